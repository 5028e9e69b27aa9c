// SPDX-License-Identifier: Apache-2.0
// A frame is one command buffer: dispatch after dispatch of each cloth's plan, all cloths side by side, then a barrier.
// All that changes from frame to frame lies in buffers, so the commands are recorded once and submitted again until the
// pass list itself changes. Two frames may be under way, each with its own inputs: the host writes one while the device
// runs the other and never waits inside a frame.
#include "vulkan/vulkan_backend.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "vulkan/upload.h"

namespace geocloth::vulkan {
namespace {

using Access = vk::AccessFlagBits;
using Stage = vk::PipelineStageFlagBits;

constexpr size_t kSlots = 2;

/// One dispatch of one cloth.
struct Item {
  size_t cloth;
  const Dispatch* dispatch;
};
/// Dispatches that need no barrier between them.
using Batch = std::vector<Item>;

/// The batches in which cloths that collide with each other meet: no sooner than all are ready.
std::vector<size_t> common_meetings(const std::vector<FramePlan>& plans) {
  std::vector<size_t> batches;
  for (const FramePlan& plan : plans) batches.resize(std::max(batches.size(), plan.meetings.size()), 0);
  for (size_t m = 0; m < batches.size(); ++m) {
    size_t longest = 0;
    for (const FramePlan& plan : plans)
      if (!plan.meetings.empty()) longest = std::max(longest, plan.meetings[m] - (m > 0 ? plan.meetings[m - 1] : 0));
    batches[m] = (m > 0 ? batches[m - 1] : 0) + longest;
  }
  return batches;
}

/// The cloths' dispatches side by side: number k of every cloth in batch k, or number k since they met.
std::vector<Batch> side_by_side(const std::vector<FramePlan>& plans) {
  const std::vector<size_t> meetings = common_meetings(plans);
  std::vector<Batch> batches;
  bool first = true;  // of the cloths that collide: it does for all of them what they do together
  for (size_t c = 0; c < plans.size(); ++c) {
    const FramePlan& plan = plans[c];
    size_t met = 0;
    for (size_t k = 0; k < plan.dispatches.size(); ++k) {
      while (met < plan.meetings.size() && plan.meetings[met] <= k) ++met;
      const size_t batch = met == 0 ? k : meetings[met - 1] + k - plan.meetings[met - 1];
      batches.resize(std::max(batches.size(), batch + 1));
      const Dispatch& dispatch = plan.dispatches[k];
      const bool between = dispatch.kind == Dispatch::Kind::pass && is_between_cloths(dispatch.step.pass);
      if (!between || first) batches[batch].push_back({c, &dispatch});
    }
    first = first && plan.meetings.empty();
  }
  std::erase_if(batches, [](const Batch& batch) { return batch.empty(); });
  return batches;
}

/// The same one after another, so that each can be timed.
std::vector<Batch> one_by_one(const std::vector<Batch>& batches) {
  std::vector<Batch> result;
  for (const Batch& batch : batches)
    for (const Item& item : batch) result.push_back({item});
  return result;
}

/// Work of others on the queue, a renderer's for instance, is done with the images; see vulkan_interop.h.
void begin_barrier(const vk::raii::CommandBuffer& commands) {
  memory_barrier(commands, Stage::eAllCommands, Access::eMemoryRead | Access::eMemoryWrite, Stage::eComputeShader,
                 Access::eShaderRead | Access::eShaderWrite);
}

void pass_barrier(const vk::raii::CommandBuffer& commands) {
  memory_barrier(commands, Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader,
                 Access::eShaderRead | Access::eShaderWrite);
}

/// Everybody may use the images now, and the host may read the measures once the fence is signalled.
void end_barrier(const vk::raii::CommandBuffer& commands) {
  memory_barrier(commands, Stage::eComputeShader, Access::eShaderWrite, Stage::eAllCommands | Stage::eHost,
                 Access::eMemoryRead | Access::eMemoryWrite | Access::eHostRead);
}

/// Frees what is on the device; the sizes and flags that a schedule depends on stay.
void drop_uploaded(ClothData& cloth) {
  cloth.position = {};
  cloth.springs = {};
  cloth.cell = {};
  cloth.seam_springs = {};
  cloth.split_pixel = {};
  cloth.self = {};
}

}  // namespace

VulkanBackend::Slot::Slot(const std::shared_ptr<const Context>& context, const PassKernels& kernels,
                          const TileKernels& tile_kernels, const std::vector<ClothResources>& cloths,
                          const InterResources* inter, bool contact_forces)
    : frame(context, kernels.set_layout(), cloths, inter, contact_forces), timer(context) {
  for (const ClothResources& cloth : cloths) {
    tiles.push_back(cloth.path == SolverPath::plain
                        ? nullptr
                        : std::make_unique<TileSets>(context, tile_kernels.set_layout(), cloth));
  }
}

VulkanBackend::VulkanBackend(std::shared_ptr<const Context> context, SimulationData data)
    : context_(std::move(context)),
      data_(std::move(data)),
      limits_(tile_limits(*context_)),
      kernels_(context_, data_.fine, data_.contact_forces),
      tile_kernels_(context_, kernels_.set_layout(), data_.contact_forces) {
  cloths_.reserve(data_.cloths.size());
  if (!data_.inter.parts.empty()) inter_ = std::make_unique<InterResources>(context_, data_.inter);
  data_.inter = {};
  for (ClothData& cloth : data_.cloths) make_cloth(cloth);
  take_parts();
  std::vector<uint32_t> all(cloths_.size());
  std::iota(all.begin(), all.end(), 0U);
  compute_normals(all);
}

void VulkanBackend::make_cloth(ClothData& data) {
  const SolverPath path = choose_path(limits_, {data_.path, data.width, data.height, data_.relaxation_steps, data_.fine,
                                                data.self.numbers.points > 0 || data.may_meet_others});
  cloths_.emplace_back(context_, data, data_.relaxation_steps > 1, data_.fine, path);
  contacts_.emplace_back();
  drop_uploaded(data);
}

/// Made anew when they are asked for, after buffers of cloths have become other ones.
VulkanBackend::Slot& VulkanBackend::slot(size_t index) {
  std::vector<std::unique_ptr<Slot>> made;
  while (slots_.empty() && made.size() < kSlots)
    made.push_back(
        std::make_unique<Slot>(context_, kernels_, tile_kernels_, cloths_, inter_.get(), data_.contact_forces));
  if (slots_.empty()) slots_ = std::move(made);
  return *slots_[index];
}

VulkanBackend::Recipe VulkanBackend::recipe_of(const FrameInput& frame) const {
  Recipe recipe;
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    recipe.schedules.push_back(schedule_options(data_, c, frame));
    recipe.pins.push_back(static_cast<uint32_t>(frame.cloths[c].pins.size()));
  }
  return recipe;
}

