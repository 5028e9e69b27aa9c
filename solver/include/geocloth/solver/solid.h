// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/asset/vec.h"

namespace geocloth {

/// Where cloth may be: the side of the plane that the normal points to.
struct Plane {
  Vec3 point = {};       ///< [m]
  Vec3 normal{0, 1, 0};  ///< unit length; cloth stays on this side
  bool operator==(const Plane&) const = default;
};

/// Triangles of a surface, counter-clockwise from outside.
struct TriangleSurface {
  std::vector<Vec3> position;                     ///< [m]
  std::vector<std::array<uint32_t, 3>> triangle;  ///< into position
  bool operator==(const TriangleSurface&) const = default;
};

/// The solid behind all of its planes, at most kMostConvexPlanes.
struct Convex {
  std::vector<Plane> planes;
  TriangleSurface surface;  ///< its corners and faces, to be drawn; empty where the planes do not close
  bool operator==(const Convex&) const = default;
};
/// Every point of the cloth looks at each plane.
inline constexpr size_t kMostConvexPlanes = 1024;
/// Planes that convex_of_planes() takes: to find the corners it tries all threes of them.
inline constexpr size_t kMostJoinedPlanes = 64;

/// The convex hull of points, any number; those inside cost little. @throws Error(invalid_argument) when one is not
/// finite, when they lie in one plane, or when the hull has more than kMostConvexPlanes faces
[[nodiscard]] Convex convex_hull(std::span<const Vec3> points);
/// The solid behind planes, 1 to kMostJoinedPlanes. @throws Error(invalid_argument) for more, when a normal is not of
/// unit length, or when nothing lies behind all of them
[[nodiscard]] Convex convex_of_planes(std::span<const Plane> planes);

/// Signed distance to the surface of a body, negative inside, at the nodes of a regular grid that holds it with room
/// around; linear in between. Not to be changed once a solver has it. A body that deforms is another field in every
/// frame, as it is at the frame's end.
struct DistanceField {
  std::array<uint32_t, 3> size{};  ///< nodes along x, y, z; >= 2
  Vec3 low;                        ///< [m] of the first node; no node is farther out than 1e6 along an axis
  float spacing = 0;               ///< [m] >= 1e-9
  float margin = 0;                ///< [m] >= 0; no surface is nearer to the grid's sides
  std::vector<float> distance;     ///< [m] one for each node, within +-4e6; x fastest, then y
  /// [m] One for each node, or none where the body keeps its shape: how far the point of the surface that is nearest to
  /// the node went in the frame.
  std::vector<Vec3> way = {};
  TriangleSurface surface;  ///< that was sampled; the solver does not look at it
};
/// Inside is where the surface winds around (generalised winding number), so holes, overlaps and several parts are
/// fine.
/// @param nodes  about how many, up to kMostFieldNodes; the spacing follows
/// @throws Error(invalid_argument) when an index is out of range, the surface encloses nothing, or for more nodes
[[nodiscard]] DistanceField make_distance_field(TriangleSurface surface, uint32_t nodes = 500'000);
/// [m] Between the nodes of a field, above 0.
struct FieldSpacing {
  float metres;
};
/// The same with a spacing, at multiples of which the nodes lie.
/// @throws Error(invalid_argument) also where the grid would have more than kMostFieldNodes nodes
[[nodiscard]] DistanceField make_distance_field(TriangleSurface surface, FieldSpacing spacing);

/// The field of a body that deforms.
/// @param surface  at the end of a frame
/// @param before   where its points were at the beginning; as many
/// @param spacing  [m] between nodes, the same in all frames
/// @throws Error(invalid_argument) as make_distance_field, where `before` does not fit, or where the grid would have
///   more than kMostFieldNodes nodes
[[nodiscard]] DistanceField make_deforming_field(TriangleSurface surface, std::span<const Vec3> before, float spacing);
inline constexpr size_t kMostFieldNodes = 64'000'000;

}  // namespace geocloth
