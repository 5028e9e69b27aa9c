// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the layout; each has a file of its own.
#include "geocloth/parametrize/flatten.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "flatten/panel_layout.h"
#include "flatten/square_layout.h"
#include "flatten/uv_layout.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"
#include "mesh/uneven.h"

namespace geocloth {
namespace {

/// @param fillings  triangles of the clean surface that are no cloth: a cut surface need not have them
void check(const CleanSurface& clean, const CutSurface& cut, size_t fillings, const FlattenOptions& options) {
  if (options.resolution < kMinResolution || options.resolution > kMaxResolution) {
    throw Error(ErrorCode::invalid_argument, "resolution " + std::to_string(options.resolution) + " is not in " +
                                                 std::to_string(kMinResolution) + ".." +
                                                 std::to_string(kMaxResolution));
  }
  if (!std::isfinite(options.spacing) || options.spacing < 0) {
    throw Error(ErrorCode::invalid_argument, "the spacing must be a positive length in metres");
  }
  if (cut.triangle.size() + fillings < clean.triangle.size() || cut.clean_triangle.size() != cut.triangle.size() ||
      cut.triangle.empty()) {
    throw Error(ErrorCode::invalid_argument, "the cut surface is not that of the clean surface");
  }
}

/// Refuses a spacing that no image has room for before minutes go into laying it out.
void check_spacing(const CleanSurface& clean, double spacing) {
  double area = 0;
  for (const Triangle& t : clean.triangle) {
    area += triangle_area(clean.position[t[0]], clean.position[t[1]], clean.position[t[2]]);
  }
  const double least = std::sqrt(area) / kMaxResolution;
  if (spacing == 0 || spacing >= least) return;
  char text[256];
  std::snprintf(text, sizeof text,
                "at a spacing of %.3g m the cloth (%.3g m2) takes %.2g pixels, more than %u x %u; raise the spacing to "
                "%.3g m or more",
                spacing, area, area / (spacing * spacing), kMaxResolution, kMaxResolution, 1.005 * least);
  throw Error(ErrorCode::invalid_argument, text);
}

/// A layout that is chosen, of the surface as it is seen without its symmetries.
template <class LayOut>
FlatSurface without_symmetry(const CleanSurface& clean, std::span<const CutSurface> cuts, const LayOut& lay_out) {
  const Uneven map = uneven(clean.position, clean.triangle);
  std::vector<CutSurface> seen(cuts.begin(), cuts.end());
  for (CutSurface& cut : seen) cut.position = map.apply(cut.position);
  FlatSurface flat = lay_out(seen);
  for (size_t v = 0; v < flat.position.size(); ++v) {
    const uint32_t source = flat.clean_vertex[v];
    flat.position[v] = source != kNone ? clean.position[source] : map.undo(flat.position[v]);
  }
  return flat;
}

}  // namespace

FlatSurface flatten(const CleanSurface& clean, std::span<const CutSurface> cuts, const FlattenOptions& options,
                    const Progress& progress) {
  if (cuts.empty()) throw Error(ErrorCode::invalid_argument, "there is no cut surface to be laid out");
  const std::vector<uint32_t>& hole = cuts.front().hole;
  const auto fillings =
      static_cast<size_t>(std::count_if(hole.begin(), hole.end(), [](uint32_t h) { return h != kNone; }));
  for (const CutSurface& cut : cuts) check(clean, cut, fillings, options);
  check_spacing(clean, options.spacing);
  using Cuts = const std::vector<CutSurface>&;
  switch (options.layout) {
    case Layout::square:
      return without_symmetry(clean, cuts.first(1),
                              [&](Cuts c) { return lay_out_squares(c.front(), options, progress); });
    case Layout::panels:
      return without_symmetry(clean, cuts, [&](Cuts c) { return lay_out_panels(c, options, progress); });
    case Layout::uv:
      return lay_out_developed(take_uv(clean, cuts.front(), usable_uv_pattern(clean)), options, progress);
  }
  throw Error(ErrorCode::invalid_argument, "no such layout");
}

FlatSurface flatten(const CleanSurface& clean, const CutSurface& cut, const FlattenOptions& options,
                    const Progress& progress) {
  return flatten(clean, std::span(&cut, 1), options, progress);
}

}  // namespace geocloth
