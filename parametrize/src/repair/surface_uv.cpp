// SPDX-License-Identifier: GPL-3.0-or-later
// Repair moves corners by welding, swaps them by orienting and inserts them at T-junctions. A corner that still is the
// welded place of a corner of its source face takes that one's coordinates; any other is interpolated in the face.
#include "repair/surface_uv.h"

#include "mesh/point_math.h"

namespace geocloth {
std::vector<std::array<Point2, 3>> surface_uv(const TriangleMesh& mesh, const CleanSurface& surface) {
  std::vector<std::array<Point2, 3>> result;
  if (mesh.uv.empty()) return result;
  result.reserve(surface.triangle.size());
  for (size_t t = 0; t < surface.triangle.size(); ++t) {
    const uint32_t source = surface.source_triangle[t];
    const Triangle& corner = mesh.triangle[source];
    const std::array<Point2, 3>& uv = mesh.uv[source];
    std::array<Point2, 3> found{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = surface.triangle[t][k];
      Point3 weight{0, 0, 0};
      for (size_t j = 0; j < 3; ++j) {
        if (surface.source_point[corner[j]] == surface.point[v]) weight[j] = 1;
      }
      if (weight == Point3{0, 0, 0}) {
        weight = weights_in_space({mesh.position[corner[0]], mesh.position[corner[1]], mesh.position[corner[2]]},
                                  surface.position[v]);
      }
      for (size_t j = 0; j < 3; ++j) {
        found[k] = {found[k][0] + weight[j] * uv[j][0], found[k][1] + weight[j] * uv[j][1]};
      }
    }
    result.push_back(found);
  }
  return result;
}

}  // namespace geocloth
