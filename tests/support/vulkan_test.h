// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/solver/vulkan_interop.h"

#if defined(__SANITIZE_ADDRESS__)
/// The validation layer (1.3.239) keeps the state of every destroyed storage image, and lavapipe a block for each
/// device: not ours to free.
extern "C" __attribute__((used)) inline const char* __lsan_default_suppressions() {  // NOLINT
  return "leak:libVkLayer_khronos_validation.so\nleak:libvulkan_lvp.so\n";
}
#endif

namespace geocloth::test {

/// Tests that run Vulkan under the validation layers: any message, also one about destruction, fails the test. They
/// skip where there is no device, unless GEOCLOTH_REQUIRE_DEVICE is set.
class VulkanTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    setenv("GEOCLOTH_VULKAN_VALIDATION", "1", 1);
    // They stay loaded, so that a leak sanitizer knows their names at the end.
    for (const char* library : {"libVkLayer_khronos_validation.so", "libvulkan_lvp.so"})
      (void)dlopen(library, RTLD_LAZY | RTLD_NODELETE);
  }

  /// A cloth of a few work groups takes lavapipe longer to hand to its threads than to go through. For scenes that are
  /// played: tests that compare passes with the cpu's bits keep the threads, so that groups do run at once there.
  static void keep_software_to_one_thread() { setenv("LP_NUM_THREADS", "0", 0); }

  void SetUp() override {
    for (const DeviceInfo& device : enumerate_devices())
      if (device.backend == Backend::vulkan && device.usable) return;
    if (std::getenv("GEOCLOTH_REQUIRE_DEVICE") != nullptr) FAIL() << "no usable Vulkan device";
    GTEST_SKIP() << "no usable Vulkan device";
  }

  void TearDown() override {
    for (const auto& log : logs_) EXPECT_THAT(log->messages(), testing::IsEmpty());
  }

  /// A solver whose validation messages fail this test.
  [[nodiscard]] Solver make_solver(std::span<const ClothDesc> cloths, SolverSettings settings) {
    settings.backend = Backend::vulkan;
    Solver solver(cloths, settings);
    watch(solver);
    return solver;
  }
  void watch(Solver& solver) { logs_.push_back(validation_log(solver)); }

 private:
  std::vector<std::shared_ptr<const ValidationLog>> logs_;
};

}  // namespace geocloth::test
