// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "backend.h"
#include "vulkan/buffer.h"
#include "vulkan/cloth_resources.h"
#include "vulkan/commands.h"
#include "vulkan/pass_kernels.h"

namespace geocloth::vulkan {

/// What one cloth needs of the host in one frame.
struct ClothInputs {
  Buffer params, pins;
  vk::raii::DescriptorSet set = nullptr;
  vk::raii::DescriptorSet scratch_set = nullptr;  ///< the same with the scratch images, for a cloth that has them
};

/// One of the frames that may be under way: its inputs, which the host writes, its descriptor sets and its commands.
/// The buffers grow when a frame brings more than the last one.
class FrameSlot {
 public:
  FrameSlot(std::shared_ptr<const Context> context, vk::DescriptorSetLayout layout,
            const std::vector<ClothResources>& cloths);

  /// Copies a frame's inputs into the buffers; the slot's commands must not be under way.
  /// @return whether a descriptor set had to be written anew, which invalidates recorded commands
  bool write(const FrameInput& frame, const std::vector<ClothResources>& cloths);

  /// @param scratch  with the scratch images, which the cloth must have
  [[nodiscard]] vk::DescriptorSet set(size_t cloth, bool scratch = false) const {
    return scratch ? *cloths_[cloth].scratch_set : *cloths_[cloth].set;
  }
  [[nodiscard]] Commands& commands() { return commands_; }

 private:
  void write_sets(const std::vector<ClothResources>& cloths) const;
  void write_set(const ClothResources& cloth, const ClothInputs& inputs, bool scratch) const;

  std::shared_ptr<const Context> context_;
  Buffer shapes_, poses_, substeps_, numbers_;
  std::shared_ptr<const std::vector<float>> numbers_written_;  ///< what numbers_ holds
  vk::raii::DescriptorPool pool_;                              // before the sets, which are freed to it
  std::vector<ClothInputs> cloths_;
  Commands commands_;  // last: its destructor waits until nothing above is in use
};

}  // namespace geocloth::vulkan
