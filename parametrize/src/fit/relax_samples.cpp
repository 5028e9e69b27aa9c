// SPDX-License-Identifier: GPL-3.0-or-later
// A grid that is even in a chart's plane is askew in space where the map shears a little and across folds narrower than
// a pixel. So the samples slide: the elastic grid of grid_energy.h again, all of it, but with the angles that its edges
// have in space. Their lengths are still those in the plane, which are lengths along the surface: samples that kept
// equal straight distances would leave the folds. Each pixel in turn takes a Gauss-Newton step, tried on the surface
// itself. Pixels of one parity of column and row share no angle: they move at the same time, whatever the threads.
// Beside an outline that runs askew, angles are bought with lengths; where that leaves springs too uneven, lengths far
// off are made to count more.
#include "fit/relax_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "image/cell_halves.h"
#include "image/chart_sampling.h"
#include "image/grid_energy.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kStill = 0.01;           // [pixels] shorter steps are not made
constexpr double kLongestSlide = 0.5;     // [pixels] of a step
constexpr double kLeastDirections = 0.1;  // [pixels^2] that the four pixels around one span
constexpr int kSweeps = 6;
/// Tried in this order: how much angles count, and lengths far off. The second is for springs that are even enough to
/// pay for straighter angles, those after it for springs that are too uneven.
struct Weights {
  double angle, tail;
};
constexpr std::array kWeights{Weights{1, 0},  Weights{5, 0},  Weights{1, 8},
                              Weights{1, 14}, Weights{1, 24}, Weights{1, 45}};
/// What is to hold: springs p99 / p1, and the cosine of the angle that is not met in 5 of 100 places. The fit
/// afterwards takes the rest up to 1.5 and 6 degrees, and a little more where angles do not hold.
constexpr double kMostSpread = 1.487, kMostSpreadAlone = 1.474, kMostSkew = 0.0985;
constexpr double kHopeless = 1.8;  // springs p99 / p1 that no weights mend

class SampleRelaxation {
 public:
  SampleRelaxation(const FlatSurface& flat, Raster& raster) : flat_(flat), raster_(raster) {
    std::vector<std::vector<uint32_t>> triangles(flat.charts.size());
    for (uint32_t t = 0; t < flat.triangle.size(); ++t) triangles[flat.chart[t]].push_back(t);
    std::vector<GridCorner> corner;
    locator_.reserve(flat.charts.size());
    for (std::size_t c = 0; c < flat.charts.size(); ++c) {
      locator_.emplace_back(flat, flat.charts[c], triangles[c]);
      add_corners(flat.charts[c], corner);
    }
    corners_ = GridCorners(std::move(corner), raster.chart.size());
    for (uint32_t i = 0; i < raster.chart.size(); ++i) {
      const bool inside = raster.chart[i] != kNoChart && raster.vertex[i] == kNone && raster.triangle[i] != kNone;
      if (inside) colour_[i % raster.width % 2 + 2 * (i / raster.width % 2)].push_back(i);
    }
  }

  void run() {
    Samples best;
    int most = -1;
    for (const Weights& weights : kWeights) {
      weights_ = weights;
      for (int sweep = 0; sweep < kSweeps; ++sweep) this->sweep();
      const auto [spread, skew] = measure();
      const bool straight = skew <= kMostSkew, even = spread <= (straight ? kMostSpread : kMostSpreadAlone);
      const int held = even || weights.angle == 1 ? (straight ? 1 : 0) + (even ? 1 : 0) : 0;
      if (held > most) best = {raster_.position, raster_.place, raster_.triangle};
      most = std::max(most, held);
      if (even && (straight || weights.tail > 0)) break;
      if (spread > kHopeless) break;
    }
    raster_.position = std::move(best.position);
    raster_.place = std::move(best.place);
    raster_.triangle = std::move(best.triangle);
  }

 private:
  struct Samples {
    std::vector<Point3> position;
    std::vector<Point2> place;
    std::vector<uint32_t> triangle;
  };

  void sweep() {
    for (const std::vector<uint32_t>& pixels : colour_) {
      tbb::parallel_for(std::size_t{0}, pixels.size(), [&](std::size_t k) { relax(pixels[k]); });
    }
  }

