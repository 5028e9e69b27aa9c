// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp's reader takes on trust in a glTF scene: indices, counts and the node graph (glTF 2.0, section 3).
#include "import/gltf_check.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "import/gltf_compression.h"
#include "import/gltf_nodes.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

constexpr std::size_t kMaxNodeDepth = 512;

/// Extensions that may be required: they are decoded, or change how the surface looks or where bytes of pictures are.
bool is_harmless(std::string_view extension) {
  return extension == kMeshopt || extension == kDraco || extension.starts_with("KHR_materials_") ||
         extension.starts_with("KHR_lights_") || extension == "KHR_texture_transform" ||
         extension == "KHR_mesh_quantization" || extension == "KHR_texture_basisu" || extension == "EXT_texture_webp" ||
         extension == "EXT_texture_avif" || extension == "KHR_xmp_json_ld" || extension == "KHR_animation_pointer";
}

std::string remedy(const std::string& extension) {
  if (extension.find("compression") != std::string::npos) {
    return "its mesh is compressed; decompress it with 'npx @gltf-transform/cli copy IN.glb OUT.glb' or export it "
           "without compression";
  }
  return "export the mesh without it";
}

void refuse_extension(const GltfFile& gltf, const std::string& name) {
  if (is_harmless(name)) return;
  fail(gltf.path, ErrorCode::unsupported, "needs the glTF extension " + name.substr(0, 80) + ": " + remedy(name));
}

class SceneCheck {
 public:
  SceneCheck(const GltfFile& gltf, const GltfData& data) : gltf_(gltf), data_(data) {}

  void check() const {
    check_meshes();
    check_skins();
    check_nodes();
    check_references();
  }

 private:
  void check_meshes() const {
    const Json& meshes = gltf_.array("meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const std::string where = label("meshes", i);
      gltf_.check_name(meshes[i], where);
      const auto primitives = meshes[i].find("primitives");
      if (primitives == meshes[i].end() || !primitives->is_array()) gltf_.bad(where + ".primitives is missing");
      for (std::size_t j = 0; j < primitives->size(); ++j) {
        check_primitive((*primitives)[j], where + "." + label("primitives", j));
      }
    }
  }

