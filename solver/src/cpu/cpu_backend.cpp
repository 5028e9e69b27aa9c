// SPDX-License-Identifier: Apache-2.0
// Runs the schedules on the cpu: by sweeps through the rows where it can, else pass by pass.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "backend.h"
#include "cpu/cloth_state.h"
#include "cpu/cpu_name.h"
#include "cpu/passes.h"
#include "cpu/plan_pool.h"
#include "cpu/self_passes.h"
#include "cpu/self_runner.h"
#include "cpu/sweep_runner.h"
#include "cpu/threads.h"
#include "cpu/wide_rows.h"
#include "lib/self_words.h"
#include "rest/self_points.h"

namespace geocloth {
namespace {

using shader::vec4;

using cpu::PassSeconds;

/// Passes one by one, as the last frame had them.
struct Schedules {
  std::optional<ScheduleOptions> options;
  SubstepHalves substep;
  std::vector<PassStep> finish;

  void make(const ScheduleOptions& wanted) {
    if (options == wanted) return;  // frames that are like the one before allocate nothing
    options = wanted;
    substep = substep_halves(wanted);
    finish = finish_schedule(wanted);
  }
};

/// One cloth with what goes with it, which has references to it.
struct Cloth {
  Cloth(const ClothData& data, bool accumulate, bool fine, cpu::PlanPool& plans)
      : rows(data.width), state(rows.widened(data), accumulate, fine), sweep(state, plans) {}

  cpu::WideRows rows;
  cpu::ClothState state;
  ClothFrame frame;  ///< with wide rows
  cpu::SweepRunner sweep;
  std::optional<cpu::SelfRunner> self;  ///< made for the points as they are
  bool sweeps = false;                  ///< the frame that runs goes by sweeps
  ScheduleOptions options;
  Schedules schedules;
  bool normals_stale = true;  ///< the positions have changed since
  cpu::Measures measures;
  PassSeconds seconds{};
};

class CpuBackend final : public SolverBackend {
 public:
  CpuBackend(SimulationData data, uint32_t threads) : data_(std::move(data)), threads_(threads) {
    for (ClothData& cloth : data_.cloths) make_cloth(cloth);
    replace_inter(std::move(data_.inter));
  }

  /// Enough cloths keep every thread busy by themselves; threads within a cloth have to wait for each other.
  void run_frame(const FrameInput& frame) override {
    const auto count = static_cast<uint32_t>(cloths_.size());
    for_each(count, [&](uint32_t c, const cpu::Threads& threads) {
      if (!meets_others_[c]) run_cloth(c, frame, threads);
    });
    if (!inter_.parts.empty()) run_meeting(frame);
  }

  void wait() override {}

