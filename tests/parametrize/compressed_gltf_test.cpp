// SPDX-License-Identifier: GPL-3.0-or-later
// Most garments on the web are compressed: EXT_meshopt_compression and KHR_draco_mesh_compression have to give the mesh
// that was compressed, and damaged streams an Error. The streams are made by the encoders of both libraries.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/geometry_metadata.h>
#include <meshoptimizer.h>

#include "import_fixture.h"

namespace geocloth {
namespace {

using test::Gltf;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr uint32_t kSide = 20;

class CompressedGltf : public test::ImportTest {};

/// A wavy sheet of kSide x kSide points with texture coordinates.
struct Sheet {
  std::vector<std::array<float, 3>> position;
  std::vector<std::array<float, 2>> uv;
  std::vector<uint32_t> index;
};

Sheet sheet() {
  Sheet s;
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x) {
      const float u = static_cast<float>(x) / (kSide - 1), v = static_cast<float>(y) / (kSide - 1);
      s.position.push_back({u, v, 0.1F * std::sin(9 * u)});
      s.uv.push_back({u, v});
      if (x + 1 == kSide || y + 1 == kSide) continue;
      const uint32_t i = y * kSide + x;
      s.index.insert(s.index.end(), {i, i + 1, i + kSide, i + 1, i + kSide + 1, i + kSide});
    }
  }
  return s;
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Scene, mesh and accessors, without the views that the accessors need.
Gltf scene_of(const Sheet& s) {
  Gltf g;
  g.json = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"accessors",
             {{{"componentType", 5126}, {"type", "VEC3"}, {"count", s.position.size()}},
              {{"componentType", 5126}, {"type", "VEC2"}, {"count", s.uv.size()}},
              {{"componentType", 5125}, {"type", "SCALAR"}, {"count", s.index.size()}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}}}}}}}};
  return g;
}

// --- meshopt

void add_meshopt_view(Gltf& g, std::vector<unsigned char> stream, std::size_t size, const char* mode, std::size_t count,
                      std::size_t stride) {
  stream.resize(size);
  const std::size_t view = g.add_view(bytes_of(stream));
  Json& json = g.json["bufferViews"][view];
  Json compression = {{"buffer", 0},        {"byteOffset", json["byteOffset"]},
                      {"byteLength", size}, {"mode", mode},
                      {"count", count},     {"byteStride", stride}};
  // The view itself lies in a buffer that nobody wrote.
  json = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", compression}}}};
  if (std::strcmp(mode, "ATTRIBUTES") == 0) json["byteStride"] = stride;
}

template <typename T>
void add_meshopt_attribute(Gltf& g, const std::vector<T>& values) {
  std::vector<unsigned char> stream(meshopt_encodeVertexBufferBound(values.size(), sizeof(T)));
  const std::size_t size =
      meshopt_encodeVertexBuffer(stream.data(), stream.size(), values.data(), values.size(), sizeof(T));
  add_meshopt_view(g, stream, size, "ATTRIBUTES", values.size(), sizeof(T));
}

