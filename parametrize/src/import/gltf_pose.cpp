// SPDX-License-Identifier: GPL-3.0-or-later
// Skins and morph targets (glTF 2.0, sections 3.7.2.2 and 3.7.3): a point of a skinned mesh is
// sum of weight * (joint's matrix in the world) * (inverse bind matrix) * point, and the transform of the mesh's own
// node does not count. Where all joints stand as they were bound, that is one matrix for all points: then the mesh is
// left alone and only placed, so that what lies at one place in the file still does.
#include "import/gltf_pose.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

std::vector<double> numbers(const Json& object, const char* key) {
  std::vector<double> out;
  const auto it = object.find(key);
  if (it == object.end() || !it->is_array()) return out;
  for (const Json& value : *it) out.push_back(value.is_number() ? value.get<double>() : 0);
  return out;
}

Eigen::Matrix4d local_matrix(const Json& node) {
  const std::vector<double> matrix = numbers(node, "matrix"), t = numbers(node, "translation"),
                            r = numbers(node, "rotation"), s = numbers(node, "scale");
  if (!matrix.empty()) return Eigen::Map<const Eigen::Matrix4d>(matrix.data());
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  if (!t.empty()) out.translate(Eigen::Vector3d(t[0], t[1], t[2]));
  if (!r.empty()) out.rotate(Eigen::Quaterniond(r[3], r[0], r[1], r[2]).normalized());
  if (!s.empty()) out.scale(Eigen::Vector3d(s[0], s[1], s[2]));
  return out.matrix();
}

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

/// The joints of one primitive and their weights, several sets of four to a vertex.
class Skin {
 public:
  Skin(const GltfFile& gltf, const GltfData& data, const Json& attributes, const std::vector<Eigen::Matrix4d>& joints)
      : joints_(joints) {
    for (std::size_t set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
      sets_.push_back({data.floats(attributes["JOINTS_" + std::to_string(set)].get<std::size_t>()),
                       data.floats(attributes["WEIGHTS_" + std::to_string(set)].get<std::size_t>())});
      for (const float joint : sets_.back().joint) {
        if (!(static_cast<std::size_t>(joint) < joints.size())) gltf.bad("a mesh names a joint that its skin lacks");
      }
    }
  }

  /// The matrix that takes vertex `i` to the world.
  [[nodiscard]] Eigen::Matrix4d matrix(std::size_t i) const {
    Eigen::Matrix4d blended = Eigen::Matrix4d::Zero();
    double sum = 0;
    for (const Set& set : sets_) {
      for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
        if (set.weight[k] == 0) continue;
        blended += double{set.weight[k]} * joint(set, k);
        sum += double{set.weight[k]};
      }
    }
    return sum > 0 ? Eigen::Matrix4d(blended / sum) : joint(sets_[0], 4 * i);
  }

 private:
  struct Set {
    std::vector<float> joint, weight;
  };

  [[nodiscard]] const Eigen::Matrix4d& joint(const Set& set, std::size_t k) const {
    return joints_[static_cast<std::size_t>(set.joint[k])];
  }

  const std::vector<Eigen::Matrix4d>& joints_;
  std::vector<Set> sets_;
};

Eigen::Vector3d placed(const Eigen::Matrix4d& m, const Eigen::Vector3d& p) {
  return m.topLeftCorner<3, 3>() * p + m.topRightCorner<3, 1>();
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
  Poser(GltfFile& gltf, GltfData& data) : gltf_(gltf), data_(data), parent_(nodes().size(), nodes().size()) {
    uses_.resize(gltf.array("meshes").size());
    for (std::size_t i = 0; i < nodes().size(); ++i) {
      if (nodes()[i].contains("mesh")) ++uses_[nodes()[i]["mesh"].get<std::size_t>()];
      if (!nodes()[i].contains("children")) continue;
      for (const Json& child : nodes()[i]["children"]) parent_[child.get<std::size_t>()] = i;
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
    const auto mesh = nodes()[node]["mesh"].get<std::size_t>();
    const std::vector<double> weights = morph_weights(node, mesh);
    if (!weights.empty()) bake_morph(node, weights);
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

  /// Empty where they change nothing.
  [[nodiscard]] std::vector<double> morph_weights(std::size_t node, std::size_t mesh) const {
    std::vector<double> weights = numbers(nodes()[node], "weights");
    if (weights.empty()) weights = numbers(gltf_.json["meshes"][mesh], "weights");
    const bool any = std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
    return any ? weights : std::vector<double>{};
  }

  [[nodiscard]] std::vector<Eigen::Matrix4d> joint_matrices(std::size_t skin) const {
    const Json& json = gltf_.json["skins"][skin];
    std::vector<float> inverse;
    if (json.contains("inverseBindMatrices")) inverse = data_.floats(json["inverseBindMatrices"].get<std::size_t>());
    std::vector<Eigen::Matrix4d> out;
    for (const Json& joint : json["joints"]) {
      Eigen::Matrix4d matrix = world_matrix(joint.get<std::size_t>());
      if (!inverse.empty()) {
        matrix *= Eigen::Map<const Eigen::Matrix4f>(inverse.data() + 16 * out.size()).cast<double>();
      }
      out.push_back(matrix);
    }
    return out;
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
      const Skin skin(gltf_, data_, attributes, joints);
      const std::vector<float> position = data_.floats(attributes["POSITION"].get<std::size_t>());
      for (std::size_t i = 0; 3 * i < position.size(); ++i) {
        const Eigen::Matrix4d matrix = skin.matrix(i);
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
      const std::vector<float> way = data_.floats(targets[t][name].get<std::size_t>());
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = static_cast<float>(double{values[i]} + weights[t] * double{way[i]});
      }
    }
    primitive["attributes"][name] = add_triples(data_, values);
  }

  void bake_skin(std::size_t node, const std::vector<Eigen::Matrix4d>& joints) {
    const Eigen::Matrix4d world = world_matrix(node);
    for (Json& primitive : primitives(own_mesh(node))) {
      Json& attributes = primitive["attributes"];
      std::optional<Skin> skin;
      if (attributes.contains("JOINTS_0")) skin.emplace(gltf_, data_, attributes, joints);
      for (const auto& [name, take] : {std::pair{"POSITION", &placed}, std::pair{"NORMAL", &placed_normal}}) {
        if (!attributes.contains(name)) continue;
        std::vector<float> values = data_.floats(attributes[name].get<std::size_t>());
        for (std::size_t i = 0; 3 * i < values.size(); ++i) {
          put_triple(values, i, take(skin ? skin->matrix(i) : world, triple(values, i)));
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
