// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbours are found in vectors, and not by the hash of the plain path: which points push must not depend on that,
// where cloth is crowded, crushed, scattered, lost or as small as a vector either.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "geocloth/asset/grid_mesh.h"
#include "solver_fixture.h"
#include "support/vector_targets.h"

namespace geocloth::test {
namespace {

/// A number from -1 to 1 for each pixel and axis.
float scattered(uint32_t pixel, uint32_t axis) {
  const uint32_t h = (pixel * 3 + axis + 1) * 2654435761U;
  return static_cast<float>(h >> 8U) / static_cast<float>(1U << 23U) - 1;
}

/// Where a cloth is put before it is played, from where it starts. Copies are put where the first of them is.
struct Placing {
  const char* name;
  uint32_t points;  ///< along a side
  Vec3 (*place)(uint32_t pixel, const Vec3& start);
};

const std::vector<Placing>& placings() {
  static const std::vector<Placing> all{
      {"folded", 33,
       [](uint32_t, const Vec3& p) {  // twice, 4 mm apart
         return Vec3{std::abs(p.x), p.y, p.z + (p.x < 0 ? 0.004F : 0.F)};
       }},
      {"crowded", 33,  // more neighbours than are kept, fuller cells than are looked into
       [](uint32_t pixel, const Vec3&) {
         return Vec3{0.04F * scattered(pixel, 0), 0.2F + 0.04F * scattered(pixel, 1), 0.04F * scattered(pixel, 2)};
       }},
      {"dense", 33,
       [](uint32_t pixel, const Vec3&) {
         return Vec3{0.1F * scattered(pixel, 0), 0.2F + 0.1F * scattered(pixel, 1), 0.1F * scattered(pixel, 2)};
       }},
      {"crushed", 20,
       [](uint32_t, const Vec3&) {
         return Vec3{0, 0.1F, 0};
       }},
      {"lost", 20,  // a part of it, beyond where anything collides
       [](uint32_t pixel, const Vec3& p) {
         return pixel % 5 == 0 ? Vec3{2e5F, p.y, p.z} : p;
       }},
      {"scattered", 20,  // over more cells than can be counted
       [](uint32_t pixel, const Vec3&) {
         return Vec3{9e4F * scattered(pixel, 0), 9e4F * scattered(pixel, 1), 9e4F * scattered(pixel, 2)};
       }},
      {"small", 3,
       [](uint32_t, const Vec3& p) {
         return Vec3{std::abs(p.x), p.y, p.z};
       }},
      {"tiny", 4,
       [](uint32_t, const Vec3& p) {
         return Vec3{std::abs(p.x), p.y, p.z};
       }},
  };
  return all;
}

/// One cloth that collides with itself, or three with each other.
uint64_t hash_after(const Placing& placing, bool between, SolverPath path, uint32_t threads) {
  const auto describe_one = [&](float x) {
    ClothDesc cloth = describe(make_sheet({.nx = placing.points,
                                           .ny = placing.points,
                                           .width = 0.4F,
                                           .height = 0.4F,
                                           .charts_x = placing.points > 9 ? 2U : 1U,
                                           .center = {0, 0.25F, 0}}));
    cloth.transform.translate.x = x;
    between ? void(cloth.inter_collision = InterCollision{}) : void(cloth.self_collision = SelfCollision{});
    return cloth;
  };
  std::vector<ClothDesc> cloths{describe_one(0)};
  if (between) cloths.insert(cloths.end(), {describe_one(0.003F), describe_one(0.05F)});
  SolverSettings settings = cpu_settings();
  settings.path = path;
  settings.threads = threads;
  settings.substeps = 4;
  Solver solver(cloths, settings);
  uint64_t hash = 0;
  for (uint32_t c = 0; c < cloths.size(); ++c) {
    std::vector<Vec3> positions = positions_of(solver, c);
    const std::vector<Vec3> start = positions;
    const std::vector<uint32_t> first = first_copies(*cloths[c].asset);
    for (uint32_t p = 0; p < positions.size(); ++p) positions[p] = placing.place(first[p] + 7 * c, start[p]);
    solver.write_state(c, positions, std::vector<Vec3>(positions.size()));
  }
  run(solver, 3);
  for (uint32_t c = 0; c < cloths.size(); ++c) hash = hash * 31 + hash_state(*cloths[c].asset, positions_of(solver, c));
  return hash;
}

using SelfVectors = OnVectorTarget;

TEST_P(SelfVectors, FindTheNeighboursOfThePlainPath) {
  for (const Placing& placing : placings()) {
    for (const bool between : {false, true}) {
      const uint64_t plain = hash_after(placing, between, SolverPath::plain, 1);
      for (const uint32_t threads : {1U, 3U}) {
        EXPECT_EQ(hash_after(placing, between, SolverPath::automatic, threads), plain)
            << placing.name << (between ? ", between cloths, " : ", ") << threads << " threads";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(On, SelfVectors, testing::ValuesIn(vector_targets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace geocloth::test
