// SPDX-License-Identifier: Apache-2.0
#include "vulkan/buffer.h"

#include <algorithm>
#include <string>

namespace geocloth::vulkan {
namespace {

using Property = vk::MemoryPropertyFlagBits;

struct MemoryKind {
  vk::MemoryPropertyFlags required, preferred;
};

MemoryKind memory_kind(Memory memory) {
  switch (memory) {
    case Memory::device:
      return {{}, Property::eDeviceLocal};
    case Memory::upload:
      return {Property::eHostVisible | Property::eHostCoherent, Property::eDeviceLocal};
    case Memory::staging:
      return {Property::eHostVisible | Property::eHostCoherent, {}};
    case Memory::readback:
      return {Property::eHostVisible | Property::eHostCoherent, Property::eHostCached};
  }
  return {};
}

/// @throws Error(device)
void check_size(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage) {
  const vk::DeviceSize most = context.limits().maxStorageBufferRange;
  if (!(usage & vk::BufferUsageFlagBits::eStorageBuffer) || bytes <= most) return;
  constexpr vk::DeviceSize kMiB = 1024 * 1024;
  throw Error(ErrorCode::device, context.info().name + " lets a shader see " + std::to_string(most / kMiB) +
                                     " MiB of a buffer, and one of " + std::to_string(bytes / kMiB + 1) +
                                     " MiB is wanted; try a smaller cloth, a wider spacing of the fields of "
                                     "colliders, another device, or the cpu backend");
}

}  // namespace

Buffer::Buffer(std::shared_ptr<const Context> context, vk::DeviceSize bytes, vk::BufferUsageFlags usage, Memory memory)
    : context_(std::move(context)), bytes_(std::max<vk::DeviceSize>(bytes, 16)) {  // Vulkan has no empty buffers
  check_size(*context_, bytes_, usage);
  buffer_ = vk::raii::Buffer(context_->device(), vk::BufferCreateInfo{.size = bytes_, .usage = usage});
  const MemoryKind kind = memory_kind(memory);
  memory_ = context_->allocate(buffer_.getMemoryRequirements(), kind.required, kind.preferred);
  buffer_.bindMemory(*memory_, 0);
  if (memory != Memory::device) mapped_ = static_cast<std::byte*>(memory_.mapMemory(0, VK_WHOLE_SIZE));
}

Buffer storage_buffer(const std::shared_ptr<const Context>& context, vk::DeviceSize bytes) {
  return {context, bytes,
          vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eTransferSrc |
              vk::BufferUsageFlagBits::eTransferDst,
          Memory::device};
}

}  // namespace geocloth::vulkan