  void check_primitive(const Json& primitive, const std::string& where) const {
    if (!primitive.is_object()) gltf_.bad(where + " is not an object");
    if (gltf_.number(primitive, "mode", where, 4) > 6) gltf_.bad(where + ".mode is unknown");
    static_cast<void>(gltf_.reference(primitive, "material", "materials", where));
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) gltf_.bad(where + ".attributes is missing");
    if (!attributes->contains("POSITION")) gltf_.bad(where + " has no POSITION");
    const GltfAccessor& position = data_.attribute(*attributes, "POSITION", where);
    if (!position.has_data) refuse_missing_data(primitive, where);
    if (position.components != 3) gltf_.bad(where + ": POSITION is not VEC3");
    for (const auto& [name, value] : attributes->items()) {
      const GltfAccessor& a = data_.attribute(*attributes, name.c_str(), where);
      if (a.count != position.count) gltf_.bad(where + ": " + name.substr(0, 40) + " and POSITION differ in count");
      if (!a.has_data) gltf_.bad(where + ": " + name.substr(0, 40) + " has no data");
      check_attribute_type(name, a, where);
    }
    if (primitive.contains("indices")) {
      const GltfAccessor& indices = data_.attribute(primitive, "indices", where);
      if (indices.components != 1) gltf_.bad(where + ".indices are not scalars");
      if (!indices.has_data || indices.bytes.empty() != (indices.count == 0)) {
        if (indices.count > 0) refuse_missing_data(primitive, where);
      }
      data_.check_indices(indices, position.count, where + ".indices");
    }
    check_targets(primitive, position.count, where);
  }

  [[noreturn]] void refuse_missing_data(const Json& primitive, const std::string& where) const {
    const auto extensions = primitive.find("extensions");
    if (extensions != primitive.end() && extensions->is_object()) {
      for (const auto& [name, value] : extensions->items()) refuse_extension(gltf_, name);
    }
    gltf_.bad(where + " refers to an accessor without data");
  }

  /// @param tangent  components of one: a morph target's lacks the handedness
  void check_attribute_type(const std::string& name, const GltfAccessor& a, const std::string& where,
                            std::size_t tangent = 4) const {
    const auto is = [&](std::string_view semantic, std::size_t components) {
      if (name.starts_with(semantic) && a.components != components) {
        gltf_.bad(where + ": " + name.substr(0, 40) + " has the wrong type");
      }
    };
    is("NORMAL", 3);
    is("TANGENT", tangent);
    is("TEXCOORD_", 2);
    is("JOINTS_", 4);
    is("WEIGHTS_", 4);
    if (name.starts_with("COLOR_") && a.components != 3 && a.components != 4)
      gltf_.bad(where + ": COLOR has the wrong type");
  }

  void check_targets(const Json& primitive, std::size_t count, const std::string& where) const {
    const auto targets = primitive.find("targets");
    if (targets == primitive.end()) return;
    if (!targets->is_array()) gltf_.bad(where + ".targets is not an array");
    for (const Json& target : *targets) {
      if (!target.is_object()) gltf_.bad(where + ".targets holds something that is not an object");
      for (const auto& [name, value] : target.items()) {
        const GltfAccessor& a = data_.attribute(target, name.c_str(), where + ".targets");
        if (a.count != count) gltf_.bad(where + ": a morph target and POSITION differ in count");
        check_attribute_type(name, a, where, 3);
        if (name == "POSITION" && a.components != 3) gltf_.bad(where + ": POSITION of a morph target is not VEC3");
      }
    }
  }

  void check_skins() const {
    const Json& skins = gltf_.array("skins");
    for (std::size_t i = 0; i < skins.size(); ++i) {
      const std::string where = label("skins", i);
      gltf_.check_name(skins[i], where);
      static_cast<void>(gltf_.reference(skins[i], "skeleton", "nodes", where));
      const auto joints = skins[i].find("joints");
      if (joints == skins[i].end() || !joints->is_array() || joints->empty()) gltf_.bad(where + ".joints is missing");
      for (const Json& joint : *joints) static_cast<void>(gltf_.index(joint, "nodes", where + ".joints"));
      if (!skins[i].contains("inverseBindMatrices")) continue;
      const GltfAccessor& matrices = data_.attribute(skins[i], "inverseBindMatrices", where);
      if (matrices.components != 16 || matrices.component_type != 5126 || !matrices.has_data ||
          matrices.count < joints->size()) {
        gltf_.bad(where + ".inverseBindMatrices does not have a matrix for every joint");
      }
    }
  }

  void check_nodes() const {
    const Json& nodes = gltf_.array("nodes");
    std::vector<std::size_t> parent(nodes.size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::string where = label("nodes", i);
      gltf_.check_name(nodes[i], where);
      gltf_.check_numbers(nodes[i], "matrix", 16, where);
      gltf_.check_numbers(nodes[i], "translation", 3, where);
      gltf_.check_numbers(nodes[i], "rotation", 4, where);
      gltf_.check_numbers(nodes[i], "scale", 3, where);
      check_node_skin(nodes[i], where);
      const auto children = nodes[i].find("children");
      if (children == nodes[i].end()) continue;
      if (!children->is_array()) gltf_.bad(where + ".children is not an array");
      for (const Json& value : *children) {
        const std::size_t child = gltf_.index(value, "nodes", where + ".children");
        if (parent[child] != nodes.size()) gltf_.bad(label("nodes", child) + " has two parents");
        parent[child] = i;
      }
    }
    check_depth(parent);
    const Json& scenes = gltf_.array("scenes");
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const auto roots = scenes[i].find("nodes");
      if (roots == scenes[i].end()) continue;
      if (!roots->is_array()) gltf_.bad(label("scenes", i) + ".nodes is not an array");
      for (const Json& root : *roots) static_cast<void>(gltf_.index(root, "nodes", label("scenes", i) + ".nodes"));
    }
    static_cast<void>(gltf_.reference(gltf_.json, "scene", "scenes", "glTF"));
  }

  void check_node_skin(const Json& node, const std::string& where) const {
    const auto mesh = gltf_.reference(node, "mesh", "meshes", where);
    const auto skin = gltf_.reference(node, "skin", "skins", where);
    if (!mesh || !skin) return;
    const std::size_t joints = gltf_.array("skins")[*skin]["joints"].size();
    for (const Json& primitive : gltf_.array("meshes")[*mesh]["primitives"]) {
      const Json& attributes = primitive["attributes"];
      if (attributes.contains("JOINTS_0") != attributes.contains("WEIGHTS_0")) {
        gltf_.bad(where + ": its mesh has joints without weights");
      }
      for (const auto& [name, value] : attributes.items()) {
        if (!name.starts_with("JOINTS_")) continue;
        if (!attributes.contains("WEIGHTS_" + name.substr(7)))
          gltf_.bad(where + ": its mesh has joints without weights");
        check_joints(data_.attribute(attributes, name.c_str(), where), joints, where);
      }
    }
  }

  void check_joints(const GltfAccessor& a, std::size_t joints, const std::string& where) const {
    if (a.component_type != 5121 && a.component_type != 5123) gltf_.bad(where + ": JOINTS_0 has the wrong type");
    if (!a.sparse.empty()) check_joints(a.sparse[1], joints, where);
    if (a.bytes.empty()) return;
    for (std::size_t i = 0; i < a.count; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        uint32_t value = 0;
        std::memcpy(&value, a.bytes.data() + i * a.stride + k * a.component_size, a.component_size);
        if (value >= joints)
          gltf_.bad(where + ": JOINTS_0 names joint " + std::to_string(value) + " of " + std::to_string(joints));
      }
    }
  }

  /// The hierarchy has to be a forest of bounded depth: assimp descends it by recursion.
  void check_depth(const std::vector<std::size_t>& parent) const {
    for (std::size_t i = 0; i < parent.size(); ++i) {
      std::size_t steps = 0;
      for (std::size_t at = i; at < parent.size(); at = parent[at]) {
        if (++steps > kMaxNodeDepth) gltf_.bad("its nodes form a circle or nest more than 512 levels deep");
      }
    }
  }

  void check_references() const {
    const Json& textures = gltf_.array("textures");
    for (std::size_t i = 0; i < textures.size(); ++i) {
      static_cast<void>(gltf_.reference(textures[i], "source", "images", label("textures", i)));
      static_cast<void>(gltf_.reference(textures[i], "sampler", "samplers", label("textures", i)));
    }
    const Json& images = gltf_.array("images");
    for (std::size_t i = 0; i < images.size(); ++i) {
      gltf_.check_name(images[i], label("images", i));
      static_cast<void>(gltf_.reference(images[i], "bufferView", "bufferViews", label("images", i)));
    }
    const Json& materials = gltf_.array("materials");
    for (std::size_t i = 0; i < materials.size(); ++i) {
      gltf_.check_name(materials[i], label("materials", i));
      check_texture_slots(materials[i], label("materials", i));
    }
    const Json& animations = gltf_.array("animations");
    for (std::size_t i = 0; i < animations.size(); ++i) check_animation(animations[i], label("animations", i));
  }

  void check_texture_slots(const Json& object, const std::string& where) const {
    for (const auto& [name, value] : object.items()) {
      if (!value.is_object()) continue;
      if (name.ends_with("Texture")) {
        if (!value.contains("index")) gltf_.bad(where + "." + name.substr(0, 60) + ".index is missing");
        static_cast<void>(gltf_.index(value["index"], "textures", where + "." + name.substr(0, 60) + ".index"));
      } else if (name == "pbrMetallicRoughness" || name == "extensions" || name.starts_with("KHR_")) {
        check_texture_slots(value, where + "." + name.substr(0, 60));
      }
    }
  }

  void check_animation(const Json& animation, const std::string& where) const {
    gltf_.check_name(animation, where);
    const auto samplers = animation.find("samplers"), channels = animation.find("channels");
    if (samplers == animation.end() || !samplers->is_array() || channels == animation.end() || !channels->is_array()) {
      gltf_.bad(where + " has no samplers or channels");
    }
    for (const Json& sampler : *samplers) {
      if (!sampler.is_object() || !sampler.contains("input") || !sampler.contains("output")) {
        gltf_.bad(where + " has a sampler without input or output");
      }
      if (!data_.attribute(sampler, "input", where).has_data || !data_.attribute(sampler, "output", where).has_data) {
        gltf_.bad(where + " has a sampler without data");
      }
    }
    for (const Json& channel : *channels) {
      if (!channel.is_object() || !channel.contains("target") || !channel["target"].is_object()) {
        gltf_.bad(where + " has a channel without target");
      }
      if (gltf_.number(channel, "sampler", where + ".channels") >= samplers->size())
        gltf_.bad(where + " names a missing sampler");
      static_cast<void>(gltf_.reference(channel["target"], "node", "nodes", where + ".channels.target"));
    }
  }

  const GltfFile& gltf_;
  const GltfData& data_;
};

}  // namespace

