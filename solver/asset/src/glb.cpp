// SPDX-License-Identifier: Apache-2.0
// The container of glTF 2.0 (specification, section 4): a header of 12 bytes, a JSON chunk padded with spaces, a binary
// chunk padded with zeros. Ours instead of tinygltf: a file may come from anywhere, and a reader of two hundred lines
// over nlohmann-json, in which every size is compared with the bytes at hand before anything is allocated, can be
// fuzzed and read at a sitting; a general loader decodes images, follows paths and trusts counts before it is asked.
#include "glb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <utility>

#include "geocloth/asset/error.h"

namespace geocloth::glb {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian; so is every machine we run on");

constexpr uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8, kAlignment = 4;
constexpr uint64_t kMaxFileSize = 0xFFFFFFFFU;
constexpr std::size_t kMaxJsonSize = std::size_t{64} << 20U;
constexpr uint32_t kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr uint32_t kMaxShortVertices = 0xFFFF;  ///< index 65535 is reserved for primitive restart

std::size_t padding(uint64_t size) {
  return static_cast<std::size_t>((kAlignment - size % kAlignment) % kAlignment);
}

void append_u32(std::vector<std::byte>& bytes, uint64_t value) {
  const auto word = std::bit_cast<std::array<std::byte, 4>>(static_cast<uint32_t>(value));
  bytes.insert(bytes.end(), word.begin(), word.end());
}

uint32_t read_u32(std::span<const std::byte> bytes, std::size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Smallest and largest value of every component of `count` tuples of `width` floats.
std::pair<std::vector<float>, std::vector<float>> bounds(const float* values, std::size_t count, std::size_t width) {
  std::vector<float> low(values, values + width), high = low;
  for (std::size_t i = 0; i < count * width; ++i) {
    low[i % width] = std::min(low[i % width], values[i]);
    high[i % width] = std::max(high[i % width], values[i]);
  }
  return {std::move(low), std::move(high)};
}

Json material_json(const SourceMaterial& material, std::optional<uint32_t> first_texture) {
  Json pbr = {{"baseColorFactor", material.base_color},
              {"metallicFactor", material.metallic},
              {"roughnessFactor", material.roughness}};
  Json json = {{"doubleSided", true}};
  if (!material.name.empty()) json["name"] = material.name;
  const auto texture = [&](Json& parent, const char* key, std::optional<uint32_t> image) {
    if (image && first_texture) parent[key] = {{"index", *first_texture + *image}};
  };
  texture(pbr, "baseColorTexture", material.base_color_image);
  texture(pbr, "metallicRoughnessTexture", material.metallic_roughness_image);
  texture(json, "normalTexture", material.normal_image);
  json["pbrMetallicRoughness"] = std::move(pbr);
  if (material.alpha_mask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  } else if (material.alpha_blend) {
    json["alphaMode"] = "BLEND";
  }
  return json;
}

uint32_t append(Json& root, const char* array, Json element) {
  Json& list = root[array];
  list.push_back(std::move(element));
  return static_cast<uint32_t>(list.size() - 1);
}

}  // namespace

Builder::Builder(OutputFile* spill) : spill_(spill) {
  root = {{"asset", {{"version", "2.0"}, {"generator", kGenerator}}}, {"scene", 0}};
}

uint32_t Builder::add_view(std::span<const std::byte> bytes, Target target, uint32_t stride) {
  constexpr std::array<std::byte, kAlignment> kZeros{};
  const std::span<const std::byte> tail(kZeros.data(), padding(bytes.size()));
  const uint64_t offset = size_;
  size_ += bytes.size() + tail.size();
  if (size_ > kMaxFileSize) {
    throw Error(ErrorCode::limit, "a .glb file ends at 4 GiB; write fewer frames, or a point cache (.pc2, .mdd)");
  }
  for (const auto part : {bytes, tail}) {
    if (spill_ != nullptr) {
      spill_->write(part);
    } else {
      binary_.insert(binary_.end(), part.begin(), part.end());
    }
  }
  Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target != Target::none) view["target"] = static_cast<uint32_t>(target);
  if (stride != 0) view["byteStride"] = stride;
  return append(root, "bufferViews", std::move(view));
}

uint32_t Builder::add_accessor(const char* type, std::size_t count, uint32_t view, std::size_t byte_offset,
                               Bounds bounds) {
  return append(root, "accessors",
                {{"bufferView", view},
                 {"byteOffset", byte_offset},
                 {"componentType", kFloat},
                 {"count", count},
                 {"type", type},
                 {"min", std::move(bounds.min)},
                 {"max", std::move(bounds.max)}});
}

uint32_t Builder::add_accessor(std::span<const Vec3> values, uint32_t view, std::size_t byte_offset) {
  auto [low, high] = bounds(&values.data()->x, values.size(), 3);
  return add_accessor("VEC3", values.size(), view, byte_offset, {std::move(low), std::move(high)});
}

uint32_t Builder::add_accessor(std::span<const Vec2> values, uint32_t view, std::size_t byte_offset) {
  auto [low, high] = bounds(&values.data()->x, values.size(), 2);
  return add_accessor("VEC2", values.size(), view, byte_offset, {std::move(low), std::move(high)});
}

uint32_t Builder::add_accessor(std::span<const float> values, uint32_t view, std::size_t byte_offset) {
  auto [low, high] = bounds(values.data(), values.size(), 1);
  return add_accessor("SCALAR", values.size(), view, byte_offset, {std::move(low), std::move(high)});
}

