// SPDX-License-Identifier: Apache-2.0
#include "vulkan/pass_timer.h"

#include <algorithm>

namespace geocloth::vulkan {

PassTimer::PassTimer(std::shared_ptr<const Context> context) : context_(std::move(context)) {}

void PassTimer::begin(const vk::raii::CommandBuffer& commands, size_t intervals) {
  names_.clear();
  if (context_->timestamp_period() == 0) return;
  const uint32_t count = static_cast<uint32_t>(intervals) + 1;
  queries_ = vk::raii::QueryPool(context_->device(),
                                 vk::QueryPoolCreateInfo{.queryType = vk::QueryType::eTimestamp, .queryCount = count});
  commands.resetQueryPool(*queries_, 0, count);
  commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *queries_, 0);
}

void PassTimer::mark(const vk::raii::CommandBuffer& commands, const std::string& name) {
  if (context_->timestamp_period() == 0) return;
  names_.push_back(name);
  commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *queries_, static_cast<uint32_t>(names_.size()));
}

void PassTimer::collect(PassSeconds& seconds) const {
  if (names_.empty()) return;
  const uint32_t count = static_cast<uint32_t>(names_.size()) + 1;
  const auto [result, ticks] =
      queries_.getResults<uint64_t>(0, count, count * sizeof(uint64_t), sizeof(uint64_t),
                                    vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
  if (result != vk::Result::eSuccess) return;
  for (size_t i = 0; i < names_.size(); ++i) {
    const uint64_t elapsed = (ticks[i + 1] - ticks[i]) & context_->timestamp_mask();
    auto sum = std::ranges::find(seconds, names_[i], &PassSeconds::value_type::first);
    if (sum == seconds.end()) sum = seconds.insert(sum, {names_[i], 0.0});
    sum->second += static_cast<double>(elapsed) * context_->timestamp_period();
  }
}

}  // namespace geocloth::vulkan