Gltf meshopt_gltf(const Sheet& s, const char* mode = "TRIANGLES") {
  Gltf g = scene_of(s);
  add_meshopt_attribute(g, s.position);
  add_meshopt_attribute(g, s.uv);
  std::vector<unsigned char> stream(meshopt_encodeIndexBufferBound(s.index.size(), s.position.size()) +
                                    meshopt_encodeIndexSequenceBound(s.index.size(), s.position.size()));
  const bool triangles = std::strcmp(mode, "TRIANGLES") == 0;
  const std::size_t size =
      triangles ? meshopt_encodeIndexBuffer(stream.data(), stream.size(), s.index.data(), s.index.size())
                : meshopt_encodeIndexSequence(stream.data(), stream.size(), s.index.data(), s.index.size());
  add_meshopt_view(g, stream, size, mode, s.index.size(), 4);
  for (std::size_t i = 0; i < 3; ++i) g.json["accessors"][i]["bufferView"] = i;
  g.more_buffers = {{{"byteLength", 1 << 20}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  g.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return g;
}

TEST_F(CompressedGltf, MeshoptGivesTheMeshBitForBit) {
  const Sheet s = sheet();
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    const TriangleMesh mesh = read("a.glb", meshopt_gltf(s, mode).glb());
    ASSERT_EQ(mesh.position.size(), s.position.size());
    for (std::size_t i = 0; i < s.position.size(); ++i) {
      EXPECT_EQ(mesh.position[i][1], static_cast<double>(s.position[i][1]));
      EXPECT_EQ(mesh.position[i][2], static_cast<double>(s.position[i][2]));
    }
    ASSERT_EQ(mesh.triangle.size(), s.index.size() / 3);
    ASSERT_EQ(mesh.uv.size(), mesh.triangle.size());
  }
}

TEST_F(CompressedGltf, MeshoptOfQuantisedPositionsIsUnfiltered) {
  // gltfpack -c writes positions as 16-bit integers and may write floats through the exponential filter.
  const Sheet s = sheet();
  Gltf g = meshopt_gltf(s);
  std::vector<std::array<uint32_t, 3>> filtered(s.position.size());
  meshopt_encodeFilterExp(filtered.data(), filtered.size(), 12, 20, s.position.front().data());
  g.json["bufferViews"].erase(0);
  add_meshopt_attribute(g, filtered);
  const Json last = g.json["bufferViews"].back();
  g.json["bufferViews"].erase(g.json["bufferViews"].size() - 1);
  g.json["bufferViews"].insert(g.json["bufferViews"].begin(), last);
  g.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = "EXPONENTIAL";
  const TriangleMesh mesh = read("a.glb", g.glb());
  ASSERT_EQ(mesh.position.size(), s.position.size());
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    EXPECT_NEAR(mesh.position[i][0], static_cast<double>(s.position[i][0]), 1e-5);
    EXPECT_NEAR(mesh.position[i][2], static_cast<double>(s.position[i][2]), 1e-5);
  }
}

TEST_F(CompressedGltf, MeshoptThatCannotBeRightIsRefused) {
  const auto compression = [](Gltf& g) -> Json& {
    return g.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
  };
  const std::vector<std::pair<const char*, Json>> wrong{
      {"mode", "VERTICES"},    {"mode", 7},       {"filter", "OCTAHEDRAL"},
      {"filter", "COLOR"},     {"byteStride", 6}, {"byteStride", 0},
      {"count", 2000000000},   {"count", 100000}, {"buffer", 5},
      {"byteOffset", 1 << 30}, {"byteLength", 3}, {"count", -1}};
  for (const auto& [key, value] : wrong) {
    Gltf g = meshopt_gltf(sheet());
    compression(g)[key] = value;
    EXPECT_THAT(refusal("a.glb", g.glb()).what(), HasSubstr("ufferViews[0]")) << key << value;
  }
}

TEST_F(CompressedGltf, DamagedMeshoptEndsInAMeshOrAnError) {
  survive_damage("a.glb", meshopt_gltf(sheet()).glb(), 300);
}

// --- Draco

std::string draco_stream(const Sheet& s, int method, bool metadata) {
  draco::Mesh mesh;
  const auto points = static_cast<uint32_t>(s.position.size());
  mesh.set_num_points(points);
  const auto add = [&](draco::GeometryAttribute::Type type, int8_t components, const auto& values) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<uint8_t>(components), draco::DT_FLOAT32, false, 4 * components, 0);
    const int id = mesh.AddAttribute(attribute, true, points);
    for (uint32_t i = 0; i < points; ++i) {
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), values[i].data());
    }
  };
  add(draco::GeometryAttribute::POSITION, 3, s.position);
  add(draco::GeometryAttribute::TEX_COORD, 2, s.uv);
  for (std::size_t i = 0; i + 2 < s.index.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(s.index[i]), draco::PointIndex(s.index[i + 1]), draco::PointIndex(s.index[i + 2])});
  }
  if (metadata) {
    auto described = std::make_unique<draco::GeometryMetadata>();
    described->AddEntryString("maker", "a tailor");
    mesh.AddMetadata(std::move(described));
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

Gltf draco_gltf(const Sheet& s, int method = draco::MESH_EDGEBREAKER_ENCODING, bool metadata = false) {
  Gltf g = scene_of(s);
  const std::size_t view = g.add_view(draco_stream(s, method, metadata));
  g.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
  g.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return g;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangle) {
    const Point3 a = mesh.position[t[0]], b = mesh.position[t[1]], c = mesh.position[t[2]];
    const Point3 p{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, q{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    sum += std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]) / 2;
  }
  return sum;
}

