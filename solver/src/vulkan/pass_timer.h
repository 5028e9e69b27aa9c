// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "pass.h"
#include "vulkan/context.h"

namespace geocloth::vulkan {

/// Seconds of each pass, by Pass.
using PassSeconds = std::array<double, kPasses.size()>;

/// Timestamps around the passes of one frame. On a queue without timestamps it records nothing.
class PassTimer {
 public:
  explicit PassTimer(std::shared_ptr<const Context> context);

  /// Starts to record a frame that has at most this many intervals.
  void begin(const vk::raii::CommandBuffer& commands, size_t intervals);
  /// Ends an interval, which belongs to a pass and starts where the last one ended.
  void mark(const vk::raii::CommandBuffer& commands, Pass pass);
  /// Adds the intervals of the frame, which must be done, to the sums.
  void collect(PassSeconds& seconds) const;

 private:
  std::shared_ptr<const Context> context_;
  vk::raii::QueryPool queries_ = nullptr;
  std::vector<Pass> passes_;
};

}  // namespace geocloth::vulkan
