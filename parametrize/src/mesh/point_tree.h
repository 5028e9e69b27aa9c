// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Points in a balanced tree of boxes, to be asked for those near a segment.
class PointTree {
 public:
  /// @param points  those of `position` that are in the tree; `position` has to outlive it
  PointTree(const std::vector<Point3>& position, std::vector<uint32_t> points)
      : position_(position), points_(std::move(points)) {
    if (!points_.empty()) build(0, points_.size());
  }

  /// Calls visit(point) for every point within reach of the segment, and for some that are a little further.
  template <typename Visit>
  void near_segment(const Point3& a, const Point3& b, double reach, Visit&& visit) const {
    if (!box_.empty()) descend(0, 0, points_.size(), a, b, reach, visit);
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Box {
    Point3 low, high;
    std::size_t right = 0;  ///< number of the second child; the first follows its parent
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    const std::size_t self = box_.size();
    Box box{position_[points_[begin]], position_[points_[begin]], 0};
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], position_[points_[i]][k]);
        box.high[k] = std::max(box.high[k], position_[points_[i]][k]);
      }
    }
    box_.push_back(box);
    if (end - begin <= kLeaf) return self;
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
    }
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t middle = begin + (end - begin) / 2;
    std::nth_element(at(begin), at(middle), at(end), [&](uint32_t i, uint32_t j) {
      return position_[i][axis] != position_[j][axis] ? position_[i][axis] < position_[j][axis] : i < j;
    });
    build(begin, middle);
    const std::size_t right = build(middle, end);
    box_[self].right = right;
    return self;
  }

  /// Whether the segment comes within reach of the box, by slabs; may say yes a little too often.
  static bool meets(const Box& box, const Point3& a, const Point3& b, double reach) {
    double from = 0, to = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = box.low[k] - reach - a[k], high = box.high[k] + reach - a[k], d = b[k] - a[k];
      if (d == 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      from = std::max(from, std::min(low / d, high / d));
      to = std::min(to, std::max(low / d, high / d));
    }
    return from <= to;
  }

  template <typename Visit>
  void descend(std::size_t node, std::size_t begin, std::size_t end, const Point3& a, const Point3& b, double reach,
               Visit&& visit) const {
    if (!meets(box_[node], a, b, reach)) return;
    if (end - begin <= kLeaf) {
      for (std::size_t i = begin; i < end; ++i) visit(points_[i]);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    descend(node + 1, begin, middle, a, b, reach, visit);
    descend(box_[node].right, middle, end, a, b, reach, visit);
  }

  const std::vector<Point3>& position_;
  std::vector<uint32_t> points_;
  std::vector<Box> box_;
};

}  // namespace geocloth
