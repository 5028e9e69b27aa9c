// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// A seam as the chains of pixels along it see it.
struct SeamMeasure {
  /// Per vertex: how many steps from pixel to pixel, straight or diagonal, the longest of the seam's runs in the plane
  /// takes up to there. So every chain of pixels has as many as it needs and few more.
  std::vector<double> arc;
  std::vector<double> mark;  ///< where one of the runs turns sharply, ascending
};

/// @param uv          per vertex [m]
/// @param spacing     [m] of a pixel
/// @param seam_count  seams are numbered from 0
[[nodiscard]] std::vector<SeamMeasure> measure_seams(std::span<const Outline> outlines, std::span<const Point2> uv,
                                                     double spacing, size_t seam_count);

/// The steps that a seam takes, a whole number of them between any two marks.
[[nodiscard]] uint32_t natural_steps(const SeamMeasure& seam);

/// Where an open polygon turns sharply within a pixel or so: a corner that samples must not cut off.
/// @param polygon  [pixels]
/// @returns numbers of vertices, ascending, without the ends and two pixels apart at least
[[nodiscard]] std::vector<uint32_t> sharp_turns(std::span<const Point2> polygon);

/// Divides a seam into steps of which one ends on every mark; between marks they are equal. Marks beside which there
/// is no room for a step are passed over.
/// @returns where the steps end, from 0 to the seam's length: one more than there are steps
[[nodiscard]] std::vector<double> spread_steps(const SeamMeasure& seam, uint32_t steps);

}  // namespace geocloth
