// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that deform: an animated character carries its clothes as a rigid one does, and they stay outside of it.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "geocloth/solver/solid.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

constexpr float kFrame = 1.F / 60;   ///< [s]
constexpr float kNodes = 0.015F;     ///< [m] between nodes
constexpr float kThickness = 0.002F;  ///< [m]

/// A ball of triangles about the origin, as long along x as `stretch` says.
TriangleSurface ball_surface(float radius, float stretch = 1) {
  constexpr uint32_t kAround = 40, kAlong = 21;
  TriangleSurface surface;
  for (uint32_t j = 0; j < kAlong; ++j) {
    for (uint32_t i = 0; i < kAround; ++i) {
      const double u = 2 * std::numbers::pi * i / kAround, v = std::numbers::pi * j / (kAlong - 1);
      surface.position.push_back({stretch * radius * static_cast<float>(std::sin(v) * std::cos(u)),
                                  radius * static_cast<float>(std::cos(v)),
                                  radius * static_cast<float>(std::sin(v) * std::sin(u))});
    }
  }
  for (uint32_t j = 0; j + 1 < kAlong; ++j) {
    for (uint32_t i = 0; i < kAround; ++i) {
      const uint32_t a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      surface.triangle.push_back({a, b, a + kAround});
      surface.triangle.push_back({b, b + kAround, a + kAround});
    }
  }
  return surface;
}

/// Where a point of a body is after some frames.
using Way = std::function<Vec3(const Vec3& p, float frames)>;

TriangleSurface moved(TriangleSurface surface, const Way& way, float frames) {
  for (Vec3& p : surface.position) p = way(p, frames);
  return surface;
}

Collider solid(DistanceField field) {
  return {"body", MeshSolid{std::make_shared<const DistanceField>(std::move(field))}, 0.5F, {}};
}

Collider deformed(const TriangleSurface& rest, const Way& way, int frame) {
  const auto f = static_cast<float>(frame);
  return solid(make_deforming_field(moved(rest, way, f), moved(rest, way, f - 1).position, kNodes));
}

class Deforming : public test::MachineTest<> {
 protected:
  [[nodiscard]] int points() const { return machine().slow() ? 15 : 33; }
  [[nodiscard]] Solver sheet_above(float height) {
    const auto n = static_cast<uint32_t>(points());
    Material material;
    material.friction = 0.5F;
    material.thickness = kThickness;
    SolverSettings settings;
    settings.substeps = 8;
    settings.check_copies = true;
    return make(test::describe(test::make_sheet({.nx = n, .ny = n, .width = 0.6F, .height = 0.6F, .horizontal = true,
                                                 .center = {0, height, 0}}),
                               material),
                settings);
  }
};

Transform rolled(float frames) {
  return {{0.4F * kFrame * frames, 0.1F * kFrame * frames, 0}, quat_from_euler_deg({0, 0.8F * frames, 0.5F * frames}), 1};
}

TEST_P(Deforming, WhoseVerticesAllGoAlikeCarriesAsOneThatIsMoved) {
  const int frames = machine().slow() ? 12 : 45;
  const TriangleSurface rest = ball_surface(0.15F);
  const Way way = [](const Vec3& p, float f) { return apply(rolled(f), p); };
  Solver rigid = sheet_above(0.155F), bent = sheet_above(0.155F);
  Collider body = solid(make_deforming_field(rest, rest.position, kNodes));
  rigid.set_colliders(std::vector{body}, true);
  bent.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  for (int f = 1; f <= frames; ++f) {
    body.pose = rolled(static_cast<float>(f));
    rigid.set_colliders(std::vector{body});
    bent.set_colliders(std::vector{deformed(rest, way, f)});
    rigid.step();
    bent.step();
    EXPECT_LE(bent.statistics().penetration, 0.5F * kThickness) << f;
  }
  const std::vector<Vec3> a = test::positions_of(rigid), b = test::positions_of(bent);
  double mean = 0, apart = 0;
  Vec3 ca, cb;
  for (size_t p = 0; p < a.size(); ++p) {
    const auto off = static_cast<double>(length(a[p] - b[p]));
    mean += off / static_cast<double>(a.size());
    apart = std::max(apart, off);
    ca += (1.F/static_cast<float>(a.size())) * a[p]; cb += (1.F/static_cast<float>(a.size())) * b[p];
  }
  std::printf("%g %g %g  / %g %g %g\n", ca.x,ca.y,ca.z,cb.x,cb.y,cb.z); std::printf("mean %g max %g pen %g %g\n", mean, apart, rigid.statistics().penetration, bent.statistics().penetration);
  EXPECT_LT(apart, 0.03);
}

TEST_P(Deforming, ThatSwellsPushesClothOut) {
  const int frames = machine().slow() ? 12 : 40;
  const TriangleSurface rest = ball_surface(0.1F);
  const Way way = [](const Vec3& p, float f) { return (1 + 0.03F * f) * p; };  // 18 cm/s
  Solver solver = sheet_above(0.11F);
  solver.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  for (int f = 1; f <= frames; ++f) {
    solver.set_colliders(std::vector{deformed(rest, way, f)});
    solver.step();
    EXPECT_LE(solver.statistics().penetration, 0.5F * kThickness) << f;
  }
  float highest = 0;
  for (const Vec3& p : test::positions_of(solver)) highest = std::max(highest, p.y);
  const float radius = 0.1F * (1 + 0.03F * static_cast<float>(frames));
  EXPECT_NEAR(highest, radius, 0.01F);
}

INSTANTIATE_TEST_SUITE_P(On, Deforming, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
