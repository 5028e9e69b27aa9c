// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A map of space that is nearly the identity and leaves no symmetry: it makes things slightly larger towards one side.
/// Lines stay lines. A default one is the identity.
struct Uneven {
  Point3 centre{0, 0, 0};  ///< [m]
  Point3 slope{0, 0, 0};   ///< [1/m]

  [[nodiscard]] Point3 apply(const Point3& p) const;
  [[nodiscard]] Point3 undo(const Point3& p) const;
  [[nodiscard]] std::vector<Point3> apply(const std::vector<Point3>& points) const;
};

/// The map for a surface, which turns, moves and grows with it: the same surface about the vertical elsewhere, in
/// another unit or in another order has the same one.
[[nodiscard]] Uneven uneven(const std::vector<Point3>& position, const std::vector<Triangle>& triangle);

}  // namespace geocloth
