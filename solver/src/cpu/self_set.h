// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cpu/cloth_state.h"
#include "lib/point_state.h"
#include "shared/layout.h"

namespace geocloth::shader {

/// self_collide.h reads and writes a cloth, or the cloths that collide with each other, through this.
struct SelfSet {
  cpu::ClothState* cloth;  ///< of self-collision, and one whose points are gathered or moved; else null
  SelfData* data;
  bool between;
};
inline bool between_cloths(SelfSet set) {
  return set.between;
}
inline uint self_word(SelfSet set, uint i) {
  return set.data->words[i];
}
inline void set_self_word(SelfSet set, uint i, uint value) {
  set.data->words[i] = value;
}
inline const SelfPoint& self_point(SelfSet set, uint i) {
  return set.data->points[i];
}
inline vec3 pixel_position(SelfSet set, uint pixel) {
  return set.cloth->position.at(pixel);
}
inline float pixel_inverse_mass(SelfSet set, uint pixel) {
  return set.cloth->inverse_mass[pixel];
}
inline PointState pixel_state(SelfSet set, uint pixel) {
  return set.cloth->point(pixel);
}

}  // namespace geocloth::shader

#include "lib/self_collide.h"
