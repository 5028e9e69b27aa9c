// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geocloth/solver/solid.h"

namespace geocloth {

struct SurfaceBounds {
  Vec3 low, high;  ///< [m]
};
/// Of the corners of its triangles, of which there is at least one.
[[nodiscard]] SurfaceBounds bounds_of(const TriangleSurface& surface);

}  // namespace geocloth
