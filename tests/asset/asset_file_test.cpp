// SPDX-License-Identifier: GPL-3.0-or-later
// An asset survives its file bit for bit, every viewer can open it, and no file, however broken, does more than raise
// an error with one line.
#include "geocloth/asset/asset_file.h"

#include <cstring>
#include <filesystem>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"
#include "sample_asset.h"
#include "support/make_sheet.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

using Bytes = std::vector<std::byte>;
using nlohmann::json;
using test::sample_asset;

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  if (!a.empty()) {
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
  }
}

/// Decodes; a broken file may only raise an Error of one line, and what is accepted must be as good as new.
bool accepted(const Bytes& bytes) {
  try {
    const ClothAsset asset = decode_asset(bytes, "test.glb");
    const Bytes again = encode_asset(asset);
    EXPECT_EQ(encode_asset(decode_asset(again, "again.glb")), again);
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, testing::StartsWith("test.glb: "));
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return false;
  }
}

void put_u32(Bytes& bytes, std::size_t at, std::size_t value) {
  const auto word = static_cast<uint32_t>(value);
  std::memcpy(bytes.data() + at, &word, sizeof word);
}

/// A container around any JSON text.
Bytes assemble(std::string text, std::span<const std::byte> binary) {
  text.append((4 - text.size() % 4) % 4, ' ');
  Bytes bytes(28 + text.size() + binary.size());
  put_u32(bytes, 0, 0x46546C67);
  put_u32(bytes, 4, 2);
  put_u32(bytes, 8, bytes.size());
  put_u32(bytes, 12, text.size());
  put_u32(bytes, 16, 0x4E4F534A);
  std::memcpy(bytes.data() + 20, text.data(), text.size());
  put_u32(bytes, 20 + text.size(), binary.size());
  put_u32(bytes, 24 + text.size(), 0x004E4942);
  if (!binary.empty()) std::memcpy(bytes.data() + 28 + text.size(), binary.data(), binary.size());
  return bytes;
}
Bytes assemble(const json& root, std::span<const std::byte> binary) {
  return assemble(root.dump(), binary);
}

TEST(AssetFile, RoundTripKeepsEveryBit) {
  const ClothAsset a = sample_asset();
  const Bytes bytes = encode_asset(a);
  const ClothAsset b = decode_asset(bytes, "test.glb");
  EXPECT_EQ(encode_asset(b), bytes);
  EXPECT_EQ(encode_asset(sample_asset()), bytes) << "same asset, same bytes";

  EXPECT_EQ(b.name, a.name);
  EXPECT_EQ(b.layout, a.layout);
  EXPECT_EQ(b.width, a.width);
  EXPECT_EQ(b.height, a.height);
  EXPECT_EQ(b.spacing, a.spacing);
  EXPECT_EQ(b.chart_count, a.chart_count);
  expect_same_bits(b.rest_position, a.rest_position);
  expect_same_bits(b.chart, a.chart);
  expect_same_bits(b.spring_mask, a.spring_mask);
  expect_same_bits(b.cell, a.cell);
  expect_same_bits(b.area, a.area);
  expect_same_bits(b.splits.offset, a.splits.offset);
  expect_same_bits(b.splits.pixel, a.splits.pixel);
  expect_same_bits(b.seam_bends, a.seam_bends);
  expect_same_bits(b.sewing, a.sewing);
  expect_same_bits(b.binding, a.binding);
  expect_same_bits(b.source.position, a.source.position);
  expect_same_bits(b.source.normal, a.source.normal);
  expect_same_bits(b.source.uv, a.source.uv);
  expect_same_bits(b.source.source_vertex, a.source.source_vertex);
  expect_same_bits(b.source.triangle, a.source.triangle);
  EXPECT_EQ(b.source.source_vertex_count, a.source.source_vertex_count);
  expect_same_bits(b.source.middle, a.source.middle);
  ASSERT_EQ(b.source.part.size(), a.source.part.size());
  for (std::size_t i = 0; i < a.source.part.size(); ++i) {
    EXPECT_EQ(b.source.part[i].name, a.source.part[i].name);
    EXPECT_EQ(b.source.part[i].material, a.source.part[i].material);
    EXPECT_EQ(b.source.part[i].first_triangle, a.source.part[i].first_triangle);
    EXPECT_EQ(b.source.part[i].triangle_count, a.source.part[i].triangle_count);
  }
  ASSERT_EQ(b.source.material.size(), a.source.material.size());
  for (std::size_t i = 0; i < a.source.material.size(); ++i) {
    const SourceMaterial &m = a.source.material[i], &n = b.source.material[i];
    EXPECT_EQ(n.name, m.name);
    EXPECT_EQ(n.base_color, m.base_color);
    EXPECT_EQ(n.metallic, m.metallic);
    EXPECT_EQ(n.roughness, m.roughness);
    EXPECT_EQ(n.base_color_image, m.base_color_image);
    EXPECT_EQ(n.normal_image, m.normal_image);
    EXPECT_EQ(n.metallic_roughness_image, m.metallic_roughness_image);
    EXPECT_EQ(n.alpha_mask, m.alpha_mask);
    EXPECT_EQ(n.alpha_blend, m.alpha_blend);
    EXPECT_EQ(n.alpha_cutoff, m.alpha_cutoff);
  }
  ASSERT_EQ(b.source.image.size(), 1U);
  EXPECT_EQ(b.source.image[0].name, a.source.image[0].name);
  EXPECT_EQ(b.source.image[0].mime_type, a.source.image[0].mime_type);
  EXPECT_EQ(b.source.image[0].bytes, a.source.image[0].bytes);
  ASSERT_EQ(b.vertex_groups.size(), a.vertex_groups.size());
  for (std::size_t i = 0; i < a.vertex_groups.size(); ++i) {
    EXPECT_EQ(b.vertex_groups[i].name, a.vertex_groups[i].name);
    EXPECT_EQ(b.vertex_groups[i].source_vertex, a.vertex_groups[i].source_vertex);
  }
  EXPECT_EQ(b.paint, a.paint);
}

