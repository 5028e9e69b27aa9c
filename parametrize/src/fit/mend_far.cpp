// SPDX-License-Identifier: GPL-3.0-or-later
// The largest deviation of an image is that of a handful of places: tips and folds narrower than the pixels, which a
// least squares fit under bounds on springs and angles rounds off. Around each of them both surfaces are sampled, and
// every sample farther from the other surface than a goal pulls the pixels of its triangle, as constraints are
// projected in position based dynamics (Mueller et al. 2007); springs are kept between limits in the same way. The best
// state that was met is taken, measured in both directions over more than what moved, so that the largest deviation
// does not grow.
#include "fit/mend_far.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "fit/grid_holds.h"
#include "geocloth/asset/grid_mesh.h"
#include "image/chart_sampling.h"
#include "mesh/nearest_weights.h"
#include "mesh/triangle_tree.h"

namespace geocloth {
namespace {

constexpr double kGoal = 1.9e-3;     // of the size: what is nearer is near enough
constexpr double kNearGoal = 0.97;   // of the goal, where samples are pulled to
constexpr double kSameFar = 1e-3;    // of the goal: on a garment's two sides only rounding differs
constexpr double kFewPoints = 3e-3;  // share of the points around which is mended
constexpr std::size_t kFewPlaces = 50;
/// Around a point that move, per pass: more where fewer did not help, and once others have moved.
constexpr std::array<std::array<int, 2>, 3> kRings{{{2, 3}, {4, 2}, {5, 2}}};
constexpr int kIterations = 25, kMostInVain = 4;
constexpr int kIterationsInAll = 1000;  // where much is far, mending a part of it is of little use
constexpr double kLongestStep = 1.3, kShortestStep = 0.05, kShorter = 0.5;
constexpr double kShortest = 0.35, kLongest = 1.85;  // [spacing] springs, as everywhere in the image
constexpr double kLeastArea = 0.2;                   // of a triangle, beside what it was
constexpr double kLeastTurn = 0.3;                   // cosine between a triangle's normals before and after
constexpr int kPlacesPerEdge = 3;

/// For every point the elements of a list that use it.
class Users {
 public:
  template <class Element>
  Users(std::size_t points, const std::vector<Element>& elements) : first_(points + 1, 0) {
    for (const Element& e : elements) {
      for (const uint32_t p : e) ++first_[p + 1];
    }
    for (std::size_t i = 0; i < points; ++i) first_[i + 1] += first_[i];
    user_.resize(first_.back());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t k = 0; k < elements.size(); ++k) {
      for (const uint32_t p : elements[k]) user_[next[p]++] = k;
    }
  }
  [[nodiscard]] std::span<const uint32_t> operator[](uint32_t point) const {
    return {user_.data() + first_[point], user_.data() + first_[point + 1]};
  }

