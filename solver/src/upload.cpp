// SPDX-License-Identifier: Apache-2.0
// From an asset and a material in physical units to particles and springs.
//
// Masses: a pixel's own share of area x density, so that a copy carries the cloth of its side. Springs: k = K w / L
// (force per strain, width w, length L), with the width from the triangles on the spring's own side: a spring on a seam
// exists once for each copy and the copies' stiffnesses add up. How the moduli of a sheet come out of springs is told
// at each.

#include "upload.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace geocloth {
namespace {

/// A distance spring over two pixels resists bending only to fourth order: chord error L angle^2 / 8. Its stiffness is
/// set so that its energy is that of a plate bent by this angle [rad] between neighbouring springs.
constexpr double kBendAngle = 0.5;
/// Areas below this share of the mean are raised to it: a sliver at an outline would be a particle without mass.
constexpr double kSmallestAreaShare = 1e-3;
/// Share of the wanted modulus that structural springs keep at least after others' contributions are taken off.
constexpr double kSmallestModulusShare = 0.05;

/// Structural moduli [N/m] such that the lattice as a whole has the material's. Two diagonals with the shear modulus G
/// add G (e_u + e_v)^2 / 2 to the energy: pulled along v and free across, K_v + G K_u / (K_u + G) resists.
struct Moduli {
  double warp, weft, shear;
};
Moduli lattice_moduli(const Material& m) {
  double warp = m.stretch_warp, weft = m.stretch_weft;
  const double g = m.shear;
  for (int i = 0; i < 200; ++i) {
    const double next_warp = m.stretch_warp - g * weft / (weft + g);
    const double next_weft = m.stretch_weft - g * warp / (warp + g);
    warp = std::max(0.5 * (warp + next_warp), kSmallestModulusShare * m.stretch_warp);
    weft = std::max(0.5 * (weft + next_weft), kSmallestModulusShare * m.stretch_weft);
  }
  return {warp, weft, g};
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * static_cast<double>(length(cross(b - a, c - a)));
}

/// The rest shape, scaled, with the areas that belong to springs.
class RestShape {
 public:
  RestShape(const ClothAsset& asset, float scale) : asset_(asset), scale_(scale), cell_area_(asset.pixel_count()) {
    for (uint32_t y = 0; y + 1 < asset.height; ++y)
      for (uint32_t x = 0; x + 1 < asset.width; ++x) cell_area_[pixel(x, y)] = areas_of_cell(x, y);
  }

  [[nodiscard]] double rest_length(uint32_t a, uint32_t b) const {
    return static_cast<double>(scale_) * static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
  }

  /// [m] perpendicular to a structural or shear spring: area of the triangles that it belongs to / its length. Every
  /// triangle has one side of each structural direction, so each direction's widths x lengths cover the surface once.
  [[nodiscard]] double width(uint32_t component, uint32_t x, uint32_t y, double rest) const {
    double area = 0;
    switch (component) {
      case 0:  // right: in the cell below it is the upper side, in the cell above the lower one
        area = cell(x, y)[diagonal_left(x, y) ? 0 : 1] + cell(x, y - 1)[diagonal_left(x, y - 1) ? 1 : 0];
        break;
      case 1:  // down: left side of the cell to its right, right side of the cell to its left
        area = cell(x, y)[0] + cell(x - 1, y)[1];
        break;
      case 2:
        area = cell(x, y)[0] + cell(x, y)[1];
        break;
      default:
        area = cell(x - 1, y)[0] + cell(x - 1, y)[1];
    }
    if (area > 0) return area / rest;
    return 0.25 * pixel_area(pixel(x, y)) / rest;  // a spring without a triangle: a thin tongue of cloth
  }

  [[nodiscard]] double pixel_area(uint32_t p) const {
    return static_cast<double>(asset_.area[p]) * static_cast<double>(scale_) * static_cast<double>(scale_);
  }

 private:
  using CellArea = std::array<double, 2>;  ///< first and second triangle

  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }
  [[nodiscard]] bool inside(uint32_t x, uint32_t y) const { return x < asset_.width && y < asset_.height; }
  /// x - 1 and y - 1 wrap to huge numbers at 0, which are outside.
  [[nodiscard]] CellArea cell(uint32_t x, uint32_t y) const {
    return inside(x, y) ? cell_area_[pixel(x, y)] : CellArea{};
  }
  [[nodiscard]] bool diagonal_left(uint32_t x, uint32_t y) const {
    return inside(x, y) && (asset_.cell[pixel(x, y)] & kCellDiagonalLeft) != 0;
  }