void VulkanBackend::run_frame(const FrameInput& frame) {
  guarded("run a frame", [&] {
    for (uint32_t c = 0; c < cloths_.size(); ++c)
      if (frame.cloths[c].pins_changed) change_pins(c, frame.cloths[c]);
    Slot& slot = this->slot(next_slot_);
    next_slot_ = (next_slot_ + 1) % kSlots;
    finish(slot);
    for (uint32_t c = 0; c < cloths_.size(); ++c) {
      if (frame.cloths[c].asleep) continue;                                     // others of this frame may be under way
      const std::span<uint32_t> measures = cloths_[c].measures.as<uint32_t>();  // its frame before is over
      measures[shader::kMeasureWay + frame.motion_word] = measures[shader::kMeasureLeft + frame.motion_word] = 0;
    }
    const bool sets_changed = slot.frame.write(frame, cloths_);
    Recipe recipe = recipe_of(frame);
    if (sets_changed || recipe != slot.recipe) {
      slot.recipe = std::move(recipe);
      record(slot);
    }
    slot.frame.commands().submit();
    slot.timed = data_.timings;
    if (!data_.contact_forces) return;
    for (const ClothFrame& cloth : frame.cloths)
      slot.colliders.push_back(cloth.asleep ? std::nullopt : std::optional(cloth.params.collider_count));
  });
}

