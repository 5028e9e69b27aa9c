// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// The file's texture coordinates on the corners of the clean surface (CleanSurface::uv); empty when it has none.
/// Corners that repair put inside a face or on its edge get what the face has there.
/// @param surface  complete but for `uv`
[[nodiscard]] std::vector<std::array<Point2, 3>> surface_uv(const TriangleMesh& mesh, const CleanSurface& surface);

}  // namespace geocloth
