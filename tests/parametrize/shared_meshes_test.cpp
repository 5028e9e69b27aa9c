// SPDX-License-Identifier: GPL-3.0-or-later
// Every mesh of the shared collection through repair, cut, square layout and image: garments and hostile shapes (genus
// 133, 106 holes, a Moebius strip, thousands of tied edges) keep their topology and have no flipped triangle.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/repair.h"
#include "geocloth/parametrize/seams.h"

namespace geocloth {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kResolution = 48;
#ifdef NDEBUG
constexpr uintmax_t kLargestFile = 5'000'000;  // [bytes]
#else
constexpr uintmax_t kLargestFile = 500'000;
#endif

const fs::path kMeshes = fs::path(GEOCLOTH_SOURCE_DIR) / ".." / "shared" / "meshes";

std::vector<std::string> mesh_names() {
  std::vector<std::string> names;
  for (const char* folder : {"garments", "irregular", "bodies"}) {
    if (!fs::is_directory(kMeshes / folder)) continue;
    for (const auto& entry : fs::directory_iterator(kMeshes / folder)) {
      if (entry.path().extension() == ".bin") continue;
      names.push_back(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

class SharedMesh : public ::testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SharedMesh);

TEST_P(SharedMesh, GridIsTheMesh) {
  const fs::path path = kMeshes / GetParam();
  if (fs::file_size(path) > kLargestFile) GTEST_SKIP() << "too large for this build";
  const RepairResult repaired = repair_mesh(import_mesh(path));
  const CutSurface cut = cut_to_disks(repaired.surface);
  const FlatSurface flat = flatten(repaired.surface, cut, {.layout = Layout::square, .resolution = kResolution});
  const auto flipped = std::count_if(flat.triangle.begin(), flat.triangle.end(), [&](const Triangle& t) {
    const Point2 &a = flat.uv[t[0]], &b = flat.uv[t[1]], &c = flat.uv[t[2]];
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) >= 0;  // v runs down
  });
  EXPECT_EQ(flipped, 0);

  const ClothAsset asset = build_image(flat, rasterize(flat), Layout::square);
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  const Topology welded = measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
  EXPECT_EQ(welded.components, repaired.cleaned.components);
  EXPECT_EQ(welded.boundary_loops, repaired.cleaned.boundary_loops);
  EXPECT_EQ(welded.euler_characteristic, repaired.cleaned.euler_characteristic);
  EXPECT_EQ(welded.orientable, repaired.cleaned.orientable);
}

INSTANTIATE_TEST_SUITE_P(All, SharedMesh, ::testing::ValuesIn(mesh_names()), [](const auto& test) {
  std::string name = test.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace geocloth
