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
constexpr double kFlatHole = 0.9;        // share of an opening's direction in the normals beside it: a hole in a sheet
constexpr double kLoose = 0.4;           // roundness: a border that is less round runs along a front or round a sheet
constexpr double kOpposed = 0.3;         // of the openings' areas, their sum: they face each other

constexpr double kRuled = 0.2;    // ratio of the normals' spreads: straight along a line, as sheets in waves are
constexpr double kCurved = 5e-3;  // the larger of these: less is flat

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
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();  // [m^2] about it
};

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

Masses masses_of(const CleanSurface& surface) {
  Masses m{.middle = triangle_middles(surface.position, surface.triangle)};
  m.area = total_area(m.middle);
  for (const auto& [place, area] : m.middle) m.centre = m.centre + place * (area / m.area);
  for (const auto& [place, area] : m.middle) m.spread += square(place - m.centre) * (area / m.area);
  return m;
}

bool is_round(const Eigen::Vector3d& ascending_spread) {
  return ascending_spread[1] > kRound * ascending_spread[2];
}

/// 1 of an opening in a flat sheet, 0 of the end of a tube.
double flatness_beside(const CleanSurface& surface, const std::vector<uint32_t>& loop, const Point3& direction) {
  double sum = 0, around = 0;
  for (const uint32_t h : loop) {
    const Point3 &a = surface.position[tail(surface.triangle, h)], &b = surface.position[head(surface.triangle, h)];
    const Point3 normal = normal_of(surface, h / 3);
    const double edge = distance(a, b), size = length(normal);
    around += edge;
    if (size > 0) sum += edge * std::abs(dot(normal, direction)) / size;
  }
  return around > 0 ? sum / around : 0;
}

/// What the borders of a part tell.
struct Openings {
  Eigen::Matrix3d along = Eigen::Matrix3d::Zero();  // [m^2] areas by direction
  Point3 sum{0, 0, 0};                              // [m^2]
  double round = 0, loose = 0;                      // [m] around those that are openings, and others
};

struct Sides {
  std::optional<Point3> up;
  std::optional<Point3> sideways;  ///< not up
};

/// The line that openings face along. Where a part is open in front, down to its hem, its sleeves or armholes are all
/// the openings that it has: they face each other, to its sides.
Sides sides_of_openings(const CleanSurface& surface, const Masses& masses) {
  std::vector<double> part_area(surface.component_count, 0.0);
  for (size_t t = 0; t < masses.middle.size(); ++t) part_area[surface.component[t]] += masses.middle[t].area;
  const bool round_sheet = is_round(Axes(masses.spread).eigenvalues());
  std::vector<Openings> parts(surface.component_count);
  for (const std::vector<uint32_t>& loop : border_loops(surface)) {
    Openings& part = parts[surface.component[loop.front() / 3]];
    const Point3 vector = area_vector(surface, loop);
    const double size = length(vector), around = length_around(surface, loop);
    const double roundness = std::min(1.0, 4 * std::numbers::pi * size / (around * around));
    (roundness < kLoose ? part.loose : part.round) += around;
    if (!(size > 0) || size > kLargestOpening * part_area[surface.component[loop.front() / 3]]) continue;
    if (!round_sheet && flatness_beside(surface, loop, vector * (1 / size)) > kFlatHole) continue;
    part.along += square(vector) * (roundness / size);
    part.sum = part.sum + vector * roundness;
  }
  Eigen::Matrix3d openings = Eigen::Matrix3d::Zero(), sideways = Eigen::Matrix3d::Zero();
  for (const Openings& part : parts) {
    const bool faces_its_sides = part.loose > part.round && length(part.sum) < kOpposed * part.along.trace();
    (faces_its_sides ? sideways : openings) += part.along;
  }
  const auto main_axis = [&](const Eigen::Matrix3d& along) -> std::optional<Point3> {
    if (along.trace() < kLeastOpenings * masses.area) return std::nullopt;
    const Axes axes(along);
    if (axes.eigenvalues()[2] < kAgreed * along.trace()) return std::nullopt;
    return axis(axes, 2);
  };
  return {main_axis(openings), main_axis(sideways)};
}

/// The mean direction of a sheet's borders near an axis; the axis where there are none.
Point3 along_borders(const CleanSurface& surface, const Masses& masses, const Point3& axis) {
  constexpr double kCosine = 0.8;
  constexpr double kRadii = 2;  // radii of gyration, together
  Point3 sum{0, 0, 0};
  for (const std::vector<uint32_t>& loop : border_loops(surface)) {
    for (const uint32_t h : loop) {
      const Point3 edge = surface.position[head(surface.triangle, h)] - surface.position[tail(surface.triangle, h)];
      const double along = dot(edge, axis);
      if (std::abs(along) > kCosine * length(edge)) sum = sum + edge * (along < 0 ? -1 : 1);
    }
  }
  const double size = length(sum);
  return size > kRadii * std::sqrt(masses.spread.trace()) ? sum * (1 / size) : axis;
}

