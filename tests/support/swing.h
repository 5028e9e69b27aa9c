// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"

namespace geocloth::test {

/// A sheet that starts level, swings down about its pinned edge and meets a ball that pokes through the plane where it
/// would hang.
struct Swing {
  uint32_t points = 100, substeps = 8, charts = 1;
  double ball = 0.15, behind = 0;  ///< radius, and way behind the plane, by the sheet's side
  float max_stretch = 5e-4F;
  uint32_t relaxation_steps = 1;
  SolverPath path = SolverPath::automatic;
  bool pinned = true;  ///< or it drops on to the ball
};

struct SwingScene {
  ClothDesc cloth;
  Solver solver;
};

inline SwingScene make_swing(const Swing& swing) {
  const float side = 0.01F * static_cast<float>(swing.points - 1);
  Material material;
  material.damping = 0;
  material.stiffness = material.bend_stiffness = 1;  // every projection removes all of its spring's error
  material.max_stretch = swing.max_stretch;
  const auto asset = std::make_shared<const ClothAsset>(make_sheet({.nx = swing.points,
                                                                    .ny = swing.points,
                                                                    .width = side,
                                                                    .height = side,
                                                                    .charts_x = swing.charts,
                                                                    .charts_y = swing.charts,
                                                                    .horizontal = true}));
  const ClothDesc cloth{asset, material, {}};
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.substeps = swing.substeps;
  settings.relaxation_steps = swing.relaxation_steps;
  settings.path = swing.path;
  Solver solver(std::vector{cloth}, settings);
  std::vector<Pin> pins;
  for (const ClothAsset::VertexGroup& group : asset->vertex_groups) {
    if (group.name != "top") continue;
    for (const uint32_t v : group.source_vertex) {
      const uint32_t pixel = asset->binding[v].pixel[0];
      pins.push_back({pixel, asset->rest_position[pixel]});
    }
  }
  if (swing.pinned) solver.set_pins(0, pins);
  const auto behind = static_cast<float>(swing.behind), radius = static_cast<float>(swing.ball);
  const Sphere ball{{0, -0.55F * side, (behind - 0.5F) * side}, radius * side};
  solver.set_colliders(std::vector<Collider>{{"ball", ball, 0.3F, {}}});
  return {cloth, std::move(solver)};
}

/// Of the sheet as it is after some frames of 1/60 s.
inline StretchStatistics stretch_of_swing(const Swing& swing, uint32_t frames) {
  SwingScene scene = make_swing(swing);
  for (uint32_t f = 0; f < frames; ++f) scene.solver.step();
  std::vector<Vec3> positions;
  scene.solver.read_positions(0, positions);
  return measure_stretch(*scene.cloth.asset, 1, positions);
}

}  // namespace geocloth::test