void VulkanBackend::record(Slot& slot) {
  const vk::raii::CommandBuffer& commands = slot.frame.commands().begin();  // waits, so the steps can be written
  std::vector<FramePlan> plans;
  for (size_t c = 0; c < cloths_.size(); ++c) {
    plans.push_back(plan_frame(cloths_[c].path, slot.recipe.schedules[c], slot.recipe.schedules[c].substeps,
                               {cloths_[c].split_rows, cloths_[c].seam_color_offset}, limits_.software));
    if (slot.tiles[c]) slot.tiles[c]->write_steps(plans[c].steps, cloths_[c]);
  }
  std::vector<Batch> batches = side_by_side(plans);
  if (data_.timings) batches = one_by_one(batches);
  begin_barrier(commands);
  if (data_.contact_forces) clear_contacts(slot, commands);
  if (data_.timings) slot.timer.begin(commands, batches.size());
  for (const Batch& batch : batches) {
    for (const Item& item : batch) record_dispatch(slot, commands, item.cloth, *item.dispatch);
    pass_barrier(commands);
    if (data_.timings) slot.timer.mark(commands, batch.front().dispatch->name);
  }
  if (data_.contact_forces) copy_contacts(slot, commands);
  end_barrier(commands);
  slot.frame.commands().end();
}

void VulkanBackend::clear_contacts(const Slot& slot, const vk::raii::CommandBuffer& commands) {
  for (size_t c = 0; c < slot.recipe.schedules.size(); ++c)
    if (!slot.recipe.schedules[c].asleep) slot.frame.clear_contacts(commands, c);
  memory_barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eComputeShader,
                 Access::eShaderRead | Access::eShaderWrite);
}

void VulkanBackend::copy_contacts(const Slot& slot, const vk::raii::CommandBuffer& commands) {
  memory_barrier(commands, Stage::eComputeShader, Access::eShaderWrite, Stage::eTransfer, Access::eTransferRead);
  for (size_t c = 0; c < slot.recipe.schedules.size(); ++c)
    if (!slot.recipe.schedules[c].asleep) slot.frame.copy_contacts(commands, c);
  memory_barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
}

void VulkanBackend::record_dispatch(const Slot& slot, const vk::raii::CommandBuffer& commands, size_t cloth,
                                    const Dispatch& dispatch) {
  const Pass pass = dispatch.step.pass;
  const bool alone = dispatch.kind != Dispatch::Kind::pass || pass < Pass::inter_gather || pass > Pass::inter_move;
  const vk::DescriptorSet points = alone                     ? slot.frame.set(cloth, dispatch.from_scratch)
                                   : is_between_cloths(pass) ? slot.frame.between_set()
                                                             : slot.frame.inter_set(cloth);
  if (dispatch.kind != Dispatch::Kind::pass) {
    const vk::DescriptorSet out = slot.tiles[cloth]->out_of(dispatch.from_scratch);
    return tile_kernels_.dispatch(commands, cloths_[cloth], dispatch, points, out);
  }
  kernels_.bind(commands, points);
  kernels_.dispatch(commands, cloths_[cloth], dispatch.step, dispatch.substep, data_.relaxation_steps,
                    slot.recipe.pins[cloth]);
}

void VulkanBackend::finish(Slot& slot) {
  slot.frame.commands().wait();
  if (slot.timed) slot.timer.collect(seconds_);
  slot.timed = false;
  for (uint32_t c = 0; c < slot.colliders.size(); ++c)
    if (slot.colliders[c]) slot.frame.read_contacts(c, *slot.colliders[c], contacts_[c]);
  slot.colliders.clear();
}

void VulkanBackend::wait() {
  guarded("finish a frame", [&] {
    for (size_t k = 0; k < slots_.size(); ++k) finish(*slots_[(next_slot_ + k) % slots_.size()]);  // the older first
  });
}

