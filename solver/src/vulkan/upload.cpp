// SPDX-License-Identifier: Apache-2.0
#include "vulkan/upload.h"

#include <algorithm>

namespace geocloth::vulkan {
namespace {

using Access = vk::AccessFlagBits;
using Stage = vk::PipelineStageFlagBits;

}  // namespace

Upload::Upload(std::shared_ptr<const Context> context) : context_(std::move(context)), commands_(context_) {
  commands_.begin();
  // What is overwritten may still be in use by work that was submitted before.
  memory_barrier(commands_.buffer(), Stage::eAllCommands, Access::eMemoryRead | Access::eMemoryWrite, Stage::eTransfer,
                 Access::eTransferWrite);
}

const Buffer& Upload::stage(std::span<const std::byte> bytes) {
  const Buffer& staging =
      staging_.emplace_back(context_, bytes.size(), vk::BufferUsageFlagBits::eTransferSrc, Memory::staging);
  std::ranges::copy(bytes, staging.mapped().begin());
  return staging;
}

void Upload::copy_to_image(const Image& image, std::span<const std::byte> bytes) {
  const auto target = vk::ImageLayout::eTransferDstOptimal;
  change_layout(commands_.buffer(), image, vk::ImageLayout::eUndefined, target);
  commands_.buffer().copyBufferToImage(stage(bytes).handle(), image.handle(), target, image.whole_copy());
  change_layout(commands_.buffer(), image, target, vk::ImageLayout::eGeneral);
}

void Upload::clear_image(const Image& image) {
  const auto target = vk::ImageLayout::eTransferDstOptimal;
  change_layout(commands_.buffer(), image, vk::ImageLayout::eUndefined, target);
  commands_.buffer().clearColorImage(image.handle(), target, vk::ClearColorValue{}, image.range());
  change_layout(commands_.buffer(), image, target, vk::ImageLayout::eGeneral);
}

void Upload::copy_to_buffer(const Buffer& buffer, std::span<const std::byte> bytes, vk::DeviceSize offset) {
  if (bytes.empty()) return;
  commands_.buffer().copyBuffer(stage(bytes).handle(), buffer.handle(),
                                vk::BufferCopy{.dstOffset = offset, .size = bytes.size()});
}

void Upload::run() {
  memory_barrier(commands_.buffer(), Stage::eTransfer, Access::eTransferWrite, Stage::eAllCommands,
                 Access::eMemoryRead | Access::eMemoryWrite);
  commands_.end();
  commands_.submit();
  commands_.wait();
}

void read_image(const std::shared_ptr<const Context>& context, const Image& image, std::span<std::byte> out) {
  const Buffer staging(context, out.size(), vk::BufferUsageFlagBits::eTransferDst, Memory::readback);
  run_once(context, [&](const vk::raii::CommandBuffer& commands) {
    const auto source = vk::ImageLayout::eTransferSrcOptimal;
    change_layout(commands, image, vk::ImageLayout::eGeneral, source);
    commands.copyImageToBuffer(image.handle(), source, staging.handle(), image.whole_copy());
    change_layout(commands, image, source, vk::ImageLayout::eGeneral);
    memory_barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
  });
  std::ranges::copy(staging.mapped().first(out.size()), out.begin());
}

void read_buffer(const std::shared_ptr<const Context>& context, const Buffer& buffer, vk::DeviceSize offset,
                 std::span<std::byte> out) {
  if (out.empty()) return;
  const Buffer staging(context, out.size(), vk::BufferUsageFlagBits::eTransferDst, Memory::readback);
  run_once(context, [&](const vk::raii::CommandBuffer& commands) {
    memory_barrier(commands, Stage::eAllCommands, Access::eMemoryWrite, Stage::eTransfer, Access::eTransferRead);
    commands.copyBuffer(buffer.handle(), staging.handle(), vk::BufferCopy{.srcOffset = offset, .size = out.size()});
    memory_barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
  });
  std::ranges::copy(staging.mapped().first(out.size()), out.begin());
}

}  // namespace geocloth::vulkan
