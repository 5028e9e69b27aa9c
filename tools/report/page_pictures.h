// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// A picture of the page.
struct PagePicture {
  std::string title, caption;
  std::string alt;  ///< what it shows, for who cannot see it
  uint32_t width = 0, height = 0;
  std::vector<std::byte> png;
  bool wide = false;  ///< takes the page's whole width
};

struct PagePictures {
  std::vector<PagePicture> pictures;
  std::string note;  ///< why there is no picture of the garment itself; empty when there is
};

/// The garment from the front and the back with its seams, the chart map, distortion, the geometry image.
/// Where no Vulkan device can draw, the first two are missing and `note` says so.
[[nodiscard]] PagePictures draw_page_pictures(const std::shared_ptr<const ClothAsset>& asset);

}  // namespace geocloth
