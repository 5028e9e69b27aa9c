// SPDX-License-Identifier: Apache-2.0
// The geometry image read back as triangles (Gu, Gortler, Hoppe 2002, section 3): each cell of four pixels gives two,
// and welding them through the split-vertex table closes the surface along the cut again.
#include "geocloth/asset/grid_mesh.h"

#include <charconv>
#include <numeric>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

/// The mesh over the pixels that `first_copy` maps to; a triangle that the weld collapses is left out.
GridMesh make_grid_mesh(const ClothAsset& asset, const std::vector<Vec3>& position,
                        const std::vector<uint32_t>& first_copy) {
  if (position.size() != asset.pixel_count()) {
    throw Error(ErrorCode::invalid_argument, "positions are given for " + std::to_string(position.size()) + " of " +
                                                 std::to_string(asset.pixel_count()) + " pixels");
  }
  GridMesh mesh;
  std::vector<uint32_t> vertex(asset.pixel_count(), kNoPixel);
  for (const Triangle& t : pixel_triangles(asset)) {
    const Triangle welded{first_copy[t[0]], first_copy[t[1]], first_copy[t[2]]};
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    for (const uint32_t pixel : welded) vertex[pixel] = 0;
    mesh.triangle.push_back(welded);
  }
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if (vertex[pixel] == kNoPixel) continue;
    vertex[pixel] = static_cast<uint32_t>(mesh.pixel.size());
    mesh.pixel.push_back(pixel);
    mesh.position.push_back(position[pixel]);
    const uint32_t column = pixel % asset.width, row = pixel / asset.width;
    const auto x = static_cast<float>(column), y = static_cast<float>(row);
    const auto last_x = static_cast<float>(asset.width - 1), last_y = static_cast<float>(asset.height - 1);
    mesh.uv.push_back({x / last_x, 1 - y / last_y});  // a cell exists, so neither side is one pixel
  }
  for (Triangle& t : mesh.triangle) {
    for (uint32_t& corner : t) corner = vertex[corner];
  }
  return mesh;
}

void append_number(std::string& text, float value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  text.append(digits, end);
}

}  // namespace

std::vector<uint32_t> first_copies(const ClothAsset& asset) {
  std::vector<uint32_t> first(asset.pixel_count());
  std::iota(first.begin(), first.end(), 0U);
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    const std::span<const uint32_t> copies = asset.splits.copies(row);
    for (const uint32_t pixel : copies) first[pixel] = copies.front();
  }
  return first;
}

std::vector<uint32_t> split_rows(const ClothAsset& asset) {
  std::vector<uint32_t> row_of(asset.pixel_count(), kNoPixel);
  for (uint32_t row = 0; row < asset.splits.rows(); ++row)
    for (const uint32_t pixel : asset.splits.copies(row)) row_of[pixel] = row;
  return row_of;
}

CellTriangles cell_triangles(const ClothAsset& asset, uint32_t pixel) {
  const uint8_t bits = asset.cell[pixel];
  const uint32_t a = pixel, b = a + 1, c = a + asset.width, d = c + 1;
  const bool left = (bits & kCellDiagonalLeft) != 0;
  CellTriangles cell;
  if ((bits & kCellFirst) != 0) cell.triangle[cell.count++] = left ? Triangle{a, c, b} : Triangle{a, c, d};
  if ((bits & kCellSecond) != 0) cell.triangle[cell.count++] = left ? Triangle{b, c, d} : Triangle{a, d, b};
  return cell;
}

std::vector<Triangle> pixel_triangles(const ClothAsset& asset) {
  std::vector<Triangle> triangles;
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    for (const Triangle& t : cell_triangles(asset, pixel)) triangles.push_back(t);
  }
  return triangles;
}

GridMesh welded_grid_mesh(const ClothAsset& asset, const std::vector<Vec3>& position) {
  return make_grid_mesh(asset, position, first_copies(asset));
}

GridMesh unwelded_grid_mesh(const ClothAsset& asset, const std::vector<Vec3>& position) {
  std::vector<uint32_t> itself(asset.pixel_count());
  std::iota(itself.begin(), itself.end(), 0U);
  return make_grid_mesh(asset, position, itself);
}

std::string to_obj(const GridMesh& mesh, bool with_uv) {
  std::string text;
  text.reserve(mesh.position.size() * 48 + mesh.triangle.size() * 32);
  for (const Vec3& p : mesh.position) {
    text += "v ";
    append_number(text, p.x);
    text += ' ';
    append_number(text, p.y);
    text += ' ';
    append_number(text, p.z);
    text += '\n';
  }
  if (with_uv) {
    for (const Vec2& uv : mesh.uv) {
      text += "vt ";
      append_number(text, uv.x);
      text += ' ';
      append_number(text, uv.y);
      text += '\n';
    }
  }
  for (const Triangle& t : mesh.triangle) {
    text += 'f';
    for (const uint32_t corner : t) {
      const std::string number = std::to_string(corner + 1);
      text += ' ' + number;
      if (with_uv) text += '/' + number;
    }
    text += '\n';
  }
  return text;
}

}  // namespace geocloth
