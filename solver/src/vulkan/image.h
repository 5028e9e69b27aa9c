// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "vulkan/context.h"

namespace geocloth::vulkan {

struct ImageOptions {
  vk::Format format = vk::Format::eR32G32B32A32Sfloat;
  vk::Extent2D extent;
  vk::ImageUsageFlags usage;
  vk::ImageAspectFlags aspect = vk::ImageAspectFlagBits::eColor;
  vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e1;
};

/// A two-dimensional image of one level with its own memory and a view of all of it. It starts in the undefined layout.
class Image {
 public:
  Image(std::shared_ptr<const Context> context, const ImageOptions& options);

  [[nodiscard]] vk::Image handle() const { return *image_; }
  [[nodiscard]] vk::ImageView view() const { return *view_; }
  [[nodiscard]] vk::Extent2D extent() const { return options_.extent; }
  [[nodiscard]] vk::ImageSubresourceRange range() const { return {options_.aspect, 0, 1, 0, 1}; }
  /// All of the image as a tightly packed buffer at an offset.
  [[nodiscard]] vk::BufferImageCopy whole_copy(vk::DeviceSize buffer_offset = 0) const;

 private:
  std::shared_ptr<const Context> context_;
  ImageOptions options_;
  vk::raii::DeviceMemory memory_ = nullptr;  // before the image, so that it dies after it
  vk::raii::Image image_ = nullptr;
  vk::raii::ImageView view_ = nullptr;
};

}  // namespace geocloth::vulkan
