// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures are drawn elsewhere, in one format and with the code that draws them into files; here they are copied to
// what the screen gives, which costs less than a tenth of a millisecond and makes them independent of its formats.
#include "view/swapchain.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "geocloth/asset/error.h"

namespace geocloth::view {
namespace {

using Access = vk::AccessFlagBits;
using Layout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits;

vk::SurfaceFormatKHR find_format(const vulkan::Context& context, vk::SurfaceKHR surface) {
  for (const vk::SurfaceFormatKHR& format : context.physical_device().getSurfaceFormatsKHR(surface)) {
    const bool srgb = format.format == vk::Format::eB8G8R8A8Srgb || format.format == vk::Format::eR8G8B8A8Srgb;
    if (srgb && format.colorSpace == vk::ColorSpaceKHR::eSrgbNonlinear) return format;
  }
  throw Error(ErrorCode::device, context.info().name +
                                     " shows no sRGB pictures in a window; name another device with --device, or "
                                     "draw without a window: geocloth render");
}

vk::ImageMemoryBarrier barrier(vk::Image image, Layout from, Layout to, vk::AccessFlags written, vk::AccessFlags used) {
  return {.srcAccessMask = written,
          .dstAccessMask = used,
          .oldLayout = from,
          .newLayout = to,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image,
          .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1}};
}

}  // namespace

Swapchain::Swapchain(render::ContextPtr context, const Window& window)
    : context_(std::move(context)),
      window_(&window),
      surface_(context_->instance(), window.make_surface(*context_->instance())),
      format_(find_format(*context_, *surface_)),
      pool_(context_->device(), vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                                          .queueFamilyIndex = context_->queue_family()}),
      taken_(context_->device(), vk::SemaphoreCreateInfo{}),
      fence_(context_->device(), vk::FenceCreateInfo{}) {
  if (context_->physical_device().getSurfaceSupportKHR(context_->queue_family(), *surface_) != VK_TRUE)
    throw Error(ErrorCode::device, context_->info().name + " cannot show pictures in this window");
  vk::raii::CommandBuffers buffers(
      context_->device(), {.commandPool = *pool_, .level = vk::CommandBufferLevel::ePrimary, .commandBufferCount = 1});
  commands_ = std::move(buffers.front());
}

Swapchain::~Swapchain() {
  try {
    wait();
    context_->queue().waitIdle();     // the screen may still wait for a semaphore
  } catch (const vk::SystemError&) {  // a lost device shows nothing any more
  }
}

void Swapchain::wait() {
  if (!pending_) return;
  if (context_->device().waitForFences(*fence_, VK_TRUE, UINT64_MAX) != vk::Result::eSuccess)
    throw vk::DeviceLostError("waiting for a picture");
  context_->device().resetFences(*fence_);
  pending_ = false;
}

vk::Extent2D Swapchain::extent() {
  const PictureSize size = window_->picture_size();
  if (size.width == 0 || size.height == 0) return {};
  const vk::SurfaceCapabilitiesKHR can = context_->physical_device().getSurfaceCapabilitiesKHR(*surface_);
  // Some systems leave the size to the swapchain.
  const vk::Extent2D now =
      can.currentExtent.width != UINT32_MAX
          ? can.currentExtent
          : vk::Extent2D{std::clamp(size.width, can.minImageExtent.width, can.maxImageExtent.width),
                         std::clamp(size.height, can.minImageExtent.height, can.maxImageExtent.height)};
  if (now.width == 0 || now.height == 0) return {};
  if (stale_ || now != extent_) make(now);
  return extent_;
}

