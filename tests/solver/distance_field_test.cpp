// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of triangles as grids of distances, against every triangle's distance from every node.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "colliders/closest.h"
#include "colliders/nearest_nodes.h"
#include "geocloth/asset/error.h"
#include "geocloth/solver/collider.h"
#include "geocloth/solver/solid.h"
#include "support/ball_surface.h"
#include "support/vector_targets.h"

namespace geocloth {
namespace {

constexpr float kRing = 0.3F, kTube = 0.12F;  ///< [m] radii of a torus
constexpr uint32_t kNodes = 20'000;

/// A torus about an axis that no row of nodes follows.
/// @param rings  of 64 that are there, one after another: fewer leave it open at two flat ends
TriangleSurface torus(uint32_t rings = 64) {
  constexpr uint32_t kAround = 64, kAlong = 24;
  const Quat turn = quat_from_euler_deg({20, 35, 10});
  TriangleSurface surface;
  for (uint32_t i = 0; i < kAround; ++i) {
    for (uint32_t j = 0; j < kAlong; ++j) {
      const float u = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kAround;
      const float v = 2 * std::numbers::pi_v<float> * static_cast<float>(j) / kAlong;
      const float r = kRing + kTube * std::cos(v);
      surface.position.push_back(rotate(turn, {r * std::cos(u), kTube * std::sin(v), -r * std::sin(u)}));
    }
  }
  for (uint32_t i = 0; i < rings; ++i) {
    for (uint32_t j = 0; j < kAlong; ++j) {
      const auto at = [&](uint32_t a, uint32_t b) { return a % kAround * kAlong + b % kAlong; };
      surface.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      surface.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return surface;
}

/// The same with corners of its own for every triangle.
TriangleSurface taken_apart(const TriangleSurface& surface, const std::function<Vec3(const Vec3&)>& change) {
  TriangleSurface apart;
  for (const auto& t : surface.triangle) {
    const auto first = static_cast<uint32_t>(apart.position.size());
    for (const uint32_t i : t) apart.position.push_back(change(surface.position[i]));
    apart.triangle.push_back({first, first + 1, first + 2});
  }
  return apart;
}

void add(TriangleSurface& surface, const TriangleSurface& other) {
  const auto first = static_cast<uint32_t>(surface.position.size());
  surface.position.insert(surface.position.end(), other.position.begin(), other.position.end());
  for (const auto& t : other.triangle) surface.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void for_nodes(const DistanceField& field, const std::function<void(size_t node, const Vec3& place)>& body) {
  size_t node = 0;
  for (uint32_t z = 0; z < field.size[2]; ++z) {
    for (uint32_t y = 0; y < field.size[1]; ++y) {
      for (uint32_t x = 0; x < field.size[0]; ++x) {
        const Vec3 steps{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        body(node++, field.low + field.spacing * steps);
      }
    }
  }
}

double distance_to(const TriangleSurface& surface, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : surface.triangle) {
    const TriangleCorners corners = corners_of(t, surface.position);
    least = std::min(least, length(to_double(p) - closest_on_triangle(corners, to_double(p))));
  }
  return least;
}

// A cell that the surface goes through with one distance that is too large is a dent that cloth sinks into.
TEST(DistanceField, IsThatToTheNearestTriangle) {
  const DistanceField field = make_distance_field(torus(), kNodes);
  const double h = field.spacing;
  for_nodes(field, [&](size_t node, const Vec3& p) {
    const double near = distance_to(field.surface, p), d = std::abs(field.distance[node]);
    EXPECT_GE(d, near - 1e-6);
    EXPECT_LE(d, near + (near < 1.74 * h ? 1e-6 : 0.2 * h)) << near / h << " spacings away";
  });
}

TEST(DistanceField, IsNegativeInsideAndNowhereElse) {
  const DistanceField field = make_distance_field(torus(), kNodes);
  const Quat back = conjugate(quat_from_euler_deg({20, 35, 10}));
  for_nodes(field, [&](size_t node, const Vec3& p) {
    const Vec3 q = rotate(back, p);
    const double out = std::hypot(std::hypot(q.x, q.z) - kRing, q.y) - kTube;
    if (std::abs(out) > 0.003) {
      EXPECT_EQ(field.distance[node] < 0, out < 0) << out;
    }
  });
}

// Files have corners twice where colours or textures meet.
TEST(DistanceField, DoesNotDependOnWhichTrianglesShareCorners) {
  const DistanceField field = make_distance_field(torus(), kNodes);
  const DistanceField apart = make_distance_field(taken_apart(torus(), [](const Vec3& p) { return p; }), kNodes);
  EXPECT_EQ(field.distance, apart.distance);
}

TEST(DistanceField, OfASoupWhoseCornersNearlyMeetIsTheBodys) {
  const DistanceField field = make_distance_field(torus(), kNodes);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> off(-0.05F * field.spacing, 0.05F * field.spacing);
  TriangleSurface soup = taken_apart(torus(), [&](const Vec3& p) {
    return p + Vec3{off(random), off(random), off(random)};
  });
  const DistanceField apart = make_distance_field(soup, kNodes);
  const MeshSolid solid{std::make_shared<const DistanceField>(apart)};
  for_nodes(field, [&](size_t node, const Vec3& p) {
    const float d = field.distance[node];
    if (std::abs(d) > field.spacing) {
      EXPECT_NEAR(signed_distance({"", solid, 0, {}}, p), d, 0.4 * field.spacing);
    }
  });
}

// A body that ends where the file was cut, as at neck and wrists, is closed there.
TEST(DistanceField, IsClosedFlatOverAHole) {
  const DistanceField field = make_distance_field(torus(48), kNodes);
  const Quat back = conjugate(quat_from_euler_deg({20, 35, 10}));
  for_nodes(field, [&](size_t node, const Vec3& p) {
    const Vec3 q = rotate(back, p);
    const double out = std::hypot(std::hypot(q.x, q.z) - kRing, q.y) - kTube;
    const bool missing = q.x > 0 && q.z > 0;  // the last quarter of a turn
    if (std::abs(out) < 0.003 || std::min(std::abs(q.x), std::abs(q.z)) < 1e-4) return;
    EXPECT_EQ(field.distance[node] < 0, out < 0 && !missing) << q.x << ' ' << q.y << ' ' << q.z;
  });
}

// Corners on one line have no normal, and what is divided by its length was not a number.
TEST(DistanceField, TrianglesWithoutAnAreaChangeNothing) {
  const TriangleSurface whole = torus();
  TriangleSurface with = whole;
  for (uint32_t i = 0; i < 40; ++i) with.triangle.push_back({i, i, i + 1});
  for (uint32_t i = 0; i < 40; ++i) with.triangle.push_back({i, i, i});
  with.position.push_back(0.5F * (whole.position[0] + whole.position[1]));
  const auto middle = static_cast<uint32_t>(whole.position.size());
  with.triangle.push_back({0, middle, 1});
  with.triangle.push_back({1, middle, 0});
  const DistanceField a = make_distance_field(whole, kNodes), b = make_distance_field(with, kNodes);
  ASSERT_EQ(a.distance.size(), b.distance.size());
  for (size_t k = 0; k < a.distance.size(); ++k) ASSERT_NEAR(a.distance[k], b.distance[k], 1e-5) << k;
}

TEST(DistanceField, ASurfaceTurnedInwardsIsACavity) {
  TriangleSurface hollow = test::ball_surface({}, 0.4F);
  TriangleSurface inner = test::ball_surface({}, 0.2F);
  for (auto& t : inner.triangle) std::swap(t[1], t[2]);
  add(hollow, inner);
  const MeshSolid solid{std::make_shared<const DistanceField>(make_distance_field(hollow, kNodes))};
  const auto distance = [&](const Vec3& p) { return signed_distance({"", solid, 0, {}}, p); };
  EXPECT_GT(distance({0, 0, 0}), 0.1);
  EXPECT_LT(distance({0.3F, 0, 0}), -0.07);
  EXPECT_GT(distance({0.5F, 0, 0}), 0.08);
}

TriangleSurface box(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (const float x : {low.x, high.x})
    for (const float y : {low.y, high.y})
      for (const float z : {low.z, high.z}) corners.push_back({x, y, z});
  return convex_hull(corners).surface;
}

/// A scene says how fine a field is to be: a board beside something large would not be there.
TEST(DistanceField, WithASpacingShowsWhatIsAsThickAsThat) {
  TriangleSurface body = test::ball_surface({0, -1, 0}, 0.5F);
  add(body, box({-0.5F, 0.5275F, -0.5F}, {0.5F, 0.5475F, 0.5F}));
  const auto at = [](const DistanceField& field, const Vec3& p) {
    return signed_distance({"", MeshSolid{std::make_shared<const DistanceField>(field)}, 0, {}}, p);
  };
  const DistanceField fine = make_distance_field(body, FieldSpacing{0.0125F});
  EXPECT_EQ(fine.spacing, 0.0125F);
  for (const Vec3& p : {Vec3{0, 0.5375F, 0}, Vec3{0.3F, 0.5375F, -0.2F}, Vec3{0.4711F, 0.5375F, 0.123F}})
    EXPECT_NEAR(at(fine, p), -0.01, 0.003);
  EXPECT_NEAR(at(fine, {0.1F, 0.6375F, 0}), 0.09, 0.003);
  const DistanceField coarse = make_distance_field(body, FieldSpacing{0.1F});
  EXPECT_GT(at(coarse, {0.3F, 0.5375F, -0.2F}), 0) << "it shows anyway: the test shows nothing";
  for (const float bad : {0.F, -1.F, std::nanf("")})
    EXPECT_THROW(static_cast<void>(make_distance_field(body, FieldSpacing{bad})), Error) << bad;
  try {
    static_cast<void>(make_distance_field(body, FieldSpacing{1e-5F}));
    FAIL() << "a grid of 2e15 nodes was made";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("m is about the least for it"), std::string::npos) << error.what();
  }
}

// Large triangles lie in many columns of the grid.
TEST(DistanceField, PiecesOfAFewLargeTrianglesMayGoIntoOneAnother) {
  TriangleSurface body = box({-1, -1, -1}, {1, 1, 1});
  add(body, box({-0.5F, -0.5F, -0.5F}, {2, 0.5F, 0.5F}));
  const MeshSolid solid{std::make_shared<const DistanceField>(make_distance_field(body, 100'000))};
  const auto distance = [&](const Vec3& p) { return signed_distance({"", solid, 0, {}}, p); };
  EXPECT_LT(distance({-0.45F, 0, 0}), -0.45);  // not 5 cm from the end that is inside
  EXPECT_NEAR(distance({1.7F, 0, 0}), -0.3, 0.02);
}

TEST(DeformingField, IsTheBodysNearItAndNoFartherThanThatElsewhere) {
  const TriangleSurface body = torus();
  const DistanceField whole = make_distance_field(body, kNodes);
  const DistanceField near = make_deforming_field(body, body.position, whole.spacing);
  const MeshSolid solid{std::make_shared<const DistanceField>(near)};
  for_nodes(near, [&](size_t node, const Vec3& p) {
    const double d = distance_to(body, p), is = near.distance[node], h = near.spacing;
    EXPECT_LE(std::abs(is), d + 0.2 * h);
    if (is < 0 || d < 4 * h) {
      EXPECT_GE(std::abs(is), d - 1e-6);
    }
    if (d >= 4 * h && is > 0) {
      EXPECT_GE(is, 4 * h - 1e-6);
    }
  });
}

// Where an arm was at the frame's beginning, beyond the nodes that are measured, cloth has to be taken along, too.
TEST(DeformingField, HasWaysEverywhere) {
  const TriangleSurface body = torus();
  const Vec3 way{0.02F, -0.01F, 0.03F};
  std::vector<Vec3> before = body.position;
  for (Vec3& p : before) p = p - way;
  const DistanceField field = make_deforming_field(body, before, 0.01F);
  ASSERT_EQ(field.way.size(), field.distance.size());
  EXPECT_TRUE(std::ranges::any_of(field.distance, [&](float d) { return d == 4 * field.spacing; }));
  for (const Vec3& w : field.way) ASSERT_NEAR(length(w - way), 0, 1e-6);
}

TEST(DistanceField, OfABallOfTrianglesIsTheBalls) {
  const DistanceField field = make_distance_field(test::ball_surface({0, 0, 0}, 0.3F), 100'000);
  const Collider body{"", MeshSolid{std::make_shared<const DistanceField>(field)}, 0, {}};
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0.25F, 0, 0}, Vec3{0.1F, -0.2F, 0.15F}, Vec3{0.2F, 0.2F, 0.2F}})
    EXPECT_NEAR(signed_distance(body, p), length(p) - 0.3, p == Vec3{} ? field.spacing : 0.004);
  EXPECT_GT(signed_distance(body, {2, 0, 0}), 1.5);
  EXPECT_LE(signed_distance(body, {2, 0, 0}), 1.7 + 1e-5);
}

TEST(DistanceField, HolesAndOverlapsDoNotTurnItInsideOut) {
  TriangleSurface two = test::ball_surface({0, 0, 0}, 0.3F);
  two.triangle.resize(two.triangle.size() - 48 * 2 * 3);  // the southern cap is missing
  const TriangleSurface other = test::ball_surface({0.2F, 0, 0}, 0.25F);
  const auto first = static_cast<uint32_t>(two.position.size());
  two.position.insert(two.position.end(), other.position.begin(), other.position.end());
  for (const auto& t : other.triangle) two.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
  const Collider body{"", MeshSolid{std::make_shared<const DistanceField>(make_distance_field(two, 60'000))}, 0, {}};
  EXPECT_LT(signed_distance(body, {-0.2F, 0, 0}), -0.03);
  EXPECT_LT(signed_distance(body, {0.1F, 0, 0}), -0.05);  // in both
  EXPECT_GT(signed_distance(body, {0, -0.4F, 0}), 0.05);
  EXPECT_GT(signed_distance(body, {0, 0.4F, 0}), 0.05);
}

/// Pushed to the end of an arm that is inside the trunk, cloth stayed in there for good.
TEST(DistanceField, IsMeasuredToTheOutsideOfPiecesThatGoIntoOneAnother) {
  TriangleSurface body = test::ball_surface({0, 0, 0}, 2);
  for (const TriangleSurface& piece : {test::ball_surface({2, 0, 0}, 0.5F), test::ball_surface({0, 1, 0}, 0.3F)}) {
    const auto first = static_cast<uint32_t>(body.position.size());
    body.position.insert(body.position.end(), piece.position.begin(), piece.position.end());
    for (const auto& t : piece.triangle) body.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const MeshSolid solid{std::make_shared<const DistanceField>(make_distance_field(body, 60'000))};
  const auto distance = [&](const Vec3& p) { return signed_distance({"", solid, 0, {}}, p); };
  EXPECT_NEAR(distance({0.3F, 1, 0}), std::hypot(0.3, 1) - 2, 0.02);  // on the ball that is all inside
  EXPECT_NEAR(distance({0, 0.7F, 0}), -1.3, 0.02);
  EXPECT_LT(distance({1.5F, 0, 0}), -0.4);          // on the half of the other that is
  EXPECT_NEAR(distance({2.4F, 0, 0}), -0.1, 0.02);  // below the half that is not
}

TEST(DistanceField, WhatEnclosesNothingIsRefused) {
  EXPECT_THROW(static_cast<void>(make_distance_field({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, 1000)), Error);
  EXPECT_THROW(static_cast<void>(make_distance_field({{{0, 0, 0}}, {{0, 1, 2}}}, 1000)), Error);
  EXPECT_THROW(static_cast<void>(make_distance_field({}, 1000)), Error);
}

// A count that came from a unit mixed up took all memory, and the program with it.
TEST(DistanceField, OfMoreNodesThanAreAllowedIsRefused) {
  for (const size_t nodes : {kMostFieldNodes + 1, size_t{4'000'000'000}}) {
    try {
      static_cast<void>(make_distance_field(box({-1, -1, -1}, {1, 1, 1}), static_cast<uint32_t>(nodes)));
      FAIL() << "a field of " << nodes << " nodes was made";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("it may have 64000000"), std::string::npos) << error.what();
    }
  }
}

// A replay on another machine would part from the first one where a body touches the cloth.
using Field = test::OnVectorTarget;
TEST_P(Field, HasTheSameBitsWithEveryInstructionSet) {
  const TriangleSurface body = torus(48);
  std::vector<Vec3> before = body.position;
  for (Vec3& p : before) p = 0.99F * p;
  const DistanceField own = make_deforming_field(body, before, 0.02F);
  hwy::SetSupportedTargetsForTest(0);  // the best one
  const DistanceField best = make_deforming_field(body, before, 0.02F);
  EXPECT_EQ(own.distance, best.distance);
  EXPECT_EQ(own.way, best.way);
}
TEST_P(Field, OfFewNodesInARowFindsTheNearestTriangle) {
  const NodeGrid grid{{5, 9, 9}, {0, 0, 0}, 1};  // fewer than are measured at once
  const std::vector<TriangleCorners> triangles{{{2, 3, 3}, {3, 5.5, 4}, {2, 4, 6}},
                                               {{1, 2, 7}, {1, 7, 7}, {4, 4, 6.5}}};
  const NearestPoints near = nearest_points(grid, triangles, std::vector<char>(grid.count()), 20);
  for (uint32_t node = 0; node < grid.count(); ++node) {
    const Vec3d p = grid.place(node % 5, node / 5 % 9, node / 45);
    const auto distance = [&](const TriangleCorners& t) { return length(p - closest_on_triangle(t, p)); };
    ASSERT_LT(near.triangle[node], 2);
    EXPECT_NEAR(length(near.off[node]), distance(triangles[near.triangle[node]]), 1e-5);
    EXPECT_NEAR(length(near.off[node]), std::min(distance(triangles[0]), distance(triangles[1])), 0.2);
  }
}
INSTANTIATE_TEST_SUITE_P(Every, Field, testing::ValuesIn(test::vector_targets()),
                         [](const auto& run) { return std::string(hwy::TargetName(run.param)); });

}  // namespace
}  // namespace geocloth
