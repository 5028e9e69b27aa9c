// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/assimp_scene.h"

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <Eigen/LU>

#include "geocloth/parametrize/parts.h"
#include "import/assimp_animation.h"
#include "import/assimp_file.h"
#include "import/import_detail.h"
#include "import/scene_mesh.h"

namespace geocloth::import_detail {
namespace {

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned k = 0; k < 4; ++k) out(i, k) = double{m[i][k]};
  }
  return out;
}

std::optional<Eigen::Matrix4d> inverse_of(const Eigen::Matrix4d& m) {
  const Eigen::FullPivLU<Eigen::Matrix4d> solver(m);
  if (!m.allFinite() || !solver.isInvertible()) return std::nullopt;
  return solver.inverse();
}

/// @param may_keep  whether the matrix can stay where no place stands for it, because it shears
NodePose pose_of(const Eigen::Matrix4d& matrix, bool may_keep) {
  constexpr double kRounding = 1e-5;  // of single precision
  NodePose out;
  out.place = node_place(matrix);
  if (may_keep && !((out.place.matrix() - matrix).norm() <= kRounding * matrix.norm())) out.matrix = matrix;
  return out;
}

class AssimpSceneReader {
 public:
  AssimpSceneReader(const std::filesystem::path& path, const AssimpFile& file, std::span<const ShownMesh> shown)
      : path_(path), file_(file), shown_(shown), work_(path) {
    add_nodes(*file.scene->mRootNode, kNoNode);
    for (const ShownMesh& mesh : shown) {
      std::size_t& targets = targets_[number_.at(mesh.node)];
      targets = std::max<std::size_t>(targets, mesh.mesh->mNumAnimMeshes);
    }
  }

  /// @param scale  metres per unit of the scene
  MovingParts read(const std::string& clip, double scale) {
    MovingParts out(read_assimp_animation(path_, file_, clip, by_name_, targets_));
    for (std::size_t i = 0; i < node_.size(); ++i) {
      out.parent.push_back(std::min(parent_[i], node_.size()));
      out.order.push_back(i);
      out.rest.push_back(pose_of(matrix_of(node_[i]->mTransformation), !out.animation.moves(i)));
      out.rest.back().weight.assign(targets_[i], 0);
    }
    out.to_world = matrix_of(upright_);
    open(out);
    if (file_.format == Format::fbx) rest_helpers(out);
    for (const ShownMesh& mesh : shown_) add_mesh(mesh, out);
    out.to_world.topRows<3>() *= scale;
    return out;
  }

 private:
  static constexpr std::size_t kNoNode = SIZE_MAX;

  /// Parents before children.
  void add_nodes(const aiNode& node, std::size_t parent) {
    const std::size_t number = node_.size();
    number_.emplace(&node, number);
    by_name_.try_emplace(node.mName.C_Str(), number);
    node_.push_back(&node);
    parent_.push_back(parent);
    targets_.push_back(0);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_nodes(*node.mChildren[i], number);
  }

  /// Where the nodes are when the file opens. FBX shows skinned meshes as they were bound, wherever its bones are.
  void open(MovingParts& out) {
    out.opening = out.rest;
    for (std::size_t i = 0; i < node_.size(); ++i) {
      world_.emplace_back((i > 0 ? world_[parent_[i]] : out.to_world) * matrix_of(node_[i]->mTransformation));
    }
    std::vector<bool> is_bound(node_.size(), false);
    if (file_.format == Format::fbx) bind_bones(is_bound);
    for (std::size_t i = 1; i < node_.size(); ++i) {
      if (!is_bound[i] && !is_bound[parent_[i]]) continue;
      const std::optional<Eigen::Matrix4d> inverse = inverse_of(world_[parent_[i]]);
      if (!inverse) continue;
      std::vector<double> weight = std::move(out.opening[i].weight);
      out.opening[i] = pose_of(*inverse * world_[i], true);
      out.opening[i].weight = std::move(weight);
    }
  }

  /// assimp 5.2.5 writes a track for all of a model without pivots, and has its turns before and behind in nodes of
  /// their own all the same: those count only until the animation begins.
  void rest_helpers(MovingParts& out) const {
    for (std::size_t i = 0; i < node_.size(); ++i) {
      if (!out.animation.moves(i)) continue;
      const std::string helper = std::string(node_[i]->mName.C_Str()).append(kFbxHelper);
      for (std::size_t k = parent_[i]; k != kNoNode; k = parent_[k]) {
        if (!std::string_view(node_[k]->mName.C_Str()).starts_with(helper)) break;
        out.rest[k] = NodePose{std::nullopt, {}, std::move(out.rest[k].weight)};
      }
    }
  }

  void bind_bones(std::vector<bool>& is_bound) {
    for (const ShownMesh& mesh : shown_) {
      for (unsigned b = 0; b < mesh.mesh->mNumBones; ++b) {
        const aiBone& bone = *mesh.mesh->mBones[b];
        const auto node = by_name_.find(std::string_view(bone.mName.C_Str()));
        if (node == by_name_.end() || is_bound[node->second]) continue;
        const std::optional<Eigen::Matrix4d> inverse = inverse_of(matrix_of(bone.mOffsetMatrix));
        if (!inverse) continue;
        is_bound[node->second] = true;
        world_[node->second] = matrix_of(mesh.matrices.all) * *inverse;
      }
    }
  }

