// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// The plane in which a garment is its own mirror image, nearly: a body's left and right sides.
struct MirrorPlane {
  Point3 normal{1, 0, 0};  ///< unit length
  double offset = 0;       ///< [m] of the plane from the origin along the normal
  double share = 0;        ///< of the surface whose mirror image lies on the surface
  double tolerance = 0;    ///< [m] how far from the surface that counts as on it

  [[nodiscard]] double height(const Point3& p) const {
    return normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2] - offset;
  }
  [[nodiscard]] Point3 image(const Point3& p) const {
    const double twice = 2 * height(p);
    return {p[0] - twice * normal[0], p[1] - twice * normal[1], p[2] - twice * normal[2]};
  }
};

/// Finds the mirror plane from the shape alone, whatever the mesh's edges. Nothing where a good part of the surface has
/// no counterpart.
[[nodiscard]] std::optional<MirrorPlane> find_mirror_plane(std::span<const Point3> position,
                                                           std::span<const Triangle> triangle);

}  // namespace geocloth
