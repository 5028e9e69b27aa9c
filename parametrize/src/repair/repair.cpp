// SPDX-License-Identifier: GPL-3.0-or-later
// Repair in the order of geometry_images 5, step 1: weld; drop collapsed and duplicate faces; split at T-junctions;
// replace triangles without area; then join the faces into oriented manifold sheets tied by their points (sheets.cpp).
// Nothing is closed and nothing is thrown away but faces that are no faces.
#include "geocloth/parametrize/repair.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"
#include "repair/sheets.h"
#include "repair/soup.h"
#include "repair/surface_uv.h"

namespace geocloth {
namespace {

/// Of the vertices that faces use.
double diagonal(const TriangleMesh& mesh) {
  if (mesh.triangle.empty()) return 0;
  Point3 low = mesh.position[mesh.triangle[0][0]], high = low;
  for (const Triangle& t : mesh.triangle) {
    for (const uint32_t v : t) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], mesh.position[v][k]);
        high[k] = std::max(high[k], mesh.position[v][k]);
      }
    }
  }
  return distance(low, high);
}

void check(const TriangleMesh& mesh, const RepairOptions& options) {
  if (options.weld_distance && !(*options.weld_distance >= 0 && std::isfinite(*options.weld_distance))) {
    throw Error(ErrorCode::invalid_argument, "the weld distance must be finite and not below 0");
  }
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    for (const uint32_t v : mesh.triangle[i]) {
      if (v < mesh.position.size()) continue;
      throw Error(ErrorCode::invalid_argument, mesh.name + ": triangle " + std::to_string(i) + " uses vertex " +
                                                   std::to_string(v) + " of " + std::to_string(mesh.position.size()));
    }
  }
}

/// Per triangle of the file: its part and its material.
std::vector<std::array<uint32_t, 2>> parts_of(const TriangleMesh& mesh) {
  std::vector<std::array<uint32_t, 2>> part(mesh.triangle.size(), {0, 0});
  for (uint32_t i = 0; i < mesh.part.size(); ++i) {
    const SourcePart& p = mesh.part[i];
    std::fill_n(part.begin() + p.first_triangle, p.triangle_count, std::array<uint32_t, 2>{i, p.material});
  }
  return part;
}

/// Points that no face uses any more go; the others move up.
void drop_unused_points(Soup& soup, std::vector<uint32_t>& source_point) {
  std::vector<uint32_t> number(soup.position.size(), kNone);
  for (const Triangle& t : soup.triangle) {
    for (const uint32_t p : t) number[p] = 0;
  }
  uint32_t count = 0;
  for (uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == kNone) continue;
    soup.position[count] = soup.position[p];
    number[p] = count++;
  }
  soup.position.resize(count);
  for (Triangle& t : soup.triangle) {
    for (uint32_t& p : t) p = number[p];
  }
  for (uint32_t& p : source_point) p = p == kNone ? kNone : number[p];
}

/// Connected parts of the file of which no face is left: nothing but faces without area.
uint64_t count_lost_parts(const TriangleMesh& mesh, const std::vector<uint32_t>& point, const CleanSurface& surface) {
  DisjointSets parts(point.size());
  for (const Triangle& t : mesh.triangle) {
    parts.join(point[t[0]], point[t[1]]);
    parts.join(point[t[1]], point[t[2]]);
  }
  std::vector<uint8_t> state(point.size(), 0);  // 1: a part, 2: something of it is left
  for (const Triangle& t : mesh.triangle) state[parts.find(point[t[0]])] = 1;
  for (const uint32_t s : surface.source_triangle) state[parts.find(point[mesh.triangle[s][0]])] = 2;
  return static_cast<uint64_t>(std::count(state.begin(), state.end(), 1));
}

/// See RepairResult::folded_faces. Faces hang together by the file's vertices.
/// @param kept  per triangle of the file
uint64_t count_folded(const TriangleMesh& mesh, const std::vector<uint32_t>& point, const std::vector<bool>& kept) {
  const auto is_collapsed = [&](const Triangle& t) {
    return point[t[0]] == point[t[1]] || point[t[1]] == point[t[2]] || point[t[2]] == point[t[0]];
  };
  DisjointSets parts(point.size());
  std::vector<bool> is_used(point.size(), false);  // by faces that are kept
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Triangle& t = mesh.triangle[i];
    if (is_collapsed(t)) continue;
    parts.join(t[0], t[1]);
    parts.join(t[1], t[2]);
    for (const uint32_t v : t) is_used[v] = is_used[v] || kept[i];
  }
  std::vector<bool> has_kept(point.size(), false);  // by a part's first vertex
  for (uint32_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v]) has_kept[parts.find(v)] = true;
  }
  uint64_t folded = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Triangle& t = mesh.triangle[i];
    if (kept[i] || is_collapsed(t) || !has_kept[parts.find(t[0])]) continue;
    if (!std::all_of(t.begin(), t.end(), [&](uint32_t v) { return is_used[v]; })) ++folded;
  }
  return folded;
}