  void add_mesh(const ShownMesh& shown, MovingParts& out) {
    const std::size_t node = number_.at(shown.node);
    PlacedVertices placed{out.vertices.size(), node, std::nullopt, 0, {}};
    work_.add(shown.vertex.size() * (1 + targets_[node]));
    for (unsigned b = 0; b < shown.mesh->mNumBones; ++b) work_.add(shown.mesh->mBones[b]->mNumWeights);
    AnimatedVertices vertices;
    for (const ShownVertex& v : shown.vertex) {
      placed.number.push_back(v.number);
      put(v.position, vertices.position);
    }
    add_targets(shown, targets_[node], vertices);
    if (std::optional<Joints> joints = joints_of(shown)) {
      placed.skin = out.skin.size();
      vertices.weights = weights_of(shown, joints->node.size() - 1);
      out.skin.push_back(std::move(*joints));
    }
    out.vertices.push_back(std::move(vertices));
    out.vertex_count += shown.vertex.size();
    out.placed.push_back(std::move(placed));
  }

  static void put(const aiVector3D& p, std::vector<float>& to) { to.insert(to.end(), {p.x, p.y, p.z}); }

  /// assimp keeps whole meshes in place of what a target moves.
  static void add_targets(const ShownMesh& shown, std::size_t count, AnimatedVertices& out) {
    const aiMesh& mesh = *shown.mesh;
    out.target.resize(count);
    for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t) {
      const aiAnimMesh& target = *mesh.mAnimMeshes[t];
      if (!target.HasPositions() || target.mNumVertices != mesh.mNumVertices) continue;
      for (const ShownVertex& v : shown.vertex) {
        put(v.vertex ? target.mVertices[*v.vertex] - v.position : aiVector3D(), out.target[t]);
      }
    }
  }

  /// The bones of a mesh, and at last what holds vertices that no bone holds; nothing where bones are missing.
  [[nodiscard]] std::optional<Joints> joints_of(const ShownMesh& shown) const {
    const aiMesh& mesh = *shown.mesh;
    if (mesh.mNumBones == 0) return std::nullopt;
    Joints out;
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const auto node = by_name_.find(std::string_view(mesh.mBones[b]->mName.C_Str()));
      if (node == by_name_.end()) return std::nullopt;
      out.node.push_back(node->second);
      out.inverse_bind.push_back(matrix_of(mesh.mBones[b]->mOffsetMatrix));
    }
    out.node.push_back(number_.at(shown.node));
    const std::optional<Eigen::Matrix4d> inverse = inverse_of(world_[out.node.back()]);
    const bool apart = inverse && shown.matrices.each.empty();
    out.inverse_bind.push_back(apart ? Eigen::Matrix4d(*inverse * matrix_of(shown.matrices.all))
                                     : Eigen::Matrix4d(Eigen::Matrix4d::Identity()));
    return out;
  }

  /// @param loose  the joint of vertices that no bone holds
  [[nodiscard]] static SkinWeights weights_of(const ShownMesh& shown, std::size_t loose) {
    const aiMesh& mesh = *shown.mesh;
    std::vector<std::vector<SkinWeights::Hold>> holds(mesh.mNumVertices);
    for (uint32_t b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      for (const aiVertexWeight& weight : std::span(bone.mWeights, bone.mNumWeights)) {
        if (weight.mVertexId >= mesh.mNumVertices || !(weight.mWeight > 0)) continue;
        holds[weight.mVertexId].push_back({b, weight.mWeight});
      }
    }
    SkinWeights out;
    const std::vector<SkinWeights::Hold> by_node{{static_cast<uint32_t>(loose), 1}};
    for (const ShownVertex& v : shown.vertex) {
      const bool is_held = v.vertex && !holds[*v.vertex].empty();
      out.add(is_held ? holds[*v.vertex] : by_node);
    }
    return out;
  }

  const std::filesystem::path& path_;
  const AssimpFile& file_;
  std::span<const ShownMesh> shown_;
  MovingWork work_;
  aiMatrix4x4 upright_ = file_.format == Format::fbx ? upright(*file_.scene) : aiMatrix4x4();
  std::vector<const aiNode*> node_;
  std::vector<std::size_t> parent_, targets_;  ///< of each node
  std::map<const aiNode*, std::size_t> number_;
  NodesByName by_name_;
  std::vector<Eigen::Matrix4d> world_;  ///< of each node when the file opens, y up, in the scene's unit
};

}  // namespace

ReadScene read_assimp_scene(const std::filesystem::path& path, const AnimationOptions& options) {
  const Format format = format_of(path);
  if (format != Format::fbx && format != Format::dae) {
    fail(path, ErrorCode::unsupported,
         "only glTF, FBX and DAE files (.gltf, .glb, .vrm, .fbx, .dae) can be played; export the animation as one");
  }
  AssimpFile file(path, true);
  const double scale = metres_per_unit(file);
  SceneMesh from = mesh_of_scene(path, file, scale);
  if (from.mesh.triangle.empty()) bad(path, "has no faces; a body needs triangles");
  AssimpSceneReader reader(path, file, from.shown);
  ReadScene out{AnimatedScene(path, reader.read(options.clip, scale), options), {}};
  TriangleMesh& mesh = from.mesh;
  if (!options.parts.empty()) mesh = select_parts(with_choosable_parts(std::move(mesh)), options.parts);
  out.triangle = std::move(mesh.triangle);
  return out;
}

}  // namespace geocloth::import_detail
