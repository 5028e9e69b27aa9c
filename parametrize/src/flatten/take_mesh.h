// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "geocloth/parametrize/flatten.h"
#include "mesh/refined_mesh.h"

namespace geocloth {

/// A flat surface gets the mesh that samples were inserted into; its components are the charts. uv are not the mesh's.
inline void take_mesh(FlatSurface& flat, RefinedMesh mesh) {
  flat.position = std::move(mesh.position);
  flat.triangle = std::move(mesh.triangle);
  flat.chart = std::move(mesh.component);
  flat.point = std::move(mesh.point);
  flat.point_count = mesh.point_count;
  flat.clean_vertex = std::move(mesh.clean_vertex);
  flat.clean_triangle = std::move(mesh.clean_triangle);
}

}  // namespace geocloth
