// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/solver/collider.h"

namespace geocloth {

/// Which collider of the last call each collider is, by Solver::set_colliders' rule: none that is new. No two are the
/// same one.
/// @param expected  [m] where the frames of those before are if they go on as in the last frame
[[nodiscard]] std::vector<std::optional<uint32_t>> match_colliders(std::span<const Collider> before,
                                                                   std::span<const Vec3> expected,
                                                                   std::span<const Collider> now);

}  // namespace geocloth
