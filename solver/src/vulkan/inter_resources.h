// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "backend.h"
#include "vulkan/buffer.h"

namespace geocloth::vulkan {

/// What the cloths that collide with each other keep on the device together, laid out as in lib/self_words.h.
struct InterResources {
  /// Uploads and waits.
  InterResources(const std::shared_ptr<const Context>& context, const InterData& data);

  /// Whether these are the same cloths, in no more pieces than there is room for.
  [[nodiscard]] bool has_room_for(const InterData& data) const;
  /// Replaces all of it after a cut; waits. The device must be done with the cloths.
  void upload(const std::shared_ptr<const Context>& context, const InterData& data);

  [[nodiscard]] size_t memory_bytes() const { return points.size() + words.size() + params.size(); }

  SelfNumbers numbers;
  std::vector<InterPart> parts;
  Buffer points, words;
  Buffer params;  ///< ClothParams for the passes between cloths
};

}  // namespace geocloth::vulkan
