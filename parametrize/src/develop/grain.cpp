// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions without a head are averaged with their angles doubled.
//
// Where the Gaussian curvature of a surface is not zero a map has to stretch, to shear, or both. The symmetric
// Dirichlet energy has no opinion which, since it knows no directions, but woven cloth has two: any surface can be laid
// out with its threads orthogonal everywhere (geodesic coordinates), and about a fifth more of the little stretch that
// near-isometric charts have anyway buys most of the way there.

#include "develop/grain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kLevel = 0.1;               // strength below which a panel counts as level
constexpr double kSlender = 6;               // ratio of the spreads along and across
constexpr double kFan = 2.5;                 // mean over strength: of an even fan that is 130 degrees wide or more
constexpr double kClearMean = 0.3;           // the least of such a mean
constexpr double kAcross = 0.7;              // cosine of the angle from which lines run across each other
constexpr double kLargeTriangle = 1.0 / 16;  // share of the panel
constexpr double kShearPrice = 6;
constexpr uint32_t kThreadSteps = 8;
constexpr int kThreadRounds = 2;

double along(const Point2& a, const Point2& b) {
  return a[0] * b[0] + a[1] * b[1];
}

/// What a triangle spreads about its middle. The middles alone will not do for a few: those of a rectangle's two
/// triangles lie across its diagonal.
Point3 spread_of(const std::array<Point2, 3>& uv, double area) {
  const Point2 middle{(uv[0][0] + uv[1][0] + uv[2][0]) / 3, (uv[0][1] + uv[1][1] + uv[2][1]) / 3};
  Point3 square{0, 0, 0};
  for (const Point2& p : uv) {
    const double x = p[0] - middle[0], y = p[1] - middle[1];
    square = square + Point3{x * x, x * y, y * y} * (area / 12);
  }
  return square;
}

GrainSum sum_of(const Chart& c) {
  GrainSum sum;
  std::vector<double> area(c.triangle.size(), 0.0);
  for (size_t i = 0; i < area.size(); ++i) {
    if (!c.is_cloth(i)) continue;
    const Triangle& t = c.triangle[i];
    const GrainSum one =
        grain_of_triangle({c.position[t[0]], c.position[t[1]], c.position[t[2]]}, {c.uv[t[0]], c.uv[t[1]], c.uv[t[2]]});
    sum.add(one);
    area[i] = one.area;
  }
  for (size_t i = 0; i < area.size(); ++i) {
    const Triangle& t = c.triangle[i];
    if (!c.is_cloth(i) || area[i] < kLargeTriangle * sum.area) continue;
    sum.square = sum.square + spread_of({c.uv[t[0]], c.uv[t[1]], c.uv[t[2]]}, area[i]);
  }
  return sum;
}

Grain grain_from(const GrainSum& sum) {
  const double angle = 0.5 * std::atan2(sum.doubled[1], sum.doubled[0]);
  Grain grain{{std::cos(angle), std::sin(angle)}, std::hypot(sum.doubled[0], sum.doubled[1]) / sum.area};
  if (along(sum.mean, grain.axis) < 0) grain.axis = {-grain.axis[0], -grain.axis[1]};
  return grain;
}

/// The direction in which the area spreads most.
struct LongAxis {
  Point2 direction;
  double ratio;  // of the spreads along it and across
};

LongAxis long_axis(const GrainSum& sum) {
  const double x = sum.moment[0] / sum.area, y = sum.moment[1] / sum.area;
  const double xx = sum.square[0] / sum.area - x * x, xy = sum.square[1] / sum.area - x * y,
               yy = sum.square[2] / sum.area - y * y;
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const double mean = (xx + yy) / 2, most = std::hypot((xx - yy) / 2, xy);
  return {{std::cos(angle), std::sin(angle)}, std::sqrt((mean + most) / std::max(mean - most, 1e-12 * mean))};
}

