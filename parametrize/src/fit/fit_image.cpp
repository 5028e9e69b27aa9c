// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels that sample a curved surface make a mesh that cuts its corners: linear interpolation at spacing h is off by
// 0.091 f'' h^2 rms, the least squares fit by the same triangles by 0.037 f'' h^2, and a cell whose diagonal lies along
// a fold by half of one whose diagonal lies across. So every cell is compared with the surface at many places of the
// chart's plane, its diagonal is chosen by what remains after a fit, and the pixels move to the L2 projection of the
// surface on to the piecewise linear functions of the grid, one unknown per surface point. Later rounds count only what
// is missing across the grid, so that pixels slide along the surface to its folds (Gauss-Newton with a little inertia),
// as far as the springs' lengths and angles allow (grid_holds.cpp); and they count what is far off more, so that the
// largest deviation falls as well (iteratively reweighted least squares).
#include "fit/fit_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "fit/fit_system.h"
#include "fit/grid_holds.h"
#include "fit/mend_far.h"
#include "geocloth/asset/grid_mesh.h"
#include "image/chart_sampling.h"
#include "image/limit_springs.h"
#include "image/pixel_areas.h"
#include "mesh/point_math.h"
#include "mesh/untangle.h"

namespace geocloth {
namespace {

constexpr int kRounds = 4, kRoundsOfSquares = 2;
constexpr int kPasses = 3;        ///< per round, in which springs that a move would break are found
constexpr double kInertia = 0.1;  ///< of moves along the surface beside those across it
constexpr double kLongestMove = 0.25, kFarthest = 0.4;  ///< [spacings] in a round, and in all
constexpr double kFarOff = 0.1;                         ///< [spacings] that are missing where a target counts twice
constexpr double kMostWeight = 50;                      ///< that a target may get
constexpr double kFarOffOfSquares = 0.15, kMostWeightOfSquares = 20;  ///< the same
constexpr double kLeastPlaneArea = 1e-3;         ///< [pixels^2] of a grid triangle in the plane that takes part
constexpr double kExact = 1e-12, kRough = 1e-4;  ///< of the right side that a solution may leave, squared

/// A place of a cell and the surface there.
struct Target {
  Point2 place;     ///< [pixels] in the chart
  Point3 position;  ///< [m]
  Point3 normal;    ///< of the surface
  double area = 0;  ///< [pixels^2] that it stands for
};

/// How far a cell's corners, joined by one of its diagonals, are from the targets in it.
struct CellFit {
  CellTriangles split;
  std::array<std::array<Point3, 3>, 2> pull{};  ///< per triangle and corner: integral of what is missing [m pixels^2]
  std::array<double, 2> weight{1, 1};           ///< per triangle: mean of its targets' weights
  std::array<FarPlace, 2> farthest{};           ///< per triangle: where most is missing
  double error = 0;                             ///< integral of what is missing, squared [m^2 pixels^2]
};

/// Of a triangle; of no length where it has no area.
Point3 unit_normal(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 normal = cross(b - a, c - a);
  const double l = length(normal);
  return l > 0 ? normal * (1 / l) : normal;
}

Point3 held(const Point3& v, double longest) {
  const double l = length(v);
  return l <= longest ? v : v * (longest / l);
}

class ImageFitter {
 public:
  ImageFitter(const FlatSurface& flat, const Raster& raster, ClothAsset& asset)
      : flat_(flat),
        raster_(raster),
        asset_(asset),
        is_square_(asset.layout == Layout::square),
        first_(first_copies(asset)),
        is_hem_(points_on_border(asset, first_)),
        shift_(asset.pixel_count()),
        pull_(asset.pixel_count()),
        farthest_(asset.pixel_count()),
        weight_(2 * std::size_t{asset.pixel_count()}, 1) {
    is_split_.assign(asset.pixel_count(), 0);
    for (const uint32_t pixel : asset.splits.pixel) is_split_[pixel] = 1;
    places_per_edge_ = count_valid_pixels(asset) < kFewPixels ? 4 : 2;
  }

