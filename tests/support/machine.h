// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of physics have one text for every backend. Such a text is built twice: into a program for the cpu, with
// machines_cpu.cpp, and into one for Vulkan devices, with machines_vulkan.cpp.
#pragma once

#include <ostream>
#include <span>
#include <string>

#include "support/make_solver.h"
#include "support/vulkan_test.h"

namespace geocloth::test {

/// Where a test runs.
struct Machine {
  Backend backend = Backend::cpu;
  SolverPath path = SolverPath::automatic;

  /// Vulkan devices may be software, for which every substep is dear: they get fewer points and frames.
  [[nodiscard]] bool slow() const { return backend == Backend::vulkan; }
  /// Work groups with barriers are dearer still in software.
  [[nodiscard]] bool slowest() const { return slow() && path != SolverPath::plain; }
};

/// All of this program's. The first one takes every test, the others the short ones.
[[nodiscard]] std::span<const Machine> machines();

[[nodiscard]] inline std::string name_of(const Machine& machine) {
  return machine.backend == Backend::cpu ? "cpu" : std::string("vulkan_") + to_string(machine.path);
}
inline void PrintTo(const Machine& machine, std::ostream* out) {
  *out << name_of(machine);
}

/// @tparam Case  a Machine, or what a test needs besides
template <class Case = Machine>
class MachineTest : public VulkanTest, public testing::WithParamInterface<Case> {
 protected:
  static void SetUpTestSuite() {
    VulkanTest::SetUpTestSuite();
    VulkanTest::keep_software_to_one_thread();
  }
  void SetUp() override {
    if (machine().backend == Backend::vulkan) VulkanTest::SetUp();
  }

  [[nodiscard]] const Machine& machine() const { return this->GetParam(); }

  [[nodiscard]] Solver make(std::span<const ClothDesc> cloths, SolverSettings settings) {
    if (machine().backend == Backend::cpu) return make_cpu_solver(cloths, settings);
    settings.path = machine().path;
    return make_solver(cloths, settings);
  }
  [[nodiscard]] Solver make(const ClothDesc& cloth, const SolverSettings& settings) {
    return make({&cloth, 1}, settings);
  }
  [[nodiscard]] MakeSolver maker() {
    return [this](std::span<const ClothDesc> cloths, const SolverSettings& settings) { return make(cloths, settings); };
  }
};

/// For INSTANTIATE_TEST_SUITE_P.
inline auto every_machine() {
  return testing::ValuesIn(machines().begin(), machines().end());
}
inline auto first_machine() {
  return testing::Values(machines().front());
}
constexpr auto kMachineName = [](const auto& tested) { return name_of(tested.param); };

}  // namespace geocloth::test
