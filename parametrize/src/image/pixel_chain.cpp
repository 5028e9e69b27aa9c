// SPDX-License-Identifier: GPL-3.0-or-later
//
// The outline of a free-form chart on the pixel lattice. Zippering (Sander et al. 2003) lets both sides of a seam be
// rasterised as they fall and merges samples afterwards, which spoils the spacing along the seam. Here the samples come
// first (equal arc length, shared by both sides) and each side looks for a lattice way with exactly that many steps:
// dynamic programming over (pixel, direction), at first as if a pixel could be met twice. Where that happens, stretches
// are taken up and laid again while contested pixels become dearer, as wires are routed on a circuit board
// (McMurchie and Ebeling, PathFinder, 1995), until no two samples share a pixel.

#include "image/pixel_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

constexpr std::array<Pixel, 8> kStep{{{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr float kNoWay = std::numeric_limits<float>::infinity();
/// Cost of a turn by 0, 45, 90 and 135 degrees, in squared pixels: keeps straight outlines straight.
constexpr std::array<float, 4> kTurnCost{0, 0, 0.3F, 2};
/// The same by direction and that of the step before; back where it came from nothing goes.
constexpr std::array<std::array<float, 8>, 8> kTurn = [] {
  std::array<std::array<float, 8>, 8> cost{};
  for (size_t to = 0; to < 8; ++to) {
    for (size_t from = 0; from < 8; ++from) {
      const size_t turn = std::min((to + 8 - from) % 8, (from + 8 - to) % 8);
      cost[to][from] = kNoWay;
      if (turn < kTurnCost.size()) cost[to][from] = kTurnCost[turn];
    }
  }
  return cost;
}();
/// By how much a distance along the outline is cheaper than one across: the sample can slide after its pixel later.
constexpr double kEaseAlong = 0.5;
constexpr int kRounds = 120, kFresh = 60;  // after each kFresh of them prices start anew
constexpr size_t kNoDirection = 8;

Pixel moved(const Pixel& p, size_t direction) {
  return {p[0] + kStep[direction][0], p[1] + kStep[direction][1]};
}

size_t direction_of(const Pixel& from, const Pixel& to) {
  for (size_t d = 0; d < 8; ++d) {
    if (moved(from, d) == to) return d;
  }
  return kNoDirection;
}

Pixel rounded(const Point2& p) {
  return {static_cast<int32_t>(std::lround(p[0])), static_cast<int32_t>(std::lround(p[1]))};
}

int32_t larger_extent(const Pixel& a, const Pixel& b) {
  return std::max(std::abs(a[0] - b[0]), std::abs(a[1] - b[1]));
}

int32_t sum_of_extents(const Pixel& a, const Pixel& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]);
}

/// Who uses which pixel and which diagonal of which cell, and what a pixel costs for having been fought over.
class Board {
 public:
  Board(const Pixel& low, const Pixel& high)
      : low_(low), width_(high[0] - low[0] + 1), height_(high[1] - low[1] + 1), place_(count(width_, height_)) {}

  [[nodiscard]] bool holds(const Pixel& p) const {
    return p[0] >= low_[0] && p[1] >= low_[1] && p[0] < low_[0] + width_ && p[1] < low_[1] + height_;
  }
  [[nodiscard]] int32_t users(const Pixel& p) const { return at(p).users; }
  [[nodiscard]] float history(const Pixel& p) const { return at(p).history; }
  void use(const Pixel& p, int32_t change) { at(p).users += change; }
  void blame(const Pixel& p, float price) { at(p).history += price; }
  void forget() {
    for (Place& p : place_) p.history = 0;
  }

  /// Users of the other diagonal of the cell that a diagonal step goes through.
  [[nodiscard]] int32_t crossed(const Pixel& from, size_t direction) const {
    return direction % 2 == 0 ? 0 : at(cell(from, direction)).diagonal[1 - slope(direction)];
  }
  void use_step(const Pixel& from, size_t direction, int32_t change) {
    if (direction % 2 == 1) at(cell(from, direction)).diagonal[slope(direction)] += change;
  }

 private:
  struct Place {
    int32_t users = 0;
    std::array<int32_t, 2> diagonal{};  // of the cell to the right and below: falling, rising
    float history = 0;
  };
  static size_t count(int32_t width, int32_t height) {
    return static_cast<size_t>(width) * static_cast<size_t>(height);
  }
  static size_t slope(size_t direction) { return direction == 1 || direction == 5 ? 0 : 1; }
  static Pixel cell(const Pixel& from, size_t direction) {
    const Pixel to = moved(from, direction);
    return {std::min(from[0], to[0]), std::min(from[1], to[1])};
  }
  [[nodiscard]] const Place& at(const Pixel& p) const {
    return place_[count(p[1] - low_[1], width_) + static_cast<size_t>(p[0] - low_[0])];
  }
  Place& at(const Pixel& p) { return place_[count(p[1] - low_[1], width_) + static_cast<size_t>(p[0] - low_[0])]; }

  Pixel low_;
  int32_t width_, height_;
  std::vector<Place> place_;
};

/// A stretch of the chain to be laid: samples first .. first + steps, of which the first has its pixel.
struct Stretch {
  size_t first, steps;
  Pixel from;
  size_t arriving = kNoDirection;  // direction of the step before
  std::optional<Pixel> to;         // where it has to end; anywhere near its target without
  size_t leaving = kNoDirection;   // direction of the step after
};

class Router {
 public:
  Router(std::span<const Point2> target, std::span<const ApartSamples> apart)
      : target_(target),
        size_(target.size()),
        along_(directions(target)),
        board_(make_board(target)),
        partners_(size_) {
    for (const ApartSamples& a : apart) {
      partners_[a.a].push_back({a.b, a.least});
      partners_[a.b].push_back({a.a, a.least});
    }
  }

  PixelChain run(std::vector<Pixel> start) {
    if (has_no_room()) return {PixelChain::Result::crowded, {}};
    pixel_ = std::move(start);
    if (pixel_.empty() && !lay_first()) return {PixelChain::Result::too_short, {}};
    for (size_t i = 0; i < size_; ++i) use(i, 1);
    return {negotiate() ? PixelChain::Result::found : PixelChain::Result::crowded, pixel_};
  }

 private:
  /// More samples than pixels within reach of any of them, as with a net whose threads are far narrower than a pixel:
  /// to negotiate that takes minutes and finds nothing.
  [[nodiscard]] bool has_no_room() const {
    constexpr int32_t kReach = 4;
    std::set<Pixel> near;
    for (size_t i = 0; i < size_; ++i) {
      const Pixel p = rounded(target_[i]);
      for (int32_t y = -kReach; y <= kReach; ++y) {
        for (int32_t x = -kReach; x <= kReach; ++x) near.insert({p[0] + x, p[1] + y});
      }
      if (near.size() >= size_) return false;
    }
    return true;
  }

  struct Partner {
    uint32_t sample;
    int32_t least;
  };

  /// Unit vectors along the outline at its samples.
  static std::vector<Point2> directions(std::span<const Point2> target) {
    std::vector<Point2> along;
    for (size_t i = 0; i < target.size(); ++i) {
      const Point2 &a = target[(i + target.size() - 1) % target.size()], &b = target[(i + 1) % target.size()];
      const double dx = b[0] - a[0], dy = b[1] - a[1], l = std::hypot(dx, dy);
      along.push_back(l > 0 ? Point2{dx / l, dy / l} : Point2{0, 0});
    }
    return along;
  }

  static Board make_board(std::span<const Point2> target) {
    Pixel low = rounded(target[0]), high = low;
    for (const Point2& t : target) {
      const Pixel p = rounded(t);
      low = {std::min(low[0], p[0]), std::min(low[1], p[1])};
      high = {std::max(high[0], p[0]), std::max(high[1], p[1])};
    }
    // Room for a chain that is much longer than its outline is wide.
    const int32_t margin = 8 + static_cast<int32_t>(std::lround(2 * std::sqrt(static_cast<double>(target.size()))));
    return {{low[0] - margin, low[1] - margin}, {high[0] + margin, high[1] + margin}};
  }

  [[nodiscard]] size_t wrapped(size_t i) const {
    while (i >= size_) i -= size_;
    return i;
  }
  [[nodiscard]] size_t before(size_t i) const { return wrapped(i + size_ - 1); }
  [[nodiscard]] size_t after(size_t i) const { return wrapped(i + 1); }

  /// Takes sample i and the step after it in use, or out of use (-1).
  void use(size_t i, int32_t change) {
    board_.use(pixel_[i], change);
    board_.use_step(pixel_[i], direction_of(pixel_[i], pixel_[after(i)]), change);
  }

  [[nodiscard]] float entry_cost(size_t sample, const Pixel& p) const {
    const double dx = p[0] - target_[sample][0], dy = p[1] - target_[sample][1];
    const double along = dx * along_[sample][0] + dy * along_[sample][1];
    float cost = static_cast<float>(dx * dx + dy * dy - kEaseAlong * along * along) + board_.history(p) +
                 price_ * static_cast<float>(board_.users(p));
    for (const Partner& other : partners_[sample]) {
      if (!pixel_.empty() && sum_of_extents(p, pixel_[other.sample]) < other.least) cost += price_;
    }
    return cost;
  }

  /// The cheapest way of exactly as many steps as the stretch has, within `radius` of the targets; empty: none.
  [[nodiscard]] std::vector<Pixel> find_way(const Stretch& stretch, int32_t radius) const {
    const int32_t side = 2 * radius + 1;
    std::vector<Pixel> place;  // in a layer, by cell
    for (int32_t y = 0; y < side; ++y) {
      for (int32_t x = 0; x < side; ++x) place.push_back({x, y});
    }
    const size_t cells = place.size();
    const auto pixel_at = [&](const Pixel& corner, size_t cell) -> Pixel {
      return {corner[0] + place[cell][0], corner[1] + place[cell][1]};
    };
    struct Layer {
      Pixel corner{};
      std::vector<uint8_t> from;  // per (pixel, arriving direction): arriving direction of the pixel before
    };
    std::vector<Layer> layer(stretch.steps + 1);
    std::vector<float> cost(cells * 8, kNoWay), next_cost, entry;
    const auto open_layer = [&](size_t i) {
      const Pixel centre = rounded(target_[wrapped(stretch.first + i)]);
      layer[i].corner = {centre[0] - radius, centre[1] - radius};
      layer[i].from.assign(cells * 8, 0);
      entry.assign(cells, -1);
      next_cost.assign(cells * 8, kNoWay);
    };
    /// Per direction of the step before: what it costs to arrive from there.
    using Costs = std::array<float, 8>;
    const auto arrive = [&](size_t i, const Pixel& from, size_t direction, const Costs& so_far) {
      const Pixel p = moved(from, direction);
      const int32_t x = p[0] - layer[i].corner[0], y = p[1] - layer[i].corner[1];
      if (x < 0 || y < 0 || x >= side || y >= side || !board_.holds(p)) return;
      const auto left = static_cast<int32_t>(stretch.steps - i);
      if (stretch.to && larger_extent(p, *stretch.to) > left) return;
      const auto cell = static_cast<size_t>(y * side + x);
      if (entry[cell] < 0) entry[cell] = entry_cost(wrapped(stretch.first + i), p);
      const float entering = entry[cell], crossing = price_ * static_cast<float>(board_.crossed(from, direction));
      Costs total;
      for (size_t d = 0; d < 8; ++d) total[d] = so_far[d] + kTurn[direction][d] + entering + crossing;
      const auto arriving = static_cast<size_t>(std::min_element(total.begin(), total.end()) - total.begin());
      const size_t state = cell * 8 + direction;  // which no other pixel leads to
      next_cost[state] = total[arriving];
      layer[i].from[state] = static_cast<uint8_t>(arriving);
    };

    open_layer(1);
    Costs start{};
    if (stretch.arriving != kNoDirection) {
      start.fill(kNoWay);
      start[stretch.arriving] = 0;
    }
    for (size_t d = 0; d < 8; ++d) arrive(1, stretch.from, d, start);
    for (size_t i = 1; i < stretch.steps; ++i) {
      cost.swap(next_cost);
      open_layer(i + 1);
      for (size_t cell = 0; cell < cells; ++cell) {
        Costs so_far;
        std::copy_n(cost.begin() + static_cast<std::ptrdiff_t>(cell * 8), so_far.size(), so_far.begin());
        if (*std::min_element(so_far.begin(), so_far.end()) == kNoWay) continue;
        const Pixel p = pixel_at(layer[i].corner, cell);
        for (size_t d = 0; d < 8; ++d) arrive(i + 1, p, d, so_far);
      }
    }

    size_t best = next_cost.size();
    float least = kNoWay;
    for (size_t state = 0; state < next_cost.size(); ++state) {
      const size_t turn = stretch.leaving == kNoDirection ? 0 : turn_between(state % 8, stretch.leaving);
      if (turn >= kTurnCost.size() || next_cost[state] + kTurnCost[turn] >= least) continue;
      least = next_cost[state] + kTurnCost[turn];
      best = state;
    }
    if (best == next_cost.size()) return {};
    std::vector<Pixel> way(stretch.steps + 1);
    size_t direction = best % 8;
    way.back() = pixel_at(layer.back().corner, best / 8);
    for (size_t i = stretch.steps; i >= 1; --i) {
      const Pixel& p = way[i];
      const auto cell = static_cast<size_t>((p[1] - layer[i].corner[1]) * side + p[0] - layer[i].corner[0]);
      way[i - 1] = {p[0] - kStep[direction][0], p[1] - kStep[direction][1]};
      direction = layer[i].from[cell * 8 + direction];
    }
    return way;
  }

  static size_t turn_between(size_t from, size_t to) {
    const size_t turn = (to + 8 - from) % 8;
    return std::min(turn, 8 - turn);
  }

  /// Lays the whole chain, some way ahead at a time, without regard to itself.
  bool lay_first() {
    constexpr size_t kAhead = 48, kKept = 32;
    std::vector<Pixel> chain{rounded(target_[0])};
    while (chain.size() - 1 + 2 * kAhead < size_) {
      const size_t done = chain.size() - 1;
      const Stretch ahead{done, kAhead, chain.back(), last_direction(chain), {}, kNoDirection};
      const std::vector<Pixel> way = find_some_way(ahead);
      if (way.empty()) return false;
      chain.insert(chain.end(), way.begin() + 1, way.begin() + 1 + kKept);
    }
    // Back to the start; where the rest has too few steps for that, more of the chain is taken up again.
    for (;;) {
      const Stretch rest{chain.size() - 1, size_ - (chain.size() - 1),
                         chain.back(),     last_direction(chain),
                         chain[0],         chain.size() > 1 ? direction_of(chain[0], chain[1]) : kNoDirection};
      const std::vector<Pixel> way = find_some_way(rest);
      if (!way.empty()) {
        chain.insert(chain.end(), way.begin() + 1, way.end() - 1);
        pixel_ = std::move(chain);
        return true;
      }
      if (chain.size() == 1) return false;
      chain.resize(std::max<size_t>(chain.size() / 2, 1));
    }
  }

  static size_t last_direction(const std::vector<Pixel>& chain) {
    return chain.size() > 1 ? direction_of(chain[chain.size() - 2], chain.back()) : kNoDirection;
  }

  [[nodiscard]] std::vector<Pixel> find_some_way(const Stretch& stretch) const {
    for (const int32_t radius : {2, 4, 7}) {
      std::vector<Pixel> way = find_way(stretch, radius);
      if (!way.empty()) return way;
    }
    return {};
  }

  /// Samples in conflict: their pixel has other users, their step crosses another, or a partner is too near.
  [[nodiscard]] bool contested(size_t i) const {
    if (board_.users(pixel_[i]) > 1) return true;
    if (board_.crossed(pixel_[i], direction_of(pixel_[i], pixel_[after(i)])) > 0) return true;
    return std::any_of(partners_[i].begin(), partners_[i].end(), [&](const Partner& other) {
      return sum_of_extents(pixel_[i], pixel_[other.sample]) < other.least;
    });
  }

  bool negotiate() {
    constexpr float kFirstPrice = 2, kDearer = 1.2F, kDearest = 1e4F, kBlame = 0.3F;
    price_ = kFirstPrice;
    for (int round = 0; round < kRounds; ++round) {
      if (round > 0 && round % kFresh == 0) {
        price_ = kFirstPrice;
        board_.forget();
      }
      std::vector<size_t> open;
      for (size_t i = 0; i < size_; ++i) {
        if (contested(i)) open.push_back(i);
      }
      if (open.empty()) return true;
      for (const size_t i : open) board_.blame(pixel_[i], kBlame * price_);
      // Forwards and backwards in turn, so that each side of a conflict is the one to give way at times.
      if (round % 2 == 1) std::reverse(open.begin(), open.end());
      for (const size_t i : open) {
        if (contested(i)) lay_again(i, round);
      }
      price_ = std::min(price_ * kDearer, kDearest);
    }
    return false;
  }

  /// Would the two samples' pixels meet if both were laid again? Then one of them has to stay.
  [[nodiscard]] bool opposed(size_t a, size_t b) const {
    const size_t along = std::min(wrapped(a + size_ - b), wrapped(b + size_ - a));
    if (along > 2 && larger_extent(pixel_[a], pixel_[b]) <= 1) return true;
    return std::any_of(partners_[a].begin(), partners_[a].end(), [&](const Partner& p) { return p.sample == b; });
  }

  /// Takes up the contested samples after i, with a margin, and lays them anew.
  void lay_again(size_t i, int round) {
    constexpr size_t kLongest = 48;
    const size_t most = std::min(kLongest, size_ - 4);
    size_t first = i + size_, last = first;  // beyond size_ where they wrap
    const auto may_add = [&](size_t sample) {
      for (size_t k = first; k <= last; ++k) {
        if (opposed(wrapped(k), wrapped(sample))) return false;
      }
      return true;
    };
    while (last - first < most && contested(wrapped(last + 1)) && may_add(last + 1)) ++last;
    const size_t margin = 3 + static_cast<size_t>(round) % 10;
    for (size_t k = 0; k < margin && last - first < most && may_add(first - 1); ++k) --first;
    for (size_t k = 0; k < margin && last - first < most && may_add(last + 1); ++k) ++last;

    // The two samples beside the stretch keep their pixels.
    const size_t fixed = wrapped(first + size_ - 1), end = wrapped(last + 1);
    const size_t steps = last - first + 2;
    int32_t radius = 2 + round / 12;
    for (size_t k = 0; k <= steps; ++k) {
      const size_t s = wrapped(fixed + k);
      radius = std::max(radius, larger_extent(pixel_[s], rounded(target_[s])) + 1);
    }
    for (size_t k = 0; k < steps; ++k) use(wrapped(fixed + k), -1);
    board_.use(pixel_[fixed], 1);
    Stretch stretch{fixed,         steps,
                    pixel_[fixed], direction_of(pixel_[before(fixed)], pixel_[fixed]),
                    pixel_[end],   direction_of(pixel_[end], pixel_[after(end)])};
    const std::vector<Pixel> way = find_way(stretch, radius);
    for (size_t k = 1; !way.empty() && k < steps; ++k) pixel_[wrapped(fixed + k)] = way[k];
    board_.use(pixel_[fixed], -1);
    for (size_t k = 0; k < steps; ++k) use(wrapped(fixed + k), 1);
  }

  std::span<const Point2> target_;
  size_t size_;
  std::vector<Point2> along_;  // per sample: unit vector along the outline
  Board board_;
  std::vector<std::vector<Partner>> partners_;  // per sample
  std::vector<Pixel> pixel_;                    // per sample
  float price_ = 0;
};

}  // namespace

PixelChain place_chain(std::span<const Point2> target, std::span<const ApartSamples> apart, std::vector<Pixel> start) {
  constexpr size_t kLeast = 3;
  if (target.size() < kLeast) throw Error(ErrorCode::invalid_argument, "an outline needs three samples at least");
  return Router(target, apart).run(std::move(start));
}

}  // namespace geocloth
