// SPDX-License-Identifier: GPL-3.0-or-later
// Packing of real outlines: bottom left fill on a bitmap (as in Levy et al., Least Squares Conformal Maps, 2002, but
// with whole shapes in place of their horizons, so that hollows are filled too). A shape is tried at all columns of a
// row at once: the columns that one of its runs forbids are a window over the bits taken, and windows whose length is a
// power of two are kept per row. Several widths, orders, half turns and corners to fill from are tried and the best
// kept; large atlases are packed in blocks of pixels, so that the work stays bounded.
#include "pack/pack.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "geocloth/asset/error.h"
#include "image/chart_outline.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kMostBlocks = 1U << 18U;   // [blocks] an atlas is packed in blocks of pixels beyond this size
constexpr uint64_t kMostWork = 30'000'000;  // [words looked at] no further arrangement is tried beyond
constexpr double kOblong = 0.001;           // what an atlas costs that is no square, per longer / shorter side - 1
constexpr double kLopsided = 0.04;          // and a lopsided one, per longer / shorter side - kLongest
constexpr double kLongest = 2;
constexpr double kTurnPays = 0.995;                      // half turns must bring the cost down to this share
constexpr double kWidthStep = 1.02;                      // between widths tried
constexpr int kNarrower = 20, kWider = 35;               // steps from the square root of the area
constexpr int kQuickStride = 3;                          // steps of the width, where speed matters more
constexpr size_t kMostTries = 4000, kTriesPerPair = 40;  // few shapes have been through everything soon
constexpr double kThreshold = 0.03;

/// A shape in blocks, with the gap below and to the right of every pixel: two shapes so grown are disjoint exactly when
/// no two of their pixels are 8-neighbours.
struct Grown {
  struct Run {
    uint32_t row, first, last;  // columns first..last
    uint32_t level;             // of the longest windows (Board) that are no longer than the run

    friend bool operator==(const Run&, const Run&) = default;
  };
  uint32_t width = 0, height = 0;
  std::vector<Run> run;  // one or more per row, disjoint, the widest first: they exclude most columns
};

Grown grown(const ChartShape& shape, uint32_t block) {
  Grown result;
  result.width = shape.width / block + 1;
  result.height = shape.height / block + 1;
  std::vector<std::vector<std::array<uint32_t, 2>>> row(result.height);
  for (const ChartShape::Run& r : shape.run) {
    for (uint32_t y = r.row / block; y <= (r.row + 1) / block; ++y) {
      row[y].push_back({r.first / block, (r.last + 1) / block});
    }
  }
  for (uint32_t y = 0; y < result.height; ++y) {
    std::sort(row[y].begin(), row[y].end());
    const size_t first_of_row = result.run.size();
    for (const auto& [first, last] : row[y]) {
      if (result.run.size() > first_of_row && first <= result.run.back().last + 1) {
        result.run.back().last = std::max(result.run.back().last, last);
      } else {
        result.run.push_back({y, first, last, 0});
      }
    }
  }
  for (Grown::Run& r : result.run) r.level = static_cast<uint32_t>(std::bit_width(r.last - r.first + 1)) - 1;
  std::stable_sort(result.run.begin(), result.run.end(),
                   [](const auto& a, const auto& b) { return a.last - a.first > b.last - b.first; });
  return result;
}

ChartShape half_turned(const ChartShape& shape) {
  ChartShape result = shape;
  for (ChartShape::Run& r : result.run) {
    r = {shape.height - 1 - r.row, shape.width - 1 - r.last, shape.width - 1 - r.first};
  }
  return result;
}

