// SPDX-License-Identifier: GPL-3.0-or-later
// What a user takes into Blender or an engine: every format holds every frame exactly, under its documented header.
#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/sample_asset.h"
#include "export/cache_writer.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"
#include "support/make_sheet.h"
#include "support/temporary_folder.h"
#include "waving_cloth.h"

namespace geocloth {
namespace {

namespace fs = std::filesystem;
using test::waving_frame;
using test::write_waving;

ClothAsset undivided() {
  ClothAsset asset = test::sample_asset();
  asset.source.middle.clear();
  return asset;
}

std::shared_ptr<const ClothAsset> sample() {
  return std::make_shared<const ClothAsset>(undivided());
}

class CacheWriters : public testing::Test {
 protected:
  void write(const char* name, const CacheDescription& description) {
    const auto writer = make_cache_writer(folder_ / name, description);
    ASSERT_NE(writer, nullptr);
    write_waving(*writer, description);
  }
  [[nodiscard]] std::vector<std::byte> bytes(const char* name) const { return read_file(folder_ / name); }

  const test::TemporaryFolder folder_;
};

template <class T>
T value_at(const std::vector<std::byte>& bytes, std::size_t at, bool big_endian = false) {
  std::array<std::byte, sizeof(T)> word{};
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), word.begin());
  if (big_endian) std::reverse(word.begin(), word.end());
  return std::bit_cast<T>(word);
}

Vec3 vec3_at(const std::vector<std::byte>& bytes, std::size_t at, bool big_endian = false) {
  return {value_at<float>(bytes, at, big_endian), value_at<float>(bytes, at + 4, big_endian),
          value_at<float>(bytes, at + 8, big_endian)};
}

TEST_F(CacheWriters, AnUnknownEndingIsNoFormat) {
  EXPECT_EQ(make_cache_writer(folder_ / "a.xyz", CacheDescription{{sample()}}), nullptr);
  EXPECT_NE(make_cache_writer(folder_ / "a.GLB", CacheDescription{{sample()}}), nullptr);
}

TEST_F(CacheWriters, NothingStandsBeforeCommitOrAfterAFailure) {
  for (const char* name : {"a.glb", "a.usda", "a.obj", "a.pc2", "a.mdd", "a.exr"}) {
    const CacheDescription description{{sample()}, 60, 2};
    const auto writer = make_cache_writer(folder_ / name, description);
    const ClothSnapshot frame = waving_frame(*description.cloths[0], 0);
    for (int i = 0; i < 3; ++i) writer->add(std::span(&frame, 1));
    writer->finish();
    for (const std::string& file : folder_.entries()) EXPECT_THAT(file, testing::StartsWith(".geocloth-")) << name;
  }
  EXPECT_THAT(folder_.entries(), testing::IsEmpty());
}

TEST_F(CacheWriters, Pc2HoldsEveryFrameInFileOrder) {
  const CacheDescription description{{sample()}, 60, 3};
  const ClothAsset& asset = *description.cloths[0];
  write("a.pc2", description);
  const auto data = bytes("a.pc2");
  const std::size_t points = asset.source.source_vertex_count;
  ASSERT_EQ(data.size(), 32 + 4 * points * 12);
  EXPECT_EQ(std::memcmp(data.data(), "POINTCACHE2\0", 12), 0);
  EXPECT_EQ(value_at<int32_t>(data, 12), 1);
  EXPECT_EQ(value_at<uint32_t>(data, 16), points);
  EXPECT_EQ(value_at<float>(data, 20), 0);
  EXPECT_EQ(value_at<float>(data, 24), 1);
  EXPECT_EQ(value_at<int32_t>(data, 28), 4);
  for (uint32_t frame = 0; frame < 4; ++frame) {
    const ClothSnapshot expected = waving_frame(asset, frame);
    for (std::size_t i = 0; i < asset.source.position.size(); ++i) {
      const std::size_t point = asset.source.source_vertex[i];
      EXPECT_EQ(vec3_at(data, 32 + (frame * points + point) * 12), expected.source_position[i]);
    }
  }
}

