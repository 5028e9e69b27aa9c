// SPDX-License-Identifier: GPL-3.0-or-later
// Buffers, views and accessors (glTF 2.0, section 3.6).
#include "import/gltf_data.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "import/gltf_compression.h"
#include "import/import_detail.h"
#include "import/import_files.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;
using Bytes = GltfFile::Bytes;

std::size_t components_of(const Json& accessor) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 7> kKinds{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const auto type = accessor.find("type");
  if (type == accessor.end() || !type->is_string()) return 0;
  const std::string_view name = type->get_ref<const std::string&>();
  const auto it = std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return kind.first == name; });
  return it == kKinds.end() ? 0 : it->second;
}

uint32_t index_at(const GltfAccessor& indices, std::size_t i) {
  uint32_t value = 0;
  std::memcpy(&value, indices.bytes.data() + i * indices.stride, indices.component_size);
  return value;
}

/// A component at `at`; integers are parts of their largest value when `scaled`.
float read_component(const std::byte* at, std::size_t type, bool scaled) {
  const auto read = [&]<typename T>(T value) {
    std::memcpy(&value, at, sizeof value);
    if (std::is_same_v<T, float> || !scaled) return static_cast<float>(value);
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
    case 5125:
      return read(uint32_t{});
    default:
      return read(float{});
  }
}

}  // namespace

