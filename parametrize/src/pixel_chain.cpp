// SPDX-License-Identifier: GPL-3.0-or-later
//
// The outline of a free-form chart on the pixel lattice. Zippering (Sander et al. 2003) lets both sides of a seam be
// rasterised as they fall and merges samples afterwards, which spoils the spacing along the seam. Here the samples come
// first (equal arc length, shared by both sides) and each side looks for a lattice way with exactly that many steps.

#include "pixel_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace geocloth {
namespace {

constexpr std::array<Pixel, 8> kStep{{{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// How far inside of its sample a pixel should lie [pixels]: the two sides of a narrow slit part by themselves.
constexpr double kInset = 0.25;
/// Cost of a turn by 0, 45, 90 and 135 degrees, in squared pixels: keeps straight outlines straight.
constexpr std::array<double, 4> kTurnCost{0, 0, 0.15, 1.5};

Pixel moved(const Pixel& p, size_t direction) {
  return {p[0] + kStep[direction][0], p[1] + kStep[direction][1]};
}

double squared_distance(const Pixel& p, const Point2& q) {
  const double dx = p[0] - q[0];
  const double dy = p[1] - q[1];
  return dx * dx + dy * dy;
}

/// Pixels and diagonals in use.
class Occupancy {
 public:
  [[nodiscard]] bool free(const Pixel& p) const { return !pixels_.contains(p); }
  void take(const Pixel& p) { pixels_.insert(p); }
  /// A diagonal step may not cross another through the same cell.
  [[nodiscard]] bool may_step(const Pixel& from, size_t direction) const {
    if (direction % 2 == 0) return true;
    return !diagonals_.contains(cell(from, direction));
  }
  void take_step(const Pixel& from, size_t direction) {
    if (direction % 2 == 1) diagonals_.insert(cell(from, direction));
  }

 private:
  static Pixel cell(const Pixel& from, size_t direction) {
    const Pixel to = moved(from, direction);
    return {std::min(from[0], to[0]), std::min(from[1], to[1])};
  }
  std::set<Pixel> pixels_;
  std::set<Pixel> diagonals_;  // by the top left pixel of their cell
};

/// The nearest free pixel to a place, by distance and then by row and column.
Pixel nearest_free(const Occupancy& occupied, const Point2& place) {
  const Pixel centre{static_cast<int32_t>(std::lround(place[0])), static_cast<int32_t>(std::lround(place[1]))};
  for (int32_t radius = 0;; ++radius) {
    std::optional<Pixel> best;
    for (int32_t y = -radius; y <= radius; ++y) {
      for (int32_t x = -radius; x <= radius; ++x) {
        const Pixel p{centre[0] + x, centre[1] + y};
        if (occupied.free(p) && (!best || squared_distance(p, place) < squared_distance(*best, place))) best = p;
      }
    }
    if (best) return *best;
  }
}

Point2 inset(const ChainRun& run, size_t i) {
  return {run.target[i][0] + kInset * run.inward[i][0], run.target[i][1] + kInset * run.inward[i][1]};
}

/// A stretch of a run with the pixels of its ends.
struct Stretch {
  const ChainRun& run;
  size_t first, last;  // samples
  Pixel from, to;
  [[nodiscard]] size_t steps() const { return last - first; }
  [[nodiscard]] Point2 place(size_t i) const { return inset(run, first + i); }
};

/// The cheapest way of exactly as many steps as the stretch has, within `radius` of the targets.
std::vector<Pixel> find_way(const Stretch& stretch, const Occupancy& occupied, int32_t radius) {
  const Pixel &from = stretch.from, &to = stretch.to;
  const auto steps = static_cast<int32_t>(stretch.steps());
  const int32_t side = 2 * radius + 1;
  const auto states = static_cast<size_t>(side * side) * 8;
  struct Window {
    Pixel corner;
    std::vector<double> cost;   // per (pixel, arriving direction)
    std::vector<int16_t> from;  // arriving direction of the pixel before
  };
  std::vector<Window> window(stretch.steps() + 1);
  for (size_t i = 0; i < window.size(); ++i) {
    const Point2 place = stretch.place(i);
    window[i].corner = {static_cast<int32_t>(std::lround(place[0])) - radius,
                        static_cast<int32_t>(std::lround(place[1])) - radius};
    window[i].cost.assign(states, kInfinity);
    window[i].from.assign(states, -1);
  }
  const auto index = [&](const Window& w, const Pixel& p) -> int32_t {
    const int32_t x = p[0] - w.corner[0], y = p[1] - w.corner[1];
    return x < 0 || y < 0 || x >= side || y >= side ? -1 : y * side + x;
  };
  const auto arrive = [&](int32_t i, const Pixel& p, size_t direction, double cost, int16_t before) {
    Window& w = window[static_cast<size_t>(i)];
    const int32_t cell = index(w, p);
    if (cell < 0) return;
    const bool last = i == steps;
    if (last ? p != to : !occupied.free(p)) return;
    // Not so far from the end that it cannot be reached any more.
    if (std::max(std::abs(to[0] - p[0]), std::abs(to[1] - p[1])) > steps - i) return;
    const double total = cost + (last ? 0 : squared_distance(p, stretch.place(static_cast<size_t>(i))));
    const size_t state = static_cast<size_t>(cell) * 8 + direction;
    if (total < w.cost[state]) {
      w.cost[state] = total;
      w.from[state] = before;
    }
  };
  for (size_t d = 0; d < 8; ++d) {
    if (occupied.may_step(from, d)) arrive(1, moved(from, d), d, 0, -1);
  }
  for (int32_t i = 1; i < steps; ++i) {
    const Window& w = window[static_cast<size_t>(i)];
    for (int32_t cell = 0; cell < side * side; ++cell) {
      const Pixel p{w.corner[0] + cell % side, w.corner[1] + cell / side};
      for (size_t d = 0; d < 8; ++d) {
        const double cost = w.cost[static_cast<size_t>(cell) * 8 + d];
        if (cost == kInfinity) continue;
        for (size_t turn = 0; turn < kTurnCost.size(); ++turn) {
          for (const size_t next : {(d + turn) % 8, (d + 8 - turn) % 8}) {
            if (!occupied.may_step(p, next)) continue;
            arrive(i + 1, moved(p, next), next, cost + kTurnCost[turn], static_cast<int16_t>(d));
          }
        }
      }
    }
  }
  // Back from the end.
  const Window& end = window[static_cast<size_t>(steps)];
  const int32_t end_cell = index(end, to);
  if (end_cell < 0) return {};
  const auto first = end.cost.begin() + static_cast<std::ptrdiff_t>(end_cell) * 8;
  auto direction = static_cast<int16_t>(std::min_element(first, first + 8) - first);
  if (*(first + direction) == kInfinity) return {};
  std::vector<Pixel> way(stretch.steps() + 1);
  way.back() = to;
  Pixel p = to;
  for (int32_t i = steps; i >= 1; --i) {
    const Window& w = window[static_cast<size_t>(i)];
    const size_t state = static_cast<size_t>(index(w, p)) * 8 + static_cast<size_t>(direction);
    p = {p[0] - kStep[static_cast<size_t>(direction)][0], p[1] - kStep[static_cast<size_t>(direction)][1]};
    way[static_cast<size_t>(i) - 1] = p;
    direction = w.from[state];
  }
  return way;
}

size_t direction_of(const Pixel& from, const Pixel& to) {
  for (size_t d = 0; d < 8; ++d) {
    if (moved(from, d) == to) return d;
  }
  return 8;
}

/// The dynamic programme does not see a run that comes back to itself or crosses itself.
bool simple(const std::vector<Pixel>& way) {
  Occupancy own;
  for (size_t i = 0; i + 1 < way.size(); ++i) {
    const size_t d = direction_of(way[i], way[i + 1]);
    if (!own.may_step(way[i], d) || (i > 0 && !own.free(way[i]))) return false;
    if (i > 0) own.take(way[i]);
    own.take_step(way[i], d);
  }
  return true;
}

void take_way(Occupancy& occupied, const std::vector<Pixel>& way) {
  for (size_t i = 0; i + 1 < way.size(); ++i) {
    occupied.take(way[i]);
    occupied.take_step(way[i], direction_of(way[i], way[i + 1]));
  }
}

/// The way of a stretch as a whole or, where that comes back to itself (a run around a narrow spike), as two halves of
/// which the second keeps clear of the first. Takes its pixels when it succeeds.
std::vector<Pixel> place_way(const Stretch& stretch, Occupancy& occupied) {
  const Pixel &a = stretch.from, &b = stretch.to;
  const int32_t apart = std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1]));
  if (static_cast<size_t>(apart) > stretch.steps()) return {};
  const bool whole = stretch.steps() + 1 == stretch.run.target.size();
  for (const int32_t radius : whole ? std::vector<int32_t>{2, 3, 6} : std::vector<int32_t>{2, 4}) {
    std::vector<Pixel> way = find_way(stretch, occupied, radius);
    if (way.empty() || !simple(way)) continue;
    take_way(occupied, way);
    return way;
  }
  constexpr size_t kLeastToHalve = 6;
  if (stretch.steps() < kLeastToHalve) return {};
  const size_t half = stretch.steps() / 2;
  Occupancy trial = occupied;
  const Pixel middle = nearest_free(trial, stretch.place(half));
  trial.take(middle);
  std::vector<Pixel> way = place_way({stretch.run, stretch.first, stretch.first + half, stretch.from, middle}, trial);
  if (way.empty()) return {};
  const std::vector<Pixel> rest =
      place_way({stretch.run, stretch.first + half, stretch.last, middle, stretch.to}, trial);
  if (rest.empty()) return {};
  way.insert(way.end(), rest.begin() + 1, rest.end());
  occupied = std::move(trial);
  return way;
}

/// One attempt, in a given order of the runs.
ChainResult place_in_order(std::span<const ChainRun> outline, const std::vector<uint32_t>& order) {
  ChainResult result;
  result.run.resize(outline.size());
  Occupancy occupied;
  std::vector<Pixel> node(outline.size());  // where run r starts
  for (size_t r = 0; r < outline.size(); ++r) {
    node[r] = nearest_free(occupied, inset(outline[r], 0));
    occupied.take(node[r]);
  }
  for (const uint32_t r : order) {
    const Pixel &from = node[r], &to = node[(r + 1) % outline.size()];
    result.run[r] = place_way({outline[r], 0, outline[r].target.size() - 1, from, to}, occupied);
    if (!result.run[r].empty()) continue;
    const int32_t apart = std::max(std::abs(to[0] - from[0]), std::abs(to[1] - from[1]));
    result.failed.push_back({r, static_cast<uint32_t>(apart)});
  }
  return result;
}

}  // namespace

ChainResult place_chain(std::span<const ChainRun> outline) {
  std::vector<uint32_t> order(outline.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return outline[a].target.size() > outline[b].target.size(); });
  constexpr int kAttempts = 3;
  ChainResult best;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    ChainResult result = place_in_order(outline, order);
    if (attempt == 0 || result.failed.size() < best.failed.size()) best = result;
    if (result.failed.empty()) break;
    // Those that found no way go first next time.
    std::vector<uint8_t> stuck(outline.size(), 0);
    for (const ChainResult::Failure& f : result.failed) stuck[f.run] = 1;
    std::stable_partition(order.begin(), order.end(), [&](uint32_t r) { return stuck[r] != 0; });
  }
  return best;
}

}  // namespace geocloth
