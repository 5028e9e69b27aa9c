// SPDX-License-Identifier: GPL-3.0-or-later
// glTF ahead of assimp, whose reader takes offsets, counts and node graphs on trust. Everything it follows is checked
// here against the glTF 2.0 specification: the GLB container (section 4), bufferViews and accessors (3.6), index
// values, the node hierarchy (3.5: a forest), and the extensions the file requires. What assimp gets is written anew:
// without animations, cameras, morph targets and lights, with buffers as bytes and attributes as floats.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include <nlohmann/json.hpp>

#include "geocloth/asset/output_file.h"
#include "import_detail.h"
#include "import_files.h"

namespace geocloth::import_detail {
namespace {

using Json = nlohmann::json;
using Bytes = std::span<const std::byte>;

constexpr std::size_t kMaxNodeDepth = 512;
constexpr uint32_t kChunkJson = 0x4E4F534A, kChunkBin = 0x004E4942;

/// Extensions that may be required: they change how the surface looks or where bytes of pictures are, not the mesh.
bool is_harmless(std::string_view extension) {
  return extension.starts_with("KHR_materials_") || extension.starts_with("KHR_lights_") ||
         extension == "KHR_texture_transform" || extension == "KHR_mesh_quantization" ||
         extension == "KHR_texture_basisu" || extension == "EXT_texture_webp" || extension == "EXT_texture_avif" ||
         extension == "KHR_xmp_json_ld" || extension == "KHR_animation_pointer";
}

const std::string kDequantize = "run 'npx @gltf-transform/cli dequantize IN.glb OUT.glb'";

std::string remedy(const std::string& extension) {
  if (extension == "KHR_draco_mesh_compression" || extension.find("meshopt_compression") != std::string::npos) {
    return "its mesh is compressed; decompress it with 'npx @gltf-transform/cli copy IN.glb OUT.glb' or export it "
           "without compression";
  }
  return "export the mesh without it";
}

uint32_t read_u32(Bytes bytes, std::size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

class GltfReader {
 public:
  GltfReader(const std::filesystem::path& file, Bytes bytes, bool binary) : file_(file) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (binary) text = split_container(bytes);
    // Counting brackets first keeps whoever parses this text next from recursing without end.
    check_nesting(text);
    json_ = Json::parse(text.begin(), text.end(), nullptr, false);
    if (json_.is_discarded()) bad("its JSON is broken; is the file cut off?");
    if (!json_.is_object()) bad("its JSON is not an object, so this is no glTF file");
  }

  void check() {
    check_version();
    check_extensions();
    check_buffers();
    check_views();
    check_accessors();
    check_meshes();
    check_skins();
    check_nodes();
    check_references();
  }

  /// The scene for assimp; only after check().
  std::vector<MemoryFile> rewrite() {
    for (const char* name : {"animations", "cameras", "extensions", "extensionsUsed", "extensionsRequired"}) {
      json_.erase(name);
    }
    for (Json& node : json_["nodes"]) {
      for (const char* name : {"camera", "weights", "extensions"}) node.erase(name);
      // assimp takes these matrices for granted.
      if (node.contains("skin") && !json_["skins"][node["skin"].get<std::size_t>()].contains("inverseBindMatrices")) {
        node.erase("skin");
      }
    }
    for (Json& mesh : json_["meshes"]) {
      mesh.erase("weights");
      for (Json& primitive : mesh["primitives"]) rewrite_primitive(primitive);
    }
    rewrite_images();
    std::vector<MemoryFile> files(1);
    for (std::size_t i = 0; i < buffer_data_.size(); ++i) {
      const Bytes bytes = buffer_data_[i];
      files.push_back({"buffer" + std::to_string(i) + ".bin",
                       std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())});
      json_["buffers"][i] = {{"byteLength", bytes.size()}, {"uri", files.back().name}};
    }
    files[0] = {"mesh.gltf", json_.dump(-1, ' ', false, Json::error_handler_t::replace)};
    return files;
  }

 private:
  [[noreturn]] void bad(const std::string& what) const { fail(file_, ErrorCode::invalid_data, what); }

  // --- container ---------------------------------------------------------------------------------------------------

