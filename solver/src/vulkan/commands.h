// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "vulkan/context.h"
#include "vulkan/image.h"

namespace geocloth::vulkan {

/// A command buffer with its pool and fence: record once or each time, submit, wait.
class Commands {
 public:
  explicit Commands(std::shared_ptr<const Context> context);
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;
  /// Waits for the last submit.
  ~Commands();

  /// Waits for the last submit and starts to record anew.
  const vk::raii::CommandBuffer& begin();
  /// What is being recorded.
  [[nodiscard]] const vk::raii::CommandBuffer& buffer() const { return buffer_; }
  void end();
  /// Waits for the last submit of these commands, so that their buffers can be written, then submits them (again).
  void submit();
  void wait();

 private:
  std::shared_ptr<const Context> context_;
  vk::raii::CommandPool pool_;
  vk::raii::CommandBuffer buffer_ = nullptr;
  vk::raii::Fence fence_;
  bool pending_ = false;
};

/// Records with f(command buffer), submits and waits.
template <typename F>
void run_once(const std::shared_ptr<const Context>& context, F&& f) {
  Commands commands(context);
  f(commands.begin());
  commands.end();
  commands.submit();
  commands.wait();
}

/// All writes of the first stages are seen by the second ones. A global barrier costs no more than one per resource
/// here: each pass needs all that the one before it wrote.
void memory_barrier(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlags from, vk::AccessFlags written,
                    vk::PipelineStageFlags to, vk::AccessFlags used);

/// Moves an image from one layout to another between two transfers, or between a transfer and all that went before or
/// comes after: `from` and `to` are one of undefined, general and the two transfer layouts.
void change_layout(const vk::raii::CommandBuffer& commands, const Image& image, vk::ImageLayout from,
                   vk::ImageLayout to);

}  // namespace geocloth::vulkan
