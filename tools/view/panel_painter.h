// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "render/gpu_support.h"

struct ImDrawData;

namespace geocloth::view {

/// Draws the widgets of Dear ImGui at the end of a picture's pass. One instance for each ImGui context.
class PanelPainter {
 public:
  /// Takes the fonts of the current ImGui context.
  /// @param picture_pass  of a render::PictureTarget
  PanelPainter(render::ContextPtr context, vk::RenderPass picture_pass);

  /// Copies what is to be drawn. The device must not be drawing.
  void prepare(const ImDrawData& data);
  /// Draws what was copied.
  void record(const vk::raii::CommandBuffer& commands, vk::Extent2D extent) const;

 private:
  struct Run {
    vk::Rect2D clip;
    uint32_t first_index = 0, index_count = 0;
    int32_t first_vertex = 0;
  };

  render::ContextPtr context_;
  vulkan::Image glyphs_;
  vk::raii::DescriptorSetLayout set_layout_;
  vk::raii::PipelineLayout layout_;
  vk::raii::Pipeline pipeline_;
  vk::raii::Sampler sampler_;
  vk::raii::DescriptorPool pool_;
  vk::raii::DescriptorSet set_ = nullptr;
  std::optional<vulkan::Buffer> vertices_, indices_;
  std::vector<Run> runs_;
  std::array<float, 4> corner_size_{0, 0, 1, 1};
};

}  // namespace geocloth::view