  [[nodiscard]] CellArea areas_of_cell(uint32_t x, uint32_t y) const {
    const uint8_t bits = asset_.cell[pixel(x, y)];
    const auto& p = asset_.rest_position;
    const Vec3 &p0 = p[pixel(x, y)], &p1 = p[pixel(x + 1, y)], &p2 = p[pixel(x, y + 1)], &p3 = p[pixel(x + 1, y + 1)];
    const bool left = (bits & kCellDiagonalLeft) != 0;
    const double s = static_cast<double>(scale_) * static_cast<double>(scale_);
    CellArea area{};
    if (bits & kCellFirst) area[0] = s * (left ? triangle_area(p0, p2, p1) : triangle_area(p0, p2, p3));
    if (bits & kCellSecond) area[1] = s * (left ? triangle_area(p1, p2, p3) : triangle_area(p0, p3, p1));
    return area;
  }

  const ClothAsset& asset_;
  float scale_;
  std::vector<CellArea> cell_area_;
};

/// [N/m] of a spring over two pixels with the half length h that stands for a plate of the rigidity B and the width w:
/// B angle^2 / 2 x w / h = k (h angle^2 / 4)^2 / 2 at angle = kBendAngle.
double bending_stiffness(double rigidity, double width, double half_length) {
  return 16 * rigidity * width / (kBendAngle * kBendAngle * half_length * half_length * half_length);
}
/// [N/m] what these springs add to the modulus of stretch: two of them cross every section, 4 k h / w.
double bending_modulus(double rigidity, double half_length) {
  return 64 * rigidity / (kBendAngle * kBendAngle * half_length * half_length);
}

/// Springs of one cloth, in the components' order.
class SpringBuilder {
 public:
  SpringBuilder(const ClothDesc& cloth, ClothData& data)
      : asset_(*cloth.asset),
        material_(cloth.material),
        moduli_(lattice_moduli(cloth.material)),
        scale_(cloth.transform.scale),
        rest_(asset_, scale_),
        data_(data) {}

  void build() {
    for (auto& family : data_.springs) family.assign(asset_.pixel_count(), {0, 0, 0, 0});
    for (uint32_t y = 0; y < asset_.height; ++y)
      for (uint32_t x = 0; x < asset_.width; ++x)
        for (uint32_t c = 0; c < kSpringCount; ++c)
          if (asset_.spring_mask[pixel(x, y)] & (1U << c)) add_spring(c, x, y);
    add_seam_bends();
  }

