// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

inline constexpr uint32_t kNoSeam = 0xFFFFFFFFU;    ///< a free border, or a pixel that has no copy
inline constexpr uint32_t kSeamNode = 0xFFFFFFFEU;  ///< a pixel where seams meet or end

/// An edge of a chart's outline.
struct OutlineEdge {
  uint32_t a, b;  ///< pixels, in the direction of the triangle that has the edge
  uint32_t seam;  ///< equal on all sides that are sewn together; kNoSeam on a free border
};

/// Which parts of the outlines are sewn to which: for pictures.
struct SeamLines {
  std::vector<OutlineEdge> edge;     ///< ascending by (smaller pixel, larger pixel)
  std::vector<uint32_t> pixel_seam;  ///< per pixel: its seam, kSeamNode or kNoSeam; copies agree
  std::vector<uint8_t> on_outline;   ///< per pixel: 1 where an outline edge ends
  uint32_t seam_count = 0;
};

/// A seam is a maximal run of outline edges with the same copies between nodes. Points that are tied without an edge in
/// common (a pocket's corner, a bow tie) are grouped by neighbourhood and count as seams too.
[[nodiscard]] SeamLines find_seam_lines(const ClothAsset& asset);

}  // namespace geocloth
