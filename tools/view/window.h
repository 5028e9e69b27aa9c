// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <vulkan/vulkan_core.h>

#include "render/render_options.h"
#include "view/input_event.h"

struct GLFWwindow;

namespace geocloth::view {

/// A window of the system, hidden until show(). Use from the main thread, one at a time.
class Window {
 public:
  /// @param size  [units of the screen, most often pixels]
  /// @throws Error(device) when there is no display, or no Vulkan on it
  Window(const std::string& title, const PictureSize& size);
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window();

  void show();
  [[nodiscard]] bool wants_to_close() const;
  /// Of what is drawn; zero while the window is minimised.
  [[nodiscard]] PictureSize picture_size() const;
  /// Events since the last call. Waits up to so long for one [s]; 0: does not.
  [[nodiscard]] std::vector<InputEvent> poll(double wait);
  /// As if the user had done that: the next poll() gives it.
  void post(const InputEvent& event) { events_.push_back(event); }

  /// What an instance needs to draw here.
  [[nodiscard]] std::vector<const char*> instance_extensions() const;
  /// Whether a queue family can show pictures on this display.
  [[nodiscard]] static bool presents(VkInstance instance, VkPhysicalDevice device, uint32_t family);
  /// The caller's to destroy. @throws Error(device)
  [[nodiscard]] VkSurfaceKHR make_surface(VkInstance instance) const;
  [[nodiscard]] GLFWwindow* handle() const { return window_; }

 private:
  class Library;  ///< is initialised as long as a window lives
  friend struct WindowCallbacks;
  /// From the screen's units to pixels of the picture.
  [[nodiscard]] Vec2 place(double x, double y) const;

  std::unique_ptr<Library> library_;
  GLFWwindow* window_ = nullptr;
  std::vector<InputEvent> events_;
};

}  // namespace geocloth::view
