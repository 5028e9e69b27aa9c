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

  /// What is turned to +y.
  [[nodiscard]] const Point3& up() const { return row_[1]; }
  [[nodiscard]] bool is_identity() const { return up() == Point3{0, 1, 0}; }
  /// Of the two ends of up and down, the one that is higher in the file (+y, else +z, else +x).
  [[nodiscard]] Point3 higher_end() const;
  [[nodiscard]] Point3 apply(const Point3& p) const;
  [[nodiscard]] Point3 undo(const Point3& p) const;
  [[nodiscard]] std::vector<Point3> apply(std::vector<Point3> points) const;
  [[nodiscard]] std::vector<Point3> undo(std::vector<Point3> points) const;

 private:
  std::array<Point3, 3> row_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// Finds up and down in a garment from its shape alone, so that a file that lies on its side (exported with z up, or
/// turned with the figure that wears it) is laid out as one that stands: the line that its openings face along (waist,
/// hem, cuffs of trousers), but for those of a part that is open in front, down to its hem, which face its sides; where
/// they do not agree, or there are none, the line of its folds, or the long axis whose two ends differ most.
/// @returns the rotation of one end of that line to +y: an end that turns with the garment, be it the upper one or not;
///   of a shape that does not tell: the identity, since +y is up in a TriangleMesh
[[nodiscard]] Upright find_upright(const CleanSurface& surface);

}  // namespace geocloth