void VulkanBackend::add_pins(Upload& upload, uint32_t cloth, const ClothFrame& frame) const {
  upload.to_buffer(cloths_[cloth].inverse_mass, std::span(frame.inverse_mass));
  upload.to_buffer(cloths_[cloth].attachments, std::span(frame.attachments));
  if (cloths_[cloth].path == SolverPath::plain) return;
  std::vector<uint32_t> pin_of_pixel(cloths_[cloth].pixel_count(), shader::kNoPin);
  for (uint32_t i = 0; i < frame.pins.size(); ++i) pin_of_pixel[frame.pins[i].pixel.x] = i;
  upload.to_buffer(cloths_[cloth].pin_of_pixel, std::span<const uint32_t>(pin_of_pixel));
}

void VulkanBackend::change_pins(uint32_t cloth, const ClothFrame& frame) {
  wait();
  Upload upload(context_);
  add_pins(upload, cloth, frame);
  upload.run();
  run_once(context_, [&](const vk::raii::CommandBuffer& commands) {
    begin_barrier(commands);
    kernels_.bind(commands, slot(0).frame.set(cloth));
    kernels_.dispatch_inverse_mass(commands, cloths_[cloth]);
    end_barrier(commands);
  });
}

void VulkanBackend::compute_normals(const std::vector<uint32_t>& cloths) {
  run_once(context_, [&](const vk::raii::CommandBuffer& commands) {
    begin_barrier(commands);
    for (const uint32_t c : cloths) {
      kernels_.bind(commands, slot(0).frame.set(c));
      for (const PassStep& step : frame_schedule({.splits = cloths_[c].split_rows > 0})) {
        kernels_.dispatch(commands, cloths_[c], step, 0, 1, 0);
        pass_barrier(commands);
      }
    }
    end_barrier(commands);
  });
}

void VulkanBackend::read(const Image& image, std::vector<shader::vec4>& out) const {
  out.resize(size_t{image.extent().width} * image.extent().height);
  read_image(context_, image, std::as_writable_bytes(std::span(out)));
}

void VulkanBackend::read_positions(uint32_t cloth, std::vector<shader::vec4>& out) {
  guarded("read positions back", [&] { read(cloths_[cloth].position, out); });
}

void VulkanBackend::read_previous(uint32_t cloth, std::vector<shader::vec4>& out) {
  guarded("read positions back", [&] { read(cloths_[cloth].previous, out); });
}

void VulkanBackend::read_carry(uint32_t cloth, std::vector<shader::vec4>& out) {
  guarded("read positions back", [&] { read(cloths_[cloth].carry, out); });
}

void VulkanBackend::read_normals(uint32_t cloth, std::vector<shader::vec4>& out) {
  guarded("read normals back", [&] { read(cloths_[cloth].normal, out); });
}

void VulkanBackend::write_state(uint32_t cloth, std::span<const shader::vec4> position,
                                std::span<const shader::vec4> previous) {
  guarded("write a state", [&] {
    wait();
    Upload upload(context_);
    upload.to_image(cloths_[cloth].position, position);
    upload.to_image(cloths_[cloth].previous, previous);
    upload.clear_image(cloths_[cloth].carry);
    upload.clear_image(cloths_[cloth].offset);
    upload.run();
    compute_normals({cloth});
  });
}

void VulkanBackend::read_words(const Buffer& words, const FoundWords& range, FoundPoints& out) const {
  std::array<uint32_t, shader::kSelfHeader> header{};
  out.words.resize(range.count);
  read_buffer(context_, words, 0, std::as_writable_bytes(std::span(header)));
  read_buffer(context_, words, range.first * sizeof(uint32_t), std::as_writable_bytes(std::span(out.words)));
  out.age = header[shader::kSelfAge];
}

void VulkanBackend::add_words(Upload& upload, const FoundPoints& found, const FoundWords& range, const Buffer& words) {
  const std::array<uint32_t, shader::kSelfHeader> header = first_header(found.age);
  upload.to_buffer(words, std::span<const uint32_t>(header));
  upload.to_buffer(words, std::span<const uint32_t>(found.words), range.first);
}

