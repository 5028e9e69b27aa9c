// SPDX-License-Identifier: Apache-2.0
// The asset as a glTF 2.0 binary file; the page GEOCLOTH_geometry_image.md specifies it. The source mesh is plain glTF,
// and the cloth data lie in buffer views that only the extension names. Floats are copied bit for bit. The reader
// believes nothing: sizes are compared with the buffer views before anything is allocated, all views together may not
// be larger than the binary chunk (so one view cannot be read a thousand times), and validate() has the last word.
#include "geocloth/asset/asset_file.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"

namespace geocloth {
namespace {

using glb::Json;

constexpr uint64_t kFormatVersion = 1;
constexpr uint32_t kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;

// ---- writing ----

/// What `values` holds at the valid pixels, in their order.
template <class T>
std::vector<T> valid_only(const ClothAsset& asset, const std::vector<T>& values) {
  std::vector<T> packed;
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) packed.push_back(values[i]);
  }
  return packed;
}

/// One field of every element.
template <class Element, class Field>
auto column(const std::vector<Element>& elements, Field field) {
  std::vector<std::decay_t<decltype(field(elements.front()))>> values;
  values.reserve(elements.size());
  for (const Element& element : elements) values.push_back(field(element));
  return values;
}

void add_source_mesh(glb::Builder& builder, const ClothAsset& asset) {
  const SourceMesh& source = asset.source;
  const auto vertex_count = static_cast<uint32_t>(source.position.size());
  const uint32_t first_material = builder.add_materials(source);
  const auto add_attribute = [&](const auto& values) {
    return builder.add_accessor(std::span(values), builder.add_array(values, glb::Target::vertices));
  };
  Json attributes = {{"POSITION", add_attribute(source.position)}, {"NORMAL", add_attribute(source.normal)}};
  if (!source.uv.empty()) attributes["TEXCOORD_0"] = add_attribute(source.uv);

  const uint32_t index_view = builder.add_index_view(source.triangle, vertex_count);
  Json primitives = Json::array();
  for (const SourcePart& part : source.part) {
    primitives.push_back(
        {{"attributes", attributes},
         {"indices", builder.add_index_accessor(index_view, part.first_triangle, part.triangle_count, vertex_count)},
         {"material", first_material + part.material}});
  }
  builder.root["meshes"] = Json::array({{{"name", asset.name}, {"primitives", std::move(primitives)}}});
  builder.root["nodes"] = Json::array({{{"name", asset.name}, {"mesh", 0}}});
  builder.root["scenes"] = Json::array({{{"nodes", {0}}}});
}

Json add_cloth(glb::Builder& builder, const ClothAsset& asset) {
  Json cloth = {{"version", kFormatVersion},
                {"name", asset.name},
                {"layout", to_string(asset.layout)},
                {"width", asset.width},
                {"height", asset.height},
                {"spacing", asset.spacing},
                {"chartCount", asset.chart_count},
                {"mesh", 0},
                {"charts", builder.add_array(asset.chart)},
                {"springs", builder.add_array(asset.spring_mask)},
                {"cells", builder.add_array(asset.cell)}};
  if (count_valid_pixels(asset) != 0) {
    cloth["positions"] = builder.add_array(valid_only(asset, asset.rest_position));
    cloth["areas"] = builder.add_array(valid_only(asset, asset.area));
  }
  if (asset.splits.rows() != 0) {
    cloth["splits"] = {{"offsets", builder.add_array(asset.splits.offset)},
                       {"pixels", builder.add_array(asset.splits.pixel)}};
  }
  if (!asset.seam_bends.empty()) {
    const auto pixels = column(asset.seam_bends, [](const SeamBend& s) { return std::array{s.a, s.middle, s.b}; });
    const auto lengths = column(asset.seam_bends, [](const SeamBend& s) { return s.rest_length; });
    cloth["seamBends"] = {{"pixels", builder.add_array(pixels)}, {"restLengths", builder.add_array(lengths)}};
  }
  cloth["binding"] = {{"pixels", builder.add_array(column(asset.binding, [](const Binding& b) { return b.pixel; }))},
                      {"weights", builder.add_array(column(asset.binding, [](const Binding& b) { return b.weight; }))},
                      {"offsets", builder.add_array(column(asset.binding, [](const Binding& b) { return b.offset; }))}};
  cloth["sourceVertices"] = {{"count", asset.source.source_vertex_count},
                             {"indices", builder.add_array(asset.source.source_vertex)}};
  cloth["parts"] = column(asset.source.part, [](const SourcePart& part) { return part.name; });
  if (!asset.vertex_groups.empty()) cloth["vertexGroups"] = Json::array();
  for (const ClothAsset::VertexGroup& group : asset.vertex_groups) {
    Json json = {{"name", group.name}};
    if (!group.source_vertex.empty()) json["vertices"] = builder.add_array(group.source_vertex);
    cloth["vertexGroups"].push_back(std::move(json));
  }
  return cloth;
}