// A modelling program lays a cache on one object, and not on what the file has besides.
TEST_F(CacheWriters, EachPartHasACacheOfItsVerticesAlone) {
  ClothAsset asset = undivided();
  const auto half = static_cast<uint32_t>(asset.source.triangle.size() / 2);
  const auto rest = static_cast<uint32_t>(asset.source.triangle.size()) - half;
  asset.source.part = {{"left sleeve", 0, 0, half}, {"left/sleeve", 0, half, rest}};
  asset.vertex_groups = {{"left sleeve", {5, 2, 9}}};  // which is more than what its triangles have, or less
  const CacheDescription description{{std::make_shared<const ClothAsset>(asset)}, 60, 1, true};
  for (const char* name : {"a.pc2", "a.mdd"}) write(name, description);
  EXPECT_THAT(folder_.entries(), testing::UnorderedElementsAre("a_left_sleeve.mdd", "a_left_sleeve.pc2",
                                                               "a_left_sleeve_2.mdd", "a_left_sleeve_2.pc2"));
  const std::vector<fs::path> names = output_names(folder_ / "a.mdd", description);
  EXPECT_THAT(names, testing::ElementsAre(folder_ / "a_left_sleeve.mdd", folder_ / "a_left_sleeve_2.mdd"));

  const std::array<uint32_t, 2> first_of_part{0, half};
  for (std::size_t part = 0; part < 2; ++part) {
    std::set<uint32_t> vertices;
    for (uint32_t t = 0; t < (part == 0 ? half : rest); ++t) {
      for (const uint32_t v : asset.source.triangle[first_of_part[part] + t])
        vertices.insert(asset.source.source_vertex[v]);
    }
    if (part == 0) vertices.insert({2, 5, 9});
    const auto data = bytes(part == 0 ? "a_left_sleeve.pc2" : "a_left_sleeve_2.pc2");
    const std::size_t points = vertices.size();
    ASSERT_LT(points, asset.source.source_vertex_count);
    ASSERT_EQ(data.size(), 32 + 2 * points * 12);
    EXPECT_EQ(value_at<uint32_t>(data, 16), points);
    const std::vector<Vec3> moved = waving_frame(asset, 1).source_position;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const auto place = vertices.find(asset.source.source_vertex[i]);
      if (place == vertices.end()) continue;
      const auto point = static_cast<std::size_t>(std::distance(vertices.begin(), place));
      EXPECT_EQ(vec3_at(data, 32 + (points + point) * 12), moved[i]);
    }
  }
}

// Where triangles were divided for the simulation, the mesh of the modelling program has not been.
TEST_F(CacheWriters, PointCachesLeaveOutVerticesThatWereAdded) {
  const ClothAsset asset = test::sample_asset();
  ASSERT_EQ(asset.source.middle.size(), 2U);
  const uint32_t points = asset.source.source_vertex_count - 2;
  for (const bool each_part : {false, true}) {
    const CacheDescription description{{std::make_shared<const ClothAsset>(asset)}, 60, 0, each_part};
    for (const char* name : {"a.pc2", "a.mdd"}) write(name, description);
    const std::string stem = output_names(folder_ / "a.pc2", description)[0].stem().string();
    EXPECT_LE(value_at<uint32_t>(bytes((stem + ".pc2").c_str()), 16), points);
    EXPECT_EQ(value_at<uint32_t>(bytes((stem + ".mdd").c_str()), 4, true),
              value_at<uint32_t>(bytes((stem + ".pc2").c_str()), 16));
  }
  EXPECT_EQ(value_at<uint32_t>(bytes("a.pc2"), 16), points);
}

