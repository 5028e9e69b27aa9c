// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include <assimp/scene.h>

#include "geocloth/parametrize/mesh.h"
#include "import/assimp_file.h"
#include "import/scene_pose.h"

namespace geocloth::import_detail {

/// Ends the names of the nodes that assimp makes of parts of one FBX model, "hip_$AssimpFbx$_PreRotation".
inline constexpr std::string_view kFbxHelper = "_$AssimpFbx$";

/// A vertex of the TriangleMesh, and where it comes from.
struct ShownVertex {
  uint32_t number;
  std::optional<unsigned> vertex;  ///< of the aiMesh; none for a point that no face has
  aiVector3D position;             ///< in the aiMesh
};

/// What a node of assimp's scene shows of a mesh.
struct ShownMesh {
  const aiNode* node;
  const aiMesh* mesh;
  std::vector<ShownVertex> vertex;  ///< those that are no other one's
  ScenePose::Matrices matrices;     ///< from the aiMesh to the world, in the scene's unit
};

struct SceneMesh {
  TriangleMesh mesh;
  std::vector<ShownMesh> shown;  ///< of FBX and DAE; each vertex is in one of them
};

/// The rotation that turns an FBX file's up axis to +y and its front axis to +z; assimp leaves them as they are.
[[nodiscard]] aiMatrix4x4 upright(const aiScene& scene);

/// Collects vertices, polygons, part ranges and pictures from assimp's scene, in the order of the file.
/// @param scale  metres per unit of the scene
[[nodiscard]] SceneMesh mesh_of_scene(const std::filesystem::path& path, AssimpFile& file, double scale);

}  // namespace geocloth::import_detail
