// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Triangles over pixels.
struct GridMesh {
  std::vector<Vec3> position;   ///< [m]
  std::vector<uint32_t> pixel;  ///< the pixel (the first copy, when welded) that each vertex stands for
  std::vector<Vec2> uv;         ///< atlas position of that pixel, (x / (width-1), 1 - y / (height-1))
  std::vector<Triangle> triangle;
};

/// For every pixel the first pixel of its row in the split-vertex table, or the pixel itself.
[[nodiscard]] std::vector<uint32_t> first_copies(const ClothAsset& asset);

/// For every pixel its row in the split-vertex table, kNoPixel for one that has no copies.
[[nodiscard]] std::vector<uint32_t> split_rows(const ClothAsset& asset);

/// Calls use(from, to) for the pixels of every structural spring, row by row.
template <class Use>
void for_structural_springs(const ClothAsset& asset, const Use& use) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if ((asset.spring_mask[p] & kSpringRight) != 0) use(p, p + 1);
    if ((asset.spring_mask[p] & kSpringDown) != 0) use(p, p + asset.width);
  }
}

/// The triangles, none to two, of the cell whose upper left corner is a pixel, as pixel indices.
struct CellTriangles {
  std::array<Triangle, 2> triangle{};
  uint32_t count = 0;
  [[nodiscard]] const Triangle* begin() const { return triangle.data(); }
  [[nodiscard]] const Triangle* end() const { return triangle.data() + count; }
};
[[nodiscard]] CellTriangles cell_triangles(const ClothAsset& asset, uint32_t pixel);

/// The grid's triangles as pixel indices (charts apart), in the order of the cells.
[[nodiscard]] std::vector<Triangle> pixel_triangles(const ClothAsset& asset);

/// The grid mesh with the copies of every split vertex merged: the surface that is simulated.
/// @param position  one per pixel; pass asset.rest_position for the rest shape
[[nodiscard]] GridMesh welded_grid_mesh(const ClothAsset& asset, const std::vector<Vec3>& position);

/// The charts apart, copies not merged.
[[nodiscard]] GridMesh unwelded_grid_mesh(const ClothAsset& asset, const std::vector<Vec3>& position);

/// Wavefront OBJ text of a mesh; texture coordinates only when with_uv. Digits round-trip the floats.
[[nodiscard]] std::string to_obj(const GridMesh& mesh, bool with_uv);

}  // namespace geocloth