  std::string_view split_container(Bytes bytes) {
    if (bytes.size() < 20 || std::memcmp(bytes.data(), "glTF", 4) != 0) bad("this is no GLB file (no 'glTF' header)");
    if (read_u32(bytes, 4) != 2) {
      fail(file_, ErrorCode::unsupported,
           "GLB version " + std::to_string(read_u32(bytes, 4)) + "; only version 2 can be read: export it as glTF 2.0");
    }
    const std::size_t length = read_u32(bytes, 8);
    if (length > bytes.size()) {
      bad("the file is cut off: " + std::to_string(bytes.size()) + " of " + std::to_string(length) + " bytes");
    }
    std::string_view text;
    for (std::size_t at = 12; at + 8 <= length;) {
      const std::size_t size = read_u32(bytes, at);
      const uint32_t kind = read_u32(bytes, at + 4);
      if (size > length - at - 8) bad("a chunk of the GLB container reaches beyond its end");
      const Bytes chunk = bytes.subspan(at + 8, size);
      if (at == 12 && kind != kChunkJson) bad("the first chunk of the GLB container is not JSON");
      if (at == 12) text = {reinterpret_cast<const char*>(chunk.data()), chunk.size()};
      if (kind == kChunkBin && !binary_chunk_) binary_chunk_ = chunk;
      at += 8 + size;
    }
    if (text.empty()) bad("the GLB container holds no JSON");
    return text;
  }

  void check_nesting(std::string_view text) const {
    std::size_t depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      if (quoted) {
        if (c == '\\') ++i;
        quoted = c != '"';
      } else if (c == '"') {
        quoted = true;
      } else if (c == '[' || c == '{') {
        if (++depth > 200) bad("its JSON is nested more than 200 levels deep");
      } else if (c == ']' || c == '}') {
        depth -= depth > 0 ? 1 : 0;
      }
    }
  }

  // --- JSON access -------------------------------------------------------------------------------------------------

  const Json& array(const char* name) const {
    static const Json none = Json::array();
    const auto it = json_.find(name);
    if (it == json_.end()) return none;
    if (!it->is_array()) bad("'" + std::string(name) + "' is not an array");
    for (const Json& element : *it) {
      if (!element.is_object()) bad("'" + std::string(name) + "' holds something that is not an object");
    }
    return *it;
  }

  std::string label(const char* name, std::size_t i) const { return std::string(name) + "[" + std::to_string(i) + "]"; }

  std::size_t number(const Json& object, const char* key, const std::string& where,
                     std::optional<std::size_t> otherwise = std::nullopt) const {
    const auto it = object.find(key);
    if (it == object.end()) {
      if (otherwise) return *otherwise;
      bad(where + "." + key + " is missing");
    }
    return whole(*it, where + "." + key);
  }

  std::size_t whole(const Json& value, const std::string& where) const {
    if (value.is_number_unsigned()) {
      const auto n = value.get<uint64_t>();
      if (n <= (uint64_t{1} << 40U)) return n;
    } else if (value.is_number_float()) {
      const auto d = value.get<double>();
      if (d >= 0 && d <= 1e12 && d == std::floor(d)) bad(where + " is written as a fraction; it must be an integer");
    }
    bad(where + " is not a number in range");
  }

  std::size_t index(const Json& value, const char* target, const std::string& where) const {
    const std::size_t i = whole(value, where);
    if (i >= array(target).size()) {
      bad(where + " is " + std::to_string(i) + ", but there are only " + std::to_string(array(target).size()) + " " +
          target);
    }
    return i;
  }

  /// Index in object[key], or nothing when the key is missing.
  std::optional<std::size_t> reference(const Json& object, const char* key, const char* target,
                                       const std::string& where) const {
    const auto it = object.find(key);
    if (it == object.end()) return std::nullopt;
    return index(*it, target, where + "." + key);
  }

  void check_numbers(const Json& object, const char* key, std::size_t count, const std::string& where) const {
    const auto it = object.find(key);
    if (it == object.end()) return;
    const bool right = it->is_array() && it->size() == count &&
                       std::all_of(it->begin(), it->end(), [](const Json& v) { return v.is_number(); });
    if (!right) bad(where + "." + key + " is not an array of " + std::to_string(count) + " numbers");
  }

  void check_name(const Json& object, const std::string& where) const {
    const auto it = object.find("name");
    if (it != object.end() && !it->is_string()) bad(where + ".name is not text");
  }

