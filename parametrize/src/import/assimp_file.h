// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include "import/import_detail.h"

namespace geocloth::import_detail {

/// A file as assimp read it. No post-processing step of assimp runs: those merge, split and reorder vertices by all
/// attributes at once.
struct AssimpFile {
  /// What assimp takes on trust is checked before it sees the bytes (import_*.cpp), and it reads them from memory.
  /// @param animated  whether animations are wanted, and nodes as they move: those of FBX are chains of nodes then
  /// @throws Error as import_mesh()
  AssimpFile(const std::filesystem::path& file, bool animated);

  Format format;                        ///< obj where an OFF file was read as one
  Assimp::Importer importer;            ///< which owns the scene
  const aiScene* scene = nullptr;       ///< has a root node
  ObjText obj = {};                     ///< of an OBJ file
  std::vector<FilePoints> points = {};  ///< of the meshes of FBX and DAE files
  double applied_unit = 1;              ///< metres per unit of the file that assimp applied
  std::vector<std::string> left_out;    ///< what of the file is not in the scene
};

/// Metres per unit of the scene's coordinates, as the file says.
[[nodiscard]] double metres_per_unit(const AssimpFile& file);

}  // namespace geocloth::import_detail