/// The line that sheets are straight along, as curtains, flags in the wind and capes are along their folds: at right
/// angles to their normals, but along their own edges where some run that way, too, as folds may be slanted. Flat
/// pieces tell nothing.
std::optional<Point3> axis_of_folds(const CleanSurface& surface, const Masses& masses) {
  std::vector<Eigen::Matrix3d> normals(surface.component_count, Eigen::Matrix3d::Zero());
  std::vector<Point3> sums(surface.component_count, Point3{0, 0, 0});
  for (size_t t = 0; t < surface.triangle.size(); ++t) {
    const Point3 normal = normal_of(surface, t);
    const double size = length(normal);
    if (size > 0) normals[surface.component[t]] += square(normal) / size;
    sums[surface.component[t]] = sums[surface.component[t]] + normal;
  }
  Eigen::Matrix3d curved = Eigen::Matrix3d::Zero();
  for (size_t c = 0; c < normals.size(); ++c) {
    const double area = normals[c].trace(), mean = length(sums[c]);
    if (mean * mean < (1 - kCurved) * area * area) curved += normals[c];
  }
  if (!(curved.trace() > 0)) return std::nullopt;
  const Axes axes(curved);
  const Eigen::Vector3d spread = axes.eigenvalues() / curved.trace();
  if (!(spread[1] > kCurved && spread[0] < kRuled * spread[1])) return std::nullopt;
  return along_borders(surface, masses, axis(axes, 0));
}

/// The share of the area by which the halves on both sides of the middle differ in how they taper along an axis.
double taper(const Masses& masses, const Point3& axis) {
  constexpr size_t kSlices = 10;  // of each half
  double farthest = 0;
  for (const auto& [place, area] : masses.middle)
    farthest = std::max(farthest, std::abs(dot(place - masses.centre, axis)));
  if (!(farthest > 0)) return 0;
  std::array<double, kSlices> more{};
  for (const auto& [place, area] : masses.middle) {
    const double height = dot(place - masses.centre, axis) / farthest;
    const auto slice = std::min(kSlices - 1, static_cast<size_t>(std::abs(height) * kSlices));
    more[slice] += height < 0 ? -area : area;
  }
  double differs = 0;
  for (const double m : more) differs += std::abs(m);
  return differs / masses.area;
}

/// @param sideways  not along this
std::optional<Point3> axis_of_unlike_ends(const CleanSurface& surface, const Masses& masses,
                                          const std::optional<Point3>& sideways) {
  constexpr double kAlong = 0.7;
  const double radius = std::sqrt(masses.spread.trace());
  if (!(radius > 0)) return std::nullopt;
  const Axes axes(masses.spread);
  const Eigen::Vector3d size = axes.eigenvalues() / masses.spread.trace();  // ascending
  const TriangleTree tree(surface.position, surface.triangle);
  const std::vector<Point3> samples = even_samples(masses.middle, kSamples);
  std::optional<Point3> best;
  double most = kAlike;
  for (int k = 2; k >= 0; --k) {
    const bool round_sheet = k == 0 && is_round(size);
    if (size[k] < kThin && !round_sheet) continue;
    const Point3 direction = axis(axes, k);
    if (sideways && std::abs(dot(direction, *sideways)) > kAlong) continue;
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

/// Of a garment whose openings do not tell. What hangs in folds hangs along them; but a cape that is bent over the
/// back, as wide above as below across its folds, hangs as it tapers.
std::optional<Point3> axis_of_sheet(const CleanSurface& surface, const Masses& masses,
                                    const std::optional<Point3>& sideways) {
  constexpr double kEven = 0.05, kTapers = 0.1;  // of the area
  constexpr double kInSheet = 0.5;               // of a direction along the mean normal, at most
  const std::optional<Point3> ends = axis_of_unlike_ends(surface, masses, sideways);
  const std::optional<Point3> folds = sideways ? std::nullopt : axis_of_folds(surface, masses);
  if (!folds || !ends) return folds ? folds : ends;
  Point3 normal{0, 0, 0};
  for (size_t t = 0; t < surface.triangle.size(); ++t) normal = normal + normal_of(surface, t);
  const bool in_sheet = std::abs(dot(*ends, normal)) < kInSheet * length(normal);
  return in_sheet && taper(masses, *folds) < kEven && taper(masses, *ends) > kTapers ? ends : folds;
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
  auto [up, sideways] = sides_of_openings(surface, masses);
  if (!up) up = axis_of_sheet(surface, masses, sideways);
  if (!up) return {};
  up = longer_end(higher_end_of(*up), masses);
  // An upright surface stays as it is, to the last bit.
  if (std::abs((*up)[1]) > 1 - kClear * kClear) up = Point3{0, (*up)[1] < 0 ? -1.0 : 1.0, 0};
  return Upright(*up);
}

}  // namespace geocloth
