// SPDX-License-Identifier: GPL-3.0-or-later
// glTF ahead of assimp, whose reader takes offsets, counts and node graphs on trust: the file is opened (gltf_file),
// its bytes are found and decoded (gltf_data, gltf_compression), everything is checked (gltf_check), skinned and
// morphed meshes are posed (gltf_pose), and what assimp gets is written anew: without animations, cameras, morph
// targets and lights, with buffers as bytes and attributes as floats.
#include <cstring>
#include <utility>

#include "geocloth/asset/output_file.h"
#include "import/gltf_check.h"
#include "import/gltf_compression.h"
#include "import/gltf_data.h"
#include "import/gltf_file.h"
#include "import/gltf_pose.h"
#include "import/import_detail.h"
#include "import/import_files.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

/// Writes an accessor of integers anew as floats (KHR_mesh_quantization).
void make_float(GltfData& data, std::size_t i) {
  if (data.accessor(i).component_type == 5126) return;
  const std::vector<float> values = data.floats(i);
  std::vector<std::byte> bytes(values.size() * sizeof(float));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  data.replace(i, 5126, std::move(bytes));
}

void rewrite_primitive(GltfData& data, Json& primitive) {
  primitive.erase("targets");
  primitive.erase("extensions");
  Json& attributes = primitive["attributes"];
  Json kept = Json::object();
  for (const auto& [name, value] : attributes.items()) {
    const bool wanted = name == "POSITION" || name == "NORMAL" || name == "TEXCOORD_0" || name == "COLOR_0" ||
                        name == "JOINTS_0" || name == "WEIGHTS_0";
    if (!wanted) continue;
    if (name != "JOINTS_0") make_float(data, value.get<std::size_t>());
    kept[name] = value;
  }
  attributes = std::move(kept);
}

/// A picture that is no base64 is left away; it must not cost the mesh.
void rewrite_images(GltfFile& gltf) {
  if (!gltf.json.contains("images")) return;
  for (Json& image : gltf.json["images"]) {
    const auto uri = image.find("uri");
    if (uri == image.end()) continue;
    try {
      if (!uri->is_string()) throw Error(ErrorCode::invalid_data, "uri is not text");
      const std::string& text = uri->get_ref<const std::string&>();
      if (text.starts_with("data:")) static_cast<void>(read_uri(gltf.path, text, "image"));
    } catch (const Error&) {
      image.erase("uri");
    }
  }
}

/// A mesh without a name goes by that of the first node which shows it; assimp would count them.
void name_meshes(Json& json) {
  for (const Json& node : json["nodes"]) {
    if (!node.contains("mesh") || !node.contains("name")) continue;
    Json& mesh = json["meshes"][node["mesh"].get<std::size_t>()];
    if (!mesh.contains("name") || mesh["name"] == "") mesh["name"] = node["name"];
  }
}

/// A file may hold nodes and no scene (glTF 2.0, section 3.5.1): assimp gets one of all that have no parent.
void add_scene(Json& json) {
  if (json.contains("scenes") && !json["scenes"].empty()) return;
  std::vector<bool> is_child(json["nodes"].size(), false);
  for (const Json& node : json["nodes"]) {
    if (!node.contains("children")) continue;
    for (const Json& child : node["children"]) is_child[child.get<std::size_t>()] = true;
  }
  Json roots = Json::array();
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(i);
  }
  json["scenes"] = {{{"nodes", roots}}};
  json["scene"] = 0;
}

/// The checked scene for assimp.
std::vector<MemoryFile> rewrite(GltfFile& gltf, GltfData& data) {
  Json& json = gltf.json;
  for (const char* name : {"animations", "cameras", "extensions", "extensionsUsed", "extensionsRequired"}) {
    json.erase(name);
  }
  for (Json& node : json["nodes"]) {
    for (const char* name : {"camera", "weights", "extensions"}) node.erase(name);
    // assimp takes these matrices for granted.
    if (node.contains("skin") && !json["skins"][node["skin"].get<std::size_t>()].contains("inverseBindMatrices")) {
      node.erase("skin");
    }
  }
  for (Json& mesh : json["meshes"]) {
    mesh.erase("weights");
    for (Json& primitive : mesh["primitives"]) rewrite_primitive(data, primitive);
  }
  name_meshes(json);
  add_scene(json);
  rewrite_images(gltf);
  std::vector<MemoryFile> files(1);
  for (std::size_t i = 0; i < data.buffers().size(); ++i) {
    const GltfFile::Bytes bytes = data.buffers()[i];
    files.push_back({"buffer" + std::to_string(i) + ".bin",
                     std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())});
    json["buffers"][i] = {{"byteLength", bytes.size()}, {"uri", files.back().name}};
  }
  files[0] = {"mesh.gltf", json.dump(-1, ' ', false, Json::error_handler_t::replace)};
  return files;
}

}  // namespace

std::vector<MemoryFile> read_gltf(const std::filesystem::path& file, std::span<const std::byte> bytes, bool binary,
                                  std::vector<std::string>& left_out) {
  GltfFile gltf(file, bytes, binary);
  check_extensions(gltf);
  GltfData data(gltf);
  decode_draco(gltf, data);
  check_scene(gltf, data);
  left_out = find_left_out(gltf);
  pose_meshes(gltf, data);
  return rewrite(gltf, data);
}

}  // namespace geocloth::import_detail
