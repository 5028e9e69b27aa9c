// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

inline constexpr uint32_t kNeverOpen = 0xFFFFFFFFU;

/// An animated .glb as `simulate` writes it.
struct Cache {
  /// At frame 0; one part per primitive, materials and images of each cloth its own.
  std::vector<SourceMesh> cloths;
  /// [cloth][triangle] Frame from which on a face is gone, because a cut opens it; kNeverOpen for one that stays.
  std::vector<std::vector<uint32_t>> open_from;
  double frame_rate = 60;                              ///< [1/s]; 60 when there is no animation
  std::vector<std::vector<std::vector<Vec3>>> frames;  ///< [frame][cloth][render vertex], frame 0 first [m]
};

/// @throws Error(io) when the file cannot be read, Error(unsupported) for a glTF that is not such a cache,
///   Error(invalid_data) for a broken one. Safe for hostile bytes.
[[nodiscard]] Cache read_gltf_cache(const std::filesystem::path& path);
[[nodiscard]] Cache decode_gltf_cache(std::span<const std::byte> bytes, const std::string& name);

/// A .pc2 or .mdd file.
struct PointCache {
  uint32_t points = 0;
  std::optional<double> frame_rate;       ///< [1/s]; of an .mdd of several frames whose times say it
  double step = 1;                        ///< of a .pc2, > 0: that many frames of its time line go by with each
  std::vector<std::vector<Vec3>> frames;  ///< each has `points` entries [m]
};

/// Which of the two formats it is, the ending of the name says.
/// @throws as read_gltf_cache
[[nodiscard]] PointCache read_point_cache(const std::filesystem::path& path);
[[nodiscard]] PointCache decode_point_cache(std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace geocloth
