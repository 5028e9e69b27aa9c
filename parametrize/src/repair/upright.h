// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A rotation about the origin that sets a garment upright. A default one is the identity.
class Upright {
 public:
  Upright() = default;
  /// The shortest one that turns a direction to +y.
  /// @param up  of unit length
  explicit Upright(const Point3& up);

  /// What is up before.
  [[nodiscard]] const Point3& up() const { return row_[1]; }
  [[nodiscard]] bool is_identity() const { return up() == Point3{0, 1, 0}; }
  [[nodiscard]] Point3 apply(const Point3& p) const;
  [[nodiscard]] Point3 undo(const Point3& p) const;
  [[nodiscard]] std::vector<Point3> apply(std::vector<Point3> points) const;
  [[nodiscard]] std::vector<Point3> undo(std::vector<Point3> points) const;

 private:
  std::array<Point3, 3> row_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// Finds which way is up in a garment from its shape, so that a file that lies on its side (exported with z up, or
/// turned with the figure that wears it) is laid out like one that stands: the direction that its openings face (waist,
/// hem, cuffs of trousers); where they do not agree, or there are none, the long axis whose two ends differ most.
/// @returns +y, up in a TriangleMesh, where that is it nearly, or where the shape does not tell; else the file's +z or
///   +x where that is it nearly; else the end of that line which is higher in the file
[[nodiscard]] Upright find_upright(const CleanSurface& surface);

}  // namespace geocloth
