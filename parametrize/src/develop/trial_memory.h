// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// What cuts of one chart have come to. Tastes that start from the same chart try the same cuts until they choose
/// otherwise: each is laid out once. What is found here is, bit for bit, what would be found again. Threads share it.
class TrialMemory {
 public:
  /// A chart, by the cuts that led to it.
  using State = uint32_t;
  static constexpr State kStart = 0;

  /// What is done to a chart: the paths that are opened, as its vertices.
  using Paths = std::vector<std::vector<uint32_t>>;

  /// How a chart lies with its cuts made.
  struct Made {
    State state = kStart;
    std::vector<Point2> uv;
    double energy = 0;
  };

  /// How far a cut was tried.
  enum class Depth : uint8_t { first_step, whole };

  /// By how much the energy falls with a cut, where that was tried so far.
  [[nodiscard]] std::optional<double> fall(State from, const Paths& paths, Depth depth) const;
  void keep_fall(State from, const Paths& paths, Depth depth, double fall);

  [[nodiscard]] std::optional<Made> made(State from, const Paths& paths) const;
  /// @returns the new chart's name
  State keep_made(State from, const Paths& paths, std::vector<Point2> uv, double energy);

 private:
  using Key = std::pair<State, Paths>;

  mutable std::mutex mutex_;
  std::array<std::map<Key, double>, 2> fall_;  // by Depth
  std::map<Key, Made> made_;
  State states_ = kStart;
};

}  // namespace geocloth
