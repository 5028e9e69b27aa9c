// SPDX-License-Identifier: Apache-2.0
// The asset as a glTF 2.0 binary file; the page GEOCLOTH_geometry_image.md specifies it. The source mesh is plain glTF,
// and the cloth data lie in buffer views that only the extension names. Floats are copied bit for bit. The reader
// believes nothing (glb_reader.h), and validate() has the last word.
#include "geocloth/asset/asset_file.h"

#include <array>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"
#include "glb_reader.h"

namespace geocloth {
namespace {

using glb::Json;
using glb::Reader;

constexpr uint64_t kFormatVersion = 1;
constexpr uint32_t kMostSourceVertices = 100'000'000;  // as many as a mesh that is converted

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
  if (!asset.sewing.empty()) cloth["sewing"] = builder.add_array(asset.sewing);
  cloth["binding"] = {{"pixels", builder.add_array(column(asset.binding, [](const Binding& b) { return b.pixel; }))},
                      {"weights", builder.add_array(column(asset.binding, [](const Binding& b) { return b.weight; }))},
                      {"offsets", builder.add_array(column(asset.binding, [](const Binding& b) { return b.offset; }))}};
  cloth["sourceVertices"] = {{"count", asset.source.source_vertex_count},
                             {"indices", builder.add_array(asset.source.source_vertex)}};
  if (!asset.source.middle.empty()) cloth["sourceVertices"]["middles"] = builder.add_array(asset.source.middle);
  cloth["parts"] = column(asset.source.part, [](const SourcePart& part) { return part.name; });
  if (!asset.vertex_groups.empty()) cloth["vertexGroups"] = Json::array();
  for (const ClothAsset::VertexGroup& group : asset.vertex_groups) {
    Json json = {{"name", group.name}};
    if (!group.source_vertex.empty()) json["vertices"] = builder.add_array(group.source_vertex);
    cloth["vertexGroups"].push_back(std::move(json));
  }
  if (!asset.paint.empty()) cloth["paint"] = builder.add_array(asset.paint);
  return cloth;
}

// ---- reading ----

/// Not by comparing the JSON objects: that recurses as deep as a hostile file is nested.
std::array<uint64_t, 3> attribute_accessors(const Reader& reader, const Json& primitive) {
  const Json& attributes = reader.member(primitive, "attributes");
  const uint64_t uv = Reader::find(attributes, "TEXCOORD_0") ? reader.number(attributes, "TEXCOORD_0") + 1 : 0;
  return {reader.number(attributes, "POSITION"), reader.number(attributes, "NORMAL"), uv};
}

/// Triangles and parts: a primitive each, all over the same vertices.
void read_primitives(Reader& reader, const Json& primitives, const Json& part_names, SourceMesh& source) {
  if (part_names.size() != primitives.size()) reader.refuse("\"parts\" does not name every primitive");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const Json& primitive = primitives[i];
    if (attribute_accessors(reader, primitive) != attribute_accessors(reader, primitives.front())) {
      reader.refuse("the primitives do not share their vertices");
    }
    const std::vector<Triangle> triangles = reader.triangles(primitive, "indices");
    source.part.push_back({reader.text(part_names[i], "parts"), reader.number32(primitive, "material"),
                           static_cast<uint32_t>(source.triangle.size()), static_cast<uint32_t>(triangles.size())});
    source.triangle.insert(source.triangle.end(), triangles.begin(), triangles.end());
  }
}

SourceMesh read_source_mesh(Reader& reader, const Json& cloth) {
  SourceMesh source;
  const Json& primitives = reader.array(reader.element("meshes", reader.number(cloth, "mesh")), "primitives");
  if (primitives.empty()) reader.refuse("the mesh has no primitives");
  const Json& attributes = reader.member(primitives.front(), "attributes");
  source.position = reader.floats<Vec3>(attributes, "POSITION");
  source.normal = reader.floats<Vec3>(attributes, "NORMAL");
  if (Reader::find(attributes, "TEXCOORD_0")) source.uv = reader.floats<Vec2>(attributes, "TEXCOORD_0");
  read_primitives(reader, primitives, reader.array(cloth, "parts"), source);
  if (Reader::find(reader.root(), "images")) {
    const std::size_t count = reader.array(reader.root(), "images").size();
    for (std::size_t i = 0; i < count; ++i) source.image.push_back(reader.image(i));
  }
  source.material = reader.materials();
  const Json& vertices = reader.member(cloth, "sourceVertices");
  source.source_vertex_count = reader.number32(vertices, "count");
  if (source.source_vertex_count > kMostSourceVertices) {
    reader.refuse("sourceVertices.count is " + std::to_string(source.source_vertex_count) +
                  ", and no mesh has more than 100 million vertices");
  }
  source.source_vertex = reader.values<uint32_t>(vertices, "indices", source.position.size());
  if (Reader::find(vertices, "middles")) source.middle = reader.values<std::array<uint32_t, 2>>(vertices, "middles");
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
  if (Reader::find(cloth, "sewing")) asset.sewing = reader.values<std::array<uint32_t, 2>>(cloth, "sewing");
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
  if (Reader::find(cloth, "paint"))
    asset.paint = reader.values<Rgba8>(cloth, "paint", asset.source.source_vertex_count);
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
