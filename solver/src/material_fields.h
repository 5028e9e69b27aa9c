// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "check_input.h"
#include "geocloth/solver/material.h"

namespace geocloth {

/// What a field of a material goes into.
enum class MaterialUse : uint8_t {
  fabric,   ///< masses, springs and bends, cell by cell: see Fabric
  springs,  ///< all springs of a cloth alike
  frame     ///< what is told of each frame
};

struct MaterialField {
  std::string_view key;  ///< in scene files
  float Material::*value;
  MaterialUse use;
  float least = 0;            ///< above 0: that it may have, where it is not 0
  bool none_at_zero = false;  ///< 0 says that there is no limit
};
/// All that a material has.
inline constexpr std::array kMaterialFields{
    MaterialField{"areal_density", &Material::areal_density, MaterialUse::fabric},
    MaterialField{"stretch_warp", &Material::stretch_warp, MaterialUse::fabric},
    MaterialField{"stretch_weft", &Material::stretch_weft, MaterialUse::fabric},
    MaterialField{"shear", &Material::shear, MaterialUse::fabric, static_cast<float>(kSoftest)},
    MaterialField{"bend_warp", &Material::bend_warp, MaterialUse::fabric, static_cast<float>(kLimpest)},
    MaterialField{"bend_weft", &Material::bend_weft, MaterialUse::fabric, static_cast<float>(kLimpest)},
    MaterialField{"bend_bias", &Material::bend_bias, MaterialUse::fabric, static_cast<float>(kLimpest)},
    MaterialField{"damping", &Material::damping, MaterialUse::frame},
    MaterialField{"thickness", &Material::thickness, MaterialUse::frame},
    MaterialField{"friction", &Material::friction, MaterialUse::frame},
    MaterialField{"max_speed", &Material::max_speed, MaterialUse::frame, 0, true},
    MaterialField{"max_stretch", &Material::max_stretch, MaterialUse::frame, 0, true},
    MaterialField{"stiffness", &Material::stiffness, MaterialUse::springs},
    MaterialField{"bend_stiffness", &Material::bend_stiffness, MaterialUse::springs},
    MaterialField{"verlet_damping", &Material::verlet_damping, MaterialUse::frame}};
static_assert(sizeof(Material) == kMaterialFields.size() * sizeof(float));

}  // namespace geocloth
