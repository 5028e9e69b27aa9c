// SPDX-License-Identifier: GPL-3.0-or-later
// What simulate wrote can be rendered later: caches are read back frame by frame, and broken ones are refused.
#include "export/cache_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/sample_asset.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "support/make_sheet.h"
#include "support/temporary_folder.h"
#include "waving_cloth.h"

namespace geocloth {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

/// What a writer makes of three waving frames of a textured sheet and a tube.
class CacheReader : public testing::Test {
 protected:
  CacheReader() {
    description_.cloths = {std::make_shared<const ClothAsset>(test::sample_asset()),
                           std::make_shared<const ClothAsset>(test::make_tube({.nx = 8, .ny = 4}))};
    description_.frame_rate = 25;
    description_.frame_count = 3;
  }

  [[nodiscard]] Bytes written(const char* name, const char* result) const {
    test::write_waving(*make_cache_writer(folder_ / name, description_), description_);
    return read_file(folder_ / result);
  }

  /// Every truncation is refused; every flipped byte is refused or read without harm.
  static void break_it(const Bytes& bytes, const std::function<void(const Bytes&)>& read) {
    const std::size_t step = 1 + bytes.size() / 4000;  // some thousand are enough, and quick
    for (std::size_t size = 0; size < bytes.size(); size += step) {
      EXPECT_THROW(read(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size))), Error) << size;
    }
    for (std::size_t i = 0; i < bytes.size(); i += step) {
      Bytes flipped = bytes;
      flipped[i] ^= static_cast<std::byte>(1U << (i % 8));
      try {
        read(flipped);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }

  const test::TemporaryFolder folder_;
  CacheDescription description_;
};

TEST_F(CacheReader, AnimatedGltfComesBackFrameByFrame) {
  const Cache cache = decode_gltf_cache(written("a.glb", "a.glb"), "a.glb");
  EXPECT_NEAR(cache.frame_rate, 25, 1e-4);
  ASSERT_EQ(cache.cloths.size(), 2U);
  ASSERT_EQ(cache.frames.size(), 4U);
  const SourceMesh& source = description_.cloths[0]->source;
  const SourceMesh& mesh = cache.cloths[0];
  EXPECT_EQ(mesh.triangle.size(), source.triangle.size());
  ASSERT_EQ(mesh.part.size(), 2U);
  EXPECT_EQ(mesh.part[1].name, "right");
  EXPECT_EQ(mesh.uv.size(), mesh.position.size());
  EXPECT_EQ(mesh.normal.size(), mesh.position.size());
  ASSERT_TRUE(mesh.material[mesh.part[0].material].base_color_image.has_value());
  EXPECT_EQ(mesh.image[*mesh.material[mesh.part[0].material].base_color_image].bytes, source.image[0].bytes);
  EXPECT_TRUE(cache.cloths[1].image.empty());

  for (uint32_t frame = 0; frame < 4; ++frame) {
    const ClothSnapshot expected = test::waving_frame(*description_.cloths[0], frame);
    for (std::size_t t = 0; t < source.triangle.size(); ++t) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Vec3& is = cache.frames[frame][0][mesh.triangle[t][corner]];
        EXPECT_LT(length(is - expected.source_position[source.triangle[t][corner]]), 3e-7F);
      }
    }
  }
}

/// Faces were drawn as cut from frame 0 on, whenever the cut comes.
TEST_F(CacheReader, FacesThatCutsOpenAreThereUntilThen) {
  description_.cloths[1] = description_.cloths[0];  // of the same name
  description_.frame_count = 4;
  const ClothAsset& asset = *description_.cloths[0];
  const auto without = [&](std::size_t last) {
    ClothAsset cut = asset;
    cut.source.part.resize(1);
    cut.source.part[0].triangle_count -= static_cast<uint32_t>(last);
    cut.source.triangle.resize(cut.source.part[0].triangle_count);
    return std::make_shared<const ClothAsset>(std::move(cut));
  };
  const std::vector<std::shared_ptr<const ClothAsset>> cuts{without(1), without(3)};
  const auto writer = make_cache_writer(folder_ / "cut.glb", description_);
  for (uint32_t frame = 0; frame <= 4; ++frame) {
    std::vector<ClothSnapshot> states{test::waving_frame(asset, frame), test::waving_frame(asset, frame)};
    if (frame >= 2) states[0].asset = cuts[frame < 4 ? 0 : 1];
    if (frame >= 3) states[1].asset = cuts[0];
    writer->add(states);
  }
  writer->finish();
  writer->commit();

  const Cache cache = read_gltf_cache(folder_ / "cut.glb");
  ASSERT_EQ(cache.cloths.size(), 2U);
  ASSERT_EQ(cache.frames.size(), 5U);
  const auto faces = [&](std::size_t cloth, uint32_t frame) {
    return static_cast<std::size_t>(std::count_if(cache.open_from[cloth].begin(), cache.open_from[cloth].end(),
                                                  [&](uint32_t f) { return frame < f; }));
  };
  const std::size_t whole = asset.source.triangle.size();
  const std::size_t once = cuts[0]->source.triangle.size(), twice = cuts[1]->source.triangle.size();
  for (const std::size_t cloth : {0U, 1U}) {
    EXPECT_EQ(cache.cloths[cloth].triangle.size(), whole);
    EXPECT_EQ(faces(cloth, 0), whole);
    for (const auto& frame : cache.frames) EXPECT_EQ(frame[cloth].size(), cache.cloths[cloth].position.size());
  }
  EXPECT_EQ(faces(0, 1), once);
  EXPECT_EQ(faces(0, 2), once);
  EXPECT_EQ(faces(0, 3), twice);
  EXPECT_EQ(faces(1, 1), whole);
  EXPECT_EQ(faces(1, 2), once);
  EXPECT_EQ(faces(1, 4), once);
  break_it(read_file(folder_ / "cut.glb"), [](const Bytes& b) { static_cast<void>(decode_gltf_cache(b, "x")); });
}

