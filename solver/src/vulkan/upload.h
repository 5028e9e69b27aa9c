// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "vulkan/buffer.h"
#include "vulkan/commands.h"
#include "vulkan/image.h"

namespace geocloth::vulkan {

/// Copies host data to the device: collects copies, then runs them all and waits.
class Upload {
 public:
  explicit Upload(std::shared_ptr<const Context> context);

  /// Fills an image; afterwards it is in the general layout, whatever it was before.
  template <typename T>
  void to_image(const Image& image, std::span<const T> texels) {
    copy_to_image(image, std::as_bytes(texels));
  }
  void clear_image(const Image& image);
  /// @param first  values of the buffer before them stay
  template <typename T>
  void to_buffer(const Buffer& buffer, std::span<const T> values, size_t first = 0) {
    copy_to_buffer(buffer, std::as_bytes(values), first * sizeof(T));
  }
  void run();

 private:
  void copy_to_image(const Image& image, std::span<const std::byte> bytes);
  void copy_to_buffer(const Buffer& buffer, std::span<const std::byte> bytes, vk::DeviceSize offset);
  const Buffer& stage(std::span<const std::byte> bytes);

  std::shared_ptr<const Context> context_;
  std::vector<Buffer> staging_;  // before the commands, which wait for their end in their destructor
  Commands commands_;
};

/// Waits for all work on the queue and copies an image in the general layout to host memory.
void read_image(const std::shared_ptr<const Context>& context, const Image& image, std::span<std::byte> out);
/// The same for bytes of a buffer on the device, from an offset on.
void read_buffer(const std::shared_ptr<const Context>& context, const Buffer& buffer, vk::DeviceSize offset,
                 std::span<std::byte> out);

}  // namespace geocloth::vulkan
