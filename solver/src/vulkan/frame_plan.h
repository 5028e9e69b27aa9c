// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geocloth/solver/solver.h"
#include "pass.h"
#include "shared/layout.h"
#include "shared/tile.h"

namespace geocloth::vulkan {

/// What a device offers to work groups that run several passes.
struct TileLimits {
  uint32_t shared_bytes = 0;  ///< of one work group
  uint32_t invocations = 0;   ///< of one work group
  uint32_t subgroup = 1;      ///< invocations that go together
  bool descriptors = false;   ///< shaders can have all that tile.comp binds
  bool software = false;      ///< a CPU: there passes one by one are faster
};

/// What the choice of a path depends on.
struct PathNeeds {
  SolverPath wish = SolverPath::automatic;
  uint32_t width = 0, height = 0;
  uint32_t relaxation_steps = 1;
  bool fine = false;            ///< constraints act on offsets, which only the plain path can
  bool points_collide = false;  ///< with each other, or with those of other cloths: needs all of the cloth between two
                                ///< passes
};

/// One that the device can run for this cloth: what is wished for, or else the fastest; plain in doubt.
[[nodiscard]] SolverPath choose_path(const TileLimits& limits, const PathNeeds& needs);

/// Pixels of a tile's side so that it fits with its border; 0 when it does not.
[[nodiscard]] uint32_t tile_side(const TileLimits& limits, uint32_t border);

/// One dispatch of a cloth.
struct Dispatch {
  enum class Kind : uint8_t {
    pass,  ///< one step of the schedule over the images
    tile,  ///< several ones, tile by tile, from one set of images to the other
    tiny   ///< many of a frame, or all, in one work group
  };
  Kind kind = Kind::pass;
  PassStep step{};               ///< of a pass
  uint32_t substep = 0;          ///< of a pass
  bool from_scratch = false;     ///< points are in the scratch images before it
  uint32_t border = 0;           ///< of a tile
  bool contacts = false;         ///< of a tile or tiny: there are steps that meet colliders
  shader::TileConstants tile{};  ///< of the others
  std::string name = {};         ///< of its passes
};

/// What one cloth does in a frame.
struct FramePlan {
  std::vector<Dispatch> dispatches;
  std::vector<shader::TileStep> steps;
  std::vector<size_t>
      meetings;  ///< where it collides with other cloths: the first of the dispatches of inter_schedule()
};

/// Lists of a cloth that passes run over.
struct ClothLists {
  uint32_t split_rows = 0;
  std::span<const uint32_t> seam_color_offset;  ///< see ClothData
};

/// @param short_dispatches  tiny: one for each substep instead of one for the frame. Software devices need it: llvmpipe
///   leaves all loops of an invocation once they have gone round 65,535 times together, and says nothing
[[nodiscard]] FramePlan plan_frame(SolverPath path, const ScheduleOptions& options, uint32_t substeps,
                                   const ClothLists& lists, bool short_dispatches = false);

}  // namespace geocloth::vulkan
