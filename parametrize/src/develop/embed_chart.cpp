// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tutte 1963, Floater 1997: with the outline on a convex curve and positive weights no triangle flips, in exact
// arithmetic. A long tube that ends in a cap has no usable embedding (its far end shrinks exponentially): such a disk
// is cut towards its far end first.

#include "develop/embed_chart.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/SparseCholesky>

#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"

namespace geocloth {
namespace {

/// Tutte's embedding on a circle of the surface's area, with weights 1.
std::vector<Point2> tutte_embedding(const Chart& c) {
  const std::vector<uint32_t> loop = outline_loop(c);
  double length = 0;
  std::vector<double> arc;
  for (size_t i = 0; i < loop.size(); ++i) {
    arc.push_back(length);
    length += distance(c.position[loop[i]], c.position[loop[(i + 1) % loop.size()]]);
  }
  const double radius = std::sqrt(total_area(c) / std::acos(-1.0));
  std::vector<Point2> uv(c.position.size(), Point2{0, 0});
  std::vector<int32_t> unknown(c.position.size(), 0);
  for (size_t i = 0; i < loop.size(); ++i) {
    const double angle = 2 * std::acos(-1.0) * arc[i] / length;
    uv[loop[i]] = {radius * std::cos(angle), radius * std::sin(angle)};
    unknown[loop[i]] = -1;
  }
  int32_t unknowns = 0;
  for (int32_t& u : unknown) {
    if (u == 0) u = unknowns++;
  }
  if (unknowns == 0) return uv;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(unknowns, 2);
  const auto around = neighbours(c);
  for (uint32_t v = 0; v < around.size(); ++v) {
    if (unknown[v] < 0) continue;
    entries.emplace_back(unknown[v], unknown[v], static_cast<double>(around[v].size()));
    for (const auto& [w, l, outline] : around[v]) {
      if (unknown[w] < 0) {
        right(unknown[v], 0) += uv[w][0];
        right(unknown[v], 1) += uv[w][1];
      } else if (unknown[w] < unknown[v]) {
        entries.emplace_back(unknown[v], unknown[w], -1.0);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(laplacian);
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (size_t v = 0; v < uv.size(); ++v) {
    if (unknown[v] >= 0) uv[v] = {solution(unknown[v], 0), solution(unknown[v], 1)};
  }
  return uv;
}

/// From the vertex farthest from the outline straight to it.
struct Farthest {
  double depth = 0;
  std::vector<uint32_t> path;
};
Farthest farthest_from_outline(const Chart& c) {
  const Distances d = distances(c, outline_loop(c), on_outline(c));
  const auto deepest = static_cast<uint32_t>(std::max_element(d.value.begin(), d.value.end()) - d.value.begin());
  return {d.value[deepest], d.path_from(deepest)};
}

}  // namespace

bool flip_free(const Chart& c) {
  return std::all_of(c.triangle.begin(), c.triangle.end(),
                     [&](const Triangle& t) { return signed_area(c.uv[t[0]], c.uv[t[1]], c.uv[t[2]]) > 0; });
}

bool embed_flat(Chart& c) {
  constexpr double kFlat = 1e-6;  // of the energy, which grows with the fourth power of how steep a triangle stands
  Point3 normal{0, 0, 0};
  for (const Triangle& t : c.triangle) normal = normal + normal_of(c.position, t);
  if (!(length(normal) > 0)) return false;
  normal = normal * (1 / length(normal));
  Point3 across{0, 0, 0};
  across[std::abs(normal[0]) < 0.6 ? 0 : 1] = 1;
  Point3 x = cross(across, normal);
  x = x * (1 / length(x));
  const Point3 y = cross(normal, x);
  for (const Point3& p : c.position) {
    const Point3 from = p - c.position[0];
    c.uv.push_back({dot(from, x), dot(from, y)});
  }
  const bool flat = flip_free(c) && chart_energy(c).energy(c.uv) < 4 + kFlat && !crossing_edges(c, outline_loop(c));
  if (!flat) c.uv.clear();
  return flat;
}

bool embed_on_circle(Chart& c) {
  c.uv = tutte_embedding(c);
  return flip_free(c);
}

void embed(Chart& c) {
  // A flat disc is 0.16 outlines deep, a hemisphere 0.25: what is deeper is a tube or a bag.
  constexpr double kDeep = 0.3;
  constexpr int kTries = 12;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Farthest farthest = farthest_from_outline(c);
    if (farthest.path.size() > 1 && farthest.depth > kDeep * outline_length(c)) {
      c = opened(c, farthest.path);
      continue;
    }
    if (embed_on_circle(c)) return;
    if (farthest.path.size() < 2) break;
    c = opened(c, farthest.path);
  }
  if (!embed_on_circle(c)) {
    throw Error(ErrorCode::verification, "a part of " + std::to_string(c.triangle.size()) +
                                             " triangles cannot be laid flat in double precision; remesh it with "
                                             "triangles of more even size");
  }
}

}  // namespace geocloth
