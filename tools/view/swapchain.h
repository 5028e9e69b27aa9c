// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "render/gpu_support.h"
#include "view/window.h"

namespace geocloth::view {

/// Brings finished pictures to a window. The device must be one whose queue family presents there, with swapchains.
class Swapchain {
 public:
  /// @throws Error(device) when the window takes no pictures in sRGB
  Swapchain(render::ContextPtr context, const Window& window);
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;
  ~Swapchain();

  /// Size that pictures must have now; zero while there is nothing to draw to.
  [[nodiscard]] vk::Extent2D extent();
  /// Shows a picture in the layout "transfer source", after all work that the queue was given before. Waits for the
  /// screen where it is slower. One that comes while the window changes its size may be left out.
  void present(const vulkan::Image& picture);
  /// Until the device draws nothing of ours any more.
  void wait();

 private:
  struct Image {
    vk::Image handle;
    vk::raii::Semaphore drawn;  ///< each has its own: the screen may still wait for that of another image
  };
  void make(vk::Extent2D extent);
  void record_copy(const vk::raii::CommandBuffer& commands, const vulkan::Image& picture, vk::Image to) const;

  render::ContextPtr context_;
  const Window* window_;
  vk::raii::SurfaceKHR surface_;
  vk::SurfaceFormatKHR format_;
  vk::raii::CommandPool pool_;
  vk::raii::CommandBuffer commands_ = nullptr;
  vk::raii::Semaphore taken_;
  vk::raii::Fence fence_;
  bool pending_ = false;
  bool stale_ = true;  ///< the window has another size
  vk::Extent2D extent_;
  vk::raii::SwapchainKHR swapchain_ = nullptr;
  std::vector<Image> images_;
};

}  // namespace geocloth::view