void Swapchain::make(vk::Extent2D extent) {
  wait();
  context_->queue().waitIdle();
  const vk::SurfaceCapabilitiesKHR can = context_->physical_device().getSurfaceCapabilitiesKHR(*surface_);
  if (!(can.supportedUsageFlags & vk::ImageUsageFlagBits::eTransferDst))
    throw Error(ErrorCode::device, context_->info().name + " cannot copy pictures to this window");
  const uint32_t wanted = can.minImageCount + 1;
  using Alpha = vk::CompositeAlphaFlagBitsKHR;
  const bool opaque = static_cast<bool>(can.supportedCompositeAlpha & Alpha::eOpaque);
  const vk::raii::SwapchainKHR old = std::move(swapchain_);
  images_.clear();
  swapchain_ = vk::raii::SwapchainKHR(
      context_->device(), {.surface = *surface_,
                           .minImageCount = can.maxImageCount > 0 ? std::min(wanted, can.maxImageCount) : wanted,
                           .imageFormat = format_.format,
                           .imageColorSpace = format_.colorSpace,
                           .imageExtent = extent,
                           .imageArrayLayers = 1,
                           .imageUsage = vk::ImageUsageFlagBits::eTransferDst,
                           .imageSharingMode = vk::SharingMode::eExclusive,
                           .preTransform = can.currentTransform,
                           .compositeAlpha = opaque ? Alpha::eOpaque : Alpha::eInherit,
                           .presentMode = vk::PresentModeKHR::eFifo,  // every device has it, and nothing tears
                           .clipped = VK_TRUE,
                           .oldSwapchain = *old});
  for (const vk::Image image : swapchain_.getImages())
    images_.push_back({image, vk::raii::Semaphore(context_->device(), vk::SemaphoreCreateInfo{})});
  extent_ = extent;
  stale_ = false;
}

void Swapchain::record_copy(const vk::raii::CommandBuffer& commands, const vulkan::Image& picture, vk::Image to) const {
  commands.pipelineBarrier(Stage::eTransfer, Stage::eTransfer, {}, {}, {},
                           barrier(to, Layout::eUndefined, Layout::eTransferDstOptimal, {}, Access::eTransferWrite));
  const vk::ImageSubresourceLayers layers{vk::ImageAspectFlagBits::eColor, 0, 0, 1};
  const auto corners = [](const vk::Extent2D& e) {
    return std::array{vk::Offset3D{0, 0, 0},
                      vk::Offset3D{static_cast<int32_t>(e.width), static_cast<int32_t>(e.height), 1}};
  };
  // A blit, because the order of the channels may differ.
  commands.blitImage(picture.handle(), Layout::eTransferSrcOptimal, to, Layout::eTransferDstOptimal,
                     vk::ImageBlit{.srcSubresource = layers,
                                   .srcOffsets = corners(picture.extent()),
                                   .dstSubresource = layers,
                                   .dstOffsets = corners(extent_)},
                     vk::Filter::eNearest);
  commands.pipelineBarrier(
      Stage::eTransfer, Stage::eBottomOfPipe, {}, {}, {},
      barrier(to, Layout::eTransferDstOptimal, Layout::ePresentSrcKHR, Access::eTransferWrite, {}));
}

void Swapchain::present(const vulkan::Image& picture) {
  wait();
  uint32_t index = 0;
  try {
    const auto [result, next] = swapchain_.acquireNextImage(UINT64_MAX, *taken_);
    stale_ = result == vk::Result::eSuboptimalKHR;
    index = next;
  } catch (const vk::OutOfDateKHRError&) {
    stale_ = true;
    return;
  }
  const Image& image = images_.at(index);
  commands_.begin(vk::CommandBufferBeginInfo{});
  record_copy(commands_, picture, image.handle);
  commands_.end();
  const vk::PipelineStageFlags at = Stage::eTransfer;
  const vk::CommandBuffer commands = *commands_;
  const vk::Semaphore taken = *taken_, drawn = *image.drawn;
  context_->queue().submit(vk::SubmitInfo{.waitSemaphoreCount = 1,
                                          .pWaitSemaphores = &taken,
                                          .pWaitDstStageMask = &at,
                                          .commandBufferCount = 1,
                                          .pCommandBuffers = &commands,
                                          .signalSemaphoreCount = 1,
                                          .pSignalSemaphores = &drawn},
                           *fence_);
  pending_ = true;
  const vk::SwapchainKHR swapchain = *swapchain_;
  try {
    const vk::Result result = context_->queue().presentKHR({.waitSemaphoreCount = 1,
                                                            .pWaitSemaphores = &drawn,
                                                            .swapchainCount = 1,
                                                            .pSwapchains = &swapchain,
                                                            .pImageIndices = &index});
    stale_ = stale_ || result == vk::Result::eSuboptimalKHR;
  } catch (const vk::OutOfDateKHRError&) {
    stale_ = true;
  }
}

}  // namespace geocloth::view
