// SPDX-License-Identifier: Apache-2.0
#include "vulkan/frame_slot.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

namespace geocloth::vulkan {
namespace {

Buffer make_input(const std::shared_ptr<const Context>& context, size_t bytes) {
  return {context, bytes, vk::BufferUsageFlagBits::eStorageBuffer, Memory::upload};
}

Buffer make_contacts_read(const std::shared_ptr<const Context>& context, size_t bytes) {
  return {context, bytes, vk::BufferUsageFlagBits::eTransferDst, Memory::readback};
}

vk::raii::DescriptorPool make_pool(const Context& context, uint32_t sets) {
  const std::array<vk::DescriptorPoolSize, 3> sizes{{
      {vk::DescriptorType::eUniformBuffer, sets * kUniformBuffers},
      {vk::DescriptorType::eStorageImage, sets * kStorageImages},
      {vk::DescriptorType::eStorageBuffer, sets * kStorageBuffers},
  }};
  return {context.device(), vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                                         .maxSets = sets,
                                                         .poolSizeCount = sizes.size(),
                                                         .pPoolSizes = sizes.data()}};
}

vk::raii::DescriptorSet allocate_set(const Context& context, vk::DescriptorPool pool, vk::DescriptorSetLayout layout) {
  vk::raii::DescriptorSets sets(
      context.device(),
      vk::DescriptorSetAllocateInfo{.descriptorPool = pool, .descriptorSetCount = 1, .pSetLayouts = &layout});
  return std::move(sets.front());
}

/// Copies values into a host-visible buffer, which is replaced by one of twice the size or more when it is too small.
/// @return whether it was replaced
template <typename T>
bool fill(const std::shared_ptr<const Context>& context, Buffer& buffer, const std::vector<T>& values) {
  const size_t bytes = values.size() * sizeof(T);
  const bool grow = bytes > buffer.size();
  const auto most = static_cast<size_t>(context->limits().maxStorageBufferRange);
  if (grow) buffer = make_input(context, std::max(bytes, std::min(std::bit_ceil(bytes), most)));
  std::ranges::copy(std::as_bytes(std::span(values)), buffer.mapped().begin());
  return grow;
}

}  // namespace

FrameSlot::FrameSlot(std::shared_ptr<const Context> context, vk::DescriptorSetLayout layout,
                     const std::vector<ClothResources>& cloths, const InterResources* inter, bool contact_forces)
    : context_(std::move(context)),
      shapes_(make_input(context_, 0)),
      poses_(make_input(context_, 0)),
      substeps_(make_input(context_, 0)),
      numbers_(make_input(context_, 0)),
      pool_(make_pool(*context_, 3 * static_cast<uint32_t>(cloths.size()) + 1)),
      inter_(inter),
      contact_forces_(contact_forces),
      commands_(context_) {
  for (const ClothResources& cloth : cloths) {
    ClothInputs& inputs =
        cloths_.emplace_back(ClothInputs{.params = Buffer(context_, sizeof(shader::ClothParams),
                                                          vk::BufferUsageFlagBits::eUniformBuffer, Memory::upload),
                                         .pins = make_input(context_, 0),
                                         .set = allocate_set(*context_, *pool_, layout),
                                         .contacts = storage_buffer(context_, 0),
                                         .contacts_read = make_contacts_read(context_, 0)});
    if (cloth.scratch) inputs.scratch_set = allocate_set(*context_, *pool_, layout);
    if (cloth.inter.points > 0) inputs.inter_set = allocate_set(*context_, *pool_, layout);
    // Enough for the passes that run before the first frame.
    shader::ClothParams params{};
    params.width = cloth.width;
    params.height = cloth.height;
    inputs.params.as<shader::ClothParams>().front() = params;
  }
  if (inter_ != nullptr) between_set_ = allocate_set(*context_, *pool_, layout);
  write_sets(cloths);
}

bool FrameSlot::write(const FrameInput& frame, const std::vector<ClothResources>& cloths) {
  bool grown = fill(context_, shapes_, frame.shapes);
  grown = fill(context_, poses_, frame.poses) || grown;
  grown = fill(context_, substeps_, frame.substeps) || grown;
  if (frame.collider_numbers && frame.collider_numbers != numbers_written_) {
    grown = fill(context_, numbers_, *frame.collider_numbers) || grown;
    numbers_written_ = frame.collider_numbers;
  }
  for (size_t c = 0; c < cloths_.size(); ++c) {
    if (frame.cloths[c].asleep) continue;  // nothing was said of it, and passes between frames look at what there is
    cloths_[c].params.as<shader::ClothParams>().front() = frame.cloths[c].params;
    grown = fill(context_, cloths_[c].pins, frame.cloths[c].pins) || grown;
    if (contact_forces_) grown = make_room(cloths_[c], frame.cloths[c].params.collider_count) || grown;
  }
  if (grown) write_sets(cloths);
  return grown;
}