double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Corners of the convex hull, counterclockwise (Andrew 1979, "Another efficient algorithm for convex hulls").
std::vector<Point2> hull_of(std::span<const Point2> points) {
  std::vector<Point2> sorted(points.begin(), points.end()), hull;
  std::sort(sorted.begin(), sorted.end());
  for (const bool upper : {false, true}) {
    const size_t first = hull.size();
    for (const Point2& p : sorted) {
      while (hull.size() > first + 1 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // where the other half begins
    if (!upper) std::reverse(sorted.begin(), sorted.end());
  }
  return hull;
}

/// The long side of the smallest box around points: one side of that box lies along the hull (Freeman and Shapira 1975,
/// "Determining the minimum-area encasing rectangle for an arbitrary closed curve").
Point2 long_side_of_box(std::span<const Point2> points, const Point2& otherwise) {
  constexpr double kSmaller = 1 - 1e-9;  // what differs by less is rounding
  const std::vector<Point2> hull = hull_of(points);
  Point2 best = otherwise;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    const Point2 &a = hull[i], &b = hull[i + 1 == hull.size() ? 0 : i + 1];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (!(length > 0)) continue;
    const Point2 side{(b[0] - a[0]) / length, (b[1] - a[1]) / length}, across{-side[1], side[0]};
    double low = 0, high = 0, depth = 0;
    for (const Point2& p : hull) {
      const Point2 from_a{p[0] - a[0], p[1] - a[1]};
      low = std::min(low, along(from_a, side));
      high = std::max(high, along(from_a, side));
      depth = std::max(depth, along(from_a, across));
    }
    const double area = (high - low) * depth;
    if (!(area < least * kSmaller)) continue;
    least = area;
    best = high - low > depth ? side : across;
  }
  return best;
}

}  // namespace

void GrainSum::add(const GrainSum& other, double times) {
  area += times * other.area;
  for (size_t k = 0; k < 2; ++k) {
    doubled[k] += times * other.doubled[k];
    mean[k] += times * other.mean[k];
    moment[k] += times * other.moment[k];
  }
  square = square + other.square * times;
}

GrainSum grain_of_triangle(const std::array<Point3, 3>& p, const std::array<Point2, 3>& uv) {
  const Point2 &a = uv[0], &b = uv[1], &d = uv[2];
  const double h1 = p[1][1] - p[0][1], h2 = p[2][1] - p[0][1];
  GrainSum sum;
  sum.area = ((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0])) / 2;
  const double x = (a[0] + b[0] + d[0]) / 3, y = (a[1] + b[1] + d[1]) / 3;
  sum.moment = {sum.area * x, sum.area * y};
  sum.square = {sum.area * x * x, sum.area * x * y, sum.area * y * y};
  // Gradient of the height over the plane, times the triangle's area.
  const Point2 up{(h1 * (d[1] - a[1]) - h2 * (b[1] - a[1])) / 2, (h2 * (b[0] - a[0]) - h1 * (d[0] - a[0])) / 2};
  const double size = std::hypot(up[0], up[1]);
  if (!(size > 0)) return sum;
  sum.mean = up;
  sum.doubled = {(up[0] * up[0] - up[1] * up[1]) / size, 2 * up[0] * up[1] / size};
  return sum;
}

Grain grain_of(const Chart& c) {
  return grain_from(sum_of(c));
}

Point2 upward(const GrainSum& sum, std::span<const Point2> outline) {
  const Grain grain = grain_from(sum);
  const LongAxis axis = long_axis(sum);
  if (axis.ratio <= kSlender) {
    // Of threads that spread out in a wide fan, as a cape's do, the doubled angles cancel; what is left may point
    // across.
    const double mean = std::hypot(sum.mean[0], sum.mean[1]) / sum.area;
    const double wide = std::abs(along(sum.mean, grain.axis)) < kAcross * mean * sum.area ? 1 : kFan;
    if (mean > std::max(wide * grain.strength, kClearMean)) {
      return {sum.mean[0] / (mean * sum.area), sum.mean[1] / (mean * sum.area)};
    }
    if (grain.strength >= kLevel) return grain.axis;
  }
  // A square has no long axis but rounding's: lying askew, its threads would end at every side.
  const Point2 d = axis.ratio > kSlender ? axis.direction : long_side_of_box(outline, axis.direction);
  // The end that is higher stays up.
  return along(grain.axis, d) < 0 ? Point2{-d[0], -d[1]} : d;
}

