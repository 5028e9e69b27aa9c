// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "view/screen_map.h"

namespace geocloth::view {

/// The triangle that a line over the picture cuts the scene with: through the eye and both ends, reaching just behind
/// what is cut. Not set for a line too short to have been meant, and where nothing is in front of the eye.
/// @param cut  what it is to go through
[[nodiscard]] std::optional<std::array<Vec3, 3>> cut_triangle(const ScreenMap& screen, const Vec2& from, const Vec2& to,
                                                              const Bounds& cut);

}  // namespace geocloth::view
