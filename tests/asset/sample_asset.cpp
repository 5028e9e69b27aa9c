// SPDX-License-Identifier: GPL-3.0-or-later
#include "sample_asset.h"

#include "support/make_sheet.h"

namespace geocloth::test {
namespace {

/// One red pixel.
const std::vector<uint8_t> kPng = {0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                                   0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
                                   0x00, 0x90, 0x77, 0x53, 0xDE, 0x00, 0x00, 0x00, 0x0C, 0x49, 0x44, 0x41, 0x54, 0x08,
                                   0xD7, 0x63, 0xF8, 0xCF, 0xC0, 0x00, 0x00, 0x03, 0x01, 0x01, 0x00, 0x18, 0xDD, 0x8D,
                                   0xB0, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

}  // namespace

ClothAsset sample_asset() {
  ClothAsset asset = make_sheet({.nx = 5, .ny = 5, .charts_x = 2, .charts_y = 2, .jitter = 0.2F});
  asset.name = "sample \u00e4";
  SourceMesh& source = asset.source;
  source.uv.clear();
  for (const Vec3& p : source.position) source.uv.push_back({p.x + 0.5F, 0.5F - p.y});
  source.image = {{"red", "image/png", kPng}};
  source.material.assign(3, {});
  source.material[0].name = "front";
  source.material[0].base_color = {0.1F, 0.2F, 0.3F, 1};
  source.material[0].roughness = 0.7F;
  source.material[0].base_color_image = 0;
  source.material[1].name = "back";
  source.material[1].metallic = 0.25F;
  source.material[1].alpha_mask = true;
  source.material[1].alpha_cutoff = 0.3F;
  source.material[1].normal_image = 0;
  source.material[2].base_color = {1, 1, 1, 0.5F};
  source.material[2].alpha_blend = true;
  source.middle = {{0, 1}, {2, source.source_vertex_count - 2}};  // the last one lies beside the one before it
  const auto count = static_cast<uint32_t>(source.triangle.size());
  source.part = {{"left", 0, 0, count / 3}, {"right", 1, count / 3, count - count / 3}};
  asset.vertex_groups.push_back({"none", {}});
  asset.sewing = {{asset.splits.pixel[0], asset.splits.pixel.back()}};
  for (uint32_t v = 0; v < source.source_vertex_count; ++v)
    asset.paint.push_back({static_cast<uint8_t>(v), 0, 255, static_cast<uint8_t>(255 - v % 256)});
  return asset;
}

}  // namespace geocloth::test
