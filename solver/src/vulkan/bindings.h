// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/layout.h"
#include "vulkan/vk.h"

namespace geocloth::vulkan {

/// Descriptors of each type in the one set that all passes share; see shared/layout.h.
inline constexpr uint32_t kUniformBuffers = 1;
inline constexpr uint32_t kStorageImages = shader::kBindingOffset - shader::kBindingPosition + 1;
inline constexpr uint32_t kStorageBuffers = shader::kBindingContacts - shader::kBindingMultipliers + 1;

[[nodiscard]] constexpr vk::DescriptorType descriptor_type(uint32_t binding) {
  if (binding == shader::kBindingParams) return vk::DescriptorType::eUniformBuffer;
  if (binding <= shader::kBindingOffset) return vk::DescriptorType::eStorageImage;
  return vk::DescriptorType::eStorageBuffer;
}

}  // namespace geocloth::vulkan