  /// Compares all cells with the surface and chooses their diagonals.
  void compare_cells() {
    std::vector<std::vector<uint32_t>> triangles(flat_.charts.size()), cells(flat_.charts.size());
    for (uint32_t t = 0; t < flat_.triangle.size(); ++t) triangles[flat_.chart[t]].push_back(t);
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      const CellTriangles split = cell_triangles(asset_, i);
      if (split.count != 0) cells[asset_.chart[split.triangle[0][0]]].push_back(i);
    }
    std::vector<CellFit> fit;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (cells[c].empty() || triangles[c].empty()) continue;
      const PlaneLocator locator(flat_, flat_.charts[c], triangles[c]);
      constexpr std::size_t kBatch = 1U << 14U;
      for (std::size_t begin = 0; begin < cells[c].size(); begin += kBatch) {
        fit.assign(std::min(kBatch, cells[c].size() - begin), {});
        tbb::parallel_for(std::size_t{0}, fit.size(),
                          [&](std::size_t k) { fit[k] = best_fit(cells[c][begin + k], locator); });
        for (std::size_t k = 0; k < fit.size(); ++k) take(cells[c][begin + k], fit[k]);
      }
    }
  }

  /// Moves the pixels by what the comparison found missing: at first just so, and then along the surface as well.
  void move_pixels() {
    std::vector<Point3> move(pull_.size(), Point3{});
    if (!may_slide_ || is_square_) {
      FitSystem(pull_.size(), fit_triangles()).solve(pull_, {}, kExact, move);
    } else {
      slide(move);
    }
    for (std::size_t i = 0; i < shift_.size(); ++i) shift_[i] = shift_[i] + move[i];
    pull_.assign(pull_.size(), Point3{});
    farthest_.assign(farthest_.size(), {});
    may_slide_ = true;
  }

  /// What the last comparison found: per first copy, where most is missing around it.
  [[nodiscard]] const std::vector<FarPlace>& farthest() const { return farthest_; }

