// SPDX-License-Identifier: GPL-3.0-or-later
// How far garments stretch that hang by their highest 2 % for two seconds, with 16 substeps. Counted are the springs of
// what is held: parts of a file that no pin holds fall, fold in the air and say nothing of how cloth hangs.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/parametrize/convert.h"
#include "geocloth/solver/scene.h"
#include "geocloth/solver/solver.h"
#include "rest/upload.h"

namespace geocloth {
namespace {

constexpr uint32_t kTwoSeconds = 120;
constexpr float kDiagonal = 1.5F;  ///< [m] that every garment is scaled to: the files' units are anything

/// The asset with the springs of what is not held taken out, to measure the others.
ClothAsset held_part(const ClothAsset& asset, const std::vector<uint32_t>& pinned) {
  std::vector<bool> held(asset.pixel_count());
  for (const uint32_t p : pinned) held[p] = true;
  const std::vector<shader::Attachment> attachments = make_attachments(asset, 1, pinned);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) held[p] = held[p] || attachments[p].anchor != shader::kNoAnchor;
  ClothAsset part = asset;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (!held[p]) part.spring_mask[p] = 0;
  return part;
}

struct Hung {
  StretchStatistics stretch;
  double share_held = 0;  ///< of the pixels
};

Hung hang(const std::filesystem::path& file) {
  ConvertOptions options;
  options.flatten.resolution = 64;
  ConvertResult converted = convert(file, options);
  ClothDesc cloth{.asset = std::make_shared<ClothAsset>(std::move(converted.asset)), .material = {}, .transform = {}};
  cloth.transform.scale = kDiagonal / static_cast<float>(converted.report.source_bbox_diagonal);
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.substeps = 16;
  Solver solver({&cloth, 1}, settings);
  const std::vector<uint32_t> pixels = select_pixels(*cloth.asset, cloth.transform, WhereTop{0.02F});
  std::vector<Pin> pins;
  pins.reserve(pixels.size());
  for (const uint32_t p : pixels) pins.push_back({p, apply(cloth.transform, cloth.asset->rest_position[p])});
  solver.set_pins(0, pins);
  for (uint32_t f = 0; f < kTwoSeconds; ++f) solver.step();
  std::vector<Vec3> positions;
  solver.read_positions(0, positions);
  const ClothAsset part = held_part(*cloth.asset, pixels);
  Hung hung{.stretch = measure_stretch(part, cloth.transform.scale, positions)};
  double all = 0, held = 0;
  for (uint32_t p = 0; p < part.pixel_count(); ++p) {
    all += cloth.asset->spring_mask[p] != 0 ? 1 : 0;
    held += part.spring_mask[p] != 0 ? 1 : 0;
  }
  hung.share_held = held / all;
  return hung;
}

std::string name_of(const std::string& file) {
  return file.substr(0, file.find('.'));
}

/// The poncho lies level: all of it is its highest 2 %.
class Own : public testing::TestWithParam<const char*> {};
TEST_P(Own, HangsWithLittleStretch) {
  const Hung hung = hang(std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes/garments" / GetParam());
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  RecordProperty("mean_percent", std::to_string(100 * (hung.stretch.mean - 1)));
  EXPECT_LE(hung.stretch.max, 1.15);
  EXPECT_LE(hung.stretch.mean, 1.01);
  EXPECT_GT(hung.share_held, 0.99);
}
INSTANTIATE_TEST_SUITE_P(Garments, Own,
                         testing::Values("cape.obj", "dress.obj", "flag.obj", "skirt.obj", "sleeve.obj", "t_shirt.obj"),
                         [](const auto& tested) { return name_of(tested.param); });

class SharedSet : public testing::TestWithParam<const char*> {};
TEST_P(SharedSet, HangsWithLittleStretch) {
  const std::filesystem::path file =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR).parent_path() / "shared/meshes/garments" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Hung hung = hang(file);
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  RecordProperty("mean_percent", std::to_string(100 * (hung.stretch.mean - 1)));
  RecordProperty("share_held", std::to_string(hung.share_held));
  EXPECT_LE(hung.stretch.max, 1.15);
  EXPECT_LE(hung.stretch.mean, 1.01);
}
INSTANTIATE_TEST_SUITE_P(Garments, SharedSet,
                         testing::Values("diffcloth_sock.obj", "raylib_greenman_hat.glb", "mh_tights.obj",
                                         "newton_unisex_shirt.obj", "diffcloth_dress_5k.obj",
                                         "codimipc_circle_skirt.obj", "mh_skirt_tube.obj", "sf_boxer_briefs.glb",
                                         "codimipc_dress_draped.obj", "kaykit_mage_hat.gltf"),
                         [](const auto& tested) { return name_of(tested.param); });

}  // namespace
}  // namespace geocloth
