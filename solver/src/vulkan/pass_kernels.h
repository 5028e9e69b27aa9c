// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pass.h"
#include "shared/layout.h"
#include "vulkan/bindings.h"
#include "vulkan/cloth_resources.h"
#include "vulkan/kernel.h"

namespace geocloth::vulkan {

/// Pipelines of the passes, each made when it is first recorded. They share one descriptor set layout (the bindings of
/// shared/layout.h) and one block of push constants, so that a pass is a pipeline, constants and a size.
class PassKernels {
 public:
  /// @param may_be_fine  ClothParams::fine may be anything but kFineOff: else the passes have no code for it, which a
  ///                     software device would go through with nothing to do
  /// @param contact_forces  contacts are summed
  PassKernels(std::shared_ptr<const Context> context, bool may_be_fine, bool contact_forces);

  [[nodiscard]] vk::DescriptorSetLayout set_layout() const { return *set_layout_; }

  /// Binds a cloth's descriptor set for the dispatches that follow.
  void bind(const vk::raii::CommandBuffer& commands, vk::DescriptorSet set) const;

  /// Records one step of a schedule. @param pins  pinned pixels of the cloth in this frame
  void dispatch(const vk::raii::CommandBuffer& commands, const ClothResources& cloth, const PassStep& step,
                uint32_t substep, uint32_t relaxation_steps, uint32_t pins) const;

  /// Writes ClothResources::inverse_mass into the w of the positions.
  void dispatch_inverse_mass(const vk::raii::CommandBuffer& commands, const ClothResources& cloth) const;

 private:
  void run(const vk::raii::CommandBuffer& commands, const Kernel& kernel, const shader::PassConstants& constants,
           uint32_t groups_x, uint32_t groups_y) const;

  std::shared_ptr<const Context> context_;
  bool may_be_fine_, contact_forces_;
  vk::raii::DescriptorSetLayout set_layout_;
  vk::raii::PipelineLayout pipeline_layout_;
  [[nodiscard]] const Kernel& kernel(Pass pass) const;
  mutable std::array<std::optional<Kernel>, kPasses.size()> kernels_;  ///< by Pass, as far as they have been needed
  Kernel inverse_mass_;
};

}  // namespace geocloth::vulkan
