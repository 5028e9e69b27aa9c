// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "backend.h"
#include "vulkan/buffer.h"
#include "vulkan/image.h"

namespace geocloth::vulkan {

class Upload;

/// Points on their way between two dispatches of tiles; see shaders/cloth/tile.comp.
struct ScratchImages {
  Image position, previous, carry;
};

/// What one cloth keeps on the device, laid out as in shared/layout.h. All images are in the general layout.
struct ClothResources {
  /// Uploads and waits.
  ClothResources(const std::shared_ptr<const Context>& context, const ClothData& data, bool multipliers, bool fine,
                 SolverPath path);

  /// Replaces springs, cells, bends over seams and copies by those of the same cloth after a cut, or of another
  /// material; waits. The device must be done with the cloth.
  /// @return whether a buffer is another one now, because it has to hold more
  bool upload_topology(const std::shared_ptr<const Context>& context, const ClothData& data);

  [[nodiscard]] uint32_t pixel_count() const { return width * height; }
  [[nodiscard]] size_t memory_bytes() const;

  SolverPath path;  ///< plain, tiled or tiny
  uint32_t width, height;
  uint32_t split_rows;
  std::vector<uint32_t> seam_color_offset;
  SelfNumbers self;
  InterPart inter;            ///< of a cloth that collides with others
  SelfNumbers inter_numbers;  ///< of all of these

  Image position, previous, carry, normal;
  std::array<Image, 3> springs;
  Image cell;
  Image offset;  ///< one pixel without ClothParams::fine
  /// As long as cuts can make them: they leave fewer bends and copies, but make two rows of one that has four copies.
  Buffer multipliers, attachments, seam_springs, split_offset, split_pixel;
  Buffer measures;  ///< host-visible, kMeasureCount words
  Buffer inverse_mass;
  Buffer self_points, self_words;        ///< only with self-collision
  Buffer pin_of_pixel;                   ///< see shared/tile.h; not on the plain path
  std::optional<ScratchImages> scratch;  ///< on the tiled path

 private:
  struct Lengths;
  ClothResources(const std::shared_ptr<const Context>& context, const ClothData& data, const Lengths& lengths,
                 bool with_multipliers, bool fine, SolverPath chosen_path);
  void add_topology(Upload& upload, const ClothData& data) const;

  bool with_multipliers_;
};

}  // namespace geocloth::vulkan
