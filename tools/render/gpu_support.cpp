// SPDX-License-Identifier: GPL-3.0-or-later
// What drawing needs beyond the solver's thin wrapper: textures, layouts, graphics pipelines.
#include "render/gpu_support.h"

#include <array>

#include "vulkan/kernel.h"

namespace geocloth::render {

vulkan::Image filled_image(const ContextPtr& context, vk::Format format, vk::Extent2D extent,
                           std::span<const std::byte> bytes) {
  vulkan::Image image(context, {.format = format,
                                .extent = extent,
                                .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst});
  const vulkan::Buffer staging = filled_buffer(context, bytes, vk::BufferUsageFlagBits::eTransferSrc);
  vulkan::run_once(context, [&](const vk::raii::CommandBuffer& commands) {
    vulkan::change_layout(commands, image, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal);
    commands.copyBufferToImage(staging.handle(), image.handle(), vk::ImageLayout::eTransferDstOptimal,
                               image.whole_copy());
    vulkan::change_layout(commands, image, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eGeneral);
  });
  return image;
}

vulkan::Image texture_of(const ContextPtr& context, const Picture& picture) {
  return filled_image(context, vk::Format::eR8G8B8A8Srgb, {picture.width, picture.height}, picture.bytes());
}

vk::raii::DescriptorSetLayout make_set_layout(const ContextPtr& context, std::span<const vk::DescriptorType> bindings) {
  std::vector<vk::DescriptorSetLayoutBinding> entries;
  for (uint32_t i = 0; i < bindings.size(); ++i)
    entries.push_back({.binding = i,
                       .descriptorType = bindings[i],
                       .descriptorCount = 1,
                       .stageFlags = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment});
  return {context->device(), vk::DescriptorSetLayoutCreateInfo{.bindingCount = static_cast<uint32_t>(entries.size()),
                                                               .pBindings = entries.data()}};
}

vk::raii::Pipeline make_pipeline(const ContextPtr& context, vk::PipelineLayout layout, vk::RenderPass render_pass,
                                 const PipelineOptions& options) {
  const bool drawn = !options.fragment.empty();
  const vk::raii::ShaderModule vertex = vulkan::make_shader(*context, options.vertex);
  const vk::raii::ShaderModule fragment = drawn ? vulkan::make_shader(*context, options.fragment) : nullptr;
  const std::array stages{
      vk::PipelineShaderStageCreateInfo{.stage = vk::ShaderStageFlagBits::eVertex, .module = *vertex, .pName = "main"},
      vk::PipelineShaderStageCreateInfo{
          .stage = vk::ShaderStageFlagBits::eFragment, .module = *fragment, .pName = "main"}};
  const vk::PipelineVertexInputStateCreateInfo input{
      .vertexBindingDescriptionCount = options.attributes.empty() ? 0U : 1U,
      .pVertexBindingDescriptions = &options.vertex_binding,
      .vertexAttributeDescriptionCount = static_cast<uint32_t>(options.attributes.size()),
      .pVertexAttributeDescriptions = options.attributes.data()};
  const vk::PipelineInputAssemblyStateCreateInfo assembly{.topology = vk::PrimitiveTopology::eTriangleList};
  const vk::PipelineViewportStateCreateInfo view{.viewportCount = 1, .scissorCount = 1};
  constexpr std::array kDynamic{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  const vk::PipelineDynamicStateCreateInfo dynamic{.dynamicStateCount = static_cast<uint32_t>(kDynamic.size()),
                                                   .pDynamicStates = kDynamic.data()};
  const vk::PipelineRasterizationStateCreateInfo raster{.polygonMode = vk::PolygonMode::eFill,
                                                        .cullMode = vk::CullModeFlagBits::eNone,
                                                        .depthBiasEnable = options.depth_bias,
                                                        .depthBiasConstantFactor = 1,
                                                        .depthBiasSlopeFactor = 1.5F,
                                                        .lineWidth = 1};
  const vk::PipelineMultisampleStateCreateInfo multisample{.rasterizationSamples = options.samples,
                                                           .alphaToCoverageEnable = options.alpha_to_coverage};
  const vk::PipelineDepthStencilStateCreateInfo depth{.depthTestEnable = options.depth,
                                                      .depthWriteEnable = options.depth,
                                                      .depthCompareOp = vk::CompareOp::eLessOrEqual};
  using Mask = vk::ColorComponentFlagBits;
  const vk::PipelineColorBlendAttachmentState attachment{.blendEnable = options.blend,
                                                         .srcColorBlendFactor = vk::BlendFactor::eSrcAlpha,
                                                         .dstColorBlendFactor = vk::BlendFactor::eOneMinusSrcAlpha,
                                                         .colorBlendOp = vk::BlendOp::eAdd,
                                                         .srcAlphaBlendFactor = vk::BlendFactor::eOne,
                                                         .dstAlphaBlendFactor = vk::BlendFactor::eOneMinusSrcAlpha,
                                                         .alphaBlendOp = vk::BlendOp::eAdd,
                                                         .colorWriteMask = Mask::eR | Mask::eG | Mask::eB | Mask::eA};
  const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = drawn ? 1U : 0U, .pAttachments = &attachment};
  return {context->device(), nullptr,
          vk::GraphicsPipelineCreateInfo{.stageCount = drawn ? 2U : 1U,
                                         .pStages = stages.data(),
                                         .pVertexInputState = &input,
                                         .pInputAssemblyState = &assembly,
                                         .pViewportState = &view,
                                         .pRasterizationState = &raster,
                                         .pMultisampleState = &multisample,
                                         .pDepthStencilState = &depth,
                                         .pColorBlendState = &blend,
                                         .pDynamicState = &dynamic,
                                         .layout = layout,
                                         .renderPass = render_pass}};
}

void fill_target(const vk::raii::CommandBuffer& commands, vk::Extent2D extent) {
  commands.setViewport(0, vk::Viewport{.width = static_cast<float>(extent.width),
                                       .height = static_cast<float>(extent.height),
                                       .minDepth = 0,
                                       .maxDepth = 1});
  commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
}

}  // namespace geocloth::render
