// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "backend.h"
#include "vulkan/buffer.h"
#include "vulkan/image.h"

namespace geocloth::vulkan {

/// What one cloth keeps on the device, laid out as in shared/layout.h. All images are in the general layout.
struct ClothResources {
  /// Uploads and waits.
  ClothResources(const std::shared_ptr<const Context>& context, const ClothData& data, bool multipliers, bool fine);

  [[nodiscard]] uint32_t pixel_count() const { return width * height; }
  [[nodiscard]] size_t memory_bytes() const;

  uint32_t width, height;
  uint32_t split_rows;
  std::vector<uint32_t> seam_color_offset;

  Image position, previous, carry, normal;
  std::array<Image, 3> springs;
  Image cell;
  Image offset;  ///< one pixel without ClothParams::fine
  Buffer multipliers, attachments, seam_bends, split_offset, split_pixel;
  Buffer measures;  ///< host-visible, kMeasureCount words
  Buffer inverse_mass;
};

}  // namespace geocloth::vulkan
