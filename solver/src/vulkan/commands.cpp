// SPDX-License-Identifier: Apache-2.0
#include "vulkan/commands.h"

namespace geocloth::vulkan {

Commands::Commands(std::shared_ptr<const Context> context)
    : context_(std::move(context)),
      pool_(context_->device(), vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                                          .queueFamilyIndex = context_->queue_family()}),
      fence_(context_->device(), vk::FenceCreateInfo{}) {
  vk::raii::CommandBuffers buffers(
      context_->device(), {.commandPool = *pool_, .level = vk::CommandBufferLevel::ePrimary, .commandBufferCount = 1});
  buffer_ = std::move(buffers.front());
}

Commands::~Commands() {
  try {
    wait();
  } catch (const vk::SystemError&) {  // a lost device runs nothing any more
  }
}

const vk::raii::CommandBuffer& Commands::begin() {
  wait();
  buffer_.begin(vk::CommandBufferBeginInfo{});
  return buffer_;
}

void Commands::end() {
  buffer_.end();
}

void Commands::submit() {
  wait();
  const vk::CommandBuffer handle = *buffer_;
  context_->queue().submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle}, *fence_);
  pending_ = true;
}

void Commands::wait() {
  if (!pending_) return;
  const auto result = context_->device().waitForFences(*fence_, VK_TRUE, UINT64_MAX);
  if (result != vk::Result::eSuccess) throw vk::DeviceLostError("waiting for a fence");
  context_->device().resetFences(*fence_);
  pending_ = false;
}

void memory_barrier(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlags from, vk::AccessFlags written,
                    vk::PipelineStageFlags to, vk::AccessFlags used) {
  const vk::MemoryBarrier barrier{.srcAccessMask = written, .dstAccessMask = used};
  commands.pipelineBarrier(from, to, {}, barrier, {}, {});
}

void change_layout(const vk::raii::CommandBuffer& commands, const Image& image, vk::ImageLayout from,
                   vk::ImageLayout to) {
  using Access = vk::AccessFlagBits;
  using Stage = vk::PipelineStageFlagBits;
  constexpr vk::AccessFlags kAll = Access::eMemoryRead | Access::eMemoryWrite;
  const auto outside = [](vk::ImageLayout layout) { return layout == vk::ImageLayout::eGeneral; };
  const vk::ImageMemoryBarrier barrier{
      .srcAccessMask = outside(from) ? kAll : Access::eTransferWrite,
      .dstAccessMask = outside(to) ? kAll : Access::eTransferRead | Access::eTransferWrite,
      .oldLayout = from,
      .newLayout = to,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image.handle(),
      .subresourceRange = image.range()};
  commands.pipelineBarrier(outside(from) ? Stage::eAllCommands : Stage::eTransfer,
                           outside(to) ? Stage::eAllCommands : Stage::eTransfer, {}, {}, {}, barrier);
}

}  // namespace geocloth::vulkan
