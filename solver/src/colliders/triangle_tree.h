// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "colliders/halve.h"

namespace geocloth {

/// Finds the nearest of many triangles: a tree of boxes.
class TriangleTree {
 public:
  /// @param triangles  those without an area are left out
  explicit TriangleTree(std::span<const TriangleCorners> triangles);

  /// By number, the lowest of several; none where there is none with an area.
  [[nodiscard]] std::optional<uint32_t> nearest(const Vec3d& p) const;
  /// Of those that may be taken, by number.
  using MayTake = std::function<bool(uint32_t)>;
  [[nodiscard]] std::optional<uint32_t> nearest(const Vec3d& p, const MayTake& may_take) const;

 private:
  struct Indexed {
    TriangleCorners corners;
    uint32_t index;
    friend const TriangleCorners& corners_in(const Indexed& t) { return t.corners; }
  };

  std::vector<Indexed> triangles_;
  std::vector<BoxNode> nodes_;
};

}  // namespace geocloth
