// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "geocloth/solver/solver.h"

namespace geocloth::test {

/// The solver to measure: its backend is the maker's business.
using MakeSolver = std::function<Solver(std::span<const ClothDesc>, const SolverSettings&)>;

[[nodiscard]] inline Solver make_cpu_solver(std::span<const ClothDesc> cloths, const SolverSettings& settings) {
  SolverSettings on_cpu = settings;
  on_cpu.backend = Backend::cpu;
  return {cloths, on_cpu};
}

}  // namespace geocloth::test
