// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/drape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/convert.h"

namespace geocloth::test {
namespace {

constexpr double kDisc = 0.15, kSupport = 0.09;  ///< [m] radii

/// A disc in the xz plane: rings of triangles.
TriangleMesh make_disc() {
  constexpr uint32_t kRings = 16, kAround = 96;
  TriangleMesh mesh;
  mesh.name = "disc";
  mesh.position.push_back({0, 0, 0});
  const auto vertex = [](uint32_t ring, uint32_t k) { return ring == 0 ? 0 : 1 + (ring - 1) * kAround + k % kAround; };
  for (uint32_t ring = 1; ring <= kRings; ++ring) {
    for (uint32_t k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround, radius = kDisc * ring / kRings;
      mesh.position.push_back({radius * std::cos(angle), 0, radius * std::sin(angle)});
      mesh.triangle.push_back({vertex(ring - 1, k), vertex(ring, k + 1), vertex(ring, k)});
      if (ring > 1) mesh.triangle.push_back({vertex(ring - 1, k), vertex(ring - 1, k + 1), vertex(ring, k + 1)});
    }
  }
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
  mesh.part.push_back({"disc", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  mesh.material.emplace_back();
  return mesh;
}

/// What is dark under the draped cloth, in cells of half a millimetre.
struct Shadow {
  static constexpr int kCells = 640;
  static constexpr double kCell = 0.0005;  ///< [m]
  static constexpr double kMiddle = 0.5 * kCells;
  std::vector<bool> dark = std::vector<bool>(size_t{kCells} * kCells);
  [[nodiscard]] static size_t cell(int i, int j) { return static_cast<size_t>(j) * kCells + static_cast<size_t>(i); }
};

void darken(Shadow& shadow, const std::array<Vec3, 3>& corner) {
  constexpr int kCells = Shadow::kCells;
  std::array<double, 3> px{}, pz{};
  for (size_t k = 0; k < 3; ++k) {
    px[k] = static_cast<double>(corner[k].x) / Shadow::kCell + Shadow::kMiddle;
    pz[k] = static_cast<double>(corner[k].z) / Shadow::kCell + Shadow::kMiddle;
  }
  const double d = (px[1] - px[0]) * (pz[2] - pz[0]) - (px[2] - px[0]) * (pz[1] - pz[0]);
  if (d == 0) return;
  const auto low = [](const auto& p) { return std::max(0, static_cast<int>(*std::ranges::min_element(p))); };
  const auto high = [](const auto& p) { return std::min(kCells - 1, static_cast<int>(*std::ranges::max_element(p))); };
  for (int j = low(pz); j <= high(pz); ++j)
    for (int i = low(px); i <= high(px); ++i) {
      const double u = ((px[1] - i) * (pz[2] - j) - (px[2] - i) * (pz[1] - j)) / d;
      const double v = ((px[2] - i) * (pz[0] - j) - (px[0] - i) * (pz[2] - j)) / d;
      if (u >= 0 && v >= 0 && u + v <= 1) shadow.dark[Shadow::cell(i, j)] = true;
    }
}

Drape measure(const ClothAsset& asset, const std::vector<Vec3>& x) {
  Shadow shadow;
  for (const Triangle& t : pixel_triangles(asset)) darken(shadow, {x[t[0]], x[t[1]], x[t[2]]});
  Drape result;
  double count = 0;
  for (int j = 0; j < Shadow::kCells; ++j)
    for (int i = 0; i < Shadow::kCells; ++i) {
      if (!shadow.dark[Shadow::cell(i, j)]) continue;
      const std::array at{(i - Shadow::kMiddle) * Shadow::kCell, (j - Shadow::kMiddle) * Shadow::kCell};
      for (size_t k = 0; k < 2; ++k) {
        result.center[k] += at[k];
        result.extent[k] += at[k] * at[k];
      }
      ++count;
    }
  for (size_t k = 0; k < 2; ++k) {
    result.center[k] /= count;
    result.extent[k] /= count;
  }
  const auto circle = [](double radius) { return std::numbers::pi * radius * radius; };
  result.coefficient =
      100 * (count * Shadow::kCell * Shadow::kCell - circle(kSupport)) / (circle(kDisc) - circle(kSupport));
  return result;
}

/// Height [m] of the small waves that the ring starts with.
double wave(double x, double z, double turn) {
  constexpr double kHeight = 0.0002;
  const double angle = std::atan2(z, x) - turn, out = std::max(0.0, (std::hypot(x, z) - kSupport) / (kDisc - kSupport));
  double sum = 0;
  for (int k = 2; k <= 8; ++k) sum += std::cos(k * angle + 1.7 * k * k);
  return kHeight * out * sum;
}

/// On the support the specimen is held as under Cusick's upper disc. Cloth is clamped at the last pinned pixel, which
/// is on average half a spacing inside the radius below which pixels are pinned.
Draped hang(const std::shared_ptr<const ClothAsset>& specimen, std::vector<Vec3> start, Material material,
            const DrapeEffort& effort, const MakeSolver& make) {
  material.damping = effort.damping;
  SolverSettings settings;
  settings.substeps = effort.substeps;
  settings.relaxation_steps = effort.relaxation_steps;
  const ClothDesc cloth{specimen, material, {}};
  Solver solver = make({&cloth, 1}, settings);

  const double held = kSupport + 0.5 * static_cast<double>(specimen->spacing);
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < specimen->pixel_count(); ++p) {
    const Vec3 rest = specimen->rest_position[p];
    if (!specimen->valid(p) || std::hypot(static_cast<double>(rest.x), static_cast<double>(rest.z)) > held) continue;
    pins.push_back({p, rest});
    start[p] = rest;
  }
  solver.write_state(0, start, std::vector<Vec3>(start.size()));
  solver.set_pins(0, pins);
  for (uint32_t frame = 0; frame < effort.frames; ++frame) solver.step();
  Draped result{specimen, {}};
  solver.read_positions(0, result.position);
  return result;
}

/// Weights of the corners of a triangle at a point, seen from above.
std::array<double, 3> weights_at(const std::array<Vec3, 3>& corner, Vec3 p) {
  const auto area = [](Vec3 a, Vec3 b, Vec3 c) {
    return static_cast<double>((b.x - a.x) * (c.z - a.z) - (c.x - a.x) * (b.z - a.z));
  };
  const double whole = area(corner[0], corner[1], corner[2]);
  return {area(p, corner[1], corner[2]) / whole, area(corner[0], p, corner[2]) / whole,
          area(corner[0], corner[1], p) / whole};
}

/// Where the pixels of a finer grid are on the triangles of a coarser one at rest, as those hang. A pixel beyond the
/// coarser outline is on the plane of the triangle that it is least far out of.
std::vector<Vec3> on_grid(const Draped& coarse, const ClothAsset& fine) {
  const std::vector<Vec3>& rest = coarse.specimen->rest_position;
  const std::vector<Triangle> triangles = pixel_triangles(*coarse.specimen);
  std::vector<Vec3> result = fine.rest_position;
  size_t last = 0;  // pixels in a row are on triangles that are near in order
  for (uint32_t p = 0; p < fine.pixel_count(); ++p) {
    if (!fine.valid(p)) continue;
    double innermost = -1e30;
    const size_t first = last;
    for (size_t k = 0; k < triangles.size() && innermost < 0; ++k) {
      const size_t at = (first + k) % triangles.size();
      const Triangle& t = triangles[at];
      const auto w = weights_at({rest[t[0]], rest[t[1]], rest[t[2]]}, fine.rest_position[p]);
      const double inside = std::min({w[0], w[1], w[2]});
      if (!(inside > innermost)) continue;
      innermost = inside;
      last = at;
      result[p] = coarse.position[t[0]] * static_cast<float>(w[0]) + coarse.position[t[1]] * static_cast<float>(w[1]) +
                  coarse.position[t[2]] * static_cast<float>(w[2]);
    }
  }
  return result;
}

}  // namespace

std::shared_ptr<const ClothAsset> make_specimen(uint32_t resolution, Layout layout) {
  ConvertOptions options;
  options.flatten.resolution = resolution;
  options.flatten.layout = layout;
  return std::make_shared<const ClothAsset>(convert(make_disc(), options).asset);
}

Material soft_sheet(double bend_warp, double bend_weft, double bend_bias) {
  Material material;
  material.stretch_warp = material.stretch_weft = 50;
  material.shear = 25;
  material.bend_warp = static_cast<float>(bend_warp);
  material.bend_weft = static_cast<float>(bend_weft);
  material.bend_bias = static_cast<float>(bend_bias);
  material.max_stretch = 0;
  return material;
}

Material even_sheet(double rigidity) {
  return soft_sheet(rigidity, rigidity, rigidity);
}

Draped hang_level(const std::shared_ptr<const ClothAsset>& specimen, const Material& material,
                  const DrapeEffort& effort, double turn, const MakeSolver& make) {
  std::vector<Vec3> start = specimen->rest_position;
  for (uint32_t p = 0; p < specimen->pixel_count(); ++p) {
    const auto x = static_cast<double>(start[p].x), z = static_cast<double>(start[p].z);
    if (specimen->valid(p)) start[p].y += static_cast<float>(wave(x, z, turn));
  }
  return hang(specimen, start, material, effort, make);
}

Draped hang_on(const Draped& coarse, const std::shared_ptr<const ClothAsset>& specimen, const Material& material,
               const DrapeEffort& effort, const MakeSolver& make) {
  return hang(specimen, on_grid(coarse, *specimen), material, effort, make);
}

Drape shadow_of(const Draped& draped) {
  return measure(*draped.specimen, draped.position);
}

Drape drape(const std::shared_ptr<const ClothAsset>& specimen, const Material& material, const DrapeEffort& effort,
            double turn, const MakeSolver& make) {
  return shadow_of(hang_level(specimen, material, effort, turn, make));
}

}  // namespace geocloth::test
