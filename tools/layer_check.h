// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// Whether cloth that is to collide with cloth begins cut through by itself or by other cloth, which no collision draws
/// apart, and whether it has got through while it was played.
class LayerCheck {
 public:
  /// Looks at where the cloths are before the first frame; reads them back.
  explicit LayerCheck(Simulation& simulation) : start_(look(simulation)) {}

  /// In plain words, with a remedy: of the beginning.
  [[nodiscard]] std::vector<std::string> warnings(const Simulation& simulation) const;
  /// The same of how the cloths are now, where that is worse; reads them back.
  [[nodiscard]] std::vector<std::string> played_warnings(Simulation& simulation) const;

 private:
  /// Pairs of triangles that cut through each other.
  struct Tangles {
    std::vector<uint64_t> within;  // per cloth; 0 where it does not collide with itself
    uint64_t between = 0;          // of cloths that collide with others
  };
  [[nodiscard]] static Tangles look(Simulation& simulation);

  Tangles start_;
};

}  // namespace geocloth
