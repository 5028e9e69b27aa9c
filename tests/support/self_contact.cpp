// SPDX-License-Identifier: GPL-3.0-or-later
// Two triangles that are not in one plane cut each other when a side of one goes through the other. In double
// precision, with a grid to find the pairs.

#include "support/self_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "geocloth/asset/grid_mesh.h"

namespace geocloth::test {
namespace {

using Point = std::array<double, 3>;
using Triangle = std::array<uint32_t, 3>;

Point point_of(const Vec3& v) {
  return {v.x, v.y, v.z};
}

/// Six times the volume of a tetrahedron.
double volume(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto edge = [&](const Point& p) { return Point{p[0] - a[0], p[1] - a[1], p[2] - a[2]}; };
  const Point u = edge(b), v = edge(c), w = edge(d);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

bool goes_through(const Point& p, const Point& q, const std::array<Point, 3>& t) {
  if ((volume(t[0], t[1], t[2], p) > 0) == (volume(t[0], t[1], t[2], q) > 0)) return false;
  const bool a = volume(p, q, t[0], t[1]) > 0, b = volume(p, q, t[1], t[2]) > 0, c = volume(p, q, t[2], t[0]) > 0;
  return a == b && b == c;
}

bool cut_each_other(const std::array<Point, 3>& s, const std::array<Point, 3>& t) {
  for (size_t k = 0; k < 3; ++k)
    if (goes_through(s[k], s[(k + 1) % 3], t) || goes_through(t[k], t[(k + 1) % 3], s)) return true;
  return false;
}

using Cell = std::array<int64_t, 3>;

Cell cell_of(const Vec3& p, double side) {
  return {static_cast<int64_t>(std::floor(p.x / side)), static_cast<int64_t>(std::floor(p.y / side)),
          static_cast<int64_t>(std::floor(p.z / side))};
}

/// Calls body(cell) for all cells from one to another.
template <class Body>
void for_cells(const Cell& low, const Cell& high, const Body& body) {
  for (int64_t x = low[0]; x <= high[0]; ++x)
    for (int64_t y = low[1]; y <= high[1]; ++y)
      for (int64_t z = low[2]; z <= high[2]; ++z) body(Cell{x, y, z});
}

}  // namespace

uint64_t count_intersections(const ClothAsset& asset, const std::vector<Vec3>& position) {
  const GridMesh mesh = welded_grid_mesh(asset, position);
  const double side = 2.0 * static_cast<double>(asset.spacing);
  std::map<Cell, std::vector<uint32_t>> cells;
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) {
    Vec3 low = mesh.position[mesh.triangle[t][0]], high = low;
    for (const uint32_t v : mesh.triangle[t]) {
      const Vec3& p = mesh.position[v];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    for_cells(cell_of(low, side), cell_of(high, side), [&](const Cell& c) { cells[c].push_back(t); });
  }
  const auto corners = [&](uint32_t t) {
    std::array<Point, 3> p;
    for (size_t k = 0; k < 3; ++k) p[k] = point_of(mesh.position[mesh.triangle[t][k]]);
    return p;
  };
  const auto share_vertex = [&](uint32_t s, uint32_t t) {
    const Triangle &a = mesh.triangle[s], &b = mesh.triangle[t];
    return std::any_of(a.begin(), a.end(), [&](uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
  };
  std::set<std::pair<uint32_t, uint32_t>> pairs;
  for (const auto& [cell, inside] : cells)
    for (size_t i = 0; i < inside.size(); ++i)
      for (size_t j = i + 1; j < inside.size(); ++j)
        if (!share_vertex(inside[i], inside[j]) && cut_each_other(corners(inside[i]), corners(inside[j])))
          pairs.emplace(inside[i], inside[j]);
  return pairs.size();
}

double smallest_distance(const ClothAsset& asset, const std::vector<Vec3>& position, double along) {
  const std::vector<uint32_t> first = first_copies(asset);
  const double side = 2.0 * static_cast<double>(asset.spacing);
  std::map<Cell, std::vector<uint32_t>> cells;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && first[p] == p) cells[cell_of(position[p], side)].push_back(p);
  double smallest = side;
  for (const auto& [cell, inside] : cells) {
    for (const uint32_t p : inside) {
      for_cells({cell[0] - 1, cell[1] - 1, cell[2] - 1}, {cell[0] + 1, cell[1] + 1, cell[2] + 1}, [&](const Cell& c) {
        const auto found = cells.find(c);
        if (found == cells.end()) return;
        for (const uint32_t q : found->second)
          if (q > p && static_cast<double>(length(asset.rest_position[q] - asset.rest_position[p])) >= along)
            smallest = std::min(smallest, static_cast<double>(length(position[q] - position[p])));
      });
    }
  }
  return smallest;
}

ClothAsset beside(const ClothAsset& first, const ClothAsset& second) {
  ClothAsset both = first;
  const uint32_t shift = (first.height + 1) * first.width;
  const auto vertices = static_cast<uint32_t>(first.source.position.size());
  both.height = first.height + 1 + second.height;
  both.chart_count += second.chart_count;
  const auto append = [&](auto& values, const auto& more, const auto& gap) {
    values.resize(shift, gap);
    values.insert(values.end(), more.begin(), more.end());
  };
  append(both.rest_position, second.rest_position, Vec3{});
  append(both.chart, second.chart, kNoChart);
  append(both.spring_mask, second.spring_mask, uint8_t{0});
  append(both.cell, second.cell, uint8_t{0});
  append(both.area, second.area, 0.F);
  for (uint32_t p = shift; p < both.chart.size(); ++p)
    if (both.chart[p] != kNoChart) both.chart[p] = static_cast<uint16_t>(both.chart[p] + first.chart_count);

  if (both.splits.offset.empty() && second.splits.rows() > 0) both.splits.offset.push_back(0);
  for (uint32_t r = 0; r < second.splits.rows(); ++r)
    both.splits.offset.push_back(first.splits.pixel.empty() ? second.splits.offset[r + 1]
                                                            : first.splits.offset.back() + second.splits.offset[r + 1]);
  for (const uint32_t p : second.splits.pixel) both.splits.pixel.push_back(p + shift);
  for (const SeamBend& b : second.seam_bends)
    both.seam_bends.push_back({b.a + shift, b.middle + shift, b.b + shift, b.rest_length});

  const SourceMesh& source = second.source;
  const auto add = [](auto& values, const auto& more) { values.insert(values.end(), more.begin(), more.end()); };
  add(both.source.position, source.position);
  add(both.source.normal, source.normal);
  add(both.source.uv, source.uv);
  for (const uint32_t v : source.source_vertex)
    both.source.source_vertex.push_back(v + first.source.source_vertex_count);
  for (const Triangle& t : source.triangle)
    both.source.triangle.push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  for (SourcePart& part : both.source.part) part.triangle_count = static_cast<uint32_t>(both.source.triangle.size());
  both.source.source_vertex_count += source.source_vertex_count;
  for (Binding binding : second.binding) {
    for (uint32_t& p : binding.pixel) p += shift;
    both.binding.push_back(binding);
  }
  for (const ClothAsset::VertexGroup& group : second.vertex_groups) {
    const auto same = std::find_if(both.vertex_groups.begin(), both.vertex_groups.end(),
                                   [&](const ClothAsset::VertexGroup& g) { return g.name == group.name; });
    for (const uint32_t v : group.source_vertex) same->source_vertex.push_back(v + first.source.source_vertex_count);
  }
  return both;
}

}  // namespace geocloth::test
