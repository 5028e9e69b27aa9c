// SPDX-License-Identifier: Apache-2.0
// Which colliders a cloth may come to in a frame, from where it is known to be: by its pins, by where it was seen, or
// by where it is.

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "colliders/reach.h"
#include "frame_input.h"
#include "solver_impl.h"

namespace geocloth {

using shader::vec4;

/// About all places where a cloth can be in this frame, less its reach; none where no pins tell.
std::optional<ClothBox> Solver::Impl::box_of_pins(const Cloth& cloth) const {
  if (!cloth.hangs) return std::nullopt;
  ClothBox box;
  const std::optional<ParentWay> parent = parent_way(cloth);
  for (const auto& [pixel, pin] : cloth.pins) {
    if (!pin.held()) continue;
    box.add(pin.from - origin_);
    box.add(pin.target - origin_);
    const PinBow bow = parent ? parent->bow_of(pin.from, pin.target) : PinBow{};
    if (!bow.bows) continue;
    box.add(pin.from + bow.middle - origin_);
    box.add(pin.target + bow.middle - origin_);
  }
  return box;
}

/// [m/s] Nothing about a cloth is faster in this frame: colliders, wind, pins and what sews it.
float Solver::Impl::fastest_about(const Cloth& cloth) const {
  const auto frame_time = static_cast<float>(settings_.frame_time);
  float way = 0;
  for (size_t i = 0; i < colliders_to_.size(); ++i)
    if (meets(cloth, i)) way = std::max(way, frame_.shapes[i].way * static_cast<float>(usual_substeps_));
  for (const auto& [pixel, pin] : cloth.pins) way = std::max(way, length(pin.target - pin.from));
  if (cloth.sewn_from) way = std::max(way, (*cloth.sewn_from - *cloth.sewn_to) * cloth.size);
  const float wind = wind_ ? cloth.wind_scale * (1 + wind_->turbulence) * length(wind_->velocity) : 0;
  constexpr float kAnySpeed = 1e6F;  // planes that turn have no bound
  return std::min(std::max(way / frame_time, wind), kAnySpeed);
}

/// [m] That a cloth goes in this frame from where it was seen, at most; springs that were drawn throw points faster
/// than what drew them.
/// @param speed  [m/s] that it had there
float Solver::Impl::way_from(const Cloth& cloth, float speed) const {
  constexpr float kThrown = 2, kStart = 1;  // [1], [m/s]
  const auto frame_time = static_cast<float>(settings_.frame_time);
  const float most = kThrown * std::max(speed, fastest_about(cloth)) + kStart;
  return (most + length(gravity_of(cloth)) * frame_time) * frame_time;
}

/// Where a cloth can be in this frame: as fast as it is where that is known, else as far from its pins as they let it.
/// Nothing is sure of cloth that is thrown about, or that was put where its pins are not.
void Solver::Impl::find_place(uint32_t index) {
  constexpr size_t kMany = 16;   // colliders: with fewer looking where it is does not pay
  constexpr float kThrown = 20;  // [m/s]
  Cloth& cloth = cloths_[index];
  cloth.place.reset();
  cloth.held_in_place = false;
  if (frame_.shapes.size() <= 1 || cloth.asleep || time_ < cloth.unruly_until) return;
  const bool alone = frame_.shapes.size() > kMany && !meets_others(cloth);  // others may be faster
  if (const std::optional<Whereabouts> known = alone ? backend_->whereabouts(index) : std::nullopt) {
    const float speed = known->way / static_cast<float>(cloth.displaced_in);
    if (speed < kThrown && !known->box.empty()) cloth.place = box_about(cloth, *known, speed);
  } else {
    cloth.place = box_of_pins(cloth);
    cloth.held_in_place = cloth.place.has_value();
  }
}

/// @param known  where it is, @param speed  [m/s] of its points
ClothBox Solver::Impl::box_about(const Cloth& cloth, const Whereabouts& known, float speed) const {
  const auto frame_time = static_cast<float>(settings_.frame_time);
  ClothBox box = known.box;
  float way = way_from(cloth, speed);
  way += std::abs(cloth.pressure) / cloth.weakest.areal_density * frame_time * frame_time;
  if (cloth.parent_to && !same_place(*cloth.parent_from, *cloth.parent_to)) {  // it may be taken along
    const Quat turn = cloth.parent_to->rotate * conjugate(cloth.parent_from->rotate);
    float turned = 0;
    for (uint32_t k = 0; k < 8; ++k) {
      const Vec3 corner{(k & 1U) != 0 ? known.box.high.x : known.box.low.x,
                        (k & 2U) != 0 ? known.box.high.y : known.box.low.y,
                        (k & 4U) != 0 ? known.box.high.z : known.box.low.z};
      const Vec3 moved =
          rotate(turn, corner + (origin_ - cloth.parent_from->translate)) + (cloth.parent_to->translate - origin_);
      box.add(moved);
      turned = std::max(turned, length(moved - corner));
    }
    way += turned;
  }
  box.grow(way);
  return box;
}

void Solver::Impl::look_at(uint32_t index) {
  Cloth& cloth = cloths_[index];
  backend_->read_positions(index, looked_position_);
  backend_->read_previous(index, looked_previous_);
  Seen seen;
  for (uint32_t p = 0; p < looked_position_.size(); ++p) {
    if (!cloth.asset->valid(p)) continue;
    const vec4 &x = looked_position_[p], &before = looked_previous_[p];
    seen.box.add({x.x, x.y, x.z});
    seen.speed = std::max(seen.speed, std::hypot(x.x - before.x, x.y - before.y, x.z - before.z));
  }
  seen.speed /= static_cast<float>(cloth.displaced_in);
  cloth.seen = seen;
  cloth.looked_at = true;
}

bool Solver::Impl::is_seen_near(const Cloth& cloth, uint32_t collider) const {
  const float margin =
      way_from(cloth, cloth.seen->speed) + cloth.material.thickness + cloth.asset->spacing * cloth.scale;
  return may_reach(frame_.shapes, frame_.poses, collider, cloth.seen->box, margin);
}

/// It goes on in this frame, nobody sees where.
void Solver::Impl::let_seen_go(Cloth& cloth) const {
  if (!cloth.looked_for) cloth.seen.reset();
  if (!cloth.seen) return;
  cloth.seen->box.grow(way_from(cloth, cloth.seen->speed));
  cloth.seen->speed = std::max(cloth.seen->speed, fastest_about(cloth)) +
                      length(gravity_of(cloth)) * static_cast<float>(settings_.frame_time);
}

/// Whether a cloth may meet a fast collider, so far as its pins do not tell. It is looked at, which waits for the
/// device, when the collider becomes fast and when it has come near; what is near is not looked at again for a while.
/// @param rides  it is where its carrier is
bool Solver::Impl::may_meet(uint32_t index, uint32_t collider, bool rides) {
  constexpr double kLookAgain = 0.5;  // [s]
  Cloth& cloth = cloths_[index];
  cloth.looked_for = !rides && (!cloth.parent_to || same_place(*cloth.parent_from, *cloth.parent_to));
  if (!cloth.looked_for) return true;
  if (cloth.seen && !is_seen_near(cloth, collider)) return false;
  if (!cloth.looked_at && time_ >= cloth.look_again) {
    look_at(index);
    if (!is_seen_near(cloth, collider)) return false;
  }
  cloth.look_again = std::max(cloth.look_again, cloth.looked_at ? time_ + kLookAgain : 0.0);
  return true;
}

/// Where some of the colliders are in the frame: lists of those that not all cloths meet come after all.
Solver::Impl::Meets Solver::Impl::list_colliders(uint32_t groups, std::span<const uint32_t> colliders) {
  const size_t all = colliders_to_.size();
  const auto count = static_cast<uint32_t>(colliders.size());
  if (count == all) return {groups, 0, 0, count};
  const Meets met{groups, static_cast<uint32_t>(frame_.shapes.size()), static_cast<uint32_t>(frame_.poses.size()),
                  count};
  for (const uint32_t i : colliders) frame_.shapes.push_back(frame_.shapes[i]);
  for (uint32_t s = 0; s <= substeps_; ++s)
    for (const uint32_t i : colliders) frame_.poses.push_back(frame_.poses[s * all + i]);
  return met;
}

/// What the cloths of these groups meet.
Solver::Impl::Meets Solver::Impl::met_in_groups(uint32_t groups) {
  const auto known = std::ranges::find(meets_, groups, &Meets::groups);
  if (known != meets_.end()) return *known;
  met_.clear();
  for (uint32_t i = 0; i < colliders_to_.size(); ++i)
    if (geocloth::meets(groups, colliders_to_[i])) met_.push_back(i);
  return meets_.emplace_back(list_colliders(groups, met_));
}

/// Of what its groups meet the ones that a cloth may come to, where it is known where it can be: in a crowd each cape
/// has its wearer's. What is deep in a collider comes out of it anywhere, and may come to others there. Two others are
/// left, so that the passes do the same: where there are several colliders they look at a point again.
Solver::Impl::Meets Solver::Impl::met_by(const Cloth& cloth, float stretch_limit, const Meets& shared) {
  constexpr float kSlack = 1.1F, kSpacings = 2;
  constexpr uint32_t kLeast = 2;
  if (!cloth.place || shared.count <= kLeast) return shared;
  const float margin = cloth.material.thickness + kSpacings * cloth.asset->spacing * cloth.scale;
  met_.clear();
  for (uint32_t i = 0; i < colliders_to_.size(); ++i)
    if (meets(cloth, i)) met_.push_back(i);
  ClothBox box = *cloth.place;
  if (cloth.held_in_place) box.grow(kSlack * cloth.reach * stretch_limit);
  auto far = met_.begin();
  for (bool more = true; more;) {
    const auto before = far;
    far = std::partition(far, met_.end(), [&](uint32_t i) { return are_near(swept_[i], box, margin); });
    more = far != before;
    if (2 * (far - met_.begin()) > static_cast<std::ptrdiff_t>(shared.count)) return shared;
    for (auto near = before; near != far; ++near) {
      if (frame_.shapes[*near].kind == shader::kShapePlane) continue;
      box.add(swept_[*near].low);
      box.add(swept_[*near].high);
    }
  }
  const std::ptrdiff_t left = met_.end() - far;
  std::sort(far, met_.end());
  met_.erase(far + std::min<std::ptrdiff_t>(kLeast, left), met_.end());
  std::ranges::sort(met_);
  return list_colliders(cloth.meets, met_);
}

}  // namespace geocloth
