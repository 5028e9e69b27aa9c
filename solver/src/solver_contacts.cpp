// SPDX-License-Identifier: Apache-2.0
// What cloth does to colliders: backends sum it over points and substeps, see lib/contact_sum.h.

#include <cmath>

#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "solver_impl.h"

namespace geocloth {
namespace {

/// [kg] Of the points that nothing holds.
double free_mass(const std::vector<float>& inverse_mass) {
  double mass = 0;
  for (const float w : inverse_mass)
    if (w > 0) mass += 1.0 / double{w};
  return mass;
}

}  // namespace

/// @param all_in_groups  it is told of all colliders of its groups, and not of those in met_
void Solver::Impl::sum_contacts(Cloth& cloth, ClothFrame& frame, bool all_in_groups) const {
  // A metre that the whole cloth goes in a substep: 256 of them leave the sum room, and what gravity gives a point of a
  // large cloth in a short substep has more digits than a float.
  constexpr int kDigits = 50;
  if (!settings_.contact_forces || frame.asleep) return;
  const double mass = free_mass(cloth.free_inverse_mass);
  const double scale = mass > 0 ? std::ldexp(1.0, kDigits - std::ilogb(mass)) : 1.0;
  frame.params.contact_scale = static_cast<float>(scale);
  Touched& touched = cloth.touched;
  touched.colliders.clear();
  touched.about.clear();
  touched.restored.clear();
  const auto touch = [&](uint32_t i) {
    touched.colliders.emplace_back(i);
    touched.about.push_back(colliders_to_[i].pose.translate);
  };
  if (all_in_groups) {
    for (uint32_t i = 0; i < colliders_to_.size(); ++i)
      if (meets(cloth, i)) touch(i);
  } else {
    for (const uint32_t i : met_) touch(i);
  }
  touched.origin = origin_;
  touched.force = 1 / (scale * clock().dt * settings_.frame_time);
}

/// @param before  for each collider which one it was in the last call of set_colliders()
void Solver::Impl::follow_colliders(std::span<const std::optional<uint32_t>> before) {
  for (Cloth& cloth : cloths_) {
    for (std::optional<uint32_t>& collider : cloth.touched.colliders) {
      const auto now = collider ? std::ranges::find(before, collider) : before.end();
      collider = now == before.end() ? std::nullopt : std::optional(static_cast<uint32_t>(now - before.begin()));
    }
  }
}

/// Of the last step, or of a state that has been restored since. Waits for the device.
void Solver::Impl::read_contacts(uint32_t cloth, std::vector<ContactSum>& sums) const {
  const Touched& touched = cloths_[cloth].touched;
  if (touched.restored.empty() && !touched.colliders.empty()) {
    backend_->read_contacts(cloth, sums);
    sums.resize(touched.colliders.size());
  } else {
    sums = touched.restored;
  }
}

std::vector<ContactForce> Solver::Impl::contact_forces(std::optional<uint32_t> only) {
  if (!settings_.contact_forces) {
    throw Error(ErrorCode::invalid_argument, "solver: it was made without contact_forces");
  }
  std::vector<Vec3d> forces(colliders_to_.size()), torques(forces.size());
  std::vector<ContactSum> sums;
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    const Touched& touched = cloths_[c].touched;
    if ((only && c != *only) || touched.colliders.empty()) continue;
    read_contacts(c, sums);
    for (size_t k = 0; k < sums.size(); ++k) {
      if (!touched.colliders[k]) continue;
      // What the cloth did to the collider, and not the other way round.
      const auto value = [&](size_t n) { return -touched.force * static_cast<double>(sums[k][n]); };
      const Vec3d force{value(0), value(1), value(2)}, about_origin{value(3), value(4), value(5)};
      const Vec3d lever = to_double(touched.about[k]) - to_double(touched.origin);
      forces[*touched.colliders[k]] += force;
      torques[*touched.colliders[k]] += about_origin - cross(lever, force);
    }
  }
  std::vector<ContactForce> result;
  result.reserve(forces.size());
  for (size_t i = 0; i < forces.size(); ++i) result.push_back({to_float(forces[i]), to_float(torques[i])});
  return result;
}

}  // namespace geocloth