void VulkanBackend::read_memory(uint32_t cloth, ClothMemory& out) {
  guarded("read a state back", [&] {
    wait();
    const ClothResources& from = cloths_[cloth];
    read(from.position, out.position);
    read(from.previous, out.previous);
    read(from.carry, out.carry);
    out.offset.clear();
    if (data_.fine) read(from.offset, out.offset);
    out.found = {};
    if (from.self.points > 0) read_words(from.self_words, found_words(from.self, from.pixel_count()), out.found);
    const std::span<const uint32_t> measures = from.measures.as<uint32_t>();
    for (uint32_t word = 0; word < 2; ++word) {
      out.longest_way[word] = std::bit_cast<float>(measures[shader::kMeasureWay + word]);
      out.left_behind[word] = measures[shader::kMeasureLeft + word];
    }
  });
}

void VulkanBackend::write_memory(uint32_t cloth, const ClothMemory& memory, const ClothFrame& pins) {
  guarded("restore a state", [&] {
    wait();
    const ClothResources& to = cloths_[cloth];
    Upload upload(context_);
    upload.to_image(to.position, std::span(memory.position));
    upload.to_image(to.previous, std::span(memory.previous));
    upload.to_image(to.carry, std::span(memory.carry));
    if (data_.fine) upload.to_image(to.offset, std::span(memory.offset));
    add_pins(upload, cloth, pins);
    if (to.self.points > 0) add_words(upload, memory.found, found_words(to.self, to.pixel_count()), to.self_words);
    upload.run();
    const std::span<uint32_t> measures = to.measures.as<uint32_t>();
    for (uint32_t word = 0; word < 2; ++word) {
      measures[shader::kMeasureWay + word] = std::bit_cast<uint32_t>(memory.longest_way[word]);
      measures[shader::kMeasureLeft + word] = memory.left_behind[word];
    }
    compute_normals({cloth});
  });
}

void VulkanBackend::read_found(FoundPoints& out) {
  guarded("read a state back", [&] {
    wait();
    read_words(inter_->words, found_words(inter_->numbers, 0), out);
  });
}

void VulkanBackend::write_found(const FoundPoints& found) {
  guarded("restore a state", [&] {
    wait();
    Upload upload(context_);
    add_words(upload, found, found_words(inter_->numbers, 0), inter_->words);
    upload.run();
  });
}

void VulkanBackend::shift(const Vec3& by) {
  guarded("move the origin", [&] {
    wait();
    Upload upload(context_);
    std::vector<shader::vec4> texels;
    for (const ClothResources& cloth : cloths_) {
      for (const Image* image : {&cloth.position, &cloth.previous}) {
        read(*image, texels);
        for (shader::vec4& t : texels) t = {t.x - by.x, t.y - by.y, t.z - by.z, t.w};
        upload.to_image(*image, std::span<const shader::vec4>(texels));
      }
    }
    upload.run();
  });
}

void VulkanBackend::add_cloth(ClothData data) {
  guarded("add a cloth", [&] {
    wait();
    slots_.clear();
    const auto count = static_cast<uint32_t>(cloths_.size());
    try {
      make_cloth(data);
      data_.cloths.push_back(std::move(data));
      compute_normals({count});
    } catch (...) {  // the others are to go on
      slots_.clear();
      if (cloths_.size() > count) cloths_.pop_back();
      contacts_.resize(count);
      data_.cloths.resize(count);
      throw;
    }
  });
}

void VulkanBackend::remove_cloth(uint32_t cloth) {
  guarded("remove a cloth", [&] {
    wait();
    const std::span<const uint32_t> measures = cloths_[cloth].measures.as<uint32_t>();
    for (size_t k = 0; k < measures.size(); ++k) past_measures_[k] = std::max(past_measures_[k], measures[k]);
    slots_.clear();  // their commands use what goes
    cloths_.erase(cloths_.begin() + cloth);
    contacts_.erase(contacts_.begin() + cloth);
    data_.cloths.erase(data_.cloths.begin() + cloth);
    if (inter_) renumber_parts(inter_->parts, cloth);
    take_parts();
  });
}

