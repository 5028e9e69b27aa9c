// SPDX-License-Identifier: Apache-2.0
// Which dispatches a frame is made of. A tile's border has to be as wide as all that its passes can carry from pixel to
// pixel: a group of springs carries what is wrong at the region's sides one pixel further in, or two over two pixels.

#include "vulkan/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lib/bend_groups.h"
#include "lib/spring_groups.h"

namespace geocloth::vulkan {
namespace {

constexpr uint32_t kLargestSide = 32;
constexpr uint32_t kSideStep = 8;
constexpr uint32_t kWidestBorder = 12;  ///< stiff bends take 10 and four structural groups 2

/// Nothing for a pass that a work group does not run by itself.
std::optional<uint32_t> tile_pass(Pass pass) {
  switch (pass) {
    case Pass::normals:
      return shader::kTileNormals;
    case Pass::normals_stitch:
      return shader::kTileNormalsStitch;
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
      return shader::kTileSprings;
    case Pass::seam_bends:
      return shader::kTileSeamBends;
    case Pass::curvature:
      return shader::kTileBends;
    case Pass::seam_curvature:
      return shader::kTileSeamCurvature;
    case Pass::seam_spans:
      return shader::kTileSeamSpans;
    case Pass::sew:
      return shader::kTileSew;
    case Pass::spans:
      return shader::kTileSpans;
    case Pass::stitch:
      return shader::kTileStitch;
    case Pass::hold_way:
      return shader::kTileHoldWay;
    case Pass::lines:
      return shader::kTileLines;
    case Pass::ties:
      return shader::kTileTies;
    case Pass::whole_ties:
      return shader::kTileWholeTies;
    case Pass::give_way:
      return shader::kTileGiveWay;
    case Pass::limit:
      return shader::kTileLimit;
    case Pass::collide:
      return shader::kTileCollide;
    case Pass::check_copies:
      return shader::kTileCheckCopies;
    case Pass::check_colliders:
      return shader::kTileCheckColliders;
    case Pass::predict:
    case Pass::pins:  // with the prediction
      return shader::kTilePredict;
    default:
      return {};
  }
}

/// Pixels that a step carries something sideways and downwards.
struct Way {
  uint32_t x = 0, y = 0;
};
Way way_of(const PassStep& step) {
  switch (step.pass) {
    case Pass::structural:
    case Pass::ties:
    case Pass::shear:
    case Pass::bending: {
      const uint32_t component = shader::group_component(step.group), two = component >= 4 ? 2 : 1;
      if (component == 2 || component == 3) return {1, 1};
      return component % 2 == 0 ? Way{two, 0} : Way{0, two};
    }
    case Pass::curvature:
      return shader::bend_component(step.group) == 4 ? Way{2, 0} : Way{0, 2};
    default:
      return {};
  }
}

/// Passes that only need points near their own, before and after the stitch of the shear springs and the spans, which
/// reach too far for a tile; at a frame's end, after the lines, which reach through all of the cloth, before and after
/// the stitch of the ties. tile.comp holds no others, and where colliders are met, in the second one, no prediction.
bool is_in_first_tile(Pass pass) {
  return pass == Pass::predict || pass == Pass::pins || pass == Pass::shear || pass == Pass::ties;
}
bool is_in_second_tile(Pass pass) {
  return pass == Pass::bending || pass == Pass::curvature || pass == Pass::structural || pass == Pass::limit ||
         pass == Pass::collide || pass == Pass::give_way;
}

/// Of every free point.
bool writes_history(Pass pass) {
  return pass == Pass::predict || pass == Pass::collide || pass == Pass::hold_way || pass == Pass::give_way;
}

/// In a step of a tile.
bool meets_colliders(const shader::TileStep& step) {
  return step.pass == shader::kTileCollide || step.pass == shader::kTileGiveWay ||
         step.pass == shader::kTileCheckColliders;
}

bool starts_tile(Pass pass) {
  return pass == Pass::predict || pass == Pass::ties;
}

class Planner {
 public:
  Planner(const ScheduleOptions& options, const ClothLists& lists) : options_(options), lists_(lists) {}

  void add_passes(const std::vector<PassStep>& schedule, uint32_t substep) {
    for (const PassStep& step : schedule) add_pass(step, substep, false);
  }

  /// From the cloth's images to the scratch images and back.
  void add_tiles(const std::vector<PassStep>& schedule, uint32_t substep) {
    bool in_scratch = false;
    for (size_t k = 0; k < schedule.size();) {
      const auto belongs = [&](size_t i) {
        return in_scratch ? is_in_second_tile(schedule[i].pass) : is_in_first_tile(schedule[i].pass);
      };
      size_t end = k;
      // What follows the stitch of the second tile is points by themselves, which has no use for tiles.
      const bool begins = in_scratch ? is_in_second_tile(schedule[k].pass) : starts_tile(schedule[k].pass);
      while (begins && end < schedule.size() && belongs(end)) ++end;
      if (end == k) {
        add_pass(schedule[k++], substep, in_scratch);
        continue;
      }
      add_tile(std::span(schedule).subspan(k, end - k), substep, in_scratch);
      in_scratch = !in_scratch;
      k = end;
    }
  }

  void add_all_steps(const std::vector<PassStep>& schedule, uint32_t substep) {
    for (const PassStep& step : schedule) add_step(step, substep);
  }

  /// Of the steps since the last one.
  void add_tiny_dispatch() {
    plan_.dispatches.push_back({.kind = Dispatch::Kind::tiny,
                                .contacts = contacts_since(dispatched_),
                                .tile = {.first = dispatched_, .count = step_count() - dispatched_, .keep_history = 0},
                                .name = "whole_frame"});
    dispatched_ = step_count();
  }

