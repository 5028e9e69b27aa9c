// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "develop/part_panels.h"
#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// Disks laid out in the plane, each nearly isometric and free of flips and of self-overlap.
struct DevelopedSurface {
  CutSurface cut;  ///< the cut surface, its cuts extended and its charts split where that was needed
  std::vector<Point2>
      uv;  ///< per vertex of `cut` [m]: x right, y up, triangles counter-clockwise; charts overlap each other
  std::vector<double> energy;  ///< per component: area-weighted symmetric Dirichlet energy reached; 4 is isometric
};

struct DevelopOptions {
  double target_energy = 4.02;        ///< cuts are extended until a chart's energy is below
  double cut_price = 0.025;           ///< least fall of the energy per length / sqrt(area) that a cut must bring
  double least_cut = 0;               ///< [m] shorter extensions are not made
  uint32_t max_cuts_per_chart = 200;  ///< bound on extensions and splits of one part
  CutPreferences prefer{};            ///< where cuts would rather run
  PartingOptions parting{};           ///< of charts that waste room in the image
  bool straight_cuts = true;          ///< cuts leave the mesh's edges where that shortens them
};

/// Parts of more triangles are laid out from the first cuts only: time grows with every other way.
constexpr size_t kMostWithWishes = 15'000;

/// Lays every disk of a cut surface out in the plane: Tutte's embedding (Tutte 1963; Floater 1997) on a circle, then
/// the symmetric Dirichlet energy with a free border. Where that stays above the target, a path from the worst place to
/// the outline is cut open (the idea of Gu, Gortler, Hoppe 2002, section 4, and of OptCuts, Li et al. 2018: a cut must
/// pay for its length); where an outline crosses itself the chart is split. Every chart is turned so that the surface's
/// upward direction (+y in space) is up in the plane, by its area mean; a level chart's long side is.
[[nodiscard]] DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options = {},
                                       const Progress& progress = {});

/// The same of a surface that was cut in several ways: every part takes the one that costs least in the end.
/// @param cuts  at least one; the first without preferences, the others with those of the options
[[nodiscard]] DevelopedSurface develop(std::span<const CutSurface> cuts, const DevelopOptions& options = {},
                                       const Progress& progress = {});

}  // namespace geocloth
