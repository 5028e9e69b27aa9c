// SPDX-License-Identifier: GPL-3.0-or-later
// Render passes of Vulkan 1.1, with the dependencies that order a picture after the one before it and its copy after
// it.
#include "render/gpu_target.h"

#include <array>

namespace geocloth::render {
namespace {

using Access = vk::AccessFlagBits;
using Aspect = vk::ImageAspectFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;
using Usage = vk::ImageUsageFlagBits;

constexpr vk::Format kColorFormat = vk::Format::eR8G8B8A8Srgb, kDepthFormat = vk::Format::eD32Sfloat;
constexpr vk::SampleCountFlagBits kSamples = vk::SampleCountFlagBits::e4;  // every device has it

vk::raii::RenderPass picture_pass(const ContextPtr& context) {
  const std::array attachments{
      vk::AttachmentDescription{.format = kColorFormat,
                                .samples = kSamples,
                                .loadOp = vk::AttachmentLoadOp::eDontCare,  // the background covers all of it
                                .storeOp = vk::AttachmentStoreOp::eDontCare,
                                .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                .initialLayout = Layout::eUndefined,
                                .finalLayout = Layout::eColorAttachmentOptimal},
      vk::AttachmentDescription{.format = kDepthFormat,
                                .samples = kSamples,
                                .loadOp = vk::AttachmentLoadOp::eClear,
                                .storeOp = vk::AttachmentStoreOp::eDontCare,
                                .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                .initialLayout = Layout::eUndefined,
                                .finalLayout = Layout::eDepthStencilAttachmentOptimal},
      vk::AttachmentDescription{.format = kColorFormat,
                                .samples = vk::SampleCountFlagBits::e1,
                                .loadOp = vk::AttachmentLoadOp::eDontCare,
                                .storeOp = vk::AttachmentStoreOp::eStore,
                                .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                .initialLayout = Layout::eUndefined,
                                .finalLayout = Layout::eTransferSrcOptimal}};
  const vk::AttachmentReference color{0, Layout::eColorAttachmentOptimal};
  const vk::AttachmentReference depth{1, Layout::eDepthStencilAttachmentOptimal};
  const vk::AttachmentReference resolve{2, Layout::eColorAttachmentOptimal};
  const vk::SubpassDescription subpass{.pipelineBindPoint = vk::PipelineBindPoint::eGraphics,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments = &color,
                                       .pResolveAttachments = &resolve,
                                       .pDepthStencilAttachment = &depth};
  const std::array dependencies{
      vk::SubpassDependency{
          .srcSubpass = VK_SUBPASS_EXTERNAL,
          .dstSubpass = 0,
          .srcStageMask = Stage::eColorAttachmentOutput | Stage::eLateFragmentTests | Stage::eTransfer,
          .dstStageMask = Stage::eColorAttachmentOutput | Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
          .srcAccessMask = Access::eColorAttachmentWrite | Access::eDepthStencilAttachmentWrite,
          .dstAccessMask = Access::eColorAttachmentWrite | Access::eColorAttachmentRead |
                           Access::eDepthStencilAttachmentWrite | Access::eDepthStencilAttachmentRead},
      vk::SubpassDependency{.srcSubpass = 0,
                            .dstSubpass = VK_SUBPASS_EXTERNAL,
                            .srcStageMask = Stage::eColorAttachmentOutput,
                            .dstStageMask = Stage::eTransfer,
                            .srcAccessMask = Access::eColorAttachmentWrite,
                            .dstAccessMask = Access::eTransferRead}};
  return {context->device(), vk::RenderPassCreateInfo{.attachmentCount = static_cast<uint32_t>(attachments.size()),
                                                      .pAttachments = attachments.data(),
                                                      .subpassCount = 1,
                                                      .pSubpasses = &subpass,
                                                      .dependencyCount = static_cast<uint32_t>(dependencies.size()),
                                                      .pDependencies = dependencies.data()}};
}

vk::raii::RenderPass shadow_pass(const ContextPtr& context) {
  const vk::AttachmentDescription attachment{.format = kDepthFormat,
                                             .samples = vk::SampleCountFlagBits::e1,
                                             .loadOp = vk::AttachmentLoadOp::eClear,
                                             .storeOp = vk::AttachmentStoreOp::eStore,
                                             .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                             .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                             .initialLayout = Layout::eUndefined,
                                             .finalLayout = Layout::eDepthStencilReadOnlyOptimal};
  const vk::AttachmentReference depth{0, Layout::eDepthStencilAttachmentOptimal};
  const vk::SubpassDescription subpass{.pipelineBindPoint = vk::PipelineBindPoint::eGraphics,
                                       .pDepthStencilAttachment = &depth};
  const std::array dependencies{
      vk::SubpassDependency{
          .srcSubpass = VK_SUBPASS_EXTERNAL,
          .dstSubpass = 0,
          .srcStageMask = Stage::eFragmentShader,
          .dstStageMask = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
          .srcAccessMask = {},
          .dstAccessMask = Access::eDepthStencilAttachmentWrite | Access::eDepthStencilAttachmentRead},
      vk::SubpassDependency{.srcSubpass = 0,
                            .dstSubpass = VK_SUBPASS_EXTERNAL,
                            .srcStageMask = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
                            .dstStageMask = Stage::eFragmentShader,
                            .srcAccessMask = Access::eDepthStencilAttachmentWrite,
                            .dstAccessMask = Access::eShaderRead}};
  return {context->device(), vk::RenderPassCreateInfo{.attachmentCount = 1,
                                                      .pAttachments = &attachment,
                                                      .subpassCount = 1,
                                                      .pSubpasses = &subpass,
                                                      .dependencyCount = static_cast<uint32_t>(dependencies.size()),
                                                      .pDependencies = dependencies.data()}};
}

vk::raii::Framebuffer make_framebuffer(const ContextPtr& context, vk::RenderPass render_pass, vk::Extent2D extent,
                                       std::span<const vk::ImageView> views) {
  return {context->device(), vk::FramebufferCreateInfo{.renderPass = render_pass,
                                                       .attachmentCount = static_cast<uint32_t>(views.size()),
                                                       .pAttachments = views.data(),
                                                       .width = extent.width,
                                                       .height = extent.height,
                                                       .layers = 1}};
}

/// Linear filtering of comparisons is softer, but not every device filters depths.
vk::raii::Sampler shadow_sampler(const ContextPtr& context) {
  const auto features = context->physical_device().getFormatProperties(kDepthFormat).optimalTilingFeatures;
  const bool smooth = static_cast<bool>(features & vk::FormatFeatureFlagBits::eSampledImageFilterLinear);
  const vk::Filter filter = smooth ? vk::Filter::eLinear : vk::Filter::eNearest;
  return {context->device(), vk::SamplerCreateInfo{.magFilter = filter,
                                                   .minFilter = filter,
                                                   .addressModeU = vk::SamplerAddressMode::eClampToEdge,
                                                   .addressModeV = vk::SamplerAddressMode::eClampToEdge,
                                                   .addressModeW = vk::SamplerAddressMode::eClampToEdge,
                                                   .compareEnable = VK_TRUE,
                                                   .compareOp = vk::CompareOp::eLessOrEqual}};
}

}  // namespace

PictureTarget::PictureTarget(const ContextPtr& context, vk::Extent2D extent)
    : extent_(extent),
      color_(context, {.format = kColorFormat,
                       .extent = extent,
                       .usage = Usage::eColorAttachment | Usage::eTransientAttachment,
                       .samples = kSamples}),
      depth_(context, {.format = kDepthFormat,
                       .extent = extent,
                       .usage = Usage::eDepthStencilAttachment | Usage::eTransientAttachment,
                       .aspect = Aspect::eDepth,
                       .samples = kSamples}),
      resolved_(context,
                {.format = kColorFormat, .extent = extent, .usage = Usage::eColorAttachment | Usage::eTransferSrc}),
      render_pass_(picture_pass(context)),
      framebuffer_(
          make_framebuffer(context, *render_pass_, extent, std::array{color_.view(), depth_.view(), resolved_.view()})),
      pixels_(context, vk::DeviceSize{4} * extent.width * extent.height, vk::BufferUsageFlagBits::eTransferDst,
              vulkan::Memory::readback) {}

void PictureTarget::begin(const vk::raii::CommandBuffer& commands) const {
  const std::array<vk::ClearValue, 2> clear{vk::ClearValue{}, vk::ClearValue{vk::ClearDepthStencilValue{.depth = 1}}};
  commands.beginRenderPass({.renderPass = *render_pass_,
                            .framebuffer = *framebuffer_,
                            .renderArea = {{0, 0}, extent_},
                            .clearValueCount = static_cast<uint32_t>(clear.size()),
                            .pClearValues = clear.data()},
                           vk::SubpassContents::eInline);
  fill_target(commands, extent_);
}

void PictureTarget::record_readback(const vk::raii::CommandBuffer& commands) const {
  commands.copyImageToBuffer(resolved_.handle(), Layout::eTransferSrcOptimal, pixels_.handle(), resolved_.whole_copy());
  vulkan::memory_barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
}

Picture PictureTarget::picture() const {
  Picture picture(extent_.width, extent_.height);
  std::memcpy(picture.pixel.data(), pixels_.mapped().data(), picture.bytes().size());
  for (Color& color : picture.pixel) color.a = 255;  // coverage is in the colours by now
  return picture;
}

ShadowTarget::ShadowTarget(const ContextPtr& context, uint32_t side)
    : depth_(context, {.format = kDepthFormat,
                       .extent = {side, side},
                       .usage = Usage::eDepthStencilAttachment | Usage::eSampled,
                       .aspect = Aspect::eDepth}),
      render_pass_(shadow_pass(context)),
      framebuffer_(make_framebuffer(context, *render_pass_, depth_.extent(), std::array{depth_.view()})),
      sampler_(shadow_sampler(context)) {}

vk::DescriptorImageInfo ShadowTarget::sampled() const {
  return {.sampler = *sampler_, .imageView = depth_.view(), .imageLayout = Layout::eDepthStencilReadOnlyOptimal};
}

void ShadowTarget::begin(const vk::raii::CommandBuffer& commands) const {
  const vk::ClearValue clear{vk::ClearDepthStencilValue{.depth = 1}};
  commands.beginRenderPass({.renderPass = *render_pass_,
                            .framebuffer = *framebuffer_,
                            .renderArea = {{0, 0}, depth_.extent()},
                            .clearValueCount = 1,
                            .pClearValues = &clear},
                           vk::SubpassContents::eInline);
  fill_target(commands, depth_.extent());
}

}  // namespace geocloth::render
