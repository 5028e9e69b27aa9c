// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/place_mender.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/grid_holds.h"
#include "geocloth/asset/grid_mesh.h"
#include "mesh/nearest_weights.h"

namespace geocloth {
namespace {

constexpr double kNearGoal = 0.97;  // of the goal, where samples are pulled to
constexpr int kIterations = 25, kMostInVain = 4;
constexpr int kIterationsInAll = 1000;
constexpr int kSearchesInAll = 1'000'000;  // for the surface's nearest place: garments need a sixth at most
constexpr double kLongestStep = 1.3, kShortestStep = 0.05, kShorter = 0.5;
constexpr double kShortest = 0.35, kLongest = 1.85;  // [spacing] springs, as everywhere in the image
constexpr double kLeastArea = 0.2;                   // of a triangle, beside what it was
constexpr double kLeastTurn = 0.3;                   // cosine between a triangle's normals before and after
constexpr int kPlacesPerEdge = 3;

bool holds(const std::vector<uint32_t>& list, uint32_t x) {
  return std::find(list.begin(), list.end(), x) != list.end();
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

Ball ball_around(const std::array<Point3, 3>& corner) {
  const Point3 middle = (corner[0] + corner[1] + corner[2]) * (1.0 / 3);
  return {middle, std::max({distance(middle, corner[0]), distance(middle, corner[1]), distance(middle, corner[2])})};
}

std::vector<std::array<uint32_t, 2>> structural_springs(const ClothAsset& asset, std::span<const uint32_t> first) {
  std::vector<std::array<uint32_t, 2>> spring;
  for_structural_springs(asset, [&](uint32_t a, uint32_t b) { spring.push_back({first[a], first[b]}); });
  return spring;
}

}  // namespace

PlaceMender::PlaceMender(ImageSurface& image, const Raster& raster, const TriangleTree& surface, double goal)
    : image_(image),
      raster_(raster),
      surface_(surface),
      goal_(goal),
      iterations_left_(kIterationsInAll),
      searches_left_(kSearchesInAll),
      is_hem_(points_on_border(image.asset, image.first)),
      spring_(structural_springs(image.asset, image.first)),
      triangles_of_(image.asset.pixel_count(), image.points),
      springs_of_(image.asset.pixel_count(), spring_),
      triangles_in_(image.flat.charts.size()),
      locator_(image.flat.charts.size()),
      is_moved_(image.asset.pixel_count(), 0),
      middle_(middles()),
      place_in_triangle_(middles_and_edges()) {
  for (uint32_t t = 0; t < image.flat.triangle.size(); ++t) triangles_in_[image.flat.chart[t]].push_back(t);
}

void PlaceMender::begin_pass() {
  image_tree_.emplace(image_.place, image_.points);
  is_tried_.assign(image_.asset.pixel_count(), 0);
}

/// The triangles around a point, and those of their points that may move.
bool PlaceMender::gather(uint32_t middle, int rings) {
  constexpr std::size_t kMostTriangles = 1024;  // a third of that lies around places of garments at most
  region_.clear();
  moving_.assign(1, middle);
  std::vector<uint32_t> ring = moving_;
  for (int k = 0; k <= rings; ++k) {
    std::vector<uint32_t> next;
    for (const uint32_t p : ring) {
      if (region_.size() + triangles_of_[p].size() > kMostTriangles) return false;
      for (const uint32_t t : triangles_of_[p]) {
        if (holds(region_, t)) continue;
        region_.push_back(t);
        for (const uint32_t q : image_.points[t]) {
          if (!holds(next, q) && !holds(moving_, q)) next.push_back(q);
        }
      }
    }
    if (k < rings) moving_.insert(moving_.end(), next.begin(), next.end());
    ring = std::move(next);
  }
  // Hems stay where they are, unless it is one that is far off.
  if (is_hem_[middle] == 0) std::erase_if(moving_, [&](uint32_t p) { return is_hem_[p] != 0; });
  return true;
}

const PlaneLocator& PlaceMender::locator(uint32_t chart) {
  if (!locator_[chart]) {
    locator_[chart] = std::make_unique<PlaneLocator>(image_.flat, image_.flat.charts[chart], triangles_in_[chart]);
  }
  return *locator_[chart];
}

void PlaceMender::sample_surface() {
  constexpr double kBeside = 0.02;  // [pixels]
  sample_.clear();
  for (const uint32_t k : region_) {
    const Triangle& t = image_.pixels[k];
    const PlaneLocator& chart = locator(image_.asset.chart[t[0]]);
    for (const Point3& w : middle_) {
      Point2 place{};
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t x = 0; x < 2; ++x) place[x] += w[i] * raster_.place[t[i]][x];
      }
      if (const auto p = surface_point(image_.flat, chart.locate(place), place, kBeside)) sample_.push_back(*p);
    }
    image_.for_each_vertex_in(image_.cell_of(k), [&](const Point3& p) { sample_.push_back(p); });
  }
  // Those that the image is nearer to elsewhere say nothing of this place.
  std::optional<TriangleTree::Place> near;
  std::size_t kept = 0;
  near_sample_.clear();
  for (const Point3& s : sample_) {
    near = image_tree_->nearest(s, near);
    if (!holds(region_, near->triangle)) continue;
    sample_[kept++] = s;
    near_sample_.push_back(near->triangle);
  }
  sample_.resize(kept);
  near_place_.assign(region_.size() * place_in_triangle_.size(), std::nullopt);
}

