// SPDX-License-Identifier: GPL-3.0-or-later
// EXT_meshopt_compression: a view holds a stream of meshoptimizer's vertex or index codec, optionally filtered.
#include <array>
#include <cstdint>
#include <utility>

#include <meshoptimizer.h>

#include "import/gltf_compression.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Mode = MeshoptLayout::Mode;
using Filter = MeshoptLayout::Filter;

template <typename Value, std::size_t N>
Value named(const GltfFile& gltf, const GltfFile::Json& object, const char* key, const std::string& where,
            const char* otherwise, const std::array<std::pair<const char*, Value>, N>& names) {
  const auto it = object.find(key);
  const std::string name = it == object.end() ? otherwise : it->is_string() ? it->get<std::string>() : "";
  for (const auto& [known, value] : names) {
    if (name == known) return value;
  }
  gltf.bad(where + "." + key + " is missing or unknown");
}

void check_layout(const GltfFile& gltf, const MeshoptLayout& layout, const std::string& where) {
  const std::size_t stride = layout.stride;
  const bool attributes = layout.mode == Mode::attributes;
  if (layout.count > kMaxElements) {
    fail(gltf.path, ErrorCode::limit, where + " has more than 100 million elements");
  }
  if (attributes ? stride == 0 || stride % 4 != 0 || stride > 256 : stride != 2 && stride != 4) {
    gltf.bad(where + ".byteStride is not allowed for its mode");
  }
  if (layout.mode == Mode::triangles && layout.count % 3 != 0) gltf.bad(where + ".count is not a multiple of three");
  const bool fits = layout.filter == Filter::none || layout.filter == Filter::exponential ||
                    (layout.filter == Filter::octahedral ? stride == 4 || stride == 8 : stride == 8);
  if (!fits || (!attributes && layout.filter != Filter::none)) {
    gltf.bad(where + ".filter is not allowed for its mode and stride");
  }
}

bool decode(std::vector<std::byte>& out, const MeshoptLayout& layout, const unsigned char* bytes, std::size_t size) {
  switch (layout.mode) {
    case Mode::attributes:
      return meshopt_decodeVertexBuffer(out.data(), layout.count, layout.stride, bytes, size) == 0;
    case Mode::triangles:
      return meshopt_decodeIndexBuffer(out.data(), layout.count, layout.stride, bytes, size) == 0;
    case Mode::indices:
      return meshopt_decodeIndexSequence(out.data(), layout.count, layout.stride, bytes, size) == 0;
  }
  return false;
}

void unfilter(std::vector<std::byte>& out, const MeshoptLayout& layout) {
  switch (layout.filter) {
    case Filter::none:
      return;
    case Filter::octahedral:
      return meshopt_decodeFilterOct(out.data(), layout.count, layout.stride);
    case Filter::quaternion:
      return meshopt_decodeFilterQuat(out.data(), layout.count, layout.stride);
    case Filter::exponential:
      return meshopt_decodeFilterExp(out.data(), layout.count, layout.stride);
  }
}

}  // namespace

MeshoptLayout read_meshopt_layout(const GltfFile& gltf, const GltfFile::Json& extension, const std::string& where) {
  constexpr std::array<std::pair<const char*, Mode>, 3> kModes{
      {{"ATTRIBUTES", Mode::attributes}, {"TRIANGLES", Mode::triangles}, {"INDICES", Mode::indices}}};
  constexpr std::array<std::pair<const char*, Filter>, 4> kFilters{{{"NONE", Filter::none},
                                                                    {"OCTAHEDRAL", Filter::octahedral},
                                                                    {"QUATERNION", Filter::quaternion},
                                                                    {"EXPONENTIAL", Filter::exponential}}};
  MeshoptLayout layout;
  layout.mode = named(gltf, extension, "mode", where, "", kModes);
  layout.filter = named(gltf, extension, "filter", where, "NONE", kFilters);
  layout.count = gltf.number(extension, "count", where);
  layout.stride = gltf.number(extension, "byteStride", where);
  check_layout(gltf, layout, where);
  return layout;
}

std::vector<std::byte> decode_meshopt(const GltfFile& gltf, GltfFile::Bytes bytes, const MeshoptLayout& layout,
                                      const std::string& where) {
  // A byte of the stream holds sixteen vertices' worth of one byte at best; the index codecs take one for a triangle.
  if (layout.count / 16 > bytes.size()) gltf.bad(where + ".count is more than its bytes can hold");
  std::vector<std::byte> out(layout.count * layout.stride);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (!decode(out, layout, data, bytes.size())) {
    gltf.bad(where + ": the stream cannot be decoded; is the file damaged, or newer than EXT_meshopt_compression?");
  }
  unfilter(out, layout);
  return out;
}

}  // namespace geocloth::import_detail
