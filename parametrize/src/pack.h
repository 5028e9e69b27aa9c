// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Where rectangles lie in an atlas [pixels].
struct Packing {
  uint32_t width = 0, height = 0;
  std::vector<std::array<uint32_t, 2>> corner;  ///< top left, per rectangle
};

/// Packs rectangles (width, height) without turning them, one pixel apart, into a small and nearly square atlas.
/// @throws Error(limit) when the atlas would exceed kMaxImageSide
[[nodiscard]] Packing pack_rectangles(std::span<const std::array<uint32_t, 2>> size);

}  // namespace geocloth
