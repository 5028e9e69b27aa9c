// SPDX-License-Identifier: Apache-2.0
// Convex solids. The hull of points grows by one point at a time, the farthest from the face that it is outside of
// (Barber, Dobkin, Huhdanpaa 1996, "The Quickhull algorithm"): the faces that see it give way to a fan from the rim of
// the hole. The corners behind planes are where three of them meet; their hull is then the surface.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/solid.h"

namespace geocloth {
namespace {

struct Face {
  std::array<uint32_t, 3> corner;
  Vec3d normal;
  double offset = 0;
  [[nodiscard]] double height(const Vec3d& p) const { return dot(normal, p) - offset; }
};

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) {
    for (const Vec3& v : points) points_.push_back(to_double(v));
    start();
    for (uint32_t next = farthest(); next != kNone; next = farthest()) add(next);
  }

  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  [[noreturn]] static void flat() {
    throw Error(ErrorCode::invalid_argument,
                "the points of a convex collider lie in one plane; they must span a volume");
  }

  template <class Measure>
  uint32_t largest(const Measure& measure) const {
    uint32_t best = 0;
    for (uint32_t i = 1; i < points_.size(); ++i)
      if (measure(points_[i]) > measure(points_[best])) best = i;
    return best;
  }

  /// A tetrahedron of points that are far apart; sets the tolerance.
  void start() {
    if (points_.size() < 4) flat();
    const Vec3d origin = points_[0];
    const uint32_t a = largest([&](const Vec3d& p) { return dot(p - origin, p - origin); });
    const uint32_t b = largest([&](const Vec3d& p) { return dot(p - points_[a], p - points_[a]); });
    const Vec3d ab = points_[b] - points_[a];
    const auto off_line = [&](const Vec3d& p) {
      const Vec3d n = cross(ab, p - points_[a]);
      return dot(n, n);
    };
    const uint32_t c = largest(off_line);
    const Vec3d n = cross(ab, points_[c] - points_[a]);
    const auto off_plane = [&](const Vec3d& p) { return std::abs(dot(n, p - points_[a])); };
    const uint32_t d = largest(off_plane);
    const double size = std::sqrt(dot(ab, ab));
    tolerance_ = 1e-6 * size;
    if (!(dot(n, n) > 0) || !(off_plane(points_[d]) > tolerance_ * std::sqrt(dot(n, n)))) flat();
    const bool d_above = dot(n, points_[d] - points_[a]) > 0;
    const auto [p, q] = d_above ? std::pair{c, b} : std::pair{b, c};
    add_face(a, p, q);
    add_face(a, q, d);
    add_face(q, p, d);
    add_face(p, a, d);
  }

  void add_face(uint32_t a, uint32_t b, uint32_t c) {
    Vec3d n = cross(points_[b] - points_[a], points_[c] - points_[a]);
    const double l = std::sqrt(dot(n, n));
    if (l > 0) n = {n.x / l, n.y / l, n.z / l};
    faces_.push_back({{a, b, c}, n, dot(n, points_[a])});
  }

  /// The point that is highest above any face.
  [[nodiscard]] uint32_t farthest() const {
    uint32_t best = kNone;
    double height = tolerance_;
    for (uint32_t i = 0; i < points_.size(); ++i)
      for (const Face& f : faces_)
        if (const double h = f.height(points_[i]); h > height) {
          height = h;
          best = i;
        }
    return best;
  }

  void add(uint32_t point) {
    if (faces_.size() > 4 * kMostConvexPlanes) {
      throw Error(ErrorCode::invalid_argument, "the hull of a convex collider has more than " +
                                                   std::to_string(kMostConvexPlanes) +
                                                   " faces; give fewer points, or use shape \"mesh\"");
    }
    std::map<std::pair<uint32_t, uint32_t>, bool> seen;  // directed edges of the faces that see the point
    std::vector<Face> kept;
    for (const Face& f : faces_) {
      if (f.height(points_[point]) <= 0.5 * tolerance_) {
        kept.push_back(f);
        continue;
      }
      for (size_t k = 0; k < 3; ++k) seen[{f.corner[k], f.corner[(k + 1) % 3]}] = true;
    }
    faces_ = std::move(kept);
    for (const auto& [edge, unused] : seen)
      if (!seen.contains({edge.second, edge.first})) add_face(edge.first, edge.second, point);
  }

  std::vector<Vec3d> points_;
  std::vector<Face> faces_;
  double tolerance_ = 0;
};