  void finish() {
    limit_shifts();
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if (asset_.valid(i)) asset_.rest_position[i] = to_single(fitted_position(i));
    }
  }

 private:
  static constexpr uint32_t kFewPixels = 200'000;

  // -------------------------------------------------------------------------------------------------- cells

  [[nodiscard]] Point3 fitted_position(uint32_t pixel) const { return raster_.position[pixel] + shift_[first_[pixel]]; }

  [[nodiscard]] Point3 grid_normal(const Triangle& t) const {
    return unit_normal(fitted_position(t[0]), fitted_position(t[1]), fitted_position(t[2]));
  }

  [[nodiscard]] double plane_area(const Triangle& t) const {
    return signed_area_twice(raster_.place[t[0]], raster_.place[t[1]], raster_.place[t[2]]) / 2;
  }

  [[nodiscard]] Point3 weights(const Triangle& t, const Point2& p) const {
    const Point2 &a = raster_.place[t[0]], &b = raster_.place[t[1]], &c = raster_.place[t[2]];
    return Point3{signed_area_twice(p, b, c), signed_area_twice(a, p, c), signed_area_twice(a, b, p)} *
           (1 / signed_area_twice(a, b, c));
  }

  /// The surface at a place, without an area; nothing beside the chart, where the outline's pixels cut a hollow corner.
  [[nodiscard]] std::optional<Target> surface_at(const PlaneLocator& locator, const Point2& place) const {
    constexpr double kBeside = 0.02;  // [pixels]
    const PlanePlace found = locator.locate(place);
    const std::optional<Point3> position = surface_point(flat_, found, place, kBeside);
    if (!position) return std::nullopt;
    const Triangle& t = flat_.triangle[found.triangle];
    return Target{place, *position, unit_normal(flat_.position[t[0]], flat_.position[t[1]], flat_.position[t[2]])};
  }

  /// Places spread evenly over a grid triangle: the middles of the triangles that its edges' division makes.
  void add_targets(const Triangle& t, const PlaneLocator& locator, std::vector<Target>& targets) const {
    const double area = plane_area(t);
    if (area < kLeastPlaneArea) return;
    const int n = places_per_edge_;
    const auto add = [&](double i, double j) {
      const double s = i / n, u = j / n;
      Point2 place{};
      for (std::size_t x = 0; x < 2; ++x) {
        place[x] = (1 - s - u) * raster_.place[t[0]][x] + s * raster_.place[t[1]][x] + u * raster_.place[t[2]][x];
      }
      if (const auto target = surface_at(locator, place)) {
        targets.push_back(*target);
        targets.back().area = area / (n * n);
      }
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < n) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
  }

  [[nodiscard]] bool touches_hem(const Triangle& t) const {
    return std::any_of(t.begin(), t.end(), [&](uint32_t i) { return is_hem_[first_[i]] != 0; });
  }

  /// May the corners of a grid triangle slide along the surface? Those on hems stay, or the cloth would shrink.
  [[nodiscard]] bool slides(const Triangle& t) const { return may_slide_ && (is_square_ || !touches_hem(t)); }

  [[nodiscard]] double weight_of(const Point3& missing) const {
    if (!may_slide_) return 1;
    const double unit = (is_square_ ? kFarOffOfSquares : kFarOff) * asset_.spacing;
    return std::min(1 + dot(missing, missing) / (unit * unit), is_square_ ? kMostWeightOfSquares : kMostWeight);
  }

  /// @param split  triangles that cover the targets
  [[nodiscard]] CellFit compare(const CellTriangles& split, const std::vector<Target>& targets) const {
    CellFit fit{split};
    std::array<double, 2> area{}, weighted{};
    std::array<Point3, 2> normal{};
    for (std::size_t k = 0; k < split.count; ++k) normal[k] = grid_normal(split.triangle[k]);
    for (const Target& target : targets) {
      std::size_t k = 0;
      Point3 w = weights(split.triangle[0], target.place);
      if (split.count == 2 && std::min({w[0], w[1], w[2]}) < 0) {
        k = 1;
        w = weights(split.triangle[1], target.place);
      }
      Point3 image{};
      for (std::size_t i = 0; i < 3; ++i) image = image + fitted_position(split.triangle[k][i]) * w[i];
      Point3 missing = target.position - image;
      if (slides(split.triangle[k])) {
        const Point3& n = is_square_ ? target.normal : normal[k];
        missing = n * dot(missing, n);
      }
      const double squared = dot(missing, missing);
      fit.error += target.area * squared;
      const double counts = target.area * weight_of(missing);
      if (squared > fit.farthest[k].squared) fit.farthest[k] = {squared, target.position, image};
      area[k] += target.area;
      weighted[k] += counts;
      for (std::size_t i = 0; i < 3; ++i) fit.pull[k][i] = fit.pull[k][i] + missing * (counts * w[i]);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      if (area[k] > 0) fit.weight[k] = weighted[k] / area[k];
    }
    return fit;
  }

  /// The cell split by its other diagonal, unless that could repeat an edge of the welded mesh (CellSplitter in
  /// seams.cpp), cut a corner of the outline, or turn a triangle over.
  [[nodiscard]] std::optional<CellTriangles> split_otherwise(uint32_t a) const {
    const uint32_t b = a + 1, c = a + asset_.width, d = c + 1;
    const bool is_left = (asset_.cell[a] & kCellDiagonalLeft) != 0;
    const uint32_t from = is_left ? a : b, to = is_left ? d : c;
    const bool linked =
        is_left ? (asset_.spring_mask[a] & kSpringDownRight) != 0 : (asset_.spring_mask[b] & kSpringDownLeft) != 0;
    if (!linked || is_split_[from] != 0 || is_split_[to] != 0) return std::nullopt;
    if (raster_.vertex[from] != kNone && raster_.vertex[to] != kNone) return std::nullopt;
    CellTriangles other;
    other.count = 2;
    if (is_left) {
      other.triangle = {{{a, c, d}, {a, d, b}}};
    } else {
      other.triangle = {{{a, c, b}, {b, c, d}}};
    }
    for (const Triangle& t : other) {
      if (plane_area(t) < kLeastPlaneArea) return std::nullopt;
    }
    return other;
  }

  [[nodiscard]] CellFit best_fit(uint32_t cell, const PlaneLocator& locator) const {
    const CellTriangles split = cell_triangles(asset_, cell);
    std::vector<Target> targets;
    for (const Triangle& t : split) add_targets(t, locator, targets);
    CellFit fit = compare(split, targets);
    const bool whole = split.count == 2 && plane_area(split.triangle[0]) >= kLeastPlaneArea &&
                       plane_area(split.triangle[1]) >= kLeastPlaneArea;
    if (!whole) return fit;
    if (const auto other = split_otherwise(cell)) {
      // Flat cells keep theirs whatever the rounding.
      constexpr double kLeastGain = 1e-10;  // [spacings^2 pixels^2]
      CellFit otherwise = compare(*other, targets);
      if (otherwise.error + kLeastGain * asset_.spacing * asset_.spacing < fit.error) return otherwise;
    }
    return fit;
  }

  void take(uint32_t cell, const CellFit& fit) {
    for (std::size_t k = 0; k < fit.split.count; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        Point3& pull = pull_[first_[fit.split.triangle[k][i]]];
        pull = pull + fit.pull[k][i];
        FarPlace& farthest = farthest_[first_[fit.split.triangle[k][i]]];
        if (fit.farthest[k].squared > farthest.squared) farthest = fit.farthest[k];
      }
      weight_[2 * std::size_t{cell} + k] = fit.weight[k];
    }
    if (fit.split.count < 2) return;
    const bool is_left = fit.split.triangle[0][2] == cell + 1;
    asset_.cell[cell] = static_cast<uint8_t>(kCellFirst | kCellSecond | (is_left ? kCellDiagonalLeft : 0));
  }

  // -------------------------------------------------------------------------------------------------- solution

  [[nodiscard]] std::vector<FitTriangle> fit_triangles() const {
    std::vector<FitTriangle> result;
    for (uint32_t cell = 0; cell < asset_.pixel_count(); ++cell) {
      const CellTriangles split = cell_triangles(asset_, cell);
      for (std::size_t k = 0; k < split.count; ++k) {
        const Triangle& t = split.triangle[k];
        const double area = plane_area(t);
        if (area < kLeastPlaneArea) continue;
        result.push_back({{first_[t[0]], first_[t[1]], first_[t[2]]},
                          grid_normal(t),
                          slides(t) && !is_square_ ? kInertia : 1,
                          area * weight_[2 * std::size_t{cell} + k]});
      }
    }
    return result;
  }

  void slide(std::vector<Point3>& move) {
    if (!holds_) holds_.emplace(asset_, raster_.position, first_, is_hem_);
    std::vector<Point3> place(pull_.size());
    for (uint32_t i = 0; i < place.size(); ++i) place[i] = fitted_position(i);
    FitSystem system(pull_.size(), fit_triangles());
    std::vector<double> farthest;
    farthest.reserve(farthest_.size());
    for (const FarPlace& f : farthest_) farthest.push_back(f.squared);
    holds_->release(farthest);
    std::vector<MoveWish> wishes = holds_->gentle_wishes(place);
    std::size_t begin = 0;
    for (int pass = 0; pass < kPasses; ++pass) {
      if (holds_->add_broken(place, move, wishes) == 0 && pass > 0) break;
      system.add(wishes, begin);
      begin = wishes.size();
      system.solve(pull_, wishes, kRough, move);
    }
    for (std::size_t i = 0; i < move.size(); ++i) {
      const Point3 whole = shift_[i] + held(move[i], kLongestMove * asset_.spacing);
      move[i] = held(whole, kFarthest * asset_.spacing) - shift_[i];
    }
  }

  /// Takes back what would make a spring much shorter or longer than it was and than it should be: at folds narrower
  /// than a pixel a fit overshoots.
  void limit_shifts() {
    constexpr double kLeastStretch = 0.6, kMostStretch = 1.5, kKept = 0.7;
    constexpr int kSweeps = 6;
    const std::vector<std::array<uint32_t, 2>> edges = grid_edges();
    for (int sweep = 0; sweep <= kSweeps; ++sweep) {
      for (const auto& [a, b] : edges) {
        const double was = distance(raster_.position[a], raster_.position[b]),
                     is = distance(fitted_position(a), fitted_position(b));
        const double wanted =
            flat_.charts[asset_.chart[a]].spacing *
            std::hypot(raster_.place[b][0] - raster_.place[a][0], raster_.place[b][1] - raster_.place[a][1]);
        if (is >= kLeastStretch * std::min(was, wanted) && is <= kMostStretch * std::max(was, wanted)) continue;
        for (const uint32_t i : {first_[a], first_[b]}) shift_[i] = shift_[i] * (sweep < kSweeps ? kKept : 0.0);
      }
    }
  }

  /// Structural springs and diagonals of the cells.
  [[nodiscard]] std::vector<std::array<uint32_t, 2>> grid_edges() const {
    std::vector<std::array<uint32_t, 2>> edges;
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if ((asset_.spring_mask[i] & kSpringRight) != 0) edges.push_back({i, i + 1});
      if ((asset_.spring_mask[i] & kSpringDown) != 0) edges.push_back({i, i + asset_.width});
      if (asset_.cell[i] == 0) continue;
      if ((asset_.cell[i] & kCellDiagonalLeft) != 0) {
        edges.push_back({i + 1, i + asset_.width});
      } else {
        edges.push_back({i, i + asset_.width + 1});
      }
    }
    return edges;
  }

  const FlatSurface& flat_;
  const Raster& raster_;
  ClothAsset& asset_;
  bool is_square_;               ///< its springs are uneven anyway: pixels move a little once, by the surface's normals
  std::vector<uint32_t> first_;  ///< per pixel: the first copy of its point
  std::vector<uint8_t> is_hem_;  ///< per first copy
  std::vector<Point3> shift_;    ///< per first copy: how far the pixel has moved [m]
  std::vector<Point3> pull_;     ///< per first copy: right side of the fit [m pixels^2]
  std::vector<FarPlace> farthest_;  ///< per first copy: where most is missing around it
  std::vector<double> weight_;      ///< per cell and triangle: how much it counts
  std::vector<uint8_t> is_split_;   ///< per pixel
  bool may_slide_ = false;          ///< along the surface
  int places_per_edge_ = 0;         ///< of a grid triangle, at which the surface is asked
  std::optional<GridHolds> holds_;
};

