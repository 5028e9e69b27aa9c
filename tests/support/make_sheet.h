// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth::test {

/// A flat sheet of nx x ny surface points. Cut into charts_x x charts_y charts, every seam point is a row of the
/// split-vertex table (two copies, four where seams cross); the surface itself is the same however it is cut.
struct SheetOptions {
  uint32_t nx = 16, ny = 16;            ///< surface points, each >= 2
  float width = 1.F, height = 1.F;      ///< [m] across (u) and down (v)
  uint32_t charts_x = 1, charts_y = 1;  ///< at least one cell per chart
  uint32_t gap = 1;                     ///< empty pixels between charts
  bool horizontal = false;              ///< false: in the xy plane, facing +z; true: in the xz plane, facing +y
  Vec3 center{};                        ///< [m] centre of the sheet
  float jitter = 0.F;                   ///< interior points are moved in plane by up to this share of the spacing
};

/// Row 0 is the top edge (largest y; smallest z when horizontal). Source vertex j * nx + i is surface point (i, j); the
/// vertex groups "top", "bottom", "left", "right" and "corners" (the two upper ones) name the sheet's edges.
[[nodiscard]] ClothAsset make_sheet(const SheetOptions& options);

/// The pixel of a surface point (its first copy).
[[nodiscard]] uint32_t sheet_pixel(const SheetOptions& options, uint32_t i, uint32_t j);

/// A tube about the y axis, cut from end to end charts_x times and across charts_y - 1 times. Facing outwards; row 0 is
/// the top. Source vertex j * nx + i is surface point (i, j); the vertex group "top" names the upper ring.
struct TubeOptions {
  uint32_t nx = 24, ny = 16;            ///< points around (>= 3) and along (>= 2)
  float radius = 0.2F;                  ///< [m]
  float height = 0.5F;                  ///< [m]
  uint32_t charts_x = 1, charts_y = 1;  ///< at least two cells per chart
  Vec3 center{};                        ///< [m]
};
[[nodiscard]] ClothAsset make_tube(const TubeOptions& options);

/// The pixel of a surface point (its first copy).
[[nodiscard]] uint32_t tube_pixel(const TubeOptions& options, uint32_t i, uint32_t j);

}  // namespace geocloth::test
