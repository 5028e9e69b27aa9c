// SPDX-License-Identifier: GPL-3.0-or-later
// Where words find room on a chart map: a chart is widest where the distance to its outline is largest (the two-pass
// distance transform of Rosenfeld and Pfaltz 1966, chessboard metric).
#include "render/chart_labels.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace geocloth {
namespace {

constexpr std::array<std::array<int, 2>, 8> kNeighbours{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

/// Pixels of an asset and their neighbours in the same chart.
class ChartPixels {
 public:
  explicit ChartPixels(const ClothAsset& asset) : asset_(asset) {}

  /// The neighbour, or kNoPixel when it belongs to another chart or to none.
  [[nodiscard]] uint32_t neighbour(uint32_t pixel, const std::array<int, 2>& step) const {
    const int64_t x = int64_t{pixel % asset_.width} + step[0], y = int64_t{pixel / asset_.width} + step[1];
    if (x < 0 || y < 0 || x >= asset_.width || y >= asset_.height) return kNoPixel;
    const auto other = static_cast<uint32_t>(y * asset_.width + x);
    return asset_.chart[other] == asset_.chart[pixel] ? other : kNoPixel;
  }

  /// Per pixel: 1 on the outline, 2 beside it, ...; 0 where not valid.
  [[nodiscard]] std::vector<uint32_t> depth() const {
    std::vector<uint32_t> depth(asset_.pixel_count(), 0);
    const auto relax = [&](uint32_t pixel, std::size_t first, std::size_t last, uint32_t start) {
      uint32_t least = start;
      for (std::size_t k = first; k < last; ++k) {
        const uint32_t other = neighbour(pixel, kNeighbours[k]);
        least = std::min(least, other == kNoPixel ? 1 : depth[other] + 1);
      }
      depth[pixel] = least;
    };
    for (uint32_t pixel = 0; pixel < asset_.pixel_count(); ++pixel) {
      if (asset_.valid(pixel)) relax(pixel, 0, 4, asset_.pixel_count());
    }
    for (uint32_t pixel = asset_.pixel_count(); pixel-- > 0;) {
      if (asset_.valid(pixel)) relax(pixel, 4, 8, depth[pixel]);
    }
    return depth;
  }

 private:
  const ClothAsset& asset_;
};

ChartLabel label_at(const ClothAsset& asset, uint32_t pixel, uint32_t depth, std::string text) {
  return {pixel % asset.width, pixel / asset.width, depth - 1, std::move(text)};
}

/// A, B, ..., Z, AA, AB, ...
std::string letters(uint32_t number) {
  std::string text;
  for (uint64_t n = uint64_t{number} + 1; n > 0; n = (n - 1) / 26) {
    text.insert(text.begin(), static_cast<char>('A' + (n - 1) % 26));
  }
  return text;
}

/// The pixel nearest to the middle of them all.
uint32_t middle_of(const std::vector<uint32_t>& pixels, uint32_t width) {
  uint64_t sum_x = 0, sum_y = 0;
  for (const uint32_t p : pixels) {
    sum_x += p % width;
    sum_y += p / width;
  }
  const auto count = static_cast<int64_t>(pixels.size());
  const int64_t x = static_cast<int64_t>(sum_x) / count, y = static_cast<int64_t>(sum_y) / count;
  const auto away = [&](uint32_t p) {
    const int64_t dx = int64_t{p % width} - x, dy = int64_t{p / width} - y;
    return dx * dx + dy * dy;
  };
  return *std::min_element(pixels.begin(), pixels.end(), [&](uint32_t a, uint32_t b) { return away(a) < away(b); });
}

}  // namespace

std::vector<ChartLabel> chart_numbers(const ClothAsset& asset) {
  const std::vector<uint32_t> depth = ChartPixels(asset).depth();
  std::vector<uint32_t> widest(asset.chart_count, kNoPixel);
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if (!asset.valid(pixel)) continue;
    uint32_t& best = widest[asset.chart[pixel]];
    if (best == kNoPixel || depth[pixel] > depth[best]) best = pixel;
  }
  std::vector<ChartLabel> labels;
  for (uint32_t chart = 0; chart < asset.chart_count; ++chart) {
    const uint32_t pixel = widest[chart];
    if (pixel != kNoPixel) labels.push_back(label_at(asset, pixel, depth[pixel], std::to_string(chart + 1)));
  }
  return labels;
}

std::vector<ChartLabel> seam_letters(const ClothAsset& asset, const SeamLines& lines, uint32_t shortest) {
  const ChartPixels pixels(asset);
  const std::vector<uint32_t> depth = pixels.depth();
  std::vector<uint8_t> seen(asset.pixel_count(), 0);
  std::vector<ChartLabel> labels;
  for (uint32_t start = 0; start < asset.pixel_count(); ++start) {
    const uint32_t seam = lines.pixel_seam[start];
    if (seam == kNoSeam || seam == kSeamNode || seen[start] != 0) continue;
    // One side: the pixels of the seam that hang together in the chart.
    std::vector<uint32_t> side{start};
    seen[start] = 1;
    for (std::size_t i = 0; i < side.size(); ++i) {
      for (const auto& step : kNeighbours) {
        const uint32_t other = pixels.neighbour(side[i], step);
        if (other == kNoPixel || seen[other] != 0 || lines.pixel_seam[other] != seam) continue;
        seen[other] = 1;
        side.push_back(other);
      }
    }
    if (side.size() < shortest) continue;
    // From the middle of the side into the chart, so far that the word stands clear of the outline.
    uint32_t pixel = middle_of(side, asset.width);
    for (uint32_t k = 0; k < shortest / 2; ++k) {
      uint32_t deeper = pixel;
      for (const auto& step : kNeighbours) {
        const uint32_t other = pixels.neighbour(pixel, step);
        if (other != kNoPixel && depth[other] > depth[deeper]) deeper = other;
      }
      pixel = deeper;
    }
    labels.push_back(label_at(asset, pixel, depth[pixel], letters(seam)));
  }
  return labels;
}

}  // namespace geocloth
