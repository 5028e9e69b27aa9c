// SPDX-License-Identifier: Apache-2.0
// The colliders that a call puts into the place of those before: which of them go on, which are new, what wakes.

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>

#include "check_input.h"
#include "colliders/match.h"
#include "solver_impl.h"

namespace geocloth {
namespace {

std::vector<Transform> frames_of(const std::vector<Collider>& colliders) {
  std::vector<Transform> frames(colliders.size());
  std::ranges::transform(colliders, frames.begin(), collider_frame);
  return frames;
}

bool same_shape(const shader::ColliderShape& a, const shader::ColliderShape& b) {
  using Words = std::array<uint32_t, sizeof(shader::ColliderShape) / sizeof(uint32_t)>;
  return std::bit_cast<Words>(a) == std::bit_cast<Words>(b);
}

bool has_same_field(const Collider& a, const Collider& b) {
  const auto* p = std::get_if<MeshSolid>(&a.shape);
  const auto* q = std::get_if<MeshSolid>(&b.shape);
  return p != nullptr && q != nullptr && p->field == q->field;
}

constexpr float kPlaced = -1;  ///< in deform_: the collider is at once as it is asked to be

}  // namespace

/// As the last call asked for.
std::vector<Vec3> Solver::Impl::collider_places() const {
  std::vector<Vec3> places(colliders_to_.size());
  std::ranges::transform(colliders_to_, places.begin(), [](const Collider& c) { return c.pose.translate; });
  return places;
}

/// Colliders go on from where those of the last call are that they are the same as; others are placed.
/// @returns as of match_colliders(); none: each is the one at its place
std::optional<Solver::Impl::Matches> Solver::Impl::take_places(std::span<const Collider> asked_before) {
  if (std::ranges::equal(asked_before, colliders_to_, {}, &Collider::name, &Collider::name)) return std::nullopt;
  std::vector<Vec3> expected = collider_ways_;
  for (size_t i = 0; i < expected.size(); ++i) expected[i] = frames_from_[i].translate + collider_ways_[i];
  Matches before = match_colliders(asked_before, expected, colliders_to_);
  follow_colliders(before);
  const std::vector<Transform> from = std::exchange(frames_from_, frames_of(colliders_to_));
  const std::vector<Vec3> ways = std::exchange(collider_ways_, std::vector<Vec3>(colliders_to_.size()));
  const std::vector<Vec3> seen = std::exchange(places_seen_, collider_places());
  const std::vector<float> deform = std::exchange(deform_, std::vector<float>(colliders_to_.size(), kPlaced));
  std::vector<bool> is_left(asked_before.size(), false);
  for (size_t i = 0; i < before.size(); ++i) {
    if (!before[i]) {
      groups_changed_ |= colliders_to_[i].groups;
      continue;
    }
    is_left[*before[i]] = true;
    frames_from_[i] = from[*before[i]];
    collider_ways_[i] = ways[*before[i]];
    places_seen_[i] = seen[*before[i]];
    deform_[i] = deform[*before[i]];
  }
  for (size_t i = 0; i < is_left.size(); ++i)
    if (!is_left[i]) groups_changed_ |= asked_before[i].groups;
  return before;
}

void Solver::Impl::set_colliders(std::span<const Collider> colliders, bool teleport) {
  for (size_t i = 0; i < colliders.size(); ++i) {
    const bool known =
        std::ranges::any_of(colliders_to_, [&](const Collider& c) { return has_same_field(colliders[i], c); });
    check(colliders[i], "colliders[" + std::to_string(i) + "]", known);
  }
  const std::vector<Collider> asked_before =
      std::exchange(colliders_to_, std::vector<Collider>(colliders.begin(), colliders.end()));
  for (Collider& c : colliders_to_) {
    if (auto* plane = std::get_if<Plane>(&c.shape)) plane->normal = normalized(plane->normal);
  }
  const std::optional<Matches> before = take_places(asked_before);
  for (size_t i = 0; i < colliders_to_.size(); ++i) {
    if (!teleport && !colliders_to_[i].teleport) continue;
    const Transform frame = collider_frame(colliders_to_[i]);
    if (!same_place(frames_from_[i], frame)) groups_changed_ |= colliders_to_[i].groups;
    frames_from_[i] = frame;
    deform_[i] = kPlaced;
  }
  take_deformations(asked_before);
  take_shapes(asked_before, before);
}

/// A body deforms in the frame that follows its new field, and in no other.
void Solver::Impl::take_deformations(std::span<const Collider> asked_before) {
  for (size_t i = 0; i < colliders_to_.size(); ++i) {
    const Collider& collider = colliders_to_[i];
    const bool known =
        std::ranges::any_of(asked_before, [&](const Collider& c) { return has_same_field(collider, c); });
    if (deform_[i] == kPlaced) {
      deform_[i] = 0;
    } else if (!known) {
      deform_[i] = longest_deformation(collider);
    }
  }
}

/// A collider, in the next frame.
bool Solver::Impl::anything_deforms() const {
  return std::ranges::any_of(deform_, [](float way) { return way > 0; });
}

/// @param before  as of take_places()
void Solver::Impl::take_shapes(std::span<const Collider> asked_before, const std::optional<Matches>& before) {
  // Most often only poses change, and the field of a body has half a million numbers.
  const auto looks_the_same = [](const Collider& a, const Collider& b) {
    return a.shape == b.shape && a.friction == b.friction && a.groups == b.groups;
  };
  if (collider_numbers_ && std::ranges::equal(asked_before, colliders_to_, looks_the_same)) return;
  std::vector<float> numbers;
  const std::vector<shader::ColliderShape> shapes_before = std::exchange(shapes_, {});
  for (const Collider& c : colliders_to_) shapes_.push_back(collider_shape_of(c, numbers));
  const bool same_numbers = collider_numbers_ && *collider_numbers_ == numbers;
  if (!same_numbers) collider_numbers_ = std::make_shared<const std::vector<float>>(std::move(numbers));
  for (size_t i = 0; i < colliders_to_.size(); ++i) {
    const auto was = before ? (*before)[i] : std::optional(static_cast<uint32_t>(i));
    // Bodies that deform wake what they reach, as all that moves evenly does.
    if (!was || deform_[i] > 0) continue;
    const Collider &old = asked_before[*was], &now = colliders_to_[i];
    const bool same = looks_the_same(old, now) ||
                      (same_numbers && same_shape(shapes_before[*was], shapes_[i]) && old.groups == now.groups);
    if (!same) groups_changed_ |= old.groups | now.groups;
  }
}

}  // namespace geocloth