void VulkanBackend::replace_topology(uint32_t cloth, ClothData data) {
  guarded("change a cloth", [&] {
    wait();
    const bool grown = cloths_[cloth].upload_topology(context_, data);
    drop_uploaded(data);
    data_.cloths[cloth] = std::move(data);
    if (grown) slots_.clear();
    for (const std::unique_ptr<Slot>& slot : slots_) slot->recipe = {};  // lists have other lengths
    compute_normals({cloth});
  });
}

void VulkanBackend::replace_inter(InterData inter) {
  guarded("change a cloth", [&] {
    wait();
    if (inter_ && inter_->has_room_for(inter)) {
      inter_->upload(context_, inter);
      take_parts();
      for (const std::unique_ptr<Slot>& slot : slots_) slot->recipe = {};
      return;
    }
    slots_.clear();
    inter_ = inter.parts.empty() ? nullptr : std::make_unique<InterResources>(context_, inter);
    take_parts();
  });
}

/// Tells each cloth where it is among those that collide with each other.
void VulkanBackend::take_parts() {
  for (ClothResources& cloth : cloths_) {
    cloth.inter = {};
    cloth.inter_numbers = {};
  }
  if (!inter_) return;
  for (const InterPart& part : inter_->parts) {
    cloths_[part.cloth].inter = part;
    cloths_[part.cloth].inter_numbers = inter_->numbers;
  }
}

float VulkanBackend::longest_way(uint32_t cloth, uint32_t word) {
  return guarded("measure how far a cloth moves", [&] {
    finish(slot(next_slot_));
    return std::bit_cast<float>(cloths_[cloth].measures.as<uint32_t>()[shader::kMeasureWay + word]);
  });
}

uint32_t VulkanBackend::left_behind(uint32_t cloth, uint32_t word) {
  return guarded("measure what carries a cloth", [&] {
    finish(slot(next_slot_));
    return cloths_[cloth].measures.as<uint32_t>()[shader::kMeasureLeft + word];
  });
}

void VulkanBackend::read_contacts(uint32_t cloth, std::vector<ContactSum>& out) {
  wait();
  out = contacts_[cloth];
}

void VulkanBackend::fill_statistics(SolverStatistics& statistics) {
  const auto keep_maxima = [&](std::span<const uint32_t> measures) {
    const auto measure = [&](uint32_t i) { return double{std::bit_cast<float>(measures[i])}; };
    statistics.copy_gap = std::max(statistics.copy_gap, measure(shader::kMeasureCopyGap));
    statistics.penetration = std::max(statistics.penetration, measure(shader::kMeasurePenetration));
  };
  wait();
  statistics.backend = to_string(Backend::vulkan);
  statistics.device = context_->info().name;
  statistics.threads = 1;
  if (inter_) statistics.memory_bytes += inter_->memory_bytes();
  for (const auto& [name, seconds] : seconds_) statistics.passes.push_back({name, seconds});
  for (const ClothResources& cloth : cloths_) {
    statistics.memory_bytes += cloth.memory_bytes();
    const std::string path = to_string(cloth.path);
    if (statistics.path.find(path) == std::string::npos)
      statistics.path += (statistics.path.empty() ? "" : ", ") + path;
    keep_maxima(cloth.measures.as<uint32_t>());
  }
  keep_maxima(past_measures_);
}

std::unique_ptr<SolverBackend> make_backend(std::shared_ptr<const Context> context, SimulationData data) {
  return guarded("set up the solver",
                 [&] { return std::make_unique<VulkanBackend>(std::move(context), std::move(data)); });
}

}  // namespace geocloth::vulkan

namespace geocloth {

std::unique_ptr<SolverBackend> make_vulkan_backend(SimulationData data, const std::string& device) {
  return vulkan::make_backend(std::make_shared<vulkan::Context>(vulkan::DeviceWish{.name = device}), std::move(data));
}

}  // namespace geocloth
