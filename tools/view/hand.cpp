// SPDX-License-Identifier: GPL-3.0-or-later
// A pin's spring pulls its one pixel, of about 1/n of the mass, with (2 pi f)^2 m/n per metre (shaders/lib/pin.h). What
// carries m g at the sag s has (2 pi f)^2 = n g / s.
#include "view/hand.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geocloth::view {
namespace {

constexpr float kSag = 0.02F;      ///< [m] when all of the cloth hangs from the hand
constexpr float kMostWeights = 3;  ///< the hardest pull, in weights of the cloth
constexpr float kGravity = 9.81F;  ///< [m/s^2] a hand is no weaker in scenes without gravity

}  // namespace

Hand::Hand(const Picked& picked, uint32_t cloth_pixels)
    : taken_(picked),
      goal_(picked.point),
      frequency_(std::sqrt(static_cast<float>(std::max(cloth_pixels, 1U)) * kGravity / kSag) /
                 (2 * std::numbers::pi_v<float>)) {}

Pin Hand::pin(const Vec3& now) const {
  const Vec3 way = goal_ - now;
  const float distance = length(way), most = kMostWeights * kSag;
  const Vec3 target = distance > most ? now + (most / distance) * way : goal_;
  return {taken_.pixel, target, frequency_};
}

}  // namespace geocloth::view