TEST_F(CompressedGltf, DracoGivesTheMeshToItsQuantisation) {
  const Sheet s = sheet();
  const TriangleMesh plain = read("plain.glb", meshopt_gltf(s).glb());
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    for (const bool metadata : {false, true}) {
      const TriangleMesh mesh = read("a.glb", draco_gltf(s, method, metadata).glb());
      ASSERT_EQ(mesh.triangle.size(), plain.triangle.size());
      EXPECT_EQ(mesh.position.size(), plain.position.size());
      EXPECT_NEAR(area(mesh), area(plain), 1e-3);
      ASSERT_EQ(mesh.uv.size(), mesh.triangle.size());
      // The decoder numbers points anew: u is the x of the same corner, v (which runs down) its y.
      for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(mesh.uv[t][k][0], mesh.position[mesh.triangle[t][k]][0], 1e-3);
      }
    }
  }
}

TEST_F(CompressedGltf, DracoBesideAPlainMeshIsNotNeeded) {
  const Sheet s = sheet();
  Gltf g = scene_of(s);
  for (std::size_t i = 0; i < 3; ++i) {
    g.json["accessors"][i]["bufferView"] = g.add_view(i == 0   ? bytes_of(s.position)
                                                      : i == 1 ? bytes_of(s.uv)
                                                               : bytes_of(s.index));
  }
  const std::size_t rubbish = g.add_view("no Draco");
  g.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", rubbish}, {"attributes", {{"POSITION", 0}}}};
  EXPECT_EQ(read("a.glb", g.glb()).triangle.size(), s.index.size() / 3);
}

TEST_F(CompressedGltf, DracoThatCannotBeRightIsRefused) {
  const auto extension = [](Gltf& g) -> Json& {
    return g.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  };
  const std::vector<std::pair<const char*, std::function<void(Gltf&)>>> wrong{
      {"bufferView", [&](Gltf& g) { extension(g)["bufferView"] = 9; }},
      {"bufferView", [&](Gltf& g) { extension(g).erase("bufferView"); }},
      {"attributes", [&](Gltf& g) { extension(g)["attributes"] = 3; }},
      {"POSITION", [&](Gltf& g) { extension(g)["attributes"]["POSITION"] = 1; }},
      {"POSITION", [&](Gltf& g) { extension(g)["attributes"]["POSITION"] = 77; }},
      {"without data", [&](Gltf& g) { extension(g)["attributes"].erase("POSITION"); }},
      {"TEXCOORD_0", [&](Gltf& g) { g.json["accessors"][1]["type"] = "VEC4"; }},
      {"2.2", [&](Gltf& g) { g.binary[0] = 'd'; }},
      {"2.2", [&](Gltf& g) { g.json["bufferViews"][0]["byteLength"] = 10; }},
      {"gives up", [&](Gltf& g) { g.json["bufferViews"][0]["byteLength"] = 40; }},
      // Four billion faces in a few bytes: what the library would allocate for.
      {"20 million", [&](Gltf& g) { g.binary.replace(12, 12, std::string(12, '\xff')); }}};
  for (const auto& [word, apply] : wrong) {
    Gltf g = draco_gltf(sheet());
    apply(g);
    EXPECT_THAT(refusal("a.glb", g.glb()).what(), HasSubstr(word));
  }
}

TEST_F(CompressedGltf, DamagedDracoEndsInAMeshOrAnError) {
  survive_damage("a.glb", draco_gltf(sheet()).glb(), 300);
  survive_damage("b.glb", draco_gltf(sheet(), draco::MESH_SEQUENTIAL_ENCODING, true).glb(), 300);
}

}  // namespace
}  // namespace geocloth
