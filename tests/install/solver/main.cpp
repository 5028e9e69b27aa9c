// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include <geocloth/asset/asset_file.h>
#include <geocloth/solver/solver.h>

int main(int argc, char** argv) try {
  if (argc != 2) return 2;
  geocloth::ClothDesc shirt;
  shirt.asset = std::make_shared<const geocloth::ClothAsset>(geocloth::read_asset(argv[1]));
  shirt.material = geocloth::find_material_preset("cotton")->material;

  geocloth::SolverSettings settings;  // 60 frames a second, 16 substeps, a GPU if there is one
  geocloth::Solver solver({&shirt, 1}, settings);
  const geocloth::Collider floor{.name = "floor", .shape = geocloth::Plane{}};
  solver.set_colliders({&floor, 1});
  for (int frame = 0; frame < 60; ++frame) solver.step();

  std::vector<geocloth::Vec3> position;  // one per pixel of the geometry image
  solver.read_positions(0, position);
  const auto lower = [](const geocloth::Vec3& a, const geocloth::Vec3& b) { return a.y < b.y; };
  std::printf("highest point after a second: %.3f m\n", std::max_element(position.begin(), position.end(), lower)->y);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