// ---- reading ----

/// Typed access to untrusted JSON and buffer views; every failure is an Error that names the file and the member.
class Reader {
 public:
  Reader(const glb::Container& container, std::string name)
      : json_(container.json), binary_(container.binary), name_(std::move(name)), budget_(container.binary.size()) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::invalid_data, name_ + ": " + what + "; convert the garment again");
  }

  [[nodiscard]] const Json& root() const { return json_; }

  [[nodiscard]] static const Json* find(const Json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
  }
  [[nodiscard]] const Json& member(const Json& object, const char* key) const {
    const Json* value = find(object, key);
    if (value == nullptr) refuse(std::string("\"") + key + "\" is missing");
    return *value;
  }
  [[nodiscard]] const Json& array(const Json& object, const char* key) const {
    const Json& value = member(object, key);
    if (!value.is_array()) refuse(std::string("\"") + key + "\" is not an array");
    return value;
  }
  /// An element of an array of the glTF root.
  [[nodiscard]] const Json& element(const char* key, uint64_t index) const {
    const Json& list = array(json_, key);
    if (index >= list.size()) refuse(std::string("\"") + key + "\" has no element " + std::to_string(index));
    return list[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] uint64_t number(const Json& object, const char* key, uint64_t max = 0xFFFFFFFFU) const {
    const Json& value = member(object, key);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > max) {
      refuse(std::string("\"") + key + "\" is not a whole number from 0 to " + std::to_string(max));
    }
    return value.get<uint64_t>();
  }
  [[nodiscard]] uint32_t number32(const Json& object, const char* key) const {
    return static_cast<uint32_t>(number(object, key));
  }
  [[nodiscard]] float real(const Json& value, const char* what) const {
    if (!value.is_number() || !(std::abs(value.get<double>()) <= double{std::numeric_limits<float>::max()})) {
      refuse(std::string("\"") + what + "\" is not a number");
    }
    return static_cast<float>(value.get<double>());
  }
  [[nodiscard]] std::string text(const Json& value, const char* what) const {
    if (!value.is_string()) refuse(std::string("\"") + what + "\" is not a string");
    return value.get<std::string>();
  }
  [[nodiscard]] std::string text_or_empty(const Json& object, const char* key) const {
    const Json* value = find(object, key);
    return value == nullptr ? std::string{} : text(*value, key);
  }

  /// The bytes of the buffer view that object[key] names. Each byte of the file can be taken once.
  [[nodiscard]] std::span<const std::byte> view(const Json& object, const char* key) {
    const Json& description = element("bufferViews", number(object, key));
    const uint64_t offset = find(description, "byteOffset") ? number(description, "byteOffset") : 0;
    const uint64_t size = number(description, "byteLength");
    if (number(description, "buffer") != 0 || offset > binary_.size() || size > binary_.size() - offset) {
      refuse(std::string("the buffer view of \"") + key + "\" does not lie in the file");
    }
    if (find(description, "byteStride") != nullptr) refuse(std::string("\"") + key + "\" is not tightly packed");
    if (size > budget_) refuse("buffer views overlap");
    budget_ -= size;
    return binary_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size));
  }

  /// The buffer view that object[key] names as values. @param count  as many as there must be
  template <class T>
  std::vector<T> values(const Json& object, const char* key, uint64_t count) {
    return values_of<T>(view(object, key), key, count);
  }
  /// As many values as the view holds.
  template <class T>
  std::vector<T> values(const Json& object, const char* key) {
    const auto bytes = view(object, key);
    return values_of<T>(bytes, key, bytes.size() / sizeof(T));
  }

 private:
  template <class T>
  std::vector<T> values_of(std::span<const std::byte> bytes, const char* key, uint64_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (bytes.size() % sizeof(T) != 0 || bytes.size() / sizeof(T) != count) {
      refuse(std::string("\"") + key + "\" has " + std::to_string(bytes.size()) + " bytes instead of " +
             std::to_string(count) + " x " + std::to_string(sizeof(T)));
    }
    std::vector<T> result(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }

  const Json& json_;
  std::span<const std::byte> binary_;
  std::string name_;
  uint64_t budget_;  ///< [bytes] of the binary chunk that no view has taken
};

