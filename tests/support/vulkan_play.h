// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"
#include "support/vulkan_test.h"

namespace geocloth::test {

/// A way to play a scene: called before every frame with the solver and the frame's number.
using Director = std::function<void(Solver&, uint32_t)>;

struct Play {
  std::vector<ClothDesc> cloths;
  SolverSettings settings;
  Director before_frame = [](Solver&, uint32_t) {};
  uint32_t frames = 4;
};

struct Outcome {
  std::vector<std::vector<Vec3>> positions, normals, velocities;
  SolverStatistics statistics;
};

inline Outcome play(Solver solver, const Play& scene) {
  for (uint32_t f = 0; f < scene.frames; ++f) {
    scene.before_frame(solver, f);
    solver.step();
  }
  Outcome outcome;
  outcome.positions.resize(scene.cloths.size());
  outcome.normals.resize(scene.cloths.size());
  outcome.velocities.resize(scene.cloths.size());
  for (uint32_t c = 0; c < scene.cloths.size(); ++c) {
    solver.read_positions(c, outcome.positions[c]);
    solver.read_normals(c, outcome.normals[c]);
    solver.read_velocities(c, outcome.velocities[c]);
  }
  outcome.statistics = solver.statistics();
  return outcome;
}

inline ClothDesc cloth_of(const SheetOptions& options, const Material& material = {}) {
  return {.asset = std::make_shared<ClothAsset>(make_sheet(options)), .material = material};
}

/// Every pixel of the sheet's top row, where it is.
inline std::vector<Pin> pins_of_top(const SheetOptions& options, const ClothAsset& asset, const Vec3& shift = {}) {
  std::vector<Pin> pins;
  for (uint32_t i = 0; i < options.nx; ++i) {
    const uint32_t pixel = sheet_pixel(options, i, 0);
    pins.push_back({pixel, asset.rest_position[pixel] + shift});
  }
  return pins;
}

inline double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double distance = double{length(a[i] - b[i])};
    if (!(distance <= largest)) largest = distance;  // NaN is the largest of all
  }
  return largest;
}

class VulkanBackendTest : public VulkanTest {
 protected:
  /// Plays the scene on both backends and compares.
  /// @param tolerance  of positions, by the size of the sheets
  Outcome expect_same_as_cpu(const Play& scene, double tolerance = 1e-3) {
    SolverSettings cpu_settings = scene.settings;
    cpu_settings.backend = Backend::cpu;
    Outcome vulkan = play(make_solver(scene.cloths, scene.settings), scene);
    compare(scene, vulkan, play(Solver(scene.cloths, cpu_settings), scene), tolerance);
    return vulkan;
  }

  static void compare(const Play& scene, const Outcome& vulkan, const Outcome& cpu, double tolerance) {
    for (size_t c = 0; c < scene.cloths.size(); ++c) {
      SCOPED_TRACE(c);
      const ClothAsset& asset = *scene.cloths[c].asset;
      EXPECT_GT(largest_distance(vulkan.positions[c], asset.rest_position), 1e-6) << "nothing moved";
      if (exact_device(vulkan.statistics)) {
        EXPECT_EQ(hash_state(asset, vulkan.positions[c]), hash_state(asset, cpu.positions[c]));
        EXPECT_EQ(largest_distance(vulkan.normals[c], cpu.normals[c]), 0);
      }
      EXPECT_LE(largest_distance(vulkan.positions[c], cpu.positions[c]), tolerance * kDiagonal);
      EXPECT_LE(largest_distance(vulkan.velocities[c], cpu.velocities[c]), 0.5);
    }
    EXPECT_NEAR(vulkan.statistics.copy_gap, cpu.statistics.copy_gap, 1e-6);
    EXPECT_NEAR(vulkan.statistics.penetration, cpu.statistics.penetration, 1e-4);
    EXPECT_EQ(vulkan.statistics.particles, cpu.statistics.particles);
    EXPECT_EQ(vulkan.statistics.springs, cpu.statistics.springs);
  }

  static bool exact_device(const SolverStatistics& statistics) {
    return statistics.device.find("llvmpipe") != std::string::npos;
  }

  static constexpr double kDiagonal = 1.4;  ///< [m] of the sheets below
};

inline const SheetOptions kUncut{.nx = 13, .ny = 11};
inline const SheetOptions kCut{.nx = 13, .ny = 11, .charts_x = 3, .charts_y = 2, .jitter = 0.2F};

inline SolverSettings settings_of(uint32_t substeps) {
  SolverSettings settings;
  settings.substeps = substeps;
  return settings;
}

inline Play hanging(const SheetOptions& options, const Material& material = {}) {
  Play scene{.cloths = {cloth_of(options, material)}, .settings = settings_of(4)};
  scene.before_frame = [options, asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(0, pins_of_top(options, *asset));
  };
  return scene;
}

}  // namespace geocloth::test
