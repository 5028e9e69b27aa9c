// SPDX-License-Identifier: GPL-3.0-or-later
// Every example scene of the repository, frame by frame: no point of a cloth goes into a collider deeper than the
// cloth is thick, no number is lost, and copies stay together. The depth is measured here, from positions that were
// read back, for the points of the grid and for the vertices that are drawn. And a small one of each ends where it
// should on a Vulkan device, too.
#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "body_reader.h"
#include "contact_check.h"
#include "geocloth/solver/scene.h"
#include "scene_input.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/vulkan_test.h"

namespace geocloth::test {
namespace {

const std::string kMeshes = GEOCLOTH_SOURCE_DIR "/meshes/";

constexpr uint32_t kMostFrames = 150;

std::vector<std::string> example_scenes() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(kMeshes + "scenes")) {
    if (file.path().extension() == ".json") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The folder of an example as tools/examples.sh makes it.
Scene lay_out(const std::string& name, const TemporaryFolder& folder, const std::string& resolution) {
  Scene scene = read_scene(folder.write(name + ".json", read_text(kMeshes + "scenes/" + name + ".json")));
  std::filesystem::create_directory(folder / "meshes");
  for (const char* of : {"defects", "bodies"}) std::filesystem::copy(kMeshes + of, folder / "meshes" / of);
  std::set<std::string> assets;
  for (const SceneCloth& cloth : scene.cloths) assets.insert(cloth.asset.stem().string());
  for (const std::string& asset : assets) {
    std::string mesh = kMeshes;
    mesh.append("garments/").append(asset).append(".obj");
    const ProgramResult result =
        run_program({"convert", mesh, "-o", folder / (asset + ".glb"), "--resolution", resolution, "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
  }
  return scene;
}

/// [m] between the nodes of a field; far away outside of it.
double distance_in(const DistanceField& field, const Vec3& p) {
  const std::array<float, 3> at{(p.x - field.low.x) / field.spacing, (p.y - field.low.y) / field.spacing,
                                (p.z - field.low.z) / field.spacing};
  std::array<uint32_t, 3> node{};
  for (size_t k = 0; k < 3; ++k) {
    if (at[k] < 0 || at[k] >= static_cast<float>(field.size[k] - 1)) return 1;
    node[k] = static_cast<uint32_t>(at[k]);
  }
  double sum = 0;
  for (uint32_t corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<uint32_t, 3> n = node;
    for (size_t k = 0; k < 3; ++k) {
      const bool far = (corner >> k & 1U) != 0;
      const double share = at[k] - static_cast<float>(node[k]);
      n[k] += far ? 1 : 0;
      weight *= far ? share : 1 - share;
    }
    sum += weight * static_cast<double>(field.distance[(n[2] * field.size[1] + n[1]) * field.size[0] + n[0]]);
  }
  return sum;
}

double distance_to(const Collider& collider, const Vec3& p) {
  const auto* body = std::get_if<MeshSolid>(&collider.shape);
  if (body == nullptr) return static_cast<double>(signed_distance(collider, p));
  return distance_in(*body->field, rotate(conjugate(collider.pose.rotate), p - collider.pose.translate));
}

/// [m] of the deepest of the points, below 0 when none is inside.
double deepest(const std::vector<Vec3>& points, const std::vector<Collider>& colliders) {
  double depth = -1e9;
  for (const Collider& collider : colliders)
    for (const Vec3& p : points) depth = std::max(depth, -distance_to(collider, p));
  return depth;
}

class Example : public testing::TestWithParam<std::string> {};

TEST_P(Example, KeepsOutOfCollidersInEveryFrame) {
  const TemporaryFolder folder;
  const Scene scene = lay_out(GetParam(), folder, "64");
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.check_copies = true;
  Simulation simulation(scene, settings, body_reader());
  ContactCheck contact(simulation);
  std::vector<ClothSnapshot> cloths(simulation.cloths().size());
  double grid_depth = -1e9, drawn_depth = -1e9;
  for (uint32_t f = 0; f < std::min(scene.frames, kMostFrames); ++f) {
    simulation.step();
    for (uint32_t c = 0; c < simulation.cloths().size(); ++c) {
      const ClothDesc& cloth = simulation.cloths()[c];
      auto& [asset, position, normal, drawn] = cloths[c];
      asset = cloth.asset;
      simulation.solver().read_positions(c, position);
      simulation.solver().read_normals(c, normal);
      evaluate_binding(*asset, position, normal, drawn, cloth.transform.scale);
      std::vector<Vec3> points;
      for (uint32_t p = 0; p < position.size(); ++p)
        if (cloth.asset->valid(p)) points.push_back(position[p]);
      ASSERT_TRUE(std::all_of(points.begin(), points.end(), is_finite)) << "frame " << f;
      const std::vector<Collider> colliders = simulation.colliders();
      grid_depth = std::max(grid_depth, deepest(points, colliders));
      drawn_depth = std::max(drawn_depth, deepest(drawn, colliders));
      ASSERT_LE(grid_depth, 1e-4) << "frame " << f;
      ASSERT_LE(drawn_depth, static_cast<double>(cloth.material.thickness)) << "frame " << f;
    }
    contact.add_frame(simulation, cloths);
  }
  EXPECT_THAT(contact.warnings(simulation), testing::IsEmpty());
  RecordProperty("grid_depth_m", std::to_string(grid_depth));
  RecordProperty("drawn_depth_m", std::to_string(drawn_depth));
  const SolverStatistics statistics = simulation.solver().statistics();
  EXPECT_EQ(statistics.copy_gap, 0.0);
  EXPECT_LE(statistics.penetration, 1e-4);
}

TEST(Examples, ThePatternIsSewnShut) {
  const TemporaryFolder folder;
  const Scene scene = lay_out("dress_pattern", folder, "48");
  SolverSettings settings;
  settings.backend = Backend::cpu;
  Simulation simulation(scene, settings, body_reader());
  const ClothAsset& dress = *simulation.cloths()[0].asset;
  EXPECT_GT(dress.sewing.size(), 100U);
  for (int f = 0; f < 120; ++f) simulation.step();
  std::vector<Vec3> position;
  simulation.solver().read_positions(0, position);
  for (const auto& [a, b] : dress.sewing) EXPECT_LT(length(position[b] - position[a]), 2e-3F) << a << " and " << b;
  EXPECT_LT(measure_stretch(dress, 1, position).mean, 1.01);
}

class SmallExample : public VulkanTest, public testing::WithParamInterface<std::string> {
 protected:
  static void SetUpTestSuite() {
    VulkanTest::SetUpTestSuite();
    keep_software_to_one_thread();
  }

  /// Positions of all cloths after a second.
  std::vector<std::vector<Vec3>> play(const Scene& scene, Backend backend) {
    SolverSettings settings;
    settings.backend = backend;
    Simulation simulation(scene, settings, body_reader());
    if (backend == Backend::vulkan) watch(simulation.solver());
    for (uint32_t f = 0; f < static_cast<uint32_t>(scene.frame_rate); ++f) simulation.step();
    std::vector<std::vector<Vec3>> positions(scene.cloths.size());
    for (uint32_t c = 0; c < positions.size(); ++c) simulation.solver().read_positions(c, positions[c]);
    cloths_ = simulation.cloths();
    return positions;
  }
  /// [m] diagonal of a cloth's box at rest.
  [[nodiscard]] double size(size_t c) const {
    const ClothAsset& asset = *cloths_[c].asset;
    Vec3 low{1e9F, 1e9F, 1e9F}, high{-1e9F, -1e9F, -1e9F};
    for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
      if (!asset.valid(p)) continue;
      const Vec3& at = asset.rest_position[p];
      low = {std::min(low.x, at.x), std::min(low.y, at.y), std::min(low.z, at.z)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y), std::max(high.z, at.z)};
    }
    return static_cast<double>(cloths_[c].transform.scale * length(high - low));
  }

 private:
  std::vector<ClothDesc> cloths_;
};

TEST_P(SmallExample, IsOnVulkanWhereItIsOnTheCpuAfterASecond) {
  const TemporaryFolder folder;
  const Scene scene = lay_out(GetParam(), folder, "24");
  const auto cpu = play(scene, Backend::cpu), vulkan = play(scene, Backend::vulkan);
  const double tolerance = scene.colliders.empty() ? 1e-4 : 1e-3;  // of the size, without contact and with
  for (size_t c = 0; c < cpu.size(); ++c) {
    double farthest = 0;
    for (size_t p = 0; p < cpu[c].size(); ++p)
      farthest = std::max(farthest, static_cast<double>(length(cpu[c][p] - vulkan[c][p])));
    EXPECT_LE(farthest, tolerance * size(c)) << "cloth " << c;
    RecordProperty("farthest_m", std::to_string(farthest));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SmallExample, testing::ValuesIn(example_scenes()),
                         [](const auto& scene) { return scene.param; });

INSTANTIATE_TEST_SUITE_P(Scenes, Example, testing::ValuesIn(example_scenes()),
                         [](const auto& scene) { return scene.param; });

}  // namespace
}  // namespace geocloth::test
