// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose outcome follows from a formula. The tests check each at an effort that is enough for it; the program
// tests/bench/convergence_table.cpp tells how the error falls with the effort.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "support/make_solver.h"

namespace geocloth::test {

/// What a user may spend on a scene.
struct Effort {
  uint32_t cells = 16;  ///< along the strip
  uint32_t substeps = 32;
  uint32_t relaxation_steps = 8;
};

struct ClosedForm {
  std::string name;              ///< letters, digits and underscores
  std::string what;              ///< the measured value, in words
  double reference;              ///< what a converged solution gives
  double tolerance;              ///< relative
  Effort enough;                 ///< meets the tolerance
  Effort least;                  ///< meets it too, for slow devices
  std::optional<Effort> single;  ///< with one relaxation step, all that tiles can do
  std::string source;            ///< where the reference comes from
  std::function<double(const Effort&, const MakeSolver&)> measure;
};

/// Statics and periods of strips: hanging, between two pins, swinging, clamped at one end.
[[nodiscard]] std::span<const ClosedForm> closed_forms();

}  // namespace geocloth::test
