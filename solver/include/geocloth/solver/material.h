// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace geocloth {

/// What the cloth is made of, in physical units: results do not depend on resolution or on the number of substeps.
struct Material {
  float areal_density = 0.2F;   ///< [kg/m^2] 1e-6..1e4
  float stretch_warp = 1000.F;  ///< [N/m] force per width and strain along +v; 1e-9..1e12; larger is stiffer
  float stretch_weft = 1000.F;  ///< [N/m] the same along u
  float shear = 100.F;          ///< [N/m] 0 or 1e-9..1e12
  float bend_warp = 1e-5F;      ///< [N m] bending rigidity of a line along +v; 0 or 1e-12..1e6
  float bend_weft = 1e-5F;      ///< [N m] the same along u
  float bend_bias = -1.F;       ///< [N m] the same at 45 degrees to both: a sheet without grain has the same in all
                                ///< directions; below 0: a weave without twisting rigidity, (warp + weft) / 4
  float damping = 1.0F;         ///< [1/s] share of the velocity lost per second; >= 0
  float thickness = 0.002F;     ///< [m] the cloth's middle surface keeps this distance from colliders; 0..1
  float friction = 0.3F;        ///< Coulomb coefficient, combined with the collider's by the geometric mean; 0..1e3
  float max_speed = 0.F;        ///< [m/s] 0 = no limit
  float max_stretch = -1.F;  ///< long-range attachments: largest strain along the surface to a pin and, where the cloth
                             ///< meets colliders, over eight pixels; 0 = off; below 0: automatic, above what the
                             ///< cloth's own weight stretches it by in a swing, and the wind in a flag; of that no
                             ///< more than 10 m count: say 0 for a banner that is to give way to more

  /// The seeds' own dimensionless parameters; they depend on the step. Used instead of the physical ones when >= 0.
  float stiffness = -1.F;       ///< 0..1 share of a structural or shear spring's error that one projection removes
  float bend_stiffness = -1.F;  ///< 0..1 the same for springs over two pixels, in place of the bending rigidity
  float verlet_damping = -1.F;  ///< Zeller's k, 0..1: x + k (x - x_prev)
  bool operator==(const Material&) const = default;
};

/// A material on the way from one to another. What both have above 0 changes in proportion (half-way from 1 to 100 is
/// 10), so that stiffnesses of other orders of magnitude are passed through evenly, and what one has as 0 in equal
/// steps. What one leaves to the solver (below 0), and a largest speed or stretch that one does not have, changes at
/// the end.
/// @param t  0: a, 1: b; clamped
[[nodiscard]] Material mix(const Material& a, const Material& b, float t);

/// A measured fabric.
struct MaterialPreset {
  std::string_view name;
  Material material;
  std::string_view source;  ///< where the numbers come from
};
[[nodiscard]] std::span<const MaterialPreset> material_presets();
/// nullptr when there is none of that name.
[[nodiscard]] const MaterialPreset* find_material_preset(std::string_view name);

}  // namespace geocloth
