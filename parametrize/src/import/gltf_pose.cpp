// SPDX-License-Identifier: GPL-3.0-or-later
// Skins and morph targets (glTF 2.0, sections 3.7.2.2 and 3.7.3): a point of a skinned mesh is
// sum of weight * (joint's matrix in the world) * (inverse bind matrix) * point, and the transform of the mesh's own
// node does not count. Where all joints stand as they were bound, that is one matrix for all points: then the mesh is
// left alone and only placed, so that what lies at one place in the file still does.
#include "import/gltf_pose.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "import/gltf_nodes.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

/// Of a list of triples.
Eigen::Vector3d triple(const std::vector<float>& values, std::size_t i) {
  return {double{values[3 * i]}, double{values[3 * i + 1]}, double{values[3 * i + 2]}};
}

void put_triple(std::vector<float>& values, std::size_t i, const Eigen::Vector3d& v) {
  for (Eigen::Index k = 0; k < 3; ++k) values[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(v[k]);
}

std::size_t add_triples(GltfData& data, const std::vector<float>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return data.add_accessor(5126, "VEC3", values.size() / 3, std::move(bytes));
}

/// Normals go by the inverse transpose; a flat matrix has none, and then its own turn has to do.
Eigen::Vector3d placed_normal(const Eigen::Matrix4d& m, const Eigen::Vector3d& n) {
  const Eigen::Matrix3d a = m.topLeftCorner<3, 3>();
  Eigen::Matrix3d inverse;
  bool invertible = false;
  a.computeInverseWithCheck(inverse, invertible);
  const Eigen::Vector3d turned = (invertible ? Eigen::Matrix3d(inverse.transpose()) : a) * n;
  return turned.squaredNorm() > 0 ? turned.normalized() : n;
}

class Poser {
 public:
  Poser(GltfFile& gltf, GltfData& data) : gltf_(gltf), data_(data), parent_(node_parents(gltf)) {
    uses_.resize(gltf.array("meshes").size());
    for (const Json& node : nodes()) {
      if (node.contains("mesh")) ++uses_[node["mesh"].get<std::size_t>()];
    }
  }

  void pose() {
    const std::size_t count = nodes().size();
    for (std::size_t i = 0; i < count; ++i) {
      if (nodes()[i].contains("mesh")) pose_node(i);
    }
    // Targets that move nothing are not read, and those of tangents need tangents that the mesh may not have.
    for (std::size_t mesh = 0; mesh < gltf_.array("meshes").size(); ++mesh) {
      for (Json& primitive : primitives(mesh)) primitive.erase("targets");
    }
  }

 private:
  [[nodiscard]] const Json& nodes() const { return gltf_.array("nodes"); }
  [[nodiscard]] Json& primitives(std::size_t mesh) const { return gltf_.json["meshes"][mesh]["primitives"]; }

  [[nodiscard]] Eigen::Matrix4d world_matrix(std::size_t node) const {
    Eigen::Matrix4d out = local_matrix(nodes()[node]);
    while ((node = parent_[node]) < parent_.size()) out = local_matrix(nodes()[node]) * out;
    return out;
  }

  void pose_node(std::size_t node) {
    const std::vector<double> weights = morph_weights(gltf_, node);
    if (std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; })) bake_morph(node, weights);
    if (!nodes()[node].contains("skin")) return;
    const std::vector<Eigen::Matrix4d> joints = joint_matrices(nodes()[node]["skin"].get<std::size_t>());
    const auto posed = nodes()[node]["mesh"].get<std::size_t>();
    if (!has_joints(posed)) return;
    if (const std::optional<Eigen::Matrix4d> all = common_matrix(posed, joints)) {
      move_to_root(node, *all);
      return;
    }
    bake_skin(node, joints);
    move_to_root(node, Eigen::Matrix4d::Identity());
  }

  [[nodiscard]] std::vector<Eigen::Matrix4d> joint_matrices(std::size_t skin) const {
    const std::vector<Eigen::Matrix4d> inverse = inverse_bind_matrices(gltf_, data_, skin);
    std::vector<Eigen::Matrix4d> out;
    for (const Json& joint : gltf_.json["skins"][skin]["joints"]) {
      Eigen::Matrix4d matrix = world_matrix(joint.get<std::size_t>());
      if (!inverse.empty()) matrix *= inverse[out.size()];
      out.push_back(matrix);
    }
    return out;
  }

  [[nodiscard]] SkinWeights skin_weights(const Json& attributes, std::size_t joints) const {
    SkinWeights weights = read_skin_weights(data_, attributes);
    check_joints(gltf_, weights, joints);
    return weights;
  }

  [[nodiscard]] bool has_joints(std::size_t mesh) const {
    return std::any_of(primitives(mesh).begin(), primitives(mesh).end(),
                       [](const Json& p) { return p["attributes"].contains("JOINTS_0"); });
  }

  /// The one matrix that takes all points of the mesh where its joints take them, if there is one.
  [[nodiscard]] std::optional<Eigen::Matrix4d> common_matrix(std::size_t mesh,
                                                             const std::vector<Eigen::Matrix4d>& joints) const {
    std::optional<Eigen::Matrix4d> first;
    Eigen::AlignedBox3d box;
    double moved = 0;
    for (const Json& primitive : primitives(mesh)) {
      const Json& attributes = primitive["attributes"];
      if (!attributes.contains("JOINTS_0")) return std::nullopt;
      const SkinWeights skin = skin_weights(attributes, joints.size());
      const std::vector<float> position = data_.floats(attributes["POSITION"].get<std::size_t>());
      for (std::size_t i = 0; 3 * i < position.size(); ++i) {
        const Eigen::Matrix4d matrix = skin.blend(i, std::span(joints));
        if (!first) first = matrix;
        const Eigen::Vector3d at = placed(*first, triple(position, i));
        box.extend(at);
        moved = std::max(moved, (placed(matrix, triple(position, i)) - at).norm());
      }
    }
    const bool one = first && first->allFinite() && moved <= kPoseAtRest * box.diagonal().norm();
    return one ? first : std::nullopt;
  }

  /// A mesh that no other node shows, so that it can be changed.
  std::size_t own_mesh(std::size_t node) {
    const auto mesh = nodes()[node]["mesh"].get<std::size_t>();
    if (uses_[mesh] == 1) return mesh;
    --uses_[mesh];
    uses_.push_back(1);
    Json copy = gltf_.json["meshes"][mesh];
    gltf_.json["meshes"].push_back(std::move(copy));
    gltf_.json["nodes"][node]["mesh"] = uses_.size() - 1;
    return uses_.size() - 1;
  }

  void bake_morph(std::size_t node, const std::vector<double>& weights) {
    for (Json& primitive : primitives(own_mesh(node))) {
      if (!primitive.contains("targets")) continue;
      for (const char* name : {"POSITION", "NORMAL"}) {
        if (primitive["attributes"].contains(name)) add_targets(primitive, name, weights);
      }
      primitive.erase("targets");
    }
  }

  void add_targets(Json& primitive, const char* name, const std::vector<double>& weights) {
    std::vector<float> values = data_.floats(primitive["attributes"][name].get<std::size_t>());
    const Json& targets = primitive["targets"];
    for (std::size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
      if (weights[t] == 0 || !targets[t].contains(name)) continue;
      add_target(values, data_.floats(targets[t][name].get<std::size_t>()), weights[t]);
    }
    primitive["attributes"][name] = add_triples(data_, values);
  }

  void bake_skin(std::size_t node, const std::vector<Eigen::Matrix4d>& joints) {
    const Eigen::Matrix4d world = world_matrix(node);
    for (Json& primitive : primitives(own_mesh(node))) {
      Json& attributes = primitive["attributes"];
      std::optional<SkinWeights> skin;
      if (attributes.contains("JOINTS_0")) skin = skin_weights(attributes, joints.size());
      for (const auto& [name, take] :
           {std::pair{"POSITION", &placed<Eigen::Matrix4d>}, std::pair{"NORMAL", &placed_normal}}) {
        if (!attributes.contains(name)) continue;
        std::vector<float> values = data_.floats(attributes[name].get<std::size_t>());
        for (std::size_t i = 0; 3 * i < values.size(); ++i) {
          put_triple(values, i, take(skin ? skin->blend(i, std::span(joints)) : world, triple(values, i)));
        }
        attributes[name] = add_triples(data_, values);
      }
    }
  }

  /// Hangs the mesh of a node on one without parent, in every scene that shows it.
  void move_to_root(std::size_t node, const Eigen::Matrix4d& matrix) {
    Json& all = gltf_.json["nodes"];
    const std::size_t moved = all.size();
    Json root = {{"mesh", all[node]["mesh"]}, {"skin", all[node]["skin"]}, {"matrix", Json::array()}};
    for (Eigen::Index k = 0; k < 16; ++k) root["matrix"].push_back(matrix.data()[k]);
    if (all[node].contains("name")) root["name"] = all[node]["name"];
    for (const char* key : {"mesh", "skin"}) all[node].erase(key);
    all.push_back(std::move(root));
    while (parent_[node] < parent_.size()) node = parent_[node];
    if (!gltf_.json.contains("scenes")) return;
    for (Json& scene : gltf_.json["scenes"]) {
      if (!scene.contains("nodes")) continue;
      Json& roots = scene["nodes"];
      if (std::find(roots.begin(), roots.end(), Json(node)) != roots.end()) roots.push_back(moved);
    }
  }

  GltfFile& gltf_;
  GltfData& data_;
  std::vector<std::size_t> parent_;  ///< of each node of the file; their number for those that have none
  std::vector<std::size_t> uses_;    ///< of each mesh, by nodes
};

}  // namespace

void pose_meshes(GltfFile& gltf, GltfData& data) {
  Poser(gltf, data).pose();
}

}  // namespace geocloth::import_detail
