// SPDX-License-Identifier: Apache-2.0
// Convex solids. The hull of points grows by one point at a time, the farthest from the face that it is outside of
// (Barber, Dobkin, Huhdanpaa 1996, "The Quickhull algorithm"): the faces that see it give way to a fan from the rim of
// the hole. Each face keeps the points that are outside of it and of no face before; a point that is outside of none is
// not looked at again. The corners behind planes are where three of them meet; their hull is then the surface.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "check_input.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/solid.h"

namespace geocloth {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

struct Face {
  std::array<uint32_t, 3> corner;
  Vec3d normal;
  double offset = 0;
  std::vector<uint32_t> outside = {};  ///< points that no other face has
  uint32_t farthest = kNone;           ///< of them
  double farthest_height = 0;
  [[nodiscard]] double height(const Vec3d& p) const { return dot(normal, p) - offset; }
};

class Hull {
 public:
  explicit Hull(std::span<const Vec3> points) {
    for (const Vec3& v : points) {
      if (!is_finite(v)) throw Error(ErrorCode::invalid_argument, "a point of a convex collider is not finite");
      points_.push_back(to_double(v));
    }
    start();
    while (const Face* face = highest()) add(face->farthest);
  }

  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }

 private:
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
    for (uint32_t i = 0; i < points_.size(); ++i) give(i, 0);
  }

  void add_face(uint32_t a, uint32_t b, uint32_t c) {
    Vec3d n = cross(points_[b] - points_[a], points_[c] - points_[a]);
    const double l = std::sqrt(dot(n, n));
    if (l > 0) n = {n.x / l, n.y / l, n.z / l};
    faces_.push_back({{a, b, c}, n, dot(n, points_[a])});
  }

  /// Gives a point to the face that it is highest above, of those from `first` on.
  /// @return whether there is one
  bool give(uint32_t point, size_t first) {
    Face* best = nullptr;
    double height = tolerance_;
    for (size_t i = first; i < faces_.size(); ++i)
      if (const double h = faces_[i].height(points_[point]); h > height) {
        height = h;
        best = &faces_[i];
      }
    if (best == nullptr) return false;
    best->outside.push_back(point);
    if (height > best->farthest_height) {
      best->farthest_height = height;
      best->farthest = point;
    }
    return true;
  }

  /// The face with the point that is highest above any; null where none is outside.
  [[nodiscard]] const Face* highest() const {
    const auto lower = [](const Face& a, const Face& b) { return a.farthest_height < b.farthest_height; };
    const auto face = std::max_element(faces_.begin(), faces_.end(), lower);
    return face->farthest == kNone ? nullptr : &*face;
  }

  void add(uint32_t point) {
    if (faces_.size() > 4 * kMostConvexPlanes) {
      throw Error(ErrorCode::invalid_argument, "the hull of a convex collider has more than " +
                                                   std::to_string(kMostConvexPlanes) +
                                                   " faces; give fewer points, or use shape \"mesh\"");
    }
    const auto gone = std::stable_partition(
        faces_.begin(), faces_.end(), [&](const Face& f) { return f.height(points_[point]) <= 0.5 * tolerance_; });
    std::set<std::pair<uint32_t, uint32_t>> seen;  // directed edges of the faces that see the point
    std::vector<uint32_t> left;
    for (auto f = gone; f != faces_.end(); ++f) {
      for (size_t k = 0; k < 3; ++k) seen.emplace(f->corner[k], f->corner[(k + 1) % 3]);
      left.insert(left.end(), f->outside.begin(), f->outside.end());
    }
    faces_.erase(gone, faces_.end());
    const size_t first = faces_.size();
    for (const auto& [a, b] : seen)
      if (!seen.contains({b, a})) add_face(a, b, point);
    // What is outside is so of a new face, but for rounding.
    for (const uint32_t p : left)
      if (p != point && !give(p, first)) give(p, 0);
  }

  std::vector<Vec3d> points_;
  std::vector<Face> faces_;
  double tolerance_ = 0;
};

/// Faces of one plane count once.
std::vector<Plane> planes_of(const std::vector<Face>& faces, std::span<const Vec3> points) {
  std::vector<Plane> planes;
  for (const Face& f : faces) {
    if (!(dot(f.normal, f.normal) > 0)) continue;  // three corners on one edge of the solid
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
  std::map<uint32_t, uint32_t> corners;  // by point
  for (const Face& f : hull.faces())
    for (const uint32_t i : f.corner) corners[i] = 0;
  for (auto& [point, corner] : corners) {
    corner = static_cast<uint32_t>(convex.surface.position.size());
    convex.surface.position.push_back(points[point]);
  }
  for (const Face& f : hull.faces())
    convex.surface.triangle.push_back({corners[f.corner[0]], corners[f.corner[1]], corners[f.corner[2]]});
  return convex;
}

Convex convex_of_planes(std::span<const Plane> planes) {
  if (planes.empty() || planes.size() > kMostJoinedPlanes) {
    throw Error(ErrorCode::invalid_argument, "a convex collider needs 1 to " + std::to_string(kMostJoinedPlanes) +
                                                 " planes, not " + std::to_string(planes.size()) +
                                                 "; give more of them as points");
  }
  for (const Plane& plane : planes) check(plane, "a plane of a convex collider");
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
