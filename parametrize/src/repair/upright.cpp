// SPDX-License-Identifier: GPL-3.0-or-later
//
// The area vector of a closed curve (half the sum of the cross products of its successive points) stands at right
// angles to the opening that the curve bounds, and is as long as that is large. The openings of a garment are small
// beside its cloth, and round; curves for which that is not so bound pieces of a sewing pattern or sheets, or run along
// a jacket's front.

#include "repair/upright.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Eigenvalues>

#include "geocloth/parametrize/mirror.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"
#include "mesh/triangle_tree.h"
#include "repair/border_loops.h"

namespace geocloth {
namespace {

constexpr double kLargestOpening = 0.3;  // of the area of the part that it is in
constexpr double kLeastOpenings = 0.02;  // of the garment's area, together, as far as they are round
constexpr double kAgreed = 0.7;          // share of the openings' areas along the axis

constexpr size_t kSamples = 1000;  // of the surface, each of equal area
constexpr double kNoImage = 0.05;  // radii of gyration: a mirror image farther from the surface has no counterpart
constexpr double kAlike = 0.2;     // share of samples without counterpart: less is no difference
constexpr double kThin = 0.05;     // share of the spread: what is thinner is the thickness of a sheet
constexpr double kRound = 0.8;     // ratio of its spreads along itself: a sheet that is rounder stands on its normal
constexpr double kClear = 1e-6;    // of units: less is rounding

/// The surface as masses.
struct Masses {
  std::vector<TriangleMiddle> middle;
  double area = 0;  // [m^2]
  Point3 centre{0, 0, 0};
};

Masses masses_of(const CleanSurface& surface) {
  Masses m{triangle_middles(surface.position, surface.triangle)};
  m.area = total_area(m.middle);
  for (const auto& [place, area] : m.middle) m.centre = m.centre + place * (area / m.area);
  return m;
}

Point3 area_vector(const CleanSurface& surface, const std::vector<uint32_t>& loop) {
  const Point3& origin = surface.position[tail(surface.triangle, loop.front())];
  Point3 sum{0, 0, 0};
  for (const uint32_t h : loop) {
    const Point3 &a = surface.position[tail(surface.triangle, h)], &b = surface.position[head(surface.triangle, h)];
    sum = sum + cross(a - origin, b - origin) * 0.5;
  }
  return sum;
}

Eigen::Matrix3d square(const Point3& p) {
  const Eigen::Vector3d v(p[0], p[1], p[2]);
  return v * v.transpose();
}

using Axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

Point3 axis(const Axes& axes, int k) {
  const Eigen::Vector3d v = axes.eigenvectors().col(k).normalized();
  return {v[0], v[1], v[2]};
}

std::optional<Point3> axis_of_openings(const CleanSurface& surface, const Masses& masses) {
  std::vector<double> part_area(surface.component_count, 0.0);
  for (size_t t = 0; t < masses.middle.size(); ++t) part_area[surface.component[t]] += masses.middle[t].area;
  Eigen::Matrix3d openings = Eigen::Matrix3d::Zero();
  for (const std::vector<uint32_t>& loop : border_loops(surface)) {
    const Point3 vector = area_vector(surface, loop);
    const double size = length(vector);
    if (!(size > 0) || size > kLargestOpening * part_area[surface.component[loop.front() / 3]]) continue;
    const double around = length_around(surface, loop);
    const double roundness = std::min(1.0, 4 * std::numbers::pi * size / (around * around));
    openings += square(vector) * (roundness / size);
  }
  if (openings.trace() < kLeastOpenings * masses.area) return std::nullopt;
  const Axes axes(openings);
  if (axes.eigenvalues()[2] < kAgreed * openings.trace()) return std::nullopt;
  return axis(axes, 2);
}

std::optional<Point3> axis_of_unlike_ends(const CleanSurface& surface, const Masses& masses) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& [place, area] : masses.middle) spread += square(place - masses.centre) * (area / masses.area);
  const double radius = std::sqrt(spread.trace());
  if (!(radius > 0)) return std::nullopt;
  const Axes axes(spread);
  const Eigen::Vector3d size = axes.eigenvalues() / spread.trace();  // ascending
  const TriangleTree tree(surface.position, surface.triangle);
  const std::vector<Point3> samples = even_samples(masses.middle, kSamples);
  std::optional<Point3> best;
  double most = kAlike;
  for (int k = 2; k >= 0; --k) {
    const bool round_sheet = k == 0 && size[1] > kRound * size[2];
    if (size[k] < kThin && !round_sheet) continue;
    const Point3 direction = axis(axes, k);
    const MirrorPlane plane{direction, dot(direction, masses.centre)};
    size_t alone = 0;
    std::optional<TriangleTree::Place> last;
    for (const Point3& p : samples) {
      const Point3 image = plane.image(p);
      last = tree.nearest(image, last);
      if (distance(image, last->point) > kNoImage * radius) ++alone;
    }
    const double share = static_cast<double>(alone) / static_cast<double>(samples.size());
    // Of ends that differ as much, those that are farther apart.
    constexpr double kMore = 1.1;
    if (share < (best ? kMore : 1) * most) continue;
    most = share;
    best = direction;
  }
  return best;
}

