// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// A pixel of a chart's outline and the vertex that it samples exactly.
struct OutlineSample {
  uint32_t x, y;    ///< pixel, relative to the chart's corner
  uint32_t vertex;  ///< vertex of the FlatSurface
};

/// A chart's rectangle in the atlas and its outline.
struct FlatChart {
  uint32_t x0 = 0, y0 = 0;             ///< [pixels] top left corner in the atlas
  uint32_t width = 0, height = 0;      ///< [pixels]
  double spacing = 0;                  ///< [m] nominal spring length of this chart: sqrt(area / cells)
  std::vector<OutlineSample> outline;  ///< counter-clockwise in uv (y up); every outline pixel once
  /// Around every hole inside, clockwise; those of layout panels only. Their pixels are outline pixels as well.
  std::vector<std::vector<OutlineSample>> holes{};
  bool is_disk = false;  ///< for want of room for the pixels of its outline, and whatever its shape
};

/// Charts in the plane, packed into one atlas. Triangles have positive area in uv, charts do not overlap.
/// The mesh is the cut surface with vertices inserted on seams and elsewhere; mates got theirs at equal places.
struct FlatSurface {
  uint32_t width = 0, height = 0;  ///< [pixels] of the atlas
  std::vector<Point3> position;    ///< per vertex [m]
  std::vector<Point2> uv;          ///< per vertex [pixels] relative to the chart's corner: u right, v DOWN (row number)
  std::vector<Triangle> triangle;  ///< counter-clockwise from outside in 3D
  std::vector<uint32_t> chart;     ///< per triangle
  std::vector<uint32_t> point;     ///< per vertex: its surface point (inserted vertices have new ones, shared by mates)
  uint32_t point_count = 0;
  std::vector<uint32_t> clean_vertex;    ///< per vertex: vertex of the clean surface, kNone if inserted
  std::vector<uint32_t> clean_triangle;  ///< per triangle: triangle of the clean surface it is part of
  std::vector<FlatChart> charts;
};

/// Of FlattenOptions::resolution.
inline constexpr uint32_t kMinResolution = 8, kMaxResolution = 4096;

struct FlattenOptions {
  Layout layout = Layout::panels;
  /// Wanted number of valid pixels in all, as the side of a square. [8, 4096] Panels may get 2 % more or fewer where
  /// that fills an image better that is not quite three quarters full.
  uint32_t resolution = 128;
  /// Spring length [m]; when set it decides the number of pixels instead of `resolution`.
  double spacing = 0;
  /// Layout panels: cuts run straight across the mesh's faces where that shortens them; false: along its edges only.
  bool straight_cuts = true;
  /// Layout panels: where further cuts would rather run; the same as for those of `cuts` that have preferences.
  CutPreferences prefer{};
};

/// Lays every component out in the plane and packs the charts.
/// Layout square: a square per component (its sides differ by a pixel at most); the outline is divided so that all runs
/// of a seam get the same whole number of pixel steps, at least as many as the welded grid needs to be a proper mesh;
/// nodes lie on pixels, cut ends never on a corner; a vertex is inserted for every outline pixel. Triangles that are
/// large beside the pixels are subdivided. The interior starts from a convex embedding with positive weights (Floater
/// 1997, 2003: no flips) and is improved for stretch without flips. Where a square cannot hold a part (long tubes) the
/// cut is extended to the vertices of greatest stretch (Gu et al. 2002, section 4).
/// Layout uv: the pieces of read_uv_pattern(clean) as they are, each scaled to metres; the surface has to be cut along
/// their seams (CutOptions::extra_edges).
/// @throws Error(limit) when the atlas would exceed kMaxImageSide, Error(unsupported) when layout uv cannot take the
///   texture coordinates, with the reason, Error(invalid_argument) when `cut` does not fit the other arguments
[[nodiscard]] FlatSurface flatten(const CleanSurface& clean, const CutSurface& cut, const FlattenOptions& options,
                                  const Progress& progress = {});

/// The same for a surface that was cut in several ways. Layout panels gives every part the one that costs least in
/// seams and distortion together; the other layouts take the first.
/// @param cuts  at least one; the first was cut without preferences
[[nodiscard]] FlatSurface flatten(const CleanSurface& clean, std::span<const CutSurface> cuts,
                                  const FlattenOptions& options, const Progress& progress = {});

}  // namespace geocloth
