// SPDX-License-Identifier: GPL-3.0-or-later
// Cusick's drape on every backend: the stiffer the cloth, the more it covers, and no side is favoured.
#include "support/drape.h"
#include "support/machine.h"

namespace geocloth::test {
namespace {

class Cusick : public MachineTest<> {};

TEST_P(Cusick, StifferClothCoversMoreAndHangsEvenly) {
  const auto disc = make_specimen(machine().slow() ? 20 : 32, Layout::panels);
  const DrapeEffort effort = machine().slow() ? DrapeEffort{16, 2, 60} : DrapeEffort{};
  double before = 0;
  for (const double rigidity : {5e-6, 2e-5, 8e-5}) {
    const Drape d = drape(disc, even_sheet(rigidity), effort, 0, maker());
    EXPECT_GT(d.coefficient, before + 10) << rigidity;
    EXPECT_LT(d.coefficient, 100) << rigidity;
    for (const double offset : d.center) EXPECT_NEAR(offset, 0, 0.004) << rigidity;
    before = d.coefficient;
  }
}

INSTANTIATE_TEST_SUITE_P(On, Cusick, first_machine(), kMachineName);

}  // namespace
}  // namespace geocloth::test
