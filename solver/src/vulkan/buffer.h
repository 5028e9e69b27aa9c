// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <memory>
#include <span>
#include <type_traits>

#include "vulkan/context.h"

namespace geocloth::vulkan {

/// What a buffer is for; the memory type follows from it.
enum class Memory {
  device,    ///< only the device touches it
  upload,    ///< the host writes it in order, shaders read it; on the device where the host reaches it there
  staging,   ///< the host writes it in order, it is copied from once
  readback,  ///< the device writes it, the host reads it at random
};

/// A buffer with its own memory: a cloth has about twenty, made at the start, so an allocator would be idle.
class Buffer {
 public:
  Buffer(std::shared_ptr<const Context> context, vk::DeviceSize bytes, vk::BufferUsageFlags usage, Memory memory);

  [[nodiscard]] vk::Buffer handle() const { return *buffer_; }
  [[nodiscard]] vk::DeviceSize size() const { return bytes_; }
  /// The bytes, mapped as long as the buffer lives; empty for Memory::device. Host-coherent: no flush is needed.
  [[nodiscard]] std::span<std::byte> mapped() const { return {mapped_, mapped_ == nullptr ? 0 : size_t{bytes_}}; }
  /// The mapped bytes as an array.
  template <typename T>
  [[nodiscard]] std::span<T> as() const {
    static_assert(std::is_trivially_copyable_v<T>);
    return {reinterpret_cast<T*>(mapped_), mapped_ == nullptr ? 0 : size_t{bytes_} / sizeof(T)};
  }

 private:
  std::shared_ptr<const Context> context_;
  vk::DeviceSize bytes_;
  vk::raii::DeviceMemory memory_ = nullptr;  // before the buffer, so that it dies after it
  vk::raii::Buffer buffer_ = nullptr;
  std::byte* mapped_ = nullptr;
};

/// On the device, for shaders, filled by an Upload.
[[nodiscard]] Buffer storage_buffer(const std::shared_ptr<const Context>& context, vk::DeviceSize bytes);

}  // namespace geocloth::vulkan
