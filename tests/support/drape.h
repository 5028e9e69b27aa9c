// SPDX-License-Identifier: GPL-3.0-or-later
// Cusick's drape test (BS 5058, ISO 9073-9): a disc of 30 cm hangs over a disc of 18 cm; the drape coefficient is the
// share of the ring's area that its shadow covers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "support/make_solver.h"

namespace geocloth::test {

/// The specimen, from a mesh of rings.
[[nodiscard]] std::shared_ptr<const ClothAsset> make_specimen(uint32_t resolution, Layout layout);

/// Soft, and without grain: shear = stretch / 2, one rigidity [N m] in all directions. Only such a sheet is the same
/// cloth in both layouts, for the square turns warp and weft as it likes.
[[nodiscard]] Material even_sheet(double rigidity);
/// The same with a rigidity for each direction. @param bend_bias  [N m] on the bias; -1: a weave
[[nodiscard]] Material soft_sheet(double bend_warp, double bend_weft, double bend_bias);

struct DrapeEffort {
  uint32_t substeps = 32, relaxation_steps = 4;
  uint32_t frames = 120;
  float damping = 4;  ///< [1/s] of the air about the cloth: no equilibrium depends on it
};

struct Drape {
  double coefficient = 0;          ///< [%]
  std::array<double, 2> center{};  ///< [m] x, z of the shadow
  std::array<double, 2> extent{};  ///< [m^2] its mean squares along x and z
};

/// A specimen and how it hangs.
struct Draped {
  std::shared_ptr<const ClothAsset> specimen;
  std::vector<Vec3> position;  ///< [m] one per pixel
};

/// From level, with the waves of drape().
[[nodiscard]] Draped hang_level(const std::shared_ptr<const ClothAsset>& specimen, const Material& material,
                                const DrapeEffort& effort, double turn = 0, const MakeSolver& make = make_cpu_solver);
/// From how a coarser specimen hangs: a finer one then has little way to go, and the folds that the coarser one chose.
[[nodiscard]] Draped hang_on(const Draped& coarse, const std::shared_ptr<const ClothAsset>& specimen,
                             const Material& material, const DrapeEffort& effort,
                             const MakeSolver& make = make_cpu_solver);
[[nodiscard]] Drape shadow_of(const Draped& draped);

/// Lets the specimen hang from level. Small waves, the same however it is laid out, choose among the folds that it may
/// come to rest in. On the support it is held as under Cusick's upper disc.
/// @param turn  [rad] of the waves about the middle
[[nodiscard]] Drape drape(const std::shared_ptr<const ClothAsset>& specimen, const Material& material,
                          const DrapeEffort& effort, double turn = 0, const MakeSolver& make = make_cpu_solver);

}  // namespace geocloth::test