void check_extensions(const GltfFile& gltf) {
  const auto required = gltf.json.find("extensionsRequired");
  if (required == gltf.json.end()) return;
  if (!required->is_array()) gltf.bad("'extensionsRequired' is not an array");
  for (const Json& name : *required) {
    if (!name.is_string()) gltf.bad("'extensionsRequired' holds something that is not text");
    refuse_extension(gltf, name.get<std::string>());
  }
}

void check_scene(const GltfFile& gltf, const GltfData& data) {
  SceneCheck(gltf, data).check();
}

std::vector<std::string> find_left_out(const GltfFile& gltf) {
  const Json& nodes = gltf.array("nodes");
  const std::vector<bool> shown = shown_nodes(gltf);
  std::size_t hidden = 0, repeated = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains("mesh")) continue;
    if (!shown[i]) {
      ++hidden;
    } else if (gltf.extension(nodes[i], "EXT_mesh_gpu_instancing", label("nodes", i)) != nullptr) {
      ++repeated;
    }
  }
  const auto count = [](std::size_t n, const char* one, const char* many) {
    return n == 1 ? std::string("1 ") + one : std::to_string(n) + ' ' + many;
  };
  std::vector<std::string> out;
  if (repeated > 0) {
    out.push_back(count(repeated, "node stands", "nodes stand") +
                  " for many copies (EXT_mesh_gpu_instancing), of which one is converted, in the node's own place; "
                  "make the copies real where the file is exported to have all");
  }
  if (hidden > 0) {
    out.push_back(count(hidden, "mesh of the file is", "meshes of the file are") +
                  " left out: not in the scene with which it opens");
  }
  return out;
}

}  // namespace geocloth::import_detail
