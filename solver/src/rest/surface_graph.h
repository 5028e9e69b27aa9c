// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/asset/grid_mesh.h"

namespace geocloth {

/// Whether points that are to be sewn together count as one: they do not as long as they are apart.
enum class Sewn : bool { no, yes };

/// Neighbours for distances along the surface: grid edges, diagonals and knight's moves, within the springs' validity.
class SurfaceGraph {
 public:
  /// Keeps the reference.
  /// @param shares  of each pixel, by which lengths about it count; none: 1
  SurfaceGraph(const ClothAsset& asset, float scale, std::span<const float> shares = {}, Sewn sewn = Sewn::no)
      : asset_(asset), scale_(scale), shares_(shares), row_of_(split_rows(asset)) {
    if (sewn == Sewn::no) return;
    for (const auto& [a, b] : asset.sewing) {
      sewn_to_.emplace(a, b);
      sewn_to_.emplace(b, a);
    }
  }

  /// Calls visit(neighbour, length) for all neighbours of a pixel.
  template <class Visit>
  void for_neighbors(uint32_t p, const Visit& visit) const {
    if (const uint32_t row = row_of_[p]; row != kNoPixel) {
      for (const uint32_t copy : asset_.splits.copies(row))
        if (copy != p) visit(copy, 0.0);
    }
    const auto [first, last] = sewn_to_.equal_range(p);
    for (auto it = first; it != last; ++it) visit(it->second, 0.0);
    for (int32_t dy = -1; dy <= 1; ++dy)
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const uint32_t near = step(p, dx, dy);
        if (near == kNoPixel || near == p) continue;
        visit(near, distance(p, near));
        if (dx == 0 || dy == 0) continue;
        for (const auto& [ex, ey] :
             {std::pair{dx, 0}, std::pair{0, dy}})  // diagonal, then straight on: a knight's move
          if (const uint32_t far = step(near, ex, ey); far != kNoPixel) visit(far, distance(p, far));
      }
  }

 private:
  /// The pixel one king's move away if a spring leads there.
  [[nodiscard]] uint32_t step(uint32_t p, int32_t dx, int32_t dy) const {
    if (dx == 0 && dy == 0) return p;
    const int64_t x = static_cast<int64_t>(p % asset_.width) + dx, y = static_cast<int64_t>(p / asset_.width) + dy;
    if (x < 0 || y < 0 || x >= asset_.width || y >= asset_.height) return kNoPixel;
    const auto q = static_cast<uint32_t>(y * asset_.width + x);
    const bool forward = dy > 0 || (dy == 0 && dx > 0);
    const int32_t fx = forward ? dx : -dx, fy = forward ? dy : -dy;
    const uint8_t bit = fy == 0 ? kSpringRight : fx == 0 ? kSpringDown : fx > 0 ? kSpringDownRight : kSpringDownLeft;
    return asset_.spring_mask[forward ? p : q] & bit ? q : kNoPixel;
  }

  [[nodiscard]] double distance(uint32_t a, uint32_t b) const {
    const double share = shares_.empty() ? 1 : 0.5 * (double{shares_[a]} + double{shares_[b]});
    return share * static_cast<double>(scale_) *
           static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
  }

  const ClothAsset& asset_;
  float scale_;
  std::span<const float> shares_;
  std::vector<uint32_t> row_of_;
  std::multimap<uint32_t, uint32_t> sewn_to_;
};

/// Goes outwards from some pixels, which the caller knows at the distance 0, nearest first (Dijkstra 1959).
/// @param distance_of  distance_of(pixel) [m] as it is known so far
/// @param reach        reach(from, pixel, distance [m], step [m]): whether the pixel is to be reached and was not known
///   as near; the caller then knows it at that distance
template <class DistanceOf, class Reach>
void spread(const SurfaceGraph& graph, std::span<const uint32_t> sources, const DistanceOf& distance_of,
            const Reach& reach) {
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const uint32_t p : sources) queue.emplace(0.0, p);
  while (!queue.empty()) {
    const auto [d, p] = queue.top();
    queue.pop();
    if (d > distance_of(p)) continue;
    graph.for_neighbors(p, [&, from = p, distance = d](uint32_t q, double step) {
      if (reach(from, q, distance + step, step)) queue.emplace(distance + step, q);
    });
  }
}

}  // namespace geocloth