/// @return whether buffers are other ones now
bool FrameSlot::make_room(ClothInputs& inputs, uint32_t colliders) {
  const size_t bytes = size_t{colliders} * shader::kContactWords * sizeof(uint32_t);
  if (bytes <= inputs.contacts.size()) return false;
  inputs.contacts = storage_buffer(context_, std::bit_ceil(bytes));
  inputs.contacts_read = make_contacts_read(context_, std::bit_ceil(bytes));
  return true;
}

void FrameSlot::clear_contacts(const vk::raii::CommandBuffer& commands, size_t cloth) const {
  commands.fillBuffer(cloths_[cloth].contacts.handle(), 0, VK_WHOLE_SIZE, 0);
}

void FrameSlot::copy_contacts(const vk::raii::CommandBuffer& commands, size_t cloth) const {
  const ClothInputs& inputs = cloths_[cloth];
  commands.copyBuffer(inputs.contacts.handle(), inputs.contacts_read.handle(),
                      vk::BufferCopy{.size = inputs.contacts.size()});
}

void FrameSlot::read_contacts(size_t cloth, uint32_t colliders, std::vector<ContactSum>& out) const {
  const std::span<const uint32_t> words = cloths_[cloth].contacts_read.as<uint32_t>();
  out.resize(colliders);
  size_t w = 0;
  for (ContactSum& sum : out) {
    for (int64_t& value : sum) {
      value = static_cast<int64_t>(uint64_t{words[w + 1]} << 32U | words[w]);
      w += 2;
    }
  }
}

void FrameSlot::write_sets(const std::vector<ClothResources>& cloths) const {
  for (size_t c = 0; c < cloths_.size(); ++c) {
    const ClothInputs& inputs = cloths_[c];
    write_set(*inputs.set, cloths[c], inputs, {});
    if (cloths[c].scratch) write_set(*inputs.scratch_set, cloths[c], inputs, {.scratch = &*cloths[c].scratch});
    if (cloths[c].inter.points > 0) write_set(*inputs.inter_set, cloths[c], inputs, {.inter = inter_});
  }
  if (inter_ == nullptr) return;
  const uint32_t any = inter_->parts.front().cloth;  // whatever of a cloth is in the set, the passes do not look at it
  write_set(*between_set_, cloths[any], cloths_[any], {.inter = inter_, .params = &inter_->params});
}

void FrameSlot::write_set(vk::DescriptorSet set, const ClothResources& cloth, const ClothInputs& inputs,
                          const Others& others) const {
  using namespace shader;
  const ScratchImages* const scratch = others.scratch;
  const InterResources* const inter = others.inter;
  const std::array<const Image*, kStorageImages> images{scratch != nullptr ? &scratch->position : &cloth.position,
                                                        scratch != nullptr ? &scratch->previous : &cloth.previous,
                                                        scratch != nullptr ? &scratch->carry : &cloth.carry,
                                                        &cloth.normal,
                                                        &cloth.springs[0],
                                                        &cloth.springs[1],
                                                        &cloth.springs[2],
                                                        &cloth.cell,
                                                        &cloth.offset};
  const std::array<const Buffer*, kStorageBuffers> buffers{&cloth.multipliers,
                                                           &cloth.attachments,
                                                           &cloth.seam_springs,
                                                           &cloth.split_offset,
                                                           &cloth.split_pixel,
                                                           &inputs.pins,
                                                           &shapes_,
                                                           &poses_,
                                                           &substeps_,
                                                           &cloth.measures,
                                                           &cloth.inverse_mass,
                                                           &numbers_,
                                                           inter != nullptr ? &inter->points : &cloth.self_points,
                                                           inter != nullptr ? &inter->words : &cloth.self_words,
                                                           &inputs.contacts};

  std::array<vk::DescriptorImageInfo, kStorageImages> image_infos;
  std::array<vk::DescriptorBufferInfo, kUniformBuffers + kStorageBuffers> buffer_infos;
  std::vector<vk::WriteDescriptorSet> writes;
  const auto add_buffer = [&](uint32_t binding, const Buffer& buffer, vk::DescriptorBufferInfo& info) {
    info = vk::DescriptorBufferInfo{.buffer = buffer.handle(), .range = VK_WHOLE_SIZE};
    writes.push_back({.dstSet = set,
                      .dstBinding = binding,
                      .descriptorCount = 1,
                      .descriptorType = descriptor_type(binding),
                      .pBufferInfo = &info});
  };
  add_buffer(kBindingParams, others.params != nullptr ? *others.params : inputs.params, buffer_infos.back());
  for (uint32_t i = 0; i < kStorageBuffers; ++i) add_buffer(kBindingMultipliers + i, *buffers[i], buffer_infos[i]);
  for (uint32_t i = 0; i < kStorageImages; ++i) {
    image_infos[i] = vk::DescriptorImageInfo{.imageView = images[i]->view(), .imageLayout = vk::ImageLayout::eGeneral};
    writes.push_back({.dstSet = set,
                      .dstBinding = kBindingPosition + i,
                      .descriptorCount = 1,
                      .descriptorType = vk::DescriptorType::eStorageImage,
                      .pImageInfo = &image_infos[i]});
  }
  context_->device().updateDescriptorSets(writes, {});
}

}  // namespace geocloth::vulkan
