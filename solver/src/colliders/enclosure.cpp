// SPDX-License-Identifier: Apache-2.0
// How often a surface without a border winds around a point is a whole number, which comes of counting the triangles
// that a row along x goes through before it. Vertices are put on a lattice much finer than the grid, whose coordinates
// are whole numbers: so no row can slip through between two triangles, and vertices that should be the same are.

#include "colliders/enclosure.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <tuple>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace geocloth {
namespace {

constexpr int64_t kSteps = 1024;          ///< of the lattice from node to node
constexpr size_t kColumnsOfFacet = 16;    ///< as a mean
constexpr int64_t kBeside = kSteps / 16;  ///< how far beside a triangle points of it may be

/// Twice the area, seen along x, of the triangle over an edge from a to b.
template <class Point>
int64_t side_of(const Point& a, const Point& b, int64_t y, int64_t z) {
  return (b.y - a.y) * (z - a.z) - (b.z - a.z) * (y - a.y);
}

/// Whether a row is to the left of an edge; one that meets it goes by a little farther along y and, much less, z.
template <class Point>
bool is_left(int64_t side, const Point& a, const Point& b) {
  return side != 0 ? side > 0 : a.z != b.z ? a.z > b.z : b.y > a.y;
}

/// Where along x a row goes through a triangle.
/// @param twice  its area, seen along x; not 0
template <class Facet>
std::optional<double> crossing(const Facet& f, int64_t twice, int64_t y, int64_t z) {
  const bool left = twice > 0;
  const int64_t a = side_of(f.b, f.c, y, z);
  if (is_left(a, f.b, f.c) != left) return {};
  const int64_t b = side_of(f.c, f.a, y, z);
  if (is_left(b, f.c, f.a) != left) return {};
  const int64_t c = side_of(f.a, f.b, y, z);
  if (is_left(c, f.a, f.b) != left) return {};
  const auto times = [](int64_t share, int64_t x) { return static_cast<double>(share) * static_cast<double>(x); };
  return (times(a, f.a.x) + times(b, f.b.x) + times(c, f.c.x)) / static_cast<double>(twice);
}

/// Going on along x a row comes in where the normal points back.
int32_t turn_of(int64_t twice, int32_t times) {
  return twice > 0 ? -times : times;
}

}  // namespace

Enclosure::Enclosure(const NodeGrid& grid, const TriangleSurface& surface) : grid_(grid) {
  const std::vector<std::array<uint32_t, 3>> triangle = join(surface);
  facets_.reserve(triangle.size());
  for (const auto& t : triangle) facets_.push_back({point_[t[0]], point_[t[1]], point_[t[2]], 1});
  const std::vector<BorderEdge> border = border_of(triangle);
  const size_t edges = std::accumulate(border.begin(), border.end(), size_t{0}, [](size_t sum, const BorderEdge& e) {
    return sum + static_cast<size_t>(e.times);
  });
  if (edges <= facets_.size() / 2) {
    close(border);
    return;
  }
  std::vector<TriangleCorners> corners;
  corners.reserve(facets_.size());
  for (const Facet& f : facets_) corners.push_back({place(f.a), place(f.b), place(f.c)});
  tree_.emplace(std::move(corners));
}

Enclosure::LatticePoint Enclosure::on_lattice(const Vec3d& p) const {
  const auto along = [&](double at, double low, uint32_t nodes) {
    const double steps = (at - low) * (kSteps / grid_.spacing);
    return static_cast<int64_t>(std::llround(std::clamp(steps, 0.0, static_cast<double>((nodes - 1) * kSteps))));
  };
  return {along(p.x, grid_.low.x, grid_.size[0]), along(p.y, grid_.low.y, grid_.size[1]),
          along(p.z, grid_.low.z, grid_.size[2])};
}

Vec3d Enclosure::place(const LatticePoint& p) const {
  const double step = grid_.spacing / kSteps;
  return {grid_.low.x + step * static_cast<double>(p.x), grid_.low.y + step * static_cast<double>(p.y),
          grid_.low.z + step * static_cast<double>(p.z)};
}

