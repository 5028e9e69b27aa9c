// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// The triangles of a mesh in another order, some left out; parts are given anew.
[[nodiscard]] TriangleMesh with_triangles(const TriangleMesh& mesh, const std::vector<uint32_t>& order,
                                          std::vector<SourcePart> part);

}  // namespace geocloth