/// Faces of one plane count once.
std::vector<Plane> planes_of(const std::vector<Face>& faces, std::span<const Vec3> points) {
  std::vector<Plane> planes;
  for (const Face& f : faces) {
    const Vec3 n{static_cast<float>(f.normal.x), static_cast<float>(f.normal.y), static_cast<float>(f.normal.z)};
    const auto same = [&](const Plane& p) { return dot(p.normal, n) > 1 - 1e-6F; };
    if (std::none_of(planes.begin(), planes.end(), same)) planes.push_back({points[f.corner[0]], n});
  }
  if (planes.size() > kMostConvexPlanes) {
    throw Error(ErrorCode::invalid_argument, "the hull of a convex collider has " + std::to_string(planes.size()) +
                                                 " faces, more than " + std::to_string(kMostConvexPlanes) +
                                                 "; give fewer points, or use shape \"mesh\"");
  }
  return planes;
}

/// Corners that several triples of planes share count once.
std::vector<Vec3> corners_behind(std::span<const Plane> planes) {
  std::vector<Vec3> corners;
  for (size_t a = 0; a < planes.size(); ++a)
    for (size_t b = a + 1; b < planes.size(); ++b)
      for (size_t c = b + 1; c < planes.size(); ++c) {
        const Vec3d na = to_double(planes[a].normal), nb = to_double(planes[b].normal),
                    nc = to_double(planes[c].normal);
        const double volume = dot(na, cross(nb, nc));
        if (std::abs(volume) < 1e-9) continue;
        const double oa = dot(na, to_double(planes[a].point)), ob = dot(nb, to_double(planes[b].point)),
                     oc = dot(nc, to_double(planes[c].point));
        const Vec3d bc = cross(nb, nc), ca = cross(nc, na), ab = cross(na, nb);
        const auto meet = [&](double Vec3d::*i) {
          return static_cast<float>((oa * bc.*i + ob * ca.*i + oc * ab.*i) / volume);
        };
        const Vec3 corner{meet(&Vec3d::x), meet(&Vec3d::y), meet(&Vec3d::z)};
        const float slack = 1e-5F * (1 + length(corner));
        const auto behind = [&](const Plane& p) { return dot(p.normal, corner - p.point) <= slack; };
        const auto known = [&](const Vec3& k) { return length(k - corner) <= slack; };
        if (!std::all_of(planes.begin(), planes.end(), behind)) continue;
        if (std::none_of(corners.begin(), corners.end(), known)) corners.push_back(corner);
      }
  return corners;
}

/// As where a prism without an end has its other end.
bool in_one_plane(std::span<const Vec3> points) {
  const Vec3d origin = to_double(points[0]);
  const auto of_origin = [&](const Vec3& p) { return to_double(p) - origin; };
  Vec3d along{}, normal{};
  for (const Vec3& p : points)
    if (const Vec3d d = of_origin(p); dot(d, d) > dot(along, along)) along = d;
  for (const Vec3& p : points)
    if (const Vec3d n = cross(along, of_origin(p)); dot(n, n) > dot(normal, normal)) normal = n;
  const double flat = 1e-5 * std::sqrt(dot(along, along) * dot(normal, normal));
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& p) { return std::abs(dot(normal, of_origin(p))) <= flat; });
}

/// None where the planes leave a side open or nothing is behind all of them.
std::optional<TriangleSurface> surface_of(std::span<const Plane> planes) {
  const std::vector<Vec3> corners = corners_behind(planes);
  if (corners.size() < 4 || in_one_plane(corners)) return std::nullopt;
  Convex closed = convex_hull(corners);
  // Planes that leave a side open have corners too; then the hull of these is not all of the solid.
  const auto touched = [&](const Plane& face) {
    return std::any_of(planes.begin(), planes.end(),
                       [&](const Plane& p) { return dot(p.normal, face.normal) > 1 - 1e-4F; });
  };
  if (!std::all_of(closed.planes.begin(), closed.planes.end(), touched)) return std::nullopt;
  return std::move(closed.surface);
}

}  // namespace

Convex convex_hull(std::span<const Vec3> points) {
  const Hull hull(points);
  Convex convex;
  convex.planes = planes_of(hull.faces(), points);
  convex.surface.position.assign(points.begin(), points.end());
  for (const Face& f : hull.faces()) convex.surface.triangle.push_back(f.corner);
  return convex;
}

Convex convex_of_planes(std::span<const Plane> planes) {
  constexpr size_t kMostPlanes = 64;  // triples of them are tried
  if (planes.empty() || planes.size() > kMostPlanes) {
    throw Error(ErrorCode::invalid_argument, "a convex collider needs 1 to " + std::to_string(kMostPlanes) +
                                                 " planes, not " + std::to_string(planes.size()) +
                                                 "; give more of them as points");
  }
  Convex convex;
  convex.planes.assign(planes.begin(), planes.end());
  if (std::optional<TriangleSurface> surface = surface_of(planes)) {
    convex.surface = std::move(*surface);
    return convex;
  }
  std::vector<Plane> turned;
  for (const Plane& p : planes) turned.push_back({p.point, -p.normal});
  if (surface_of(turned)) {
    throw Error(ErrorCode::invalid_argument,
                "nothing is behind all planes of the convex collider: their normals must point out of the solid");
  }
  return convex;
}

}  // namespace geocloth
