// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/window.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geocloth/asset/error.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace geocloth::view {
namespace {

/// What GLFW says about its last failure.
std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "the system does not say why" : text;
}

constexpr std::array<std::pair<int, Key>, 16> kKeys{{{GLFW_KEY_SPACE, Key::play},
                                                     {GLFW_KEY_RIGHT, Key::step},
                                                     {GLFW_KEY_R, Key::restart},
                                                     {GLFW_KEY_F, Key::frame_all},
                                                     {GLFW_KEY_HOME, Key::frame_all},
                                                     {GLFW_KEY_C, Key::cut},
                                                     {GLFW_KEY_ESCAPE, Key::cancel},
                                                     {GLFW_KEY_1, Key::show_cloth},
                                                     {GLFW_KEY_2, Key::show_grid},
                                                     {GLFW_KEY_3, Key::show_strain},
                                                     {GLFW_KEY_4, Key::show_charts},
                                                     {GLFW_KEY_5, Key::show_seams},
                                                     {GLFW_KEY_S, Key::springs},
                                                     {GLFW_KEY_P, Key::pins},
                                                     {GLFW_KEY_O, Key::colliders},
                                                     {GLFW_KEY_TAB, Key::panel}}};

std::optional<MouseButton> button_of(int button) {
  switch (button) {
    case GLFW_MOUSE_BUTTON_LEFT:
      return MouseButton::left;
    case GLFW_MOUSE_BUTTON_MIDDLE:
      return MouseButton::middle;
    case GLFW_MOUSE_BUTTON_RIGHT:
      return MouseButton::right;
    default:
      return std::nullopt;
  }
}

}  // namespace

class Window::Library {
 public:
  Library() {
    if (glfwInit() != GLFW_TRUE)
      throw Error(ErrorCode::device,
                  fmt::format("there is no display for a window ({}); set DISPLAY or WAYLAND_DISPLAY to one, or draw "
                              "without a window: geocloth simulate SCENE -o OUT.mp4, geocloth render",
                              last_error()));
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() { glfwTerminate(); }
};

/// GLFW calls plain functions; each finds its window.
struct WindowCallbacks {
  static Window& window(GLFWwindow* handle) { return *static_cast<Window*>(glfwGetWindowUserPointer(handle)); }

  static void on_move(GLFWwindow* handle, double x, double y) {
    Window& w = window(handle);
    w.post(MouseMoved{w.place(x, y)});
  }
  static void on_button(GLFWwindow* handle, int button, int action, int modifiers) {
    const std::optional<MouseButton> known = button_of(button);
    if (!known) return;
    double x = 0, y = 0;
    glfwGetCursorPos(handle, &x, &y);
    Window& w = window(handle);
    if (action == GLFW_PRESS) {
      w.post(
          MousePressed{*known, w.place(x, y), (modifiers & GLFW_MOD_SHIFT) != 0, (modifiers & GLFW_MOD_CONTROL) != 0});
    } else {
      w.post(MouseReleased{*known, w.place(x, y)});
    }
  }
  static void on_scroll(GLFWwindow* handle, double, double steps) {
    window(handle).post(Scrolled{static_cast<float>(steps)});
  }
  static void on_key(GLFWwindow* handle, int key, int, int action, int modifiers) {
    if (action == GLFW_RELEASE || (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;
    for (const auto& [code, meaning] : kKeys) {
      // A key that is held steps on; it does not switch back and forth.
      if (code == key && (action == GLFW_PRESS || meaning == Key::step)) window(handle).post(KeyPressed{meaning});
    }
  }
};

Window::Window(const std::string& title, const PictureSize& size) : library_(std::make_unique<Library>()) {
  if (glfwVulkanSupported() != GLFW_TRUE)
    throw Error(ErrorCode::device,
                "a window needs the Vulkan loader and a driver; install the driver of your GPU (Debian: libvulkan1, "
                "mesa-vulkan-drivers)");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  window_ =
      glfwCreateWindow(static_cast<int>(size.width), static_cast<int>(size.height), title.c_str(), nullptr, nullptr);
  if (window_ == nullptr)
    throw Error(ErrorCode::device,
                fmt::format("a window of {} x {} cannot be opened: {}", size.width, size.height, last_error()));
  glfwSetWindowUserPointer(window_, this);
  glfwSetCursorPosCallback(window_, WindowCallbacks::on_move);
  glfwSetMouseButtonCallback(window_, WindowCallbacks::on_button);
  glfwSetScrollCallback(window_, WindowCallbacks::on_scroll);
  glfwSetKeyCallback(window_, WindowCallbacks::on_key);
}

Window::~Window() {
  glfwDestroyWindow(window_);
}

void Window::show() {
  glfwShowWindow(window_);
}

bool Window::wants_to_close() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

PictureSize Window::picture_size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {static_cast<uint32_t>(std::max(width, 0)), static_cast<uint32_t>(std::max(height, 0))};
}

Vec2 Window::place(double x, double y) const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  const PictureSize picture = picture_size();
  const auto scaled = [](double at, uint32_t pixels, int units) {
    return static_cast<float>(units > 0 ? at * pixels / units : at);
  };
  return {scaled(x, picture.width, width), scaled(y, picture.height, height)};
}

std::vector<InputEvent> Window::poll(double wait) {
  if (wait > 0 && events_.empty()) {
    glfwWaitEventsTimeout(wait);
  } else {
    glfwPollEvents();
  }
  return std::exchange(events_, {});
}

std::vector<const char*> Window::instance_extensions() const {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (names == nullptr)
    throw Error(ErrorCode::device, fmt::format("Vulkan cannot draw on this display: {}; draw without a window: "
                                               "geocloth simulate SCENE -o OUT.mp4, geocloth render",
                                               last_error()));
  return {names, names + count};
}

bool Window::presents(VkInstance instance, VkPhysicalDevice device, uint32_t family) {
  return glfwGetPhysicalDevicePresentationSupport(instance, device, family) == GLFW_TRUE;
}

VkSurfaceKHR Window::make_surface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  if (glfwCreateWindowSurface(instance, window_, nullptr, &surface) != VK_SUCCESS)
    throw Error(ErrorCode::device, fmt::format("the window cannot be drawn into: {}", last_error()));
  return surface;
}

}  // namespace geocloth::view
