// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/playback.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace geocloth {
namespace {

/// A stand-in asset: an image with a pixel for each vertex, and bindings that say so.
std::shared_ptr<const ClothAsset> image_of_vertices(const SourceMesh& source) {
  ClothAsset asset;
  const auto vertices = static_cast<uint32_t>(source.position.size());
  asset.width = std::max(1U, static_cast<uint32_t>(std::ceil(std::sqrt(vertices))));
  asset.height = std::max(1U, (vertices + asset.width - 1) / asset.width);
  asset.rest_position.resize(asset.pixel_count());
  asset.chart.assign(asset.pixel_count(), kNoChart);
  asset.spring_mask.resize(asset.pixel_count());
  asset.cell.resize(asset.pixel_count());
  asset.source = source;
  for (uint32_t v = 0; v < vertices; ++v) asset.binding.push_back({{v, v, v}, {1, 0, 0}, {}});
  return std::make_shared<const ClothAsset>(std::move(asset));
}

/// For every vertex the first one with the same position and normal.
std::vector<uint32_t> smooth_groups(const SourceMesh& source) {
  using Key = std::tuple<float, float, float, float, float, float>;
  std::map<Key, uint32_t> first;
  std::vector<uint32_t> group;
  for (uint32_t v = 0; v < source.position.size(); ++v) {
    const Vec3& p = source.position[v];
    const Vec3 n = source.normal.empty() ? Vec3{} : source.normal[v];
    group.push_back(first.try_emplace({p.x, p.y, p.z, n.x, n.y, n.z}, v).first->second);
  }
  return group;
}

std::vector<Vec3> smooth_normals(const SourceMesh& source, const std::vector<uint32_t>& group,
                                 const std::vector<Vec3>& position) {
  std::vector<Vec3> sum(position.size());
  for (const Triangle& t : source.triangle) {
    const Vec3 weighted = cross(position[t[1]] - position[t[0]], position[t[2]] - position[t[0]]);
    for (const uint32_t v : t) sum[group[v]] += weighted;
  }
  std::vector<Vec3> normal(position.size());
  for (size_t v = 0; v < normal.size(); ++v) normal[v] = normalized(sum[group[v]]);
  return normal;
}

}  // namespace

Playback play_asset(const std::shared_ptr<const ClothAsset>& asset) {
  Playback playback;
  playback.scene.subject = bounds_of(asset->source.position);
  playback.scene.cloths = {make_render_cloth(asset)};
  playback.state = [asset](size_t) {
    PlayedCloth cloth{asset->rest_position, {}};
    compute_normals(*asset, cloth.position, cloth.normal);
    return std::vector{std::move(cloth)};
  };
  return playback;
}

Playback play_vertices(const std::vector<SourceMesh>& cloths, std::vector<std::vector<std::vector<Vec3>>> frames,
                       double frame_rate) {
  Playback playback{.scene = {}, .frame_rate = frame_rate, .frame_count = frames.size(), .state = {}};
  std::vector<std::vector<uint32_t>> groups;
  std::vector<uint32_t> pixels;
  for (const SourceMesh& source : cloths) {
    const std::shared_ptr<const ClothAsset> asset = image_of_vertices(source);
    pixels.push_back(asset->pixel_count());
    playback.scene.cloths.push_back({asset, 1, std::vector<Vec3>(source.position.size(), Vec3{0, 0, 1})});
    groups.push_back(smooth_groups(source));
  }
  for (const auto& frame : frames)
    for (const auto& cloth : frame) playback.scene.subject.include(bounds_of(cloth));
  playback.state = [cloths, groups, pixels, frames = std::move(frames)](size_t frame) {
    std::vector<PlayedCloth> states;
    for (size_t c = 0; c < cloths.size(); ++c) {
      PlayedCloth state{frames[frame][c], smooth_normals(cloths[c], groups[c], frames[frame][c])};
      state.position.resize(pixels[c]);
      state.normal.resize(pixels[c]);
      states.push_back(std::move(state));
    }
    return states;
  };
  return playback;
}

}  // namespace geocloth