/// Rows become columns.
ChartShape transposed(const ChartShape& shape) {
  ChartShape result{shape.height, shape.width, {}};
  std::vector<uint8_t> taken(size_t{shape.width} * shape.height, 0);
  for (const ChartShape::Run& r : shape.run) {
    for (uint32_t x = r.first; x <= r.last; ++x) taken[size_t{x} * shape.height + r.row] = 1;
  }
  for (uint32_t row = 0; row < result.height; ++row) {
    const uint8_t* pixel = &taken[size_t{row} * result.width];
    for (uint32_t x = 0; x < result.width; ++x) {
      if (pixel[x] == 0) continue;
      const uint32_t first = x;
      while (x + 1 < result.width && pixel[x + 1] != 0) ++x;
      result.run.push_back({row, first, x});
    }
  }
  return result;
}

ChartShape mirrored(const ChartShape& shape) {
  ChartShape result = shape;
  for (ChartShape::Run& r : result.run) r = {r.row, shape.width - 1 - r.last, shape.width - 1 - r.first};
  return result;
}

/// From which corner, and along which of its sides, an atlas is filled: what is filled is seen mirrored or transposed,
/// or both. The other four corners and sides are those with everything turned by half a turn.
struct Fill {
  bool is_transposed, is_mirrored;

  [[nodiscard]] ChartShape seen(const ChartShape& shape) const {
    const ChartShape lying = is_transposed ? transposed(shape) : shape;
    return is_mirrored ? mirrored(lying) : lying;
  }
};
constexpr std::array kFills{Fill{false, false}, Fill{false, true}, Fill{true, false}, Fill{true, true}};

/// The blocks taken, for columns 0..width-1 and as many rows as needed.
class Board {
 public:
  /// @param levels  more than any run's of the shapes
  Board(uint32_t width, uint32_t levels) : width_(width), words_((width + 63) / 64), levels_(levels) {}

  /// The first row, and the first column in it, where the shape fits.
  std::array<uint32_t, 2> find(const Grown& shape, uint32_t first_row, uint64_t& work) const {
    switch (words_) {
      case 1:
        return find_among<1>(shape, first_row, work);
      case 2:
        return find_among<2>(shape, first_row, work);
      case 3:
        return find_among<3>(shape, first_row, work);
      case 4:
        return find_among<4>(shape, first_row, work);
      default:
        return find_among<0>(shape, first_row, work);
    }
  }

  void take(const Grown& shape, const std::array<uint32_t, 2>& corner) {
    rows_ = std::max(rows_, corner[1] + shape.height);
    window_.resize(size_t{rows_} * levels_ * stride(), 0);
    for (const Grown::Run& r : shape.run) {
      uint64_t* taken = window(corner[1] + r.row, 0);
      const uint32_t first = corner[0] + r.first, last = corner[0] + r.last;
      for (uint32_t k = first / 64; k <= last / 64; ++k) {
        const uint32_t from = k == first / 64 ? first % 64 : 0, to = k == last / 64 ? last % 64 : 63;
        taken[k] |= (~uint64_t{0} >> (63 - (to - from))) << from;
      }
    }
    for (uint32_t y = corner[1]; y < corner[1] + shape.height; ++y) {
      switch (words_) {
        case 1:
          widen_among<1>(y);
          break;
        case 2:
          widen_among<2>(y);
          break;
        case 3:
          widen_among<3>(y);
          break;
        case 4:
          widen_among<4>(y);
          break;
        default:
          for (uint32_t level = 1; level < levels_; ++level) widen(y, level);
      }
    }
  }

 private:
  /// Of a row at one level [words]: zeros follow its bits, so that whatever is shifted in from beyond its end is free.
  [[nodiscard]] size_t stride() const { return 2 * size_t{words_}; }

  /// Bit x of a level: one of the 2^level columns from x on is taken.
  uint64_t* window(uint32_t row, uint32_t level) { return &window_[(size_t{row} * levels_ + level) * stride()]; }
  [[nodiscard]] const uint64_t* window(uint32_t row, uint32_t level) const {
    return &window_[(size_t{row} * levels_ + level) * stride()];
  }

  /// Bits `by` .. `by` + 63 of a row.
  static uint64_t shifted(const uint64_t* row, uint32_t by) {
    const uint64_t *word = row + by / 64, bits = by % 64;
    return word[0] >> bits | word[1] << 1 << (63 - bits);
  }