void turn_upright(Chart& c) {
  const Point2 up = upward(sum_of(c), c.uv);
  for (Point2& p : c.uv) p = {p[0] * up[1] - p[1] * up[0], along(p, up)};
}

bool is_askew(const Chart& c) {
  constexpr double kSeen = 0.1;  // sine: less does not stand out at a hem
  return std::abs(upward(sum_of(c), c.uv)[0]) > kSeen;
}

void straighten_threads(Chart& c, double share, std::span<const double> times) {
  const std::vector<Point2> before = c.uv;
  SymmetricDirichlet energy = chart_energy(c);
  energy.set_shear_price(share * kShearPrice);
  energy.set_weights(times);
  // The energy knows the plane's axes, so that it turns the chart a little: that is undone, and what it lost regained.
  for (int round = 0; round < kThreadRounds; ++round) {
    if (round > 0) turn_upright(c);
    energy.minimise(c.uv, kThreadSteps, 1e-6);
  }
  if (crossing_edges(c, outline_loop(c))) c.uv = before;
}

namespace {

/// How the plane's axes lie on a triangle.
struct TriangleThreads {
  double angle = 0;  // [degrees] off a right one
  double anisotropy = 1;
};

/// Nothing where the triangle has no area in the plane or on the surface.
std::optional<TriangleThreads> threads_of(const Chart& c, const Triangle& t) {
  const Point2 &o = c.uv[t[0]], &p = c.uv[t[1]], &q = c.uv[t[2]];
  const Point3 a = c.position[t[1]] - c.position[t[0]], b = c.position[t[2]] - c.position[t[0]];
  // The plane's axes on the surface, times the triangle's area in the plane.
  const Point3 x = a * (q[1] - o[1]) - b * (p[1] - o[1]), y = b * (p[0] - o[0]) - a * (q[0] - o[0]);
  const double xx = dot(x, x), xy = dot(x, y), yy = dot(y, y);
  const double difference = std::hypot(xx - yy, 2 * xy), smaller = xx + yy - difference;
  if (!(smaller > 0)) return std::nullopt;
  return TriangleThreads{std::asin(std::min(std::abs(xy) / std::sqrt(xx * yy), 1.0)) * 180 / std::numbers::pi,
                         std::sqrt((xx + yy + difference) / smaller)};
}

}  // namespace

std::vector<double> anisotropies(const Chart& c) {
  std::vector<double> result;
  result.reserve(c.triangle.size());
  for (size_t i = 0; i < c.triangle.size(); ++i) {
    const std::optional<TriangleThreads> threads =
        c.is_cloth(i) ? threads_of(c, c.triangle[i]) : std::optional<TriangleThreads>{};
    result.push_back(threads.value_or(TriangleThreads{}).anisotropy);
  }
  return result;
}

ThreadMeasure measure_threads(const std::vector<Chart>& charts) {
  using Weighted = std::pair<double, double>;  // of a triangle, its area
  std::vector<Weighted> angle, anisotropy;
  double all = 0;
  for (const Chart& c : charts) {
    for (size_t i = 0; i < c.triangle.size(); ++i) {
      if (!c.is_cloth(i)) continue;
      const Triangle& t = c.triangle[i];
      const std::optional<TriangleThreads> threads = threads_of(c, t);
      if (!threads) continue;
      const double area = triangle_area(c.position[t[0]], c.position[t[1]], c.position[t[2]]);
      angle.emplace_back(threads->angle, area);
      anisotropy.emplace_back(threads->anisotropy, area);
      all += area;
    }
  }
  std::sort(angle.begin(), angle.end());
  std::sort(anisotropy.begin(), anisotropy.end());
  const auto quantile = [&](const std::vector<Weighted>& sorted, double share) {
    double sum = 0;
    for (const auto& [value, area] : sorted) {
      sum += area;
      if (sum >= share * all) return value;
    }
    return sorted.empty() ? 0 : sorted.back().first;
  };
  return {quantile(angle, 0.5), quantile(angle, 0.95), quantile(anisotropy, 0.95)};
}

}  // namespace geocloth
