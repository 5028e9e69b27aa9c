// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Whether a valid pixel lacks one of its eight neighbours in its chart.
[[nodiscard]] inline bool on_border(const ClothAsset& asset, uint32_t pixel) {
  const int64_t x = pixel % asset.width, y = pixel / asset.width;
  for (const int64_t ny : {y - 1, y, y + 1}) {
    for (const int64_t nx : {x - 1, x, x + 1}) {
      if (nx < 0 || ny < 0 || nx >= asset.width || ny >= asset.height) return true;
      if (asset.chart[static_cast<std::size_t>(ny * asset.width + nx)] != asset.chart[pixel]) return true;
    }
  }
  return false;
}

}  // namespace geocloth