/// The triangles on the lattice, with vertices that are at one place made one.
std::vector<std::array<uint32_t, 3>> Enclosure::join(const TriangleSurface& surface) {
  point_.reserve(surface.position.size());
  for (const Vec3& p : surface.position) point_.push_back(on_lattice(to_double(p)));
  std::vector<uint32_t> order(point_.size()), joined(point_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    const LatticePoint &p = point_[a], &q = point_[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  for (size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && point_[order[k]] == point_[order[k - 1]];
    joined[order[k]] = same ? joined[order[k - 1]] : order[k];
  }
  std::vector<std::array<uint32_t, 3>> triangle;
  triangle.reserve(surface.triangle.size());
  for (const auto& t : surface.triangle) {
    const std::array<uint32_t, 3> v{joined[t[0]], joined[t[1]], joined[t[2]]};
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) triangle.push_back(v);
  }
  return triangle;
}

/// The boundary of the surface as a chain: what its triangles leave of each edge.
std::vector<Enclosure::BorderEdge> Enclosure::border_of(const std::vector<std::array<uint32_t, 3>>& triangle) const {
  std::vector<uint32_t> first(point_.size() + 1);  // the edges from each vertex to a higher one
  const auto for_edges = [&](const auto& body) {
    for (const auto& t : triangle) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t from = t[k], to = t[(k + 1) % 3];
        body(std::min(from, to), std::max(from, to), from < to ? 1 : -1);
      }
    }
  };
  for_edges([&](uint32_t low, uint32_t, int32_t) { ++first[low + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::pair<uint32_t, int32_t>> ends(first.back());
  std::vector<uint32_t> next(first.begin(), first.end() - 1);
  for_edges([&](uint32_t low, uint32_t high, int32_t way) { ends[next[low]++] = {high, way}; });
  std::vector<BorderEdge> edges;
  for (uint32_t v = 0; v < point_.size(); ++v) {
    std::sort(ends.begin() + first[v], ends.begin() + first[v + 1]);
    for (uint32_t k = first[v]; k < first[v + 1];) {
      const uint32_t to = ends[k].first;
      int32_t times = 0;
      for (; k < first[v + 1] && ends[k].first == to; ++k) times += ends[k].second;
      if (times > 0) edges.push_back({v, to, times});
      if (times < 0) edges.push_back({to, v, -times});
    }
  }
  return edges;
}

/// Adds a cone over each part of the border that hangs together.
void Enclosure::close(const std::vector<BorderEdge>& border) {
  std::vector<uint32_t> root(point_.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const BorderEdge& e : border) root[find(e.from)] = find(e.to);
  struct Middle {
    LatticePoint sum{};
    int64_t points = 0;
  };
  std::vector<Middle> middle(point_.size());  // by root
  for (const BorderEdge& e : border) {
    Middle& m = middle[find(e.from)];
    const LatticePoint& p = point_[e.from];
    m = {{m.sum.x + p.x, m.sum.y + p.y, m.sum.z + p.z}, m.points + 1};
  }
  for (const BorderEdge& e : border) {
    const Middle& m = middle[find(e.from)];
    const LatticePoint tip{m.sum.x / m.points, m.sum.y / m.points, m.sum.z / m.points};
    facets_.push_back({point_[e.to], point_[e.from], tip, e.times});
  }
}

std::vector<char> Enclosure::nodes_inside() const {
  std::vector<char> inside(grid_.count());
  const size_t layer = size_t{grid_.size[0]} * grid_.size[1];
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, grid_.size[2], kLayersAtOnce),
                    [&](const tbb::blocked_range<uint32_t>& layers) {
                      char* out = &inside[layer * layers.begin()];
                      if (!tree_) {
                        std::vector<int32_t> turns(layer * layers.size());
                        count_turns(layers.begin(), layers.end(), turns);
                        std::ranges::transform(turns, out, [](int32_t t) { return static_cast<char>(t != 0); });
                        return;
                      }
                      for (uint32_t z = layers.begin(); z < layers.end(); ++z) {
                        for (uint32_t y = 0; y < grid_.size[1]; ++y) {
                          for (uint32_t x = 0; x < grid_.size[0]; ++x)
                            *out++ = static_cast<char>(encloses(grid_.place(x, y, z)));
                        }
                      }
                    });
  return inside;
}

/// Counts at each node of some layers how often the closed surface winds around it.
void Enclosure::count_turns(uint32_t first_layer, uint32_t last_layer, std::vector<int32_t>& turns) const {
  const size_t row = grid_.size[0];
  const auto nodes = [](int64_t a, int64_t b, int64_t c) {
    const auto [low, high] = std::minmax({a, b, c});
    return std::pair(static_cast<uint32_t>((low + kSteps - 1) / kSteps), static_cast<uint32_t>(high / kSteps + 1));
  };
  for (const Facet& f : facets_) {
    const auto [z0, z1] = nodes(f.a.z, f.b.z, f.c.z);
    const uint32_t first = std::max(z0, first_layer), last = std::min(z1, last_layer);
    if (first >= last) continue;
    const auto [y0, y1] = nodes(f.a.y, f.b.y, f.c.y);
    const int64_t twice = side_of(f.a, f.b, f.c.y, f.c.z);
    if (twice == 0) continue;
    for (uint32_t z = first; z < last; ++z) {
      for (uint32_t y = y0; y < y1; ++y) {
        const std::optional<double> x = crossing(f, twice, kSteps * y, kSteps * z);
        if (!x) continue;
        const auto beyond = static_cast<size_t>(*x / kSteps) + 1;
        if (beyond < row) turns[row * (grid_.size[1] * (z - first_layer) + y) + beyond] += turn_of(twice, f.times);
      }
    }
  }
  for (size_t begin = 0; begin < turns.size(); begin += row) {
    for (size_t k = begin + 1; k < begin + row; ++k) turns[k] += turns[k - 1];
  }
}

