// SPDX-License-Identifier: GPL-3.0-or-later
// The GLB container (glTF 2.0, section 4) and access to the JSON in it.
#include "import/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr uint32_t kChunkJson = 0x4E4F534A, kChunkBin = 0x004E4942;

uint32_t read_u32(GltfFile::Bytes bytes, std::size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace

GltfFile::GltfFile(const std::filesystem::path& file, Bytes bytes, bool binary) : path(file) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (binary) text = split_container(bytes);
  // Counting brackets first keeps whoever parses this text next from recursing without end.
  check_nesting(text);
  json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (json.is_discarded()) bad("its JSON is broken; is the file cut off?");
  if (!json.is_object()) bad("its JSON is not an object, so this is no glTF file");
  check_version();  // first: glTF 1.0 has objects for arrays
  for (const auto& [name, value] : json.items()) check_objects(name, value);
}

/// Those of its arrays that elements of the file refer to hold objects.
void GltfFile::check_objects(const std::string& name, const Json& value) const {
  constexpr std::array kNames{"accessors", "animations", "bufferViews", "buffers", "images", "materials",
                              "meshes",    "nodes",      "samplers",    "scenes",  "skins",  "textures"};
  if (std::ranges::find(kNames, name) == kNames.end()) return;
  if (!value.is_array()) bad("'" + name + "' is not an array");
  if (!std::ranges::all_of(value, &Json::is_object)) bad("'" + name + "' holds something that is not an object");
}

void GltfFile::bad(const std::string& what) const {
  fail(path, ErrorCode::invalid_data, what);
}

std::string_view GltfFile::split_container(Bytes bytes) {
  if (bytes.size() < 20 || std::memcmp(bytes.data(), "glTF", 4) != 0) bad("this is no GLB file (no 'glTF' header)");
  if (read_u32(bytes, 4) != 2) {
    fail(path, ErrorCode::unsupported,
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
    if (kind == kChunkBin && !binary_chunk) binary_chunk = chunk;
    at += 8 + size;
  }
  if (text.empty()) bad("the GLB container holds no JSON");
  return text;
}

void GltfFile::check_nesting(std::string_view text) const {
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

const GltfFile::Json& GltfFile::array(const char* name) const {
  static const Json none = Json::array();
  const auto it = json.find(name);
  return it == json.end() ? none : *it;
}

std::size_t GltfFile::number(const Json& object, const char* key, const std::string& where,
                             std::optional<std::size_t> otherwise) const {
  const auto it = object.find(key);
  if (it == object.end()) {
    if (otherwise) return *otherwise;
    bad(where + "." + key + " is missing");
  }
  return whole(*it, where + "." + key);
}

std::size_t GltfFile::whole(const Json& value, const std::string& where) const {
  if (value.is_number_unsigned()) {
    const auto n = value.get<uint64_t>();
    if (n <= (uint64_t{1} << 40U)) return n;
  } else if (value.is_number_float()) {
    const auto d = value.get<double>();
    if (d >= 0 && d <= 1e12 && d == std::floor(d)) bad(where + " is written as a fraction; it must be an integer");
  }
  bad(where + " is not a number in range");
}

std::size_t GltfFile::index(const Json& value, const char* target, const std::string& where) const {
  const std::size_t i = whole(value, where);
  if (i >= array(target).size()) {
    bad(where + " is " + std::to_string(i) + ", but there are only " + std::to_string(array(target).size()) + " " +
        target);
  }
  return i;
}

/// Index in object[key], or nothing when the key is missing.
std::optional<std::size_t> GltfFile::reference(const Json& object, const char* key, const char* target,
                                               const std::string& where) const {
  const auto it = object.find(key);
  if (it == object.end()) return std::nullopt;
  return index(*it, target, where + "." + key);
}

void GltfFile::check_numbers(const Json& object, const char* key, std::size_t count, const std::string& where) const {
  const auto it = object.find(key);
  if (it == object.end()) return;
  const bool right = it->is_array() && it->size() == count &&
                     std::all_of(it->begin(), it->end(), [](const Json& v) { return v.is_number(); });
  if (!right) bad(where + "." + key + " is not an array of " + std::to_string(count) + " numbers");
}

void GltfFile::check_name(const Json& object, const std::string& where) const {
  const auto it = object.find("name");
  if (it != object.end() && !it->is_string()) bad(where + ".name is not text");
}

const GltfFile::Json* GltfFile::extension(const Json& object, const char* name, const std::string& where) const {
  const auto extensions = object.find("extensions");
  if (extensions == object.end()) return nullptr;
  if (!extensions->is_object()) bad(where + ".extensions is not an object");
  const auto it = extensions->find(name);
  if (it == extensions->end()) return nullptr;
  if (!it->is_object()) bad(where + ".extensions." + name + " is not an object");
  return &*it;
}

void GltfFile::check_version() const {
  const auto asset = json.find("asset");
  if (asset == json.end() || !asset->is_object()) bad("'asset' is missing, so this is no glTF file");
  const auto version = asset->find("version");
  if (version == asset->end() || !version->is_string()) bad("asset.version is missing");
  if (!version->get_ref<const std::string&>().starts_with("2.")) {
    fail(path, ErrorCode::unsupported,
         "glTF version '" + version->get<std::string>().substr(0, 16) +
             "'; only 2.0 can be read: export it as glTF 2.0");
  }
}

}  // namespace geocloth::import_detail