TEST(AssetFile, WideIndicesAndNoSeamsRoundTrip) {
  const Bytes bytes = encode_asset(test::make_sheet({.nx = 300, .ny = 260}));
  const ClothAsset asset = decode_asset(bytes, "test.glb");
  EXPECT_EQ(asset.source.position.size(), 78000U);
  EXPECT_EQ(asset.splits.rows(), 0U);
  EXPECT_EQ(encode_asset(asset), bytes);
}

TEST(AssetFile, NamesThatAreNotUtf8DoNotStopAConversion) {
  ClothAsset asset = sample_asset();
  asset.name = "caf\xE9";
  asset.source.part[0].name = std::string("a\0b", 3);
  const ClothAsset back = decode_asset(encode_asset(asset), "test.glb");
  EXPECT_EQ(back.name, "caf\xEF\xBF\xBD");
  EXPECT_EQ(back.source.part[0].name, asset.source.part[0].name);
}

TEST(AssetFile, TexturesNeedTextureCoordinates) {
  ClothAsset asset = sample_asset();
  asset.source.uv.clear();
  const ClothAsset back = decode_asset(encode_asset(asset), "test.glb");
  EXPECT_FALSE(back.source.material[0].base_color_image.has_value());
  EXPECT_EQ(back.source.image.size(), 1U);
}

TEST(AssetFile, ABrokenAssetIsNotWritten) {
  ClothAsset asset = sample_asset();
  asset.area[0] = -1;
  EXPECT_THROW(static_cast<void>(encode_asset(asset)), Error);
}

TEST(AssetFile, TruncationAtEveryByteIsAnError) {
  const Bytes bytes = encode_asset(sample_asset());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(accepted(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
  }
  Bytes longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(accepted(longer));
}

TEST(AssetFile, TruncationThatTheHeaderHidesIsAnError) {
  const Bytes bytes = encode_asset(sample_asset());
  uint32_t json_size = 0;
  std::memcpy(&json_size, bytes.data() + 12, 4);
  for (std::size_t size = 20; size < bytes.size(); ++size) {
    Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    put_u32(cut, 8, size);
    if (size < 20 + json_size) put_u32(cut, 12, size - 20);
    if (size >= 28 + json_size) put_u32(cut, 20 + json_size, size - 28 - json_size);
    const bool only_padding_lost = bytes.size() - size < 4;
    if (!only_padding_lost) {
      EXPECT_FALSE(accepted(cut)) << size;
    }
  }
}

TEST(AssetFile, FlippedBitsAreAnErrorOrAValidAsset) {
  const Bytes bytes = encode_asset(sample_asset());
  std::size_t refused = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const uint32_t bits : {1U << (i % 8), 0xFFU}) {
      Bytes flipped = bytes;
      flipped[i] ^= static_cast<std::byte>(bits);
      if (!accepted(flipped)) ++refused;
    }
  }
  EXPECT_GT(refused, bytes.size() / 2);
}