TEST_F(CacheWriters, MddIsBigEndianWithTimes) {
  const CacheDescription description{{sample()}, 25, 3};
  const ClothAsset& asset = *description.cloths[0];
  write("a.mdd", description);
  const auto data = bytes("a.mdd");
  const std::size_t points = asset.source.source_vertex_count;
  ASSERT_EQ(data.size(), 8 + 4 * 4 + 4 * points * 12);
  EXPECT_EQ(value_at<int32_t>(data, 0, true), 4);
  EXPECT_EQ(value_at<uint32_t>(data, 4, true), points);
  for (uint32_t frame = 0; frame < 4; ++frame) {
    EXPECT_EQ(value_at<float>(data, 8 + 4 * frame, true), static_cast<float>(frame / 25.0));
    const ClothSnapshot expected = waving_frame(asset, frame);
    const std::size_t point = asset.source.source_vertex[5];
    EXPECT_EQ(vec3_at(data, 24 + (frame * points + point) * 12, true), expected.source_position[5]);
  }
}

TEST_F(CacheWriters, SeveralClothsAreSeveralPointCaches) {
  write("a.pc2", {{sample(), sample()}, 60, 1});
  write("b.mdd", {{sample(), sample()}, 60, 1});
  EXPECT_THAT(folder_.entries(), testing::ElementsAre("a_1.pc2", "a_2.pc2", "b_1.mdd", "b_2.mdd"));
  EXPECT_NE(bytes("a_1.pc2"), bytes("a_2.pc2"));
}

TEST_F(CacheWriters, ObjSeriesIsTheSourceMeshWelded) {
  const CacheDescription description{{sample(), sample()}, 60, 2};
  const ClothAsset& asset = *description.cloths[0];
  write("a.obj", description);
  ASSERT_THAT(folder_.entries(), testing::ElementsAre("a_0001.obj", "a_0002.obj"));
  const auto data = bytes("a_0002.obj");
  std::istringstream text(std::string(reinterpret_cast<const char*>(data.data()), data.size()));
  std::vector<Vec3> points;
  std::size_t objects = 0, faces = 0, uvs = 0, largest = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      Vec3& p = points.emplace_back();
      words >> p.x >> p.y >> p.z;
    } else if (keyword == "f") {
      ++faces;
      std::size_t index = 0;
      words >> index;
      largest = std::max(largest, index);
    }
    objects += keyword == "o" ? 1U : 0U;
    uvs += keyword == "vt" ? 1U : 0U;
  }
  EXPECT_EQ(objects, 2U);
  EXPECT_EQ(faces, 2 * asset.source.triangle.size());
  EXPECT_EQ(uvs, 2 * asset.source.uv.size());
  ASSERT_EQ(points.size(), 2 * asset.source.source_vertex_count);
  EXPECT_LE(largest, points.size());
  EXPECT_GT(largest, points.size() / 2) << "the second object counts on";
  const ClothSnapshot expected = waving_frame(asset, 2, {1.2F, 0, 0});
  const std::size_t second = asset.source.source_vertex_count;
  EXPECT_EQ(points[second + asset.source.source_vertex[7]], expected.source_position[7]);
}

/// What stands between a declaration, from a place in the text on, and the bracket that closes its value.
std::string usd_value(const std::string& text, const std::string& declaration, std::size_t from) {
  const std::size_t found = text.find(declaration + " = ", from);
  if (found == std::string::npos) return {};
  const std::size_t begin = found + declaration.size() + 3;
  std::size_t end = begin;
  for (int open = 0; end < text.size(); ++end) {
    if (text[end] == '[' || text[end] == '{') ++open;
    if ((text[end] == ']' || text[end] == '}') && --open == 0) break;
  }
  return text.substr(begin, end + 1 - begin);
}

/// All numbers of a text.
std::vector<float> usd_numbers(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::strchr("[](),{}", c) != nullptr; }, ' ');
  std::istringstream words(text);
  std::vector<float> numbers;
  for (float number = 0; words >> number;) numbers.push_back(number);
  EXPECT_TRUE(words.eof()) << text;
  return numbers;
}

