// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "develop/develop.h"
#include "geocloth/parametrize/uv.h"

namespace geocloth {

/// read_uv_pattern, when the pieces can be laid out.
/// @throws Error(unsupported) with the reason and the remedy when they cannot
[[nodiscard]] UvPattern usable_uv_pattern(const CleanSurface& clean);

/// The garment's own texture coordinates as flat charts: every piece scaled to metres by itself, face up, the image's
/// upward direction up, otherwise as it is. Triangles that a file's rounding has flipped are evened out with
/// those around them; where that does not help, the piece is flattened anew and laid over its place.
/// @param cut  the clean surface cut along the pattern's seams
/// @throws Error(unsupported) when a piece overlaps itself, Error(invalid_argument) when the
///   surface was cut otherwise
[[nodiscard]] DevelopedSurface take_uv(const CleanSurface& clean, const CutSurface& cut, const UvPattern& pattern);

}  // namespace geocloth
