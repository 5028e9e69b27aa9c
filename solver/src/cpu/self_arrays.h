// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cpu/point_grid.h"
#include "cpu/self_set.h"

namespace geocloth::cpu {

/// Points of self-collision, or of the collision between cloths, as vectors read and write them beside the words of
/// lib/self_words.h.
struct SelfArrays {
  static constexpr uint32_t kPlaceNumbers = 4;

  explicit SelfArrays(size_t points)
      : position(points + kOverhang, 0),
        place(make_floats(kPlaceNumbers * points, 3)),
        cells{counts(points), counts(points), counts(points)},
        pushed(points, 0),
        grid(points, 4) {}

  Vec3Array position;           ///< [m] in this substep
  Floats place;                 ///< the same, four numbers for each point, so that one load reads a point
  PointGrid::Cells cells;       ///< where neighbours are looked up
  std::vector<uint8_t> pushed;  ///< 1: the point was pushed in this substep, and its push is among the words
  PointGrid grid;

 private:
  static std::vector<int32_t> counts(size_t points) { return std::vector<int32_t>(points + kOverhang, 0); }
};

/// How far points went from where they were seen: widens `all`. Fills their places.
void run_self_drift(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                    uint32_t last, shader::SelfDrift& all);
/// The cells of points, which are seen there; widens `bounds`. A point that is nowhere has no neighbours.
void run_self_cells(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                    uint32_t last, PointGrid::Bounds& bounds);
/// The neighbours of the points in some cells of the grid.
void run_self_find(const SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                   uint32_t first_cell, uint32_t last_cell);
/// The pushes of points.
void run_self_push(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                   uint32_t last);

}  // namespace geocloth::cpu
