// SPDX-License-Identifier: GPL-3.0-or-later
#include "develop/sewn_sheet.h"

#include <algorithm>
#include <array>

#include "mesh/half_edges.h"

namespace geocloth {

namespace {

/// Where a sheet touches itself along an edge, the edge may end at a vertex that both its copies share: that vertex has
/// no copy, but the edge is tied all the same.
void tie_ends_of_tied_edges(const CutSurface& cut, const std::vector<uint32_t>& point, Sheet& sheet) {
  using Edge = std::array<uint32_t, 2>;
  const auto sorted = [](uint32_t a, uint32_t b) { return Edge{std::min(a, b), std::max(a, b)}; };
  std::vector<std::pair<Edge, Edge>> edges;  // between points, between vertices of the sheet
  for (const Triangle& t : cut.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = sheet.of_vertex[t[k]], b = sheet.of_vertex[t[(k + 1) % 3]];
      if (sheet.tied[a] != 0 || sheet.tied[b] != 0) edges.emplace_back(sorted(point[a], point[b]), sorted(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i].first != edges[i + 1].first) continue;
    for (const uint32_t v : edges[i].second) sheet.tied[v] = 1;
    for (const uint32_t v : edges[i + 1].second) sheet.tied[v] = 1;
  }
}

}  // namespace

Sheet find_sheet(const CutSurface& cut) {
  using Name = std::pair<uint32_t, uint32_t>;
  std::vector<std::pair<Name, uint32_t>> named;  // the clean vertex, or the point of an inserted one; vertex
  for (uint32_t v = 0; v < cut.position.size(); ++v) {
    const uint32_t clean = cut.clean_vertex[v];
    named.push_back({clean != kNone ? Name{clean, kNone} : Name{kNone, cut.point[v]}, v});
  }
  std::sort(named.begin(), named.end());
  Sheet sheet;
  sheet.of_vertex.resize(named.size());
  std::vector<uint32_t> point;  // per sheet vertex
  for (size_t i = 0; i < named.size(); ++i) {
    if (i == 0 || named[i].first != named[i - 1].first) point.push_back(cut.point[named[i].second]);
    sheet.of_vertex[named[i].second] = static_cast<uint32_t>(point.size() - 1);
  }
  std::vector<uint32_t> copies(cut.point_count, 0);
  for (const uint32_t p : point) ++copies[p];
  for (const uint32_t p : point) sheet.tied.push_back(copies[p] > 1 ? 1 : 0);
  tie_ends_of_tied_edges(cut, point, sheet);
  sheet.pinned.assign(point.size(), 0);
  return sheet;
}

std::pair<RefinedMesh, CutLines> sewn_together(const CutSurface& cut, const Sheet& sheet,
                                               const std::vector<Chart>& charts, const std::vector<uint32_t>& rings) {
  RefinedMesh mesh;
  mesh.position.resize(sheet.tied.size());
  mesh.point.resize(sheet.tied.size());
  mesh.clean_vertex.resize(sheet.tied.size());
  for (size_t v = 0; v < cut.position.size(); ++v) {
    mesh.position[sheet.of_vertex[v]] = cut.position[v];
    mesh.point[sheet.of_vertex[v]] = cut.point[v];
    mesh.clean_vertex[sheet.of_vertex[v]] = cut.clean_vertex[v];
  }
  mesh.point_count = cut.point_count;
  mesh.component = cut.component;
  for (uint32_t t = 0; t < cut.triangle.size(); ++t) {
    const Triangle& k = cut.triangle[t];
    mesh.triangle.push_back({sheet.of_vertex[k[0]], sheet.of_vertex[k[1]], sheet.of_vertex[k[2]]});
    mesh.clean_triangle.push_back(t);
  }
  mesh.opposite = opposite_half_edges(mesh.triangle);
  mesh.leaving.assign(mesh.position.size(), kNone);
  CutLines lines{std::vector<char>(mesh.opposite.size(), 0), std::vector<char>(mesh.opposite.size(), 0),
                 std::vector<char>(sheet.tied.begin(), sheet.tied.end()),
                 std::vector<uint32_t>(mesh.position.size(), kNone)};
  for (size_t v = 0; v < sheet.pinned.size(); ++v) {
    if (sheet.pinned[v] != 0) lines.node[v] = 1;
  }
  for (size_t i = 0; i < charts.size(); ++i) {
    const Chart& c = charts[i];
    for (uint32_t h = 0; h < c.opposite.size(); ++h) {
      if (c.opposite[h] != kNone) continue;
      const uint32_t edge = 3 * c.global_triangle[h / 3] + h % 3;
      lines.cut[edge] = 1;
      for (const uint32_t v : {tail(mesh.triangle, edge), head(mesh.triangle, edge)}) {
        lines.rings[v] = std::min(lines.rings[v], rings[i]);
      }
      if (rings[i] > 0) continue;
      lines.fixed[edge] = 1;
      if (mesh.opposite[edge] != kNone) lines.fixed[mesh.opposite[edge]] = 1;
    }
  }
  for (uint32_t h = 0; h < mesh.opposite.size(); ++h) {
    const uint32_t a = tail(mesh.triangle, h), b = head(mesh.triangle, h);
    if (mesh.opposite[h] == kNone) mesh.leaving[a] = h;
    if (mesh.opposite[h] == kNone || (lines.cut[h] && sheet.tied[a] && sheet.tied[b])) lines.fixed[h] = 1;
  }
  return {std::move(mesh), std::move(lines)};
}

}  // namespace geocloth
