// SPDX-License-Identifier: GPL-3.0-or-later
// Round shapes are one grid of latitudes and longitudes: a sphere's direction n becomes center + radius n, for a
// tapered capsule with the latitude at which the cone touches both spheres (its normals have the sine (ra - rb) / |ab|
// along the axis), for an ellipsoid scaled by its radii.
#include "render/solid_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geocloth {
namespace {

constexpr uint32_t kSides = 64, kHalfAlong = 16;

/// Rings of points of equal count, closed round; triangles between neighbours, outward for rings that go along `axis`
/// while the points of a ring go counter-clockwise about it.
void join_rings(SolidMesh& mesh, uint32_t rings) {
  for (uint32_t ring = 0; ring + 1 < rings; ++ring)
    for (uint32_t i = 0; i < kSides; ++i) {
      const uint32_t a = ring * kSides + i, b = ring * kSides + (i + 1) % kSides;
      mesh.triangle.push_back({a, b, b + kSides});
      mesh.triangle.push_back({a, b + kSides, a + kSides});
    }
}

struct Basis {
  Vec3 x, y, z;  ///< right-handed
};

Basis basis_along(const Vec3& z) {
  const Vec3 helper = std::abs(z.x) < 0.9F ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = normalized(cross(helper, z));
  return {x, cross(z, x), z};
}

/// Adds a ring of normals at a latitude and the points center + radius * normal.
void add_ring(SolidMesh& mesh, const Basis& basis, const Vec3& center, float radius, float latitude) {
  for (uint32_t i = 0; i < kSides; ++i) {
    const float longitude = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kSides;
    const Vec3 n = basis.x * (std::cos(latitude) * std::cos(longitude)) +
                   basis.y * (std::cos(latitude) * std::sin(longitude)) + basis.z * std::sin(latitude);
    mesh.normal.push_back(n);
    mesh.position.push_back(center + n * radius);
  }
}

SolidMesh round_mesh(const Vec3& a, float radius_a, const Vec3& b, float radius_b) {
  constexpr float kQuarter = std::numbers::pi_v<float> / 2;
  const float apart = length(b - a);
  // One sphere holds the other: the smaller one does not show.
  if (radius_a != radius_b && apart <= std::abs(radius_a - radius_b))
    return radius_a > radius_b ? round_mesh(a, radius_a, a, radius_a) : round_mesh(b, radius_b, b, radius_b);
  const Basis basis = basis_along(apart > 0 ? normalized(b - a) : Vec3{0, 1, 0});
  const float touch = apart > 0 ? std::asin((radius_a - radius_b) / apart) : 0;
  SolidMesh mesh;
  const auto add_cap = [&](const Vec3& center, float radius, float from, float to) {
    for (uint32_t ring = 0; ring <= kHalfAlong; ++ring)
      add_ring(mesh, basis, center, radius, from + (to - from) * static_cast<float>(ring) / kHalfAlong);
  };
  add_cap(a, radius_a, -kQuarter, touch);
  add_cap(b, radius_b, touch, kQuarter);
  join_rings(mesh, 2 * (kHalfAlong + 1));
  return mesh;
}

SolidMesh mesh_of(const Plane&) {
  return {};
}

SolidMesh mesh_of(const Sphere& s) {
  return round_mesh(s.center, s.radius, s.center, s.radius);
}

SolidMesh mesh_of(const Capsule& c) {
  return round_mesh(c.a, c.radius_a, c.b, c.radius_b);
}

SolidMesh mesh_of(const Ellipsoid& e) {
  SolidMesh mesh = round_mesh({}, 1, {}, 1);
  for (size_t i = 0; i < mesh.position.size(); ++i) {
    const Vec3 p = mesh.position[i];
    mesh.position[i] = e.center + rotate(e.rotate, {p.x * e.radii.x, p.y * e.radii.y, p.z * e.radii.z});
    mesh.normal[i] = normalized(rotate(e.rotate, {p.x / e.radii.x, p.y / e.radii.y, p.z / e.radii.z}));
  }
  return mesh;
}

SolidMesh mesh_of(const Box& box) {
  SolidMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.F, 1.F}) {
      const Vec3 n{axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
      const Basis basis = basis_along(n);
      const auto first = static_cast<uint32_t>(mesh.position.size());
      for (const auto& [x, y] : {std::pair{-1.F, -1.F}, {1.F, -1.F}, {1.F, 1.F}, {-1.F, 1.F}}) {
        const Vec3 p = n + basis.x * x + basis.y * y;
        const Vec3& h = box.half_extents;
        mesh.position.push_back(box.center + rotate(box.rotate, {p.x * h.x, p.y * h.y, p.z * h.z}));
        mesh.normal.push_back(rotate(box.rotate, n));
      }
      mesh.triangle.push_back({first, first + 1, first + 2});
      mesh.triangle.push_back({first, first + 2, first + 3});
    }
  return mesh;
}

/// Flat faces: every triangle has corners of its own.
SolidMesh mesh_of(const Convex& convex) {
  SolidMesh mesh;
  for (const Triangle& t : convex.surface.triangle) {
    const auto first = static_cast<uint32_t>(mesh.position.size());
    const Vec3 &a = convex.surface.position[t[0]], &b = convex.surface.position[t[1]],
               &c = convex.surface.position[t[2]];
    mesh.position.insert(mesh.position.end(), {a, b, c});
    mesh.normal.insert(mesh.normal.end(), 3, normalized(cross(b - a, c - a)));
    mesh.triangle.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

SolidMesh mesh_of(const MeshSolid& solid) {
  SolidMesh mesh;
  if (!solid.field) return mesh;
  const TriangleSurface& surface = solid.field->surface;
  mesh.position = surface.position;
  mesh.normal.resize(surface.position.size());
  for (const Triangle& t : surface.triangle) {
    const Vec3& a = surface.position[t[0]];
    const Vec3 n = cross(surface.position[t[1]] - a, surface.position[t[2]] - a);  // as long as its area is large
    for (const uint32_t i : t) mesh.normal[i] = mesh.normal[i] + n;
    mesh.triangle.push_back(t);
  }
  for (Vec3& n : mesh.normal) n = length(n) > 0 ? normalized(n) : Vec3{0, 1, 0};
  return mesh;
}

}  // namespace

SolidMesh solid_mesh(const ColliderShape& shape) {
  return std::visit([](const auto& s) { return mesh_of(s); }, shape);
}

SolidMesh ground_mesh() {
  constexpr uint32_t kSide = 8;
  SolidMesh mesh;
  for (uint32_t z = 0; z <= kSide; ++z)
    for (uint32_t x = 0; x <= kSide; ++x) {
      mesh.position.push_back({2.F * static_cast<float>(x) / kSide - 1, 0, 2.F * static_cast<float>(z) / kSide - 1});
      mesh.normal.push_back({0, 1, 0});
    }
  for (uint32_t z = 0; z < kSide; ++z)
    for (uint32_t x = 0; x < kSide; ++x) {
      const uint32_t a = z * (kSide + 1) + x, b = a + kSide + 1;
      mesh.triangle.push_back({a, b, b + 1});
      mesh.triangle.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

Bounds collider_bounds(const Collider& collider) {
  Bounds bounds;
  for (const Vec3& p : solid_mesh(collider.shape).position) bounds.include(apply(collider.pose, p));
  return bounds;
}

}  // namespace geocloth