  void read_positions(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth]->state;
    gather(
        cloth, state.position, [&](size_t i) { return state.packed_mass(i); }, out);
  }
  void read_previous(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth]->state;
    gather(
        cloth, state.previous, [&](size_t i) { return state.inverse_mass[i]; }, out);
  }
  void read_carry(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth]->state;
    gather(
        cloth, state.carry, [&](size_t i) { return state.inverse_mass[i]; }, out);
  }
  /// Nobody else looks at the normals after a frame, so they are computed when they are asked for.
  void read_normals(uint32_t cloth, std::vector<vec4>& out) override {
    if (cloths_[cloth]->normals_stale) compute_normals(*cloths_[cloth], threads_);
    const cpu::ClothState& state = cloths_[cloth]->state;
    gather(
        cloth, state.normal, [&](size_t i) { return state.normal_length[i]; }, out);
  }

  void write_state(uint32_t cloth, std::span<const vec4> position, std::span<const vec4> previous) override {
    cpu::ClothState& state = cloths_[cloth]->state;
    state.forget();
    cloths_[cloth]->sweep.forget();
    for (uint32_t k = 0; k < position.size(); ++k) {
      const uint32_t i = cloths_[cloth]->rows.pixel(k);
      state.position.set(i, {position[k].x, position[k].y, position[k].z});
      state.set_packed_mass(i, position[k].w);
      state.previous.set(i, {previous[k].x, previous[k].y, previous[k].z});
    }
    cloths_[cloth]->normals_stale = true;
  }

  void read_memory(uint32_t cloth, ClothMemory& out) override {
    const cpu::ClothState& state = cloths_[cloth]->state;
    read_positions(cloth, out.position);
    read_previous(cloth, out.previous);
    read_carry(cloth, out.carry);
    out.offset.clear();
    if (data_.fine)
      gather(
          cloth, state.offset, [&](size_t i) { return state.inverse_mass[i]; }, out.offset);
    read_words(state.data.self, state.pixel_count(), out.found);
    out.longest_way = cloths_[cloth]->measures.longest_way;
    out.left_behind = cloths_[cloth]->measures.left_behind;
  }

  void write_memory(uint32_t cloth, const ClothMemory& memory, const ClothFrame& pins) override {
    cpu::ClothState& state = cloths_[cloth]->state;
    write_state(cloth, memory.position, memory.previous);
    const auto scatter = [&](const std::vector<vec4>& from, cpu::Vec3Array& to) {
      for (uint32_t k = 0; k < from.size(); ++k) to.set(cloths_[cloth]->rows.pixel(k), shader::xyz(from[k]));
    };
    scatter(memory.carry, state.carry);
    scatter(memory.offset, state.offset);
    cloths_[cloth]->rows.widen(pins, cloths_[cloth]->frame);
    if (state.data.attachments) state.attachments = cloths_[cloth]->frame.attachments;
    cloths_[cloth]->sweep.forget_plan();
    write_words(memory.found, state.pixel_count(), state.data.self);
    cloths_[cloth]->measures.longest_way = memory.longest_way;
    cloths_[cloth]->measures.left_behind = memory.left_behind;
  }

  [[nodiscard]] std::optional<Whereabouts> whereabouts(uint32_t cloth) const override {
    const cpu::ClothState& state = cloths_[cloth]->state;
    Whereabouts where;
    float longest2 = 0;
    for (const cpu::Run& run : cloths_[cloth]->sweep.valid()) {
      for (uint32_t i = run.first; i < run.last; ++i) {
        const shader::vec3 x = state.position.at(i), way = shader::way_of(state.point(i));
        where.box.add({x.x, x.y, x.z});
        longest2 = std::max(longest2, way.x * way.x + way.y * way.y + way.z * way.z);
      }
    }
    where.way = std::sqrt(longest2);
    return where;
  }

  void read_found(FoundPoints& out) override { read_words(inter_.points, 0, out); }
  void write_found(const FoundPoints& found) override { write_words(found, 0, inter_.points); }

  void shift(const Vec3& by) override {
    for (const std::unique_ptr<Cloth>& cloth : cloths_) {
      cpu::ClothState& state = cloth->state;
      for (size_t i = 0; i < state.pixel_count(); ++i) {
        const shader::vec3 way{by.x, by.y, by.z};
        state.position.set(i, state.position.at(i) - way);
        state.previous.set(i, state.previous.at(i) - way);
      }
    }
  }

  void add_cloth(ClothData data) override {
    const size_t count = cloths_.size();
    try {
      make_cloth(data);
      data_.cloths.push_back(std::move(data));
      meets_others_.push_back(false);
    } catch (...) {  // the others are to go on
      cloths_.resize(count);
      data_.cloths.resize(count);
      throw;
    }
  }

  void remove_cloth(uint32_t cloth) override {
    keep_maxima(cloths_[cloth]->measures, past_measures_);
    add_seconds(cloths_[cloth]->seconds, past_seconds_);
    data_.cloths.erase(data_.cloths.begin() + cloth);
    cloths_.erase(cloths_.begin() + cloth);
    meets_others_.erase(meets_others_.begin() + cloth);
    renumber_parts(inter_.parts, cloth);
  }

  void replace_topology(uint32_t cloth, ClothData data) override {
    data_.cloths[cloth] = data;
    drop_moved(data_.cloths[cloth]);
    cloths_[cloth]->state.set_topology(cloths_[cloth]->rows.widened(data));
    take_self_points(*cloths_[cloth]);
    cloths_[cloth]->sweep.forget_plan();
    cloths_[cloth]->normals_stale = true;
  }

  void replace_inter(InterData inter) override {
    inter_ = std::move(inter);
    meets_others_.assign(cloths_.size(), false);
    inter_params_ = {};
    set_self_numbers(inter_.points.numbers, inter_params_);
    for (const InterPart& part : inter_.parts) {
      meets_others_[part.cloth] = true;
      const cpu::WideRows& rows = cloths_[part.cloth]->rows;
      const shader::SelfRoom room = shader::self_room(inter_params_);
      for (uint32_t k = 0; k < part.points; ++k) {
        shader::SelfPoint& point = inter_.points.points[part.first_point + k];
        point.pixel = rows.pixel(point.pixel);
      }
      for (uint32_t k = 0; k < part.pixels; ++k) {
        uint32_t& pixel = inter_.points.words[shader::inter_pixel_word(room, part.first_pixel + k)];
        pixel = rows.pixel(pixel);
      }
    }
    inter_self_.emplace(inter_.points, 0, by_sweeps());
  }

  float longest_way(uint32_t cloth, uint32_t word) override { return cloths_[cloth]->measures.longest_way[word]; }
  uint32_t left_behind(uint32_t cloth, uint32_t word) override { return cloths_[cloth]->measures.left_behind[word]; }

  void read_contacts(uint32_t cloth, std::vector<ContactSum>& out) override { out = cloths_[cloth]->state.contacts; }

  void fill_statistics(SolverStatistics& statistics) override {
    statistics.backend = "cpu";
    statistics.device = cpu::cpu_name();
    statistics.path = by_sweeps() ? std::string("sweep ") + cpu::vector_target() : "plain";
    statistics.threads = threads_.count();
    PassSeconds seconds = inter_seconds_;
    add_seconds(past_seconds_, seconds);
    cpu::Measures largest = past_measures_;
    statistics.memory_bytes += plans_.memory_bytes() + inter_.points.memory_bytes() + inter_self_->memory_bytes();
    for (const std::unique_ptr<Cloth>& c : cloths_) {
      const Cloth& cloth = *c;
      statistics.memory_bytes += cloth.state.memory_bytes() + cloth.sweep.memory_bytes() + cloth.self->memory_bytes();
      keep_maxima(cloth.measures, largest);
      add_seconds(cloth.seconds, seconds);
    }
    statistics.copy_gap = double{largest.copy_gap};
    statistics.penetration = double{largest.penetration};
    for (const PassInfo& pass : kPasses) {
      const double time = seconds[static_cast<size_t>(pass.pass)];
      if (time > 0) statistics.passes.push_back({std::string(pass.name), time});
    }
  }

 private:
  void make_cloth(ClothData& data) {
    cloths_.push_back(std::make_unique<Cloth>(data, data_.relaxation_steps > 1, data_.fine, plans_));
    take_self_points(*cloths_.back());
    drop_moved(data);
  }

  static void keep_maxima(const cpu::Measures& from, cpu::Measures& to) {
    to.copy_gap = std::max(to.copy_gap, from.copy_gap);
    to.penetration = std::max(to.penetration, from.penetration);
  }
  static void add_seconds(const PassSeconds& from, PassSeconds& to) {
    for (size_t k = 0; k < to.size(); ++k) to[k] += from[k];
  }

  static void drop_moved(ClothData& data) {
    data.position = {};
    data.self = {};
    data.springs = {};
  }

  static void read_words(const SelfData& self, size_t pixels, FoundPoints& out) {
    out = {};
    if (self.numbers.points == 0) return;
    const FoundWords range = found_words(self.numbers, pixels);
    const auto first = self.words.begin() + static_cast<std::ptrdiff_t>(range.first);
    out.age = self.words[shader::kSelfAge];
    out.words.assign(first, first + static_cast<std::ptrdiff_t>(range.count));
  }
  static void write_words(const FoundPoints& found, size_t pixels, SelfData& self) {
    if (self.numbers.points == 0) return;
    const FoundWords range = found_words(self.numbers, pixels);
    std::ranges::copy(first_header(found.age), self.words.begin());
    std::ranges::copy(found.words, self.words.begin() + static_cast<std::ptrdiff_t>(range.first));
  }

  /// Calls body(number, threads that it may use) for some of the cloths.
  template <class Body>
  void for_each(uint32_t count, const Body& body) const {
    if (threads_.count() == 1 || count < threads_.count()) {
      for (uint32_t k = 0; k < count; ++k) body(k, threads_);
    } else {
      threads_.for_range(count, 1, [&](uint32_t first, uint32_t last) {
        for (uint32_t k = first; k < last; ++k) body(k, alone_);
      });
    }
  }

  void run_cloth(uint32_t c, const FrameInput& frame, const cpu::Threads& threads) {
    if (!begin_cloth(c, frame, threads)) return;
    run_substeps(*cloths_[c], frame, 0, cloths_[c]->options.substeps, threads);
    end_cloth(*cloths_[c], frame, threads);
  }

  /// The cloths that collide with each other, substep by substep; all of them sleep, or none.
  void run_meeting(const FrameInput& frame) {
    const auto count = static_cast<uint32_t>(inter_.parts.size());
    const auto for_parts = [&](const auto& body) {
      for_each(count, [&](uint32_t k, const cpu::Threads& threads) {
        body(inter_.parts[k], *cloths_[inter_.parts[k].cloth], threads);
      });
    };
    if (frame.cloths[inter_.parts.front().cloth].asleep) return;
    for_parts([&](const InterPart& part, Cloth&, const cpu::Threads& threads) {
      static_cast<void>(begin_cloth(part.cloth, frame, threads));
    });
    for (uint32_t s = 0; s < frame.substeps.size(); ++s) {
      for_parts([&](const InterPart&, Cloth& cloth, const cpu::Threads& threads) {
        run_substeps(cloth, frame, s, s + 1, threads);
      });
      for (const PassStep& step : inter_schedule()) {
        if (is_between_cloths(step.pass)) {
          timed(inter_seconds_, step.pass,
                [&] { inter_self_->run_between(step.pass, inter_params_, threads_, inter_.points); });
          continue;
        }
        for_parts([&](const InterPart& part, Cloth& cloth, const cpu::Threads& threads) {
          const cpu::PassContext context{frame, cloth.frame, threads, s, data_.relaxation_steps};
          timed(cloth.seconds, step.pass, [&] {
            if (step.pass == Pass::inter_gather) return cpu::inter_gather(part, context, cloth.state, inter_.points);
            inter_self_->move_part(part, context, cloth.state, inter_.points);
          });
        });
      }
      for_parts([&](const InterPart&, Cloth& cloth, const cpu::Threads& threads) {
        run_second_half(cloth, frame, s, threads);
      });
    }
    for_parts([&](const InterPart&, Cloth& cloth, const cpu::Threads& threads) { end_cloth(cloth, frame, threads); });
  }

  [[nodiscard]] cpu::SweepRunner::Measuring measuring_of(Cloth& cloth) const {
    return {&cloth.measures, data_.timings ? &cloth.seconds : nullptr};
  }
  [[nodiscard]] cpu::SweepRunner::RunPass run_one(Cloth& cloth) const {
    return [&cloth](const PassStep& step, const cpu::PassContext& context) { run_pass(step, context, cloth); };
  }

  /// @return whether it is awake
  bool begin_cloth(uint32_t c, const FrameInput& frame, const cpu::Threads& threads) {
    Cloth& cloth = *cloths_[c];
    cpu::ClothState& state = cloth.state;
    cloth.rows.widen(frame.cloths[c], cloth.frame);
    const ClothFrame& input = cloth.frame;
    if (input.pins_changed) {
      for (size_t i = 0; i < input.inverse_mass.size(); ++i) state.set_packed_mass(i, input.inverse_mass[i]);
      if (state.data.attachments && !input.attachments.empty()) state.attachments = input.attachments;
    }
    cloth.options = schedule_options(data_, c, frame);
    if (cloth.options.asleep) return false;
    state.has_yields = input.params.collider_count > 0;
    if (data_.contact_forces) state.contacts.assign(input.params.collider_count, ContactSum{});
    cloth.sweeps = by_sweeps() && cloth.sweep.begin(frame, input, cloth.options, threads, state);
    if (!cloth.sweeps) cloth.schedules.make(options_of_substeps(cloth.options));
    return true;
  }

  void run_substeps(Cloth& cloth, const FrameInput& frame, uint32_t first, uint32_t last,
                    const cpu::Threads& threads) const {
    if (cloth.sweeps) return cloth.sweep.run(first, last, measuring_of(cloth), run_one(cloth));
    for (uint32_t s = first; s < last; ++s)
      run_all(cloth.schedules.substep.before, {frame, cloth.frame, threads, s, data_.relaxation_steps}, cloth);
  }

  void run_second_half(Cloth& cloth, const FrameInput& frame, uint32_t substep, const cpu::Threads& threads) const {
    if (cloth.sweeps) return cloth.sweep.run_second_half(substep, measuring_of(cloth), run_one(cloth));
    run_all(cloth.schedules.substep.after, {frame, cloth.frame, threads, substep, data_.relaxation_steps}, cloth);
  }

  void end_cloth(Cloth& cloth, const FrameInput& frame, const cpu::Threads& threads) const {
    const cpu::PassContext last{frame, cloth.frame, threads, cloth.options.substeps - 1, data_.relaxation_steps};
    if (cloth.sweeps) {
      cloth.sweep.finish(measuring_of(cloth), run_one(cloth));
    } else {
      run_all(cloth.schedules.finish, last, cloth);
    }
    cloth.normals_stale = true;
    if (data_.timings) compute_normals(cloth, threads);
    if (!cloth.options.motion) {  // nothing of an earlier frame is left to be read as this one's
      cloth.measures.longest_way[cloth.options.motion_word] = 0;
      cloth.measures.left_behind[cloth.options.motion_word] = 0;
      return;
    }
    run({Pass::measure_motion, cloth.options.motion_word}, {frame, cloth.frame, threads, 0, data_.relaxation_steps},
        cloth);
  }

  void take_self_points(Cloth& cloth) const {
    cloth.self.emplace(cloth.state.data.self, cloth.state.pixel_count(), by_sweeps());
  }

  /// Pass by pass is the reference.
  [[nodiscard]] bool by_sweeps() const { return data_.path != SolverPath::plain; }

  static void run_pass(const PassStep& step, const cpu::PassContext& context, Cloth& cloth) {
    if (is_of_self_collision(step.pass)) return cloth.self->run(step.pass, context, cloth.state);
    cpu::run_pass(step, context, cloth.state, cloth.measures);
  }
  void run(const PassStep& step, const cpu::PassContext& context, Cloth& cloth) const {
    timed(cloth.seconds, step.pass, [&] { run_pass(step, context, cloth); });
  }
  void run_all(const std::vector<PassStep>& steps, const cpu::PassContext& context, Cloth& cloth) const {
    for (const PassStep& step : steps) run(step, context, cloth);
  }

  template <class Work>
  void timed(PassSeconds& seconds, Pass pass, const Work& work) const {
    using Clock = std::chrono::steady_clock;
    if (!data_.timings) return work();
    const auto start = Clock::now();
    work();
    seconds[static_cast<size_t>(pass)] += std::chrono::duration<double>(Clock::now() - start).count();
  }

  void compute_normals(Cloth& cloth, const cpu::Threads& threads) const {
    const FrameInput no_frame{};
    const ClothFrame no_input{};
    const cpu::PassContext context{no_frame, no_input, threads, 0, data_.relaxation_steps};
    ScheduleOptions options;
    options.splits = cloth.state.data.split_rows() > 0;
    for (const PassStep& step : frame_schedule(options)) {
      if (step.pass == Pass::normals && by_sweeps()) {
        timed(cloth.seconds, step.pass, [&] { cloth.sweep.normals(threads, cloth.state); });
      } else {
        run(step, context, cloth);
      }
    }
    cloth.normals_stale = false;
  }

  /// One vec4 for each pixel of the asset.
  /// @param w  w(i) of pixel i
  template <class W>
  void gather(uint32_t cloth, const cpu::Vec3Array& xyz, const W& w, std::vector<vec4>& out) const {
    out.resize(data_.cloths[cloth].pixel_count());
    for (uint32_t k = 0; k < out.size(); ++k) {
      const uint32_t i = cloths_[cloth]->rows.pixel(k);
      out[k] = {xyz.at(i), w(i)};
    }
  }

  SimulationData data_;  ///< positions and springs have moved to the cloths
  cpu::Threads threads_;
  cpu::Threads alone_{1};
  cpu::PlanPool plans_;
  std::vector<std::unique_ptr<Cloth>> cloths_;
  InterData inter_;
  std::optional<cpu::SelfRunner> inter_self_;
  shader::ClothParams inter_params_{};  ///< for the passes between cloths
  std::vector<bool> meets_others_;      ///< by cloth
  PassSeconds inter_seconds_{};
  cpu::Measures past_measures_;  ///< of cloths that have been removed
  PassSeconds past_seconds_{};
};

}  // namespace

std::unique_ptr<SolverBackend> make_cpu_backend(SimulationData data, uint32_t threads) {
  return std::make_unique<CpuBackend>(std::move(data), threads);
}

}  // namespace geocloth
