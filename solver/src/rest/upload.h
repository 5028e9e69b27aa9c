// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "backend.h"

namespace geocloth {

/// Everything a backend needs to know of one cloth: positions relative to the origin, masses from the pixels' area
/// shares, springs with rest lengths and compliances from the material.
/// @param uncut  the cloth's asset before any cut
[[nodiscard]] ClothData make_cloth_data(const ClothDesc& cloth, const Vec3& origin, const ClothAsset& uncut);
[[nodiscard]] inline ClothData make_cloth_data(const ClothDesc& cloth, const Vec3& origin) {
  return make_cloth_data(cloth, origin, *cloth.asset);
}

/// [1/kg] One per pixel, without pins.
[[nodiscard]] std::vector<float> inverse_masses(const ClothData& cloth);

/// Whether springs of it are held by long-range attachments.
[[nodiscard]] bool has_attachments(const Material& material);

/// Whether make_cloth_data() makes the same of both.
[[nodiscard]] bool make_same_data(const Material& a, const Material& b);
/// @param a,b  of the same pixels
[[nodiscard]] bool make_same_data(std::span<const Fabric> a, std::span<const Fabric> b);

/// The coordinate origin for these cloths: the middle of their bounds, rounded to multiples of 4 m.
[[nodiscard]] Vec3 choose_origin(std::span<const ClothDesc> cloths);

/// [m] diagonal of the bounds at rest.
[[nodiscard]] float rest_size(const ClothAsset& asset, float scale);

/// For every pixel that is not pinned the nearest pinned pixel along the surface at rest, over splits too, and how far
/// it is [m]. The distance runs over grid edges, diagonals and knight's moves: at most 2.8 % too long on a flat grid.
/// @param pinned  pixels, all copies listed
/// @param shares  of each pixel, by which lengths about it count; none: 1
[[nodiscard]] std::vector<shader::Attachment> make_attachments(const ClothAsset& asset, float scale,
                                                               std::span<const uint32_t> pinned,
                                                               std::span<const float> shares = {});

/// A way along the surface at rest between two pinned pixels.
struct PinWay {
  uint32_t a, b;
  float length;  ///< [m]
};
/// The shortest ways between pins whose nearest cloth meets: pins that are farther apart than one of them stretch it.
/// @param attachments  of these pins
[[nodiscard]] std::vector<PinWay> ways_between_pins(const ClothAsset& asset, float scale,
                                                    std::span<const shader::Attachment> attachments,
                                                    std::span<const uint32_t> pinned);

}  // namespace geocloth
