// SPDX-License-Identifier: Apache-2.0
#include "rest/fabrics.h"

#include <algorithm>
#include <array>

#include "material_fields.h"

namespace geocloth {
namespace {

/// In which fabrics each pixel is listed: a bit for each.
std::vector<uint32_t> listed_in(const ClothAsset& asset, std::span<const Fabric> fabrics) {
  std::vector<uint32_t> bits(asset.pixel_count(), 0);
  for (size_t f = 0; f < fabrics.size(); ++f)
    for (const uint32_t p : fabrics[f].pixels) bits[p] |= 1U << f;
  return bits;
}

uint32_t triangles_of(const ClothAsset& asset, uint32_t cell) {
  const uint8_t bits = asset.cell[cell];
  return ((bits & kCellFirst) != 0 ? 1U : 0U) + ((bits & kCellSecond) != 0 ? 1U : 0U);
}

/// The fabrics that list all corners of the triangles of a cell that has some.
uint32_t shared_by_corners(const ClothAsset& asset, uint32_t p0, std::span<const uint32_t> listed) {
  const uint8_t bits = asset.cell[p0];
  const uint32_t p1 = p0 + 1, p2 = p0 + asset.width, p3 = p2 + 1;
  const bool left = (bits & kCellDiagonalLeft) != 0;
  uint32_t shared = ~0U;
  if ((bits & kCellFirst) != 0) shared &= listed[p0] & listed[p2] & listed[left ? p1 : p3];
  if ((bits & kCellSecond) != 0) shared &= listed[p1] & listed[p3] & listed[left ? p2 : p0];
  return shared;
}

/// 0 for none, else one more than the number of the highest bit.
uint8_t last_of(uint32_t bits) {
  uint8_t last = 0;
  for (; bits != 0; bits >>= 1U) ++last;
  return last;
}

template <class Visit>
void for_cells(const ClothAsset& asset, const Visit& visit) {
  for (uint32_t y = 0; y + 1 < asset.height; ++y)
    for (uint32_t p = y * asset.width; p + 1 < (y + 1) * asset.width; ++p)
      if (triangles_of(asset, p) > 0) visit(p);
}

/// The cells about a pixel, as far as they are in the image.
class CellsAbout {
 public:
  CellsAbout(uint32_t pixel, uint32_t width) {
    const bool has_left = pixel % width > 0, has_up = pixel >= width;
    if (has_left && has_up) add(pixel - width - 1, true, true);
    if (has_up) add(pixel - width, false, true);
    if (has_left) add(pixel - 1, true, false);
    add(pixel, false, false);
  }
  [[nodiscard]] std::span<const uint32_t> all() const { return all_.seen(); }
  [[nodiscard]] std::span<const uint32_t> left() const { return left_.seen(); }
  [[nodiscard]] std::span<const uint32_t> right() const { return right_.seen(); }
  [[nodiscard]] std::span<const uint32_t> up() const { return up_.seen(); }
  [[nodiscard]] std::span<const uint32_t> down() const { return down_.seen(); }

 private:
  struct List {
    std::array<uint32_t, 4> cell{};
    size_t count = 0;
    void add(uint32_t c) { cell[count++] = c; }
    [[nodiscard]] std::span<const uint32_t> seen() const { return {cell.data(), count}; }
  };
  void add(uint32_t cell, bool is_left, bool is_up) {
    all_.add(cell);
    (is_left ? left_ : right_).add(cell);
    (is_up ? up_ : down_).add(cell);
  }

