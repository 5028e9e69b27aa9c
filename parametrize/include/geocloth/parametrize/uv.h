// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// The flat pieces that a garment's own texture coordinates describe: its sewing pattern, when it has one.
struct UvPattern {
  /// Triangles joined over edges along which the texture coordinates agree, all face up or all face down.
  struct Island {
    uint32_t faces = 0;
    double area = 0;        ///< [m^2] on the surface
    double scale = 0;       ///< [m per unit of uv] of least distortion
    bool mirrored = false;  ///< it lies face down in the texture
    double energy = 0;      ///< mean symmetric Dirichlet energy at that scale, by area; 4 is isometric
  };
  std::vector<Island> island;
  std::vector<uint32_t> island_of;            ///< per triangle of the clean surface
  std::vector<std::array<uint32_t, 2>> seam;  ///< clean-surface edges (vertex pairs) between islands or within one
  double energy = 0;                          ///< as of an island, of all triangles at one common scale
  double outline = 0;                         ///< [m] around all pieces together
  /// Why the pieces cannot be laid out as they are, in words; empty when they can.
  std::string refusal;
  /// The pieces look like a sewing pattern: drawn to one scale, nearly without distortion, not in fragments.
  bool is_sewing_pattern = false;
};

/// Judges the texture coordinates of a clean surface. That a piece overlaps itself is found by flatten().
[[nodiscard]] UvPattern read_uv_pattern(const CleanSurface& surface);

}  // namespace geocloth
