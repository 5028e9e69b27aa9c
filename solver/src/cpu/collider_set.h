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
  vec3 gravity_step{0, 0, 0};
  float mass_inverse = 0;  ///< [1/kg] of the point that meets them
  float yield = 1;         ///< of it, as far as that counts for contact sums
};
inline ColliderSet set_of_point(ColliderSet set, float mass_inverse, float yield) {
  set.mass_inverse = mass_inverse;
  set.yield = yield;
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

inline void add_share(ContactSum& sum, const ContactShare& share) {
  const auto whole = [](float v) {  // fixed_point(), in one instruction
    return static_cast<uint64_t>(abs(v) < kLargestContact ? static_cast<int64_t>(v) : 0);
  };
  const auto add = [&](uint k, float v) {
    sum[k] = static_cast<int64_t>(static_cast<uint64_t>(sum[k]) + whole(v));  // beyond its ends it goes on
  };
  add(0, share.impulse.x);
  add(1, share.impulse.y);
  add(2, share.impulse.z);
  add(3, share.moment.x);
  add(4, share.moment.y);
  add(5, share.moment.z);
}

/// To what several threads add to.
inline void add_sum(ContactSum& sum, const ContactSum& more) {
  for (size_t k = 0; k < sum.size(); ++k) std::atomic_ref(sum[k]).fetch_add(more[k], std::memory_order_relaxed);
}

inline void add_contact(const ColliderSet& set, uint i, vec3 way, vec3 n, vec3 position) {
  if (set.contacts == nullptr || set.mass_inverse <= 0) return;
  ContactSum one{};
  const vec3 borne = borne_way(way, n, set.gravity_step, set.yield);
  add_share(one, contact_share(set.mass_inverse, borne, position, set.contact_scale));
  add_sum(set.contacts[i], one);
}

}  // namespace geocloth::shader

#include "lib/collide.h"
