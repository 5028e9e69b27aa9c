// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// How far each part of the file is from lying flat without stretch.
[[nodiscard]] std::vector<PartShape> measure_parts(const TriangleMesh& mesh, const CleanSurface& clean,
                                                   const FlatSurface& flat);

/// Corners of the surface that no cut ends at, if most of the curvature inside of the charts is in them: else 0.
[[nodiscard]] uint32_t count_uncut_corners(const FlatSurface& flat);
/// Share of the area that is drawn as disks.
[[nodiscard]] double disk_share(const FlatSurface& flat);

/// What a user should know of a conversion that came out valid: one sentence each, with the remedy where there is one.
/// @param wanted_pixels  that the user asked for; 0: asked for a spacing
[[nodiscard]] std::vector<std::string> plain_warnings(const ConvertReport& report, const ClothAsset& asset,
                                                      double wanted_pixels);

}  // namespace geocloth
