// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"

namespace geocloth::test {

inline SolverSettings cpu_settings() {
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.check_copies = true;
  return settings;
}

inline ClothDesc describe(ClothAsset asset, const Material& material = {}) {
  return {std::make_shared<const ClothAsset>(std::move(asset)), material, {}};
}

/// Cloth that nothing but gravity and springs slows down or holds.
inline Material material_with(float Material::*field, float value) {
  Material material;
  material.*field = value;
  return material;
}

inline Material undamped() {
  Material material;
  material.damping = 0;
  return material;
}

inline std::vector<Vec3> positions_of(Solver& solver, uint32_t cloth = 0) {
  std::vector<Vec3> positions;
  solver.read_positions(cloth, positions);
  return positions;
}
inline std::vector<Vec3> velocities_of(Solver& solver, uint32_t cloth = 0) {
  std::vector<Vec3> velocities;
  solver.read_velocities(cloth, velocities);
  return velocities;
}

inline void run(Solver& solver, uint32_t frames) {
  for (uint32_t f = 0; f < frames; ++f) solver.step();
}

/// Into a sheet in the xy plane.
inline void push_ball(Solver& solver, int frames) {
  for (int f = 0; f < frames; ++f) {
    solver.set_colliders(std::vector{Collider{"ball", Sphere{{0, 0, 0.3F - 0.03F * static_cast<float>(f)}, 0.2F}}});
    solver.step();
  }
}

/// [m] By how much the ways of points differ from one frame to the next, as a root mean square: cloth at rest has none.
inline double tremble(Solver& solver, uint32_t frames) {
  std::vector<Vec3> before = positions_of(solver);
  solver.step();
  std::vector<Vec3> last = positions_of(solver);
  double squares = 0, count = 0;
  for (uint32_t f = 0; f < frames; ++f) {
    solver.step();
    std::vector<Vec3> now = positions_of(solver);
    for (size_t p = 0; p < now.size(); ++p, ++count) {
      const auto change = static_cast<double>(length(now[p] - 2.F * last[p] + before[p]));
      squares += change * change;
    }
    before = std::exchange(last, std::move(now));
  }
  return std::sqrt(squares / count);
}

/// Pins that hold the named group of source vertices where they start.
inline std::vector<Pin> pins_at_rest(const ClothAsset& asset, const std::string& group, const Vec3& shift = {}) {
  std::vector<Pin> pins;
  for (const auto& g : asset.vertex_groups) {
    if (g.name != group) continue;
    for (const uint32_t v : g.source_vertex) {
      const uint32_t pixel = asset.binding[v].pixel[0];
      pins.push_back({pixel, asset.rest_position[pixel] + shift});
    }
  }
  return pins;
}

inline bool all_finite(const std::vector<Vec3>& positions) {
  for (const Vec3& p : positions)
    if (!is_finite(p)) return false;
  return true;
}

/// Mass [kg] of every pixel.
inline std::vector<double> masses_of(const ClothDesc& cloth) {
  std::vector<double> mass;
  const double s = cloth.transform.scale;
  for (const float area : cloth.asset->area)
    mass.push_back(static_cast<double>(area) * s * s * cloth.material.areal_density);
  return mass;
}

}  // namespace geocloth::test
