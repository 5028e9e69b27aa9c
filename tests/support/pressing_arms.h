// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"

namespace geocloth::test {

/// A tube about a trunk, to be caught between it, the arms that are pressed into it and the floor.
inline ClothDesc tube_about_a_trunk() {
  const TubeOptions tube{.nx = 40, .ny = 24, .radius = 0.2F, .height = 0.6F, .charts_x = 2, .center = {0, 0.1F, 0}};
  return {std::make_shared<const ClothAsset>(make_tube(tube)), {}, {}};
}

/// @param time  [s]; in the first one and a half the arms swing in and out twice
inline std::vector<Collider> pressing_arms(float time) {
  const auto arm = [time](float side, float x, const Vec3& turn_deg, const Vec3& rate) {
    Collider r{"arm", Capsule{{0, 0, 0}, {0.15F * side, -0.45F, 0}, 0.05F, 0.035F}, 0.3F, {}};
    r.pose.translate = {x, 0.35F, 0};
    r.pose.rotate =
        quat_from_euler_deg({turn_deg.x * std::sin(rate.x * time), 0, turn_deg.z * std::sin(rate.z * time)});
    return r;
  };
  return {{"trunk", Ellipsoid{{0, 0, 0}, {0.1294F, 0.3037F, 0.1026F}, {}}, 0.3F, {}},
          arm(-1, -0.1604F, {16.912F, 0, -35.652F}, {2.026F, 0, 3.98F}),
          arm(1, 0.1603F, {5.744F, 0, 50.381F}, {2.188F, 0, 2.428F}),
          {"floor", Plane{{0, -0.5F, 0}, {0, 1, 0}}, 0.3F, {}}};
}

}  // namespace geocloth::test