/// The samples of an attribute, by frame.
std::map<int, std::vector<float>> usd_samples(const std::string& text, const std::string& declaration,
                                              std::size_t from) {
  std::istringstream lines(usd_value(text, declaration + ".timeSamples", from));
  std::map<int, std::vector<float>> samples;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) samples[std::stoi(line)] = usd_numbers(line.substr(colon + 2));
  }
  return samples;
}

void expect_vectors(const std::vector<float>& numbers, const std::vector<Vec3>& expected) {
  ASSERT_EQ(numbers.size(), 3 * expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_EQ((Vec3{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]}), expected[i]) << i;
}

TEST_F(CacheWriters, UsdIsTheSourceMeshWeldedWithEveryFrame) {
  const CacheDescription description{{sample(), sample()}, 24, 3};
  const ClothAsset& asset = *description.cloths[0];
  const SourceMesh& source = asset.source;
  write("a.usda", description);
  const std::string text = test::read_text(folder_ / "a.usda");
  EXPECT_THAT(text, testing::StartsWith("#usda 1.0\n(\n"));
  for (const char* line : {"    endTimeCode = 3\n", "    timeCodesPerSecond = 24\n", "    upAxis = \"Y\"\n",
                           "    metersPerUnit = 1\n", "    defaultPrim = \"World\"\n", "\ndef Xform \"World\"\n{\n"})
    EXPECT_THAT(text, testing::HasSubstr(line));
  for (const char* pair : {"()", "[]", "{}"})
    EXPECT_EQ(std::ranges::count(text, pair[0]), std::ranges::count(text, pair[1])) << pair;

  std::size_t from = text.find("def Mesh \"sample___\"");
  for (std::size_t cloth = 0; cloth < 2; ++cloth) {
    ASSERT_NE(from, std::string::npos);
    const auto points = usd_samples(text, "point3f[] points", from);
    const auto normals = usd_samples(text, "normal3f[] primvars:normals", from);
    ASSERT_EQ(points.size(), 4U);
    const std::vector<Vec3> bound = bind_normals(asset);
    for (uint32_t frame = 0; frame <= 3; ++frame) {
      const ClothSnapshot state = waving_frame(asset, frame, {1.2F * static_cast<float>(cloth), 0, 0});
      std::vector<Vec3> expected(source.source_vertex_count), expected_normals;
      for (std::size_t v = 0; v < source.source_vertex.size(); ++v)
        expected[source.source_vertex[v]] = state.source_position[v];
      expect_vectors(points.at(static_cast<int>(frame)), expected);
      evaluate_bound_normals(asset, bound, state.position, state.normal, expected_normals);
      expect_vectors(normals.at(static_cast<int>(frame)), expected_normals);
      const std::vector<float> extent = usd_samples(text, "float3[] extent", from).at(static_cast<int>(frame));
      ASSERT_EQ(extent.size(), 6U);
      for (const Vec3& p : expected) {
        EXPECT_TRUE(p.x >= extent[0] && p.y >= extent[1] && p.z >= extent[2]);
        EXPECT_TRUE(p.x <= extent[3] && p.y <= extent[4] && p.z <= extent[5]);
      }
    }
    std::vector<float> corners, render_corners, uv;
    for (const Triangle& t : source.triangle) {
      for (const uint32_t v : t) {
        corners.push_back(static_cast<float>(source.source_vertex[v]));
        render_corners.push_back(static_cast<float>(v));
      }
    }
    for (const Vec2& p : source.uv) uv.insert(uv.end(), {p.x, 1 - p.y});  // v up
    const auto numbers = [&](const char* declaration) { return usd_numbers(usd_value(text, declaration, from)); };
    EXPECT_EQ(numbers("int[] faceVertexCounts"), std::vector<float>(source.triangle.size(), 3));
    EXPECT_EQ(numbers("int[] faceVertexIndices"), corners);
    EXPECT_EQ(numbers("int[] primvars:normals:indices"), render_corners);
    EXPECT_EQ(numbers("int[] primvars:st:indices"), render_corners);
    EXPECT_EQ(numbers("texCoord2f[] primvars:st"), uv);
    // Each face is of one part, and the parts have their materials.
    std::vector<float> faces = numbers("int[] indices");
    const std::size_t right = text.find("def GeomSubset \"right\"", from);
    const std::vector<float> others = usd_numbers(usd_value(text, "int[] indices", right));
    EXPECT_EQ(faces.size(), source.part[0].triangle_count);
    faces.insert(faces.end(), others.begin(), others.end());
    std::vector<float> all(source.triangle.size());
    std::iota(all.begin(), all.end(), 0.F);
    EXPECT_EQ(faces, all);
    const std::string path = cloth == 0 ? "</World/sample___/" : "</World/sample____2/";
    EXPECT_EQ(text.find("rel material:binding = " + path + "back>", right), text.find("rel material", right));
    from = text.find("def Mesh \"sample____2\"", from);
  }
  EXPECT_THAT(text, testing::HasSubstr("color3f inputs:diffuseColor = (0.1, 0.2, 0.3)"));
}

