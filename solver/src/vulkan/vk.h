// SPDX-License-Identifier: Apache-2.0
#pragma once

// The one place that includes Vulkan-Hpp. No prototypes: the loader is opened at run time, so nothing links libvulkan
// and a program without Vulkan still starts. No struct constructors: fields are named where they are set.
#define VK_NO_PROTOTYPES
#define VULKAN_HPP_NO_STRUCT_CONSTRUCTORS
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"
#include <vulkan/vulkan_raii.hpp>
#pragma GCC diagnostic pop
