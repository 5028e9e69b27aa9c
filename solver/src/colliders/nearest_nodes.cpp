// SPDX-License-Identifier: Apache-2.0
// Every triangle is measured from the nodes close by; from there on nodes take the nearest triangles of the nodes
// beside them, in the order of their distances, as in Danielsson 1980, "Euclidean distance mapping".

#include "colliders/nearest_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace geocloth {
namespace {

constexpr double kNear = 1.75;     ///< [spacings] that triangles are measured from; above the square root of 3
constexpr double kShellsEach = 2;  ///< to a spacing
constexpr size_t kGrain = 256;     ///< nodes

/// Squared distances to a triangle from some nodes in a row, without a branch.
class TriangleFromRows {
 public:
  static constexpr uint32_t kNodes = 8;
  using Squares = std::array<float, kNodes>;

  explicit TriangleFromRows(const TriangleCorners& t) : a_(t.a) {
    const std::array<Vec3d, 3> corner{t.a, t.b, t.c};
    const Vec3d n = cross(t.b - t.a, t.c - t.a);
    const double area = length(n);
    flat_ = !(area > 1e-12);
    const Vec3d unit = flat_ ? Vec3d{} : (1 / area) * n;
    normal_ = single(unit);
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d edge = corner[(k + 1) % 3] - corner[k];
      const double square = dot(edge, edge);
      edges_[k] = {single(corner[k] - t.a), single(edge), single(cross(edge, unit)),
                   square > 0 ? static_cast<float>(1 / square) : 0.F};
    }
  }

  /// From the nodes x, x + 1 ...
  [[nodiscard]] Squares squares(uint32_t x, uint32_t y, uint32_t z) const {
    const Single p = single(Vec3d{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)} - a_);
    Squares squares{};
    for (uint32_t k = 0; k < kNodes; ++k) {
      const float px = p.x + static_cast<float>(k);
      float least = std::numeric_limits<float>::max(), most_out = flat_ ? 1.F : -1.F;
      for (const Edge& e : edges_) {
        const float qx = px - e.from.x, qy = p.y - e.from.y, qz = p.z - e.from.z;
        const float along = (qx * e.way.x + qy * e.way.y + qz * e.way.z) * e.inverse;
        const float share = along < 0 ? 0 : along > 1 ? 1 : along;
        const float dx = qx - share * e.way.x, dy = qy - share * e.way.y, dz = qz - share * e.way.z;
        const float square = dx * dx + dy * dy + dz * dz;
        const float out = qx * e.out.x + qy * e.out.y + qz * e.out.z;
        least = square < least ? square : least;
        most_out = out > most_out ? out : most_out;
      }
      const float above = px * normal_.x + p.y * normal_.y + p.z * normal_.z;
      squares[k] = most_out > 0 ? least : above * above;
    }
    return squares;
  }

 private:
  struct Single {
    float x, y, z;
  };
  static Single single(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  struct Edge {
    Single from, way;
    Single out;     ///< across it, away from the triangle
    float inverse;  ///< of its length squared
  };

  Vec3d a_;
  Single normal_{};
  std::array<Edge, 3> edges_{};
  bool flat_;  ///< without an area, as a segment
};

enum class State : uint8_t { unknown, touched, front, known };

class NearestTriangles {
 public:
  NearestTriangles(const NodeGrid& grid, std::span<const TriangleCorners> triangles, const std::vector<char>& inside,
                   double band)
      : grid_(grid),
        size_(grid.size),
        inside_(inside),
        band_(static_cast<float>(band * band)),
        square_(inside.size(), std::numeric_limits<float>::max()),
        nearest_(inside.size(), kNoTriangle),
        state_(inside.size(), State::unknown) {
    const auto in_spacings = [&](const Vec3d& p) { return (1 / grid.spacing) * (p - grid.low); };
    triangles_.reserve(triangles.size());
    for (const TriangleCorners& t : triangles)
      triangles_.push_back({in_spacings(t.a), in_spacings(t.b), in_spacings(t.c)});
  }

  std::vector<uint32_t> find() {
    measure_near();
    spread();
    for (size_t node = 0; node < nearest_.size(); ++node) {
      if (state_[node] != State::known) nearest_[node] = kNoTriangle;
    }
    return std::move(nearest_);
  }

