// SPDX-License-Identifier: GPL-3.0-or-later
// Skinned and morphed glTF, and skinned DAE, come out where every viewer shows it before anything moves: a body that
// lies on its back, or a garment of another size than its wearer, would be of no use.
#include "import_fixture.h"

namespace geocloth::test {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void expect_at(const Point3& p, double x, double y, double z) {
  EXPECT_NEAR(p[0], x, 1e-6);
  EXPECT_NEAR(p[1], y, 1e-6);
  EXPECT_NEAR(p[2], z, 1e-6);
}

using ImportPose = ImportTest;

TEST_F(ImportPose, ASkinnedMeshStandsWhereItsJointsAreAndNotWhereItsNodeIs) {
  Gltf g = skinned_strip();
  g.json["nodes"][0]["rotation"] = {0.70710678, 0, 0, 0.70710678};
  g.json["nodes"][0]["translation"] = {5, 0, 0};
  const TriangleMesh bound = read("bound.glb", g.glb());
  EXPECT_THAT(bound.position, ElementsAre(Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{1, 1, 0},
                                          Point3{0, 2, 0}, Point3{1, 2, 0}));
  ASSERT_EQ(bound.part.size(), 1U);
  EXPECT_EQ(bound.part[0].name, "strip");
  EXPECT_EQ(read("avatar.vrm", g.glb()).position, bound.position);  // VRM is GLB under a name of its own

  // An armature in centimetres that stands on its head.
  g.json["nodes"][1]["scale"] = {0.01, 0.01, 0.01};
  g.json["nodes"][1]["rotation"] = {0, 0, 1, 0};
  g.json["nodes"][1]["translation"] = {0, 3, 0};
  const TriangleMesh placed = read("placed.glb", g.glb());
  expect_at(placed.position[5], -0.01, 2.98, 0);
  EXPECT_NEAR(placed.normal[0][0][2], 1, 1e-6);
}

TEST_F(ImportPose, ABentJointBendsTheMesh) {
  Gltf g = skinned_strip();
  g.json["nodes"][2]["rotation"] = {0.70710678, 0, 0, 0.70710678};  // +y to +z
  const TriangleMesh mesh = read("a.glb", g.glb());
  expect_at(mesh.position[1], 1, 0, 0);
  expect_at(mesh.position[3], 1, 1, 0);
  expect_at(mesh.position[5], 1, 1, 1);
  ASSERT_EQ(mesh.normal.size(), 4U);
  EXPECT_NEAR(mesh.normal[2][2][1], -1, 1e-6);  // of vertex 5
  ASSERT_EQ(mesh.vertex_groups.size(), 3U);     // the part, and both joints
  // The file's own scene decides what is there.
  g.json["scenes"] = {{{"nodes", {1}}}, {{"nodes", {0, 1}}}};
  EXPECT_THAT(refusal("empty.glb", g.glb()).what(), HasSubstr("no faces"));
}

TEST_F(ImportPose, AMeshOfTwoNodesIsPosedForEach) {
  Gltf g = skinned_strip();
  g.json["nodes"][2]["translation"] = {0, 1.5, 0};
  g.json["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 7}}});
  g.json["scenes"][0]["nodes"] = {0, 1, 3};
  const TriangleMesh mesh = read("a.glb", g.glb());
  ASSERT_EQ(mesh.position.size(), 12U);
  expect_at(mesh.position[5], 1, 2, 7);
  expect_at(mesh.position[11], 1, 2.5, 0);
  expect_at(mesh.position[9], 1, 1.25, 0);
}

TEST_F(ImportPose, FiveJointsToAPointAndWeightsThatAreNotOneInSum) {
  Gltf g = skinned_strip();
  g.json["nodes"][2]["translation"] = {0, 2, 0};
  json& attributes = g.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_1"] = g.add_accessor<uint8_t>(std::vector<uint8_t>(24, 1), 5121, "VEC4", 4);
  attributes["WEIGHTS_1"] =
      g.add_accessor<float>({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5126, "VEC4", 4);
  expect_at(read("a.glb", g.glb()).position[0], 0, 0.5, 0);
  attributes["JOINTS_1"] = g.add_accessor<uint8_t>(std::vector<uint8_t>(24, 2), 5121, "VEC4", 4);
  EXPECT_THAT(refusal("b.glb", g.glb()).what(), HasSubstr("joint 2 of 2"));
  attributes.erase("WEIGHTS_1");
  EXPECT_THAT(refusal("c.glb", g.glb()).what(), HasSubstr("joints without weights"));
}

TEST_F(ImportPose, MorphTargetsWithTheirWeights) {
  Gltf g = skinned_strip();
  g.json["nodes"] = {{{"mesh", 0}}};
  g.json.erase("skins");
  g.json["scenes"][0]["nodes"] = {0};
  const auto up = g.add_accessor<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 2}, 5126, "VEC3", 3);
  g.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  expect_at(read("none.glb", g.glb()).position[5], 1, 2, 0);
  g.json["meshes"][0]["weights"] = {0.5};
  expect_at(read("mesh.glb", g.glb()).position[5], 1, 2, 1);
  g.json["nodes"][0]["weights"] = {0.25};
  expect_at(read("node.glb", g.glb()).position[5], 1, 2, 0.5);
  // Tangents of targets are three numbers, those of the mesh four; exporters write the former without the latter too.
  g.json["meshes"][0]["primitives"][0]["targets"][0]["TANGENT"] = up;
  expect_at(read("tangent.glb", g.glb()).position[5], 1, 2, 0.5);
  g.json["nodes"][0]["weights"] = {0};
  expect_at(read("rest.glb", g.glb()).position[5], 1, 2, 0);
}

TEST_F(ImportPose, SparseAndQuantisedAtOnce) {
  Gltf g = skinned_strip();
  g.json["nodes"][0].erase("skin");
  json& attributes = g.json["meshes"][0]["primitives"][0]["attributes"];
  const auto position = g.add_accessor<int16_t>(
      {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 2, 0, 0, 1, 2, 0, 0}, 5122, "VEC4", 4);
  g.json["accessors"][position]["type"] = "VEC3";
  g.json["bufferViews"][g.json["accessors"][position]["bufferView"].get<std::size_t>()]["byteStride"] = 8;
  std::string index, value;
  put(index, uint16_t{5});
  for (const int16_t v : {int16_t{3}, int16_t{4}, int16_t{-5}}) put(value, v);
  g.json["accessors"][position]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", g.add_view(index)}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", g.add_view(value)}}}};
  attributes["POSITION"] = position;
  g.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const TriangleMesh mesh = read("a.glb", g.glb());
  EXPECT_EQ(mesh.position[4], (Point3{0, 2, 0}));
  EXPECT_EQ(mesh.position[5], (Point3{3, 4, -5}));
}