std::size_t gltf_component_size(std::size_t component_type) {
  switch (component_type) {
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

GltfData::GltfData(GltfFile& gltf) : gltf_(gltf) {
  load_buffers();
  load_views();
  load_accessors();
}

const GltfAccessor& GltfData::attribute(const Json& object, const char* key, const std::string& where) const {
  return accessors_[gltf_.index(object[key], "accessors", where + "." + key)];
}

void GltfData::count_bytes(std::size_t more) {
  total_bytes_ += more;
  if (total_bytes_ > kMaxFileBytes) fail(gltf_.path, ErrorCode::limit, "its buffers hold more than 4 GiB");
}

void GltfData::load_buffers() {
  const Json& buffers = gltf_.array("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = label("buffers", i);
    const std::size_t length = gltf_.number(buffers[i], "byteLength", where);
    const Json* meshopt = gltf_.extension(buffers[i], kMeshopt, where);
    // Stands in for those who cannot decode, and need not be there (EXT_meshopt_compression, "Fallback buffers").
    if (meshopt != nullptr && meshopt->value("fallback", Json(false)) == true) {
      buffers_.emplace_back();
      continue;
    }
    const Bytes bytes = load_buffer(buffers[i], i, where);
    if (length > bytes.size()) {
      gltf_.bad(where + " has " + std::to_string(bytes.size()) + " of " + std::to_string(length) +
                " bytes; is it cut off?");
    }
    count_bytes(length);
    buffers_.push_back(bytes.first(length));
  }
}

GltfData::Bytes GltfData::load_buffer(const Json& buffer, std::size_t i, const std::string& where) {
  const auto uri = buffer.find("uri");
  if (uri == buffer.end()) {
    if (i != 0 || !gltf_.binary_chunk) {
      gltf_.bad(where + " has neither a uri nor a binary chunk; is the file cut off?");
    }
    return *gltf_.binary_chunk;
  }
  if (!uri->is_string()) gltf_.bad(where + ".uri is not text");
  owned_.push_back(read_uri(gltf_.path, uri->get_ref<const std::string&>(), where));
  return owned_.back();
}

void GltfData::load_views() {
  // By index: decoding appends to the buffers of the same JSON.
  const std::size_t count = gltf_.array("bufferViews").size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::string where = label("bufferViews", i);
    const Json& json = gltf_.json["bufferViews"][i];
    if (const Json* compression = gltf_.extension(json, kMeshopt, where)) {
      decode_view(i, Json(*compression), where);
    } else {
      views_.push_back(read_view(json, where));
    }
  }
}

GltfData::View GltfData::read_view(const Json& json, const std::string& where) const {
  if (!json.contains("buffer")) gltf_.bad(where + ".buffer is missing");
  const std::size_t buffer = gltf_.index(json["buffer"], "buffers", where + ".buffer");
  const std::size_t offset = gltf_.number(json, "byteOffset", where, 0);
  const std::size_t length = gltf_.number(json, "byteLength", where);
  const std::size_t size = buffers_[buffer].size();
  if (offset > size || length > size - offset) {
    gltf_.bad(where + " reaches beyond buffers[" + std::to_string(buffer) + "]; is the file cut off?");
  }
  const std::size_t stride = gltf_.number(json, "byteStride", where, 0);
  if (stride != 0 && (stride < 4 || stride > 252)) gltf_.bad(where + ".byteStride is not within 4..252");
  return {buffers_[buffer].subspan(offset, length), stride};
}

void GltfData::decode_view(std::size_t i, const Json& compression, const std::string& where) {
  const std::string inside = where + ".extensions." + kMeshopt;
  const MeshoptLayout layout = read_meshopt_layout(gltf_, compression, inside);
  // Its byteStride is that of what it decodes to, so it is not one of the compressed bytes.
  Json range = compression;
  range.erase("byteStride");
  count_bytes(layout.count * layout.stride);
  const std::size_t buffer = add_buffer(decode_meshopt(gltf_, read_view(range, inside).bytes, layout, inside));
  Json& json = gltf_.json["bufferViews"][i];
  const std::size_t stride = gltf_.number(json, "byteStride", where, 0);
  if (stride != 0 && stride != layout.stride) gltf_.bad(where + ".byteStride is not that of its compression");
  json.erase("extensions");
  json.erase("byteOffset");
  json["buffer"] = buffer;
  json["byteLength"] = buffers_[buffer].size();
  views_.push_back({buffers_[buffer], stride});
}

/// The bytes of the elements of `a`; sets its stride.
GltfData::Bytes GltfData::elements(const Json& object, const std::string& where, GltfAccessor& a) const {
  const View& view = views_[gltf_.index(object["bufferView"], "bufferViews", where + ".bufferView")];
  const std::size_t offset = gltf_.number(object, "byteOffset", where, 0);
  const std::size_t element = a.component_size * a.components;
  a.stride = view.stride != 0 ? view.stride : element;
  const std::size_t needed = a.count == 0 ? 0 : (a.count - 1) * a.stride + element;
  if (offset > view.bytes.size() || needed > view.bytes.size() - offset) {
    gltf_.bad(where + " reaches beyond its bufferView; is the file cut off?");
  }
  return view.bytes.subspan(offset);
}

void GltfData::load_accessors() {
  const Json& accessors = gltf_.array("accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    const std::string where = label("accessors", i);
    const Json& json = accessors[i];
    GltfAccessor a;
    a.count = gltf_.number(json, "count", where);
    if (a.count > kMaxElements) fail(gltf_.path, ErrorCode::limit, where + " has more than 100 million elements");
    a.component_type = gltf_.number(json, "componentType", where);
    a.component_size = gltf_component_size(a.component_type);
    a.components = components_of(json);
    a.normalized = json.value("normalized", Json(false)) == true;
    if (a.component_size == 0 || a.components == 0) gltf_.bad(where + " has an unknown type");
    if (json.contains("bufferView")) {
      a.bytes = elements(json, where, a);
      a.has_data = true;
    }
    load_sparse(json, a, where);
    accessors_.push_back(a);
  }
}

void GltfData::load_sparse(const Json& json, GltfAccessor& accessor, const std::string& where) {
  const auto sparse = json.find("sparse");
  if (sparse == json.end()) return;
  if (!sparse->is_object()) gltf_.bad(where + ".sparse is not an object");
  const std::size_t count = gltf_.number(*sparse, "count", where + ".sparse");
  if (count > accessor.count) gltf_.bad(where + ".sparse.count is greater than its accessor's");
  for (const char* part : {"indices", "values"}) {
    const std::string name = where + ".sparse." + part;
    const auto object = sparse->find(part);
    if (object == sparse->end() || !object->is_object() || !object->contains("bufferView")) {
      gltf_.bad(name + " is missing");
    }
    const bool indices = std::string_view(part) == "indices";
    GltfAccessor a;
    a.component_type = indices ? gltf_.number(*object, "componentType", name) : accessor.component_type;
    a.component_size = gltf_component_size(a.component_type);
    a.components = indices ? 1 : accessor.components;
    a.count = count;
    if (a.component_size == 0) gltf_.bad(name + " has an unknown type");
    a.bytes = elements(*object, name, a);
    if (indices) check_indices(a, accessor.count, name);
    accessor.sparse.push_back(a);
  }
  // Zeros that a few bytes of the file announce.
  if (!accessor.has_data) count_bytes(accessor.count * accessor.components * accessor.component_size);
  accessor.has_data = true;
}

std::vector<float> GltfData::floats(std::size_t i) const {
  const GltfAccessor& a = accessors_[i];
  std::vector<float> out(a.count * a.components, 0.0F);
  const auto copy = [&](const GltfAccessor& from, std::size_t element, std::size_t to) {
    for (std::size_t c = 0; c < a.components; ++c) {
      const std::byte* at = from.bytes.data() + element * from.stride + c * a.component_size;
      out[to * a.components + c] = read_component(at, a.component_type, a.normalized);
    }
  };
  for (std::size_t k = 0; !a.bytes.empty() && k < a.count; ++k) copy(a, k, k);
  for (std::size_t k = 0; !a.sparse.empty() && k < a.sparse[0].count; ++k) {
    copy(a.sparse[1], k, index_at(a.sparse[0], k));
  }
  return out;
}

std::vector<uint32_t> GltfData::indices(std::size_t i) const {
  const GltfAccessor& a = accessors_[i];
  std::vector<uint32_t> out(a.count, 0);
  for (std::size_t k = 0; !a.bytes.empty() && k < a.count; ++k) out[k] = index_at(a, k);
  for (std::size_t k = 0; !a.sparse.empty() && k < a.sparse[0].count; ++k) {
    out[index_at(a.sparse[0], k)] = index_at(a.sparse[1], k);
  }
  return out;
}

void GltfData::check_indices(const GltfAccessor& a, std::size_t limit, const std::string& where) const {
  if (a.component_type != 5121 && a.component_type != 5123 && a.component_type != 5125) {
    gltf_.bad(where + " has indices that are not unsigned integers");
  }
  for (std::size_t i = 0; i < a.count; ++i) {
    const uint32_t value = index_at(a, i);
    if (value >= limit) {
      gltf_.bad(where + ": index " + std::to_string(value) + " at " + std::to_string(i) + ", but there are only " +
                std::to_string(limit) + " vertices");
    }
  }
}

std::size_t GltfData::add_buffer(std::vector<std::byte> bytes) {
  owned_.push_back(std::move(bytes));
  buffers_.emplace_back(owned_.back());
  gltf_.json["buffers"].push_back({{"byteLength", owned_.back().size()}});
  return buffers_.size() - 1;
}

std::size_t GltfData::add_view(std::vector<std::byte> bytes) {
  const std::size_t buffer = add_buffer(std::move(bytes));
  gltf_.json["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", buffers_[buffer].size()}});
  views_.push_back({buffers_[buffer], 0});
  return views_.size() - 1;
}

