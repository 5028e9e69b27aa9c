// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "render/seam_lines.h"

namespace geocloth {

/// A word on a chart map and where it stands.
struct ChartLabel {
  uint32_t x, y;  ///< pixel of the asset at its middle
  uint32_t room;  ///< that many pixels around it, in every direction, belong to the same chart
  std::string text;
};

/// The number of every chart, from 1, where the chart is widest.
[[nodiscard]] std::vector<ChartLabel> chart_numbers(const ClothAsset& asset);

/// The letters of seams (A to Z, AA, AB, ...), beside the middle of each side, mates with the same; sides of fewer
/// pixels than `shortest` have none.
[[nodiscard]] std::vector<ChartLabel> seam_letters(const ClothAsset& asset, const SeamLines& lines, uint32_t shortest);

}  // namespace geocloth
