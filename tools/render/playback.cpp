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

/// A triangle that is drawn before a frame only.
struct Opening {
  Triangle corner;
  uint32_t frame;
};

/// Gives the triangles that open in the motion vertices of their own at the end of the mesh, three by three.
std::vector<Opening> part_openings(SourceMesh& mesh, const std::vector<uint32_t>& open_from, size_t frame_count) {
  std::vector<Opening> openings;
  for (size_t t = 0; t < open_from.size(); ++t) {
    if (open_from[t] >= frame_count) continue;
    Triangle& triangle = mesh.triangle[t];
    openings.push_back({triangle, open_from[t]});
    for (uint32_t& v : triangle) {
      const auto copy = [v](auto& values) {
        if (!values.empty()) values.push_back(values[v]);
      };
      copy(mesh.normal);
      copy(mesh.uv);
      copy(mesh.source_vertex);
      copy(mesh.position);
      v = static_cast<uint32_t>(mesh.position.size()) - 1;
    }
  }
  return openings;
}

/// Adds the vertices of the openings; those that are open have no size.
std::vector<Vec3> with_openings(std::vector<Vec3> position, const std::vector<Opening>& openings, size_t frame) {
  position.reserve(position.size() + 3 * openings.size());
  for (const Opening& opening : openings) {
    const bool open = frame >= opening.frame;
    for (const uint32_t v : opening.corner) position.push_back(position[open ? opening.corner[0] : v]);
  }
  return position;
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

Playback play_vertices(std::vector<SourceMesh> cloths, std::vector<std::vector<std::vector<Vec3>>> frames,
                       double frame_rate, const std::vector<std::vector<uint32_t>>& open_from) {
  Playback playback{.scene = {}, .frame_rate = frame_rate, .frame_count = frames.size(), .is_cache = true, .state = {}};
  std::vector<std::vector<uint32_t>> groups;
  std::vector<std::vector<Opening>> openings(cloths.size());
  std::vector<uint32_t> pixels;
  for (size_t c = 0; c < cloths.size(); ++c) {
    SourceMesh& source = cloths[c];
    if (!open_from.empty()) openings[c] = part_openings(source, open_from[c], frames.size());
    const std::shared_ptr<const ClothAsset> asset = image_of_vertices(source);
    pixels.push_back(asset->pixel_count());
    playback.scene.cloths.push_back({asset, 1, std::vector<Vec3>(source.position.size(), Vec3{0, 0, 1})});
    groups.push_back(smooth_groups(source));
  }
  for (const auto& frame : frames)
    for (const auto& cloth : frame) playback.scene.subject.include(bounds_of(cloth));
  playback.state = [cloths = std::move(cloths), groups, openings, pixels, frames = std::move(frames)](size_t frame) {
    std::vector<PlayedCloth> states;
    for (size_t c = 0; c < cloths.size(); ++c) {
      PlayedCloth state{with_openings(frames[frame][c], openings[c], frame), {}};
      state.normal = smooth_normals(cloths[c], groups[c], state.position);
      state.position.resize(pixels[c]);
      state.normal.resize(pixels[c]);
      states.push_back(std::move(state));
    }
    return states;
  };
  return playback;
}

}  // namespace geocloth