/// What is farther from the other surface than is wanted. What was near a triangle or a place of it mostly still is,
/// and then no nearer one is looked for.
/// @returns the largest distance of all; 0: all are as near as is wanted
double PlaceMender::find_misses(std::vector<Miss>& misses) {
  constexpr double kRoundedUp = 1 + 1e-9;
  misses.clear();
  double farthest = 0;
  const double wanted = kNearGoal * goal_;
  const auto count = [&](uint32_t t, const Point3& weight, const Point3& way) {
    const double d = length(way);
    if (!(d > wanted)) return;
    farthest = std::max(farthest, d);
    misses.push_back({image_.points[t], weight, way * (1 - wanted / d)});
  };
  ball_.clear();
  for (const uint32_t t : region_) ball_.push_back(ball_around(image_.corners(t)));
  const auto miss_of = [&](uint32_t t, const Point3& s) -> Miss {
    const std::array<Point3, 3> corner = image_.corners(t);
    const Point3 weight = nearest_weights(corner[0], corner[1], corner[2], s);
    return {image_.points[t], weight, s - at(corner, weight)};
  };
  for (std::size_t k = 0; k < sample_.size(); ++k) {
    const Point3& s = sample_[k];
    const double last = length(miss_of(near_sample_[k], s).way);
    if (last <= wanted) continue;
    double least = std::numeric_limits<double>::infinity(), within = last * kRoundedUp;
    Miss nearest{};
    for (std::size_t i = 0; i < region_.size(); ++i) {
      if (distance(ball_[i].middle, s) - ball_[i].radius > within) continue;
      const Miss miss = miss_of(region_[i], s);
      const double squared = dot(miss.way, miss.way);
      if (squared >= least) continue;
      least = squared;
      within = std::sqrt(squared) * kRoundedUp;
      nearest = miss;
      near_sample_[k] = region_[i];
    }
    count(near_sample_[k], nearest.weight, nearest.way);
  }
  std::optional<TriangleTree::Place> found;
  auto near = near_place_.begin();
  for (const uint32_t t : region_) {
    const std::array<Point3, 3> corner = image_.corners(t);
    for (const Point3& weight : place_in_triangle_) {
      const Point3 p = at(corner, weight);
      std::optional<Point3>& last = *near++;
      if (last && distance(*last, p) <= wanted) continue;
      --searches_left_;
      found = surface_.nearest(p, found);
      last = found->point;
      count(t, weight, found->point - p);
    }
  }
  return farthest;
}

void PlaceMender::pull(const std::vector<Miss>& misses, double step) {
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
    if (weight[k] > 0) image_.place[moving_[k]] = image_.place[moving_[k]] + sum[k] * (step / weight[k]);
  }
}

void PlaceMender::limit_lengths() {
  constexpr int kSweeps = 3;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const uint32_t p : moving_) {
      for (const uint32_t k : springs_of_[p]) {
        const uint32_t q = spring_[k][0] == p ? spring_[k][1] : spring_[k][0];
        const Point3 along = image_.place[p] - image_.place[q];
        const double l = length(along),
                     wanted = std::clamp(l, kShortest * image_.asset.spacing, kLongest * image_.asset.spacing);
        if (l > 0 && l != wanted) image_.place[p] = image_.place[q] + along * (wanted / l);
      }
    }
  }
}

std::vector<double> PlaceMender::lengths() const {
  std::vector<double> result;
  for (const uint32_t p : moving_) {
    for (const uint32_t k : springs_of_[p])
      result.push_back(distance(image_.place[spring_[k][0]], image_.place[spring_[k][1]]));
  }
  return result;
}

std::vector<Point3> PlaceMender::normals() const {
  std::vector<Point3> result;
  result.reserve(region_.size());
  for (const uint32_t t : region_) result.push_back(image_.normal(t));
  return result;
}

/// Are triangles not folded over, and springs within limits or no worse than they were?
bool PlaceMender::is_sound(const std::vector<Point3>& normal_before, const std::vector<double>& length_before) const {
  for (std::size_t k = 0; k < region_.size(); ++k) {
    const Point3 now = image_.normal(region_[k]);
    const double is = length(now), was = length(normal_before[k]);
    if (is < kLeastArea * was || dot(now, normal_before[k]) < kLeastTurn * was * is) return false;
  }
  constexpr double kRounding = 1e-3;
  const std::vector<double> now = lengths();
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double least = std::min(length_before[k], kShortest * image_.asset.spacing) * (1 - kRounding);
    const double most = std::max(length_before[k], kLongest * image_.asset.spacing) * (1 + kRounding);
    if (now[k] < least || now[k] > most) return false;
  }
  return true;
}

std::vector<Point3> PlaceMender::moving_places() const {
  std::vector<Point3> result;
  result.reserve(moving_.size());
  for (const uint32_t p : moving_) result.push_back(image_.place[p]);
  return result;
}
void PlaceMender::put(const std::vector<Point3>& places) {
  for (std::size_t k = 0; k < moving_.size(); ++k) image_.place[moving_[k]] = places[k];
}

bool PlaceMender::mend_around(uint32_t point, int rings) {
  if (!gather(point, rings)) return false;
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
  for (int k = 0; k < kIterations && !is_exhausted() && step > kShortestStep && least > goal_; ++k) {
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

}  // namespace geocloth