/// Calls visit(value) for every value below a JSON value, containers included.
void for_each_value(json& value, const std::function<void(json&)>& visit) {
  visit(value);
  if (!value.is_structured()) return;
  for (json& child : value) for_each_value(child, visit);
}

TEST(AssetFile, EveryMemberBrokenInEveryWayIsAnErrorOrAValidAsset) {
  const Bytes bytes = encode_asset(sample_asset());
  const glb::Container container = glb::parse(bytes, "test.glb");
  json root = container.json;
  const std::vector<json> wrong = {nullptr,       true,  -1,  0,  1,  0xFFFFFFFFU,   18446744073709551615U,
                                   1.5,           1e300, "x", "", {}, json::array(), json::array({-1}),
                                   json::object()};
  for_each_value(root, [&](json& value) {
    const json right = value;
    for (const json& other : wrong) {
      value = other;
      accepted(assemble(root, container.binary));
    }
    if (right.is_object()) {
      for (const auto& item : right.items()) {
        value.erase(item.key());
        accepted(assemble(root, container.binary));
        value = right;
      }
    }
    value = right;
  });
  EXPECT_TRUE(accepted(assemble(root, container.binary)));
}

TEST(AssetFile, AbsurdSizesAllocateNothing) {
  const Bytes bytes = encode_asset(sample_asset());
  const glb::Container container = glb::parse(bytes, "test.glb");
  json root = container.json;
  json& cloth = root["extensions"][kAssetExtension];
  cloth["width"] = cloth["height"] = kMaxImageSide;
  EXPECT_FALSE(accepted(assemble(root, container.binary)));

  // As many vertices as point caches of it would have: bytes that the file at hand does not pay for.
  root = container.json;
  root["extensions"][kAssetExtension]["sourceVertices"]["count"] = 4'000'000'000U;
  EXPECT_FALSE(accepted(assemble(root, container.binary)));

  // Thousands of groups that all point at the same bytes: the bytes can be taken once.
  root = container.json;
  const json group = {{"name", "g"}, {"vertices", root["extensions"][kAssetExtension]["sourceVertices"]["indices"]}};
  root["extensions"][kAssetExtension]["vertexGroups"] = json(10000, group);
  EXPECT_FALSE(accepted(assemble(root, container.binary)));
}

TEST(AssetFile, OtherFilesAreRefusedWithTheReason) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(decode_asset(std::as_bytes(std::span(text)), "x"));
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message(""), testing::HasSubstr("is empty"));
  EXPECT_THAT(message("v 0 0 0\nf 1 1 1\n"), testing::HasSubstr("geocloth convert"));
  EXPECT_THAT(message(std::string("glTF\2\0\0\0\x10", 9)), testing::HasSubstr("truncated"));
  const Bytes plain = assemble({{"asset", {{"version", "2.0"}}}}, {});
  try {
    static_cast<void>(decode_asset(plain, "plain.glb"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_THAT(error.what(), testing::HasSubstr("without a geometry image"));
  }
  const std::string nested = "glTF" + std::string(100000, '[');
  EXPECT_NE(message(nested), "accepted");
}

TEST(AssetFile, DeeplyNestedJsonDoesNotOverflowTheStack) {
  const std::string deep = std::string(1000000, '[') + std::string(1000000, ']');
  EXPECT_FALSE(accepted(assemble("{\"a\":" + deep + "}", {})));

  // In every attribute object, where two of them are compared; a member that we do not know is passed over.
  const Bytes bytes = encode_asset(sample_asset());
  const glb::Container container = glb::parse(bytes, "test.glb");
  std::string text = container.json.dump();
  const std::string key = "\"attributes\":{";
  for (std::size_t at = 0; (at = text.find(key, at)) != std::string::npos; at += key.size()) {
    text.insert(at + key.size(), "\"_X\":" + deep + ",");
  }
  EXPECT_TRUE(accepted(assemble(text, container.binary)));
}

TEST(AssetFile, WritesAndReadsFiles) {
  const test::TemporaryFolder folder;
  const auto path = folder / "sheet.glb";
  write_asset(sample_asset(), path);
  EXPECT_EQ(encode_asset(read_asset(path)), encode_asset(sample_asset()));
  std::filesystem::remove(path);
  EXPECT_THROW(static_cast<void>(read_asset(path)), Error);
}

}  // namespace
}  // namespace geocloth
