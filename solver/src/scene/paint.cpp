// SPDX-License-Identifier: Apache-2.0
// What vertices are painted in as a map of settings: values of pixels from those of the mesh's vertices.
#include <algorithm>
#include <array>

#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"
#include "scene/source_surface.h"

namespace geocloth {

const char* to_string(PaintChannel channel) {
  constexpr std::array<const char*, 4> kNames{"red", "green", "blue", "alpha"};
  return kNames.at(static_cast<size_t>(channel));
}

std::vector<float> paint_at(const ClothAsset& asset, PaintChannel channel, std::span<const uint32_t> pixels) {
  if (asset.paint.empty()) {
    throw Error(
        ErrorCode::invalid_data,
        (asset.name.empty() ? "" : asset.name + ": ") +
            "none of its vertices is painted; paint them (vertex colors) in the mesh file and convert it again");
  }
  const SourceMesh& source = asset.source;
  const auto value_of = [&](uint32_t vertex) {
    return asset.paint[source.source_vertex[vertex]][static_cast<size_t>(channel)] / 255.0;
  };
  const SourceSurface surface(asset);
  std::vector<float> values;
  values.reserve(pixels.size());
  for (const uint32_t p : pixels) {
    const std::optional<RestPlace> place = surface.place_of(p);
    if (!place) {
      values.push_back(1);
      continue;
    }
    const auto& [a, b, c] = place->triangle;
    const Vec3d& share = place->beside.corner_share;
    const double value = share.x * value_of(a) + share.y * value_of(b) + share.z * value_of(c);
    values.push_back(static_cast<float>(std::clamp(value, 0.0, 1.0)));  // shares on edges are off by rounding
  }
  return values;
}

}  // namespace geocloth
