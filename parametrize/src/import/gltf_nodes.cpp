// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/gltf_nodes.h"

#include <algorithm>
#include <string>

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

}  // namespace

std::vector<double> gltf_numbers(const Json& object, const char* key) {
  std::vector<double> out;
  const auto it = object.find(key);
  if (it == object.end() || !it->is_array()) return out;
  for (const Json& value : *it) out.push_back(value.is_number() ? value.get<double>() : 0);
  return out;
}

NodePlace node_place(const Json& node) {
  const std::vector<double> t = gltf_numbers(node, "translation"), r = gltf_numbers(node, "rotation"),
                            s = gltf_numbers(node, "scale");
  NodePlace out;
  if (!t.empty()) out.translation = {t[0], t[1], t[2]};
  if (!r.empty()) out.rotation = {r[3], r[0], r[1], r[2]};
  if (!s.empty()) out.scale = {s[0], s[1], s[2]};
  return out;
}

Eigen::Matrix4d local_matrix(const Json& node) {
  const std::vector<double> matrix = gltf_numbers(node, "matrix");
  if (!matrix.empty()) return Eigen::Map<const Eigen::Matrix4d>(matrix.data());
  return node_place(node).matrix();
}

std::vector<std::size_t> node_parents(const GltfFile& gltf) {
  const Json& nodes = gltf.array("nodes");
  std::vector<std::size_t> parent(nodes.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains("children")) continue;
    for (const Json& child : nodes[i]["children"]) parent[child.get<std::size_t>()] = i;
  }
  return parent;
}

std::vector<bool> shown_nodes(const GltfFile& gltf) {
  const Json& nodes = gltf.array("nodes");
  const Json& scenes = gltf.array("scenes");
  std::vector<bool> shown(nodes.size(), scenes.empty());
  if (scenes.empty()) return shown;
  std::vector<std::size_t> open;
  const auto add = [&](const Json& of, const char* list) {
    if (!of.contains(list)) return;
    for (const Json& node : of[list]) open.push_back(node.get<std::size_t>());
  };
  add(scenes[gltf.reference(gltf.json, "scene", "scenes", "glTF").value_or(0)], "nodes");
  while (!open.empty()) {
    const std::size_t node = open.back();
    open.pop_back();
    if (shown[node]) continue;
    shown[node] = true;
    add(nodes[node], "children");
  }
  return shown;
}

std::vector<double> morph_weights(const GltfFile& gltf, std::size_t node) {
  const Json& json = gltf.array("nodes")[node];
  std::vector<double> weights = gltf_numbers(json, "weights");
  if (weights.empty()) weights = gltf_numbers(gltf.json["meshes"][json["mesh"].get<std::size_t>()], "weights");
  return weights;
}

std::vector<std::size_t> count_targets(const GltfFile& gltf) {
  std::vector<std::size_t> out;
  for (const Json& mesh : gltf.array("meshes")) {
    out.push_back(0);
    for (const Json& primitive : mesh["primitives"]) {
      if (primitive.contains("targets")) out.back() = std::max(out.back(), primitive["targets"].size());
    }
  }
  return out;
}

std::vector<Eigen::Matrix4d> inverse_bind_matrices(const GltfFile& gltf, const GltfData& data, std::size_t skin) {
  const Json& json = gltf.array("skins")[skin];
  std::vector<Eigen::Matrix4d> out;
  if (!json.contains("inverseBindMatrices")) return out;
  const std::vector<float> values = data.floats(json["inverseBindMatrices"].get<std::size_t>());
  for (std::size_t i = 0; i < json["joints"].size(); ++i) {
    out.emplace_back(Eigen::Map<const Eigen::Matrix4f>(values.data() + 16 * i).cast<double>());
  }
  return out;
}

SkinWeights read_skin_weights(const GltfData& data, const Json& attributes) {
  struct Set {
    std::vector<float> joint, weight;
  };
  std::vector<Set> sets;
  for (std::size_t i = 0; attributes.contains("JOINTS_" + std::to_string(i)); ++i) {
    sets.push_back({data.floats(attributes["JOINTS_" + std::to_string(i)].get<std::size_t>()),
                    data.floats(attributes["WEIGHTS_" + std::to_string(i)].get<std::size_t>())});
  }
  SkinWeights out;
  std::vector<SkinWeights::Hold> holds;
  for (std::size_t vertex = 0; 4 * vertex < sets[0].joint.size(); ++vertex) {
    holds.clear();
    for (const Set& set : sets) {
      for (std::size_t k = 4 * vertex; k < 4 * vertex + 4; ++k) {
        holds.push_back({static_cast<uint32_t>(set.joint[k]), set.weight[k]});
      }
    }
    out.add(holds);
  }
  return out;
}

void check_joints(const GltfFile& gltf, const SkinWeights& weights, std::size_t joints) {
  if (weights.joints_needed() > joints) gltf.bad("a mesh names a joint that its skin lacks");
}

}  // namespace geocloth::import_detail
