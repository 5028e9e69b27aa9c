// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Samples the charts at the pixels: rest positions, chart numbers, and for every valid pixel the flat triangle it
/// lies in. Outline pixels take their vertex's position bit for bit.
struct Raster {
  uint32_t width = 0, height = 0;
  std::vector<Point3> position;       ///< per pixel [m]
  std::vector<uint16_t> chart;        ///< per pixel, kNoChart where not valid
  std::vector<uint32_t> triangle;     ///< per pixel: flat triangle it samples, kNone where not valid
  std::vector<uint32_t> point;        ///< per pixel: surface point for outline pixels, kNone otherwise
  std::vector<uint32_t> vertex;       ///< per pixel: flat vertex for outline pixels, kNone otherwise
  std::vector<Point2> place;          ///< per pixel: where it samples its chart's plane [pixels], relative to the chart
  std::vector<uint32_t> overlapping;  ///< pixels claimed by more than one chart or covered twice by one, ascending
};

/// A pixel is valid when it is an outline sample or lies inside the closed polygon of its chart's outline samples. It
/// samples the plane at itself, or beside outline samples that stand off the lattice a little to the side (see
/// sampling_places). Where several triangles cover a pixel, the first is taken and the pixel counts as overlapping.
/// @throws Error(limit) when there are too many charts, Error(invalid_argument) when a chart leaves the atlas
[[nodiscard]] Raster rasterize(const FlatSurface& flat, const Progress& progress = {});

}  // namespace geocloth