/// See RepairResult::touching_points.
uint64_t count_touching(const TriangleMesh& mesh, const CleanSurface& surface) {
  std::vector<uint32_t> fans(surface.point_count, 0);
  for (const uint32_t p : surface.point) ++fans[p];
  const std::vector<uint32_t>& point = surface.source_point;
  const auto is_tied = [&](uint32_t v) { return point[v] != kNone && fans[point[v]] > 1; };
  std::vector<std::array<uint32_t, 2>> edges;  // by the file's vertices, at tied points
  std::vector<bool> is_whole(point.size(), false);
  for (const Triangle& t : mesh.triangle) {
    if (std::none_of(t.begin(), t.end(), is_tied)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
      is_whole[a] = is_tied(a);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last = std::upper_bound(first, edges.end(), *first);
    if (last - first != 2) is_whole[(*first)[0]] = is_whole[(*first)[1]] = false;
    first = last;
  }
  std::vector<uint32_t> whole(surface.point_count, 0);
  for (uint32_t v = 0; v < is_whole.size(); ++v)
    if (is_whole[v]) ++whole[point[v]];
  return static_cast<uint64_t>(std::count_if(whole.begin(), whole.end(), [](uint32_t n) { return n > 1; }));
}

uint64_t count_merged(std::vector<uint32_t> point) {
  std::sort(point.begin(), point.end());
  const auto used = std::lower_bound(point.begin(), point.end(), kNone);
  return static_cast<uint64_t>(used - std::unique(point.begin(), used));
}

}  // namespace

RepairResult repair_mesh(const TriangleMesh& mesh, const RepairOptions& options, const Progress& progress) {
  const auto report = [&](double fraction) {
    if (progress) progress("repair", fraction);
  };
  check(mesh, options);
  report(0);
  RepairResult result;
  const auto count = [&](const char* kind, uint64_t n) {
    if (n > 0) result.repairs.push_back({kind, n});
  };
  const WeldReach reach = weld_reach(options, diagonal(mesh));

  Weld welded = weld(mesh.position, mesh.triangle, reach);
  Soup soup{std::move(welded.position), mesh.triangle, std::vector<uint32_t>(mesh.triangle.size())};
  for (uint32_t i = 0; i < soup.triangle.size(); ++i) {
    soup.source[i] = i;
    for (uint32_t& v : soup.triangle[i]) v = welded.point[v];
  }
  report(0.3);

  const uint64_t collapsed = drop_collapsed(soup);
  result.source = measure_topology(soup.triangle, static_cast<uint32_t>(soup.position.size()));
  uint64_t duplicates = drop_duplicates(soup, mesh.polygon);
  if (duplicates > 0) {
    std::vector<bool> kept(mesh.triangle.size(), false);
    for (const uint32_t s : soup.source) kept[s] = true;
    result.folded_faces = count_folded(mesh, welded.point, kept);
  }
  const uint64_t t_junctions = sew_borders(soup, welded.point, reach.distance);
  duplicates += drop_duplicates(soup, {});
  const uint64_t flat = flatten_caps(soup);
  duplicates += drop_duplicates(soup, {});
  count("welded_vertices", count_merged(welded.point));
  count("degenerate_faces", collapsed);
  count("duplicate_faces", duplicates);
  count("t_junctions", t_junctions);
  count("zero_area_faces", flat);
  if (soup.triangle.empty()) {
    throw Error(ErrorCode::invalid_data, mesh.name + ": no face with an area is left; is the mesh scaled to nothing?");
  }
  report(0.6);

  const std::vector<uint32_t> welded_point = welded.point;
  drop_unused_points(soup, welded.point);
  SheetRepairs sheets;
  result.surface = make_manifold(soup, parts_of(mesh), sheets);
  result.surface.source_point = std::move(welded.point);
  result.surface.uv = surface_uv(mesh, result.surface);
  result.touching_points = count_touching(mesh, result.surface);
  count("flipped_faces", sheets.flipped_faces);
  count("detached_sheets", sheets.detached_sheets);
  count("torn_edges", sheets.torn_edges);
  count("bow_ties", sheets.bow_ties);
  count("lost_parts", count_lost_parts(mesh, welded_point, result.surface));
  result.cleaned = measure_topology(point_triangles(result.surface), result.surface.point_count);
  report(1);
  return result;
}

std::vector<Triangle> point_triangles(const CleanSurface& surface) {
  std::vector<Triangle> out = surface.triangle;
  for (Triangle& t : out) {
    for (uint32_t& v : t) v = surface.point[v];
  }
  return out;
}

}  // namespace geocloth
