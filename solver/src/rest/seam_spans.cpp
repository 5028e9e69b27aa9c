// SPDX-License-Identifier: Apache-2.0
// Spans over seams (shaders/lib/span.h): where the grid ends at a seam, a span goes on along the other chart's grid, so
// that cloth is held along itself as if it were not cut. A bend over the seam says which line of the other side goes on
// straightest. The way over the seam is a way along the surface, so a span never holds two points closer than they can
// be; where the lines meet at an angle it pulls a little late.

#include "rest/seam_spans.h"

#include <array>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "lib/span.h"
#include "rest/seam_list.h"
#include "rest/short_seams.h"

namespace geocloth {
namespace {

/// Colours are passes of their own: the few spans that need more, at corners of charts, are left out.
constexpr uint32_t kMostSpanColors = 4;
constexpr uint32_t kMostShortSeamColors = 8;

constexpr uint32_t kLineSprings = 4;  ///< right, down and both diagonals

/// Pixels along a line of the grid from a seam on, and how far each is [m] from the seam along the line.
struct Line {
  std::vector<uint32_t> pixel;
  std::vector<double> distance;
};

class SeamSpanBuilder {
 public:
  SeamSpanBuilder(const ClothAsset& asset, const RestShape& rest)
      : asset_(asset), rest_(rest), point_(first_copies(asset)) {}

  [[nodiscard]] std::vector<shader::SeamSpring> build() const {
    std::vector<shader::SeamSpring> spans;
    for (const SeamBend& bend : asset_.seam_bends) {
      const Line a = line_from_seam(bend.a, bend.middle), b = line_from_seam(bend.b, bend.middle);
      for (uint32_t k = 1; k < shader::kSpanPixels; ++k) {
        const uint32_t other = shader::kSpanPixels - k;
        if (k > a.pixel.size() || other > b.pixel.size()) continue;
        shader::SeamSpring span{};
        span.a = span.middle = span.beside = a.pixel[k - 1];
        span.b = b.pixel[other - 1];
        span.rest = static_cast<float>(a.distance[k - 1] + b.distance[other - 1]);
        if (span.a != span.b) spans.push_back(span);
      }
    }
    return spans;
  }

 private:
  /// One step of the grid, and the spring that it follows.
  struct Way {
    int32_t dx = 0, dy = 0;
    uint32_t spring = 0;
  };

  [[nodiscard]] std::optional<uint32_t> next(uint32_t p, const Way& way) const {
    const int64_t x = p % asset_.width + int64_t{way.dx}, y = p / asset_.width + int64_t{way.dy};
    if (x < 0 || y < 0 || x >= asset_.width || y >= asset_.height) return {};
    const auto q = static_cast<uint32_t>(y * asset_.width + x);
    const bool forward = kSpringOffset[way.spring][0] == way.dx && kSpringOffset[way.spring][1] == way.dy;
    if ((asset_.spring_mask[forward ? p : q] & (1U << way.spring)) == 0) return {};
    return q;
  }

  /// From a copy of the middle's point through `first`, as far as a span goes and springs lead on; empty where no
  /// spring leads from the point to `first`.
  [[nodiscard]] Line line_from_seam(uint32_t first, uint32_t middle) const {
    for (uint32_t spring = 0; spring < kLineSprings; ++spring) {
      for (const int32_t sign : {1, -1}) {
        const Way back{-sign * kSpringOffset[spring][0], -sign * kSpringOffset[spring][1], spring};
        const std::optional<uint32_t> copy = next(first, back);
        if (!copy || point_[*copy] != point_[middle]) continue;
        return line(*copy, {-back.dx, -back.dy, spring});
      }
    }
    return {};
  }

  [[nodiscard]] Line line(uint32_t from, const Way& way) const {
    Line line;
    double distance = 0;
    for (std::optional<uint32_t> at = next(from, way); at && line.pixel.size() < shader::kSpanPixels;
         at = next(from, way)) {
      const double step = rest_.rest_length(from, *at);
      if (!(step > 0)) break;
      distance += step;
      line.pixel.push_back(*at);
      line.distance.push_back(distance);
      from = *at;
    }
    return line;
  }

  const ClothAsset& asset_;
  const RestShape& rest_;
  std::vector<uint32_t> point_;
};

}  // namespace

void add_seam_spans(const ClothAsset& asset, const RestShape& rest, float scale, const std::vector<bool>& short_seams,
                    ClothData& data) {
  data.seam_span_colors = append_by_color(SeamSpanBuilder(asset, rest).build(), kMostSpanColors, data);
  const std::vector<shader::SeamSpring> through = spans_through_short_seams(asset, scale, short_seams);
  data.seam_span_colors += append_by_color(through, kMostShortSeamColors, data);
  data.most_seam_springs += most_spans_through_short_seams(asset, short_seams) - through.size();
}

}  // namespace geocloth
