// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "backend.h"
#include "lib/contact_sum.h"
#include "shared/layout.h"

namespace geocloth::shader {

/// collide.h reads colliders through this.
struct ColliderSet {
  const ColliderShape* shapes;
  const ColliderPose* poses;
  uint count;
  const float* numbers;            ///< see ColliderShape::data
  ContactSum* contacts = nullptr;  ///< one for each collider; null: contacts are not summed
  float contact_scale = 0;
  float mass_inverse = 0;  ///< [1/kg] of the point that meets them
};
inline ColliderSet set_of_point(ColliderSet set, float mass_inverse) {
  set.mass_inverse = mass_inverse;
  return set;
}
inline ColliderShape collider_shape(ColliderSet set, uint i) {
  return set.shapes[i];
}
inline ColliderPose collider_pose(ColliderSet set, uint pose, uint i) {
  return set.poses[size_t{pose} * set.count + i];
}

inline float collider_number(ColliderSet set, uint i) {
  return set.numbers[i];
}

inline void add_contact(ContactSum& sum, const ContactShare& share) {
  const auto add = [&](uint k, float v) {
    const FixedPoint n = fixed_point(v);
    const auto whole = static_cast<int64_t>(uint64_t{n.high} << 32U | n.low);
    std::atomic_ref(sum[k]).fetch_add(whole, std::memory_order_relaxed);
  };
  add(0, share.impulse.x);
  add(1, share.impulse.y);
  add(2, share.impulse.z);
  add(3, share.moment.x);
  add(4, share.moment.y);
  add(5, share.moment.z);
}

inline void add_contact(const ColliderSet& set, uint i, vec3 way, vec3 position) {
  if (set.contacts == nullptr || set.mass_inverse <= 0) return;
  add_contact(set.contacts[i], contact_share(set.mass_inverse, way, position, set.contact_scale));
}

}  // namespace geocloth::shader

#include "lib/collide.h"
