// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// What of a surface is the second side of cloth that was given a thickness.
struct Layers {
  std::vector<uint8_t> is_other;  ///< per triangle: 1: it is of the other side, or of the edge that joins the sides
  double thickness = 0;           ///< [m] mean over that side
  std::vector<Point3> across;     ///< [m] per point of that side: the way to the first one, about; else nothing
};
/// @returns nothing where no part of the surface has two sides
[[nodiscard]] std::optional<Layers> find_layers(const CleanSurface& surface);

/// [m] How thick the cloth is where nearly all of it has two sides, from a sample of its triangles; else nothing.
[[nodiscard]] std::optional<double> find_thickness(const CleanSurface& surface);

struct OneLayer {
  CleanSurface surface;              ///< repaired anew
  std::vector<CarriedPart> carried;  ///< the other side, for each part of the file
  std::vector<Point3> beside;        ///< per vertex of the file: where the cloth is that it is or rides on [m]
};
/// The larger side by itself.
/// @param mesh     that the surface was repaired from
/// @throws Error(invalid_argument) where there are no two sides
[[nodiscard]] OneLayer leave_one_layer(const TriangleMesh& mesh, const CleanSurface& surface,
                                       const RepairOptions& repair);

}  // namespace geocloth
