// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/pacer.h"

#include <algorithm>

namespace geocloth::view {
namespace {

constexpr double kMostOwed = 0.25;  ///< [s] a picture that takes longer is no motion any more
constexpr double kRounding = 1e-6;  ///< of a frame

}  // namespace

void Pacer::pass(double seconds) {
  owed_ = std::min(owed_ + std::max(seconds, 0.0), std::max(kMostOwed, frame_time_));
}

bool Pacer::due() const {
  return owed_ >= (1 - kRounding) * frame_time_;
}

void Pacer::drop() {
  if (due()) owed_ = 0;
}

}  // namespace geocloth::view