  // --- the parts of the file ---------------------------------------------------------------------------------------

  void check_version() const {
    const auto asset = json_.find("asset");
    if (asset == json_.end() || !asset->is_object()) bad("'asset' is missing, so this is no glTF file");
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string()) bad("asset.version is missing");
    if (!version->get_ref<const std::string&>().starts_with("2.")) {
      fail(file_, ErrorCode::unsupported,
           "glTF version '" + version->get<std::string>().substr(0, 16) +
               "'; only 2.0 can be read: export it as glTF 2.0");
    }
  }

  void check_extensions() const {
    const auto required = json_.find("extensionsRequired");
    if (required == json_.end()) return;
    if (!required->is_array()) bad("'extensionsRequired' is not an array");
    for (const Json& name : *required) {
      if (!name.is_string()) bad("'extensionsRequired' holds something that is not text");
      refuse_extension(name.get<std::string>());
    }
  }

  void refuse_extension(const std::string& name) const {
    if (is_harmless(name)) return;
    fail(file_, ErrorCode::unsupported, "needs the glTF extension " + name.substr(0, 80) + ": " + remedy(name));
  }

  void check_buffers() {
    const Json& buffers = array("buffers");
    std::size_t total = 0;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const std::string where = label("buffers", i);
      const std::size_t length = number(buffers[i], "byteLength", where);
      const std::size_t available = buffer_size(buffers[i], i, where);
      if (length > available) {
        bad(where + " has " + std::to_string(available) + " of " + std::to_string(length) + " bytes; is it cut off?");
      }
      buffer_data_.back() = buffer_data_.back().first(length);
      total += length;
      if (total > kMaxFileBytes) fail(file_, ErrorCode::limit, "its buffers hold more than 4 GiB");
    }
  }

  /// Loads the bytes of a buffer so that indices can be looked at. @returns how many there are
  std::size_t buffer_size(const Json& buffer, std::size_t i, const std::string& where) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) {
      if (i != 0 || !binary_chunk_) bad(where + " has neither a uri nor a binary chunk; is the file cut off?");
      buffer_data_.push_back(*binary_chunk_);
    } else {
      if (!uri->is_string()) bad(where + ".uri is not text");
      owned_.push_back(read_uri(file_, uri->get_ref<const std::string&>(), where));
      buffer_data_.push_back(owned_.back());
    }
    return buffer_data_.back().size();
  }

  void check_views() {
    const Json& views = array("bufferViews");
    for (std::size_t i = 0; i < views.size(); ++i) {
      const std::string where = label("bufferViews", i);
      if (!views[i].contains("buffer")) bad(where + ".buffer is missing");
      const std::size_t buffer = index(views[i]["buffer"], "buffers", where + ".buffer");
      const std::size_t offset = number(views[i], "byteOffset", where, 0);
      const std::size_t length = number(views[i], "byteLength", where);
      const std::size_t size = buffer_data_[buffer].size();
      if (offset > size || length > size - offset) {
        bad(where + " reaches beyond buffers[" + std::to_string(buffer) + "]; is the file cut off?");
      }
      const std::size_t stride = number(views[i], "byteStride", where, 0);
      if (stride != 0 && (stride < 4 || stride > 252)) bad(where + ".byteStride is not within 4..252");
      views_.push_back({buffer_data_[buffer].subspan(offset, length), stride});
    }
  }

  struct View {
    Bytes bytes;
    std::size_t stride;
  };
  struct Accessor {
    std::size_t count = 0, component_size = 0, components = 0, component_type = 0;
    bool has_data = false;
    std::size_t stride = 0;
    Bytes bytes;  ///< from its first element on
  };

  static std::size_t size_of_component(std::size_t type) {
    switch (type) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        return 0;
    }
  }

  static std::size_t components_of(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kKinds{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    const auto it = std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return kind.first == type; });
    return it == kKinds.end() ? 0 : it->second;
  }

  /// The bytes of `count` elements in a view.
  Bytes range(const Json& object, const std::string& where, std::size_t count, std::size_t element,
              std::size_t& stride) const {
    const View& view = views_[index(object["bufferView"], "bufferViews", where + ".bufferView")];
    const std::size_t offset = number(object, "byteOffset", where, 0);
    stride = view.stride != 0 ? view.stride : element;
    const std::size_t needed = count == 0 ? 0 : (count - 1) * stride + element;
    if (offset > view.bytes.size() || needed > view.bytes.size() - offset) {
      bad(where + " reaches beyond its bufferView; is the file cut off?");
    }
    return view.bytes.subspan(offset);
  }

  void check_accessors() {
    const Json& accessors = array("accessors");
    for (std::size_t i = 0; i < accessors.size(); ++i) {
      const std::string where = label("accessors", i);
      const Json& json = accessors[i];
      Accessor a;
      a.count = number(json, "count", where);
      if (a.count > kMaxElements) fail(file_, ErrorCode::limit, where + " has more than 100 million elements");
      a.component_type = number(json, "componentType", where);
      a.component_size = size_of_component(a.component_type);
      const auto type = json.find("type");
      a.components = type != json.end() && type->is_string() ? components_of(type->get_ref<const std::string&>()) : 0;
      if (a.component_size == 0 || a.components == 0) bad(where + " has an unknown type");
      if (json.contains("bufferView")) {
        a.bytes = range(json, where, a.count, a.component_size * a.components, a.stride);
        a.has_data = true;
      }
      check_sparse(json, a, where);
      accessors_.push_back(a);
    }
  }

  void check_sparse(const Json& json, Accessor& accessor, const std::string& where) const {
    const auto sparse = json.find("sparse");
    if (sparse == json.end()) return;
    if (!sparse->is_object()) bad(where + ".sparse is not an object");
    const std::size_t count = number(*sparse, "count", where + ".sparse");
    if (count > accessor.count) bad(where + ".sparse.count is greater than its accessor's");
    for (const char* part : {"indices", "values"}) {
      const std::string name = where + ".sparse." + part;
      const auto object = sparse->find(part);
      if (object == sparse->end() || !object->is_object() || !object->contains("bufferView")) bad(name + " is missing");
      const bool indices = std::string_view(part) == "indices";
      Accessor a;
      a.component_type = indices ? number(*object, "componentType", name) : accessor.component_type;
      a.component_size = size_of_component(a.component_type);
      a.components = indices ? 1 : accessor.components;
      a.count = count;
      if (a.component_size == 0) bad(name + " has an unknown type");
      a.bytes = range(*object, name, count, a.component_size * a.components, a.stride);
      if (indices) check_indices(a, accessor.count, name);
    }
    accessor.has_data = true;
  }

  void check_indices(const Accessor& a, std::size_t limit, const std::string& where) const {
    if (a.component_type != 5121 && a.component_type != 5123 && a.component_type != 5125) {
      bad(where + " has indices that are not unsigned integers");
    }
    for (std::size_t i = 0; i < a.count; ++i) {
      uint32_t value = 0;
      std::memcpy(&value, a.bytes.data() + i * a.stride, a.component_size);
      if (value >= limit) {
        bad(where + ": index " + std::to_string(value) + " at " + std::to_string(i) + ", but there are only " +
            std::to_string(limit) + " vertices");
      }
    }
  }

  const Accessor& attribute(const Json& object, const char* key, const std::string& where) const {
    return accessors_[index(object[key], "accessors", where + "." + key)];
  }

  void check_meshes() const {
    const Json& meshes = array("meshes");
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const std::string where = label("meshes", i);
      check_name(meshes[i], where);
      const auto primitives = meshes[i].find("primitives");
      if (primitives == meshes[i].end() || !primitives->is_array()) bad(where + ".primitives is missing");
      for (std::size_t j = 0; j < primitives->size(); ++j) {
        check_primitive((*primitives)[j], where + "." + label("primitives", j));
      }
    }
  }

  void check_primitive(const Json& primitive, const std::string& where) const {
    if (!primitive.is_object()) bad(where + " is not an object");
    if (number(primitive, "mode", where, 4) > 6) bad(where + ".mode is unknown");
    static_cast<void>(reference(primitive, "material", "materials", where));
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) bad(where + ".attributes is missing");
    if (!attributes->contains("POSITION")) bad(where + " has no POSITION");
    const Accessor& position = attribute(*attributes, "POSITION", where);
    if (!position.has_data) refuse_missing_data(primitive, where);
    if (position.components != 3) bad(where + ": POSITION is not VEC3");
    for (const auto& [name, value] : attributes->items()) {
      const Accessor& a = attribute(*attributes, name.c_str(), where);
      if (a.count != position.count) bad(where + ": " + name.substr(0, 40) + " and POSITION differ in count");
      if (!a.has_data) bad(where + ": " + name.substr(0, 40) + " has no data");
      check_attribute_type(name, a, where);
    }
    if (primitive.contains("indices")) {
      const Accessor& indices = attribute(primitive, "indices", where);
      if (indices.components != 1) bad(where + ".indices are not scalars");
      if (!indices.has_data || indices.bytes.empty() != (indices.count == 0)) {
        if (indices.count > 0) refuse_missing_data(primitive, where);
      }
      check_indices(indices, position.count, where + ".indices");
    }
    check_targets(primitive, position.count, where);
  }

  [[noreturn]] void refuse_missing_data(const Json& primitive, const std::string& where) const {
    const auto extensions = primitive.find("extensions");
    if (extensions != primitive.end() && extensions->is_object()) {
      for (const auto& [name, value] : extensions->items()) refuse_extension(name);
    }
    bad(where + " refers to an accessor without data");
  }

  void check_attribute_type(const std::string& name, const Accessor& a, const std::string& where) const {
    const auto is = [&](std::string_view semantic, std::size_t components) {
      if (name.starts_with(semantic) && a.components != components) {
        bad(where + ": " + name.substr(0, 40) + " has the wrong type");
      }
    };
    is("NORMAL", 3);
    is("TANGENT", 4);
    is("TEXCOORD_", 2);
    is("JOINTS_", 4);
    is("WEIGHTS_", 4);
    if (name.starts_with("COLOR_") && a.components != 3 && a.components != 4) bad(where + ": COLOR has the wrong type");
  }

  void check_targets(const Json& primitive, std::size_t count, const std::string& where) const {
    const auto targets = primitive.find("targets");
    if (targets == primitive.end()) return;
    if (!targets->is_array()) bad(where + ".targets is not an array");
    for (const Json& target : *targets) {
      if (!target.is_object()) bad(where + ".targets holds something that is not an object");
      for (const auto& [name, value] : target.items()) {
        const Accessor& a = attribute(target, name.c_str(), where + ".targets");
        if (a.count != count) bad(where + ": a morph target and POSITION differ in count");
      }
    }
  }

  void check_skins() const {
    const Json& skins = array("skins");
    for (std::size_t i = 0; i < skins.size(); ++i) {
      const std::string where = label("skins", i);
      check_name(skins[i], where);
      static_cast<void>(reference(skins[i], "skeleton", "nodes", where));
      const auto joints = skins[i].find("joints");
      if (joints == skins[i].end() || !joints->is_array() || joints->empty()) bad(where + ".joints is missing");
      for (const Json& joint : *joints) static_cast<void>(index(joint, "nodes", where + ".joints"));
      if (!skins[i].contains("inverseBindMatrices")) continue;
      const Accessor& matrices = attribute(skins[i], "inverseBindMatrices", where);
      if (matrices.components != 16 || matrices.component_type != 5126 || !matrices.has_data ||
          matrices.count < joints->size()) {
        bad(where + ".inverseBindMatrices does not have a matrix for every joint");
      }
    }
  }

  void check_nodes() const {
    const Json& nodes = array("nodes");
    std::vector<std::size_t> parent(nodes.size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::string where = label("nodes", i);
      check_name(nodes[i], where);
      check_numbers(nodes[i], "matrix", 16, where);
      check_numbers(nodes[i], "translation", 3, where);
      check_numbers(nodes[i], "rotation", 4, where);
      check_numbers(nodes[i], "scale", 3, where);
      check_node_skin(nodes[i], where);
      const auto children = nodes[i].find("children");
      if (children == nodes[i].end()) continue;
      if (!children->is_array()) bad(where + ".children is not an array");
      for (const Json& value : *children) {
        const std::size_t child = index(value, "nodes", where + ".children");
        if (parent[child] != nodes.size()) bad(label("nodes", child) + " has two parents");
        parent[child] = i;
      }
    }
    check_depth(parent);
    const Json& scenes = array("scenes");
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const auto roots = scenes[i].find("nodes");
      if (roots == scenes[i].end()) continue;
      if (!roots->is_array()) bad(label("scenes", i) + ".nodes is not an array");
      for (const Json& root : *roots) static_cast<void>(index(root, "nodes", label("scenes", i) + ".nodes"));
    }
    static_cast<void>(reference(json_, "scene", "scenes", "glTF"));
  }

  void check_node_skin(const Json& node, const std::string& where) const {
    const auto mesh = reference(node, "mesh", "meshes", where);
    const auto skin = reference(node, "skin", "skins", where);
    if (!mesh || !skin) return;
    const std::size_t joints = array("skins")[*skin]["joints"].size();
    for (const Json& primitive : array("meshes")[*mesh]["primitives"]) {
      const Json& attributes = primitive["attributes"];
      if (attributes.contains("JOINTS_0") != attributes.contains("WEIGHTS_0")) {
        bad(where + ": its mesh has joints without weights");
      }
      if (attributes.contains("JOINTS_0")) check_joints(attribute(attributes, "JOINTS_0", where), joints, where);
    }
  }

  void check_joints(const Accessor& a, std::size_t joints, const std::string& where) const {
    if (a.component_type != 5121 && a.component_type != 5123) bad(where + ": JOINTS_0 has the wrong type");
    if (a.bytes.empty()) return;
    for (std::size_t i = 0; i < a.count; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        uint32_t value = 0;
        std::memcpy(&value, a.bytes.data() + i * a.stride + k * a.component_size, a.component_size);
        if (value >= joints)
          bad(where + ": JOINTS_0 names joint " + std::to_string(value) + " of " + std::to_string(joints));
      }
    }
  }

  /// The hierarchy has to be a forest of bounded depth: assimp descends it by recursion.
  void check_depth(const std::vector<std::size_t>& parent) const {
    std::vector<std::size_t> depth(parent.size(), 0);
    for (std::size_t i = 0; i < parent.size(); ++i) {
      std::size_t steps = 0;
      for (std::size_t at = i; at < parent.size(); at = parent[at]) {
        if (++steps > kMaxNodeDepth) bad("its nodes form a circle or nest more than 512 levels deep");
      }
    }
  }

  void check_references() const {
    const Json& textures = array("textures");
    for (std::size_t i = 0; i < textures.size(); ++i) {
      static_cast<void>(reference(textures[i], "source", "images", label("textures", i)));
      static_cast<void>(reference(textures[i], "sampler", "samplers", label("textures", i)));
    }
    const Json& images = array("images");
    for (std::size_t i = 0; i < images.size(); ++i) {
      check_name(images[i], label("images", i));
      static_cast<void>(reference(images[i], "bufferView", "bufferViews", label("images", i)));
    }
    const Json& materials = array("materials");
    for (std::size_t i = 0; i < materials.size(); ++i) {
      check_name(materials[i], label("materials", i));
      check_texture_slots(materials[i], label("materials", i));
    }
    const Json& animations = array("animations");
    for (std::size_t i = 0; i < animations.size(); ++i) check_animation(animations[i], label("animations", i));
  }

  void check_texture_slots(const Json& object, const std::string& where) const {
    for (const auto& [name, value] : object.items()) {
      if (!value.is_object()) continue;
      if (name.ends_with("Texture")) {
        if (!value.contains("index")) bad(where + "." + name.substr(0, 60) + ".index is missing");
        static_cast<void>(index(value["index"], "textures", where + "." + name.substr(0, 60) + ".index"));
      } else if (name == "pbrMetallicRoughness" || name == "extensions" || name.starts_with("KHR_")) {
        check_texture_slots(value, where + "." + name.substr(0, 60));
      }
    }
  }

  void check_animation(const Json& animation, const std::string& where) const {
    check_name(animation, where);
    const auto samplers = animation.find("samplers"), channels = animation.find("channels");
    if (samplers == animation.end() || !samplers->is_array() || channels == animation.end() || !channels->is_array()) {
      bad(where + " has no samplers or channels");
    }
    for (const Json& sampler : *samplers) {
      if (!sampler.is_object() || !sampler.contains("input") || !sampler.contains("output")) {
        bad(where + " has a sampler without input or output");
      }
      if (!attribute(sampler, "input", where).has_data || !attribute(sampler, "output", where).has_data) {
        bad(where + " has a sampler without data");
      }
    }
    for (const Json& channel : *channels) {
      if (!channel.is_object() || !channel.contains("target") || !channel["target"].is_object()) {
        bad(where + " has a channel without target");
      }
      if (number(channel, "sampler", where + ".channels") >= samplers->size()) bad(where + " names a missing sampler");
      static_cast<void>(reference(channel["target"], "node", "nodes", where + ".channels.target"));
    }
  }

  // --- the copy for assimp -----------------------------------------------------------------------------------------

  void rewrite_primitive(Json& primitive) {
    primitive.erase("targets");
    primitive.erase("extensions");
    Json& attributes = primitive["attributes"];
    Json kept = Json::object();
    for (const auto& [name, value] : attributes.items()) {
      const bool wanted =
          name == "POSITION" || name == "NORMAL" || name == "TEXCOORD_0" || name == "JOINTS_0" || name == "WEIGHTS_0";
      if (!wanted) continue;
      if (name != "JOINTS_0") make_float(value.get<std::size_t>());
      kept[name] = value;
    }
    attributes = std::move(kept);
  }

  /// Writes an accessor of integers anew as floats (KHR_mesh_quantization; 3.11 for normalized values).
  void make_float(std::size_t i) {
    Accessor& a = accessors_[i];
    if (a.component_type == 5126) return;
    Json& json = json_["accessors"][i];
    const auto normalized = json.find("normalized");
    const bool scaled = normalized != json.end() && normalized->is_boolean() && normalized->get<bool>();
    if (json.contains("sparse")) fail(file_, ErrorCode::unsupported, "sparse and quantised at once; " + kDequantize);
    std::vector<std::byte> bytes(a.count * a.components * sizeof(float));
    for (std::size_t k = 0; k < a.count * a.components; ++k) {
      const std::byte* at = a.bytes.data() + k / a.components * a.stride + k % a.components * a.component_size;
      const float value = read_component(at, a.component_type, scaled);
      std::memcpy(bytes.data() + k * sizeof value, &value, sizeof value);
    }
    json["componentType"] = 5126;
    json["bufferView"] = json_["bufferViews"].size();
    for (const char* name : {"byteOffset", "normalized", "min", "max"}) json.erase(name);
    json_["bufferViews"].push_back({{"buffer", buffer_data_.size()}, {"byteLength", bytes.size()}});
    owned_.push_back(std::move(bytes));
    buffer_data_.push_back(owned_.back());
    a.component_type = 5126;
  }

  static float read_component(const std::byte* at, std::size_t type, bool scaled) {
    const auto read = [&]<typename T>(T value) {
      std::memcpy(&value, at, sizeof value);
      if (!scaled) return static_cast<float>(value);
      return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max()), -1.0F);
    };
    switch (type) {
      case 5120:
        return read(int8_t{});
      case 5121:
        return read(uint8_t{});
      case 5122:
        return read(int16_t{});
      case 5123:
        return read(uint16_t{});
      default:
        return read(uint32_t{});
    }
  }

  /// A picture that is no base64 is left away; it must not cost the mesh.
  void rewrite_images() {
    if (!json_.contains("images")) return;
    for (Json& image : json_["images"]) {
      const auto uri = image.find("uri");
      if (uri == image.end()) continue;
      try {
        if (!uri->is_string()) throw Error(ErrorCode::invalid_data, "uri is not text");
        const std::string& text = uri->get_ref<const std::string&>();
        if (text.starts_with("data:")) static_cast<void>(read_uri(file_, text, "image"));
      } catch (const Error&) {
        image.erase("uri");
      }
    }
  }

  const std::filesystem::path& file_;
  Json json_;
  std::optional<Bytes> binary_chunk_;
  std::vector<std::vector<std::byte>> owned_;
  std::vector<Bytes> buffer_data_;
  std::vector<View> views_;
  std::vector<Accessor> accessors_;
};

}  // namespace

std::vector<MemoryFile> read_gltf(const std::filesystem::path& file, std::span<const std::byte> bytes, bool binary) {
  GltfReader reader(file, bytes, binary);
  reader.check();
  return reader.rewrite();
}

}  // namespace geocloth::import_detail
