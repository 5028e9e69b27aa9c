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

/// Share of a direction's modulus that shear springs may take over at most.
constexpr double kLargestShearShare = 0.5;

/// The springs of one cell, so that the lattice has the material's moduli. With the sides a (weft) and b (warp),
/// strains e_u, e_v and the shear gamma, two diagonals with k = G L^2 / (2 a b) have the energy per area
///   G ((e_u a/b + e_v b/a)^2 + gamma^2) / 2,
/// that is the shear modulus G, and moduli C_u = G a^2/b^2, C_v = G b^2/a^2 with the coupling G on top of the
/// structural springs'. Pulled along one direction and free across, K_v + C_v - G^2 / (K_u + C_u) must be the
/// material's modulus.
struct CellModuli {
  double warp = 0, weft = 0;  ///< [N/m] of the structural springs
  double diagonal = 0;        ///< [N/m^3] stiffness of a diagonal / its length squared
};
CellModuli cell_moduli(const Material& m, double a, double b) {
  const double ratio = std::clamp(a / b, 1e-3, 1e3);
  const double r2 = ratio * ratio;
  const double wanted_warp = m.stretch_warp, wanted_weft = m.stretch_weft;
  const double g =
      std::min(static_cast<double>(m.shear), kLargestShearShare * std::min(wanted_weft / r2, wanted_warp * r2));
  CellModuli c{wanted_warp, wanted_weft, g / (2 * a * b)};
  for (int i = 0; i < 20; ++i) {
    c.warp = wanted_warp - g / r2 + g * g / (c.weft + g * r2);
    c.weft = wanted_weft - g * r2 + g * g / (c.warp + g / r2);
  }
  return c;
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * static_cast<double>(length(cross(b - a, c - a)));
}

/// [N/m] of a spring over two pixels with the half length h that stands for a plate of the rigidity B and the width w:
/// B angle^2 / 2 x w / h = k (h angle^2 / 4)^2 / 2 at angle = kBendAngle.
double bending_stiffness(double rigidity, double width, double half_length) {
  return 16 * rigidity * width / (kBendAngle * kBendAngle * half_length * half_length * half_length);
}
/// [N/m] what these springs add to the modulus of stretch: two of them cross every section, 4 k h / w.
double bending_modulus(double rigidity, double half_length) {
  return 64 * rigidity / (kBendAngle * kBendAngle * half_length * half_length);
}

/// One cell of the rest shape.
struct RestCell {
  std::array<double, 2> area{};  ///< [m^2] first and second triangle
  CellModuli moduli;
  [[nodiscard]] double triangles() const { return (area[0] > 0 ? 0.5 : 0) + (area[1] > 0 ? 0.5 : 0); }  ///< of two
};

/// The rest shape, scaled, and what each cell gives to the springs around it. Every triangle has one side of each
/// structural direction, so each direction's springs cover the surface once.
class RestShape {
 public:
  RestShape(const ClothAsset& asset, float scale, const Material& material)
      : asset_(asset), scale_(scale), material_(material), cells_(asset.pixel_count()) {
    for (uint32_t y = 0; y + 1 < asset.height; ++y)
      for (uint32_t x = 0; x + 1 < asset.width; ++x)
        if (asset.cell[pixel(x, y)] & (kCellFirst | kCellSecond)) cells_[pixel(x, y)] = make_cell(x, y);
  }

  [[nodiscard]] double rest_length(uint32_t a, uint32_t b) const {
    return static_cast<double>(scale_) * static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
  }

  /// [m] perpendicular to a structural spring: area of the triangles that it is a side of / its length.
  [[nodiscard]] double width(uint32_t component, uint32_t x, uint32_t y, double rest) const {
    double area = 0;
    for_triangles(component, x, y, [&](const RestCell& c, size_t triangle) { area += c.area[triangle]; });
    return (area > 0 ? area : lone_area(x, y)) / rest;
  }

  /// [N/m] of a structural spring: K w / L, with K and w from its triangles.
  [[nodiscard]] double structural_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const {
    const bool warp = component == 1;
    double sum = 0;
    for_triangles(component, x, y, [&](const RestCell& c, size_t triangle) {
      const double from_bending = material_.bend_stiffness >= 0 ? 0 : bending_modulus(rigidity(warp), rest);
      const double wanted = warp ? c.moduli.warp : c.moduli.weft;
      sum += c.area[triangle] * std::max(wanted - from_bending, kSmallestModulusShare * wanted);
    });
    if (!(sum > 0)) sum = lone_area(x, y) * static_cast<double>(warp ? material_.stretch_warp : material_.stretch_weft);
    return sum / (rest * rest);
  }