/// Sorts the facets into columns along x, as wide as it takes for large triangles not to lie in too many, but only
/// where something will be asked for.
void Enclosure::index(std::span<const TriangleCorners> triangles) {
  if (tree_) return;
  std::vector<FacetBox> asked;
  asked.reserve(triangles.size());
  for (const TriangleCorners& t : triangles)
    asked.push_back(box_of({on_lattice(t.a), on_lattice(t.b), on_lattice(t.c), 0}, 0));
  std::vector<FacetBox> boxes;
  boxes.reserve(facets_.size());
  for (uint32_t k = 0; k < facets_.size(); ++k) boxes.push_back(box_of(facets_[k], k));

  std::vector<char> is_asked;
  const auto for_columns = [&](const FacetBox& box, int64_t more, const auto& body) {
    const auto column = [&](int64_t at) { return static_cast<uint32_t>(std::max<int64_t>(at, 0) / column_); };
    const uint32_t y1 = std::min(column(box.y1 + more), columns_along_y_ - 1);
    const uint32_t z1 = std::min(column(box.z1 + more), columns_along_z_ - 1);
    for (uint32_t z = column(box.z0 - more); z <= z1; ++z) {
      for (uint32_t y = column(box.y0 - more); y <= y1; ++y) body(size_t{z} * columns_along_y_ + y);
    }
  };
  const auto for_entries = [&](const auto& body) {
    for (const FacetBox& box : boxes) {
      for_columns(box, 0, [&](size_t column) {
        if (is_asked[column] != 0) body(column, box);
      });
    }
  };
  const auto count_entries = [&] {
    const auto along = [&](uint32_t nodes) { return static_cast<uint32_t>(nodes * kSteps / column_ + 1); };
    columns_along_y_ = along(grid_.size[1]);
    columns_along_z_ = along(grid_.size[2]);
    is_asked.assign(size_t{columns_along_y_} * columns_along_z_, 0);
    for (const FacetBox& box : asked) for_columns(box, kBeside, [&](size_t column) { is_asked[column] = 1; });
    column_first_.assign(is_asked.size() + 1, 0);
    for_entries([&](size_t column, const FacetBox&) { ++column_first_[column + 1]; });
    return std::accumulate(column_first_.begin(), column_first_.end(), size_t{0});
  };
  while (count_entries() > kColumnsOfFacet * facets_.size()) column_ *= 2;
  std::partial_sum(column_first_.begin(), column_first_.end(), column_first_.begin());
  in_column_.resize(column_first_.back());
  std::vector<uint32_t> next = column_first_;
  for_entries([&](size_t column, const FacetBox& box) { in_column_[next[column]++] = box; });
}

Enclosure::FacetBox Enclosure::box_of(const Facet& f, uint32_t number) {
  const auto [y0, y1] = std::minmax({f.a.y, f.b.y, f.c.y});
  const auto [z0, z1] = std::minmax({f.a.z, f.b.z, f.c.z});
  return {std::min({f.a.x, f.b.x, f.c.x}), y0, y1, z0, z1, number};
}

bool Enclosure::encloses(const Vec3d& p) const {
  return tree_ ? std::abs(tree_->winding(p)) > 0.5 : turns_at(on_lattice(p)) != 0;
}

/// How often the closed surface winds around a point.
int32_t Enclosure::turns_at(const LatticePoint& p) const {
  const auto column = static_cast<size_t>(p.z / column_ * columns_along_y_ + p.y / column_);
  int32_t turns = 0;
  for (uint32_t k = column_first_[column]; k < column_first_[column + 1]; ++k) {
    const FacetBox& box = in_column_[k];
    if (box.x0 >= p.x || p.y < box.y0 || p.y > box.y1 || p.z < box.z0 || p.z > box.z1) continue;
    const Facet& f = facets_[box.facet];
    const int64_t twice = side_of(f.a, f.b, f.c.y, f.c.z);
    if (twice == 0) continue;
    const std::optional<double> x = crossing(f, twice, p.y, p.z);
    if (x && *x < static_cast<double>(p.x)) turns += turn_of(twice, f.times);
  }
  return turns;
}

}  // namespace geocloth