  void widen(uint32_t row, uint32_t level) {
    const uint64_t* half = window(row, level - 1);
    uint64_t* whole = window(row, level);
    for (uint32_t k = 0; k < words_; ++k) whole[k] = half[k] | shifted(half + k, 1U << (level - 1));
  }

  /// Fills in all levels of a row. What is stored is not read again at once: words that straddle two stored ones would
  /// have to wait for both.
  template <uint32_t kWords>
  void widen_among(uint32_t row) {
    std::array<uint64_t, kWords + 1> half{};
    std::copy_n(window(row, 0), kWords, half.begin());
    const uint32_t within_words = std::min(levels_, 7U);
    for (uint32_t level = 1; level < within_words; ++level) {
      const uint32_t by = 1U << (level - 1);
      uint64_t* whole = window(row, level);
      for (uint32_t k = 0; k < kWords; ++k) whole[k] = half[k] |= half[k] >> by | half[k + 1] << (64 - by);
    }
    for (uint32_t level = within_words; level < levels_; ++level) widen(row, level);
  }

  /// @tparam kWords  how many words a row has, or 0: any number
  template <uint32_t kWords>
  std::array<uint32_t, 2> find_among(const Grown& shape, uint32_t first_row, uint64_t& work) const {
    const uint32_t words = kWords > 0 ? kWords : words_;
    std::vector<uint64_t> many(kWords > 0 ? 0 : words_);
    std::array<uint64_t, kWords> few;
    uint64_t* blocked = kWords > 0 ? few.data() : many.data();
    for (uint32_t y = first_row;; ++y) {
      forbid_beyond(width_ - shape.width, words, blocked);
      uint64_t all = 0;
      for (const Grown::Run& run : shape.run) {
        if (y + run.row >= rows_) continue;
        const uint64_t* taken = window(y + run.row, run.level);
        const uint32_t second = run.last + 1 - (1U << run.level);
        all = ~uint64_t{0};
        for (uint32_t k = 0; k < words; ++k) {
          all &= blocked[k] |= shifted(taken + k, run.first) | shifted(taken + k, second);
        }
        work += words;
        if (~all == 0) break;
      }
      if (~all == 0) continue;
      for (uint32_t k = 0; k < words; ++k) {
        if (~blocked[k] != 0) return {64 * k + static_cast<uint32_t>(std::countr_one(blocked[k])), y};
      }
    }
  }

  static void forbid_beyond(uint32_t last, uint32_t words, uint64_t* blocked) {
    for (uint32_t k = 0; k < words; ++k) {
      const uint32_t first = 64 * k;
      const uint32_t free = last + 1 > first ? std::min(last + 1 - first, 64U) : 0;
      blocked[k] = free == 64 ? 0 : ~uint64_t{0} << free;
    }
  }

  uint32_t width_, words_, levels_;
  uint32_t rows_ = 0;
  std::vector<uint64_t> window_;
};

/// In which order shapes are placed, on a board of which width, and how they lie.
struct Arrangement {
  std::vector<uint32_t> order;
  std::vector<uint8_t> turned;  ///< empty: whichever way fits lower
  uint32_t width = 0;           ///< [blocks] of the board, as filled
  size_t fill = 0;              ///< of kFills
};

void expect_side(uint32_t side) {
  if (side <= kMaxImageSide) return;
  throw Error(ErrorCode::limit, "the atlas would be " + std::to_string(side) + " pixels wide or high, more than " +
                                    std::to_string(kMaxImageSide) + "; lower the resolution or raise the spacing");
}

