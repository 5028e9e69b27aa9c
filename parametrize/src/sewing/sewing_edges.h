// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Two vertices of a mesh that a loose edge joins.
using SewnVertices = std::array<uint32_t, 2>;

/// Pairs one after the other along edges of the mesh: all first vertices lie on one side of a seam, all second ones on
/// the other. A side may stay at a vertex. A pair by itself is a run of one.
struct SewingRun {
  std::vector<SewnVertices> pair;
  std::vector<std::array<bool, 2>>
      on_border;  ///< whether the edges from each pair to the next one are of one face only
};

/// Edges that runs are made of. One that goes round ends with the pair that it begins with.
[[nodiscard]] uint32_t count_edges(std::span<const SewingRun> runs);

/// What the loose edges of a mesh sew: those between vertices of faces that no edge joins. Vertices at one place count
/// as one.
[[nodiscard]] std::vector<SewingRun> find_sewing(const TriangleMesh& mesh);

}  // namespace geocloth
