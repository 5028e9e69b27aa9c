// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geocloth/solver/scene.h"
#include "scene/json_reader.h"

namespace geocloth {

/// Puts the colliders of a scene into groups, by what the cloths say that they meet: "ignores" names those that one
/// does not, "collides_with" all that it does.
/// @param json   of the scene
/// @param scene  whose cloths and colliders are read
/// @throws Error(invalid_data) for a name that no collider has, Error(limit) when that takes more than 32 groups
void read_collision_groups(const JsonReader& json, Scene& scene);

}  // namespace geocloth
