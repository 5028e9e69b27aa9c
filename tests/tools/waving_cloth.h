// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "export/cache_writer.h"

namespace geocloth::test {

/// A frame of a cloth in a made-up wave that moves it out of its plane, with everything that writers read.
inline ClothSnapshot waving_frame(const ClothAsset& asset, uint32_t frame, const Vec3& shift = {}) {
  ClothSnapshot state;
  const float phase = 0.2F * static_cast<float>(frame);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    const Vec3& p = asset.rest_position[i];
    const Vec3 moved{p.x + shift.x, p.y + shift.y, p.z + shift.z + 0.3F * std::sin(phase) * std::cos(6 * p.x)};
    state.position.push_back(asset.valid(i) ? moved : Vec3{});
  }
  compute_normals(asset, state.position, state.normal);
  evaluate_binding(asset, state.position, state.normal, state.source_position);
  return state;
}

/// Feeds frames 0..frame_count of waving cloths, side by side, to a writer and completes it.
inline void write_waving(CacheWriter& writer, const CacheDescription& description) {
  for (uint32_t frame = 0; frame <= description.frame_count; ++frame) {
    std::vector<ClothSnapshot> cloths;
    for (std::size_t i = 0; i < description.cloths.size(); ++i) {
      cloths.push_back(waving_frame(*description.cloths[i], frame, {1.2F * static_cast<float>(i), 0, 0}));
    }
    writer.add(cloths);
  }
  writer.finish();
  writer.commit();
}

}  // namespace geocloth::test
