// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "colliders/closest.h"

namespace geocloth {

/// Generalised winding numbers of triangles about points: how often they go around one, for triangles that do not close
/// in between. Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast Winding Numbers for Soups and Clouds": a tree of
/// boxes, halved at the median along the longest side, of which a branch that is far away counts as one dipole.
class WindingTree {
 public:
  /// @param triangles  at least one
  explicit WindingTree(std::vector<TriangleCorners> triangles);

  [[nodiscard]] double winding(const Vec3d& p) const;

 private:
  struct Node {
    Vec3d center, area;             ///< of the dipole: weighted by area; sum of the area vectors
    double radius = 0;              ///< about the centre
    uint32_t first = 0, count = 0;  ///< triangles of a leaf
    uint32_t left = 0, right = 0;
  };

  uint32_t build(uint32_t first, uint32_t last);
  [[nodiscard]] Node measure(uint32_t first, uint32_t last) const;

  std::vector<TriangleCorners> triangles_;
  std::vector<Node> nodes_;  ///< the root first
};

}  // namespace geocloth