  FramePlan take() { return std::move(plan_); }

 private:
  void add_pass(const PassStep& step, uint32_t substep, bool from_scratch) {
    if (step == inter_schedule().front()) plan_.meetings.push_back(plan_.dispatches.size());
    plan_.dispatches.push_back(
        {.step = step, .substep = substep, .from_scratch = from_scratch, .name = std::string(info(step.pass).name)});
  }

  void add_tile(std::span<const PassStep> steps, uint32_t substep, bool from_scratch) {
    Dispatch dispatch{.kind = Dispatch::Kind::tile, .substep = substep, .from_scratch = from_scratch};
    dispatch.tile = {.first = step_count(), .count = 0, .keep_history = 1};
    Way way;
    for (const PassStep& step : steps) {
      add_step(step, substep);
      way = {way.x + way_of(step).x, way.y + way_of(step).y};
      if (writes_history(step.pass)) dispatch.tile.keep_history = 0;
      const std::string_view name = info(step.pass).name;
      if (dispatch.name.ends_with(name)) continue;
      if (!dispatch.name.empty()) dispatch.name.push_back('+');
      dispatch.name.append(name);
    }
    dispatch.tile.count = step_count() - dispatch.tile.first;
    dispatch.contacts = contacts_since(dispatch.tile.first);
    dispatch.border = std::max(way.x, way.y);
    plan_.dispatches.push_back(std::move(dispatch));
  }

  void add_step(const PassStep& step, uint32_t substep) {
    if (step.pass == Pass::pins) return;
    const bool colored = is_over_seams(step.pass);
    const uint32_t first = colored ? lists_.seam_color_offset[step.group] : 0;
    const uint32_t count = colored                        ? lists_.seam_color_offset[step.group + 1] - first
                           : step.pass == Pass::curvature ? compliance_times(step)
                                                          : lists_.split_rows;
    plan_.steps.push_back({.pass = *tile_pass(step.pass),
                           .substep = substep,
                           .group = step.group,
                           .first = first,
                           .count = count,
                           .read_multiplier = step.relaxation > 0 ? 1U : 0U,
                           .write_multiplier = step.relaxation + 1 < options_.relaxation_steps ? 1U : 0U,
                           .pins = options_.pins ? 1U : 0U});
  }

  [[nodiscard]] bool contacts_since(uint32_t step) const {
    return std::any_of(plan_.steps.begin() + step, plan_.steps.end(), meets_colliders);
  }
  [[nodiscard]] uint32_t step_count() const { return static_cast<uint32_t>(plan_.steps.size()); }

  const ScheduleOptions& options_;
  const ClothLists& lists_;
  FramePlan plan_;
  uint32_t dispatched_ = 0;  ///< steps
};

bool fits_tiny(const TileLimits& limits, const PathNeeds& needs) {
  const size_t bytes = size_t{needs.width} * needs.height * sizeof(shader::vec4);
  return limits.descriptors && !needs.fine && !needs.points_collide && bytes <= limits.shared_bytes;
}

/// Multipliers of springs in a border would have to be kept twice.
bool fits_tiled(const TileLimits& limits, const PathNeeds& needs) {
  return limits.descriptors && !needs.fine && needs.relaxation_steps == 1 && tile_side(limits, kWidestBorder) > 0;
}

}  // namespace

SolverPath choose_path(const TileLimits& limits, const PathNeeds& needs) {
  const bool automatic = needs.wish == SolverPath::automatic && !limits.software;
  if ((automatic || needs.wish == SolverPath::tiny) && fits_tiny(limits, needs)) return SolverPath::tiny;
  if ((automatic || needs.wish == SolverPath::tiled) && fits_tiled(limits, needs)) return SolverPath::tiled;
  return SolverPath::plain;
}

uint32_t tile_side(const TileLimits& limits, uint32_t border) {
  const auto region = static_cast<uint32_t>(std::sqrt(limits.shared_bytes / sizeof(shader::vec4)));
  if (region < 2 * border + kSideStep) return 0;
  return std::min(kLargestSide, (region - 2 * border) / kSideStep * kSideStep);
}

FramePlan plan_frame(SolverPath path, const ScheduleOptions& options, uint32_t substeps, const ClothLists& lists,
                     bool short_dispatches) {
  if (options.asleep) return {};
  Planner planner(options, lists);
  const std::vector<PassStep> substep = substep_schedule(options), finish = finish_schedule(options);
  const std::vector<PassStep> end = frame_schedule(options);
  const auto runs_alone = [](const PassStep& step) { return tile_pass(step.pass).has_value(); };
  if (path == SolverPath::tiny && !std::ranges::all_of(substep, runs_alone)) path = SolverPath::plain;
  const auto add = [&](const std::vector<PassStep>& steps, uint32_t s) {
    if (path == SolverPath::tiny) {
      planner.add_all_steps(steps, s);
    } else if (path == SolverPath::tiled) {
      planner.add_tiles(steps, s);
    } else {
      planner.add_passes(steps, s);
    }
  };
  for (uint32_t s = 0; s < substeps; ++s) {
    add(substep, s);
    if (path == SolverPath::tiny && short_dispatches) planner.add_tiny_dispatch();
  }
  add(finish, substeps - 1);
  if (path == SolverPath::tiny) {
    const auto in_group = std::ranges::find_if_not(end, runs_alone);
    planner.add_all_steps({end.begin(), in_group}, 0);
    planner.add_tiny_dispatch();
    planner.add_passes({in_group, end.end()}, 0);
    return planner.take();
  }
  planner.add_passes(end, 0);
  return planner.take();
}

}  // namespace geocloth::vulkan