/// The values of a float attribute that all primitives share.
template <class T>
std::vector<T> read_attribute(Reader& reader, const Json& attributes, const char* name) {
  const Json& accessor = reader.element("accessors", reader.number(attributes, name));
  const char* type = sizeof(T) == sizeof(Vec3) ? "VEC3" : "VEC2";
  const bool whole_view = !Reader::find(accessor, "byteOffset") || reader.number(accessor, "byteOffset") == 0;
  if (reader.number(accessor, "componentType") != kFloat || reader.member(accessor, "type") != type || !whole_view ||
      Reader::find(accessor, "sparse") != nullptr) {
    reader.refuse(std::string("the accessor of ") + name + " is not a plain " + type + " of floats");
  }
  return reader.values<T>(accessor, "bufferView", reader.number(accessor, "count"));
}

/// Not by comparing the JSON objects: that recurses as deep as a hostile file is nested.
std::array<uint64_t, 3> attribute_accessors(const Reader& reader, const Json& primitive) {
  const Json& attributes = reader.member(primitive, "attributes");
  const uint64_t uv = Reader::find(attributes, "TEXCOORD_0") ? reader.number(attributes, "TEXCOORD_0") + 1 : 0;
  return {reader.number(attributes, "POSITION"), reader.number(attributes, "NORMAL"), uv};
}

std::vector<Triangle> group_corners(const std::vector<uint32_t>& corners) {
  std::vector<Triangle> triangles(corners.size() / 3);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    triangles[i] = {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]};
  }
  return triangles;
}

/// Triangles and parts: every primitive takes the next run of one buffer view of indices.
void read_primitives(Reader& reader, const Json& primitives, const Json& part_names, SourceMesh& source) {
  const Json& first = reader.element("accessors", reader.number(primitives.front(), "indices"));
  const uint64_t component = reader.number(first, "componentType"), view = reader.number(first, "bufferView");
  if (component != kUnsignedShort && component != kUnsignedInt) reader.refuse("indices have an unknown type");
  const uint64_t corner_size = component == kUnsignedShort ? 2 : 4;
  if (part_names.size() != primitives.size()) reader.refuse("\"parts\" does not name every primitive");

  uint64_t corner = 0;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Json& primitive = primitives[i];
    const Json& accessor = reader.element("accessors", reader.number(primitive, "indices"));
    const uint64_t count = reader.number(accessor, "count");
    const uint64_t offset = Reader::find(accessor, "byteOffset") ? reader.number(accessor, "byteOffset") : 0;
    if (reader.number(accessor, "bufferView") != view || reader.number(accessor, "componentType") != component ||
        offset != corner * corner_size || count % 3 != 0 || Reader::find(accessor, "sparse") != nullptr) {
      reader.refuse("the primitives do not share one run of indices");
    }
    if (attribute_accessors(reader, primitive) != attribute_accessors(reader, primitives.front())) {
      reader.refuse("the primitives do not share their vertices");
    }
    SourcePart& part = source.part.emplace_back();
    part.name = reader.text(part_names[i], "parts");
    part.material = reader.number32(primitive, "material");
    part.first_triangle = static_cast<uint32_t>(corner / 3);
    part.triangle_count = static_cast<uint32_t>(count / 3);
    corner += count;
    if (corner > 0xFFFFFFFFU) reader.refuse("there are too many indices");
  }
  if (component == kUnsignedInt) {
    source.triangle = group_corners(reader.values<uint32_t>(first, "bufferView", corner));
  } else {
    const auto narrow = reader.values<uint16_t>(first, "bufferView", corner);
    source.triangle = group_corners({narrow.begin(), narrow.end()});
  }
}

void read_images(Reader& reader, SourceMesh& source) {
  if (Reader::find(reader.root(), "images") == nullptr) return;
  for (const Json& json : reader.array(reader.root(), "images")) {
    SourceImage& image = source.image.emplace_back();
    image.name = reader.text_or_empty(json, "name");
    image.mime_type = reader.text(reader.member(json, "mimeType"), "mimeType");
    image.bytes = reader.values<uint8_t>(json, "bufferView");
  }
}