TEST_F(ImportPose, DamagedSkinsAreReadOrRefused) {
  Gltf g = skinned_strip();
  g.json["nodes"][2]["rotation"] = {0, 0, 0.38268343, 0.92387953};
  survive_damage("damaged.glb", g.glb(), 300);
}

// --- DAE

/// The strip of skinned_strip() as DAE, in centimetres that only the bind shape takes to metres.
const std::string kSkinnedDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="18">0 0 0 100 0 0 0 100 0 100 100 0 0 200 0 100 200 0</float_array>
<technique_common><accessor source="#pa" count="6" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4</vcount><p>0 1 3 2 2 3 5 4</p>
</polylist></mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g">
<bind_shape_matrix>.01 0 0 0  0 .01 0 0  0 0 .01 0  0 0 0 1</bind_shape_matrix>
<source id="j"><Name_array id="ja" count="2">hip knee</Name_array><technique_common>
<accessor source="#ja" count="2"><param name="JOINT" type="name"/></accessor></technique_common></source>
<source id="b"><float_array id="ba" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1  1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1
</float_array><technique_common><accessor source="#ba" count="2" stride="16"><param name="T" type="float4x4"/></accessor>
</technique_common></source>
<source id="w"><float_array id="wa" count="2">1 0.5</float_array><technique_common>
<accessor source="#wa" count="2"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints>
<vertex_weights count="6"><input semantic="JOINT" source="#j" offset="0"/><input semantic="WEIGHT" source="#w" offset="1"/>
<vcount>1 1 2 2 1 1</vcount><v>0 0 0 0 0 1 1 1 0 1 1 1 1 0 1 0</v></vertex_weights>
</skin></controller></library_controllers>
<library_visual_scenes><visual_scene id="s">
<node id="hip" sid="hip" name="hip" type="JOINT"><node id="knee" sid="knee" name="knee" type="JOINT">
<translate>0 1 0</translate><rotate sid="bend">1 0 0 0</rotate></node></node>
<node id="strip" name="strip"><translate>7 0 0</translate><instance_controller url="#c"><skeleton>#hip</skeleton>
</instance_controller></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";

// A garment of 200 m, or beside its wearer, would be of no use; nor one in another pose than its file shows.
TEST_F(ImportPose, ASkinnedDaeStandsWhereItsJointsAre) {
  const TriangleMesh bound = read("a.dae", kSkinnedDae);
  ASSERT_EQ(bound.position.size(), 6U);
  expect_at(bound.position[1], 1, 0, 0);
  expect_at(bound.position[4], 0, 2, 0);

  const TriangleMesh bent = read("bent.dae", replaced(kSkinnedDae, "1 0 0 0</rotate>", "1 0 0 90</rotate>"));
  ASSERT_EQ(bent.position.size(), 6U);
  expect_at(bent.position[1], 1, 0, 0);
  expect_at(bent.position[3], 1, 1, 0);  // held by both joints
  expect_at(bent.position[5], 1, 1, 1);
  EXPECT_EQ(bent.polygon, bound.polygon);
}

// What names no joint of the scene is where its node is, not lost.
TEST_F(ImportPose, ADaeWithoutItsJointsIsPlacedByItsNode) {
  std::string text = kSkinnedDae;
  for (int i = 0; i < 3; ++i) text = replaced(text, "\"hip\"", "\"other\"");
  const TriangleMesh mesh = read("a.dae", text);
  ASSERT_EQ(mesh.position.size(), 6U);
  EXPECT_NEAR(mesh.position[0][0], 7, 1e-5);
}

TEST_F(ImportPose, DamagedSkinsOfDaeNeverCrash) {
  survive_damage("a.dae", kSkinnedDae, 150);
}

}  // namespace
}  // namespace geocloth::test
