// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "vulkan/cloth_resources.h"
#include "vulkan/frame_plan.h"
#include "vulkan/kernel.h"

namespace geocloth::vulkan {

[[nodiscard]] TileLimits tile_limits(const Context& context);

/// Pipelines of tile.comp and tiny.comp, made when they are first needed, and what they bind besides the set that all
/// passes share.
class TileKernels {
 public:
  /// @param pass_set_layout  set 0
  /// @param contact_forces  contacts are summed
  TileKernels(std::shared_ptr<const Context> context, vk::DescriptorSetLayout pass_set_layout, bool contact_forces);

  [[nodiscard]] vk::DescriptorSetLayout set_layout() const { return *set_layout_; }

  /// Records a dispatch that is a tile's or tiny. @param points, out  sets 0 and 1
  void dispatch(const vk::raii::CommandBuffer& commands, const ClothResources& cloth, const Dispatch& dispatch,
                vk::DescriptorSet points, vk::DescriptorSet out);

 private:
  const Kernel& tile_kernel(uint32_t border, bool contacts);
  const Kernel& tiny_kernel(uint32_t pixels, bool contacts);

  std::shared_ptr<const Context> context_;
  TileLimits limits_;
  uint32_t contact_forces_;  ///< 1: contacts are summed
  vk::raii::DescriptorSetLayout set_layout_;
  vk::raii::PipelineLayout pipeline_layout_;
  /// Contacts are most of a kernel and want most registers: what meets no collider has kernels without.
  using WithContacts = bool;
  std::map<std::pair<uint32_t, WithContacts>, Kernel> tiles_;  ///< by border
  std::map<std::pair<uint32_t, WithContacts>, Kernel> tiny_;   ///< by number of points
};

/// What one frame under way needs for the tiles of one cloth: the steps, and set 1 for both directions.
class TileSets {
 public:
  TileSets(std::shared_ptr<const Context> context, vk::DescriptorSetLayout layout, const ClothResources& cloth);

  /// The commands that read the steps must not be under way.
  void write_steps(const std::vector<shader::TileStep>& steps, const ClothResources& cloth);
  /// Where a dispatch writes to that reads from the scratch images, or from the cloth's own.
  [[nodiscard]] vk::DescriptorSet out_of(bool scratch) const { return *sets_[scratch ? 0 : 1]; }

 private:
  void write_sets(const ClothResources& cloth) const;

  std::shared_ptr<const Context> context_;
  Buffer steps_;
  vk::raii::DescriptorPool pool_;              // before the sets, which are freed to it
  std::vector<vk::raii::DescriptorSet> sets_;  ///< to the cloth's own images, to the scratch images
};

}  // namespace geocloth::vulkan
