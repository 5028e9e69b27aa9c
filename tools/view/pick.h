// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/solver/collider.h"
#include "view/screen_map.h"

namespace geocloth::view {

/// A cloth as it stands.
struct PickedFrom {
  const ClothAsset* asset = nullptr;
  std::span<const Vec3> position;  ///< [m] one per pixel
  float scale = 1;                 ///< of its transform
};

struct Picked {
  uint32_t cloth = 0, pixel = 0;
  Vec3 point;  ///< [m] where the pixel is
};

/// The pixel under the mouse: the nearest corner of the foremost triangle there, else, beside the cloth, the nearest
/// pixel within a few pixels of the picture. Nothing where a collider is in front. Points that are not finite do not
/// count.
/// @param colliders  that can be seen
[[nodiscard]] std::optional<Picked> pick_pixel(const ScreenMap& screen, const Vec2& place,
                                               std::span<const PickedFrom> cloths, std::span<const Collider> colliders);

}  // namespace geocloth::view
