// SPDX-License-Identifier: Apache-2.0
#include "vulkan/pass_kernels.h"

#include <span>

#include "check_colliders_comp.h"
#include "check_copies_comp.h"
#include "collide_cells_comp.h"
#include "collide_comp.h"
#include "curvature_comp.h"
#include "give_way_comp.h"
#include "hold_way_comp.h"
#include "inter_gather_comp.h"
#include "inter_move_comp.h"
#include "inverse_mass_comp.h"
#include "lib/bend_groups.h"
#include "lib/cell_groups.h"
#include "lib/span.h"
#include "lib/spring_groups.h"
#include "limit_comp.h"
#include "lines_comp.h"
#include "measure_motion_comp.h"
#include "normals_comp.h"
#include "normals_stitch_comp.h"
#include "pins_comp.h"
#include "predict_comp.h"
#include "rescale_comp.h"
#include "seam_bends_comp.h"
#include "seam_curvature_comp.h"
#include "seam_spans_comp.h"
#include "self_clear_comp.h"
#include "self_drift_comp.h"
#include "self_find_comp.h"
#include "self_insert_comp.h"
#include "self_move_comp.h"
#include "self_push_comp.h"
#include "settle_comp.h"
#include "sew_comp.h"
#include "shared/workgroup.h"
#include "spans_comp.h"
#include "springs_comp.h"
#include "stitch_comp.h"
#include "stitch_contacts_comp.h"
#include "ties_comp.h"
#include "whole_ties_comp.h"

namespace geocloth::vulkan {
namespace {

std::span<const uint32_t> spirv(Pass pass) {
  switch (pass) {
    case Pass::normals:
      return normals_comp;
    case Pass::normals_stitch:
      return normals_stitch_comp;
    case Pass::rescale:
      return rescale_comp;
    case Pass::predict:
      return predict_comp;
    case Pass::pins:
      return pins_comp;
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
      return springs_comp;
    case Pass::seam_bends:
      return seam_bends_comp;
    case Pass::curvature:
      return curvature_comp;
    case Pass::seam_curvature:
      return seam_curvature_comp;
    case Pass::seam_spans:
      return seam_spans_comp;
    case Pass::spans:
      return spans_comp;
    case Pass::sew:
      return sew_comp;
    case Pass::stitch:
      return stitch_comp;
    case Pass::settle:
      return settle_comp;
    case Pass::limit:
      return limit_comp;
    case Pass::self_drift:
    case Pass::inter_drift:
      return self_drift_comp;
    case Pass::self_clear:
    case Pass::inter_clear:
      return self_clear_comp;
    case Pass::self_insert:
    case Pass::inter_insert:
      return self_insert_comp;
    case Pass::self_find:
    case Pass::inter_find:
      return self_find_comp;
    case Pass::self_push:
    case Pass::inter_push:
      return self_push_comp;
    case Pass::self_move:
      return self_move_comp;
    case Pass::inter_gather:
      return inter_gather_comp;
    case Pass::inter_move:
      return inter_move_comp;
    case Pass::collide_cells:
      return collide_cells_comp;
    case Pass::stitch_contacts:
      return stitch_contacts_comp;
    case Pass::collide:
      return collide_comp;
    case Pass::hold_way:
      return hold_way_comp;
    case Pass::lines:
      return lines_comp;
    case Pass::ties:
      return ties_comp;
    case Pass::whole_ties:
      return whole_ties_comp;
    case Pass::give_way:
      return give_way_comp;
    case Pass::check_copies:
      return check_copies_comp;
    case Pass::check_colliders:
      return check_colliders_comp;
    case Pass::measure_motion:
      return measure_motion_comp;
  }
  return {};
}

/// springs.comp's first specialization constant: which family's image it reads.
uint32_t family(Pass pass) {
  return pass == Pass::shear ? 1 : pass == Pass::bending ? 2 : 0;
}

vk::raii::DescriptorSetLayout make_set_layout(const Context& context) {
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (uint32_t binding = 0; binding < kUniformBuffers + kStorageImages + kStorageBuffers; ++binding)
    bindings.push_back({.binding = binding,
                        .descriptorType = descriptor_type(binding),
                        .descriptorCount = 1,
                        .stageFlags = vk::ShaderStageFlagBits::eCompute});
  return {context.device(), vk::DescriptorSetLayoutCreateInfo{.bindingCount = static_cast<uint32_t>(bindings.size()),
                                                              .pBindings = bindings.data()}};
}

vk::raii::PipelineLayout make_pipeline_layout(const Context& context, vk::DescriptorSetLayout set) {
  const vk::PushConstantRange constants{.stageFlags = vk::ShaderStageFlagBits::eCompute,
                                        .size = sizeof(shader::PassConstants)};
  return {
      context.device(),
      vk::PipelineLayoutCreateInfo{
          .setLayoutCount = 1, .pSetLayouts = &set, .pushConstantRangeCount = 1, .pPushConstantRanges = &constants}};
}

constexpr uint32_t groups(uint32_t count, uint32_t size) {
  return (count + size - 1) / size;
}

/// Number of entries of a pass that runs over a list.
uint32_t list_count(const ClothResources& cloth, const PassStep& step, uint32_t pins) {
  if (step.pass == Pass::pins) return pins;
  if (step.pass == Pass::lines) return step.group == 0 ? cloth.height : cloth.width;
  if (step.pass == Pass::self_clear) return cloth.self.buckets;
  if (step.pass == Pass::inter_clear) return cloth.inter_numbers.buckets;
  if (step.pass == Pass::inter_gather) return cloth.inter.points;
  if (step.pass == Pass::inter_move) return cloth.inter.pixels;
  if (is_between_cloths(step.pass)) return cloth.inter_numbers.points;
  if (step.pass >= Pass::self_drift && step.pass <= Pass::self_push) return cloth.self.points;
  if (is_over_seams(step.pass)) return cloth.seam_color_offset[step.group + 1] - cloth.seam_color_offset[step.group];
  return cloth.split_rows;
}

}  // namespace

PassKernels::PassKernels(std::shared_ptr<const Context> context, bool may_be_fine, bool contact_forces)
    : context_(std::move(context)),
      may_be_fine_(may_be_fine),
      contact_forces_(contact_forces),
      set_layout_(make_set_layout(*context_)),
      pipeline_layout_(make_pipeline_layout(*context_, *set_layout_)),
      inverse_mass_(context_, inverse_mass_comp, *pipeline_layout_) {}

const Kernel& PassKernels::kernel(Pass pass) const {
  std::optional<Kernel>& kernel = kernels_[static_cast<size_t>(pass)];
  if (!kernel) {
    const std::array<uint32_t, 6> specialization{
        family(pass), may_be_fine_ ? 1U : 0U, is_between_cloths(pass) ? 1U : 0U, 0, 0, contact_forces_ ? 1U : 0U};
    kernel.emplace(context_, spirv(pass), *pipeline_layout_, specialization);
  }
  return *kernel;
}

void PassKernels::bind(const vk::raii::CommandBuffer& commands, vk::DescriptorSet set) const {
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline_layout_, 0, set, {});
}

