// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "backend.h"
#include "vulkan/buffer.h"
#include "vulkan/cloth_resources.h"
#include "vulkan/commands.h"
#include "vulkan/inter_resources.h"
#include "vulkan/pass_kernels.h"

namespace geocloth::vulkan {

/// What one cloth needs of the host in one frame.
struct ClothInputs {
  Buffer params, pins;
  vk::raii::DescriptorSet set = nullptr;
  vk::raii::DescriptorSet scratch_set = nullptr;  ///< the same with the scratch images, for a cloth that has them
  vk::raii::DescriptorSet inter_set = nullptr;    ///< the same with the points of all cloths that collide with it
  Buffer contacts, contacts_read;  ///< what its contacts are summed in, and where the host reads them when it is done
};

/// One of the frames that may be under way: its inputs, which the host writes, its descriptor sets and its commands.
/// The buffers grow when a frame brings more than the last one.
class FrameSlot {
 public:
  /// @param inter  of the cloths that collide with each other; null for none
  /// @param contact_forces  contacts are summed
  FrameSlot(std::shared_ptr<const Context> context, vk::DescriptorSetLayout layout,
            const std::vector<ClothResources>& cloths, const InterResources* inter, bool contact_forces);

  /// Copies a frame's inputs into the buffers; the slot's commands must not be under way.
  /// @return whether a descriptor set had to be written anew, which invalidates recorded commands
  bool write(const FrameInput& frame, const std::vector<ClothResources>& cloths);

  /// @param scratch  with the scratch images, which the cloth must have
  [[nodiscard]] vk::DescriptorSet set(size_t cloth, bool scratch = false) const {
    return scratch ? *cloths_[cloth].scratch_set : *cloths_[cloth].set;
  }
  /// For the passes inter_gather and inter_move.
  [[nodiscard]] vk::DescriptorSet inter_set(size_t cloth) const { return *cloths_[cloth].inter_set; }
  /// For the passes between cloths.
  [[nodiscard]] vk::DescriptorSet between_set() const { return *between_set_; }
  [[nodiscard]] Commands& commands() { return commands_; }

  /// Before a cloth's passes and after them; there has to be a barrier between these and the passes.
  void clear_contacts(const vk::raii::CommandBuffer& commands, size_t cloth) const;
  void copy_contacts(const vk::raii::CommandBuffer& commands, size_t cloth) const;
  /// Of the first so many colliders, once the commands are done.
  void read_contacts(size_t cloth, uint32_t colliders, std::vector<ContactSum>& out) const;

 private:
  /// What of a set differs from a cloth's own one.
  struct Others {
    const ScratchImages* scratch = nullptr;
    const InterResources* inter = nullptr;
    const Buffer* params = nullptr;
  };
  [[nodiscard]] bool make_room(ClothInputs& inputs, uint32_t colliders);
  void write_sets(const std::vector<ClothResources>& cloths) const;
  void write_set(vk::DescriptorSet set, const ClothResources& cloth, const ClothInputs& inputs,
                 const Others& others) const;

  std::shared_ptr<const Context> context_;
  Buffer shapes_, poses_, substeps_, numbers_;
  std::shared_ptr<const std::vector<float>> numbers_written_;  ///< what numbers_ holds
  vk::raii::DescriptorPool pool_;                              // before the sets, which are freed to it
  std::vector<ClothInputs> cloths_;
  const InterResources* inter_;
  bool contact_forces_;
  vk::raii::DescriptorSet between_set_ = nullptr;
  Commands commands_;  // last: its destructor waits until nothing above is in use
};

}  // namespace geocloth::vulkan
