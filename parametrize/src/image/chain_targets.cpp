// SPDX-License-Identifier: GPL-3.0-or-later
// From every sample a ray is cast to the inside and one to the outside; what it meets within a pixel is the opposite
// side of a narrow place or of a slit, and both sides give way by half of what the room between them lacks.
#include "image/chain_targets.h"

#include <algorithm>
#include <cmath>

namespace geocloth {
namespace {

constexpr double kSlit = 1;  // [pixels] that the sides of a slit want between them

/// The outline's edges, sorted into squares of the lattice.
class EdgeGrid {
 public:
  explicit EdgeGrid(std::span<const Point2> sample) : sample_(sample) {
    for (const Point2& p : sample) {
      low_ = {std::min(low_[0], p[0]), std::min(low_[1], p[1])};
      high_ = {std::max(high_[0], p[0]), std::max(high_[1], p[1])};
    }
    width_ = cell(high_[0] - low_[0]) + 1;
    height_ = cell(high_[1] - low_[1]) + 1;
    for (uint32_t i = 0; i < sample.size(); ++i) {
      for_cells(sample[i], sample[(i + 1) % sample.size()], [&](uint64_t c) { entry_.emplace_back(c, i); });
    }
    std::sort(entry_.begin(), entry_.end());
  }

  /// How far the ray from sample i along a unit vector goes before it meets an edge that does not end there.
  /// @param reach  [pixels] what lies further away does not matter
  [[nodiscard]] double room(uint32_t i, const Point2& direction, double reach) const {
    const Point2& from = sample_[i];
    const Point2 to{from[0] + reach * direction[0], from[1] + reach * direction[1]};
    const auto count = static_cast<uint32_t>(sample_.size());
    double room = reach;
    for_cells(from, to, [&](uint64_t c) {
      for (auto e = std::lower_bound(entry_.begin(), entry_.end(), std::pair<uint64_t, uint32_t>(c, 0));
           e != entry_.end() && e->first == c; ++e) {
        const uint32_t k = e->second;
        if (k == i || (k + 1) % count == i) continue;
        room = std::min(room, distance_along(from, direction, sample_[k], sample_[(k + 1) % count]));
      }
    });
    return room;
  }

 private:
  static int64_t cell(double x) { return static_cast<int64_t>(std::floor(x)); }

  template <class Visit>
  void for_cells(const Point2& a, const Point2& b, const Visit& visit) const {
    const auto row = [&](double y) { return std::clamp<int64_t>(cell(y - low_[1]), 0, height_ - 1); };
    const auto column = [&](double x) { return std::clamp<int64_t>(cell(x - low_[0]), 0, width_ - 1); };
    for (int64_t y = row(std::min(a[1], b[1])); y <= row(std::max(a[1], b[1])); ++y) {
      for (int64_t x = column(std::min(a[0], b[0])); x <= column(std::max(a[0], b[0])); ++x) {
        visit(static_cast<uint64_t>(y * width_ + x));
      }
    }
  }

  /// Where the ray meets the edge a-b; infinite when it does not.
  static double distance_along(const Point2& from, const Point2& direction, const Point2& a, const Point2& b) {
    constexpr double kNever = 1e30, kSlack = 1e-9;
    // Along the ray, and to its left.
    const auto local = [&](const Point2& p) -> Point2 {
      const double x = p[0] - from[0], y = p[1] - from[1];
      return {x * direction[0] + y * direction[1], y * direction[0] - x * direction[1]};
    };
    const Point2 p = local(a), q = local(b);
    if ((p[1] > kSlack && q[1] > kSlack) || (p[1] < -kSlack && q[1] < -kSlack)) return kNever;
    const double height = q[1] - p[1];
    const double at = std::abs(height) > kSlack ? p[0] - p[1] * (q[0] - p[0]) / height : std::min(p[0], q[0]);
    return at >= -kSlack ? std::max(at, 0.0) : kNever;
  }

  std::span<const Point2> sample_;
  Point2 low_{1e30, 1e30}, high_{-1e30, -1e30};
  int64_t width_ = 0, height_ = 0;
  std::vector<std::pair<uint64_t, uint32_t>> entry_;  // square, edge
};

}  // namespace

std::vector<Point2> chain_targets(std::span<const Point2> sample, double inside) {
  const EdgeGrid edges(sample);
  const auto count = static_cast<uint32_t>(sample.size());
  std::vector<Point2> target;
  target.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    const Point2 &before = sample[(i + count - 1) % count], &after = sample[(i + 1) % count];
    const double dx = after[0] - before[0], dy = after[1] - before[1], l = std::hypot(dx, dy);
    Point2 p = sample[i];
    if (l > 0) {
      // Left of the outline's direction; v runs down.
      const Point2 inward{dy / l, -dx / l}, outward{-inward[0], -inward[1]};
      constexpr double kBeyond = 0.5;
      const double most = (edges.room(i, inward, inside + kBeyond) - inside) / 2;
      const double least = (kSlit - edges.room(i, outward, kSlit + kBeyond)) / 2;
      const double shift = least > most ? (least + most) / 2 : std::clamp(0.0, least, most);
      p = {p[0] + shift * inward[0], p[1] + shift * inward[1]};
    }
    target.push_back(p);
  }
  return target;
}

}  // namespace geocloth
