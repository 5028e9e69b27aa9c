// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of animated meshes share, whatever file they come from.
#pragma once

#include <algorithm>
#include <cmath>

#include "geocloth/parametrize/animated_mesh.h"
#include "import_fixture.h"

namespace geocloth::test {

inline const double kHalf = std::sqrt(0.5);

inline void expect_at(const Vec3& p, double x, double y, double z) {
  EXPECT_NEAR(p.x, x, 1e-5);
  EXPECT_NEAR(p.y, y, 1e-5);
  EXPECT_NEAR(p.z, z, 1e-5);
}

/// A file that is damaged ends in an Error, or in a mesh that is whole at all times.
inline void expect_plays_or_is_refused(const std::filesystem::path& file) {
  try {
    const AnimatedMesh mesh(file, {.start = 0.5, .loop = true});
    for (const double time : {0.0, 0.2, 1.3, 40.0}) {
      const std::vector<Vec3> position = mesh.positions_at(time);
      EXPECT_TRUE(std::all_of(position.begin(), position.end(), is_finite));
      for (const Triangle& t : mesh.triangle()) EXPECT_LT(std::max({t[0], t[1], t[2]}), position.size());
    }
  } catch (const Error&) {
  }
}

}  // namespace geocloth::test
