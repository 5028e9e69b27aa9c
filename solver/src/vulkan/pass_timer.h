// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "vulkan/context.h"

namespace geocloth::vulkan {

/// Seconds of each kind of dispatch, by the names of its passes, in the order in which they were first met.
using PassSeconds = std::vector<std::pair<std::string, double>>;

/// Timestamps around the passes of one frame. On a queue without timestamps it records nothing.
class PassTimer {
 public:
  explicit PassTimer(std::shared_ptr<const Context> context);

  /// Starts to record a frame that has at most this many intervals.
  void begin(const vk::raii::CommandBuffer& commands, size_t intervals);
  /// Ends an interval, which belongs to a dispatch of that name and starts where the last one ended.
  void mark(const vk::raii::CommandBuffer& commands, const std::string& name);
  /// Adds the intervals of the frame, which must be done, to the sums.
  void collect(PassSeconds& seconds) const;

 private:
  std::shared_ptr<const Context> context_;
  vk::raii::QueryPool queries_ = nullptr;
  std::vector<std::string> names_;
};

}  // namespace geocloth::vulkan
