// SPDX-License-Identifier: Apache-2.0
#include "vulkan/tile_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "tile_comp.h"
#include "tiny_comp.h"
#include "vulkan/bindings.h"

namespace geocloth::vulkan {
namespace {

constexpr uint32_t kTileBindings = shader::kBindingCarryOut + 1;
constexpr uint32_t kTileBuffers = shader::kBindingPinOfPixel + 1;
constexpr uint32_t kTileImages = kTileBindings - kTileBuffers;
constexpr uint32_t kDirections = 2;

constexpr uint32_t kTileInvocations = 256;  ///< a few pixels for each
constexpr uint32_t kTinyInvocations = 1024;
/// In software every invocation goes through all kinds of steps, whichever it is: few do, and each takes more pixels.
constexpr uint32_t kSoftwareInvocations = 32;
constexpr uint32_t kTinyPoints = 256;  ///< numbers of points are rounded up to these, so that kernels are shared

vk::DescriptorType tile_descriptor_type(uint32_t binding) {
  return binding < kTileBuffers ? vk::DescriptorType::eStorageBuffer : vk::DescriptorType::eStorageImage;
}

vk::raii::DescriptorSetLayout make_tile_set_layout(const Context& context) {
  std::array<vk::DescriptorSetLayoutBinding, kTileBindings> bindings;
  for (uint32_t binding = 0; binding < kTileBindings; ++binding) {
    bindings[binding] = {.binding = binding,
                         .descriptorType = tile_descriptor_type(binding),
                         .descriptorCount = 1,
                         .stageFlags = vk::ShaderStageFlagBits::eCompute};
  }
  return {context.device(),
          vk::DescriptorSetLayoutCreateInfo{.bindingCount = bindings.size(), .pBindings = bindings.data()}};
}

vk::raii::PipelineLayout make_pipeline_layout(const Context& context, vk::DescriptorSetLayout points,
                                              vk::DescriptorSetLayout out) {
  const std::array sets{points, out};
  const vk::PushConstantRange constants{.stageFlags = vk::ShaderStageFlagBits::eCompute,
                                        .size = sizeof(shader::TileConstants)};
  return {context.device(), vk::PipelineLayoutCreateInfo{.setLayoutCount = sets.size(),
                                                         .pSetLayouts = sets.data(),
                                                         .pushConstantRangeCount = 1,
                                                         .pPushConstantRanges = &constants}};
}

/// 1 where an application's instance is too old for the question.
uint32_t subgroup_size(const Context& context) {
  if (context.instance().getDispatcher()->vkGetPhysicalDeviceProperties2 == nullptr) return 1;
  const auto chain =
      context.physical_device().getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
  return std::max(1U, chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize);
}

/// Whole subgroups, at most as many as a work group can have.
uint32_t invocations(const TileLimits& limits, uint32_t wanted) {
  const uint32_t most = std::min({limits.invocations, wanted, limits.software ? kSoftwareInvocations : wanted});
  return std::max(limits.subgroup, most / limits.subgroup * limits.subgroup);
}

constexpr uint32_t divide_up(uint32_t count, uint32_t size) {
  return (count + size - 1) / size;
}

vk::raii::DescriptorPool make_pool(const Context& context) {
  const std::array<vk::DescriptorPoolSize, 2> sizes{{
      {vk::DescriptorType::eStorageBuffer, kDirections * kTileBuffers},
      {vk::DescriptorType::eStorageImage, kDirections * kTileImages},
  }};
  return {context.device(), vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                         .maxSets = kDirections,
                                                         .poolSizeCount = sizes.size(),
                                                         .pPoolSizes = sizes.data()}};
}

Buffer make_steps(const std::shared_ptr<const Context>& context, size_t bytes) {
  return {context, bytes, vk::BufferUsageFlagBits::eStorageBuffer, Memory::upload};
}

}  // namespace

TileLimits tile_limits(const Context& context) {
  const vk::PhysicalDeviceLimits& limits = context.limits();
  return {.shared_bytes = limits.maxComputeSharedMemorySize,
          .invocations = std::min(limits.maxComputeWorkGroupInvocations, limits.maxComputeWorkGroupSize[0]),
          .subgroup = subgroup_size(context),
          .descriptors = limits.maxPerStageDescriptorStorageImages >= kStorageImages + kTileImages &&
                         limits.maxPerStageDescriptorStorageBuffers >= kStorageBuffers + kTileBuffers,
          .software = context.info().type == "software"};
}

TileKernels::TileKernels(std::shared_ptr<const Context> context, vk::DescriptorSetLayout pass_set_layout,
                         bool contact_forces)
    : context_(std::move(context)),
      limits_(tile_limits(*context_)),
      contact_forces_(contact_forces ? 1U : 0U),
      set_layout_(make_tile_set_layout(*context_)),
      pipeline_layout_(make_pipeline_layout(*context_, pass_set_layout, *set_layout_)) {}