 private:
  void measure_near() {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, size_[2], kLayersAtOnce),
                      [&](const tbb::blocked_range<uint32_t>& layers) {
                        for (uint32_t k = 0; k < triangles_.size(); ++k)
                          measure_around(k, layers.begin(), layers.end());
                      });
  }

  void measure_around(uint32_t k, uint32_t first_layer, uint32_t last_layer) {
    const TriangleCorners& t = triangles_[k];
    const auto [z0, z1] = nodes_beside(t.a.z, t.b.z, t.c.z, size_[2]);
    const uint32_t first = std::max(z0, first_layer), last = std::min(z1, last_layer);
    if (first >= last) return;
    const auto [y0, y1] = nodes_beside(t.a.y, t.b.y, t.c.y, size_[1]);
    const auto [x0, x1] = nodes_beside(t.a.x, t.b.x, t.c.x, size_[0]);
    const TriangleFromRows triangle(t);
    for (uint32_t z = first; z < last; ++z) {
      for (uint32_t y = y0; y < y1; ++y) {
        for (uint32_t x = x0; x < x1; x += TriangleFromRows::kNodes) {
          const uint32_t count = std::min(TriangleFromRows::kNodes, x1 - x);
          const TriangleFromRows::Squares squares = triangle.squares(x, y, z);
          const size_t node = grid_.at(x, y, z);
          for (uint32_t i = 0; i < count; ++i) offer(node + i, k, squares[i]);
        }
      }
    }
  }

  /// The nodes first .. last - 1 along an axis that are as near as kNear to what lies between three points.
  static std::pair<uint32_t, uint32_t> nodes_beside(double a, double b, double c, uint32_t size) {
    const auto [low, high] = std::minmax({a, b, c});
    const auto node = [&](double at) { return static_cast<uint32_t>(std::clamp(at, 0.0, static_cast<double>(size))); };
    return {node(std::ceil(low - kNear)), node(std::floor(high + kNear) + 1)};
  }

  void offer(size_t node, uint32_t triangle, float square) {
    if (!(square < square_[node])) return;
    square_[node] = square;
    nearest_[node] = triangle;
  }

  /// Shell by shell: the nodes in one are the front, and those beside it take what is nearest to it.
  void spread() {
    constexpr auto kFirst = static_cast<size_t>(kShellsEach * kNear);
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

  [[nodiscard]] size_t shell_of(uint32_t node) const {
    return static_cast<size_t>(kShellsEach * std::sqrt(double{square_[node]}));
  }
  void put(uint32_t node, size_t first_shell, std::vector<std::vector<uint32_t>>& shells) const {
    const size_t shell = std::max(first_shell, shell_of(node));
    if (shell >= shells.size()) shells.resize(shell + 1);
    shells[shell].push_back(node);
  }

  /// From those of the 26 nodes around that are in the front.
  void take_nearest(uint32_t node) {
    const auto [x, y, z] = place_of(node);
    const Vec3d p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    std::array<uint32_t, 27> seen{nearest_[node]};
    auto end = seen.begin() + 1;
    const uint32_t x0 = x - (x > 0 ? 1 : 0), y0 = y - (y > 0 ? 1 : 0), z0 = z - (z > 0 ? 1 : 0);
    for (uint32_t k = z0; k < std::min(z + 2, size_[2]); ++k) {
      for (uint32_t j = y0; j < std::min(y + 2, size_[1]); ++j) {
        for (uint32_t i = x0; i < std::min(x + 2, size_[0]); ++i) {
          const size_t other = grid_.at(i, j, k);
          if (state_[other] != State::front || std::find(seen.begin(), end, nearest_[other]) != end) continue;
          *end++ = nearest_[other];
          const Vec3d d = p - closest_on_triangle(triangles_[nearest_[other]], p);
          offer(node, nearest_[other], static_cast<float>(dot(d, d)));
        }
      }
    }
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
  std::array<uint32_t, 3> size_;            ///< the grid's
  std::vector<TriangleCorners> triangles_;  ///< in spacings from the first node
  const std::vector<char>& inside_;
  float band_;                 ///< squared
  std::vector<float> square_;  ///< by node, of the distance to the nearest triangle so far
  std::vector<uint32_t> nearest_;
  std::vector<State> state_;
};

}  // namespace

std::vector<uint32_t> nearest_triangles(const NodeGrid& grid, std::span<const TriangleCorners> triangles,
                                        const std::vector<char>& inside, double band) {
  return NearestTriangles(grid, triangles, inside, band).find();
}

}  // namespace geocloth
