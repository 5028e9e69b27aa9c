// SPDX-License-Identifier: GPL-3.0-or-later
// Packing of real outlines: bottom left fill on a bitmap (as in Levy et al., Least Squares Conformal Maps, 2002, but
// with whole shapes in place of their horizons, so that hollows are filled too; board.cpp). Several widths, orders,
// half turns and corners to fill from are tried and the best kept; large atlases are packed in blocks of pixels, so
// that the work stays bounded.
#include "pack/pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include "geocloth/asset/error.h"
#include "image/chart_outline.h"
#include "mesh/point_math.h"
#include "pack/board.h"
#include "pack/ready_shape.h"

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
  Packer(std::span<const ChartShape> shape, PackEffort effort) : is_quick_(effort == PackEffort::quick) {
    for (const ChartShape& s : shape) shape_.push_back(&s);
    measure();
    see();
  }

  /// To be packed quickly.
  explicit Packer(std::span<const ReadyShape* const> shape) : is_quick_(true) {
    for (const ReadyShape* s : shape) shape_.push_back(&s->shape);
    measure();
    if (block_ > 1) {
      see();
      return;
    }
    for (const ReadyShape* s : shape) {
      seen_[0].upright.push_back(&s->upright);
      seen_[0].turned.push_back(&s->turned);
    }
    count_blocks();
  }

  Packing pack_quickly() {
    std::vector<std::vector<uint32_t>> order = orders(0);
    order.resize(order[0] == order[1] ? 1 : 2);
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
    std::vector<const Grown*> upright, turned;
    std::vector<uint32_t> levels;  // more than that of any run
    uint32_t widest = 0;           // [pixels]
  };

  void measure() {
    double area = 0;
    uint32_t widest = 0, highest = 0;
    for (const ChartShape* s : shape_) {
      area += (s->width + 1.0) * (s->height + 1.0);
      widest = std::max(widest, s->width);
      highest = std::max(highest, s->height);
    }
    expect_side(std::max(widest, highest));
    block_ = static_cast<uint32_t>(std::ceil(std::sqrt(area / kMostBlocks)));
    for (size_t f = 0; f < kFills.size(); ++f) seen_[f].widest = kFills[f].is_transposed ? highest : widest;
  }

  void see() {
    const size_t fills = is_quick_ ? 1 : kFills.size();
    own_.reserve(2 * fills * shape_.size());
    for (size_t f = 0; f < fills; ++f) {
      for (const ChartShape* s : shape_) {
        const ChartShape lying = kFills[f].seen(*s);
        seen_[f].upright.push_back(&own_.emplace_back(grown(lying, block_)));
        seen_[f].turned.push_back(&own_.emplace_back(grown(half_turned(lying), block_)));
      }
    }
    count_blocks();
  }

  void count_blocks() {
    for (Seen& seen : seen_) {
      for (const Grown* g : seen.upright) {
        uint32_t& levels = seen.levels.emplace_back(1);
        for (const Grown::Run& r : g->run) levels = std::max(levels, r.level + 1);
        levels_ = std::max(levels_, levels);
      }
    }
    for (const Grown* g : seen_[0].upright) {
      for (const Grown::Run& r : g->run) blocks_ += r.last - r.first + 1.0;
    }
  }

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
    const std::vector<const Grown*>& upright = seen_[fill].upright;
    const auto by = [&](const auto& size) {
      std::vector<uint32_t> sorted = order;
      std::stable_sort(sorted.begin(), sorted.end(),
                       [&](uint32_t a, uint32_t b) { return size(*upright[a]) > size(*upright[b]); });
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
    board_.reset(arrangement.width, levels_);
    const Seen& seen = seen_[arrangement.fill];
    levels_from_.assign(shape_.size() + 1, 1);
    for (size_t k = shape_.size(); k-- > 0;) {
      levels_from_[k] = std::max(levels_from_[k + 1], seen.levels[arrangement.order[k]]);
    }
    Packing packing;
    packing.corner.resize(shape_.size());
    uint32_t row = 0;  // of the shape placed last
    const Grown* last = nullptr;
    for (size_t k = 0; k < arrangement.order.size(); ++k) {
      const uint32_t i = arrangement.order[k];
      const Grown* lying = arrangement.turned[i] != 0 ? seen.turned[i] : seen.upright[i];
      // Where an equal shape did not fit this does not either.
      const uint32_t first = last != nullptr && last->run == lying->run ? row : 0;
      std::array<uint32_t, 2> corner = board_.find(*lying, first, kNone, work_).value();
      if (choose) {
        // Thorough packing counts all rows as work, since that decides how long it goes on.
        const auto other = board_.find(*seen.turned[i], 0, is_quick_ ? corner[1] : kNone, work_);
        if (other && std::array{(*other)[1], (*other)[0]} < std::array{corner[1], corner[0]}) {
          corner = *other;
          lying = seen.turned[i];
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
      if (k + 1 < arrangement.order.size()) board_.take(*lying, corner, levels_from_[k + 1]);
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
    const ChartShape& s = *shape_[i];
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

  bool is_quick_;
  std::vector<const ChartShape*> shape_;
  std::vector<Grown> own_;
  std::array<Seen, kFills.size()> seen_;
  Board board_;
  std::vector<uint32_t> levels_from_;  // per place of an order: of the shapes from there on
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

ReadyShape make_ready(ChartShape shape) {
  Grown upright = grown(shape, 1), turned = grown(half_turned(shape), 1);
  return {std::move(shape), std::move(upright), std::move(turned)};
}

Packing pack_quickly(std::span<const ReadyShape* const> shape) {
  return Packer(shape).pack_quickly();
}

Packing pack_shapes(std::span<const ChartShape> shape, PackEffort effort) {
  Packer packer(shape, effort);
  return effort == PackEffort::quick ? packer.pack_quickly() : packer.pack();
}

namespace {

void turn_samples(const FlatChart& chart, std::vector<OutlineSample>& samples) {
  for (OutlineSample& s : samples) {
    s.x = chart.width - 1 - s.x;
    s.y = chart.height - 1 - s.y;
  }
}

}  // namespace

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
    turn_samples(chart, chart.outline);
    for (std::vector<OutlineSample>& hole : chart.holes) turn_samples(chart, hole);
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

void turn_atlas(FlatSurface& flat) {
  Packing turned{flat.width, flat.height, {}, std::vector<uint8_t>(flat.charts.size(), 1)};
  for (const FlatChart& chart : flat.charts) {
    turned.corner.push_back({flat.width - chart.x0 - chart.width, flat.height - chart.y0 - chart.height});
  }
  arrange_charts(flat, turned);
}

}  // namespace geocloth
