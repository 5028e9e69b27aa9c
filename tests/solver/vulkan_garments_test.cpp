// SPDX-License-Identifier: GPL-3.0-or-later
// Real garments, converted at 64 x 64, fall onto a moving sphere on both backends: same place after sixty frames, seams
// closed after every substep, nothing inside the sphere, no NaN. And squares that hang, whose springs are squeezed.
#include <algorithm>
#include <filesystem>
#include <limits>

#include "geocloth/parametrize/convert.h"
#include "geocloth/solver/scene.h"
#include "geocloth/solver/solver.h"
#include "support/vulkan_test.h"

namespace geocloth {
namespace {

constexpr uint32_t kFrames = 60;
constexpr float kDiagonal = 1.5F;  ///< [m] that every garment is scaled to: the files' units are anything

struct Bounds {
  Vec3 min, max;
  [[nodiscard]] Vec3 center() const { return 0.5F * (min + max); }
};

Bounds bounds_of(const ClothAsset& asset) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Bounds b{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) continue;
    const Vec3& p = asset.rest_position[i];
    b.min = {std::min(b.min.x, p.x), std::min(b.min.y, p.y), std::min(b.min.z, p.z)};
    b.max = {std::max(b.max.x, p.x), std::max(b.max.y, p.y), std::max(b.max.z, p.z)};
  }
  return b;
}

class VulkanGarmentsTest : public test::VulkanTest, public testing::WithParamInterface<const char*> {
 protected:
  struct Outcome {
    std::vector<Vec3> positions;
    SolverStatistics statistics;
  };

  /// A sphere comes up from below the garment's middle and goes sideways.
  Outcome play(const ClothDesc& cloth, Backend backend) {
    SolverSettings settings;
    settings.backend = backend;
    settings.substeps = 8;
    settings.check_copies = true;
    Solver solver(std::span(&cloth, 1), settings);
    if (backend == Backend::vulkan) watch(solver);
    const Bounds bounds = bounds_of(*cloth.asset);
    const Vec3 center = apply(cloth.transform, bounds.center());
    const float bottom = apply(cloth.transform, bounds.min).y;
    for (uint32_t f = 0; f <= kFrames; ++f) {
      const float t = static_cast<float>(f) / 60.F;
      const Collider ball{.name = "ball",
                          .shape = Sphere{{center.x, bottom - 0.3F, center.z}, 0.2F},
                          .friction = 0.3F,
                          .pose = {.translate = {0.3F * t, 0.2F * t, 0.1F * t}}};
      solver.set_colliders(std::span(&ball, 1), f == 0);
      if (f > 0) solver.step();
    }
    Outcome outcome;
    solver.read_positions(0, outcome.positions);
    outcome.statistics = solver.statistics();
    return outcome;
  }
};

TEST_P(VulkanGarmentsTest, BackendsAgreeAndNothingBreaks) {
  const std::filesystem::path file =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR).parent_path() / "shared/meshes/garments" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  ConvertOptions options;
  options.flatten.resolution = 64;
  ConvertResult converted = convert(file, options);
  ClothDesc cloth{.asset = std::make_shared<ClothAsset>(std::move(converted.asset))};
  cloth.transform.scale = kDiagonal / static_cast<float>(converted.report.source_bbox_diagonal);

  const Outcome vulkan = play(cloth, Backend::vulkan);
  const Outcome cpu = play(cloth, Backend::cpu);

  double apart = 0;
  uint32_t non_finite = 0;
  for (uint32_t i = 0; i < cloth.asset->pixel_count(); ++i) {
    if (!is_finite(vulkan.positions[i]) || !is_finite(cpu.positions[i])) ++non_finite;
    apart = std::max(apart, double{length(vulkan.positions[i] - cpu.positions[i])});
  }
  EXPECT_EQ(non_finite, 0U);
  EXPECT_LE(apart, 1e-3 * kDiagonal);
  if (vulkan.statistics.device.find("llvmpipe") != std::string::npos) {
    EXPECT_EQ(hash_state(*cloth.asset, vulkan.positions), hash_state(*cloth.asset, cpu.positions));
  }
  EXPECT_LE(vulkan.statistics.copy_gap, 1e-6);
  EXPECT_LE(vulkan.statistics.penetration, double{cloth.material.thickness});
}

class VulkanSquareTest : public VulkanGarmentsTest {
 protected:
  std::vector<Vec3> hang(const ClothDesc& cloth, Backend backend) {
    SolverSettings settings;
    settings.backend = backend;
    settings.substeps = 16;
    Solver solver(std::span(&cloth, 1), settings);
    if (backend == Backend::vulkan) watch(solver);
    std::vector<Pin> pins;
    for (const uint32_t p : select_pixels(*cloth.asset, cloth.transform, WhereTop{0.02F}))
      pins.push_back({p, apply(cloth.transform, cloth.asset->rest_position[p])});
    solver.set_pins(0, pins);
    for (uint32_t f = 0; f < kFrames / 2; ++f) solver.step();
    std::vector<Vec3> positions;
    solver.read_positions(0, positions);
    return positions;
  }
};

// Where springs are squeezed, spans act though there is no collider: on both backends or on none.
TEST_P(VulkanSquareTest, BackendsAgreeWhereItHangs) {
  const std::filesystem::path file =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR).parent_path() / "shared/meshes/garments" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  ConvertOptions options;
  options.flatten.resolution = 48;
  options.flatten.layout = Layout::square;
  ConvertResult converted = convert(file, options);
  ClothDesc cloth{.asset = std::make_shared<ClothAsset>(std::move(converted.asset)), .material = {}, .transform = {}};
  cloth.transform.scale = kDiagonal / static_cast<float>(converted.report.source_bbox_diagonal);

  const std::vector<Vec3> vulkan = hang(cloth, Backend::vulkan), cpu = hang(cloth, Backend::cpu);
  double apart = 0;
  for (uint32_t i = 0; i < cloth.asset->pixel_count(); ++i) apart = std::max(apart, double{length(vulkan[i] - cpu[i])});
  EXPECT_LE(apart, 1e-3 * kDiagonal);
  const StretchStatistics stretch = measure_stretch(*cloth.asset, cloth.transform.scale, vulkan);
  RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
  EXPECT_LE(stretch.max, 1.2);
}

INSTANTIATE_TEST_SUITE_P(Garments, VulkanSquareTest,
                         testing::Values("codimipc_circle_skirt.obj", "diffcloth_skirt_handsup.obj"),
                         [](const auto& tested) {
                           const std::string file = tested.param;
                           return file.substr(0, file.find('.'));
                         });
INSTANTIATE_TEST_SUITE_P(Garments, VulkanGarmentsTest,
                         testing::Values("newton_unisex_shirt.obj", "mh_tee_shorts.obj", "kaykit_knight_cape.glb",
                                         "codimipc_circle_skirt.obj", "diffcloth_dress_5k.obj", "sf_sweater.glb"),
                         [](const auto& tested) {
                           const std::string file = tested.param;
                           return file.substr(0, file.find('.'));
                         });

}  // namespace
}  // namespace geocloth
