// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/parametrize/flatten.h"
#include "render/picture.h"

namespace geocloth {

/// How the image stretches the surface at a pixel, from the rest positions of its neighbours against nominal spacing.
struct PixelDistortion {
  float area = 0;        ///< area of the surface per area of the image; 1 is nominal, 0 where it cannot be told
  float anisotropy = 1;  ///< larger singular value over the smaller; 1 is none, at most 1e6
};
[[nodiscard]] std::vector<PixelDistortion> measure_distortion(const ClothAsset& asset);

/// The geometry image as the well-known colour picture: x, y, z of the rest position over its bounding box as red,
/// green, blue; one pixel per pixel of the asset.
[[nodiscard]] Picture draw_geometry_image(const ClothAsset& asset);
/// Rest normals as colours, n/2 + 1/2; one pixel per pixel of the asset.
[[nodiscard]] Picture draw_normal_map(const ClothAsset& asset);
/// Whether words under a picture say what it shows.
enum class Caption { none, below };
/// A colour and a number per chart, free borders dark, seams in colours and with letters that mates share, nodes white.
[[nodiscard]] Picture draw_chart_map(const ClothAsset& asset, Caption caption = Caption::below);
/// Area stretch and anisotropy as two heat maps with scales: fine ones where the distortion is small, else coarse ones.
[[nodiscard]] Picture draw_distortion(const ClothAsset& asset);
/// The triangles of the cut surface as they lie in the atlas.
[[nodiscard]] Picture draw_flat_surface(const FlatSurface& flat);

/// A picture of the image's pixels, each a block so large that the whole can be judged.
[[nodiscard]] Picture enlarged_to_see(const Picture& picture);

/// Writes geometry_image.png, normals.png, charts.png, distortion.png, and flat.png when there is a flat surface, into
/// a folder that is made if need be. Small images are enlarged so that they can be judged.
/// @return the files
/// @throws Error(io) when the folder or a file cannot be written
std::vector<std::filesystem::path> write_pictures(const ClothAsset& asset, const FlatSurface* flat,
                                                  const std::filesystem::path& folder);

}  // namespace geocloth