  /// As quality.cpp has them: springs p99 / p1, and p95 of the cosines of the angles at which springs meet.
  [[nodiscard]] std::array<double, 2> measure() const {
    std::vector<double> lengths, cosines;
    std::vector<uint8_t> met(raster_.chart.size(), 0);
    const auto meet = [&](uint32_t from, uint32_t to, uint8_t bit) {
      uint8_t& bits = met[std::min(from, to)];
      if ((bits & bit) == 0) lengths.push_back(length(edge(from, to)));
      bits = static_cast<uint8_t>(bits | bit);
    };
    for (const GridCorner& c : corners_) {
      meet(c.middle, c.beside, kSpringRight);
      meet(c.middle, c.below, kSpringDown);
      if (c.beside < c.middle || c.below < c.middle) continue;
      const Point3 a = edge(c.middle, c.beside), b = edge(c.middle, c.below);
      const double sizes = length(a) * length(b);
      cosines.push_back(sizes > 0 ? std::abs(dot(a, b)) / sizes : 1);
    }
    const auto percentile = [](std::vector<double>& values, double share) {
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    if (cosines.empty()) return {1, 0};
    return {percentile(lengths, 0.99) / percentile(lengths, 0.01), percentile(cosines, 0.95)};
  }

  void add_corners(const FlatChart& chart, std::vector<GridCorner>& corner) const {
    std::vector<std::vector<Pixel>> chains;
    const auto add_chain = [&](const std::vector<OutlineSample>& loop) {
      std::vector<Pixel>& chain = chains.emplace_back();
      for (const OutlineSample& s : loop) {
        chain.push_back({static_cast<int32_t>(chart.x0 + s.x), static_cast<int32_t>(chart.y0 + s.y)});
      }
    };
    add_chain(chart.outline);
    for (const std::vector<OutlineSample>& hole : chart.holes) add_chain(hole);
    const CellHalves cells(chains);
    const auto index = [&](int32_t x, int32_t y) {
      return static_cast<uint32_t>(y) * raster_.width + static_cast<uint32_t>(x);
    };
    const auto add = [&](const Pixel& at, int32_t dx, int32_t dy) {
      corner.push_back(
          {index(at[0], at[1]), index(at[0] + dx, at[1]), index(at[0], at[1] + dy), static_cast<double>(dx * dy)});
    };
    for (int32_t y = cells.low()[1]; y < cells.high()[1]; ++y) {
      for (int32_t x = cells.low()[0]; x < cells.high()[0]; ++x) cells.for_right_angles({x, y}, add);
    }
  }

  /// [pixels] in the plane.
  [[nodiscard]] Point2 way(uint32_t from, uint32_t to) const {
    return {raster_.place[to][0] - raster_.place[from][0], raster_.place[to][1] - raster_.place[from][1]};
  }
  /// [spacings] in space.
  [[nodiscard]] Point3 edge(uint32_t from, uint32_t to) const {
    return (raster_.position[to] - raster_.position[from]) * (1 / flat_.charts[raster_.chart[from]].spacing);
  }

  [[nodiscard]] double energy(uint32_t pixel) const {
    double sum = 0;
    for (const uint32_t k : corners_.around(pixel)) {
      const GridCorner& c = corners_[k];
      const Point2 a = way(c.middle, c.beside), b = way(c.middle, c.below);
      sum += length_energy(a, weights_.tail) + length_energy(b, weights_.tail) + area_energy(c, a, b) +
             weights_.angle * angle_energy(dot(edge(c.middle, c.beside), edge(c.middle, c.below)));
    }
    return sum;
  }

  /// How a sample moves in space with its place [spacings / pixel], as seen from the pixels around it.
  [[nodiscard]] std::optional<std::array<Point3, 2>> directions(uint32_t i) const {
    const uint32_t w = raster_.width;
    const Point3 right = edge(i - 1, i + 1), down = edge(i - w, i + w);
    const Point2 r = way(i - 1, i + 1), d = way(i - w, i + w);
    const double determinant = r[0] * d[1] - r[1] * d[0];
    if (!(determinant > kLeastDirections)) return std::nullopt;
    return std::array{(right * d[1] - down * r[1]) * (1 / determinant),
                      (down * r[0] - right * d[0]) * (1 / determinant)};
  }

  void relax(uint32_t pixel) {
    const auto direction = directions(pixel);
    if (!direction) return;
    GridSlope slope;
    for (const uint32_t k : corners_.around(pixel)) {
      const GridCorner& c = corners_[k];
      const Point2 a = way(c.middle, c.beside), b = way(c.middle, c.below);
      const double in_a = share_in_edge(c, c.beside, pixel), in_b = share_in_edge(c, c.below, pixel);
      if (in_a != 0) add_length(slope, in_a, a, weights_.tail);
      if (in_b != 0) add_length(slope, in_b, b, weights_.tail);
      add_area(slope, c, pixel, a, b);
      const Point3 in_space_a = edge(c.middle, c.beside), in_space_b = edge(c.middle, c.below);
      const Point3 turn = in_space_b * in_a + in_space_a * in_b;
      add_angle(slope, dot(in_space_a, in_space_b), {dot(turn, (*direction)[0]), dot(turn, (*direction)[1])},
                weights_.angle);
    }
    const Point2 step = slope.step();
    const double whole = std::hypot(step[0], step[1]);
    if (!(whole >= kStill)) return;
    const double most = std::min(1.0, kLongestSlide / whole);
    try_step(pixel, {step[0] * most, step[1] * most});
  }

  /// Takes the step or a part of it, where that is better.
  void try_step(uint32_t pixel, const Point2& step) {
    constexpr double kBeyond = 1e-6;  // [pixels] of the chart's edge
    const Point2 place = raster_.place[pixel];
    const Point3 position = raster_.position[pixel];
    const double before = energy(pixel);
    for (const double share : {1.0, 0.5, 0.25}) {
      const Point2 trial{place[0] + share * step[0], place[1] + share * step[1]};
      const PlanePlace found = locator_[raster_.chart[pixel]].locate(trial);
      const auto at = surface_point(flat_, found, trial, kBeyond);
      if (!at) continue;
      raster_.place[pixel] = trial;
      raster_.position[pixel] = *at;
      if (energy(pixel) < before) {
        raster_.triangle[pixel] = found.triangle;
        return;
      }
    }
    raster_.place[pixel] = place;
    raster_.position[pixel] = position;
  }

  const FlatSurface& flat_;
  Raster& raster_;
  std::vector<PlaneLocator> locator_;  // per chart
  Weights weights_{1, 0};
  GridCorners corners_;                            // of all charts
  std::array<std::vector<uint32_t>, 4> colour_{};  // pixels that move, by parity of column and row
};

}  // namespace

void relax_samples(const FlatSurface& flat, Raster& raster) {
  SampleRelaxation(flat, raster).run();
}

}  // namespace geocloth
