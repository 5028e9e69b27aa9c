// SPDX-License-Identifier: GPL-3.0-or-later
// Cusick's drape (BS 5058, ISO 9073-9): a disc of 30 cm hangs over a disc of 18 cm; the drape coefficient is the share
// of the ring's area that its shadow covers. Fabrics fold into several equilibria, so what must hold is the
// coefficient, its trend, and the direction of the folds; not the shape. A soft knit, because the stretch of a firm
// weave needs hundreds of relaxation steps at this size; 32 substeps of 1/60 s and 4 relaxation steps.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/convert.h"
#include "solver_fixture.h"

namespace geocloth {
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

std::shared_ptr<const ClothAsset> disc_of(uint32_t resolution) {
  ConvertOptions options;
  options.flatten.resolution = resolution;
  return std::make_shared<const ClothAsset>(convert(make_disc(), options).asset);
}

/// What is dark under the draped cloth, in cells of half a millimetre.
struct Shadow {
  double area = 0;                 ///< [m^2]
  std::array<double, 2> center{};  ///< [m] x, z
  std::array<double, 2> extent{};  ///< [m^2] mean squares along x and z
};
Shadow shadow_of(const ClothAsset& asset, const std::vector<Vec3>& x) {
  constexpr int kCells = 640;
  constexpr double kCell = 0.0005;
  std::vector<bool> dark(size_t{kCells} * kCells);
  const auto place = [](float v) { return static_cast<double>(v) / kCell + kCells / 2; };
  for (const Triangle& t : pixel_triangles(asset)) {
    const std::array<double, 3> px{place(x[t[0]].x), place(x[t[1]].x), place(x[t[2]].x)};
    const std::array<double, 3> pz{place(x[t[0]].z), place(x[t[1]].z), place(x[t[2]].z)};
    const double d = (px[1] - px[0]) * (pz[2] - pz[0]) - (px[2] - px[0]) * (pz[1] - pz[0]);
    if (d == 0) continue;
    const auto low = [](const auto& p) { return std::max(0, static_cast<int>(*std::ranges::min_element(p))); };
    const auto high = [](const auto& p) {
      return std::min(kCells - 1, static_cast<int>(*std::ranges::max_element(p)));
    };
    for (int j = low(pz); j <= high(pz); ++j)
      for (int i = low(px); i <= high(px); ++i) {
        const double u = ((px[1] - i) * (pz[2] - j) - (px[2] - i) * (pz[1] - j)) / d;
        const double v = ((px[2] - i) * (pz[0] - j) - (px[0] - i) * (pz[2] - j)) / d;
        if (u >= 0 && v >= 0 && u + v <= 1) dark[static_cast<size_t>(j) * kCells + static_cast<size_t>(i)] = true;
      }
  }
  Shadow shadow;
  double count = 0;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      if (!dark[static_cast<size_t>(j) * kCells + static_cast<size_t>(i)]) continue;
      const std::array at{(i - kCells / 2) * kCell, (j - kCells / 2) * kCell};
      for (size_t k = 0; k < 2; ++k) {
        shadow.center[k] += at[k];
        shadow.extent[k] += at[k] * at[k];
      }
      ++count;
    }
  shadow.area = count * kCell * kCell;
  for (size_t k = 0; k < 2; ++k) {
    shadow.center[k] /= count;
    shadow.extent[k] /= count;
  }
  return shadow;
}

struct Drape {
  double coefficient = 0;  ///< [%]
  Shadow shadow;
};
Drape drape(const std::shared_ptr<const ClothAsset>& disc, double bend_warp, double bend_weft) {
  ClothDesc cloth{disc, {}, {}};
  cloth.material.stretch_warp = cloth.material.stretch_weft = 50;
  cloth.material.shear = 5;
  cloth.material.bend_warp = static_cast<float>(bend_warp);
  cloth.material.bend_weft = static_cast<float>(bend_weft);
  cloth.material.damping = 4;
  cloth.material.max_stretch = 0;
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  settings.relaxation_steps = 4;
  Solver solver(std::vector{cloth}, settings);
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < disc->pixel_count(); ++p) {
    const Vec3& at = disc->rest_position[p];
    if (disc->valid(p) && std::hypot(at.x, at.z) <= static_cast<float>(kSupport)) pins.push_back({p, at});
  }
  solver.set_pins(0, pins);
  test::run(solver, 120);
  const std::vector<Vec3> x = test::positions_of(solver);
  Drape result{0, shadow_of(*disc, x)};
  const auto circle = [](double radius) { return std::numbers::pi * radius * radius; };
  result.coefficient = 100 * (result.shadow.area - circle(kSupport)) / (circle(kDisc) - circle(kSupport));
  return result;
}

TEST(Cusick, CoefficientDoesNotDependOnTheResolution) {
  EXPECT_NEAR(drape(disc_of(64), 2e-5, 2e-5).coefficient, drape(disc_of(32), 2e-5, 2e-5).coefficient, 3.0);
}

TEST(Cusick, StifferClothCoversMoreAndHangsEvenly) {
  const auto disc = disc_of(32);
  double before = 0;
  for (const double rigidity : {5e-6, 2e-5, 8e-5}) {
    const Drape d = drape(disc, rigidity, rigidity);
    EXPECT_GT(d.coefficient, before + 10) << rigidity;
    EXPECT_LT(d.coefficient, 100) << rigidity;
    for (const double offset : d.shadow.center) EXPECT_NEAR(offset, 0, 0.002) << rigidity;
    before = d.coefficient;
  }
}

// What is stiff reaches farther out; swapping warp and weft turns that by a right angle.
TEST(Cusick, SwappingWarpAndWeftTurnsTheDrape) {
  const auto disc = disc_of(32);
  const Drape one = drape(disc, 1e-4, 2e-6), other = drape(disc, 2e-6, 1e-4);
  const auto lengthwise = [](const Drape& d) { return d.shadow.extent[0] / d.shadow.extent[1]; };
  EXPECT_GT(std::abs(std::log(lengthwise(one))), 0.2);
  EXPECT_NEAR(std::log(lengthwise(one)), -std::log(lengthwise(other)), 0.05);
  EXPECT_NEAR(one.coefficient, other.coefficient, 3.0);
}

}  // namespace
}  // namespace geocloth