  /// [N/m] of a diagonal from (x, y), component 2 (down-right) or 3 (down-left).
  [[nodiscard]] double diagonal_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const {
    const RestCell c = cell(component == 2 ? x : x - 1, y);
    if (c.triangles() > 0) return c.triangles() * c.moduli.diagonal * rest * rest;
    return static_cast<double>(material_.shear) * lone_area(x, y) / (rest * rest);
  }

  [[nodiscard]] double pixel_area(uint32_t p) const {
    return static_cast<double>(asset_.area[p]) * static_cast<double>(scale_) * static_cast<double>(scale_);
  }
  [[nodiscard]] double rigidity(bool warp) const { return warp ? material_.bend_warp : material_.bend_weft; }

 private:
  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }
  [[nodiscard]] bool inside(uint32_t x, uint32_t y) const { return x < asset_.width && y < asset_.height; }
  /// x - 1 and y - 1 wrap to huge numbers at 0, which are outside.
  [[nodiscard]] RestCell cell(uint32_t x, uint32_t y) const { return inside(x, y) ? cells_[pixel(x, y)] : RestCell{}; }
  [[nodiscard]] bool diagonal_left(uint32_t x, uint32_t y) const {
    return inside(x, y) && (asset_.cell[pixel(x, y)] & kCellDiagonalLeft) != 0;
  }
  /// A spring without a triangle is a thin tongue of cloth.
  [[nodiscard]] double lone_area(uint32_t x, uint32_t y) const { return 0.25 * pixel_area(pixel(x, y)); }

  /// Calls visit(cell, triangle) for the triangles that have the structural spring from (x, y) as a side.
  template <class Visit>
  void for_triangles(uint32_t component, uint32_t x, uint32_t y, const Visit& visit) const {
    if (component == 0) {  // upper side of the cell below, lower side of the cell above
      visit(cell(x, y), size_t{diagonal_left(x, y) ? 0U : 1U});
      visit(cell(x, y - 1), size_t{diagonal_left(x, y - 1) ? 1U : 0U});
    } else {  // left side of the cell to the right, right side of the cell to the left
      visit(cell(x, y), size_t{0});
      visit(cell(x - 1, y), size_t{1});
    }
  }

  [[nodiscard]] RestCell make_cell(uint32_t x, uint32_t y) const {
    const uint8_t bits = asset_.cell[pixel(x, y)];
    const auto& p = asset_.rest_position;
    const Vec3 &p0 = p[pixel(x, y)], &p1 = p[pixel(x + 1, y)], &p2 = p[pixel(x, y + 1)], &p3 = p[pixel(x + 1, y + 1)];
    const bool left = (bits & kCellDiagonalLeft) != 0;
    const double s = static_cast<double>(scale_);
    RestCell c;
    if (bits & kCellFirst) c.area[0] = s * s * (left ? triangle_area(p0, p2, p1) : triangle_area(p0, p2, p3));
    if (bits & kCellSecond) c.area[1] = s * s * (left ? triangle_area(p1, p2, p3) : triangle_area(p0, p3, p1));
    // A cell with one triangle has only that triangle's sides.
    const double upper = length(p1 - p0), lower = length(p3 - p2), west = length(p2 - p0), east = length(p3 - p1);
    const bool first = c.area[0] > 0, second = c.area[1] > 0;
    const double a = first && second ? 0.5 * (upper + lower) : first == left ? upper : lower;
    const double b = first && second ? 0.5 * (west + east) : first ? west : east;
    if (a > 0 && b > 0) c.moduli = cell_moduli(material_, s * a, s * b);
    return c;
  }

  const ClothAsset& asset_;
  float scale_;
  const Material& material_;
  std::vector<RestCell> cells_;
};

/// Springs of one cloth, in the components' order.
class SpringBuilder {
 public:
  SpringBuilder(const ClothDesc& cloth, ClothData& data)
      : asset_(*cloth.asset),
        material_(cloth.material),
        scale_(cloth.transform.scale),
        rest_(asset_, scale_, material_),
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
    return c < 2 ? rest_.structural_stiffness(c, x, y, rest) : rest_.diagonal_stiffness(c, x, y, rest);
  }

  [[nodiscard]] double bending_stiffness_at(uint32_t c, uint32_t x, uint32_t y, double rest) const {
    const uint32_t structural = c - 4;
    const uint32_t x1 = x + static_cast<uint32_t>(kSpringOffset[structural][0]);
    const uint32_t y1 = y + static_cast<uint32_t>(kSpringOffset[structural][1]);
    const double half = 0.5 * rest;
    const double width = 0.5 * (rest_.width(structural, x, y, half) + rest_.width(structural, x1, y1, half));
    return bending_stiffness(rest_.rigidity(is_warp(c)), width, half);
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
      const double stiffness = bending_stiffness(0.5 * (rest_.rigidity(true) + rest_.rigidity(false)), width, half);
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