// USD takes letters, digits and _ for names, and no name twice.
TEST_F(CacheWriters, UsdNamesAreIdentifiers) {
  ClothAsset asset = test::sample_asset();
  asset.name = "3 \"Kleid\"\n";
  asset.source.part[0].name = asset.source.part[1].name = "\xC3\xA4";
  asset.source.material[0].name.clear();
  const auto cloth = std::make_shared<const ClothAsset>(asset);
  write("a.usda", {{cloth}, 60, 1});
  const std::string text = test::read_text(folder_ / "a.usda");
  for (const char* name : {"def Mesh \"_3__Kleid__\" (", "def GeomSubset \"__\" (", "def GeomSubset \"___2\" (",
                           "def Material \"material\"\n"})
    EXPECT_THAT(text, testing::HasSubstr(name));
}

TEST_F(CacheWriters, ARunWithoutFramesStillGivesAFile) {
  write("a.obj", {{sample()}, 60, 0});
  write("a.glb", {{sample()}, 60, 0});
  write("a.usda", {{sample()}, 60, 0});
  EXPECT_THAT(folder_.entries(), testing::ElementsAre("a.glb", "a.usda", "a_0000.obj"));
  EXPECT_EQ(usd_samples(test::read_text(folder_ / "a.usda"), "point3f[] points", 0).size(), 1U);
}

TEST_F(CacheWriters, ExrHoldsTheGridBitForBit) {
  const CacheDescription description{{sample()}, 60, 2};
  const ClothAsset& asset = *description.cloths[0];
  write("a.exr", description);
  ASSERT_THAT(folder_.entries(), testing::ElementsAre("a_0001.exr", "a_0002.exr"));
  Imf::InputFile file((folder_ / "a_0002.exr").c_str());
  const auto width = static_cast<std::size_t>(asset.width);
  struct Pixel {
    float r = -1, g = -1, b = -1, a = -1;
  };
  std::vector<Pixel> pixels(asset.pixel_count());
  Imf::FrameBuffer buffer;
  const auto slice = [&](float Pixel::*member) {
    char* base = reinterpret_cast<char*>(&(pixels.front().*member));
    return Imf::Slice(Imf::FLOAT, base, sizeof(Pixel), sizeof(Pixel) * width);
  };
  buffer.insert("R", slice(&Pixel::r));
  buffer.insert("G", slice(&Pixel::g));
  buffer.insert("B", slice(&Pixel::b));
  buffer.insert("A", slice(&Pixel::a));
  file.setFrameBuffer(buffer);
  ASSERT_EQ(file.header().dataWindow().max.x + 1, static_cast<int>(asset.width));
  file.readPixels(0, static_cast<int>(asset.height) - 1);
  const ClothSnapshot expected = waving_frame(asset, 2);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    EXPECT_EQ((Vec3{pixels[i].r, pixels[i].g, pixels[i].b}), expected.position[i]);
    EXPECT_EQ(pixels[i].a, asset.valid(i) ? 1.0F : 0.0F);
  }
}