/// The image that a material's member key shows.
std::optional<uint32_t> read_texture(const Reader& reader, const Json& material, const char* key) {
  const Json* info = Reader::find(material, key);
  if (info == nullptr) return std::nullopt;
  return reader.number32(reader.element("textures", reader.number(*info, "index")), "source");
}

SourceMaterial read_material(const Reader& reader, const Json& json) {
  SourceMaterial material;
  material.name = reader.text_or_empty(json, "name");
  const Json& pbr = reader.member(json, "pbrMetallicRoughness");
  const Json& color = reader.array(pbr, "baseColorFactor");
  if (color.size() != material.base_color.size()) reader.refuse("\"baseColorFactor\" does not have four numbers");
  for (std::size_t i = 0; i < color.size(); ++i) material.base_color[i] = reader.real(color[i], "baseColorFactor");
  material.metallic = reader.real(reader.member(pbr, "metallicFactor"), "metallicFactor");
  material.roughness = reader.real(reader.member(pbr, "roughnessFactor"), "roughnessFactor");
  material.base_color_image = read_texture(reader, pbr, "baseColorTexture");
  material.metallic_roughness_image = read_texture(reader, pbr, "metallicRoughnessTexture");
  material.normal_image = read_texture(reader, json, "normalTexture");
  const std::string mode = reader.text_or_empty(json, "alphaMode");
  material.alpha_mask = mode == "MASK";
  material.alpha_blend = mode == "BLEND";
  if (const Json* cutoff = Reader::find(json, "alphaCutoff")) {
    material.alpha_cutoff = reader.real(*cutoff, "alphaCutoff");
  }
  return material;
}

SourceMesh read_source_mesh(Reader& reader, const Json& cloth) {
  SourceMesh source;
  const Json& primitives = reader.array(reader.element("meshes", reader.number(cloth, "mesh")), "primitives");
  if (primitives.empty()) reader.refuse("the mesh has no primitives");
  const Json& attributes = reader.member(primitives.front(), "attributes");
  source.position = read_attribute<Vec3>(reader, attributes, "POSITION");
  source.normal = read_attribute<Vec3>(reader, attributes, "NORMAL");
  if (Reader::find(attributes, "TEXCOORD_0")) source.uv = read_attribute<Vec2>(reader, attributes, "TEXCOORD_0");
  read_primitives(reader, primitives, reader.array(cloth, "parts"), source);
  read_images(reader, source);
  for (const Json& json : reader.array(reader.root(), "materials")) {
    source.material.push_back(read_material(reader, json));
  }
  const Json& vertices = reader.member(cloth, "sourceVertices");
  source.source_vertex_count = reader.number32(vertices, "count");
  source.source_vertex = reader.values<uint32_t>(vertices, "indices", source.position.size());
  return source;
}

Layout read_layout(const Reader& reader, const Json& cloth) {
  const std::string text = reader.text(reader.member(cloth, "layout"), "layout");
  for (const Layout layout : {Layout::square, Layout::panels, Layout::uv}) {
    if (text == to_string(layout)) return layout;
  }
  reader.refuse("\"layout\" is not square, panels or uv");
}

/// The per-pixel arrays; positions and areas are stored for valid pixels only.
void read_pixels(Reader& reader, const Json& cloth, ClothAsset& asset) {
  const uint64_t count = uint64_t{asset.width} * asset.height;
  asset.chart = reader.values<uint16_t>(cloth, "charts", count);
  asset.spring_mask = reader.values<uint8_t>(cloth, "springs", count);
  asset.cell = reader.values<uint8_t>(cloth, "cells", count);
  asset.rest_position.resize(asset.chart.size());
  asset.area.resize(asset.chart.size());
  const uint32_t valid_count = count_valid_pixels(asset);
  if (valid_count == 0) return;
  const auto positions = reader.values<Vec3>(cloth, "positions", valid_count);
  const auto areas = reader.values<float>(cloth, "areas", valid_count);
  for (uint32_t pixel = 0, i = 0; pixel < asset.pixel_count(); ++pixel) {
    if (!asset.valid(pixel)) continue;
    asset.rest_position[pixel] = positions[i];
    asset.area[pixel] = areas[i++];
  }
}

