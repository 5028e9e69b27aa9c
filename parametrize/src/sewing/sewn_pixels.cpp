// SPDX-License-Identifier: GPL-3.0-or-later
#include "sewing/sewn_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "geocloth/asset/grid_mesh.h"
#include "mesh/point_math.h"
#include "mesh/point_tree.h"

namespace geocloth {
namespace {

/// A pixel beside one side of a run.
struct SidePixel {
  double along;  ///< [m] the run
  uint32_t pixel;
};

/// Which of `many` each of `few` gets, ascending: so that they are as little apart along the run as can be.
std::vector<std::size_t> match(const std::vector<SidePixel>& few, const std::vector<SidePixel>& many) {
  // least[k]: the sum with the present one at many[i + k]; stays[i][k]: the one before lies better at less than k.
  const std::size_t n = few.size(), choices = many.size() - n + 1;
  std::vector<std::size_t> chosen(n);
  constexpr std::size_t kMost = std::size_t{1} << 28U;  // some seconds
  if (n > kMost / choices) {
    for (std::size_t i = 0; i < n; ++i) chosen[i] = i + i * (choices - 1) / n;
    return chosen;
  }
  std::vector<double> least(choices, 0);
  std::vector<std::vector<bool>> stays(n, std::vector<bool>(choices, false));
  for (std::size_t i = 0; i < n; ++i) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < choices; ++k) {
      stays[i][k] = best <= least[k];
      best = std::min(best, least[k]);
      least[k] = best + std::abs(few[i].along - many[i + k].along);
    }
  }
  auto k = static_cast<std::size_t>(std::min_element(least.begin(), least.end()) - least.begin());
  for (std::size_t i = n; i-- > 0;) {
    chosen[i] = i + k;
    while (stays[i][k]) --k;
  }
  return chosen;
}

class PixelSewer {
 public:
  PixelSewer(const TriangleMesh& mesh, const ClothAsset& asset) : mesh_(mesh), asset_(asset) {
    for (const Vec3& p : asset.rest_position) position_.push_back(to_double(p));
    find_charts();
    find_border();
  }

  void add(const SewingRun& run) {
    if (run.pair.size() == 1) return add_single(run.pair[0]);
    std::array<std::vector<SidePixel>, 2> side;
    for (std::size_t s = 0; s < 2; ++s) side[s] = pixels_beside(run, s);
    const std::size_t few = side[0].size() <= side[1].size() ? 0 : 1, many = 1 - few;
    const std::vector<std::size_t> chosen = match(side[few], side[many]);
    for (std::size_t i = 0; i < chosen.size(); ++i) join(side[few][i].pixel, side[many][chosen[i]].pixel);
  }

  [[nodiscard]] std::vector<std::array<uint32_t, 2>> pairs() const { return {pair_.begin(), pair_.end()}; }

 private:
  static constexpr double kReach = 1.5;  // [spacings] of a pixel beside a seam

  /// The charts that have a place, by its position.
  void find_charts() {
    for (std::size_t r = 0; r < asset_.binding.size(); ++r) {
      const Binding& binding = asset_.binding[r];
      const auto heaviest = std::max_element(binding.weight.begin(), binding.weight.end()) - binding.weight.begin();
      const uint32_t pixel = binding.pixel[static_cast<std::size_t>(heaviest)];
      charts_[mesh_.position[asset_.source.source_vertex[r]]].insert(asset_.chart[pixel]);
    }
  }

