// SPDX-License-Identifier: Apache-2.0
#include "vulkan/image.h"

namespace geocloth::vulkan {

Image::Image(std::shared_ptr<const Context> context, const ImageOptions& options)
    : context_(std::move(context)), options_(options) {
  const uint32_t limit = context_->limits().maxImageDimension2D;
  const vk::Extent2D extent = options.extent;
  if (extent.width > limit || extent.height > limit)
    throw Error(ErrorCode::limit, context_->info().name + " has no images larger than " + std::to_string(limit) +
                                      " pixels a side, " + std::to_string(extent.width) + " x " +
                                      std::to_string(extent.height) +
                                      " are needed; use a coarser asset or the cpu backend");
  image_ = vk::raii::Image(context_->device(), vk::ImageCreateInfo{.imageType = vk::ImageType::e2D,
                                                                   .format = options.format,
                                                                   .extent = {extent.width, extent.height, 1},
                                                                   .mipLevels = 1,
                                                                   .arrayLayers = 1,
                                                                   .samples = options.samples,
                                                                   .tiling = vk::ImageTiling::eOptimal,
                                                                   .usage = options.usage,
                                                                   .initialLayout = vk::ImageLayout::eUndefined});
  memory_ = context_->allocate(image_.getMemoryRequirements(), {}, vk::MemoryPropertyFlagBits::eDeviceLocal);
  image_.bindMemory(*memory_, 0);
  view_ = vk::raii::ImageView(
      context_->device(),
      vk::ImageViewCreateInfo{
          .image = *image_, .viewType = vk::ImageViewType::e2D, .format = options.format, .subresourceRange = range()});
}

vk::BufferImageCopy Image::whole_copy(vk::DeviceSize buffer_offset) const {
  return {.bufferOffset = buffer_offset,
          .imageSubresource = {options_.aspect, 0, 0, 1},
          .imageExtent = {options_.extent.width, options_.extent.height, 1}};
}

}  // namespace geocloth::vulkan
