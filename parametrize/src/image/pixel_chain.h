// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

using Pixel = std::array<int32_t, 2>;  ///< column, row (downwards)

/// Two samples of one chart whose pixels must be further apart than neighbours are.
struct ApartSamples {
  uint32_t a, b;
  int32_t least;  ///< columns and rows between their pixels, added
  bool operator==(const ApartSamples&) const = default;
  bool operator<(const ApartSamples& other) const {
    return std::tie(a, b, least) < std::tie(other.a, other.b, other.least);
  }
};

/// A closed chain of pixels, or why there is none.
struct PixelChain {
  enum class Result : uint8_t {
    found,
    too_short,  ///< the samples lie further apart than one pixel each
    crowded     ///< pixels are met twice still
  };
  Result result = Result::found;
  std::vector<Pixel> pixel;  ///< per sample
};

/// Finds a closed simple polygon of pixels with one pixel per sample, consecutive pixels being 8-neighbours, as near to
/// the targets as that goes. Since a lattice way between two places may take any number of steps from the larger to the
/// sum of its extents, chains of equal sample count fit both sides of a seam whatever their directions in the plane.
/// The polygon meets no pixel twice and crosses itself nowhere, so that its inside is a disk.
/// @param target  per sample of the outline, in order: where its pixel should lie [pixels], v down; at least three
/// @param apart   samples to keep apart
/// @param start   a chain to begin with, such as one that another `apart` gave; empty: none
[[nodiscard]] PixelChain place_chain(std::span<const Point2> target, std::span<const ApartSamples> apart = {},
                                     std::vector<Pixel> start = {});

}  // namespace geocloth