Point3 higher_end_of(const Point3& axis) {
  for (const size_t k : {size_t{1}, size_t{2}, size_t{0}}) {
    if (std::abs(axis[k]) > kClear) return axis[k] < 0 ? Point3{0, 0, 0} - axis : axis;
  }
  return axis;
}

/// The end of an axis on whose side the area reaches farther out; the one given where both are alike.
Point3 longer_end(const Point3& axis, const Masses& masses) {
  double second = 0, third = 0;
  for (const auto& [place, area] : masses.middle) {
    const double height = dot(place - masses.centre, axis);
    second += area / masses.area * height * height;
    third += area / masses.area * height * height * height;
  }
  return third < -kClear * second * std::sqrt(second) ? axis * -1 : axis;
}

}  // namespace

Upright::Upright(const Point3& up) {
  if (up[1] < 0) {  // its other end to +y, and half a turn about x
    const Upright other(up * -1);
    row_ = {other.row_[0], up, other.row_[2] * -1};
    return;
  }
  // Rodrigues' formula, about the axis up x y.
  const double x = -up[2], z = up[0], c = up[1], s = 1 / (1 + c);
  row_ = {{{1 - z * z * s, -z, x * z * s}, {z, c, -x}, {x * z * s, x, 1 - x * x * s}}};
}

Point3 Upright::higher_end() const {
  return higher_end_of(up());
}

Point3 Upright::apply(const Point3& p) const {
  return {dot(row_[0], p), dot(row_[1], p), dot(row_[2], p)};
}

Point3 Upright::undo(const Point3& p) const {
  return row_[0] * p[0] + row_[1] * p[1] + row_[2] * p[2];
}

std::vector<Point3> Upright::apply(std::vector<Point3> points) const {
  if (is_identity()) return points;
  for (Point3& p : points) p = apply(p);
  return points;
}

std::vector<Point3> Upright::undo(std::vector<Point3> points) const {
  if (is_identity()) return points;
  for (Point3& p : points) p = undo(p);
  return points;
}

Upright find_upright(const CleanSurface& surface) {
  const Masses masses = masses_of(surface);
  if (!(masses.area > 0)) return {};
  std::optional<Point3> up = axis_of_openings(surface, masses);
  if (!up) up = axis_of_unlike_ends(surface, masses);
  if (!up) return {};
  up = longer_end(higher_end_of(*up), masses);
  // An upright surface stays as it is, to the last bit.
  if (std::abs((*up)[1]) > 1 - kClear * kClear) up = Point3{0, (*up)[1] < 0 ? -1.0 : 1.0, 0};
  return Upright(*up);
}

}  // namespace geocloth
