// SPDX-License-Identifier: GPL-3.0-or-later
// A garment on a runner looks as on one who stands.

#include <algorithm>
#include <vector>

#include "solver_fixture.h"
#include "support/machine.h"
#include "support/running_slab.h"

namespace geocloth {
namespace {

class Ride : public test::MachineTest<> {
 protected:
  /// How the sheet lies on the slab, as seen from it, after a while at this speed [m/s]; all of it starts so.
  std::vector<Vec3> lies(float speed, int frames) {
    const ClothAsset sheet = test::make_sheet(test::sheet_on_slab());
    Solver solver = make(test::describe(sheet, test::cloth_on_slab()), test::eight_substeps());
    solver.set_colliders(std::vector{test::slab(0)}, true);
    solver.write_state(0, sheet.rest_position, std::vector<Vec3>(sheet.pixel_count(), Vec3{speed, 0, 0}));
    for (int f = 1; f <= frames; ++f) {
      solver.set_colliders(std::vector{test::slab(speed * test::kFrame * static_cast<float>(f))});
      solver.step();
    }
    std::vector<Vec3> x = test::positions_of(solver);
    for (Vec3& p : x) p.x -= speed * test::kFrame * static_cast<float>(frames);
    return x;
  }
};

TEST_P(Ride, AtSixMetresASecondLooksAsAtRest) {
  const int frames = machine().slow() ? 20 : 90;
  const std::vector<Vec3> rest = lies(0, frames), riding = lies(6, frames);
  double apart = 0, lowest = 0;
  for (size_t p = 0; p < rest.size(); ++p) {
    apart = std::max(apart, static_cast<double>(length(rest[p] - riding[p])));
    lowest = std::min(lowest, static_cast<double>(riding[p].y));
  }
  EXPECT_LT(lowest, -0.05);  // it hangs over
  // Haste in the first frames gives it other folds while it falls; a sheet left behind would be metres away.
  EXPECT_LT(apart, 0.03);
}

INSTANTIATE_TEST_SUITE_P(On, Ride, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
