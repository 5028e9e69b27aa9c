// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the project's own meshes into a folder: garments/*.obj and defects/*.obj. Same program, same bytes; the files
// in the repository were made by it.
#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "geocloth/asset/output_file.h"
#include "mesh_file.h"

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
  return text;
}

namespace {

void write_all(const std::filesystem::path& folder, const std::vector<ObjMesh>& meshes) {
  std::filesystem::create_directories(folder);
  for (const ObjMesh& mesh : meshes) {
    const std::filesystem::path path = folder / (mesh.name + ".obj");
    write_file(path, to_obj(mesh));
    fmt::print("{}: {} vertices, {} faces\n", path.string(), mesh.position.size(), mesh.face.size());
  }
}

}  // namespace
}  // namespace geocloth::meshes

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: make_meshes FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    geocloth::meshes::write_all(folder / "garments", geocloth::meshes::make_garments());
    geocloth::meshes::write_all(folder / "defects", geocloth::meshes::make_defects());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "make_meshes: {}\n", error.what());
    return 1;
  }
}
