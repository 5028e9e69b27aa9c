// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// Of all pixels.
struct StartState {
  std::vector<Vec3> position, velocity;  ///< [m], [m/s]
};

/// Where a start has a cloth.
/// @param frame_rate  [1/s] of frames whose file does not say it
/// @throws as `read`; Error(unsupported) without one; Error(invalid_data) where the file is of another mesh, or in
/// another
///   unit, or has no frame to take velocities from
[[nodiscard]] StartState start_state(const SceneStart& start, const ClothDesc& cloth, const ReadVertices& read,
                                     double frame_rate);

}  // namespace geocloth
