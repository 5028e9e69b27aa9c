// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geocloth/solver/device.h"
#include "vulkan/vk.h"

namespace geocloth::vulkan {

/// One physical device, and whether the solver can run on it. Must not outlive the instance that it was listed from.
struct Candidate {
  vk::raii::PhysicalDevice device;
  DeviceInfo info;
  bool software = false;
  bool graphics = false;      ///< the queue family can draw as well
  bool presents = false;      ///< it can show pictures where DeviceWish::presents wants them
  uint32_t queue_family = 0;  ///< the first with compute and graphics, else the first with compute
};

/// What a caller wants of a device.
struct DeviceWish {
  std::string name = {};  ///< part of its name, in any case; empty: any
  bool real_gpu = false;  ///< no software device unless it is named
  bool graphics = false;  ///< its queue must be able to draw
  /// Whether a queue family can show pictures on the caller's screen. Set: it must, and the device has swapchains.
  std::function<bool(VkInstance, VkPhysicalDevice, uint32_t family)> presents = {};
  std::vector<const char*> instance_extensions = {};  ///< that the caller needs
};

[[nodiscard]] Candidate examine(const vk::raii::PhysicalDevice& device);

/// Every device, in the loader's order.
[[nodiscard]] std::vector<Candidate> list_candidates(const vk::raii::Instance& instance);

/// Index of the best device that fits: discrete before integrated before virtual before software.
[[nodiscard]] std::optional<size_t> find_fitting(const std::vector<Candidate>& candidates, const DeviceWish& wish);

/// The same. @throws Error(device) with one sentence for every device that was refused
[[nodiscard]] const Candidate& choose(const std::vector<Candidate>& candidates, const DeviceWish& wish);

}  // namespace geocloth::vulkan
