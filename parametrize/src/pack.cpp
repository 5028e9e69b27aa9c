// SPDX-License-Identifier: GPL-3.0-or-later
// Skyline packing, bottom left (Jylanki, A Thousand Ways to Pack the Bin, 2010): the upper outline of what is placed is
// a list of level runs; each rectangle, tallest first, goes where its far edge ends lowest. Several atlas widths are
// tried.
#include "pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

constexpr uint32_t kGap = 1;         // [pixels]
constexpr uint32_t kAlignment = 32;  // widths tried are multiples of it
constexpr int kWidths = 12;

class Skyline {
 public:
  explicit Skyline(uint32_t width) : width_(width), run_{{0, 0, width}} {}

  /// Places a rectangle that is no wider than the skyline.
  std::array<uint32_t, 2> place(uint32_t width, uint32_t height) {
    uint32_t best_y = kNone, best_x = 0;
    for (size_t i = 0; i < run_.size() && run_[i].x + width <= width_; ++i) {
      uint32_t y = 0;
      for (size_t k = i; k < run_.size() && run_[k].x < run_[i].x + width; ++k) y = std::max(y, run_[k].y);
      if (y < best_y) {
        best_y = y;
        best_x = run_[i].x;
      }
    }
    raise(best_x, width, best_y + height);
    return {best_x, best_y};
  }

 private:
  struct Run {
    uint32_t x, y, width;
  };

  void raise(uint32_t x, uint32_t width, uint32_t y) {
    std::vector<Run> next;
    bool placed = false;
    for (const Run& r : run_) {
      const uint32_t end = r.x + r.width;
      if (r.x < x) next.push_back({r.x, r.y, std::min(end, x) - r.x});
      if (!placed && end > x) {
        next.push_back({x, y, width});
        placed = true;
      }
      if (end > x + width) next.push_back({std::max(r.x, x + width), r.y, end - std::max(r.x, x + width)});
    }
    run_.clear();
    for (const Run& r : next) {
      if (r.width == 0) continue;
      if (!run_.empty() && run_.back().y == r.y) {
        run_.back().width += r.width;
      } else {
        run_.push_back(r);
      }
    }
  }

  uint32_t width_;
  std::vector<Run> run_;
};

Packing pack_into(std::span<const std::array<uint32_t, 2>> size, const std::vector<uint32_t>& order, uint32_t width) {
  Packing packing;
  packing.corner.resize(size.size());
  Skyline skyline(width + kGap);
  for (const uint32_t i : order) {
    packing.corner[i] = skyline.place(size[i][0] + kGap, size[i][1] + kGap);
    packing.width = std::max(packing.width, packing.corner[i][0] + size[i][0]);
    packing.height = std::max(packing.height, packing.corner[i][1] + size[i][1]);
  }
  return packing;
}

}  // namespace

Packing pack_rectangles(std::span<const std::array<uint32_t, 2>> size) {
  std::vector<uint32_t> order(size.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return size[a][1] != size[b][1] ? size[a][1] > size[b][1] : size[a][0] > size[b][0];
  });
  uint32_t widest = 0;
  double area = 0;
  for (const auto& [w, h] : size) {
    widest = std::max(widest, w);
    area += (w + kGap) * static_cast<double>(h + kGap);
  }
  const auto too_large = [](double side) {
    return Error(ErrorCode::limit, "the atlas would be " + std::to_string(static_cast<uint64_t>(side)) +
                                       " pixels wide or high, more than " + std::to_string(kMaxImageSide) +
                                       "; lower the resolution or raise the spacing");
  };
  if (std::max(static_cast<double>(widest), std::sqrt(area)) > kMaxImageSide) {
    throw too_large(std::max(static_cast<double>(widest), std::sqrt(area)));
  }
  if (size.size() == 1) return pack_into(size, order, widest);

  Packing best;
  double best_cost = 0;
  for (int i = 0; i < kWidths; ++i) {
    const double wanted = std::max(static_cast<double>(widest), std::sqrt(area) * (0.9 + 0.05 * i));
    const uint32_t width = (static_cast<uint32_t>(std::ceil(wanted)) + kAlignment - 1) / kAlignment * kAlignment;
    Packing packing = pack_into(size, order, width);
    // A lopsided atlas is worth a little waste.
    const double longer = std::max(packing.width, packing.height), shorter = std::min(packing.width, packing.height);
    const double cost = longer * shorter * (1 + 0.05 * (longer / shorter - 1));
    if (i == 0 || cost < best_cost) {
      best_cost = cost;
      best = std::move(packing);
    }
  }
  if (std::max(best.width, best.height) > kMaxImageSide) throw too_large(std::max(best.width, best.height));
  return best;
}

}  // namespace geocloth
