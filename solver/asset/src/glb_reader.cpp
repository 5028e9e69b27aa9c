// SPDX-License-Identifier: Apache-2.0
// Reading glTF that may be hostile: every member is looked up, typed and bounded before it is used, and nothing is
// allocated that the bytes at hand do not pay for.
#include "glb_reader.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geocloth/asset/error.h"

namespace geocloth::glb {
namespace {

std::string quoted(const char* key) {
  return std::string("\"") + key + "\"";
}

template <class T>
std::vector<Triangle> group_corners(const std::vector<std::array<T, 3>>& corners) {
  std::vector<Triangle> triangles;
  triangles.reserve(corners.size());
  for (const auto& t : corners) triangles.push_back({t[0], t[1], t[2]});
  return triangles;
}

}  // namespace

Reader::Reader(const Container& container, std::string name)
    : json_(container.json), binary_(container.binary), name_(std::move(name)), budget_(container.binary.size()) {}

void Reader::refuse(const std::string& what) const {
  throw Error(ErrorCode::invalid_data, name_ + ": " + what + "; make the file again");
}

const Json* Reader::find(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto it = object.find(key);
  return it == object.end() ? nullptr : &*it;
}

const Json& Reader::member(const Json& object, const char* key) const {
  const Json* value = find(object, key);
  if (value == nullptr) refuse(quoted(key) + " is missing");
  return *value;
}

const Json& Reader::array(const Json& object, const char* key) const {
  const Json& value = member(object, key);
  if (!value.is_array()) refuse(quoted(key) + " is not an array");
  return value;
}

const Json& Reader::element(const char* key, uint64_t index) const {
  const Json& list = array(json_, key);
  if (index >= list.size()) refuse(quoted(key) + " has no element " + std::to_string(index));
  return list[static_cast<std::size_t>(index)];
}

uint64_t Reader::number(const Json& object, const char* key, uint64_t max) const {
  const Json& value = member(object, key);
  if (!value.is_number_unsigned() || value.get<uint64_t>() > max) {
    refuse(quoted(key) + " is not a whole number from 0 to " + std::to_string(max));
  }
  return value.get<uint64_t>();
}

uint64_t Reader::number_or_zero(const Json& object, const char* key) const {
  return find(object, key) == nullptr ? 0 : number(object, key);
}

uint32_t Reader::number32(const Json& object, const char* key) const {
  return static_cast<uint32_t>(number(object, key));
}

float Reader::real(const Json& value, const char* what) const {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= double{std::numeric_limits<float>::max()})) {
    refuse(quoted(what) + " is not a number");
  }
  return static_cast<float>(value.get<double>());
}

std::string Reader::text(const Json& value, const char* what) const {
  if (!value.is_string()) refuse(quoted(what) + " is not a string");
  return value.get<std::string>();
}

std::string Reader::text_or_empty(const Json& object, const char* key) const {
  const Json* value = find(object, key);
  return value == nullptr ? std::string{} : text(*value, key);
}

void Reader::take(uint64_t bytes) {
  if (bytes > budget_) refuse("buffer views or accessors overlap");
  budget_ -= bytes;
}

std::span<const std::byte> Reader::locate_view(const Json& description, const char* key) const {
  const uint64_t offset = number_or_zero(description, "byteOffset");
  const uint64_t size = number(description, "byteLength");
  if (number(description, "buffer") != 0 || offset > binary_.size() || size > binary_.size() - offset) {
    refuse("the buffer view of " + quoted(key) + " does not lie in the file");
  }
  return binary_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
}

std::span<const std::byte> Reader::view(const Json& object, const char* key) {
  const Json& description = element("bufferViews", number(object, key));
  if (find(description, "byteStride") != nullptr) refuse(quoted(key) + " is not tightly packed");
  const auto bytes = locate_view(description, key);
  take(bytes.size());
  return bytes;
}

std::span<const std::byte> Reader::accessor(const Json& object, const char* key, const char* type, uint32_t component,
                                            std::size_t element_size) {
  const Json& description = element("accessors", number(object, key));
  const Json& view_description = element("bufferViews", number(description, "bufferView"));
  const uint64_t stride = number_or_zero(view_description, "byteStride");
  if (text(member(description, "type"), "type") != type || number(description, "componentType") != component ||
      find(description, "sparse") != nullptr || (stride != 0 && stride != element_size)) {
    refuse("the accessor of " + quoted(key) + " is not a packed " + type);
  }
  const auto bytes = locate_view(view_description, key);
  const uint64_t offset = number_or_zero(description, "byteOffset");
  const uint64_t count = number(description, "count");
  if (offset > bytes.size() || count > (bytes.size() - offset) / element_size) {
    refuse("the accessor of " + quoted(key) + " is longer than its buffer view");
  }
  take(count * element_size);
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(count) * element_size);
}

std::vector<Triangle> Reader::triangles(const Json& object, const char* key) {
  const Json& description = element("accessors", number(object, key));
  const bool is_short = number(description, "componentType") == kUnsignedShort;
  const std::size_t corner_size = is_short ? 2 : 4;
  const auto bytes = accessor(object, key, "SCALAR", is_short ? kUnsignedShort : kUnsignedInt, corner_size);
  if (bytes.size() % (3 * corner_size) != 0) refuse(quoted(key) + " does not make whole triangles");
  if (is_short) return group_corners(copy<std::array<uint16_t, 3>>(bytes));
  return group_corners(copy<std::array<uint32_t, 3>>(bytes));
}

std::optional<uint32_t> Reader::texture_image(const Json& material, const char* key) const {
  const Json* info = find(material, key);
  if (info == nullptr) return std::nullopt;
  return number32(element("textures", number(*info, "index")), "source");
}

SourceMaterial Reader::material(const Json& json) const {
  SourceMaterial result;
  result.name = text_or_empty(json, "name");
  const Json& pbr = member(json, "pbrMetallicRoughness");
  const Json& color = array(pbr, "baseColorFactor");
  if (color.size() != result.base_color.size()) refuse("\"baseColorFactor\" does not have four numbers");
  for (std::size_t i = 0; i < color.size(); ++i) result.base_color[i] = real(color[i], "baseColorFactor");
  result.metallic = real(member(pbr, "metallicFactor"), "metallicFactor");
  result.roughness = real(member(pbr, "roughnessFactor"), "roughnessFactor");
  result.base_color_image = texture_image(pbr, "baseColorTexture");
  result.metallic_roughness_image = texture_image(pbr, "metallicRoughnessTexture");
  result.normal_image = texture_image(json, "normalTexture");
  const std::string mode = text_or_empty(json, "alphaMode");
  result.alpha_mask = mode == "MASK";
  result.alpha_blend = mode == "BLEND";
  if (const Json* cutoff = find(json, "alphaCutoff")) result.alpha_cutoff = real(*cutoff, "alphaCutoff");
  return result;
}

std::vector<SourceMaterial> Reader::materials() const {
  std::vector<SourceMaterial> result;
  for (const Json& json : array(json_, "materials")) result.push_back(material(json));
  return result;
}

SourceImage Reader::image(uint64_t index) {
  const Json& json = element("images", index);
  SourceImage result;
  result.name = text_or_empty(json, "name");
  result.mime_type = text(member(json, "mimeType"), "mimeType");
  result.bytes = values<uint8_t>(json, "bufferView");
  return result;
}

}  // namespace geocloth::glb