uint32_t Builder::add_index_view(std::span<const Triangle> triangles, uint32_t vertex_count) {
  if (vertex_count > kMaxShortVertices) return add_view(std::as_bytes(triangles), Target::indices);
  std::vector<uint16_t> corners;
  corners.reserve(triangles.size() * 3);
  for (const Triangle& t : triangles) {
    for (const uint32_t v : t) corners.push_back(static_cast<uint16_t>(v));
  }
  return add_array(corners, Target::indices);
}

uint32_t Builder::add_index_accessor(uint32_t view, std::size_t first_triangle, std::size_t triangle_count,
                                     uint32_t vertex_count) {
  const bool is_short = vertex_count <= kMaxShortVertices;
  return append(root, "accessors",
                {{"bufferView", view},
                 {"byteOffset", first_triangle * 3 * (is_short ? 2U : 4U)},
                 {"componentType", is_short ? kUnsignedShort : kUnsignedInt},
                 {"count", triangle_count * 3},
                 {"type", "SCALAR"}});
}

uint32_t Builder::add_materials(const SourceMesh& source) {
  const auto first_texture = static_cast<uint32_t>(root.value("textures", Json::array()).size());
  for (const SourceImage& image : source.image) {
    Json json = {{"mimeType", image.mime_type}, {"bufferView", add_array(image.bytes)}};
    if (!image.name.empty()) json["name"] = image.name;
    const uint32_t index = append(root, "images", std::move(json));
    append(root, "textures", {{"source", index}});
  }
  const auto first_material = static_cast<uint32_t>(root.value("materials", Json::array()).size());
  for (const SourceMaterial& material : source.material) {
    // A texture without texture coordinates is an error in glTF, and could show nothing.
    const auto textures = source.uv.empty() ? std::nullopt : std::optional(first_texture);
    append(root, "materials", material_json(material, textures));
  }
  return first_material;
}

std::vector<std::byte> Builder::head() {
  root["buffers"] = Json::array({{{"byteLength", size_}}});
  // Names come from foreign files: what is not UTF-8 in them becomes U+FFFD.
  std::string json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  json.append(padding(json.size()), ' ');
  const uint64_t total = kHeaderSize + kChunkHeaderSize + json.size() + kChunkHeaderSize + size_;
  if (total > kMaxFileSize) throw Error(ErrorCode::limit, "a .glb file ends at 4 GiB; write fewer frames");
  std::vector<std::byte> bytes;
  bytes.reserve(static_cast<std::size_t>(total - size_));
  append_u32(bytes, kMagic);
  append_u32(bytes, kVersion);
  append_u32(bytes, total);
  append_u32(bytes, json.size());
  append_u32(bytes, kJsonChunk);
  const auto text = std::as_bytes(std::span(json.data(), json.size()));
  bytes.insert(bytes.end(), text.begin(), text.end());
  append_u32(bytes, size_);
  append_u32(bytes, kBinaryChunk);
  return bytes;
}

std::vector<std::byte> Builder::bytes() {
  std::vector<std::byte> bytes = head();
  bytes.insert(bytes.end(), binary_.begin(), binary_.end());
  return bytes;
}

void Builder::write(OutputFile& file) {
  file.write(head());
  if (spill_ == nullptr) {
    file.write(binary_);
    return;
  }
  spill_->close();
  file.append_file(spill_->temporary_path());
}

Container parse(std::span<const std::byte> bytes, const std::string& name) {
  const auto broken = [&](const std::string& what) { return Error(ErrorCode::invalid_data, name + ": " + what); };
  if (bytes.empty()) throw broken("is empty");
  if (bytes.size() < 4 || read_u32(bytes, 0) != kMagic) {
    throw broken("is not a binary glTF file; make one with geocloth convert");
  }
  if (bytes.size() < kHeaderSize + kChunkHeaderSize) throw broken("is truncated in its header");
  if (read_u32(bytes, 4) != kVersion) {
    throw Error(ErrorCode::unsupported,
                name + ": is binary glTF of version " + std::to_string(read_u32(bytes, 4)) + "; version 2 is read");
  }
  if (const std::size_t size = read_u32(bytes, 8); size != bytes.size()) {
    const std::string sizes = std::to_string(bytes.size()) + " of " + std::to_string(size) + " bytes";
    throw broken((bytes.size() < size ? "is truncated: has " : "has more than its header says: ") + sizes +
                 "; copy or make it again");
  }
  const std::size_t json_size = read_u32(bytes, kHeaderSize);
  if (read_u32(bytes, kHeaderSize + 4) != kJsonChunk) throw broken("does not begin with a JSON chunk");
  std::span<const std::byte> rest = bytes.subspan(kHeaderSize + kChunkHeaderSize);
  if (json_size > rest.size()) throw broken("has a JSON chunk that is longer than the file");
  if (json_size > kMaxJsonSize) throw Error(ErrorCode::limit, name + ": has a JSON chunk of more than 64 MiB");
  const char* text = reinterpret_cast<const char*>(rest.data());
  Container container;
  try {
    container.json = Json::parse(text, text + json_size);
  } catch (const Json::exception&) {
    throw broken("has a JSON chunk that is not JSON");
  }
  rest = rest.subspan(json_size);
  if (rest.empty()) return container;
  if (rest.size() < kChunkHeaderSize || read_u32(rest, 0) > rest.size() - kChunkHeaderSize) {
    throw broken("has a binary chunk that is longer than the file");
  }
  if (read_u32(rest, 4) != kBinaryChunk) throw broken("has a second chunk that is not binary data");
  container.binary = rest.subspan(kChunkHeaderSize, read_u32(rest, 0));
  return container;
}

}  // namespace geocloth::glb
