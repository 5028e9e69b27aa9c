// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cuts are named by where they begin and what they open, not by what comes of them: charts that were cut alike have
// their vertices in the same order.
#include "develop/trial_memory.h"

namespace geocloth {

std::optional<double> TrialMemory::fall(State from, const Paths& paths, Depth depth) const {
  const std::scoped_lock lock(mutex_);
  const std::map<Key, double>& known = fall_.at(static_cast<size_t>(depth));
  const auto found = known.find({from, paths});
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

void TrialMemory::keep_fall(State from, const Paths& paths, Depth depth, double fall) {
  const std::scoped_lock lock(mutex_);
  fall_.at(static_cast<size_t>(depth)).emplace(Key{from, paths}, fall);
}

std::optional<TrialMemory::Made> TrialMemory::made(State from, const Paths& paths) const {
  const std::scoped_lock lock(mutex_);
  const auto found = made_.find({from, paths});
  return found == made_.end() ? std::nullopt : std::optional(found->second);
}

TrialMemory::State TrialMemory::keep_made(State from, const Paths& paths, std::vector<Point2> uv, double energy) {
  const std::scoped_lock lock(mutex_);
  const auto [place, is_new] = made_.try_emplace({from, paths});
  if (is_new) place->second = {++states_, std::move(uv), energy};
  return place->second.state;
}

}  // namespace geocloth
