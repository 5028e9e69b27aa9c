// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_file.h"

#include <cmath>

#include <fmt/format.h>

namespace geocloth::meshes {

std::string to_obj(const ObjMesh& mesh) {
  // Adding zero turns -0.00000 into 0.00000.
  const auto clean = [](double x) { return std::abs(x) < 5e-6 ? 0.0 : x; };
  std::string text = fmt::format("# {}. CC0-1.0.\no {}\n", mesh.comment, mesh.name);
  for (const Point3& p : mesh.position) {
    text += fmt::format("v {:.5f} {:.5f} {:.5f}\n", clean(p[0]), clean(p[1]), clean(p[2]));
  }
  for (const Point2& p : mesh.uv) text += fmt::format("vt {:.5f} {:.5f}\n", clean(p[0]), clean(p[1]));
  for (std::size_t i = 0; i < mesh.face.size(); ++i) {
    text += "f";
    for (std::size_t k = 0; k < mesh.face[i].size(); ++k) {
      text += fmt::format(" {}", mesh.face[i][k] + 1);
      if (!mesh.face_uv.empty()) text += fmt::format("/{}", mesh.face_uv[i][k] + 1);
    }
    text += "\n";
  }
  for (const auto& [a, b] : mesh.line) text += fmt::format("l {} {}\n", a + 1, b + 1);
  return text;
}

}  // namespace geocloth::meshes
