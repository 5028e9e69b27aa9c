// SPDX-License-Identifier: GPL-3.0-or-later
// The stress scene of the examples over and over: pins that shake the cloth, take hold of it and let go, a ball that
// beats it, a stone, a floor and gusts. Whatever is put in, the cloth must stay finite and its energy bounded.
// GEOCLOTH_STRESS_SECONDS=600 plays the ten minutes that the project promises.

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

#include "geocloth/asset/asset_file.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"
#include "support/machine.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

constexpr double kPeriod = 5;  ///< [s] of the scene file

/// The keys again and again, each time a period later; the first one is where the last left off.
void repeat(Motion& motion, uint32_t periods) {
  const size_t keys = motion.size();
  for (uint32_t k = 1; k < periods; ++k) {
    for (size_t i = 1; i < keys; ++i) {
      Keyframe key = motion[i];
      key.time += kPeriod * k;
      motion.push_back(key);
    }
  }
}

/// Pins that act for a while act again in every period.
void repeat_pins(SceneCloth& cloth, uint32_t periods) {
  const std::vector<ScenePin> once = cloth.pins;
  for (uint32_t k = 1; k < periods; ++k) {
    for (const ScenePin& pin : once) {
      if (!(pin.until <= kPeriod)) continue;
      ScenePin again = pin;
      again.from += kPeriod * k;
      again.until += kPeriod * k;
      for (Keyframe& key : again.motion) key.time += kPeriod * k;
      cloth.pins.push_back(again);
    }
  }
  for (size_t p = 0; p < once.size(); ++p) {
    if (!(once[p].until <= kPeriod)) repeat(cloth.pins[p].motion, periods);
  }
}

class Stress : public test::MachineTest<> {
 protected:
  [[nodiscard]] double seconds() const {
    const char* const wish = std::getenv("GEOCLOTH_STRESS_SECONDS");
    if (wish != nullptr) return std::stod(wish);
    return machine().slow() ? 10 : 20;
  }

  [[nodiscard]] test::SheetOptions flag() const {
    test::SheetOptions flag{
        .nx = 41, .ny = 27, .width = 1.2F, .height = 0.8F, .charts_x = 2, .center = {0.6F, 1.4F, 0}};
    if (machine().slow()) flag.nx = 16, flag.ny = 11;
    return flag;
  }
};

TEST_P(Stress, NeitherEnergyNorAnythingElseGrowsWithoutBound) {
  const auto periods = static_cast<uint32_t>(seconds() / kPeriod);
  const test::TemporaryFolder folder;
  write_asset(make_sheet(flag()), folder / "flag.glb");
  Scene scene = parse_scene(test::read_text(GEOCLOTH_SOURCE_DIR "/meshes/scenes/stress.json"), folder / "stress.json");
  for (SceneCollider& collider : scene.colliders) repeat(collider.motion, periods);
  repeat_pins(scene.cloths[0], periods);
  if (machine().slow()) scene.substeps /= 2;

  SolverSettings settings;
  settings.backend = machine().backend;
  settings.path = machine().path;
  settings.check_copies = true;
  Simulation simulation(scene, settings);
  if (machine().backend == Backend::vulkan) watch(simulation.solver());
  const ClothDesc& cloth = simulation.cloths()[0];
  const EnergyMeter meter(cloth);
  std::vector<double> largest(periods, 0);  // [J] kinetic energy in each period
  const auto frames = static_cast<uint32_t>(periods * kPeriod * scene.frame_rate);
  for (uint32_t f = 0; f < frames; ++f) {
    simulation.step();
    const std::vector<Vec3> x = test::positions_of(simulation.solver());
    ASSERT_TRUE(test::all_finite(x)) << "frame " << f;
    const Energy e = meter.measure(scene.gravity, x, test::velocities_of(simulation.solver()));
    double& most = largest[static_cast<size_t>(f / (kPeriod * scene.frame_rate))];
    most = std::max(most, e.kinetic);
  }
  const SolverStatistics statistics = simulation.solver().statistics();
  std::cout << "kinetic energy at most " << largest.front() << " J in the first period, "
            << *std::max_element(largest.begin(), largest.end()) << " J ever, " << largest.back()
            << " J in the last; penetration " << statistics.penetration << " m\n";
  double before = largest[0];
  for (size_t k = 1; k < periods; ++k) {
    EXPECT_LT(largest[k], 2 * before) << "in period " << k + 1;
    before = std::max(before, largest[k]);
  }
  EXPECT_LE(statistics.penetration, double{cloth.material.thickness});
  EXPECT_EQ(statistics.copy_gap, 0.0);
}

INSTANTIATE_TEST_SUITE_P(On, Stress, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