/// The vectors of an accessor.
std::vector<Vec3> vec3_accessor(const glb::Container& file, const glb::Json& index) {
  const auto& accessor = file.json["accessors"][index.get<std::size_t>()];
  const auto& view = file.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::size_t offset = view["byteOffset"].get<std::size_t>() + accessor["byteOffset"].get<std::size_t>();
  std::vector<Vec3> values(accessor["count"].get<std::size_t>());
  std::memcpy(values.data(), file.binary.data() + offset, values.size() * sizeof(Vec3));
  return values;
}

TEST_F(CacheWriters, AnimatedGltfGivesBackEveryFrame) {
  const CacheDescription description{{sample(), sample()}, 30, 4};
  const ClothAsset& asset = *description.cloths[0];
  write("a.glb", description);
  const auto data = bytes("a.glb");
  const glb::Container file = glb::parse(data, "a.glb");
  ASSERT_EQ(file.json["nodes"].size(), 2U);
  ASSERT_EQ(file.json["animations"][0]["channels"].size(), 2U);
  EXPECT_EQ(file.json["materials"].size(), 2 * asset.source.material.size());
  EXPECT_EQ(file.json["images"].size(), 2U);

  const auto& primitive = file.json["meshes"][1]["primitives"][0];
  const auto base = vec3_accessor(file, primitive["attributes"]["POSITION"]);
  const auto base_normal = vec3_accessor(file, primitive["attributes"]["NORMAL"]);
  ASSERT_EQ(primitive["targets"].size(), 4U);
  // Vertices of a part are the render vertices that it uses, ascending.
  std::vector<uint32_t> used;
  const SourcePart& part = asset.source.part[0];
  for (uint32_t t = 0; t < part.triangle_count; ++t) {
    used.insert(used.end(), asset.source.triangle[t].begin(), asset.source.triangle[t].end());
  }
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  ASSERT_EQ(base.size(), used.size());
  for (uint32_t frame = 1; frame <= 4; ++frame) {
    const ClothSnapshot expected = waving_frame(asset, frame, {1.2F, 0, 0});
    const auto delta = vec3_accessor(file, primitive["targets"][frame - 1]["POSITION"]);
    const auto delta_normal = vec3_accessor(file, primitive["targets"][frame - 1]["NORMAL"]);
    for (std::size_t i = 0; i < used.size(); ++i) {
      EXPECT_LT(length(base[i] + delta[i] - expected.source_position[used[i]]), 3e-7F);
      EXPECT_NEAR(length(base_normal[i] + delta_normal[i]), 1, 1e-5F);
    }
  }
}

/// The cloth without the last face of its first part and the parts after it.
std::shared_ptr<const ClothAsset> opened(const ClothAsset& asset) {
  ClothAsset cut = asset;
  cut.source.part.resize(1);
  cut.source.part[0].triangle_count = asset.source.part[0].triangle_count - 1;
  cut.source.triangle.resize(cut.source.part[0].triangle_count);
  return std::make_shared<const ClothAsset>(std::move(cut));
}