 private:
  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }
  [[nodiscard]] static bool is_warp(uint32_t component) { return component == 1 || component == 5; }
  [[nodiscard]] double rigidity(bool warp) const { return warp ? material_.bend_warp : material_.bend_weft; }

  void add_spring(uint32_t c, uint32_t x, uint32_t y) {
    const uint32_t a = pixel(x, y);
    const auto b = static_cast<uint32_t>(static_cast<int64_t>(a) + kSpringOffset[c][0] +
                                         static_cast<int64_t>(asset_.width) * kSpringOffset[c][1]);
    const double rest = rest_.rest_length(a, b);
    if (!(rest > 0)) return;
    const double stiffness = c < 4 ? membrane_stiffness(c, x, y, rest) : bending_stiffness_at(c, x, y, rest);
    const bool by_share = c < 4 ? material_.stiffness >= 0 : material_.bend_stiffness >= 0;
    if (!by_share && !(stiffness > 0)) return;
    const auto compliance = by_share ? 0.F : to_compliance(stiffness);
    shader::vec4& entry = data_.springs[c / 2][a];
    (c % 2 == 0 ? entry.x : entry.z) = static_cast<float>(rest);
    (c % 2 == 0 ? entry.y : entry.w) = compliance;
    data_.bending = data_.bending || c >= 4;
    ++data_.springs_per_sweep;
  }

  [[nodiscard]] double membrane_stiffness(uint32_t c, uint32_t x, uint32_t y, double rest) const {
    const double width = rest_.width(c, x, y, rest);
    // Shear by gamma lengthens the diagonal of a square by gamma L / 2: two diagonals with 2 G w / L make up G.
    if (c >= 2) return 2 * moduli_.shear * width / rest;
    const double wanted = is_warp(c) ? moduli_.warp : moduli_.weft;
    const double from_bending = material_.bend_stiffness >= 0 ? 0 : bending_modulus(rigidity(is_warp(c)), rest);
    return std::max(wanted - from_bending, kSmallestModulusShare * wanted) * width / rest;
  }

  [[nodiscard]] double bending_stiffness_at(uint32_t c, uint32_t x, uint32_t y, double rest) const {
    const uint32_t structural = c - 4;
    const uint32_t x1 = x + static_cast<uint32_t>(kSpringOffset[structural][0]);
    const uint32_t y1 = y + static_cast<uint32_t>(kSpringOffset[structural][1]);
    const double half = 0.5 * rest;
    const double width = 0.5 * (rest_.width(structural, x, y, half) + rest_.width(structural, x1, y1, half));
    return bending_stiffness(rigidity(is_warp(c)), width, half);
  }

  [[nodiscard]] static float to_compliance(double stiffness) {
    return static_cast<float>(std::min(1 / stiffness, static_cast<double>(std::numeric_limits<float>::max())));
  }

  /// Bends over a seam, coloured so that springs of one colour share no pixel: each takes the lowest free colour in
  /// order.
  void add_seam_bends() {
    std::vector<std::vector<uint32_t>> colors_at(asset_.pixel_count());
    std::vector<std::vector<shader::SeamSpring>> by_color;
    for (const SeamBend& bend : asset_.seam_bends) {
      const double rest = static_cast<double>(bend.rest_length) * static_cast<double>(scale_);
      if (!(rest > 0) || bend.a == bend.b) continue;
      const double half = 0.5 * rest;
      const double width = 0.5 * (rest_.pixel_area(bend.a) + rest_.pixel_area(bend.b)) / half;
      const double stiffness = bending_stiffness(0.5 * (rigidity(true) + rigidity(false)), width, half);
      const bool by_share = material_.bend_stiffness >= 0;
      if (!by_share && !(stiffness > 0)) continue;
      const uint32_t color = free_color(colors_at[bend.a], colors_at[bend.b]);
      if (color == by_color.size()) by_color.emplace_back();
      by_color[color].push_back({bend.a, bend.b, static_cast<float>(rest), by_share ? 0.F : to_compliance(stiffness)});
      colors_at[bend.a].push_back(color);
      colors_at[bend.b].push_back(color);
    }
    if (by_color.empty()) return;
    data_.seam_color_offset.push_back(0);
    for (const auto& springs : by_color) {
      data_.seam_bends.insert(data_.seam_bends.end(), springs.begin(), springs.end());
      data_.seam_color_offset.push_back(static_cast<uint32_t>(data_.seam_bends.size()));
    }
    data_.springs_per_sweep += data_.seam_bends.size();
    data_.bending = true;
  }

  static uint32_t free_color(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
    uint32_t color = 0;
    const auto used = [&](const std::vector<uint32_t>& list) {
      return std::find(list.begin(), list.end(), color) != list.end();
    };
    while (used(a) || used(b)) ++color;
    return color;
  }

  const ClothAsset& asset_;
  const Material& material_;
  Moduli moduli_;
  float scale_;
  RestShape rest_;
  ClothData& data_;
};

/// Neighbours for distances along the surface: grid edges, diagonals and knight's moves, within the springs' validity.
class SurfaceGraph {
 public:
  SurfaceGraph(const ClothAsset& asset, float scale)
      : asset_(asset), scale_(scale), row_of_(asset.pixel_count(), kNoPixel) {
    for (uint32_t r = 0; r < asset.splits.rows(); ++r)
      for (uint32_t k = asset.splits.offset[r]; k < asset.splits.offset[r + 1]; ++k) row_of_[asset.splits.pixel[k]] = r;
  }

