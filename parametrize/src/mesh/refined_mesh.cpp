// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/refined_mesh.h"

#include <numeric>
#include <utility>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {

// Splitting a -> b at m; only the half-edges named below change. New triangles are (m, b, c) and, beyond the edge,
// (m, a, d).
//            c                       c
//          /   \.                  / | \.
//        /       \.              /   |   \.
//       a ------- b     =>      a -- m -- b
//        \       /               \   |   /
//          \   /                   \ | /
//            d                       d
uint32_t RefinedMesh::split_edge(uint32_t h, const Point3& at, uint32_t new_point) {
  const auto m = static_cast<uint32_t>(position.size());
  position.push_back(at);
  point.push_back(new_point);
  clean_vertex.push_back(kNone);
  leaving.push_back(kNone);

  // Cuts triangle side / 3 in two along the line from m to the corner that faces `side`; gives the half-edge from m on.
  const auto split_triangle = [&](uint32_t side) {
    const uint32_t next = next_half_edge(side), apex = tail(triangle, previous_half_edge(side));
    const uint32_t end = tail(triangle, next), outer = opposite[next];
    const auto fresh = static_cast<uint32_t>(triangle.size() * 3);
    triangle[next / 3][next % 3] = m;
    triangle.push_back({m, end, apex});
    clean_triangle.push_back(clean_triangle[side / 3]);
    component.push_back(component[side / 3]);
    opposite.insert(opposite.end(), {kNone, outer, next});
    opposite[next] = fresh + 2;
    if (outer == kNone) {
      leaving[end] = fresh + 1;
    } else {
      opposite[outer] = fresh + 1;
    }
    return fresh;
  };

  const uint32_t beyond = opposite[h];
  const uint32_t second_half = split_triangle(h);
  if (beyond == kNone) {
    leaving[m] = second_half;
    return m;
  }
  const uint32_t beyond_second_half = split_triangle(beyond);
  opposite[h] = beyond_second_half;
  opposite[beyond_second_half] = h;
  opposite[second_half] = beyond;
  opposite[beyond] = second_half;
  return m;
}

namespace {

void find_leaving(RefinedMesh& mesh) {
  mesh.leaving.assign(mesh.position.size(), kNone);
  for (uint32_t h = 0; h < mesh.opposite.size(); ++h) {
    if (mesh.opposite[h] == kNone) mesh.leaving[tail(mesh.triangle, h)] = h;
  }
}

}  // namespace

RefinedMesh make_refined_mesh(const CutSurface& cut) {
  RefinedMesh mesh;
  mesh.position = cut.position;
  mesh.triangle = cut.triangle;
  mesh.point = cut.point;
  mesh.point_count = cut.point_count;
  mesh.clean_vertex = cut.clean_vertex;
  mesh.component = cut.component;
  mesh.clean_triangle = cut.clean_triangle;
  mesh.opposite = opposite_half_edges(cut.triangle);
  find_leaving(mesh);
  return mesh;
}

RefinedMesh make_refined_mesh(const CleanSurface& surface, std::vector<uint32_t> opposite) {
  RefinedMesh mesh;
  mesh.position = surface.position;
  mesh.triangle = surface.triangle;
  mesh.point = surface.point;
  mesh.point_count = surface.point_count;
  mesh.clean_vertex.resize(surface.position.size());
  std::iota(mesh.clean_vertex.begin(), mesh.clean_vertex.end(), 0U);
  mesh.component = surface.component;
  mesh.clean_triangle.resize(surface.triangle.size());
  std::iota(mesh.clean_triangle.begin(), mesh.clean_triangle.end(), 0U);
  mesh.opposite = std::move(opposite);
  find_leaving(mesh);
  return mesh;
}

void split_edges_across(RefinedMesh& mesh) {
  // The list grows on the way: an edge that a split moves gets a higher number and is met there.
  for (uint32_t h = 0; h < mesh.triangle.size() * 3; ++h) {
    const uint32_t a = tail(mesh.triangle, h), b = head(mesh.triangle, h);
    if (mesh.opposite[h] == kNone || mesh.leaving[a] == kNone || mesh.leaving[b] == kNone) continue;
    mesh.split_edge(h, (mesh.position[a] + mesh.position[b]) * 0.5, mesh.point_count++);
  }
}

}  // namespace geocloth
