// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_draco_mesh_compression: a primitive's triangles and attributes in one stream of Google's Draco (bitstream 2.2).
// The library allocates what the stream announces, so the announced sizes are read and limited before it sees them.
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include <draco/compression/decode.h>

#include "import/gltf_compression.h"
#include "import/gltf_data.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;
using Bytes = GltfFile::Bytes;

/// Reads the head of a stream; beyond its end everything is zero.
class Head {
 public:
  explicit Head(Bytes bytes) : bytes_(bytes) {}

  uint8_t byte() { return at_ < bytes_.size() ? static_cast<uint8_t>(bytes_[at_++]) : uint8_t{0}; }
  uint64_t varint() {
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const uint8_t b = byte();
      value |= uint64_t{b & 0x7FU} << shift;
      if (b < 0x80) break;
    }
    return value;
  }
  void skip(uint64_t count) { at_ = count > bytes_.size() - at_ ? bytes_.size() : at_ + count; }
  [[nodiscard]] bool at_end() const { return at_ >= bytes_.size(); }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

/// Metadata are a tree of named entries (Draco bitstream specification, "Metadata"). @returns false when it is too deep
bool skip_metadata(Head& head, int depth) {
  if (depth > 16) return false;
  for (uint64_t entries = head.varint(); entries > 0 && !head.at_end(); --entries) {
    head.skip(head.byte());
    head.skip(head.varint());
  }
  for (uint64_t children = head.varint(); children > 0 && !head.at_end(); --children) {
    head.skip(head.byte());
    if (!skip_metadata(head, depth + 1)) return false;
  }
  return true;
}

struct AnnouncedSize {
  uint64_t points, faces;
};

/// What a stream of a mesh says of itself, or nothing when it is none ("Header", "Sequential", "EdgeBreaker").
std::optional<AnnouncedSize> read_size(Bytes bytes) {
  if (bytes.size() < 11 || std::memcmp(bytes.data(), "DRACO", 5) != 0) return std::nullopt;
  Head head(bytes.subspan(5));
  const uint8_t major = head.byte(), minor = head.byte(), type = head.byte(), method = head.byte();
  head.byte();
  const bool metadata = (head.byte() & 0x80U) != 0;  // the flags' highest bit
  constexpr uint8_t kMesh = 1, kEdgeBreaker = 1;
  if (major != 2 || minor != 2 || type != kMesh || method > kEdgeBreaker) return std::nullopt;
  if (metadata) {
    for (uint64_t attributes = head.varint(); attributes > 0 && !head.at_end(); --attributes) {
      head.varint();  // which attribute
      if (!skip_metadata(head, 0)) return std::nullopt;
    }
    if (!skip_metadata(head, 0)) return std::nullopt;
  }
  if (method == kEdgeBreaker) head.byte();  // how it is traversed
  const uint64_t first = head.varint(), second = head.varint();
  return method == kEdgeBreaker ? AnnouncedSize{first, second} : AnnouncedSize{second, first};
}

std::unique_ptr<draco::Mesh> decode_mesh(const GltfFile& gltf, Bytes bytes, const std::string& where) {
  const std::optional<AnnouncedSize> size = read_size(bytes);
  if (!size) gltf.bad(where + " holds no Draco mesh of version 2.2; is the file damaged?");
  if (size->faces > kMaxTriangles || size->points > kMaxElements) {
    fail(gltf.path, ErrorCode::limit, where + " announces more than 20 million triangles");
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) {
    gltf.bad(where + ": Draco's decoder gives up (" + mesh.status().error_msg_string() + "); is the file damaged?");
  }
  return std::move(mesh).value();
}

template <typename T>
std::vector<std::byte> values_as(const draco::PointAttribute& attribute, std::size_t points) {
  const std::size_t components = attribute.num_components();
  std::vector<std::byte> bytes(points * components * sizeof(T));
  std::vector<T> value(components);
  for (std::size_t i = 0; i < points; ++i) {
    const auto at = attribute.mapped_index(draco::PointIndex(static_cast<uint32_t>(i)));
    if (at.value() >= attribute.size() || !attribute.ConvertValue<T>(at, value.data())) return {};
    std::memcpy(bytes.data() + i * components * sizeof(T), value.data(), components * sizeof(T));
  }
  return bytes;
}

/// The attribute of every point in the type of its accessor; nothing when it does not fit.
std::vector<std::byte> values(const draco::PointAttribute& attribute, std::size_t points, std::size_t component_type) {
  switch (component_type) {
    case 5120:
      return values_as<int8_t>(attribute, points);
    case 5121:
      return values_as<uint8_t>(attribute, points);
    case 5122:
      return values_as<int16_t>(attribute, points);
    case 5123:
      return values_as<uint16_t>(attribute, points);
    case 5125:
      return values_as<uint32_t>(attribute, points);
    default:
      return values_as<float>(attribute, points);
  }
}

