// SPDX-License-Identifier: GPL-3.0-or-later
// Threads on one cloth must not meet: what two of them do at the same time, or in an order that is left to chance,
// would give other bits on another day. Races are rare where processors are idle, so this goes through the plan
// instead: all pairs of tasks that may run at once, and the points that their vectors read and write, lanes over a
// row's end too.

#include "cpu/bands.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "backend_scene.h"
#include "support/vector_targets.h"

namespace geocloth {
namespace {

using cpu::BandPlan;
using cpu::BandTask;
using test::CpuCloth;

/// Passes of a task that touch a point: the first and the last one that do, and that write it.
struct Touch {
  static constexpr int kNone = std::numeric_limits<int>::max();
  int first = kNone, last = -1, first_write = kNone, last_write = -1;
  void add(int pass, bool writes) {
    first = std::min(first, pass);
    last = std::max(last, pass);
    if (!writes) return;
    first_write = std::min(first_write, pass);
    last_write = std::max(last_write, pass);
  }
  /// Whether it matters which one comes first.
  [[nodiscard]] bool meets(const Touch& other) const {
    return (last_write >= 0 && other.last >= 0) || (last >= 0 && other.last_write >= 0);
  }
  /// Whether all that it does comes before what the other does to what it touches, as in one thread.
  [[nodiscard]] bool comes_before(const Touch& other) const {
    return last_write <= other.first && last <= other.first_write;
  }
};

/// What a task touches: positions and what goes with them for all pixels and those after the image that vectors reach,
/// then normals.
class Touched {
 public:
  Touched(const CpuCloth& cloth, uint32_t lanes)
      : width_(cloth.state.data.width),
        height_(cloth.state.data.height),
        lanes_(lanes),
        points_(size_t{width_} * (height_ + 16)),
        all_(2 * points_) {}

  void add(const cpu::SweepOp& op, int pass, const cpu::RowRange& rows) {
    const uint32_t first = op.stream->row_first[rows.first], last = op.stream->row_first[rows.last];
    for (uint32_t y = rows.first; y < rows.last; ++y) add_thirds(op, pass, y);
    for (uint32_t k = first; k < last; ++k) add_entry(op, pass, k);
  }
  [[nodiscard]] const std::vector<Touch>& all() const { return all_; }

 private:
  void add(int pass, size_t first, size_t last, bool writes = true) {
    ASSERT_LE(last, points_);
    for (size_t i = first; i < last; ++i) all_[i].add(pass, writes);
  }
  void add_thirds(const cpu::SweepOp& op, int pass, uint32_t y) {
    if (op.kernel != cpu::RowKernel::bends_along) return;
    if (op.stream->third_first[y] == op.stream->third_first[y + 1]) return;
    add(pass, size_t{y} * width_, size_t{y + 1} * width_);
  }
  void add_entry(const cpu::SweepOp& op, int pass, uint32_t k) {
    using cpu::RowKernel;
    const cpu::RowStream& stream = *op.stream;
    switch (op.kernel) {
      case RowKernel::bends_along:
        return;
      case RowKernel::normals:
        for (size_t i = stream.runs[k].first; i < stream.runs[k].last; ++i) {
          for (const size_t row : {i - std::min<size_t>(i, width_), i, i + width_})
            add(pass, row - std::min<size_t>(row, 1), row + 2, false);
          all_[points_ + i].add(pass, true);
        }
        return;
      case RowKernel::springs_across:
      case RowKernel::ties_across:
        add(pass, stream.pixel[k], stream.pixel[k] + lanes_);
        add(pass, stream.pixel[k] + op.offset, stream.pixel[k] + op.offset + lanes_);
        return;
      case RowKernel::spans_along:
        for (const uint32_t first : {stream.pixel[k], stream.pixel[k] + op.offset})
          add(pass, first, first + std::min(lanes_, cpu::kSpanLanes));
        return;
      case RowKernel::short_spans_along:
        for (const uint32_t first : {stream.pixel[k], stream.pixel[k] + op.offset})
          add(pass, first, first + std::min(lanes_, cpu::kShortSpanLanes));
        return;
      case RowKernel::springs_along:
      case RowKernel::springs_along_two:
      case RowKernel::ties_along:
        for (const uint32_t first : {stream.pixel[k], stream.second[k]}) add(pass, first, first + lanes_);
        return;
      case RowKernel::bends_across:
        for (uint32_t n = 0; n < 3; ++n)
          add(pass, stream.pixel[k] + n * op.offset, stream.pixel[k] + n * op.offset + lanes_);
        return;
      case RowKernel::limit:
        add(pass, stream.pixel[k], stream.pixel[k] + lanes_);
        return;
      default:
        add(pass, stream.runs[k].first, stream.runs[k].last);
        if (op.kernel != RowKernel::predict) return;
        for (size_t i = stream.runs[k].first; i < stream.runs[k].last; ++i) all_[points_ + i].add(pass, false);
        return;
    }
  }

