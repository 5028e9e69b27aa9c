// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle that is large beside the pixels cannot bend in the plane and would be cut into slivers by the samples on
// its outline edge. All long edges are halved at once, pass by pass; copies of an edge have bit-identical ends, so they
// are halved together and at the same place.
#include "mesh/subdivide.h"

#include <algorithm>
#include <array>
#include <map>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

// A needle is long without having area, so that its length says nothing about how many pieces are sensible.
constexpr size_t kMostAdded = 20'000;

/// Replaces a triangle by two to four; middle[i] lies on the edge from corner i, kNone where that is not split.
void split_triangle(const Triangle& corner, const std::array<uint32_t, 3>& middle, const std::vector<Point3>& position,
                    std::vector<Triangle>& out) {
  const auto splits = 3 - std::count(middle.begin(), middle.end(), kNone);
  if (splits == 0) {
    out.push_back(corner);
    return;
  }
  if (splits == 3) {
    for (size_t i = 0; i < 3; ++i) out.push_back({middle[(i + 2) % 3], corner[i], middle[i]});
    out.push_back({middle[0], middle[1], middle[2]});
    return;
  }
  // Turned so that the first edge is split, and with two splits the last is not.
  size_t first = 0;
  while (middle[first] == kNone || (splits == 2 && middle[(first + 2) % 3] != kNone)) ++first;
  const uint32_t a = corner[first], b = corner[(first + 1) % 3], c = corner[(first + 2) % 3];
  const uint32_t ab = middle[first], bc = middle[(first + 1) % 3];
  if (splits == 1) {
    out.insert(out.end(), {Triangle{a, ab, c}, Triangle{ab, b, c}});
    return;
  }
  out.push_back({ab, b, bc});
  if (distance(position[a], position[bc]) <= distance(position[ab], position[c])) {
    out.insert(out.end(), {Triangle{a, ab, bc}, Triangle{a, bc, c}});
  } else {
    out.insert(out.end(), {Triangle{a, ab, c}, Triangle{ab, bc, c}});
  }
}

/// Halves every edge that is too long; false if there was none, or there were so many that needles must be the cause.
/// @param uv  per vertex, null where the surface lies in no plane yet
bool halve_once(CutSurface& cut, std::vector<Point2>* uv, double longest, size_t most_triangles) {
  const std::vector<uint32_t> opposite = opposite_half_edges(cut.triangle);
  const auto is_long = [&](uint32_t h) {
    return distance(cut.position[tail(cut.triangle, h)], cut.position[head(cut.triangle, h)]) > longest;
  };
  size_t splits = 0;  // each half-edge that is split makes a triangle
  for (uint32_t h = 0; h < opposite.size(); ++h) splits += is_long(h) ? 1U : 0U;
  if (splits == 0 || cut.triangle.size() + splits > most_triangles) return false;
  std::vector<uint32_t> middle(opposite.size(), kNone);
  std::map<std::array<uint32_t, 2>, uint32_t> point_between;
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    if (opposite[h] != kNone && opposite[h] < h) continue;
    const uint32_t a = tail(cut.triangle, h), b = head(cut.triangle, h);
    if (!is_long(h)) continue;
    middle[h] = static_cast<uint32_t>(cut.position.size());
    if (opposite[h] != kNone) middle[opposite[h]] = middle[h];
    const auto [low, high] = std::minmax({cut.point[a], cut.point[b]});
    const auto [at, fresh] = point_between.try_emplace({low, high}, cut.point_count);
    if (fresh) ++cut.point_count;
    cut.position.push_back((cut.position[a] + cut.position[b]) * 0.5);
    cut.point.push_back(at->second);
    cut.clean_vertex.push_back(kNone);
    if (uv != nullptr) {
      const Point2 from = (*uv)[a], to = (*uv)[b];
      uv->push_back({(from[0] + to[0]) / 2, (from[1] + to[1]) / 2});
    }
  }
  std::vector<Triangle> triangle;
  std::vector<uint32_t> component, clean_triangle, hole;
  for (size_t t = 0; t < cut.triangle.size(); ++t) {
    split_triangle(cut.triangle[t], {middle[3 * t], middle[3 * t + 1], middle[3 * t + 2]}, cut.position, triangle);
    component.resize(triangle.size(), cut.component[t]);
    clean_triangle.resize(triangle.size(), cut.clean_triangle[t]);
    if (!cut.hole.empty()) hole.resize(triangle.size(), cut.hole[t]);
  }
  cut.triangle = std::move(triangle);
  cut.component = std::move(component);
  cut.clean_triangle = std::move(clean_triangle);
  cut.hole = std::move(hole);
  return true;
}

CutSurface subdivided(CutSurface cut, std::vector<Point2>* uv, double longest) {
  const size_t most_triangles = kMostAdded + 2 * cut.triangle.size();
  while (halve_once(cut, uv, longest, most_triangles)) {
  }
  return cut;
}

}  // namespace

CutSurface subdivide_long_edges(CutSurface cut, double longest) {
  return subdivided(std::move(cut), nullptr, longest);
}

CutSurface subdivide_long_edges(CutSurface cut, std::vector<Point2>& uv, double longest) {
  return subdivided(std::move(cut), &uv, longest);
}

}  // namespace geocloth
