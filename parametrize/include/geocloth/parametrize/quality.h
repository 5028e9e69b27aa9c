// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/seams.h"

namespace geocloth {

/// Measures of a geometry image. Lengths are relative to the nominal spacing or to the bounding-box diagonal, as noted.
struct Quality {
  uint32_t flipped = 0;             ///< flat triangles with area <= 0
  uint32_t mirrored = 0;            ///< charts with negative area
  uint32_t overlapping_pixels = 0;  ///< pixels claimed by more than one chart or covered twice by one
  uint32_t crossing_springs = 0;    ///< valid springs whose segment leaves its chart
  double copy_gap = 0;              ///< [m] largest distance between the copies of a point
  double l2_stretch = 0;            ///< Sander et al. 2001, area-weighted over the surface; 1 is best
  double symmetric_dirichlet = 0;   ///< mean of s1^2 + s2^2 + 1/s1^2 + 1/s2^2; 4 is best
  double anisotropy_p95 = 0;        ///< 95th area percentile of s1 / s2
  double spring_min = 0, spring_max = 0, spring_p99_over_p1 = 0;  ///< structural springs / asset.spacing
  double shear_deg_p50 = 0, shear_deg_p95 = 0;                    ///< |90 - angle between the two structural springs|
  double quad_area_p5 = 0, quad_area_p95 = 0;                     ///< whole cells / asset.spacing^2
  double rms_error = 0, max_error = 0;  ///< two-sided distance to the clean surface / bounding-box diagonal
  double psnr_db = 0;                   ///< 20 log10(1 / rms_error)
  double seam_length = 0;               ///< length of the cuts / sqrt(area)
  double binding_error = 0;             ///< largest distance of a bound vertex from its source at rest / diagonal
};

/// Measures the flat charts and the finished asset against the clean surface; definitions as in the design reference.
[[nodiscard]] Quality measure_quality(const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
                                      const ClothAsset& asset, const Progress& progress = {});

}  // namespace geocloth
