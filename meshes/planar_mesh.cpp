// SPDX-License-Identifier: GPL-3.0-or-later
// Constrained Delaunay triangulation of a jittered hexagonal grid inside given loops: irregular, as the meshes of
// garment designers are, but without slivers, because points near an outline are left out.
#include "planar_mesh.h"

#include <algorithm>
#include <cmath>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace geocloth::meshes {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

constexpr double kJitter = 0.28;       // of the spacing
constexpr double kBorderMargin = 0.6;  // of the spacing

using Loops = std::vector<std::vector<Point2>>;

/// The same number in -1..1 for the same cell everywhere (splitmix64).
double noise(uint64_t cell) {
  cell += 0x9e3779b97f4a7c15U;
  cell = (cell ^ (cell >> 30U)) * 0xbf58476d1ce4e5b9U;
  cell = (cell ^ (cell >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<double>((cell ^ (cell >> 31U)) >> 11U) * 0x1p-52 - 1;
}

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double t = std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
}

/// Even-odd rule over all loops.
bool is_inside(const Loops& loops, const Point2& p) {
  bool inside = false;
  for (const auto& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Point2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
      if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
        inside = !inside;
      }
    }
  }
  return inside;
}

double distance_to_loops(const Loops& loops, const Point2& p) {
  double nearest = INFINITY;
  for (const auto& loop : loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      nearest = std::min(nearest, distance_to_segment(p, loop[i], loop[(i + 1) % loop.size()]));
    }
  }
  return nearest;
}

/// Rounding puts slivers between points of a straight border and the hull; they belong to neither side.
bool is_well_inside(const Loops& loops, const Point2& p, double spacing) {
  return is_inside(loops, p) && distance_to_loops(loops, p) > 1e-6 * spacing;
}

std::vector<Point2> interior_points(const Loops& loops, double spacing) {
  Point2 low = loops[0][0], high = loops[0][0];
  for (const Point2& p : loops[0]) {
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  const double row_height = spacing * std::sqrt(0.75);
  std::vector<Point2> points;
  for (uint32_t row = 0; low[1] + row * row_height <= high[1]; ++row) {
    for (uint32_t column = 0; low[0] + column * spacing <= high[0]; ++column) {
      const uint64_t cell = (uint64_t{row} << 32U) | column;
      const Point2 p{low[0] + (column + 0.5 * (row % 2) + kJitter * noise(2 * cell)) * spacing,
                     low[1] + (row + kJitter * noise(2 * cell + 1)) * row_height};
      if (is_inside(loops, p) && distance_to_loops(loops, p) > kBorderMargin * spacing) points.push_back(p);
    }
  }
  return points;
}

/// Middles of the inner edges that join two points of the loops, in a fixed order.
std::vector<Point2> chord_middles(const Triangulation& triangulation, const Loops& loops, uint32_t loop_points,
                                  double spacing) {
  std::vector<Point2> middles;
  for (const auto& edge : triangulation.finite_edges()) {
    const auto a = edge.first->vertex(triangulation.cw(edge.second));
    const auto b = edge.first->vertex(triangulation.ccw(edge.second));
    if (triangulation.is_constrained(edge) || a->info() >= loop_points || b->info() >= loop_points) continue;
    const Point2 middle{(a->point().x() + b->point().x()) / 2, (a->point().y() + b->point().y()) / 2};
    if (is_well_inside(loops, middle, spacing)) middles.push_back(middle);
  }
  std::sort(middles.begin(), middles.end());
  return middles;
}

/// CGAL walks its faces in an order of its own; the result is sorted.
std::vector<std::array<uint32_t, 3>> inner_triangles(const Triangulation& triangulation, const Loops& loops,
                                                     double spacing) {
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const auto face : triangulation.finite_face_handles()) {
    std::array<uint32_t, 3> t{};
    Point2 middle{};
    for (int k = 0; k < 3; ++k) {
      t[static_cast<std::size_t>(k)] = face->vertex(k)->info();
      middle[0] += face->vertex(k)->point().x() / 3;
      middle[1] += face->vertex(k)->point().y() / 3;
    }
    if (!is_well_inside(loops, middle, spacing)) continue;
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    triangles.push_back(t);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace

std::vector<Point2> sample_polyline(const std::vector<Point2>& corners, double spacing) {
  std::vector<Point2> samples;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Point2 &a = corners[i], &b = corners[i + 1];
    const auto steps = std::max(1L, std::lround(std::hypot(b[0] - a[0], b[1] - a[1]) / spacing));
    for (long k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(steps);
      samples.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
  }
  return samples;
}

PlanarMesh triangulate(const Loops& loops, double spacing) {
  PlanarMesh mesh;
  Triangulation triangulation;
  const auto insert = [&](const Point2& p) {
    const auto vertex = triangulation.insert(Kernel::Point_2(p[0], p[1]));
    vertex->info() = static_cast<uint32_t>(mesh.position.size());
    mesh.position.push_back(p);
  };
  for (const auto& loop : loops) {
    const std::size_t first = mesh.position.size();
    for (const Point2& p : loop) insert(p);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Point2 &a = mesh.position[first + i], &b = mesh.position[first + (i + 1) % loop.size()];
      triangulation.insert_constraint(Kernel::Point_2(a[0], a[1]), Kernel::Point_2(b[0], b[1]));
    }
  }
  const auto loop_points = static_cast<uint32_t>(mesh.position.size());
  for (const Point2& p : interior_points(loops, spacing)) insert(p);
  for (auto middles = chord_middles(triangulation, loops, loop_points, spacing); !middles.empty();
       middles = chord_middles(triangulation, loops, loop_points, spacing)) {
    for (const Point2& p : middles) insert(p);
  }
  mesh.triangle = inner_triangles(triangulation, loops, spacing);
  return mesh;
}

}  // namespace geocloth::meshes
