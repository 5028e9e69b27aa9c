// SPDX-License-Identifier: Apache-2.0
// Seams of a few points, as a mesh with cracks has them: what hangs below is carried by the few springs about them, and
// the way to the pins bends there, so that attachments, which run straight, are slack. Spans over a seam follow the
// lines of the grid; about a single point the load goes on in all directions. So spans lead from each side of such a
// point to the other ones in all directions, as long as their way through the point. That is a way along the surface,
// so they never hold two points closer than they can be. They act without colliders, too (backend.cpp), and what ends
// a frame goes on about such points (whole_ties.cpp).

#include "rest/short_seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "geocloth/asset/grid_mesh.h"
#include "lib/span.h"
#include "rest/surface_graph.h"

namespace geocloth {
namespace {

constexpr uint32_t kMostPoints = 4;     ///< of a short seam
constexpr size_t kMostDirections = 3;   ///< spans from one distance on one side
constexpr uint32_t kSpringsAround = 3;  ///< what is so near carries the most

/// Pixels with how far they are [m], by that distance in spacings; the first entry is empty.
using Rings = std::array<std::vector<std::pair<uint32_t, double>>, shader::kSpanPixels>;

/// Around one copy of a point, on its side of the seam.
Rings rings_around(const SurfaceGraph& graph, uint32_t copy, double spacing) {
  const double farthest = (shader::kSpanPixels - 0.5) * spacing;
  std::map<uint32_t, double> distance{{copy, 0.0}};
  spread(
      graph, {&copy, 1}, [&](uint32_t p) { return distance.at(p); },
      [&](uint32_t, uint32_t p, double d, double step) {
        if (!(step > 0) || d >= farthest) return false;  // not over a seam, where the step is 0
        const auto [known, added] = distance.try_emplace(p, d);
        if (!added && known->second <= d) return false;
        known->second = d;
        return true;
      });
  Rings rings;
  for (const auto& [p, d] : distance)
    if (const auto ring = static_cast<size_t>(std::lround(d / spacing)); ring > 0) rings.at(ring).emplace_back(p, d);
  return rings;
}

/// Calls visit(copies of the point) for every point of a short seam that still has copies.
template <class Visit>
void for_short_seams(const ClothAsset& asset, const std::vector<bool>& short_seams, const Visit& visit) {
  for (uint32_t r = 0; r < asset.splits.rows(); ++r) {
    const std::span<const uint32_t> copies = asset.splits.copies(r);
    if (short_seams[copies.front()]) visit(copies);
  }
}

}  // namespace

std::vector<bool> pixels_of_short_seams(const ClothAsset& asset) {
  // Seams run along the grid's lines, its diagonals, or in steps of a knight's moves.
  const std::vector<uint32_t> point = first_copies(asset);
  std::vector<bool> sewn(asset.pixel_count());
  for (const uint32_t p : asset.splits.pixel) sewn[p] = true;
  std::vector<uint32_t> next(asset.pixel_count());
  std::iota(next.begin(), next.end(), 0U);
  const auto seam_of = [&](uint32_t p) {
    while (next[p] != p) p = next[p] = next[next[p]];
    return p;
  };
  const SurfaceGraph graph(asset, 1);
  for (const uint32_t p : asset.splits.pixel)
    graph.for_neighbors(p, [&](uint32_t q, double) {
      if (sewn[q]) next[seam_of(point[p])] = seam_of(point[q]);
    });
  std::vector<uint32_t> points(asset.pixel_count());
  for (uint32_t r = 0; r < asset.splits.rows(); ++r) ++points[seam_of(asset.splits.copies(r).front())];
  std::vector<bool> short_seams(asset.pixel_count());
  for (const uint32_t p : asset.splits.pixel) short_seams[p] = points[seam_of(point[p])] <= kMostPoints;
  return short_seams;
}

std::vector<shader::SeamSpring> spans_through_short_seams(const ClothAsset& asset, float scale,
                                                          const std::vector<bool>& short_seams) {
  const std::vector<uint32_t> point = first_copies(asset);
  const SurfaceGraph graph(asset, scale);
  const double spacing = static_cast<double>(scale) * static_cast<double>(asset.spacing);
  std::vector<shader::SeamSpring> spans;
  const auto add_between = [&](const Rings& one, const Rings& other) {
    for (size_t k = 1; k < one.size(); ++k) {
      const auto &from = one.at(k), &to = other.at(shader::kSpanPixels - k);
      const size_t directions = std::min({kMostDirections, from.size(), to.size()});
      for (size_t i = 0; i < directions; ++i) {
        const auto& [a, from_a] = from[(2 * i + 1) * from.size() / (2 * directions)];
        const auto& [b, from_b] = to[(2 * i + 1) * to.size() / (2 * directions)];
        if (point[a] == point[b]) continue;
        shader::SeamSpring span{};
        span.a = span.middle = span.beside = a;
        span.b = b;
        span.rest = static_cast<float>(from_a + from_b);
        spans.push_back(span);
      }
    }
  };
  for_short_seams(asset, short_seams, [&](std::span<const uint32_t> copies) {
    std::vector<Rings> sides;
    sides.reserve(copies.size());
    for (const uint32_t copy : copies) sides.push_back(rings_around(graph, copy, spacing));
    for (size_t i = 0; i < sides.size(); ++i)
      for (size_t j = i + 1; j < sides.size(); ++j) add_between(sides[i], sides[j]);
  });
  return spans;
}

size_t most_spans_through_short_seams(const ClothAsset& asset, const std::vector<bool>& short_seams) {
  size_t pairs = 0;
  for_short_seams(asset, short_seams,
                  [&](std::span<const uint32_t> copies) { pairs += copies.size() * (copies.size() - 1) / 2; });
  return pairs * kMostDirections * (shader::kSpanPixels - 1);
}

std::vector<bool> points_near_short_seams(const ClothAsset& asset, const std::vector<bool>& short_seams) {
  const std::vector<uint32_t> point = first_copies(asset);
  std::vector<bool> near(asset.pixel_count());
  for_short_seams(asset, short_seams, [&](std::span<const uint32_t> copies) { near[point[copies.front()]] = true; });
  for (uint32_t i = 0; i < kSpringsAround; ++i) {
    std::vector<bool> wider = near;
    for_structural_springs(asset, [&](uint32_t a, uint32_t b) {
      if (near[point[a]] || near[point[b]]) wider[point[a]] = wider[point[b]] = true;
    });
    near.swap(wider);
  }
  return near;
}

}  // namespace geocloth
