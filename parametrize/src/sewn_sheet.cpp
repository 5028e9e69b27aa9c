// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewn_sheet.h"

#include <algorithm>

#include "half_edges.h"

namespace geocloth {

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
  return sheet;
}

std::pair<RefinedMesh, CutLines> sewn_together(const CutSurface& cut, const Sheet& sheet,
                                               const std::vector<Chart>& charts, const std::vector<uint8_t>& keep) {
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
                 std::vector<char>(sheet.tied.begin(), sheet.tied.end())};
  for (size_t i = 0; i < charts.size(); ++i) {
    const Chart& c = charts[i];
    for (uint32_t h = 0; h < c.opposite.size(); ++h) {
      if (c.opposite[h] != kNone) continue;
      const uint32_t edge = 3 * c.global_triangle[h / 3] + h % 3;
      lines.cut[edge] = 1;
      if (keep[i] == 0) continue;
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
