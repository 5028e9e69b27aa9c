// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>

namespace geocloth::view {

/// What the mouse and the keys do (Session::handle, and the keys of window.cpp), for --help and the panel.
inline constexpr std::array<std::pair<const char*, const char*>, 15> kControls{
    {{"left on the cloth", "drag it"},
     {"left beside it, right", "orbit"},
     {"middle, shift and left", "pan"},
     {"wheel", "zoom"},
     {"control and left", "cut along a line, through all behind it"},
     {"C", "the left button cuts, until C or Escape"},
     {"space", "play, pause"},
     {"right arrow", "one frame"},
     {"R", "restart"},
     {"F", "frame all"},
     {"1 to 5", "show cloth, grid, strain, charts, seams"},
     {"S", "springs"},
     {"P", "pins"},
     {"O", "colliders"},
     {"Tab", "this panel"}}};

}  // namespace geocloth::view