TEST_F(CacheWriters, FacesThatACutOpensVanishInThatFrame) {
  const CacheDescription description{{sample()}, 30, 4};
  const ClothAsset& asset = *description.cloths[0];
  const std::shared_ptr<const ClothAsset> cut = opened(asset);
  for (const char* name : {"a.glb", "a.obj", "a.usda"}) {
    const auto writer = make_cache_writer(folder_ / name, description);
    for (uint32_t frame = 0; frame <= 4; ++frame) {
      ClothSnapshot state = waving_frame(asset, frame);
      if (frame >= 3) state.asset = cut;  // cut when two frames were done
      writer->add(std::span(&state, 1));
    }
    writer->finish();
    writer->commit();
  }
  const auto data = bytes("a.glb");
  const glb::Container file = glb::parse(data, "a.glb");
  ASSERT_EQ(file.json["meshes"].size(), 2U);
  const auto corners = [&](std::size_t mesh) {
    std::size_t count = 0;
    for (const auto& primitive : file.json["meshes"][mesh]["primitives"])
      count += file.json["accessors"][primitive["indices"].get<std::size_t>()]["count"].get<std::size_t>();
    return count;
  };
  EXPECT_EQ(corners(0), 3 * (asset.source.triangle.size() - cut->source.triangle.size()));
  EXPECT_EQ(corners(1), 3 * cut->source.triangle.size());
  const auto& animation = file.json["animations"][0];
  ASSERT_EQ(animation["channels"].size(), 3U);
  EXPECT_EQ(animation["channels"][1]["target"]["path"], "scale");
  EXPECT_EQ(animation["channels"][1]["target"]["node"], 0);
  const auto& sampler = animation["samplers"][animation["channels"][1]["sampler"].get<std::size_t>()];
  EXPECT_EQ(sampler["interpolation"], "STEP");
  EXPECT_EQ(vec3_accessor(file, sampler["output"]), (std::vector<Vec3>{{1, 1, 1}, {0, 0, 0}}));
  EXPECT_FLOAT_EQ(file.json["accessors"][sampler["input"].get<std::size_t>()]["max"][0].get<float>(), 2 / 30.0F);

  const auto faces = [&](const char* name) {
    const std::string text = test::read_text(folder_ / name);
    std::size_t count = 0;
    for (std::size_t i = text.find("\nf "); i != std::string::npos; i = text.find("\nf ", i + 1)) ++count;
    return count;
  };
  EXPECT_EQ(faces("a_0002.obj"), asset.source.triangle.size());
  EXPECT_EQ(faces("a_0003.obj"), cut->source.triangle.size());
  const std::string usd = test::read_text(folder_ / "a.usda");
  for (const auto& [declaration, each] : {std::pair{"int[] faceVertexCounts", 1U},
                                          {"int[] faceVertexIndices", 3U},
                                          {"int[] primvars:normals:indices", 3U},
                                          {"int[] primvars:st:indices", 3U}}) {
    const auto samples = usd_samples(usd, declaration, 0);
    ASSERT_EQ(samples.size(), 2U) << declaration;
    EXPECT_EQ(samples.at(0).size(), each * asset.source.triangle.size());
    EXPECT_EQ(samples.at(3).size(), each * cut->source.triangle.size());
  }
}

TEST_F(CacheWriters, SameFramesSameBytes) {
  for (const char* ending : {"glb", "usda", "obj", "pc2", "mdd", "exr"}) {
    write((std::string("a.") + ending).c_str(), {{sample()}, 60, 2});
    write((std::string("b.") + ending).c_str(), {{sample()}, 60, 2});
  }
  EXPECT_EQ(bytes("a.glb"), bytes("b.glb"));
  EXPECT_EQ(bytes("a.usda"), bytes("b.usda"));
  EXPECT_EQ(bytes("a_0002.obj"), bytes("b_0002.obj"));
  EXPECT_EQ(bytes("a.pc2"), bytes("b.pc2"));
  EXPECT_EQ(bytes("a.mdd"), bytes("b.mdd"));
  EXPECT_EQ(bytes("a_0001.exr"), bytes("b_0001.exr"));
}

TEST_F(CacheWriters, AGltfThatCannotHoldTheMotionIsRefusedAtOnce) {
  EXPECT_THROW(static_cast<void>(make_cache_writer(folder_ / "a.glb", CacheDescription{{sample()}, 60, 5000})), Error);
  EXPECT_THAT(folder_.entries(), testing::IsEmpty());
}

TEST_F(CacheWriters, AMissingFolderIsAnErrorAtOnce) {
  for (const char* name :
       {"missing/a.glb", "missing/a.usda", "missing/a.pc2", "missing/a.mdd", "missing/a.obj", "missing/a.exr"}) {
    EXPECT_THROW(static_cast<void>(make_cache_writer(folder_ / name, CacheDescription{{sample()}, 60, 2})), Error);
  }
}

}  // namespace
}  // namespace geocloth
