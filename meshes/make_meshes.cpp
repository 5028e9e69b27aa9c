// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the project's own meshes into a folder: garments/*.obj, defects/*.obj and bodies/*.glb. Same program, same
// bytes; the files in the repository were made by it.
#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "geocloth/asset/output_file.h"
#include "meshes/mesh_file.h"
#include "meshes/walker.h"

namespace geocloth::meshes {

namespace {

void write_all(const std::filesystem::path& folder, const std::vector<ObjMesh>& meshes) {
  std::filesystem::create_directories(folder);
  for (const ObjMesh& mesh : meshes) {
    const std::filesystem::path path = folder / (mesh.name + ".obj");
    write_file(path, to_obj(mesh));
    fmt::print("{}: {} vertices, {} faces\n", path.string(), mesh.position.size(), mesh.face.size());
  }
}

void write_body(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::filesystem::create_directories(path.parent_path());
  write_file(path, bytes);
  fmt::print("{}: {} bytes\n", path.string(), bytes.size());
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
    geocloth::meshes::write_body(folder / "bodies" / "walker.glb", geocloth::meshes::make_walker());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "make_meshes: {}\n", error.what());
    return 1;
  }
}