  List all_, left_, right_, up_, down_;
};

}  // namespace

FabricMap::FabricMap(const ClothDesc& cloth, const ClothAsset& uncut)
    : materials_{cloth.material}, width_(uncut.width) {
  if (cloth.fabrics.empty()) return;
  for (const Fabric& fabric : cloth.fabrics) materials_.push_back(fabric.material);
  if (std::ranges::any_of(materials_, [](const Material& m) { return m.bend_bias >= 0; })) {
    for (Material& m : materials_)
      if (m.bend_bias < 0) m.bend_bias = 0.25F * (m.bend_warp + m.bend_weft);
  }
  const std::vector<uint32_t> listed = listed_in(uncut, cloth.fabrics);
  cell_.assign(uncut.pixel_count(), 0);
  triangles_.assign(uncut.pixel_count(), 0);
  lone_.resize(uncut.pixel_count());
  std::ranges::transform(listed, lone_.begin(), last_of);
  for_cells(uncut, [&](uint32_t p) {
    cell_[p] = last_of(shared_by_corners(uncut, p, listed));
    triangles_[p] = static_cast<uint8_t>(triangles_of(uncut, p));
  });
}

/// By their triangles.
/// @param otherwise  number of the material where there are none
Material FabricMap::mean_of(std::span<const uint32_t> cells, uint32_t otherwise) const {
  std::array<uint32_t, kMostFabrics + 1> triangles{};
  uint32_t all = 0;
  for (const uint32_t cell : cells) {
    triangles[cell_[cell]] += triangles_[cell];
    all += triangles_[cell];
  }
  if (all == 0) return materials_[otherwise];
  const auto most = static_cast<size_t>(std::ranges::max_element(triangles) - triangles.begin());
  Material mean = materials_[most];
  if (triangles[most] == all) return mean;
  for (const MaterialField& field : kMaterialFields) {
    if (field.use != MaterialUse::fabric) continue;
    double sum = 0;
    for (size_t m = 0; m < materials_.size(); ++m) sum += triangles[m] * double{materials_[m].*field.value};
    mean.*field.value = static_cast<float>(sum / all);
  }
  return mean;
}

Material FabricMap::at(uint32_t pixel) const {
  if (cell_.empty()) return materials_.front();
  const CellsAbout cells(pixel, width_);
  return mean_of(cells.all(), lone_[pixel]);
}

Material FabricMap::bending_at(uint32_t pixel) const {
  if (cell_.empty()) return materials_.front();
  const CellsAbout cells(pixel, width_);
  Material bending = mean_of(cells.all(), lone_[pixel]);
  const auto number = static_cast<uint32_t>(std::ranges::find(materials_, bending) -
                                            materials_.begin());  // of what is about the pixel, if that is one
  if (number < materials_.size()) return bending;
  const auto side = [&](std::span<const uint32_t> of) { return mean_of(of, lone_[pixel]); };
  const Material left = side(cells.left()), right = side(cells.right()), up = side(cells.up()),
                 down = side(cells.down());
  bending.bend_weft = static_cast<float>(rigidity_between(left.bend_weft, right.bend_weft));
  bending.bend_warp = static_cast<float>(rigidity_between(up.bend_warp, down.bend_warp));
  if (has_bias()) {
    bending.bend_bias = static_cast<float>(
        std::min(rigidity_between(left.bend_bias, right.bend_bias), rigidity_between(up.bend_bias, down.bend_bias)));
  }
  return bending;
}

double FabricMap::rigidity_between(double a, double b) const {
  if (a == b) return a;
  return materials_.size() > 1 ? 2 * a * b / (a + b) : 0.5 * (a + b);
}

float FabricMap::stiffest() const {
  float rigidity = 0;
  for (const Material& m : materials_) rigidity = std::max(rigidity, stiffest_bend(m));
  return rigidity;
}

float stiffest_bend(const Material& material) {
  return std::max({material.bend_warp, material.bend_weft, material.bend_bias});
}

bool has_cell(const ClothAsset& asset, std::span<const uint32_t> pixels) {
  const std::array<Fabric, 1> only{Fabric{{pixels.begin(), pixels.end()}, {}}};
  const std::vector<uint32_t> listed = listed_in(asset, only);
  bool found = false;
  for_cells(asset, [&](uint32_t p) { found = found || shared_by_corners(asset, p, listed) != 0; });
  return found;
}

Material FabricMap::weakest() const {
  std::array<bool, kMostFabrics + 1> has_cells{};
  for (size_t p = 0; p < cell_.size(); ++p)
    if (triangles_[p] > 0) has_cells[cell_[p]] = true;
  Material weakest = materials_.front();
  bool is_first = true;
  for (size_t m = 0; m < materials_.size(); ++m) {
    if (!has_cells[m]) continue;
    const Material& other = materials_[m];
    weakest.areal_density = is_first ? other.areal_density : std::max(weakest.areal_density, other.areal_density);
    weakest.stretch_warp = is_first ? other.stretch_warp : std::min(weakest.stretch_warp, other.stretch_warp);
    weakest.stretch_weft = is_first ? other.stretch_weft : std::min(weakest.stretch_weft, other.stretch_weft);
    is_first = false;
  }
  return weakest;
}

}  // namespace geocloth
