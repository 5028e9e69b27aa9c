// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/solver/vulkan_interop.h"
#include "vulkan/candidate.h"
#include "vulkan/vk.h"

namespace geocloth::vulkan {

/// Instance, device and one queue that can compute (and draw, where the device can). Everything else in this folder
/// keeps a shared pointer to it, so there is no order of destruction to get wrong.
class Context {
 public:
  /// With GEOCLOTH_VULKAN_VALIDATION set, under the validation layers. @throws Error(device)
  explicit Context(const DeviceWish& wish);
  /// Uses a device of the application, which stays its owner and must outlive the context. @throws Error(device)
  explicit Context(const VulkanDevice& foreign);
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context();

  [[nodiscard]] const vk::raii::Instance& instance() const { return instance_; }
  [[nodiscard]] const vk::raii::PhysicalDevice& physical_device() const { return physical_device_; }
  [[nodiscard]] const vk::raii::Device& device() const { return device_; }
  [[nodiscard]] const vk::raii::Queue& queue() const { return queue_; }
  [[nodiscard]] uint32_t queue_family() const { return queue_family_; }
  [[nodiscard]] VulkanDevice handles() const;
  [[nodiscard]] const DeviceInfo& info() const { return info_; }
  [[nodiscard]] bool graphics() const { return graphics_; }
  [[nodiscard]] const vk::PhysicalDeviceLimits& limits() const { return limits_; }
  /// Seconds per timestamp tick; 0 when the queue has no timestamps.
  [[nodiscard]] double timestamp_period() const { return timestamp_period_; }
  /// The bits of a timestamp that count.
  [[nodiscard]] uint64_t timestamp_mask() const { return timestamp_mask_; }
  /// Outlives the context, so that messages of its destruction can be seen too.
  [[nodiscard]] const std::shared_ptr<ValidationLog>& validation_log() const { return log_; }

  /// Index of a memory type that `type_bits` allows and that has `required`, with `preferred` too if there is one.
  [[nodiscard]] uint32_t memory_type(uint32_t type_bits, vk::MemoryPropertyFlags required,
                                     vk::MemoryPropertyFlags preferred) const;
  [[nodiscard]] vk::raii::DeviceMemory allocate(const vk::MemoryRequirements& needs, vk::MemoryPropertyFlags required,
                                                vk::MemoryPropertyFlags preferred) const;

 private:
  void adopt_candidate(const Candidate& candidate);

  std::shared_ptr<ValidationLog> log_ = std::make_shared<ValidationLog>();
  bool foreign_ = false;
  vk::raii::Context loader_;
  vk::raii::Instance instance_ = nullptr;
  vk::raii::DebugUtilsMessengerEXT messenger_ = nullptr;
  vk::raii::PhysicalDevice physical_device_ = nullptr;
  vk::raii::Device device_ = nullptr;
  vk::raii::Queue queue_ = nullptr;
  uint32_t queue_family_ = 0;
  DeviceInfo info_;
  bool graphics_ = false;
  vk::PhysicalDeviceLimits limits_;
  vk::PhysicalDeviceMemoryProperties memory_;
  double timestamp_period_ = 0;
  uint64_t timestamp_mask_ = 0;
};

/// Runs f and turns what Vulkan-Hpp throws into Error(device): the one place where that is done.
/// @param what  completes "Vulkan failed to ..."
template <typename F>
auto guarded(const char* what, F&& f) -> decltype(f()) {
  try {
    return f();
  } catch (const vk::SystemError& e) {
    throw Error(ErrorCode::device, std::string("Vulkan failed to ") + what + ": " + e.what() +
                                       "; try a smaller cloth, another device, or the cpu backend");
  }
}

}  // namespace geocloth::vulkan
