// SPDX-License-Identifier: Apache-2.0
#include "vulkan/kernel.h"

namespace geocloth::vulkan {
namespace {

vk::raii::Pipeline make_pipeline(const Context& context, std::span<const uint32_t> spirv, vk::PipelineLayout layout,
                                 std::span<const uint32_t> specialization) {
  std::vector<vk::SpecializationMapEntry> entries;
  for (uint32_t i = 0; i < specialization.size(); ++i)
    entries.push_back({.constantID = i, .offset = 4 * i, .size = sizeof(uint32_t)});
  const vk::SpecializationInfo constants{.mapEntryCount = static_cast<uint32_t>(entries.size()),
                                         .pMapEntries = entries.data(),
                                         .dataSize = specialization.size_bytes(),
                                         .pData = specialization.data()};
  const vk::raii::ShaderModule shader = make_shader(context, spirv);
  return {context.device(), nullptr,
          vk::ComputePipelineCreateInfo{.stage = {.stage = vk::ShaderStageFlagBits::eCompute,
                                                  .module = *shader,
                                                  .pName = "main",
                                                  .pSpecializationInfo = &constants},
                                        .layout = layout}};
}

}  // namespace

vk::raii::ShaderModule make_shader(const Context& context, std::span<const uint32_t> spirv) {
  return {context.device(), vk::ShaderModuleCreateInfo{.codeSize = spirv.size_bytes(), .pCode = spirv.data()}};
}

Kernel::Kernel(std::shared_ptr<const Context> context, std::span<const uint32_t> spirv, vk::PipelineLayout layout,
               std::span<const uint32_t> specialization)
    : context_(std::move(context)), pipeline_(make_pipeline(*context_, spirv, layout, specialization)) {}

}  // namespace geocloth::vulkan
