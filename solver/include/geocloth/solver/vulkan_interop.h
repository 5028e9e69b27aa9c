// SPDX-License-Identifier: Apache-2.0
#pragma once

// The only public header that names Vulkan. It needs <vulkan/vulkan_core.h> and links nothing: the library opens the
// loader at run time.
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan_core.h>

#include "geocloth/solver/solver.h"

namespace geocloth {

/// A Vulkan device of the application. The queue must support compute; the images that the solver creates belong to its
/// family. Vulkan asks that a queue is used by one thread at a time: that is the caller's care in step(), wait() and
/// the read and write functions. Needs Vulkan 1.1, no feature and no extension.
struct VulkanDevice {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  uint32_t queue_family = 0;
  VkQueue queue = VK_NULL_HANDLE;
};

/// Where a cloth lives on the device. Both images are R32G32B32A32_SFLOAT, one texel per pixel of the asset, usable as
/// storage and sampled images and as copy source. They stay in VK_IMAGE_LAYOUT_GENERAL and keep their handles as long
/// as the solver has the cloth, also while others come and go; whoever uses them has to be done before it is removed.
struct VulkanClothImages {
  VkImage position = VK_NULL_HANDLE;  ///< xyz [m] relative to origin; w is the solver's own
  VkImageView position_view = VK_NULL_HANDLE;
  VkImage normal = VK_NULL_HANDLE;  ///< xyz of unit length, zero where the pixel is not valid
  VkImageView normal_view = VK_NULL_HANDLE;
  uint32_t width = 0, height = 0;  ///< [pixels]
  VkImageLayout layout = VK_IMAGE_LAYOUT_GENERAL;
  Vec3 origin;  ///< [m] to be added to every position; see vulkan_origin()
};

/// A solver on a device of the application, which must outlive the solver. Settings' backend and device are ignored.
/// @throws Error(device) when the device lacks what the solver needs
[[nodiscard]] Solver make_vulkan_solver(std::span<const ClothDesc> cloths, const SolverSettings& settings,
                                        const VulkanDevice& device);

/// The device that a solver runs on. @throws Error(unsupported) for a solver on the cpu backend
[[nodiscard]] VulkanDevice vulkan_device(Solver& solver);

/// The images of a cloth. step() makes what it writes available to all later work on the same queue (a full memory
/// barrier ends its commands and another begins the next frame's), so reading them there needs no barrier of the
/// caller's.
/// @throws Error(unsupported) for a solver on the cpu backend
[[nodiscard]] VulkanClothImages vulkan_images(Solver& solver, uint32_t cloth);

/// [m] What is to be added to the positions of all cloths, so that single precision reaches far from the world's
/// origin: whole metres, that follow the cloths. To be asked for after every step().
/// @throws Error(unsupported) for a solver on the cpu backend
[[nodiscard]] Vec3 vulkan_origin(Solver& solver);

/// Messages of the validation layers, which run when the environment variable GEOCLOTH_VULKAN_VALIDATION is not empty
/// and not 0. Outlives the solver. Safe to use from several threads.
class ValidationLog {
 public:
  void add(std::string message);
  [[nodiscard]] std::vector<std::string> messages() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};
/// Of a solver's device. @throws Error(unsupported) for a solver on the cpu backend
[[nodiscard]] std::shared_ptr<const ValidationLog> validation_log(Solver& solver);

}  // namespace geocloth