/// Areas, and lengths of bends over seams, of pixels as they are.
void measure_rest(ClothAsset& asset) {
  share_area(asset);
  for (SeamBend& bend : asset.seam_bends)
    bend.rest_length = length(asset.rest_position[bend.b] - asset.rest_position[bend.a]);
}

}  // namespace

void fit_image(const FlatSurface& flat, const Raster& raster, ClothAsset& asset) {
  ImageFitter fitter(flat, raster, asset);
  const int rounds = asset.layout == Layout::square ? kRoundsOfSquares : kRounds;
  for (int round = 0; round < rounds; ++round) {
    fitter.compare_cells();
    fitter.move_pixels();
  }
  fitter.finish();
  if (asset.layout != Layout::square) {  // a square stretches by more than a spring may be long
    limit_springs(asset);
    fitter.compare_cells();
    mend_far_places(flat, raster, fitter.farthest(), asset);
  }
  measure_rest(asset);
}

Untangled untangle_image(ClothAsset& asset) {
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  std::vector<Point3> place;
  place.reserve(mesh.position.size());
  for (const Vec3& p : mesh.position) place.push_back(to_double(p));
  const Untangled result = untangle(mesh.triangle, place);
  if (result.after == result.before) return result;
  for (std::size_t i = 0; i < place.size(); ++i) asset.rest_position[mesh.pixel[i]] = to_single(place[i]);
  const std::vector<uint32_t> first = first_copies(asset);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i)
    if (asset.valid(i)) asset.rest_position[i] = asset.rest_position[first[i]];
  measure_rest(asset);
  return result;
}

}  // namespace geocloth