  uint32_t width_, height_, lanes_;
  size_t points_;
  std::vector<Touch> all_;
};

/// Which tasks are done for certain when another one begins, whatever the threads do.
class Certain {
 public:
  Certain(const BandPlan& bands, uint32_t tasks) : count_(bands.count()) {
    done_.assign(tasks, std::vector(count_, std::vector<uint32_t>(count_, 0)));
    for (uint32_t number = 0; number < tasks; ++number) {
      for (uint32_t band = 0; band < count_; ++band) {
        std::vector<uint32_t>& own = done_[number][band];
        if (number > 0) own = done_[number - 1][band];
        own[band] = number;
        for (uint32_t other = 0; other < count_; ++other) {
          const uint32_t needed = other == band ? 0 : cpu::tasks_needed(bands, band, number, other);
          if (needed == 0) continue;
          for (uint32_t k = 0; k < count_; ++k) own[k] = std::max(own[k], done_[needed - 1][other][k]);
          own[other] = std::max(own[other], needed);
        }
      }
    }
  }
  [[nodiscard]] bool before(uint32_t band, uint32_t number, uint32_t other, uint32_t of_other) const {
    return done_[of_other][other][band] > number;
  }

 private:
  uint32_t count_;
  std::vector<std::vector<std::vector<uint32_t>>> done_;  ///< for each task of each band those of each band
};

/// What is wrong with how threads share out a plan; nothing: "".
std::string trouble(const CpuCloth& cloth, const cpu::SweepPlan& plan, const BandPlan& bands) {
  const auto tasks = static_cast<uint32_t>(bands.tasks.size()), count = bands.count();
  std::vector<std::vector<Touched>> touched(tasks);
  for (uint32_t number = 0; number < tasks; ++number) {
    const BandTask& task = bands.tasks[number];
    for (uint32_t band = 0; band < count; ++band) {
      Touched& own = touched[number].emplace_back(cloth, plan.lanes());
      const auto* sweep = std::get_if<cpu::Sweep>(&plan.parts()[task.first_part]);
      if (sweep == nullptr) continue;
      const cpu::SweepBand& rows = bands.rows_of(task.first_part, band, task.kind);
      for (size_t k = 0; k < sweep->ops.size(); ++k)
        if (rows.rows[k].first < rows.rows[k].last) own.add(sweep->ops[k], static_cast<int>(k), rows.rows[k]);
    }
  }
  const auto name = [&](uint32_t band, uint32_t number) {
    return "task " + std::to_string(number) + " of band " + std::to_string(band);
  };
  // Three substeps, so that each task meets those of the substeps before and after.
  const Certain certain(bands, 3 * tasks);
  for (uint32_t a = 0; a < 3 * tasks; ++a) {
    for (uint32_t b = a; b < 3 * tasks; ++b) {
      for (uint32_t one = 0; one < count; ++one) {
        for (uint32_t two = 0; two < count; ++two) {
          if (one == two) continue;
          const bool forth = certain.before(one, a, two, b), back = certain.before(two, b, one, a);
          const bool at_once = !forth && !back;
          const bool in_sweep =
              std::max(bands.tasks[a % tasks].kind, bands.tasks[b % tasks].kind) <= BandTask::Kind::rest;
          if (at_once && !in_sweep && a != b) return name(one, a) + " does not wait for " + name(two, b);
          // What follows in a later sweep of its own accord is in order.
          const bool same =
              a / tasks == b / tasks && bands.tasks[a % tasks].first_part == bands.tasks[b % tasks].first_part;
          if (!at_once && !same) continue;
          const std::vector<Touch>& first = touched[a % tasks][one].all();
          const std::vector<Touch>& second = touched[b % tasks][two].all();
          for (size_t i = 0; i < first.size(); ++i) {
            if (!first[i].meets(second[i])) continue;
            const std::string where = name(one, a) + ", " + name(two, b) + ", pixel " + std::to_string(i);
            if (at_once) return "at once: " + where;
            if (!(forth ? first[i].comes_before(second[i]) : second[i].comes_before(first[i])))
              return "in another order than one thread: " + where;
          }
        }
      }
    }
  }
  return "";
}

/// All rows of each pass, by one band each.
std::string missing(const cpu::SweepPlan& plan, const BandPlan& bands, uint32_t height) {
  for (uint32_t part = 0; part < plan.parts().size(); ++part) {
    const auto* sweep = std::get_if<cpu::Sweep>(&plan.parts()[part]);
    if (sweep == nullptr) continue;
    for (size_t k = 0; k < sweep->ops.size(); ++k) {
      std::vector<uint32_t> times(height, 0);
      for (uint32_t band = 0; band < bands.count(); ++band) {
        for (uint32_t kind = 0; kind < BandPlan::kSweepTasks; ++kind) {
          const cpu::SweepBand& rows = bands.rows_of(part, band, static_cast<BandTask::Kind>(kind));
          for (uint32_t y = rows.rows[k].first; y < rows.rows[k].last; ++y) {
            ++times[y];
            const uint32_t time = y + sweep->ops[k].lag;
            if (time < rows.first_time || time >= rows.end_time) return "not in time";
          }
        }
      }
      for (uint32_t y = 0; y < height; ++y)
        if (times[y] != 1)
          return "part " + std::to_string(part) + ", pass " + std::to_string(k) + ", row " + std::to_string(y);
    }
  }
  return "";
}

struct Cloth {
  std::string name;
  CpuCloth cloth;
};
std::vector<Cloth> cloths() {
  Material springs, bias = test::attached(), stiff = test::attached();
  bias.bend_warp = bias.bend_weft = bias.bend_bias = 2e-5F;
  stiff.stiffness = stiff.bend_stiffness = 1;
  std::vector<Cloth> all;
  const auto add = [&](const std::string& name, const test::SheetOptions& sheet, const Material& material,
                       bool collider = true, uint32_t relaxation_steps = 1, bool pinned = true) {
    const ClothDesc cloth = test::describe(test::make_sheet(sheet), material);
    all.push_back({name, CpuCloth(test::make_scene(cloth, collider, relaxation_steps, pinned), true)});
  };
  for (const uint32_t width : {61U, 64U, 100U, 111U}) {
    const std::string of = ", width " + std::to_string(width);
    add("hung" + of, {.nx = width, .ny = 90}, test::attached(), false);
    add("on a ball" + of, {.nx = width, .ny = 130}, test::attached());
    add("dropped" + of, {.nx = width, .ny = 130}, test::attached(), true, 1, false);
  }
  for (const uint32_t height : {40U, 75U, 200U})
    add("height " + std::to_string(height), {.nx = 64, .ny = height}, test::attached());
  add("springs only", {.nx = 100, .ny = 100}, springs, false);
  add("bent in all directions", {.nx = 100, .ny = 120}, bias);
  add("stiff", {.nx = 100, .ny = 120}, stiff);
  add("several relaxation steps", {.nx = 100, .ny = 160}, test::attached(), true, 3);
  add("cut", {.nx = 110, .ny = 120, .charts_x = 2}, test::attached());
  add("cut, with a gap", {.nx = 110, .ny = 160, .charts_x = 2, .gap = 7}, springs, false);
  return all;
}

using Bands = test::OnVectorTarget;

TEST_P(Bands, DoNothingAtOnceThatMeets) {
  uint32_t shared = 0;
  for (const Cloth& c : cloths()) {
    for (const bool finish : {false, true}) {
      const auto plan = finish ? c.cloth.finish_plan() : c.cloth.plan();
      if (!plan) continue;
      for (const uint32_t threads : {1U, 2U, 3U, 7U}) {
        const BandPlan bands = cpu::plan_bands(*plan, c.cloth.state, threads);
        const std::string where = c.name + (finish ? ", finish" : "") + ", threads " + std::to_string(threads);
        EXPECT_EQ(trouble(c.cloth, *plan, bands), "") << where;
        EXPECT_EQ(missing(*plan, bands, c.cloth.state.data.height), "") << where;
        if (bands.count() > 1) ++shared;
      }
    }
  }
  EXPECT_GT(shared, 20U);
}

/// Schedules change. Here each pass is the only one of its sweep, so that no other makes threads keep their distance.
TEST_P(Bands, DoNothingAtOnceThatMeetsInPassesByThemselves) {
  for (const uint32_t width : {64U, 100U, 111U}) {
    const CpuCloth cloth(test::make_scene({.nx = width, .ny = 90}, test::attached()), true);
    for (const PassStep& step : substep_schedule(cloth.options())) {
      for (const bool repeated : {true, false}) {  // or followed by what all have to wait for
        std::vector<PassStep> steps{step};
        if (!repeated) steps.push_back({Pass::stitch});
        const auto plan = cloth.plan_of(steps, 1);
        if (!plan || plan->parts().empty() || !std::holds_alternative<cpu::Sweep>(plan->parts().front())) continue;
        const BandPlan bands = cpu::plan_bands(*plan, cloth.state, 3);
        const std::string where = std::string(info(step.pass).name) + " " + std::to_string(step.group) + ", width " +
                                  std::to_string(width) + (repeated ? ", repeated" : "");
        EXPECT_GE(bands.count(), 2U) << where;
        EXPECT_EQ(trouble(cloth, *plan, bands), "") << where;
        EXPECT_EQ(missing(*plan, bands, cloth.state.data.height), "") << where;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Bands, Bands, testing::ValuesIn(test::vector_targets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace geocloth
