// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "vulkan/context.h"

namespace geocloth::vulkan {

/// A shader module from embedded SPIR-V.
[[nodiscard]] vk::raii::ShaderModule make_shader(const Context& context, std::span<const uint32_t> spirv);

/// A compute pipeline.
class Kernel {
 public:
  /// @param specialization  values of the specialization constants 0, 1, 2, ...
  Kernel(std::shared_ptr<const Context> context, std::span<const uint32_t> spirv, vk::PipelineLayout layout,
         std::span<const uint32_t> specialization = {});

  [[nodiscard]] vk::Pipeline handle() const { return *pipeline_; }

 private:
  std::shared_ptr<const Context> context_;
  vk::raii::Pipeline pipeline_;
};

}  // namespace geocloth::vulkan
