// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "cut/straight_cuts.h"
#include "develop/chart.h"

namespace geocloth {

/// What lies on both sides of a cut is one vertex of the sheet that was cut.
struct Sheet {
  std::vector<uint32_t> of_vertex;  ///< per vertex of the cut surface: its sheet vertex
  std::vector<uint8_t>
      tied;  ///< per sheet vertex: its point has other sheet vertices, so that it must stay on outlines
  std::vector<uint8_t> pinned;  ///< per sheet vertex: seams that end there do so for a reason and stay
};
[[nodiscard]] Sheet find_sheet(const CutSurface& cut);

/// The surface sewn together, with the outlines of its charts as cuts.
/// @param rings  per chart: how many vertices away its outline may go (straight_cuts.h); 0 fixes it, kNone: any number
/// @returns `clean_triangle` of the mesh holds triangles of `cut`
[[nodiscard]] std::pair<RefinedMesh, CutLines> sewn_together(const CutSurface& cut, const Sheet& sheet,
                                                             const std::vector<Chart>& charts,
                                                             const std::vector<uint32_t>& rings);

}  // namespace geocloth
