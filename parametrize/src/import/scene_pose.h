// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <assimp/scene.h>

namespace geocloth::import_detail {

/// Where the nodes and bones of a DAE or FBX file put its meshes before anything moves; of glTF, gltf_pose.h takes
/// care.
class ScenePose {
 public:
  /// The matrices of the vertices of one mesh.
  struct Matrices {
    aiMatrix4x4 all;                ///< of every vertex, where `each` is empty
    std::vector<aiMatrix4x4> each;  ///< one per vertex, where bones bend the mesh
  };

  /// The world matrix of a node; to be called for every node before matrices().
  void add(const aiNode& node, const aiMatrix4x4& to_world);

  /// A node's own matrix where no bones hold its meshes, or where they hold them just there.
  [[nodiscard]] Matrices matrices(const aiScene& scene, const aiNode& node, const aiMesh& mesh,
                                  const aiMatrix4x4& to_world);

 private:
  /// Of all meshes of a node, so that they hang together.
  struct Verdict {
    bool bends = false;
    aiMatrix4x4 common;  ///< what takes all vertices to where they are, when nothing bends
  };

  [[nodiscard]] Verdict verdict(const aiScene& scene, const aiNode& node, const aiMatrix4x4& to_world) const;
  [[nodiscard]] bool blend(const aiMesh& mesh, std::vector<aiMatrix4x4>& sum, std::vector<float>& weight) const;

  std::map<std::string, aiMatrix4x4, std::less<>> bone_;
  std::map<const aiNode*, Verdict> verdict_;  // of nodes asked for
};

}  // namespace geocloth::import_detail
