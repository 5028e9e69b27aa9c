// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses the layout; each has a file of its own.
#include "geocloth/parametrize/flatten.h"

#include <cmath>
#include <string>

#include "geocloth/asset/error.h"
#include "panel_layout.h"
#include "square_layout.h"
#include "uv_layout.h"

namespace geocloth {
namespace {

constexpr uint32_t kMinResolution = 8, kMaxResolution = 4096;

void check(const CleanSurface& clean, const CutSurface& cut, const FlattenOptions& options) {
  if (options.resolution < kMinResolution || options.resolution > kMaxResolution) {
    throw Error(ErrorCode::invalid_argument, "resolution " + std::to_string(options.resolution) + " is not in " +
                                                 std::to_string(kMinResolution) + ".." +
                                                 std::to_string(kMaxResolution));
  }
  if (!std::isfinite(options.spacing) || options.spacing < 0) {
    throw Error(ErrorCode::invalid_argument, "the spacing must be a positive length in metres");
  }
  if (cut.triangle.size() < clean.triangle.size() || cut.clean_triangle.size() != cut.triangle.size() ||
      cut.triangle.empty()) {
    throw Error(ErrorCode::invalid_argument, "the cut surface is not that of the clean surface");
  }
}

}  // namespace

FlatSurface flatten(const CleanSurface& clean, const CutSurface& cut, const FlattenOptions& options,
                    const Progress& progress) {
  check(clean, cut, options);
  switch (options.layout) {
    case Layout::square:
      return lay_out_squares(cut, options, progress);
    case Layout::panels:
      return lay_out_panels(cut, options, progress);
    case Layout::uv:
      return lay_out_developed(take_uv(clean, cut, usable_uv_pattern(clean)), options, progress);
  }
  throw Error(ErrorCode::invalid_argument, "no such layout");
}

}  // namespace geocloth
