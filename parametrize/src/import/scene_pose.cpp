// SPDX-License-Identifier: GPL-3.0-or-later
// A point of a skinned mesh is sum of weight * (bone's matrix in the world) * (bone's offset) * point, as COLLADA 1.4.1
// (chapter 4, "Skin deformation") has it; assimp's offsets hold COLLADA's bind shape. The transform of the
// mesh's own node does not count: exporters leave there what they like, and the mesh's size may stand in the bind shape
// alone.
#include "import/scene_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

bool finite(const aiMatrix4x4& m) {
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned k = 0; k < 4; ++k) {
      if (!std::isfinite(m[i][k])) return false;
    }
  }
  return true;
}

aiMatrix4x4 times(const aiMatrix4x4& m, float factor) {
  aiMatrix4x4 out;
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned k = 0; k < 4; ++k) out[i][k] = m[i][k] * factor;
  }
  return out;
}

aiMatrix4x4 plus(const aiMatrix4x4& a, const aiMatrix4x4& b) {
  aiMatrix4x4 out;
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned k = 0; k < 4; ++k) out[i][k] = a[i][k] + b[i][k];
  }
  return out;
}

/// How far two ways to place points lie apart, and how large what the first one makes is.
class Comparison {
 public:
  void add(const aiVector3D& first, const aiVector3D& second) {
    for (unsigned k = 0; k < 3; ++k) {
      low_[k] = std::min(low_[k], first[k]);
      high_[k] = std::max(high_[k], first[k]);
    }
    apart_ = std::max(apart_, (second - first).Length());
  }
  [[nodiscard]] bool same() const { return apart_ <= static_cast<float>(kPoseAtRest) * (high_ - low_).Length(); }

 private:
  aiVector3D low_{std::numeric_limits<float>::max()}, high_{std::numeric_limits<float>::lowest()};
  float apart_ = 0;
};

}  // namespace

void ScenePose::add(const aiNode& node, const aiMatrix4x4& to_world) {
  bone_.try_emplace(node.mName.C_Str(), to_world);
}

/// @returns false where there are no bones to go by
bool ScenePose::blend(const aiMesh& mesh, std::vector<aiMatrix4x4>& sum, std::vector<float>& weight) const {
  sum.assign(mesh.mNumVertices, times({}, 0));
  weight.assign(mesh.mNumVertices, 0);
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    const auto at = bone_.find(std::string_view(bone.mName.C_Str()));
    if (at == bone_.end()) return false;
    const aiMatrix4x4 matrix = at->second * bone.mOffsetMatrix;
    if (!finite(matrix)) return false;
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const auto [vertex, share] = bone.mWeights[w];
      if (vertex >= mesh.mNumVertices || !(share > 0) || !std::isfinite(share)) continue;
      sum[vertex] = plus(sum[vertex], times(matrix, share));
      weight[vertex] += share;
    }
  }
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    if (weight[i] > 0) sum[i] = times(sum[i], 1 / weight[i]);
  }
  return mesh.mNumBones > 0;
}

ScenePose::Verdict ScenePose::verdict(const aiScene& scene, const aiNode& node, const aiMatrix4x4& to_world) const {
  Verdict result;
  std::vector<aiMatrix4x4> matrix;
  std::vector<float> weight;
  bool any = false;
  Comparison with_node, with_first;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    if (!blend(mesh, matrix, weight)) continue;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      if (weight[i] <= 0) continue;
      if (!any) result.common = matrix[i];
      any = true;
      const aiVector3D at = matrix[i] * mesh.mVertices[i];
      with_node.add(at, to_world * mesh.mVertices[i]);
      with_first.add(at, result.common * mesh.mVertices[i]);
    }
  }
  if (!any || with_node.same()) result.common = to_world;
  result.bends = any && !with_node.same() && !with_first.same();
  return result;
}

ScenePose::Matrices ScenePose::matrices(const aiScene& scene, const aiNode& node, const aiMesh& mesh,
                                        const aiMatrix4x4& to_world) {
  const auto [known, is_new] = verdict_.try_emplace(&node);
  if (is_new) known->second = verdict(scene, node, to_world);
  Matrices out{known->second.common, {}};
  if (!known->second.bends) return out;
  std::vector<float> weight;
  if (!blend(mesh, out.each, weight)) {
    out.each.clear();
    out.all = to_world;
    return out;
  }
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    if (weight[i] <= 0) out.each[i] = to_world;
  }
  return out;
}

}  // namespace geocloth::import_detail
