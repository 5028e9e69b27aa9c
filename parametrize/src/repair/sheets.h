// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"
#include "repair/soup.h"

namespace geocloth {

/// What make_manifold did.
struct SheetRepairs {
  uint64_t detached_sheets = 0;  ///< faces at edges with more than two, beyond the two that stay joined
  uint64_t torn_edges = 0;       ///< edges opened because the sheet could not be oriented, or touched itself
  uint64_t bow_ties = 0;         ///< vertices added where only a point held sheets together
  uint64_t flipped_faces = 0;    ///< faces that now run the other way round than in the file
};

/// Makes a complex of proper triangles into sheets that are manifold and oriented, tied by their points.
/// @param soup  every triangle over three different points, no two over the same three
/// @param part  per triangle of the file: something that tells parts apart (the same pair of numbers: same part)
[[nodiscard]] CleanSurface make_manifold(const Soup& soup, const std::vector<std::array<uint32_t, 2>>& part,
                                         SheetRepairs& repairs);

}  // namespace geocloth