 private:
  std::vector<uint32_t> first_, user_;  // rows and entries
};

/// The diameter of the smallest sphere around points: never above the diagonal of the box that deviations are relative
/// to, and, unlike it, the same however a garment is turned.
double size_of(const std::vector<Point3>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> around;
  around.reserve(points.size());
  for (const Point3& p : points) around.emplace_back(p[0], p[1], p[2]);
  return 2 * CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>(around.begin(),
                                                                                                  around.end())
                 .radius();
}

bool holds(const std::vector<uint32_t>& list, uint32_t x) {
  return std::find(list.begin(), list.end(), x) != list.end();
}

Point3 at(const std::array<Point3, 3>& t, const Point3& weight) {
  return t[0] * weight[0] + t[1] * weight[1] + t[2] * weight[2];
}

/// Weights of the middles of the triangles that the division of a triangle's edges makes.
std::vector<Point3> middles() {
  std::vector<Point3> result;
  const auto add = [&](double i, double j) {
    const double s = i / kPlacesPerEdge, u = j / kPlacesPerEdge;
    result.push_back({1 - s - u, s, u});
  };
  for (int i = 0; i < kPlacesPerEdge; ++i) {
    for (int j = 0; i + j < kPlacesPerEdge; ++j) {
      add(i + 1.0 / 3, j + 1.0 / 3);
      if (i + j + 1 < kPlacesPerEdge) add(i + 2.0 / 3, j + 2.0 / 3);
    }
  }
  return result;
}

/// The same, and the corners and the middles of the edges.
std::vector<Point3> middles_and_edges() {
  std::vector<Point3> result = middles();
  for (std::size_t k = 0; k < 3; ++k) {
    Point3 corner{}, edge{};
    corner[k] = 1;
    edge[k] = edge[(k + 1) % 3] = 0.5;
    result.push_back(corner);
    result.push_back(edge);
  }
  return result;
}

/// A place that may be far from the other surface.
struct Suspect {
  Point3 surface;
  std::optional<Point3> image;  ///< that stands for it
};

/// A place of the image that is too far from the surface, or too far from a place of the surface.
struct Miss {
  Triangle point;
  Point3 weight;
  Point3 way;  ///< [m] that it has to go
};

class FarMender {
 public:
  FarMender(const FlatSurface& flat, const Raster& raster, ClothAsset& asset)
      : flat_(flat), raster_(raster), asset_(asset), first_(first_copies(asset)), pixels_(pixel_triangles(asset)) {
    points_.reserve(pixels_.size());
    for (const Triangle& t : pixels_) points_.push_back({first_[t[0]], first_[t[1]], first_[t[2]]});
    place_.reserve(asset.pixel_count());
    for (const Vec3& p : asset.rest_position) place_.push_back({p.x, p.y, p.z});
    goal_ = kGoal * size_of(flat.position);
    find_vertices();
  }

  void mend(const std::vector<FarPlace>& far) {
    std::vector<Suspect> suspects = find_suspects(far);
    if (suspects.empty()) return;
    prepare();
    for (std::size_t pass = 0; pass < kRings.size() && !suspects.empty(); ++pass) {
      for (const uint32_t p : far_points(suspects)) {
        if (iterations_left_ == 0) break;
        if (is_tried_[p] != 0) continue;
        for (const int rings : kRings.at(pass)) {
          if (mend_around(p, rings)) break;
        }
      }
      if (pass + 1 == kRings.size() || iterations_left_ == 0) break;
      image_.emplace(place_, points_);
      is_tried_.assign(is_tried_.size(), 0);
      suspects = find_suspects_anew(far);
    }
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if (!asset_.valid(i) || is_moved_[first_[i]] == 0) continue;
      const Point3& p = place_[first_[i]];
      asset_.rest_position[i] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    }
  }

 private:
  struct CellVertex {
    uint32_t cell, vertex;
  };
  static bool by_cell(const CellVertex& a, const CellVertex& b) { return a.cell < b.cell; }

  // ------------------------------------------------------------------------------------------- what is far

  /// Which cell every vertex of the surface lies in: they may be the tips of something.
  void find_vertices() {
    std::vector<uint32_t> chart_of(flat_.position.size(), kNone);
    for (std::size_t t = 0; t < flat_.triangle.size(); ++t) {
      for (const uint32_t v : flat_.triangle[t]) chart_of[v] = flat_.chart[t];
    }
    const auto cell_at = [](double x, uint32_t corner, uint32_t size) {
      return corner + static_cast<uint32_t>(std::clamp(std::floor(x), 0.0, std::max(size, 2U) - 2.0));
    };
    for (uint32_t v = 0; v < flat_.position.size(); ++v) {
      if (chart_of[v] == kNone) continue;
      const FlatChart& chart = flat_.charts[chart_of[v]];
      const uint32_t x = cell_at(flat_.uv[v][0], chart.x0, chart.width),
                     y = cell_at(flat_.uv[v][1], chart.y0, chart.height);
      vertex_.push_back({cell_beside(y * asset_.width + x, chart, flat_.uv[v]), v});
    }
  }

