// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <variant>

#include "geocloth/asset/vec.h"

namespace geocloth::view {

// What a user does. Windows make these from what the system says, tests write them down. Places are in pixels of the
// picture, from its upper left corner.

enum class MouseButton : uint8_t { left, middle, right };
enum class Key : uint8_t {
  play,
  step,
  restart,
  frame_all,
  cut,
  cancel,
  show_cloth,
  show_grid,
  show_strain,
  show_charts,
  show_seams,
  springs,
  pins,
  colliders,
  panel
};

struct MouseMoved {
  Vec2 at;
};
struct MousePressed {
  MouseButton button = MouseButton::left;
  Vec2 at;
  bool shift = false, control = false;  ///< held with it
};
struct MouseReleased {
  MouseButton button = MouseButton::left;
  Vec2 at;
};
struct Scrolled {
  float steps = 0;  ///< of the wheel, away from the user
};
struct KeyPressed {
  Key key = Key::play;
};
using InputEvent = std::variant<MouseMoved, MousePressed, MouseReleased, Scrolled, KeyPressed>;

}  // namespace geocloth::view
