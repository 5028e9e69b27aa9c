// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "render/picture.h"
#include "vulkan/buffer.h"
#include "vulkan/commands.h"
#include "vulkan/context.h"
#include "vulkan/image.h"

namespace geocloth::render {

using ContextPtr = std::shared_ptr<const vulkan::Context>;

/// A buffer that holds the given values and that the device only reads.
template <typename T>
[[nodiscard]] vulkan::Buffer filled_buffer(const ContextPtr& context, std::span<const T> values,
                                           vk::BufferUsageFlags usage) {
  vulkan::Buffer buffer(context, values.size_bytes(), usage, vulkan::Memory::upload);
  if (!values.empty()) std::memcpy(buffer.mapped().data(), values.data(), values.size_bytes());
  return buffer;
}

/// An image in the layout "general" that the device samples, filled from host memory.
[[nodiscard]] vulkan::Image filled_image(const ContextPtr& context, vk::Format format, vk::Extent2D extent,
                                         std::span<const std::byte> bytes);

/// A picture as an sRGB texture.
[[nodiscard]] vulkan::Image texture_of(const ContextPtr& context, const Picture& picture);

/// A descriptor set layout whose binding i is bindings[i], for vertex and fragment stage.
[[nodiscard]] vk::raii::DescriptorSetLayout make_set_layout(const ContextPtr& context,
                                                            std::span<const vk::DescriptorType> bindings);

/// What a graphics pipeline of this renderer can differ in. Viewport and scissor are set by the target (fill_target),
/// so that pipelines outlive a target of another size.
struct PipelineOptions {
  std::span<const uint32_t> vertex, fragment;  ///< SPIR-V; no fragment stage when empty
  vk::VertexInputBindingDescription vertex_binding;
  std::span<const vk::VertexInputAttributeDescription> attributes;
  vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e4;
  bool depth = true;        ///< test and write
  bool depth_bias = false;  ///< push away from the light, for shadow maps
  bool alpha_to_coverage = false;
  bool blend = false;  ///< over what is there, by alpha, which is not multiplied in yet
};
[[nodiscard]] vk::raii::Pipeline make_pipeline(const ContextPtr& context, vk::PipelineLayout layout,
                                               vk::RenderPass render_pass, const PipelineOptions& options);

/// Sets viewport and scissor to all of a target.
void fill_target(const vk::raii::CommandBuffer& commands, vk::Extent2D extent);

}  // namespace geocloth::render