void PassKernels::run(const vk::raii::CommandBuffer& commands, const Kernel& kernel,
                      const shader::PassConstants& constants, uint32_t groups_x, uint32_t groups_y) const {
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, kernel.handle());
  commands.pushConstants<shader::PassConstants>(*pipeline_layout_, vk::ShaderStageFlagBits::eCompute, 0, constants);
  commands.dispatch(groups_x, groups_y, 1);
}

void PassKernels::dispatch(const vk::raii::CommandBuffer& commands, const ClothResources& cloth, const PassStep& step,
                           uint32_t substep, uint32_t relaxation_steps, uint32_t pins) const {
  const Kernel& kernel = this->kernel(step.pass);
  shader::PassConstants constants{.substep = substep,
                                  .group = step.group,
                                  .first = 0,
                                  .count = 0,
                                  .read_multiplier = step.relaxation > 0 ? 1U : 0U,
                                  .write_multiplier = step.relaxation + 1 < relaxation_steps ? 1U : 0U};
  const auto over_pixels = [&](shader::uvec2 size) {
    run(commands, kernel, constants, groups(size.x, shader::kGroupSide), groups(size.y, shader::kGroupSide));
  };
  switch (step.pass) {
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
    case Pass::ties:
      return over_pixels(shader::group_extent(step.group, cloth.width, cloth.height));
    case Pass::spans:
      return over_pixels(shader::span_extent(step.group, cloth.width, cloth.height));
    case Pass::collide_cells:
      return over_pixels(shader::cell_extent(cloth.width, cloth.height));
    case Pass::curvature:
      constants.count = compliance_times(step);
      return over_pixels(shader::bend_extent(step.group, cloth.width, cloth.height));
    case Pass::normals:
    case Pass::rescale:
    case Pass::predict:
    case Pass::settle:
    case Pass::limit:
    case Pass::self_move:
    case Pass::collide:
    case Pass::hold_way:
    case Pass::give_way:
    case Pass::check_colliders:
    case Pass::measure_motion:
      return over_pixels({cloth.width, cloth.height});
    case Pass::seam_bends:
    case Pass::seam_curvature:
    case Pass::seam_spans:
    case Pass::sew:
    case Pass::whole_ties:
      constants.first = cloth.seam_color_offset[step.group];
      break;
    case Pass::inter_gather:
      constants.first = cloth.inter.first_point;
      break;
    case Pass::inter_move:
      constants.first = cloth.inter.first_pixel;
      break;
    case Pass::normals_stitch:
    case Pass::pins:
    case Pass::stitch:
    case Pass::stitch_contacts:
    case Pass::self_drift:
    case Pass::self_clear:
    case Pass::self_insert:
    case Pass::self_find:
    case Pass::self_push:
    case Pass::inter_drift:
    case Pass::inter_clear:
    case Pass::inter_insert:
    case Pass::inter_find:
    case Pass::inter_push:
    case Pass::lines:
    case Pass::check_copies:
      break;
  }
  constants.count = list_count(cloth, step, pins);
  if (constants.count == 0) return;
  const uint32_t row = std::min(constants.count, shader::kListRow);
  run(commands, kernel, constants, groups(row, shader::kGroupLine), groups(constants.count, shader::kListRow));
}

void PassKernels::dispatch_inverse_mass(const vk::raii::CommandBuffer& commands, const ClothResources& cloth) const {
  run(commands, inverse_mass_, {}, groups(cloth.width, shader::kGroupSide), groups(cloth.height, shader::kGroupSide));
}

}  // namespace geocloth::vulkan