  /// Calls visit(neighbour, length) for all neighbours of a pixel.
  template <class Visit>
  void for_neighbors(uint32_t p, const Visit& visit) const {
    if (const uint32_t row = row_of_[p]; row != kNoPixel) {
      for (uint32_t k = asset_.splits.offset[row]; k < asset_.splits.offset[row + 1]; ++k)
        if (asset_.splits.pixel[k] != p) visit(asset_.splits.pixel[k], 0.0);
    }
    for (int32_t dy = -1; dy <= 1; ++dy)
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const uint32_t near = step(p, dx, dy);
        if (near == kNoPixel || near == p) continue;
        visit(near, distance(p, near));
        if (dx == 0 || dy == 0) continue;
        for (const auto& [ex, ey] :
             {std::pair{dx, 0}, std::pair{0, dy}})  // diagonal, then straight on: a knight's move
          if (const uint32_t far = step(near, ex, ey); far != kNoPixel) visit(far, distance(p, far));
      }
  }

 private:
  /// The pixel one king's move away if a spring leads there.
  [[nodiscard]] uint32_t step(uint32_t p, int32_t dx, int32_t dy) const {
    if (dx == 0 && dy == 0) return p;
    const int64_t x = static_cast<int64_t>(p % asset_.width) + dx, y = static_cast<int64_t>(p / asset_.width) + dy;
    if (x < 0 || y < 0 || x >= asset_.width || y >= asset_.height) return kNoPixel;
    const auto q = static_cast<uint32_t>(y * asset_.width + x);
    const bool forward = dy > 0 || (dy == 0 && dx > 0);
    const int32_t fx = forward ? dx : -dx, fy = forward ? dy : -dy;
    const uint8_t bit = fy == 0 ? kSpringRight : fx == 0 ? kSpringDown : fx > 0 ? kSpringDownRight : kSpringDownLeft;
    return asset_.spring_mask[forward ? p : q] & bit ? q : kNoPixel;
  }

  [[nodiscard]] double distance(uint32_t a, uint32_t b) const {
    return static_cast<double>(scale_) * static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
  }

  const ClothAsset& asset_;
  float scale_;
  std::vector<uint32_t> row_of_;
};

std::vector<shader::vec4> start_positions(const ClothDesc& cloth, const Vec3& origin) {
  const ClothAsset& asset = *cloth.asset;
  const double scale = cloth.transform.scale;
  double total = 0;
  for (const float a : asset.area) total += static_cast<double>(a);
  const double smallest = kSmallestAreaShare * total / std::max(1U, count_valid_pixels(asset));
  std::vector<shader::vec4> position(asset.pixel_count(), {0, 0, 0, 0});
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    const Vec3 x = apply(cloth.transform, asset.rest_position[p]) - origin;
    const double area = std::max(static_cast<double>(asset.area[p]), smallest) * scale * scale;
    position[p] = {x.x, x.y, x.z, static_cast<float>(1 / (area * static_cast<double>(cloth.material.areal_density)))};
  }
  return position;
}

}  // namespace

ClothData make_cloth_data(const ClothDesc& cloth, const Vec3& origin) {
  const ClothAsset& asset = *cloth.asset;
  ClothData data;
  data.width = asset.width;
  data.height = asset.height;
  data.position = start_positions(cloth, origin);
  SpringBuilder(cloth, data).build();
  data.cell.assign(asset.cell.begin(), asset.cell.end());
  data.split_offset = asset.splits.offset;
  data.split_pixel = asset.splits.pixel;
  data.attachments = cloth.material.max_stretch > 0;
  return data;
}

Vec3 choose_origin(std::span<const ClothDesc> cloths) {
  constexpr float kGrid = 4;  // [m]
  Vec3 low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  Vec3 high = -low;
  for (const ClothDesc& cloth : cloths) {
    for (uint32_t p = 0; p < cloth.asset->pixel_count(); ++p) {
      if (!cloth.asset->valid(p)) continue;
      const Vec3 x = apply(cloth.transform, cloth.asset->rest_position[p]);
      low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
      high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
    }
  }
  if (low.x > high.x) return {};
  const auto middle = [&](float a, float b) { return kGrid * std::round((0.5F * a + 0.5F * b) / kGrid) + 0.F; };
  return {middle(low.x, high.x), middle(low.y, high.y), middle(low.z, high.z)};
}

std::vector<shader::Attachment> make_attachments(const ClothAsset& asset, float scale,
                                                 std::span<const uint32_t> pinned) {
  const SurfaceGraph graph(asset, scale);
  std::vector<double> distance(asset.pixel_count(), std::numeric_limits<double>::infinity());
  std::vector<uint32_t> anchor(asset.pixel_count(), shader::kNoAnchor);
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const uint32_t p : pinned) {
    distance[p] = 0;
    anchor[p] = p;
    queue.emplace(0.0, p);
  }
  while (!queue.empty()) {
    const auto [d, p] = queue.top();
    queue.pop();
    if (d > distance[p]) continue;
    graph.for_neighbors(p, [&, from = d, pixel = p](uint32_t q, double step) {
      if (from + step >= distance[q]) return;
      distance[q] = from + step;
      anchor[q] = anchor[pixel];
      queue.emplace(distance[q], q);
    });
  }
  std::vector<shader::Attachment> attachments(asset.pixel_count(), {shader::kNoAnchor, 0});
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (distance[p] > 0 && anchor[p] != shader::kNoAnchor)
      attachments[p] = {anchor[p], static_cast<float>(distance[p])};
  return attachments;
}

}  // namespace geocloth