std::vector<std::byte> corners(const GltfFile& gltf, const draco::Mesh& mesh, const std::string& where) {
  std::vector<std::byte> bytes;
  bytes.reserve(std::size_t{mesh.num_faces()} * 3 * sizeof(uint32_t));
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& point : mesh.face(draco::FaceIndex(f))) {
      const uint32_t value = point.value();
      if (value >= mesh.num_points()) gltf.bad(where + " has a triangle of points that it does not have");
      const auto* raw = reinterpret_cast<const std::byte*>(&value);
      bytes.insert(bytes.end(), raw, raw + sizeof value);
    }
  }
  return bytes;
}

class DracoPrimitive {
 public:
  DracoPrimitive(GltfFile& gltf, GltfData& data, Json& primitive, std::string where)
      : gltf_(gltf), data_(data), primitive_(primitive), where_(std::move(where)) {}

  void decode() {
    const Json* extension = gltf_.extension(primitive_, kDraco, where_);
    if (extension == nullptr || has_plain_positions()) return;
    const std::string inside = where_ + ".extensions." + kDraco;
    const auto view = gltf_.reference(*extension, "bufferView", "bufferViews", inside);
    const auto ids = extension->find("attributes");
    if (!view || ids == extension->end() || !ids->is_object()) {
      gltf_.bad(inside + " has no bufferView or no attributes");
    }
    const std::unique_ptr<draco::Mesh> mesh = decode_mesh(gltf_, data_.view(*view), inside);
    Json attributes = Json::object();
    for (const auto& [name, accessor] : primitive_["attributes"].items()) {
      // What is no part of the stream has an accessor with data, as in every other primitive.
      const auto id = ids->find(name);
      attributes[name] =
          id == ids->end() ? accessor : Json(decode_attribute(*mesh, gltf_.number(*ids, name.c_str(), inside), name));
    }
    primitive_["indices"] =
        data_.add_accessor(5125, "SCALAR", std::size_t{mesh->num_faces()} * 3, corners(gltf_, *mesh, inside));
    primitive_["attributes"] = std::move(attributes);
    primitive_["mode"] = 4U;  // triangles
  }

 private:
  /// Files may hold the mesh a second time for those who cannot decode.
  [[nodiscard]] bool has_plain_positions() const {
    const auto attributes = primitive_.find("attributes");
    if (attributes == primitive_.end() || !attributes->is_object() || !attributes->contains("POSITION")) return true;
    return data_.attribute(*attributes, "POSITION", where_).has_data;
  }

  std::size_t decode_attribute(const draco::Mesh& mesh, std::size_t id, const std::string& name) {
    const std::size_t accessor = gltf_.index(primitive_["attributes"][name], "accessors", where_ + "." + name);
    const draco::PointAttribute* attribute =
        id > 0xFFFFFFFFU ? nullptr : mesh.GetAttributeByUniqueId(static_cast<uint32_t>(id));
    const GltfAccessor declared = data_.accessor(accessor);
    if (attribute == nullptr || static_cast<std::size_t>(attribute->num_components()) != declared.components) {
      gltf_.bad(where_ + ": " + name.substr(0, 40) + " is not in the compressed data");
    }
    std::vector<std::byte> bytes = values(*attribute, mesh.num_points(), declared.component_type);
    if (bytes.empty() && mesh.num_points() > 0) {
      gltf_.bad(where_ + ": " + name.substr(0, 40) + " of the compressed data does not fit its accessor");
    }
    const Json before = gltf_.json["accessors"][accessor];
    const std::size_t decoded =
        data_.add_accessor(declared.component_type, before["type"].get_ref<const std::string&>().c_str(),
                           mesh.num_points(), std::move(bytes));
    if (before.contains("normalized")) gltf_.json["accessors"][decoded]["normalized"] = before["normalized"];
    return decoded;
  }

  GltfFile& gltf_;
  GltfData& data_;
  Json& primitive_;
  std::string where_;
};

}  // namespace

void decode_draco(GltfFile& gltf, GltfData& data) {
  const std::size_t meshes = gltf.array("meshes").size();
  for (std::size_t i = 0; i < meshes; ++i) {
    const auto primitives = gltf.json["meshes"][i].find("primitives");
    if (primitives == gltf.json["meshes"][i].end() || !primitives->is_array()) continue;
    for (std::size_t j = 0; j < primitives->size(); ++j) {
      Json& primitive = (*primitives)[j];
      if (!primitive.is_object()) continue;
      DracoPrimitive(gltf, data, primitive, label("meshes", i) + "." + label("primitives", j)).decode();
    }
  }
}

}  // namespace geocloth::import_detail