/// Tries arrangements and keeps the best.
class Packer {
 public:
  Packer(std::span<const ChartShape> shape, PackEffort effort) : shape_(shape) {
    double area = 0;
    uint32_t widest = 0, highest = 0;
    for (const ChartShape& s : shape) {
      area += (s.width + 1.0) * (s.height + 1.0);
      widest = std::max(widest, s.width);
      highest = std::max(highest, s.height);
    }
    expect_side(std::max(widest, highest));
    block_ = static_cast<uint32_t>(std::ceil(std::sqrt(area / kMostBlocks)));
    const size_t fills = effort == PackEffort::quick ? 1 : kFills.size();
    for (size_t f = 0; f < fills; ++f) {
      Seen& seen = seen_[f];
      seen.widest = kFills[f].is_transposed ? highest : widest;
      for (const ChartShape& s : shape) {
        const ChartShape lying = kFills[f].seen(s);
        seen.upright.push_back(grown(lying, block_));
        seen.turned.push_back(grown(half_turned(lying), block_));
      }
    }
    for (const Seen& seen : seen_) {
      for (const Grown& g : seen.upright) {
        for (const Grown::Run& r : g.run) levels_ = std::max(levels_, r.level + 1);
      }
    }
    for (const Grown& g : seen_[0].upright) {
      for (const Grown::Run& r : g.run) blocks_ += r.last - r.first + 1.0;
    }
  }

  Packing pack_quickly() {
    std::vector<std::vector<uint32_t>> order = orders(0);
    order.resize(2);
    for (const std::vector<uint32_t>& o : order) {
      for (const uint32_t width : widths(0, kQuickStride)) {
        Arrangement arrangement{o, {}, width};
        try_arrangement(arrangement, best_cost_);
      }
    }
    return best_;
  }

  Packing pack() {
    const std::vector<uint8_t> all_upright(shape_.size(), 0);
    for (size_t fill = 0; fill < kFills.size(); ++fill) {
      for (const std::vector<uint8_t>& turned : {all_upright, std::vector<uint8_t>{}}) {
        for (const std::vector<uint32_t>& order : orders(fill)) {
          for (const uint32_t width : widths(fill, 1)) {
            Arrangement arrangement{order, turned, width, fill};
            if (!std::isfinite(best_cost_) || work_ < kMostWork / 2) try_arrangement(arrangement, best_cost_);
          }
        }
        if (shape_.size() == 1) return best_;
      }
    }
    improve();
    expect_side(std::max(best_.width, best_.height));
    return best_;
  }

 private:
  /// The shapes as a way to fill sees them.
  struct Seen {
    std::vector<Grown> upright, turned;
    uint32_t widest = 0;  // [pixels]
  };

  [[nodiscard]] uint32_t least_width(size_t fill) const { return seen_[fill].widest / block_ + 1; }

  /// [blocks] the likeliest first, each once.
  [[nodiscard]] std::vector<uint32_t> widths(size_t fill, int stride) const {
    std::vector<uint32_t> result;
    const double side = std::sqrt(blocks_);
    const auto add = [&](int steps) {
      const auto wanted = static_cast<uint32_t>(std::ceil(side * std::pow(kWidthStep, steps)));
      const uint32_t width = std::max(wanted, least_width(fill));
      if (std::find(result.begin(), result.end(), width) == result.end()) result.push_back(width);
    };
    for (int steps = 1; steps <= kWider; steps += stride) add(steps);
    for (int steps = 0; steps >= -kNarrower; steps -= stride) add(steps);
    return result;
  }

