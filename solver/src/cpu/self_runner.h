// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/passes.h"
#include "cpu/self_arrays.h"

namespace geocloth::cpu {

/// The passes of self_passes.h: in vectors with the same bits where points suit them, else as they are.
class SelfRunner {
 public:
  /// @param points   of a cloth, or of several that collide with each other; none: there is nothing to run
  /// @param pixels   of the cloth's image; 0: of several
  /// @param vectors  whether they may be used
  SelfRunner(const SelfData& points, size_t pixels, bool vectors);

  /// One of the passes self_drift .. self_move of the cloth.
  void run(Pass pass, const PassContext& context, ClothState& state);
  /// One of the passes inter_drift .. inter_push.
  void run_between(Pass pass, const shader::ClothParams& params, const Threads& threads, SelfData& points);
  /// The pass inter_move of one of the cloths.
  void move_part(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points) const;

  [[nodiscard]] size_t memory_bytes() const;

 private:
  /// Points one after another whose pixels are one after another.
  struct PixelRun {
    uint32_t first_point, first_pixel;
  };
  struct Copy {
    uint32_t point, pixel;
  };
  void run_in_vectors(Pass pass, const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads);
  void fetch(const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first, uint32_t last);
  void drift(const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads);
  void see(const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads);
  void sort(const shader::SelfSet& set, const shader::SelfRoom& room);
  void find(const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads) const;
  void push(const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads);
  void move(const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads) const;

  SelfArrays arrays_;
  std::vector<PixelRun> runs_;  ///< of one cloth, ascending, and one for the end
  std::vector<Copy> copies_;    ///< of one cloth: all but the first of each point, by points
  PointGrid::Bounds bounds_;    ///< of the cells where points are seen
  bool in_grid_ = false;        ///< the grid has room for the points as they were seen
};

}  // namespace geocloth::cpu
