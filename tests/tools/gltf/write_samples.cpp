// SPDX-License-Identifier: GPL-3.0-or-later
// Writes one .glb of every kind that geocloth writes into a folder, for the checks beside this file.
#include <cstdio>
#include <filesystem>

#include "asset/sample_asset.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "support/make_sheet.h"
#include "tools/waving_cloth.h"

namespace {

using namespace geocloth;

void write_animation(const std::filesystem::path& path, std::vector<std::shared_ptr<const ClothAsset>> cloths,
                     uint32_t frames) {
  const CacheDescription description{std::move(cloths), 60, frames};
  test::write_waving(*make_cache_writer(path, description), description);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  write_asset(test::sample_asset(), folder / "asset.glb");
  write_asset(test::make_sheet({.nx = 2, .ny = 2}), folder / "asset_smallest.glb");
  write_asset(test::make_sheet({.nx = 300, .ny = 250, .charts_x = 3}), folder / "asset_large.glb");
  const auto sample = std::make_shared<const ClothAsset>(test::sample_asset());
  const auto sheet = std::make_shared<const ClothAsset>(test::make_sheet({.nx = 40, .ny = 40, .charts_x = 2}));
  const auto tube = std::make_shared<const ClothAsset>(test::make_tube({.nx = 24, .ny = 16}));
  write_animation(folder / "animated.glb", {sheet}, 30);
  write_animation(folder / "animated_several.glb", {sample, tube, sheet}, 12);
  write_animation(folder / "animated_still.glb", {sample}, 0);
  return 0;
} catch (const geocloth::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