const Kernel& TileKernels::tile_kernel(uint32_t border, bool contacts) {
  const std::pair key{border, contacts};
  const auto found = tiles_.find(key);
  if (found != tiles_.end()) return found->second;
  const uint32_t side = tile_side(limits_, border), region = side + 2 * border;
  const std::array specialization{
      invocations(limits_, kTileInvocations), region * region, contacts ? 1U : 0U, side, border, contact_forces_};
  return tiles_.emplace(key, Kernel(context_, tile_comp, *pipeline_layout_, specialization)).first->second;
}

const Kernel& TileKernels::tiny_kernel(uint32_t pixels, bool contacts) {
  const uint32_t most = limits_.shared_bytes / static_cast<uint32_t>(sizeof(shader::vec4));
  // Software takes ten seconds to compile one, and no less time to run one of fewer points.
  const uint32_t points = limits_.software ? most : std::min(divide_up(pixels, kTinyPoints) * kTinyPoints, most);
  const std::pair key{points, contacts};
  const auto found = tiny_.find(key);
  if (found != tiny_.end()) return found->second;
  const std::array specialization{
      invocations(limits_, std::min(points, kTinyInvocations)), points, contacts ? 1U : 0U, 0U, 0U, contact_forces_};
  return tiny_.emplace(key, Kernel(context_, tiny_comp, *pipeline_layout_, specialization)).first->second;
}

void TileKernels::dispatch(const vk::raii::CommandBuffer& commands, const ClothResources& cloth,
                           const Dispatch& dispatch, vk::DescriptorSet points, vk::DescriptorSet out) {
  const bool tiny = dispatch.kind == Dispatch::Kind::tiny;
  const Kernel& kernel =
      tiny ? tiny_kernel(cloth.pixel_count(), dispatch.contacts) : tile_kernel(dispatch.border, dispatch.contacts);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline_layout_, 0, {points, out}, {});
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, kernel.handle());
  commands.pushConstants<shader::TileConstants>(*pipeline_layout_, vk::ShaderStageFlagBits::eCompute, 0, dispatch.tile);
  if (tiny) return commands.dispatch(1, 1, 1);
  const uint32_t side = tile_side(limits_, dispatch.border);
  commands.dispatch(divide_up(cloth.width, side), divide_up(cloth.height, side), 1);
}

TileSets::TileSets(std::shared_ptr<const Context> context, vk::DescriptorSetLayout layout, const ClothResources& cloth)
    : context_(std::move(context)), steps_(make_steps(context_, 0)), pool_(make_pool(*context_)) {
  const std::array layouts{layout, layout};
  vk::raii::DescriptorSets sets(context_->device(), vk::DescriptorSetAllocateInfo{.descriptorPool = *pool_,
                                                                                  .descriptorSetCount = layouts.size(),
                                                                                  .pSetLayouts = layouts.data()});
  for (vk::raii::DescriptorSet& set : sets) sets_.push_back(std::move(set));
  write_sets(cloth);
}

void TileSets::write_steps(const std::vector<shader::TileStep>& steps, const ClothResources& cloth) {
  const auto bytes = std::as_bytes(std::span(steps));
  if (bytes.size() > steps_.size()) {
    steps_ = make_steps(context_, std::bit_ceil(bytes.size()));
    write_sets(cloth);
  }
  std::ranges::copy(bytes, steps_.mapped().begin());
}

void TileSets::write_sets(const ClothResources& cloth) const {
  const std::array buffers{vk::DescriptorBufferInfo{.buffer = steps_.handle(), .range = VK_WHOLE_SIZE},
                           vk::DescriptorBufferInfo{.buffer = cloth.pin_of_pixel.handle(), .range = VK_WHOLE_SIZE}};
  for (uint32_t direction = 0; direction < kDirections; ++direction) {
    const bool to_scratch = direction == 1 && cloth.scratch.has_value();
    const std::array<const Image*, kTileImages> targets{to_scratch ? &cloth.scratch->position : &cloth.position,
                                                        to_scratch ? &cloth.scratch->previous : &cloth.previous,
                                                        to_scratch ? &cloth.scratch->carry : &cloth.carry};
    std::array<vk::DescriptorImageInfo, kTileImages> images;
    std::array<vk::WriteDescriptorSet, kTileBindings> writes;
    for (uint32_t binding = 0; binding < kTileBindings; ++binding) {
      writes[binding] = {.dstSet = *sets_[direction],
                         .dstBinding = binding,
                         .descriptorCount = 1,
                         .descriptorType = tile_descriptor_type(binding)};
      if (binding < kTileBuffers) {
        writes[binding].pBufferInfo = &buffers[binding];
        continue;
      }
      const uint32_t i = binding - kTileBuffers;
      images[i] = vk::DescriptorImageInfo{.imageView = targets[i]->view(), .imageLayout = vk::ImageLayout::eGeneral};
      writes[binding].pImageInfo = &images[i];
    }
    context_->device().updateDescriptorSets(writes, {});
  }
}

}  // namespace geocloth::vulkan
