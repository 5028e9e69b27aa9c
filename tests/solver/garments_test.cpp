// SPDX-License-Identifier: GPL-3.0-or-later
// How far garments stretch that hang by their highest 2 % for two seconds, with 16 substeps. Counted are the springs of
// what is held: parts of a file that no pin holds fall, fold in the air and say nothing of how cloth hangs. And whether
// garments come to rest: what trembles is seen before all else.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/solver/scene.h"
#include "geocloth/solver/solver.h"
#include "rest/upload.h"
#include "support/temporary_folder.h"

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

Hung hang(const std::filesystem::path& file, Layout layout = Layout::panels, uint32_t resolution = 64) {
  ConvertOptions options;
  options.flatten.resolution = resolution;
  options.flatten.layout = layout;
  ConvertResult converted = convert(file, options);
  ClothDesc cloth{.asset = std::make_shared<ClothAsset>(std::move(converted.asset))};
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

/// Such a file may be absent.
std::filesystem::path shared_garment(const char* file) {
  return std::filesystem::path(GEOCLOTH_SOURCE_DIR).parent_path() / "shared/meshes/garments" / file;
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

// Fine cloth passes less of a pull on in a substep, and at a seam it ended: shoulders were stretched by 9.8 %, and the
// sweatshirt of the other file by 14.8 %, before a frame's end went through the lines a second time.
TEST(Fine, HangsBySeamsWithLittleStretch) {
  const Hung hung =
      hang(std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes/garments/t_shirt.obj", Layout::panels, 128);
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  EXPECT_LE(hung.stretch.max, 1.075);
  EXPECT_LE(hung.stretch.mean, 1.003);
}

class SharedSet : public testing::TestWithParam<const char*> {};
TEST_P(SharedSet, HangsWithLittleStretch) {
  const std::filesystem::path file = shared_garment(GetParam());
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

// At its back, beside a seam, one spring carried more than its neighbours: 18 %, and 14 where only short springs at
// seams were tied by their whole points.
TEST(SharedFine, DrapedDressHangsWithLittleStretch) {
  const std::filesystem::path file = shared_garment("codimipc_dress_draped.obj");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Hung hung = hang(file, Layout::panels, 128);
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  EXPECT_LE(hung.stretch.max, 1.11);
  EXPECT_LE(hung.stretch.mean, 1.01);
}

/// A skirt from a round waist, a little aslant, down to a hem of waves.
void write_waved_skirt(const std::filesystem::path& file) {
  constexpr int kAround = 96, kDown = 30;
  constexpr double kPi = 3.14159265358979, kWaist = 0.14, kHem = 0.4, kLength = 0.6, kWave = 0.08, kSlant = 0.05;
  std::ofstream out(file);
  for (int j = 0; j <= kDown; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * kPi * i / kAround, down = static_cast<double>(j) / kDown;
      const double radius = kWaist + (kHem - kWaist) * down + kWave * down * std::sin(7 * angle);
      const double x = radius * std::cos(angle);
      out << "v " << x << ' ' << kSlant * x - kLength * down << ' ' << radius * std::sin(angle) << '\n';
    }
  }
  for (int j = 0; j < kDown; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const int a = j * kAround + i + 1, b = j * kAround + (i + 1) % kAround + 1;
      out << "f " << a << ' ' << a + kAround << ' ' << b << '\n';
      out << "f " << b << ' ' << a + kAround << ' ' << b + kAround << '\n';
    }
  }
}

// A square squeezes the waist: many springs there are much shorter than others and carry the whole of the skirt.
// Without spans they were stretched by 16 %, by 28 % in the circle skirt and by 53 % in the skirt of the other file.
TEST(Square, HangsWithLittleStretchWhereItIsSqueezed) {
  const test::TemporaryFolder folder;
  write_waved_skirt(folder / "skirt.obj");
  const Hung hung = hang(folder / "skirt.obj", Layout::square);
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  EXPECT_LE(hung.stretch.max, 1.12);
  EXPECT_LE(hung.stretch.p99, 1.06);
  EXPECT_LE(hung.stretch.mean, 1.01);
}
class SharedSquare : public testing::TestWithParam<const char*> {};
TEST_P(SharedSquare, HangsWithLittleStretch) {
  const std::filesystem::path file = shared_garment(GetParam());
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const Hung hung = hang(file, Layout::square);
  RecordProperty("max_percent", std::to_string(100 * (hung.stretch.max - 1)));
  EXPECT_LE(hung.stretch.max, 1.2);
  EXPECT_LE(hung.stretch.mean, 1.01);
}
INSTANTIATE_TEST_SUITE_P(Garments, SharedSquare,
                         testing::Values("codimipc_circle_skirt.obj", "diffcloth_skirt_handsup.obj"),
                         [](const auto& tested) { return name_of(tested.param); });

/// How points move otherwise than evenly from frame to frame: second differences of their positions [m].
struct Trembling {
  double root_mean_square = 0;
  double of_99 = 0;  ///< what 99 of 100 points do not exceed
};

Trembling trembling_of(const Scene& scene, uint32_t frames) {
  constexpr uint32_t kWatched = 20;
  SolverSettings settings;
  settings.backend = Backend::cpu;
  Simulation simulation(scene, settings);
  std::vector<std::vector<Vec3>> seen(kWatched + 2);
  for (uint32_t f = 0; f < frames; ++f) {
    simulation.step();
    if (f + seen.size() >= frames) simulation.solver().read_positions(0, seen[f + seen.size() - frames]);
  }
  const std::shared_ptr<const ClothAsset> asset = simulation.solver().asset(0);
  std::vector<double> squares;
  double sum = 0;
  for (size_t f = 1; f + 1 < seen.size(); ++f) {
    for (uint32_t p = 0; p < asset->pixel_count(); ++p) {
      if (!asset->valid(p)) continue;
      const auto second = static_cast<double>(length(seen[f + 1][p] - seen[f][p] - (seen[f][p] - seen[f - 1][p])));
      squares.push_back(second * second);
      sum += second * second;
    }
  }
  const auto at_99 = squares.begin() + static_cast<ptrdiff_t>(squares.size() * 99 / 100);
  std::nth_element(squares.begin(), at_99, squares.end());
  return {std::sqrt(sum / static_cast<double>(squares.size())), std::sqrt(*at_99)};
}

/// An example's scene without its wind.
class Settled : public testing::Test {
 protected:
  [[nodiscard]] Scene scene_of(const std::string& name) const {
    const std::filesystem::path meshes = std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes";
    write_asset(convert(meshes / "garments" / (name + ".obj"), {}).asset, folder_ / (name + ".glb"));
    Scene scene = parse_scene(test::read_text(meshes / "scenes" / (name + ".json")), folder_.path() / (name + ".json"));
    scene.wind = {};
    return scene;
  }

  static constexpr uint32_t kSevenSeconds = 420;
  test::TemporaryFolder folder_;
};

// Where lines pulled bent rows straight along the directions that they had before, zigzags at side seams and shoulders
// flipped over in every frame: 0.08 to 0.1 mm, and at one point in a hundred 0.36 to 0.44 mm.
TEST_F(Settled, AWornDressIsStill) {
  const Trembling dress = trembling_of(scene_of("dress"), kSevenSeconds);
  RecordProperty("root_mean_square_um", std::to_string(1e6 * dress.root_mean_square));
  RecordProperty("of_99_um", std::to_string(1e6 * dress.of_99));
  EXPECT_LE(dress.root_mean_square, 5e-5);
  EXPECT_LE(dress.of_99, 2e-4);
}

// What hangs from shoulders pulls at the few points that lie there: with spans of one length only, springs round them
// were stretched by 22 % and one in a hundred by 7 %.
TEST_F(Settled, AWornDressIsHeldByItsShoulders) {
  const Scene scene = scene_of("dress");
  SolverSettings settings;
  settings.backend = Backend::cpu;
  Simulation simulation(scene, settings);
  for (uint32_t f = 0; f < kSevenSeconds; ++f) simulation.step();
  std::vector<Vec3> positions;
  simulation.solver().read_positions(0, positions);
  const StretchStatistics dress = measure_stretch(*simulation.solver().asset(0), 1, positions);
  RecordProperty("max_percent", std::to_string(100 * (dress.max - 1)));
  RecordProperty("p99_percent", std::to_string(100 * (dress.p99 - 1)));
  EXPECT_LE(dress.max, 1.15);
  EXPECT_LE(dress.p99, 1.05);
}

}  // namespace
}  // namespace geocloth
