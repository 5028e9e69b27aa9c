// SPDX-License-Identifier: Apache-2.0
// Every triangle is measured from the nodes close by; from there on nodes take over where the nodes beside them have
// their nearest points, in the order of their distances, as in Danielsson 1980, "Euclidean distance mapping", and look
// on the triangle there.

#include "colliders/nearest_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "colliders/triangle_rows.h"

namespace geocloth {
namespace {

constexpr double kNear = 1.75;  ///< [spacings] that triangles are measured from; above the square root of 3
constexpr size_t kGrain = 256;  ///< nodes or triangles
constexpr size_t kTrianglesAtOnce = 65'536;  ///< which take 16 MiB

enum class State : uint8_t { unknown, touched, front, known };

class NearestSurface {
 public:
  NearestSurface(const NodeGrid& grid, std::span<const TriangleCorners> triangles, const std::vector<char>& inside,
                 double band)
      : grid_(grid),
        size_(grid.size),
        around_(neighbors_in(grid.size)),
        inside_(inside),
        band_(static_cast<float>(band * band)),
        square_(inside.size(), std::numeric_limits<float>::max()),
        nearest_(inside.size(), kNoTriangle),
        off_(inside.size()),
        state_(inside.size(), State::unknown) {
    const auto in_spacings = [&](const Vec3d& p) { return (1 / grid.spacing) * (p - grid.low); };
    triangles_.reserve(triangles.size());
    for (const TriangleCorners& t : triangles)
      triangles_.push_back({in_spacings(t.a), in_spacings(t.b), in_spacings(t.c)});
  }

  NearestPoints find() {
    measure_near();
    spread();
    tbb::parallel_for(tbb::blocked_range<size_t>(0, nearest_.size(), kGrain), [&](const auto& nodes) {
      for (size_t node = nodes.begin(); node < nodes.end(); ++node) {
        if (state_[node] != State::known) nearest_[node] = kNoTriangle;
      }
    });
    return {std::move(nearest_), std::move(off_)};
  }

 private:
  /// All triangles, each from the nodes near it; then where on its triangle each node's nearest point is.
  void measure_near() {
    for (size_t first = 0; first < triangles_.size(); first += kTrianglesAtOnce) measure_from(first);
    tbb::parallel_for(0U, size_[2], [&](uint32_t z) { find_points(z); });
  }

  /// The triangles from `first` on that are measured at once.
  void measure_from(size_t first_triangle) {
    std::vector<RowTriangle> rows(std::min(kTrianglesAtOnce, triangles_.size() - first_triangle));
    tbb::parallel_for(tbb::blocked_range<size_t>(0, rows.size(), kGrain), [&](const auto& range) {
      for (size_t k = range.begin(); k < range.end(); ++k)
        rows[k] = RowTriangle(triangles_[first_triangle + k], kNear, size_);
    });
    const uint32_t slabs = (size_[2] + kLayersAtOnce - 1) / kLayersAtOnce;
    const SlabLists lists = lists_of(rows, slabs);
    tbb::parallel_for(0U, slabs, [&](uint32_t slab) {
      const uint32_t first = slab * kLayersAtOnce, last = std::min(first + kLayersAtOnce, size_[2]);
      for (uint32_t i = lists.first[slab]; i < lists.first[slab + 1]; ++i) {
        const uint32_t k = lists.triangle[i], number = static_cast<uint32_t>(first_triangle + k);
        measure_triangle(rows[k], number, size_, first, last, square_.data(), nearest_.data());
      }
    });
  }

  /// Which triangles are near each slab of layers.
  struct SlabLists {
    std::vector<uint32_t> first, triangle;
  };
  static SlabLists lists_of(const std::vector<RowTriangle>& rows, uint32_t slabs) {
    const auto for_slabs = [&](const auto& body) {
      for (uint32_t k = 0; k < rows.size(); ++k) {
        if (rows[k].first[2] >= rows[k].last[2]) continue;
        const uint32_t last = (rows[k].last[2] - 1) / kLayersAtOnce;
        for (uint32_t slab = rows[k].first[2] / kLayersAtOnce; slab <= last; ++slab) body(slab, k);
      }
    };
    SlabLists lists{std::vector<uint32_t>(slabs + 1), {}};
    for_slabs([&](uint32_t slab, uint32_t) { ++lists.first[slab + 1]; });
    std::partial_sum(lists.first.begin(), lists.first.end(), lists.first.begin());
    lists.triangle.resize(lists.first.back());
    std::vector<uint32_t> next = lists.first;
    for_slabs([&](uint32_t slab, uint32_t k) { lists.triangle[next[slab]++] = k; });
    return lists;
  }

  void find_points(uint32_t z) {
    for (uint32_t y = 0; y < size_[1]; ++y) {
      for (uint32_t x = 0; x < size_[0]; ++x) {
        const size_t node = grid_.at(x, y, z);
        if (nearest_[node] == kNoTriangle) continue;
        if (square_[node] > kNear * kNear) {  // measured by the way, and not from what may be nearer
          nearest_[node] = kNoTriangle;
          square_[node] = std::numeric_limits<float>::max();
          continue;
        }
        off_[node] = off_triangle(nearest_[node], x, y, z);
        square_[node] = square(off_[node]);
      }
    }
  }

  [[nodiscard]] Vec3 off_triangle(uint32_t triangle, uint32_t x, uint32_t y, uint32_t z) const {
    const Vec3d p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    return to_float(closest_on_triangle(triangles_[triangle], p) - p);
  }
  static float square(const Vec3& d) { return dot(d, d); }

