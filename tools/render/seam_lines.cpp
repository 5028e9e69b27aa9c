// SPDX-License-Identifier: GPL-3.0-or-later
// An outline edge is one that a single triangle of the unwelded grid has. Merge the copies: outline edges that fall
// together are sewn, the others are free borders. Sewn edges that follow each other at a plain point (two of them
// there, the same number of sides, no free border) belong to one seam.
#include "render/seam_lines.h"

#include <algorithm>
#include <array>
#include <map>

#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/grid_mesh.h"

namespace geocloth {
namespace {

using PixelPair = std::array<uint32_t, 2>;

PixelPair ascending(uint32_t a, uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

std::vector<OutlineEdge> outline_edges(const ClothAsset& asset) {
  struct Side {
    PixelPair key;
    uint32_t a, b;
  };
  std::vector<Side> sides;
  for (const Triangle& t : pixel_triangles(asset))
    for (size_t i = 0; i < 3; ++i) sides.push_back({ascending(t[i], t[(i + 1) % 3]), t[i], t[(i + 1) % 3]});
  std::ranges::sort(sides, {}, &Side::key);
  std::vector<OutlineEdge> edges;
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].key == sides[i].key) ++end;
    if (end == i + 1) edges.push_back({sides[i].a, sides[i].b, kNoSeam});
    i = end;
  }
  return edges;
}

/// Outline edges with the same end points once copies are merged.
struct WeldedEdge {
  std::vector<uint32_t> side;  ///< indices of outline edges
  [[nodiscard]] bool sewn() const { return side.size() > 1; }
};
using WeldedEdges = std::map<PixelPair, WeldedEdge>;

WeldedEdges weld(const std::vector<OutlineEdge>& edges, const std::vector<uint32_t>& first_copy) {
  WeldedEdges welded;
  for (uint32_t i = 0; i < edges.size(); ++i)
    welded[ascending(first_copy[edges[i].a], first_copy[edges[i].b])].side.push_back(i);
  return welded;
}

/// Gives every sewn edge the number of its seam.
uint32_t number_seams(const WeldedEdges& welded, std::vector<OutlineEdge>& edges) {
  std::map<uint32_t, std::vector<const WeldedEdge*>> at_point;
  for (const auto& [key, edge] : welded)
    for (const uint32_t point : key) at_point[point].push_back(&edge);
  DisjointSets sets(edges.size());
  for (const auto& [key, edge] : welded)
    for (const uint32_t side : edge.side) sets.join(edge.side.front(), side);
  for (const auto& [point, around] : at_point)
    if (around.size() == 2 && around[0]->sewn() && around[0]->side.size() == around[1]->side.size())
      sets.join(around[0]->side.front(), around[1]->side.front());
  std::map<uint32_t, uint32_t> number;
  for (const auto& [key, edge] : welded) {
    if (!edge.sewn()) continue;
    for (const uint32_t side : edge.side)
      edges[side].seam = number.try_emplace(sets.find(side), static_cast<uint32_t>(number.size())).first->second;
  }
  return static_cast<uint32_t>(number.size());
}

/// Seam of every row of the table, from the edges that meet there.
std::vector<uint32_t> seams_of_rows(const ClothAsset& asset, const SeamLines& lines,
                                    const std::vector<uint32_t>& row_of) {
  std::vector<uint32_t> seam(asset.splits.rows(), kNoSeam);
  std::vector<uint8_t> free_border(seam.size(), 0);
  for (const OutlineEdge& edge : lines.edge)
    for (const uint32_t pixel : {edge.a, edge.b}) {
      const uint32_t row = row_of[pixel];
      if (row == kNoPixel) continue;
      if (edge.seam == kNoSeam)
        free_border[row] = 1;
      else
        seam[row] = seam[row] == kNoSeam || seam[row] == edge.seam ? edge.seam : kSeamNode;
    }
  for (uint32_t row = 0; row < seam.size(); ++row)
    if (free_border[row] != 0 && seam[row] != kNoSeam) seam[row] = kSeamNode;
  return seam;
}

/// Rows that no sewn edge touches: neighbours on the grid form a group.
uint32_t number_loose_rows(const ClothAsset& asset, const std::vector<uint32_t>& row_of, uint32_t next,
                           std::vector<uint32_t>& seam) {
  DisjointSets sets(seam.size());
  const auto loose = [&](uint32_t row) { return row != kNoPixel && seam[row] == kNoSeam; };
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel)
    for (uint32_t s = 0; s < 4; ++s) {
      if ((asset.spring_mask[pixel] & (1U << s)) == 0) continue;
      const int64_t other = int64_t{pixel} + kSpringOffset[s][0] + int64_t{kSpringOffset[s][1]} * asset.width;
      const uint32_t a = row_of[pixel], b = row_of[static_cast<size_t>(other)];
      if (loose(a) && loose(b)) sets.join(a, b);
    }
  std::map<uint32_t, uint32_t> number;
  std::vector<uint32_t> numbered = seam;
  for (uint32_t row = 0; row < seam.size(); ++row)
    if (loose(row))
      numbered[row] = number.try_emplace(sets.find(row), next + static_cast<uint32_t>(number.size())).first->second;
  seam = std::move(numbered);
  return next + static_cast<uint32_t>(number.size());
}

}  // namespace

SeamLines find_seam_lines(const ClothAsset& asset) {
  SeamLines lines;
  lines.edge = outline_edges(asset);
  lines.seam_count = number_seams(weld(lines.edge, first_copies(asset)), lines.edge);
  lines.on_outline.assign(asset.pixel_count(), 0);
  for (const OutlineEdge& edge : lines.edge) lines.on_outline[edge.a] = lines.on_outline[edge.b] = 1;

  const std::vector<uint32_t> row_of = split_rows(asset);
  std::vector<uint32_t> seam = seams_of_rows(asset, lines, row_of);
  lines.seam_count = number_loose_rows(asset, row_of, lines.seam_count, seam);
  lines.pixel_seam.assign(asset.pixel_count(), kNoSeam);
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel)
    if (row_of[pixel] != kNoPixel) lines.pixel_seam[pixel] = seam[row_of[pixel]];
  return lines;
}

}  // namespace geocloth
