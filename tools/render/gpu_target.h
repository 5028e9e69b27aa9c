// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/gpu_support.h"

namespace geocloth::render {

/// Where a picture is drawn: four samples a pixel, resolved, for a window or to be copied to host memory.
class PictureTarget {
 public:
  PictureTarget(const ContextPtr& context, vk::Extent2D extent);

  [[nodiscard]] vk::RenderPass render_pass() const { return *render_pass_; }
  [[nodiscard]] vk::Extent2D extent() const { return extent_; }
  void begin(const vk::raii::CommandBuffer& commands) const;
  void end(const vk::raii::CommandBuffer& commands) const { commands.endRenderPass(); }
  /// After the pass: copies the picture to where picture() finds it once the commands are done.
  void record_readback(const vk::raii::CommandBuffer& commands) const;
  [[nodiscard]] Picture picture() const;
  /// What was drawn, after the pass in the layout "transfer source" and ready to be copied by the same queue.
  [[nodiscard]] const vulkan::Image& resolved() const { return resolved_; }

 private:
  vk::Extent2D extent_;
  vulkan::Image color_, depth_, resolved_;
  vk::raii::RenderPass render_pass_;
  vk::raii::Framebuffer framebuffer_;
  vulkan::Buffer pixels_;
};

/// Depths seen from the light.
class ShadowTarget {
 public:
  ShadowTarget(const ContextPtr& context, uint32_t side);

  [[nodiscard]] vk::RenderPass render_pass() const { return *render_pass_; }
  [[nodiscard]] vk::Extent2D extent() const { return depth_.extent(); }
  [[nodiscard]] vk::DescriptorImageInfo sampled() const;
  void begin(const vk::raii::CommandBuffer& commands) const;
  void end(const vk::raii::CommandBuffer& commands) const { commands.endRenderPass(); }

 private:
  vulkan::Image depth_;
  vk::raii::RenderPass render_pass_;
  vk::raii::Framebuffer framebuffer_;
  vk::raii::Sampler sampler_;
};

}  // namespace geocloth::render