std::size_t GltfData::add_accessor(std::size_t component_type, const char* type, std::size_t count,
                                   std::vector<std::byte> bytes) {
  count_bytes(bytes.size());
  const Json json = {{"componentType", component_type}, {"type", type}, {"count", count}};
  GltfAccessor a;
  a.count = count;
  a.component_type = component_type;
  a.component_size = gltf_component_size(component_type);
  a.components = components_of(json);
  a.has_data = true;
  accessors_.push_back(a);
  gltf_.json["accessors"].push_back(json);
  replace(accessors_.size() - 1, component_type, std::move(bytes));
  return accessors_.size() - 1;
}

void GltfData::replace(std::size_t i, std::size_t component_type, std::vector<std::byte> bytes) {
  GltfAccessor& a = accessors_[i];
  a.component_type = component_type;
  a.component_size = gltf_component_size(component_type);
  a.stride = a.component_size * a.components;
  const std::size_t view = add_view(std::move(bytes));
  a.bytes = views_[view].bytes;
  a.normalized = false;
  a.sparse.clear();
  Json& json = gltf_.json["accessors"][i];
  json["componentType"] = component_type;
  json["bufferView"] = view;
  for (const char* name : {"byteOffset", "normalized", "sparse", "min", "max"}) json.erase(name);
}

}  // namespace geocloth::import_detail
