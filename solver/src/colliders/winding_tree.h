// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "colliders/halve.h"

namespace geocloth {

/// Generalised winding numbers of triangles about points: how often they go around one, for triangles that do not close
/// in between. Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast Winding Numbers for Soups and Clouds": a tree,
/// of which a branch that is far away counts as one dipole.
class WindingTree {
 public:
  /// @param triangles  at least one
  explicit WindingTree(std::vector<TriangleCorners> triangles);

  [[nodiscard]] double winding(const Vec3d& p) const;

 private:
  struct Node : HalvedNode {
    Vec3d center, area;  ///< of the dipole: weighted by area; sum of the area vectors
    double radius = 0;   ///< about the centre
  };
  static Node measure(std::span<const TriangleCorners> triangles);

  std::vector<TriangleCorners> triangles_;
  std::vector<Node> nodes_;  ///< the root first
};

}  // namespace geocloth