  void find_border() {
    const std::vector<uint32_t> first = first_copies(asset_);
    std::map<std::array<uint32_t, 2>, uint32_t> triangles;
    for (const Triangle& t : pixel_triangles(asset_)) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(first[t[k]], first[t[(k + 1) % 3]]);
        ++triangles[{a, b}];
      }
    }
    std::vector<bool> is_border(asset_.pixel_count(), false);
    for (const auto& [edge, count] : triangles)
      if (count == 1) is_border[edge[0]] = is_border[edge[1]] = true;
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p) {
      if (!asset_.valid(p)) continue;
      pixels_[{asset_.chart[p], false}].push_back(p);
      if (is_border[first[p]]) pixels_[{asset_.chart[p], true}].push_back(p);
    }
  }

  struct Near {
    double distance = std::numeric_limits<double>::infinity();
    uint32_t pixel = kNone;
  };

  [[nodiscard]] Near nearest(const std::set<uint16_t>& charts, bool on_border, const Point3& place) {
    Near best;
    const double reach = kReach * double{asset_.spacing};
    for (const uint16_t chart : charts) {
      const auto pixels = pixels_.find({chart, on_border});
      if (pixels == pixels_.end()) continue;
      const auto [tree, is_new] = tree_.try_emplace(pixels->first, position_, pixels->second);
      tree->second.near_segment(place, place, reach, [&](uint32_t p) {
        const double d = distance(position_[p], place);
        if (d <= reach && std::pair(d, p) < std::pair(best.distance, best.pixel)) best = {d, p};
      });
    }
    return best;
  }

  /// Each once, where the run passes it most closely.
  [[nodiscard]] std::vector<SidePixel> pixels_beside(const SewingRun& run, std::size_t side) {
    constexpr double kStep = 0.25;                         // [spacings]
    std::map<uint32_t, std::pair<double, double>> passed;  // distance, along
    double along = 0;
    for (std::size_t i = 0; i + 1 < run.pair.size(); ++i) {
      const std::array<Point3, 2> from = places(run.pair[i]), to = places(run.pair[i + 1]);
      const double own = distance(from[side], to[side]);
      const double length = (own + distance(from[1 - side], to[1 - side])) / 2;
      const auto steps = static_cast<std::size_t>(std::ceil(own / (kStep * double{asset_.spacing}))) + 1;
      const std::set<uint16_t> charts = common_charts(from[side], to[side]);
      for (std::size_t k = 0; k <= steps; ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(steps);
        const Near near = nearest(charts, run.on_border[i][side], from[side] + (to[side] - from[side]) * share);
        if (near.pixel == kNone) continue;
        const std::pair here{near.distance, along + share * length};
        const auto [it, is_new] = passed.try_emplace(near.pixel, here);
        if (!is_new) it->second = std::min(it->second, here);
      }
      along += length;
    }
    std::vector<SidePixel> pixels;
    pixels.reserve(passed.size());
    for (const auto& [pixel, where] : passed) pixels.push_back({where.second, pixel});
    std::sort(pixels.begin(), pixels.end(), [](const SidePixel& a, const SidePixel& b) {
      return std::pair(a.along, a.pixel) < std::pair(b.along, b.pixel);
    });
    return pixels;
  }

  [[nodiscard]] std::array<Point3, 2> places(const SewnVertices& pair) const {
    return {mesh_.position[pair[0]], mesh_.position[pair[1]]};
  }

  [[nodiscard]] std::set<uint16_t> common_charts(const Point3& a, const Point3& b) const {
    std::set<uint16_t> common;
    const auto of_a = charts_.find(a), of_b = charts_.find(b);
    if (of_a == charts_.end() || of_b == charts_.end()) return common;
    std::set_intersection(of_a->second.begin(), of_a->second.end(), of_b->second.begin(), of_b->second.end(),
                          std::inserter(common, common.end()));
    return common;
  }

  void add_single(const SewnVertices& pair) {
    std::array<uint32_t, 2> pixel{};
    const std::array<Point3, 2> place = places(pair);
    for (std::size_t s = 0; s < 2; ++s) {
      const auto charts = charts_.find(place[s]);
      if (charts == charts_.end()) return;
      const Near on_border = nearest(charts->second, true, place[s]), any = nearest(charts->second, false, place[s]);
      // A vertex of the border has a pixel of the border, which need not be the nearest one where that stands off.
      constexpr double kOffBorder = 0.5;  // [spacings]
      const bool takes_border = on_border.distance <= any.distance + kOffBorder * double{asset_.spacing};
      pixel[s] = takes_border ? on_border.pixel : any.pixel;
    }
    if (pixel[0] != kNone && pixel[1] != kNone) join(pixel[0], pixel[1]);
  }

  void join(uint32_t a, uint32_t b) {
    if (a != b) pair_.insert({std::min(a, b), std::max(a, b)});
  }

  const TriangleMesh& mesh_;
  const ClothAsset& asset_;
  using Pixels = std::pair<uint16_t, bool>;  ///< chart, of the border only
  std::vector<Point3> position_;             ///< per pixel
  std::map<Point3, std::set<uint16_t>> charts_;
  std::map<Pixels, std::vector<uint32_t>> pixels_;
  std::map<Pixels, PointTree> tree_;
  std::set<std::array<uint32_t, 2>> pair_;
};

}  // namespace

std::vector<std::array<uint32_t, 2>> sew_pixels(std::span<const SewingRun> runs, const TriangleMesh& mesh,
                                                const ClothAsset& asset) {
  if (runs.empty()) return {};
  PixelSewer sewer(mesh, asset);
  for (const SewingRun& run : runs) sewer.add(run);
  return sewer.pairs();
}

}  // namespace geocloth