  /// The cell, or the nearest one around it where the outline's pixels leave it out.
  [[nodiscard]] uint32_t cell_beside(uint32_t cell, const FlatChart& chart, const Point2& place) const {
    if (cell_triangles(asset_, cell).count != 0) return cell;
    const uint32_t column = cell % asset_.width, row = cell / asset_.width;
    uint32_t best = cell;
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t y = std::max(row, 1U) - 1; y <= row + 1 && y + 1 < asset_.height; ++y) {
      for (uint32_t x = std::max(column, 1U) - 1; x <= column + 1 && x + 1 < asset_.width; ++x) {
        const uint32_t other = y * asset_.width + x;
        const double d = std::hypot(x + 0.5 - chart.x0 - place[0], y + 0.5 - chart.y0 - place[1]);
        if (d >= least || cell_triangles(asset_, other).count == 0) continue;
        least = d;
        best = other;
      }
    }
    return best;
  }

  [[nodiscard]] std::vector<Suspect> find_suspects(const std::vector<FarPlace>& far) const {
    std::vector<Suspect> suspects;
    for (const FarPlace& place : far) {
      if (place.squared > goal_ * goal_) suspects.push_back({place.surface, place.image});
    }
    for (const CellVertex& v : vertex_) {
      const Point3& p = flat_.position[v.vertex];
      bool is_near = false;
      for (const Triangle& t : cell_triangles(asset_, v.cell)) {
        const std::array<Point3, 3> corner{place_[first_[t[0]]], place_[first_[t[1]]], place_[first_[t[2]]]};
        is_near = is_near || distance(at(corner, nearest_weights(corner[0], corner[1], corner[2], p)), p) <= goal_;
      }
      if (!is_near) suspects.push_back({p, std::nullopt});
    }
    return suspects;
  }

  /// The same once pixels have moved, and the places of the image itself that are far: to the comparison along the
  /// surface's normals a pixel beside a fold seems near.
  [[nodiscard]] std::vector<Suspect> find_suspects_anew(const std::vector<FarPlace>& far) const {
    std::vector<Suspect> suspects = find_suspects(far);
    for (Suspect& s : suspects) s.image.reset();  // it was that of the pixels as they were
    std::vector<Point3> place;
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if (asset_.valid(i) && first_[i] == i) place.push_back(place_[i]);
    }
    for (uint32_t t = 0; t < points_.size(); ++t) place.push_back(at(corners(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}));
    std::vector<Point3> near(place.size());
    constexpr std::size_t kBatch = 256;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, place.size(), kBatch), [&](const auto& range) {
      std::optional<TriangleTree::Place> found;
      for (std::size_t k = range.begin(); k != range.end(); ++k) {
        found = surface_->nearest(place[k], found);
        near[k] = found->point;
      }
    });
    for (std::size_t k = 0; k < place.size(); ++k) {
      if (distance(near[k], place[k]) > goal_) suspects.push_back({near[k], place[k]});
    }
    return suspects;
  }

  void prepare() {
    is_hem_ = points_on_border(asset_, first_);
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if ((asset_.spring_mask[i] & kSpringRight) != 0) spring_.push_back({first_[i], first_[i + 1]});
      if ((asset_.spring_mask[i] & kSpringDown) != 0) spring_.push_back({first_[i], first_[i + asset_.width]});
    }
    triangles_of_.emplace(asset_.pixel_count(), points_);
    springs_of_.emplace(asset_.pixel_count(), spring_);
    surface_.emplace(flat_.position, flat_.triangle);
    image_.emplace(place_, points_);
    triangles_in_.resize(flat_.charts.size());
    for (uint32_t t = 0; t < flat_.triangle.size(); ++t) triangles_in_[flat_.chart[t]].push_back(t);
    locator_.resize(flat_.charts.size());
    std::stable_sort(vertex_.begin(), vertex_.end(), by_cell);
    is_tried_.assign(asset_.pixel_count(), 0);
    is_moved_.assign(asset_.pixel_count(), 0);
  }

  /// The points beside what is truly farther than the goal, the farthest first: what lies beside each other in the
  /// plane need not be what is nearest in space.
  [[nodiscard]] std::vector<uint32_t> far_points(const std::vector<Suspect>& suspects) const {
    std::vector<double> farthest(asset_.pixel_count(), 0);
    const auto note = [&](const Point3& place, const TriangleTree::Place& in_image, double d) {
      const Triangle& t = points_[in_image.triangle];
      const uint32_t point = *std::min_element(t.begin(), t.end(), [&](uint32_t a, uint32_t b) {
        return distance(place_[a], place) < distance(place_[b], place);
      });
      farthest[point] = std::max(farthest[point], d);
    };
    for (const Suspect& s : suspects) {
      const TriangleTree::Place found = image_->nearest(s.surface);
      note(s.surface, found, distance(found.point, s.surface));
      if (!s.image) continue;
      const double away = distance(surface_->nearest(*s.image).point, *s.image);
      if (away > goal_) note(*s.image, image_->nearest(*s.image), away);
    }
    std::vector<uint32_t> points;
    for (uint32_t p = 0; p < farthest.size(); ++p) {
      if (farthest[p] > goal_) points.push_back(p);
    }
    const auto level = [&](uint32_t p) { return std::round(farthest[p] / (kSameFar * goal_)); };
    std::stable_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) { return level(a) > level(b); });
    const auto few = static_cast<std::size_t>(std::ceil(kFewPoints * count_valid_pixels(asset_)));
    points.resize(std::min({points.size(), few, kFewPlaces}));
    return points;
  }

  // ------------------------------------------------------------------------------------------- around a point

  /// The triangles around a point, and those of their points that may move.
  void gather(uint32_t middle, int rings) {
    region_.clear();
    moving_.assign(1, middle);
    std::vector<uint32_t> ring = moving_;
    for (int k = 0; k <= rings; ++k) {
      std::vector<uint32_t> next;
      for (const uint32_t p : ring) {
        for (const uint32_t t : (*triangles_of_)[p]) {
          if (holds(region_, t)) continue;
          region_.push_back(t);
          for (const uint32_t q : points_[t]) {
            if (!holds(next, q) && !holds(moving_, q)) next.push_back(q);
          }
        }
      }
      if (k < rings) moving_.insert(moving_.end(), next.begin(), next.end());
      ring = std::move(next);
    }
    // Hems stay where they are, unless it is one that is far off.
    if (is_hem_[middle] == 0) std::erase_if(moving_, [&](uint32_t p) { return is_hem_[p] != 0; });
  }

  const PlaneLocator& locator(uint32_t chart) {
    if (!locator_[chart]) {
      locator_[chart] = std::make_unique<PlaneLocator>(flat_, flat_.charts[chart], triangles_in_[chart]);
    }
    return *locator_[chart];
  }

  [[nodiscard]] uint32_t cell_of(const Triangle& t) const {
    const uint32_t w = asset_.width;
    return std::min({t[0] / w, t[1] / w, t[2] / w}) * w + std::min({t[0] % w, t[1] % w, t[2] % w});
  }

  void sample_surface() {
    constexpr double kBeside = 0.02;  // [pixels]
    sample_.clear();
    for (const uint32_t k : region_) {
      const Triangle& t = pixels_[k];
      const PlaneLocator& chart = locator(asset_.chart[t[0]]);
      for (const Point3& w : middle_) {
        Point2 place{};
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t x = 0; x < 2; ++x) place[x] += w[i] * raster_.place[t[i]][x];
        }
        if (const auto p = surface_point(flat_, chart.locate(place), place, kBeside)) sample_.push_back(*p);
      }
      const auto [begin, end] = std::equal_range(vertex_.begin(), vertex_.end(), CellVertex{cell_of(t), 0}, by_cell);
      for (auto v = begin; v != end; ++v) sample_.push_back(flat_.position[v->vertex]);
    }
    // Those that the image is nearer to elsewhere say nothing of this place.
    std::optional<TriangleTree::Place> near;
    std::size_t kept = 0;
    near_sample_.clear();
    for (const Point3& s : sample_) {
      near = image_->nearest(s, near);
      if (!holds(region_, near->triangle)) continue;
      sample_[kept++] = s;
      near_sample_.push_back(near->triangle);
    }
    sample_.resize(kept);
    near_place_.assign(region_.size() * place_in_triangle_.size(), std::nullopt);
  }

  [[nodiscard]] std::array<Point3, 3> corners(uint32_t t) const {
    return {place_[points_[t][0]], place_[points_[t][1]], place_[points_[t][2]]};
  }
  [[nodiscard]] Point3 normal(uint32_t t) const {
    const std::array<Point3, 3> corner = corners(t);
    return cross(corner[1] - corner[0], corner[2] - corner[0]);
  }

  /// What is farther from the other surface than is wanted. What was near a triangle or a place of it mostly still is,
  /// and then no nearer one is looked for.
  /// @returns the largest distance of all; 0: all are as near as is wanted
  double find_misses(std::vector<Miss>& misses) {
    misses.clear();
    double farthest = 0;
    const double wanted = kNearGoal * goal_;
    const auto count = [&](uint32_t t, const Point3& weight, const Point3& way) {
      const double d = length(way);
      if (!(d > wanted)) return;
      farthest = std::max(farthest, d);
      misses.push_back({points_[t], weight, way * (1 - wanted / d)});
    };
    const auto miss_of = [&](uint32_t t, const Point3& s) -> Miss {
      const std::array<Point3, 3> corner = corners(t);
      const Point3 weight = nearest_weights(corner[0], corner[1], corner[2], s);
      return {points_[t], weight, s - at(corner, weight)};
    };
    for (std::size_t k = 0; k < sample_.size(); ++k) {
      const Point3& s = sample_[k];
      if (length(miss_of(near_sample_[k], s).way) <= wanted) continue;
      double least = std::numeric_limits<double>::infinity();
      Miss nearest{};
      for (const uint32_t t : region_) {
        const Miss miss = miss_of(t, s);
        if (dot(miss.way, miss.way) >= least) continue;
        least = dot(miss.way, miss.way);
        nearest = miss;
        near_sample_[k] = t;
      }
      count(near_sample_[k], nearest.weight, nearest.way);
    }
    std::optional<TriangleTree::Place> found;
    auto near = near_place_.begin();
    for (const uint32_t t : region_) {
      const std::array<Point3, 3> corner = corners(t);
      for (const Point3& weight : place_in_triangle_) {
        const Point3 p = at(corner, weight);
        std::optional<Point3>& last = *near++;
        if (last && distance(*last, p) <= wanted) continue;
        found = surface_->nearest(p, found);
        last = found->point;
        count(t, weight, found->point - p);
      }
    }
    return farthest;
  }

  void pull(const std::vector<Miss>& misses, double step) {
    std::vector<Point3> sum(moving_.size(), Point3{});
    std::vector<double> weight(moving_.size(), 0);
    for (const Miss& miss : misses) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto found = std::find(moving_.begin(), moving_.end(), miss.point[i]);
        if (found == moving_.end()) continue;
        const auto k = static_cast<std::size_t>(found - moving_.begin());
        sum[k] = sum[k] + miss.way * miss.weight[i];
        weight[k] += miss.weight[i];
      }
    }
    for (std::size_t k = 0; k < moving_.size(); ++k) {
      if (weight[k] > 0) place_[moving_[k]] = place_[moving_[k]] + sum[k] * (step / weight[k]);
    }
  }

  void limit_lengths() {
    constexpr int kSweeps = 3;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (const uint32_t p : moving_) {
        for (const uint32_t k : (*springs_of_)[p]) {
          const uint32_t q = spring_[k][0] == p ? spring_[k][1] : spring_[k][0];
          const Point3 along = place_[p] - place_[q];
          const double l = length(along), wanted = std::clamp(l, kShortest * asset_.spacing, kLongest * asset_.spacing);
          if (l > 0 && l != wanted) place_[p] = place_[q] + along * (wanted / l);
        }
      }
    }
  }

  [[nodiscard]] std::vector<double> lengths() const {
    std::vector<double> result;
    for (const uint32_t p : moving_) {
      for (const uint32_t k : (*springs_of_)[p])
        result.push_back(distance(place_[spring_[k][0]], place_[spring_[k][1]]));
    }
    return result;
  }

  [[nodiscard]] std::vector<Point3> normals() const {
    std::vector<Point3> result;
    result.reserve(region_.size());
    for (const uint32_t t : region_) result.push_back(normal(t));
    return result;
  }

  /// Are triangles not folded over, and springs within limits or no worse than they were?
  [[nodiscard]] bool is_sound(const std::vector<Point3>& normal_before,
                              const std::vector<double>& length_before) const {
    for (std::size_t k = 0; k < region_.size(); ++k) {
      const Point3 now = normal(region_[k]);
      const double is = length(now), was = length(normal_before[k]);
      if (is < kLeastArea * was || dot(now, normal_before[k]) < kLeastTurn * was * is) return false;
    }
    constexpr double kRounding = 1e-3;
    const std::vector<double> now = lengths();
    for (std::size_t k = 0; k < now.size(); ++k) {
      const double least = std::min(length_before[k], kShortest * asset_.spacing) * (1 - kRounding);
      const double most = std::max(length_before[k], kLongest * asset_.spacing) * (1 + kRounding);
      if (now[k] < least || now[k] > most) return false;
    }
    return true;
  }

  [[nodiscard]] std::vector<Point3> moving_places() const {
    std::vector<Point3> result;
    result.reserve(moving_.size());
    for (const uint32_t p : moving_) result.push_back(place_[p]);
    return result;
  }
  void put(const std::vector<Point3>& places) {
    for (std::size_t k = 0; k < moving_.size(); ++k) place_[moving_[k]] = places[k];
  }

  /// @returns whether the goal is reached
  bool mend_around(uint32_t middle, int rings) {
    gather(middle, rings);
    sample_surface();
    for (const uint32_t p : moving_) is_tried_[p] = 1;
    const std::vector<Point3> normal_before = normals();
    const std::vector<double> length_before = lengths();
    std::vector<Miss> misses;
    const double at_first = find_misses(misses);
    double least = at_first, step = kLongestStep;
    std::vector<Point3> best = moving_places();
    std::vector<Miss> of_best = misses;
    int in_vain = 0;
    for (int k = 0; k < kIterations && iterations_left_ > 0 && step > kShortestStep && least > goal_; ++k) {
      --iterations_left_;
      pull(misses, step);
      limit_lengths();
      const double farthest = find_misses(misses);
      if (farthest < least && is_sound(normal_before, length_before)) {
        least = farthest;
        best = moving_places();
        of_best = misses;
        in_vain = 0;
      } else if (++in_vain == kMostInVain) {
        put(best);
        misses = of_best;
        step *= kShorter;
        in_vain = 0;
      }
    }
    put(best);
    if (least < at_first) {
      for (const uint32_t p : moving_) is_moved_[p] = 1;
    }
    return least <= goal_;
  }

  const FlatSurface& flat_;
  const Raster& raster_;
  ClothAsset& asset_;
  std::vector<uint32_t> first_;
  std::vector<Triangle> pixels_, points_;  ///< the grid's triangles: as pixels, and as first copies
  std::vector<Point3> place_;              ///< per first copy
  std::vector<CellVertex> vertex_;
  double goal_ = 0;  ///< [m]
  int iterations_left_ = kIterationsInAll;
  // From here on only where something is far.
  std::vector<uint8_t> is_hem_;
  std::vector<std::array<uint32_t, 2>> spring_;
  std::optional<Users> triangles_of_, springs_of_;
  std::optional<TriangleTree> surface_, image_;  ///< the image as it was
  std::vector<std::vector<uint32_t>> triangles_in_;
  std::vector<std::unique_ptr<PlaneLocator>> locator_;  ///< per chart
  std::vector<uint8_t> is_tried_, is_moved_;            ///< per first copy: in this pass, and ever
  std::vector<uint32_t> region_, moving_;               ///< triangles and points around the place
  std::vector<Point3> sample_;
  std::vector<uint32_t> near_sample_;              ///< per sample a triangle of the image near it
  std::vector<std::optional<Point3>> near_place_;  ///< per place of the region's triangles one of the surface near it
  const std::vector<Point3> middle_ = middles(), place_in_triangle_ = middles_and_edges();  ///< weights
};

}  // namespace

void mend_far_places(const FlatSurface& flat, const Raster& raster, const std::vector<FarPlace>& far,
                     ClothAsset& asset) {
  FarMender(flat, raster, asset).mend(far);
}

}  // namespace geocloth
