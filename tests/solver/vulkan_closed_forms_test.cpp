// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms on a Vulkan device, at the smallest size that meets them.
#include <cmath>
#include <string_view>

#include "support/closed_forms.h"
#include "support/vulkan_test.h"

namespace geocloth {
namespace {

class VulkanClosedFormTest : public test::VulkanTest {
 protected:
  void expect_met(std::string_view name, const test::Effort& effort) {
    for (const test::ClosedForm& form : test::closed_forms()) {
      if (form.name != name) continue;
      const double measured =
          form.measure(effort, [this](std::span<const ClothDesc> cloths, const SolverSettings& settings) {
            return make_solver(cloths, settings);
          });
      EXPECT_NEAR(measured, form.reference, form.tolerance * form.reference) << name;
      return;
    }
    FAIL() << "no closed form " << name;
  }
};

TEST_F(VulkanClosedFormTest, StretchByItsOwnWeight) {
  expect_met("hanging_strip", {8, 16, 4});
}
TEST_F(VulkanClosedFormTest, Catenary) {
  expect_met("catenary_1_25", {16, 16, 1});
}
TEST_F(VulkanClosedFormTest, Swing) {
  expect_met("swinging_strip", {8, 8, 2});
}
TEST_F(VulkanClosedFormTest, HeavyElastica) {
  expect_met("cantilever_20", {8, 16, 2});
}

}  // namespace
}  // namespace geocloth