  /// Shell by shell, each a spacing wide: the nodes in one are the front, and those beside it take what is nearest to
  /// it.
  void spread() {
    constexpr auto kFirst = static_cast<size_t>(kNear);
    std::vector<std::vector<uint32_t>> shells(kFirst + 1);
    std::vector<uint32_t> front, touched;
    for (uint32_t node = 0; node < nearest_.size(); ++node) {
      if (nearest_[node] != kNoTriangle) put(node, kFirst, shells);
    }
    for (size_t shell = kFirst; shell < shells.size(); ++shell) {
      front.clear();
      for (const uint32_t node : shells[shell]) {
        if (state_[node] != State::unknown || shell_of(node) > shell) continue;
        state_[node] = State::front;
        front.push_back(node);
      }
      shells[shell] = {};
      touched.clear();
      for (const uint32_t node : front) {
        if (inside_[node] == 0 && square_[node] > band_) continue;
        for_beside(node, [&](uint32_t other) {
          if (state_[other] != State::unknown) return;
          state_[other] = State::touched;
          touched.push_back(other);
        });
      }
      tbb::parallel_for(tbb::blocked_range<size_t>(0, touched.size(), kGrain),
                        [&](const tbb::blocked_range<size_t>& range) {
                          for (size_t n = range.begin(); n < range.end(); ++n) take_nearest(touched[n]);
                        });
      for (const uint32_t node : front) state_[node] = State::known;
      for (const uint32_t node : touched) {
        state_[node] = State::unknown;
        put(node, shell + 1, shells);
      }
    }
  }

  [[nodiscard]] size_t shell_of(uint32_t node) const { return static_cast<size_t>(std::sqrt(square_[node])); }
  void put(uint32_t node, size_t first_shell, std::vector<std::vector<uint32_t>>& shells) const {
    const size_t shell = std::max(first_shell, shell_of(node));
    if (shell >= shells.size()) shells.resize(shell + 1);
    shells[shell].push_back(node);
  }

  /// Of the 26 nodes around, those in the front: the triangle whose point there is the nearest here.
  void take_nearest(uint32_t node) {
    const auto [x, y, z] = place_of(node);
    const bool is_within = x > 0 && x + 1 < size_[0] && y > 0 && y + 1 < size_[1] && z > 0 && z + 1 < size_[2];
    float least = std::numeric_limits<float>::max();
    uint32_t best = kNoTriangle;
    for (const Neighbor& n : around_) {
      if (!is_within && !has(x + n.x, y + n.y, z + n.z)) continue;
      const uint32_t other = node + n.nodes;
      if (state_[other] != State::front) continue;
      const float own = square(off_[other] + n.way);
      if (!(own < least)) continue;
      least = own;
      best = nearest_[other];
    }
    if (best == nearest_[node]) return;
    const Vec3 off = off_triangle(best, x, y, z);
    if (!(square(off) < square_[node])) return;
    square_[node] = square(off);
    nearest_[node] = best;
    off_[node] = off;
  }

  /// One of the 26 nodes around a node. Steps back are whole numbers that go around.
  struct Neighbor {
    uint32_t nodes, x, y, z;  ///< that it is further on
    Vec3 way;                 ///< [spacings] to it
  };
  static std::array<Neighbor, 26> neighbors_in(const std::array<uint32_t, 3>& size) {
    std::array<Neighbor, 26> around{};
    auto next = around.begin();
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (x == 0 && y == 0 && z == 0) continue;
          const auto dx = static_cast<uint32_t>(x), dy = static_cast<uint32_t>(y), dz = static_cast<uint32_t>(z);
          *next++ = {dx + size[0] * (dy + size[1] * dz),
                     dx,
                     dy,
                     dz,
                     {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}};
        }
      }
    }
    return around;
  }
  [[nodiscard]] bool has(uint32_t x, uint32_t y, uint32_t z) const {
    return x < size_[0] && y < size_[1] && z < size_[2];
  }

  [[nodiscard]] std::array<uint32_t, 3> place_of(uint32_t node) const {
    return {node % size_[0], node / size_[0] % size_[1], node / size_[0] / size_[1]};
  }
  template <class Body>
  void for_beside(uint32_t node, const Body& body) const {
    const auto [x, y, z] = place_of(node);
    const uint32_t row = size_[0], layer = row * size_[1];
    if (x > 0) body(node - 1);
    if (x + 1 < size_[0]) body(node + 1);
    if (y > 0) body(node - row);
    if (y + 1 < size_[1]) body(node + row);
    if (z > 0) body(node - layer);
    if (z + 1 < size_[2]) body(node + layer);
  }

  const NodeGrid& grid_;
  std::array<uint32_t, 3> size_;  ///< the grid's
  std::array<Neighbor, 26> around_;
  std::vector<TriangleCorners> triangles_;  ///< in spacings from the first node
  const std::vector<char>& inside_;
  float band_;                 ///< squared
  std::vector<float> square_;  ///< by node, of the distance to the nearest triangle so far
  std::vector<uint32_t> nearest_;
  std::vector<Vec3> off_;  ///< where there is a nearest triangle
  std::vector<State> state_;
};

}  // namespace

NearestPoints nearest_points(const NodeGrid& grid, std::span<const TriangleCorners> triangles,
                             const std::vector<char>& inside, double band) {
  return NearestSurface(grid, triangles, inside, band).find();
}

}  // namespace geocloth
