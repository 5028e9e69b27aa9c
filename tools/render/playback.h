// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "render/renderer.h"

namespace geocloth {

/// The state of one cloth in host memory.
struct PlayedCloth {
  std::vector<Vec3> position, normal;  ///< one per pixel of its RenderCloth's asset
};

/// Something that can be drawn frame by frame: an asset at rest (one frame) or a cache of a motion.
struct Playback {
  RenderScene scene;
  double frame_rate = 60;
  size_t frame_count = 1;
  bool is_cache = false;  ///< of vertices of meshes, whose grids are not known
  std::function<std::vector<PlayedCloth>(size_t frame)> state;
};

/// An asset as it came out of the conversion.
[[nodiscard]] Playback play_asset(const std::shared_ptr<const ClothAsset>& asset);

/// A cache of vertex positions of source meshes: every vertex becomes a pixel of its own, so that the same shader draws
/// it. Normals are smooth over vertices that shared position and normal in the source mesh.
/// @param frames     [frame][cloth][render vertex] [m], at least one frame
/// @param open_from  [cloth][triangle] frame from which on it is not drawn; empty: all are
[[nodiscard]] Playback play_vertices(std::vector<SourceMesh> cloths, std::vector<std::vector<std::vector<Vec3>>> frames,
                                     double frame_rate, const std::vector<std::vector<uint32_t>>& open_from = {});

}  // namespace geocloth
