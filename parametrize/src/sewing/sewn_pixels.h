// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "sewing/sewing_edges.h"

namespace geocloth {

/// The pixels that runs of a mesh sew together, each pair ascending, in ascending order. Along a run every pixel of the
/// side that has fewer gets one of the other side, in their order; what the other side has more of is gathered.
/// @param mesh   with the vertices that the asset was made of
/// @param asset  with its binding
[[nodiscard]] std::vector<std::array<uint32_t, 2>> sew_pixels(std::span<const SewingRun> runs, const TriangleMesh& mesh,
                                                              const ClothAsset& asset);

}  // namespace geocloth