void read_tables(Reader& reader, const Json& cloth, ClothAsset& asset) {
  if (const Json* splits = Reader::find(cloth, "splits")) {
    asset.splits.offset = reader.values<uint32_t>(*splits, "offsets");
    asset.splits.pixel = reader.values<uint32_t>(*splits, "pixels");
  }
  if (const Json* bends = Reader::find(cloth, "seamBends")) {
    const auto pixels = reader.values<std::array<uint32_t, 3>>(*bends, "pixels");
    const auto lengths = reader.values<float>(*bends, "restLengths", pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      asset.seam_bends.push_back({pixels[i][0], pixels[i][1], pixels[i][2], lengths[i]});
    }
  }
}

void read_binding(Reader& reader, const Json& cloth, ClothAsset& asset) {
  const std::size_t count = asset.source.position.size();
  const Json& binding = reader.member(cloth, "binding");
  const auto pixels = reader.values<std::array<uint32_t, 3>>(binding, "pixels", count);
  const auto weights = reader.values<std::array<float, 3>>(binding, "weights", count);
  const auto offsets = reader.values<Vec3>(binding, "offsets", count);
  asset.binding.reserve(count);
  for (std::size_t i = 0; i < count; ++i) asset.binding.push_back({pixels[i], weights[i], offsets[i]});
}

void read_vertex_groups(Reader& reader, const Json& cloth, ClothAsset& asset) {
  if (Reader::find(cloth, "vertexGroups") == nullptr) return;
  for (const Json& json : reader.array(cloth, "vertexGroups")) {
    ClothAsset::VertexGroup& group = asset.vertex_groups.emplace_back();
    group.name = reader.text(reader.member(json, "name"), "name");
    if (Reader::find(json, "vertices")) group.source_vertex = reader.values<uint32_t>(json, "vertices");
  }
}

ClothAsset read_cloth(Reader& reader, const Json& cloth) {
  ClothAsset asset;
  asset.name = reader.text(reader.member(cloth, "name"), "name");
  asset.layout = read_layout(reader, cloth);
  asset.width = static_cast<uint32_t>(reader.number(cloth, "width", kMaxImageSide));
  asset.height = static_cast<uint32_t>(reader.number(cloth, "height", kMaxImageSide));
  asset.spacing = reader.real(reader.member(cloth, "spacing"), "spacing");
  asset.chart_count = reader.number32(cloth, "chartCount");
  read_pixels(reader, cloth, asset);
  read_tables(reader, cloth, asset);
  asset.source = read_source_mesh(reader, cloth);
  read_binding(reader, cloth, asset);
  read_vertex_groups(reader, cloth, asset);
  return asset;
}

}  // namespace

std::vector<std::byte> encode_asset(const ClothAsset& asset) {
  validate(asset);
  glb::Builder builder;
  add_source_mesh(builder, asset);
  builder.root["extensions"] = {{kAssetExtension, add_cloth(builder, asset)}};
  builder.root["extensionsUsed"] = {kAssetExtension};
  return builder.bytes();
}

ClothAsset decode_asset(std::span<const std::byte> bytes, const std::string& name) {
  const glb::Container container = glb::parse(bytes, name);
  Reader reader(container, name);
  const Json* extensions = Reader::find(container.json, "extensions");
  const Json* cloth = extensions == nullptr ? nullptr : Reader::find(*extensions, kAssetExtension);
  if (cloth == nullptr) {
    throw Error(ErrorCode::unsupported,
                name + ": is a glTF file without a geometry image; make an asset of it with geocloth convert");
  }
  if (const uint64_t version = reader.number(*cloth, "version"); version != kFormatVersion) {
    throw Error(ErrorCode::unsupported, name + ": has version " + std::to_string(version) + " of " + kAssetExtension +
                                            "; version 1 is read: update geocloth or convert the garment again");
  }
  ClothAsset asset = read_cloth(reader, *cloth);
  try {
    validate(asset);
  } catch (const Error& error) {
    reader.refuse(error.what());
  }
  return asset;
}

void write_asset(const ClothAsset& asset, const std::filesystem::path& path) {
  write_file(path, encode_asset(asset));
}

ClothAsset read_asset(const std::filesystem::path& path) {
  return decode_asset(read_file(path), path.string());
}

}  // namespace geocloth
