// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geocloth/solver/vulkan_interop.h"
#include "vulkan/vk.h"

namespace geocloth::vulkan {

constexpr uint32_t kApiVersion = VK_API_VERSION_1_1;

/// Whether the environment variable GEOCLOTH_VULKAN_VALIDATION is set to something other than nothing or 0.
[[nodiscard]] bool validation_requested();

/// @throws Error(device) when there is no loader
[[nodiscard]] vk::raii::Context open_loader();

/// An instance of Vulkan 1.1; with a log also the validation layers, which write to it.
/// @param extensions  that the caller needs
/// @throws Error(device) when there is no driver, or no layer though it is asked for
[[nodiscard]] vk::raii::Instance create_instance(const vk::raii::Context& loader, ValidationLog* log,
                                                 std::span<const char* const> extensions = {});

/// A messenger that writes warnings and errors of the layers to the log and to standard error.
[[nodiscard]] vk::DebugUtilsMessengerCreateInfoEXT messenger_info(ValidationLog& log);

}  // namespace geocloth::vulkan