  [[nodiscard]] std::vector<std::vector<uint32_t>> orders(size_t fill) const {
    std::vector<uint32_t> order(shape_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::vector<std::vector<uint32_t>> result;
    const std::vector<Grown>& upright = seen_[fill].upright;
    const auto by = [&](const auto& size) {
      std::vector<uint32_t> sorted = order;
      std::stable_sort(sorted.begin(), sorted.end(),
                       [&](uint32_t a, uint32_t b) { return size(upright[a]) > size(upright[b]); });
      result.push_back(std::move(sorted));
    };
    by([](const Grown& g) { return g.height; });
    by([](const Grown& g) { return uint64_t{g.width} * g.height; });
    by([](const Grown& g) { return g.width + g.height; });
    by([](const Grown& g) { return std::max(g.width, g.height); });
    return result;
  }

  /// Small changes of the best arrangement, as long as the work allows: they are cheap for few shapes, where the sorted
  /// orders leave most room. Slightly worse ones are gone through (threshold accepting, Dueck and Scheuer 1990).
  void improve() {
    std::mt19937 random(1);
    const auto below = [&](size_t n) { return static_cast<uint32_t>(random() % n); };
    Arrangement now = best_arrangement_;
    double now_cost = best_cost_;
    const size_t most_tries = std::min(kMostTries, kTriesPerPair * shape_.size() * shape_.size());
    for (size_t tries = 0; tries < most_tries && work_ < kMostWork; ++tries) {
      Arrangement trial = now;
      const uint32_t kind = below(4), i = below(shape_.size()), k = below(shape_.size());
      if (kind <= 1) std::swap(trial.order[i], trial.order[k]);
      if (kind == 1 || kind == 2) trial.turned[k] ^= 1U;
      if (kind >= 2) {
        const uint32_t width = trial.width + below(trial.width / 8 + 2) - trial.width / 16;
        trial.width = std::max(least_width(trial.fill), width);
      }
      const double left = 1 - std::max(static_cast<double>(tries) / static_cast<double>(most_tries),
                                       static_cast<double>(work_) / kMostWork);
      const double cost = try_arrangement(trial, now_cost * (1 + kThreshold * left));
      if (!std::isfinite(cost)) continue;
      now = std::move(trial);
      now_cost = cost;
    }
  }

  /// Carries an arrangement out, keeps it if it is the best so far, and fills in which shapes it turned.
  /// @returns its cost, or infinity when that exceeds `bound`
  double try_arrangement(Arrangement& arrangement, double bound) {
    const bool choose = arrangement.turned.empty();
    if (choose) arrangement.turned.assign(shape_.size(), 0);
    Board board(arrangement.width, levels_);
    const Seen& seen = seen_[arrangement.fill];
    Packing packing;
    packing.corner.resize(shape_.size());
    uint32_t row = 0;  // of the shape placed last
    const Grown* last = nullptr;
    for (const uint32_t i : arrangement.order) {
      const Grown* lying = arrangement.turned[i] != 0 ? &seen.turned[i] : &seen.upright[i];
      // Where an equal shape did not fit this does not either.
      std::array<uint32_t, 2> corner = board.find(*lying, last != nullptr && last->run == lying->run ? row : 0, work_);
      if (choose) {
        const std::array<uint32_t, 2> other = board.find(seen.turned[i], 0, work_);
        if (std::array{other[1], other[0]} < std::array{corner[1], corner[0]}) {
          corner = other;
          lying = &seen.turned[i];
          arrangement.turned[i] = 1;
        }
      }
      row = corner[1];
      last = lying;
      packing.corner[i] = {corner[0] * block_, corner[1] * block_};
      const auto [width, height] = size_of(i, arrangement.fill);
      packing.width = std::max(packing.width, packing.corner[i][0] + width);
      packing.height = std::max(packing.height, packing.corner[i][1] + height);
      if (cost_of(packing) >= bound) return kInfinity;
      if (i != arrangement.order.back()) board.take(*lying, corner);
    }
    const auto is_set = [](uint8_t t) { return t != 0; };
    const bool turns = std::any_of(arrangement.turned.begin(), arrangement.turned.end(), is_set);
    const double cost = cost_of(packing) / (turns ? kTurnPays : 1);
    if (cost < best_cost_) {
      best_cost_ = cost;
      best_ = as_it_is(std::move(packing), arrangement.fill);
      best_.turned = arrangement.turned;
      best_arrangement_ = arrangement;
    }
    if (cost >= bound) return kInfinity;
    return cost;
  }

  /// Width and height of a shape as a way to fill sees it [pixels].
  [[nodiscard]] std::array<uint32_t, 2> size_of(uint32_t i, size_t fill) const {
    const ChartShape& s = shape_[i];
    return kFills[fill].is_transposed ? std::array{s.height, s.width} : std::array{s.width, s.height};
  }

  /// A packing as a way to fill sees it becomes one of the shapes as they are.
  [[nodiscard]] Packing as_it_is(Packing packing, size_t fill) const {
    for (uint32_t i = 0; i < packing.corner.size(); ++i) {
      std::array<uint32_t, 2>& corner = packing.corner[i];
      if (kFills[fill].is_mirrored) corner[0] = packing.width - corner[0] - size_of(i, fill)[0];
      if (kFills[fill].is_transposed) std::swap(corner[0], corner[1]);
    }
    if (kFills[fill].is_transposed) std::swap(packing.width, packing.height);
    return packing;
  }

  /// Grows with every shape that is placed.
  static double cost_of(const Packing& packing) {
    const double longer = std::max(packing.width, packing.height), shorter = std::min(packing.width, packing.height);
    const double ratio = longer / shorter;
    return longer * shorter * (1 + kOblong * (ratio - 1) + kLopsided * std::max(ratio - kLongest, 0.0));
  }

  std::span<const ChartShape> shape_;
  std::array<Seen, kFills.size()> seen_;
  uint32_t block_ = 1, levels_ = 1;
  double blocks_ = 0;
  uint64_t work_ = 0;
  Packing best_;
  Arrangement best_arrangement_;
  double best_cost_ = kInfinity;
};

}  // namespace

