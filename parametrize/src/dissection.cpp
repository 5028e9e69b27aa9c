// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nested dissection (George 1973) with separators found in the plane (Miller, Teng, Vavasis 1991 say why that is as
// good as can be): a piece of the mesh is halved by number along x and along y, and what lies on one side but touches
// the other parts it; the shorter of the four candidates is taken. Factors of n unknowns have n log n entries.
#include "dissection.h"

#include <algorithm>
#include <array>

namespace geocloth {
namespace {

constexpr uint32_t kSmall = 16;  // unknowns that are not parted further

class Dissector {
 public:
  Dissector(std::span<const Triangle> triangle, std::span<const int32_t> unknown, std::span<const Point2> place) {
    for (size_t v = 0; v < unknown.size(); ++v) {
      if (unknown[v] >= 0) place_.push_back(place[v]);
    }
    connect(triangle, unknown);
    side_.assign(place_.size(), Side::elsewhere);
    result_.order.resize(place_.size());
    for (uint32_t u = 0; u < place_.size(); ++u) result_.order[u] = u;
  }

  Dissection run() {
    if (!result_.order.empty()) part(0, static_cast<uint32_t>(result_.order.size()));
    return std::move(result_);
  }

 private:
  enum class Side : uint8_t { elsewhere, low, high, between };

  void connect(std::span<const Triangle> triangle, std::span<const int32_t> unknown) {
    const auto each = [&](const auto& visit) {
      for (const Triangle& t : triangle) {
        for (size_t i = 0; i < 3; ++i) {
          const int32_t a = unknown[t[i]], b = unknown[t[(i + 1) % 3]];
          if (a < 0 || b < 0) continue;
          visit(static_cast<uint32_t>(a), static_cast<uint32_t>(b));
          visit(static_cast<uint32_t>(b), static_cast<uint32_t>(a));
        }
      }
    };
    first_.assign(place_.size() + 1, 0);
    each([&](uint32_t a, uint32_t) { ++first_[a + 1]; });
    for (size_t u = 0; u < place_.size(); ++u) first_[u + 1] += first_[u];
    neighbour_.resize(first_.back());
    std::vector<uint32_t> end = first_;
    each([&](uint32_t a, uint32_t b) { neighbour_[end[a]++] = b; });
  }

  /// Orders a range of unknowns and appends its nodes. @returns the node at their top
  uint32_t part(uint32_t begin, uint32_t end) {
    std::array<uint32_t, 2> child{kNone, kNone};
    uint32_t own = begin;
    if (end - begin > kSmall) {
      const auto [low_end, high_end] = halve(begin, end);
      if (low_end > begin) child[0] = part(begin, low_end);
      if (high_end > low_end) child[1] = part(low_end, high_end);
      own = high_end;
    }
    const auto number = static_cast<uint32_t>(result_.node.size());
    for (const uint32_t c : child) {
      if (c != kNone) result_.node[c].parent = number;
    }
    result_.node.push_back({own, end, kNone});
    return number;
  }

  /// Rearranges a range: what is on the low side, what is on the high side, what parts them.
  std::array<uint32_t, 2> halve(uint32_t begin, uint32_t end) {
    const std::span<uint32_t> range(result_.order.data() + begin, end - begin);
    const std::ptrdiff_t half = static_cast<std::ptrdiff_t>(range.size() / 2);
    size_t least = range.size() + 1;
    std::vector<uint32_t> best;  // the range, parted
    std::array<uint32_t, 2> ends{};
    std::array<std::vector<uint32_t>, 4> part;  // by Side
    for (const size_t axis : {size_t{0}, size_t{1}}) {
      std::nth_element(range.begin(), range.begin() + half, range.end(), [&](uint32_t a, uint32_t b) {
        return place_[a][axis] != place_[b][axis] ? place_[a][axis] < place_[b][axis] : a < b;
      });
      for (size_t i = 0; i < range.size(); ++i) {
        side_[range[i]] = i < static_cast<size_t>(half) ? Side::low : Side::high;
      }
      for (const Side from : {Side::low, Side::high}) {
        const Side to = from == Side::low ? Side::high : Side::low;
        const auto touches = [&](uint32_t u) {
          return std::any_of(neighbour_.begin() + first_[u], neighbour_.begin() + first_[u + 1],
                             [&](uint32_t w) { return side_[w] == to; });
        };
        for (auto& p : part) p.clear();
        for (const uint32_t u : range) {
          const Side at = side_[u] == from && touches(u) ? Side::between : side_[u];
          part[static_cast<size_t>(at)].push_back(u);
        }
        const auto& [elsewhere, low, high, between] = part;
        if (between.size() >= least) continue;
        least = between.size();
        best = low;
        best.insert(best.end(), high.begin(), high.end());
        best.insert(best.end(), between.begin(), between.end());
        ends = {begin + static_cast<uint32_t>(low.size()), begin + static_cast<uint32_t>(low.size() + high.size())};
      }
    }
    for (const uint32_t u : range) side_[u] = Side::elsewhere;
    std::copy(best.begin(), best.end(), range.begin());
    return ends;
  }

  std::vector<Point2> place_;                // per unknown
  std::vector<uint32_t> first_, neighbour_;  // per unknown: a range of neighbours
  std::vector<Side> side_;                   // per unknown, while its range is parted
  Dissection result_;
};

}  // namespace

Dissection dissect(std::span<const Triangle> triangle, std::span<const int32_t> unknown,
                   std::span<const Point2> place) {
  return Dissector(triangle, unknown, place).run();
}

}  // namespace geocloth