/// A cut that opened faces of one material alone was taken for a cloth of its own, and the file refused.
TEST_F(CacheReader, CutsOfOneMaterialAreOfTheirCloth) {
  ClothAsset asset = test::sample_asset();
  asset.source.part[1].material = static_cast<uint32_t>(asset.source.material.size());
  asset.source.material.emplace_back().name = "lining";
  ClothAsset cut = asset;
  cut.source.part.resize(1);
  cut.source.triangle.resize(cut.source.part[0].triangle_count);
  description_.cloths[0] = std::make_shared<const ClothAsset>(asset);
  const auto after = std::make_shared<const ClothAsset>(cut);
  const auto writer = make_cache_writer(folder_ / "cut.glb", description_);
  for (uint32_t frame = 0; frame <= 3; ++frame) {
    std::vector<ClothSnapshot> states{test::waving_frame(asset, frame),
                                      test::waving_frame(*description_.cloths[1], frame)};
    if (frame >= 2) states[0].asset = after;
    writer->add(states);
  }
  writer->finish();
  writer->commit();
  const Cache cache = read_gltf_cache(folder_ / "cut.glb");
  ASSERT_EQ(cache.cloths.size(), 2U);
  EXPECT_EQ(cache.cloths[0].triangle.size(), asset.source.triangle.size());
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(cache.open_from[0], 1U)),
            asset.source.triangle.size() - cut.source.triangle.size());
}

TEST_F(CacheReader, PointCachesComeBackBitForBit) {
  for (const char* ending : {".pc2", ".mdd"}) {
    const std::string name = std::string("a") + ending, second = std::string("a_2") + ending;
    const PointCache cache = decode_point_cache(written(name.c_str(), second.c_str()), second);
    const ClothAsset& tube = *description_.cloths[1];
    ASSERT_EQ(cache.points, tube.source.source_vertex_count);
    ASSERT_EQ(cache.frames.size(), 4U);
    const ClothSnapshot expected = test::waving_frame(tube, 3, {1.2F, 0, 0});
    for (std::size_t i = 0; i < tube.source.position.size(); ++i) {
      EXPECT_EQ(cache.frames[3][tube.source.source_vertex[i]], expected.source_position[i]);
    }
  }
}

// Frames of a cut from a longer motion have the times that they had there.
TEST_F(CacheReader, AnMddMayBeginLater) {
  Bytes bytes;
  const auto append = [&](auto word) {
    auto raw = std::bit_cast<std::array<std::byte, sizeof word>>(word);
    std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  };
  append(uint32_t{3});
  append(uint32_t{1});
  for (const float time : {2.0F, 2.5F, 3.0F}) append(time);
  for (int number = 0; number < 9; ++number) append(0.0F);
  EXPECT_EQ(decode_point_cache(bytes, "x.mdd").frame_rate, 2);
  std::fill_n(bytes.begin() + 8, 3 * sizeof(float), std::byte{0});
  EXPECT_EQ(decode_point_cache(bytes, "x.mdd").frame_rate, std::nullopt) << "no times: as fast as the scene's";
}

TEST_F(CacheReader, BrokenFilesAreRefused) {
  break_it(written("a.glb", "a.glb"), [](const Bytes& b) { static_cast<void>(decode_gltf_cache(b, "x")); });
  break_it(written("a.pc2", "a_1.pc2"), [](const Bytes& b) { static_cast<void>(decode_point_cache(b, "x.pc2")); });
  break_it(written("a.mdd", "a_1.mdd"), [](const Bytes& b) { static_cast<void>(decode_point_cache(b, "x.mdd")); });
}

TEST_F(CacheReader, OtherFilesAreNamedAsSuch) {
  EXPECT_THROW(static_cast<void>(read_gltf_cache(folder_ / "missing.glb")), Error);
  EXPECT_THROW(static_cast<void>(decode_point_cache({}, "x.abc")), Error);
}

}  // namespace
}  // namespace geocloth