ChartShape rectangle_shape(uint32_t width, uint32_t height) {
  expect_side(std::max(width, height));
  ChartShape shape{width, height, {}};
  for (uint32_t y = 0; y < height; ++y) shape.run.push_back({y, 0, width - 1});
  return shape;
}

ChartShape chart_shape(const FlatChart& chart) {
  ChartShape shape{chart.width, chart.height, {}};
  for (const OutlineSample& s : chart.outline) shape.run.push_back({s.y, s.x, s.x});
  const std::vector<std::vector<uint32_t>> crossing = row_crossings(chart);
  for (uint32_t y = 0; y < crossing.size(); ++y) {
    for (size_t k = 0; k + 1 < crossing[y].size(); k += 2) shape.run.push_back({y, crossing[y][k], crossing[y][k + 1]});
  }
  return shape;
}

Packing pack_shapes(std::span<const ChartShape> shape, PackEffort effort) {
  Packer packer(shape, effort);
  return effort == PackEffort::quick ? packer.pack_quickly() : packer.pack();
}

void pack_charts(FlatSurface& flat) {
  std::vector<ChartShape> shape;
  shape.reserve(flat.charts.size());
  for (const FlatChart& chart : flat.charts) shape.push_back(chart_shape(chart));
  arrange_charts(flat, pack_shapes(shape));
}

void arrange_charts(FlatSurface& flat, const Packing& packing) {
  flat.width = packing.width;
  flat.height = packing.height;
  for (size_t c = 0; c < flat.charts.size(); ++c) {
    FlatChart& chart = flat.charts[c];
    chart.x0 = packing.corner[c][0];
    chart.y0 = packing.corner[c][1];
    if (packing.turned[c] == 0) continue;
    for (OutlineSample& s : chart.outline) {
      s.x = chart.width - 1 - s.x;
      s.y = chart.height - 1 - s.y;
    }
  }
  std::vector<uint8_t> met(flat.uv.size(), 0);
  for (size_t t = 0; t < flat.triangle.size(); ++t) {
    const FlatChart& chart = flat.charts[flat.chart[t]];
    if (packing.turned[flat.chart[t]] == 0) continue;
    for (const uint32_t v : flat.triangle[t]) {
      if (met[v] == 0) flat.uv[v] = {chart.width - 1 - flat.uv[v][0], chart.height - 1 - flat.uv[v][1]};
      met[v] = 1;
    }
  }
}

}  // namespace geocloth
