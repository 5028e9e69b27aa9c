// SPDX-License-Identifier: GPL-3.0-or-later
//
// Garments are symmetric: a cut on the left costs what one on the right costs, and rounding would decide between them,
// so that a file that is exported again, turned, came out with other panels. All that chooses therefore sees the
// surface through a projective map that is larger towards one side by more than rounding and by less than matters. The
// side is found from moments of the area, which turn with the surface: of third order, then with the height, then the
// longer axis; a surface that has none of these is round, and any side of it will do.
#include "mesh/uneven.h"

#include <array>
#include <cmath>
#include <optional>

#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"

namespace geocloth {
namespace {

constexpr double kUnevenness = 3e-5;  // of lengths, at one radius of gyration from the centre
constexpr double kClear = 1e-6;       // a moment that is no matter of rounding, in units of that radius

/// A horizontal direction (x, z) that turns with the surface.
/// @param surface  with middles relative to the centre, in radii
std::optional<Point2> side_of(const std::vector<TriangleMiddle>& surface, double area) {
  std::array<Point2, 3> odd{};
  Point2 twice{0, 0};  // the longer axis at twice its angle
  for (const auto& [m, weight] : surface) {
    const double across = m[0] * m[0] + m[2] * m[2];
    const std::array<double, 3> factor{across, m[1], m[1] * m[1]};
    for (size_t k = 0; k < odd.size(); ++k) {
      odd[k][0] += weight / area * factor[k] * m[0];
      odd[k][1] += weight / area * factor[k] * m[2];
    }
    twice[0] += weight / area * (m[0] * m[0] - m[2] * m[2]);
    twice[1] += weight / area * 2 * m[0] * m[2];
  }
  const auto size = [](const Point2& v) { return std::hypot(v[0], v[1]); };
  for (const Point2& v : odd) {
    if (size(v) > kClear) return Point2{v[0] / size(v), v[1] / size(v)};
  }
  if (size(twice) > kClear) {
    const double angle = 0.5 * std::atan2(twice[1], twice[0]);
    return Point2{std::cos(angle), std::sin(angle)};
  }
  return std::nullopt;
}

/// Of a round surface: towards one of the vertices that are farthest from its axis.
Point2 side_of_round(const std::vector<Point3>& position, const std::vector<Triangle>& triangle, const Point3& centre) {
  Point2 farthest{0, 0};
  double most = 0;
  for (const Triangle& t : triangle) {
    for (const uint32_t v : t) {
      const Point2 way{position[v][0] - centre[0], position[v][2] - centre[2]};
      const double far = std::hypot(way[0], way[1]);
      if (far <= most) continue;
      most = far;
      farthest = {way[0] / far, way[1] / far};
    }
  }
  return most > 0 ? farthest : Point2{1, 0};
}

}  // namespace

Point3 Uneven::apply(const Point3& p) const {
  const Point3 way = p - centre;
  return centre + way * (1 / (1 - dot(slope, way)));
}

Point3 Uneven::undo(const Point3& p) const {
  const Point3 way = p - centre;
  return centre + way * (1 / (1 + dot(slope, way)));
}

std::vector<Point3> Uneven::apply(const std::vector<Point3>& points) const {
  std::vector<Point3> result;
  result.reserve(points.size());
  for (const Point3& p : points) result.push_back(apply(p));
  return result;
}

Uneven uneven(const std::vector<Point3>& position, const std::vector<Triangle>& triangle) {
  std::vector<TriangleMiddle> surface = triangle_middles(position, triangle);
  const double area = total_area(surface);
  if (!(area > 0)) return {};
  Uneven map;
  for (const TriangleMiddle& m : surface) map.centre = map.centre + m.place * (m.area / area);
  double inertia = 0;
  for (TriangleMiddle& m : surface) {
    m.place = m.place - map.centre;
    inertia += m.area / area * dot(m.place, m.place);
  }
  const double radius = std::sqrt(inertia);
  if (!(radius > 0)) return {};
  for (TriangleMiddle& m : surface) m.place = m.place * (1 / radius);
  const std::optional<Point2> side = side_of(surface, area);
  const auto [x, z] = side ? *side : side_of_round(position, triangle, map.centre);
  // Along none of the planes that garments are symmetric about: aside, forwards and up.
  constexpr double kAlong = 0.62, kAcross = 0.53, kUp = 0.58;
  map.slope = Point3{kAlong * x + kAcross * z, kUp, kAlong * z - kAcross * x} * (kUnevenness / radius);
  return map;
}

}  // namespace geocloth
