// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/import.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "import/import_detail.h"
#include "import_fixture.h"

namespace geocloth {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using Json = nlohmann::json;

using test::Gltf;
using test::put;
using test::replaced;
class Import : public test::ImportTest {};

/// Two triangles over four vertices, moved by (10, 0, 0) by their node.
Gltf square() {
  Gltf g;
  g.json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  const auto position = g.add_accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3", 3);
  g.json["accessors"][position]["min"] = {0, 0, 0};
  g.json["accessors"][position]["max"] = {1, 1, 0};
  const auto uv = g.add_accessor<float>({0, 0.25F, 1, 0.25F, 1, 1, 0, 1}, 5126, "VEC2", 2);
  const auto index = g.add_accessor<uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 1);
  g.json["meshes"] = {
      {{"name", "square"},
       {"primitives", {{{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", index}}}}}};
  g.json["nodes"] = {{{"mesh", 0}, {"translation", {10, 0, 0}}}};
  return g;
}

const std::string kSquareObj =
    "# a square of two parts\n"
    "o top\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n"
    "o bottom\nv 2 0 0\nf 1 3 -3\n";

// --- OBJ

TEST_F(Import, ObjKeepsTheNumbersOfItsVertices) {
  const TriangleMesh mesh = read("a.obj", kSquareObj);
  EXPECT_EQ(mesh.name, "a");
  ASSERT_EQ(mesh.position.size(), 6U);
  EXPECT_EQ(mesh.position[4], (Point3{9, 9, 9}));  // no face uses it
  EXPECT_THAT(mesh.triangle, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  ASSERT_EQ(mesh.part.size(), 2U);
  EXPECT_EQ(mesh.part[0].name, "top");
  EXPECT_EQ(mesh.part[1].first_triangle, 1U);
  ASSERT_EQ(mesh.vertex_groups.size(), 2U);
  EXPECT_EQ(mesh.vertex_groups[1].name, "bottom");
  EXPECT_THAT(mesh.vertex_groups[1].source_vertex, ElementsAre(0, 2, 3));
  ASSERT_EQ(mesh.uv.size(), 2U);
  EXPECT_EQ(mesh.uv[0][2], (Point2{1, 0}));  // v runs down
}

// Painted where it is pinned, in any program that paints vertices.
TEST_F(Import, PaintedVerticesAreGroups) {
  const auto groups = [&](const char* name, const std::string& bytes) {
    std::vector<std::pair<std::string, std::vector<uint32_t>>> found;
    for (const ClothAsset::VertexGroup& group : read(name, bytes).vertex_groups)
      if (group.name.starts_with("color:")) found.emplace_back(group.name, group.source_vertex);
    return found;
  };
  const auto is = [](const char* name, std::vector<uint32_t> vertices) { return Pair(name, std::move(vertices)); };
  const std::string triangles = "f 1 2 3\nf 1 3 4\n";
  EXPECT_THAT(groups("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0.9 0.1 0\nv 1 1 0 0 0 0\nv 0 1 0 0.2 0.7 0.6\n" + triangles),
              ElementsAre(is("color:black", {2}), is("color:red", {0, 1}), is("color:cyan", {3})));
  EXPECT_THAT(groups("b.obj", "v 0 0 0 1 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0 1 0 0 1\n" + triangles),
              ElementsAre(is("color:red", {0}), is("color:white", {1, 2, 3})));
  EXPECT_THAT(groups("c.obj", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\n" + triangles), IsEmpty());
  EXPECT_THAT(groups("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
                     "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 0 255\n0 1 0 250 3 9\n"
                     "3 0 1 2\n"),
              ElementsAre(is("color:red", {0, 2}), is("color:blue", {1})));
  EXPECT_THAT(groups("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 255 255\n0 1 0 250 3 9 255\n3 0 1 2\n"),
              ElementsAre(is("color:red", {0, 2}), is("color:blue", {1})));
  EXPECT_THAT(groups("b.off", "CNOFF\n3 1 0\n0 0 0 0 0 1 1 0 0\n1 0 0 0 0 1 0 0 1\n0 1 0 0 0 1 1 0 0\n3 0 1 2\n"),
              ElementsAre(is("color:red", {0, 2}), is("color:blue", {1})));
  Gltf g = square();
  const auto color = g.add_accessor<float>({1, 1, 1, 0, 0, 0, 0, 1, 0, 1, 1, 1}, 5126, "VEC3", 3);
  g.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = color;
  EXPECT_THAT(groups("a.gltf", g.glb()),
              ElementsAre(is("color:black", {1}), is("color:green", {2}), is("color:white", {0, 3})));
}

// A map of how far the cloth may go from its skin: rounded to eight colours its steps would be seen.
TEST_F(Import, PaintKeepsItsShades) {
  const auto is = [](int r, int g, int b, int a) { return ElementsAre(r, g, b, a); };
  const std::string triangle = "f 1 2 3\n";
  EXPECT_THAT(read("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0.2 -3 0.4\nv 0 1 0 nan 0.5 7\n" + triangle).paint,
              ElementsAre(is(1, 0, 0, 255), is(0, 0, 0, 255), is(255, 1, 7, 255)))
      << "counted to 255, as one vertex shows";
  EXPECT_THAT(read("b.obj", "v 0 0 0\nv 1 0 0 0.2 0 0.4\nv 0 1 0\n" + triangle).paint,
              ElementsAre(is(255, 255, 255, 255), is(51, 0, 102, 255), is(255, 255, 255, 255)));
  EXPECT_THAT(read("c.obj", "v 0 0 0 128 0 51\nv 1 0 0\nv 0 1 0 255 255 0\n" + triangle).paint,
              ElementsAre(is(128, 0, 51, 255), is(255, 255, 255, 255), is(255, 255, 0, 255)));
  EXPECT_THAT(read("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + triangle).paint, IsEmpty());
  Gltf g = square();
  const auto color = g.add_accessor<float>({1, 1, 1, 0.5, 0, 0, 0, 0.25, 0, 0.2, 0, 1, 0, 1, 0.6, 0}, 5126, "VEC4", 4);
  g.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = color;
  EXPECT_THAT(read("a.gltf", g.glb()).paint,
              ElementsAre(is(255, 255, 255, 128), is(0, 0, 0, 64), is(0, 51, 0, 255), is(0, 255, 153, 0)));
}

TEST_F(Import, ObjKeepsDigitsBeyondSinglePrecision) {
  const TriangleMesh mesh = read("a.obj", "v 0.12345678901234 0 0\nv 1 0 0\nv 0 1e-9 1\nf 1 2 3\n");
  EXPECT_EQ(mesh.position[0][0], 0.12345678901234);
  EXPECT_EQ(mesh.position[2][1], 1e-9);
}

TEST_F(Import, ObjWithManyVertices) {
  std::string text;
  for (int i = 0; i < 70000; ++i) text += "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + " 1 0\n";
  text += "f 139999 140000 139998\n";
  const TriangleMesh mesh = read("a.obj", text);
  EXPECT_THAT(mesh.triangle, ElementsAre(Triangle{139998, 139999, 139997}));
}

TEST_F(Import, LinesAreLooseEdges) {
  const std::string faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\n";
  const std::vector<std::array<uint32_t, 2>> some{{0, 4}, {4, 2}, {1, 3}};
  EXPECT_EQ(read("a.obj", faces + "l 1 5/7 3\nf 2 4\n").loose_edge, some);
  EXPECT_EQ(read("a.obj", faces + "l -5 -1 -3 # to the corner\nl 2 4").loose_edge, some);
  EXPECT_EQ(read("a.obj", "l 1 5 3\nl 2 4\n" + faces).loose_edge, some) << "before the vertices";
  EXPECT_THAT(read("a.obj", faces + "l\nl 1\nl 1 99\nl 0 1\nl x 2\nl 3 3\nl 1 99999999999999999999\n").loose_edge,
              IsEmpty())
      << "no lines, and no reason to refuse the faces";

  Gltf g = square();
  Json& primitives = g.json["meshes"][0]["primitives"];
  const auto line = g.add_accessor<float>({0, 0, 0, 0, 0, 1, 1, 1, 0}, 5126, "VEC3", 3);
  primitives.push_back({{"attributes", {{"POSITION", line}}}, {"mode", 3}});
  EXPECT_THAT(read("a.glb", g.glb()).loose_edge, ElementsAre(ElementsAre(4, 5), ElementsAre(5, 6)));
}

TEST_F(Import, ObjLinesPointsAndColoursAreLeftOut) {
  const TriangleMesh mesh = read("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\np 1\nl 1 2\nf 1 2 3\n");
  EXPECT_EQ(mesh.position.size(), 3U);
  EXPECT_EQ(mesh.triangle.size(), 1U);
}

TEST_F(Import, ObjLineEndsContinuationsAndComments) {
  const TriangleMesh mesh = read("a.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\rv 0 1 0 # last\nf 1 2 \\\n 3 4 # quad");
  EXPECT_EQ(mesh.triangle.size(), 2U);
  EXPECT_THAT(mesh.polygon, ElementsAre(0, 0));
}

TEST_F(Import, TextsThatOpenWithAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read("a.obj", mark + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").position.size(), 3U);
  EXPECT_EQ(read("a.ply", mark + "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
                .triangle.size(),
            1U);
}

/// What a shell's redirection and some editors make of a text: told by its name, not by the first broken record.
TEST_F(Import, Utf16IsRefusedWithTheRemedy) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::string little, big;
  for (const char c : obj) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (const std::string& text : {"\xFF\xFE" + little, "\xFE\xFF" + big, little, big}) {
    for (const char* name : {"a.obj", "a.ply", "a.gltf", "a.dae"}) {
      const Error e = refusal(name, text);
      EXPECT_EQ(e.code(), ErrorCode::unsupported);
      EXPECT_THAT(e.what(), HasSubstr("save it as UTF-8"));
    }
  }
}

TEST_F(Import, ObjBadRecordsAreNamedByLine) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(refusal("a.obj", head + "f 1 2 4\n").what(), HasSubstr("line 4"));
  EXPECT_THAT(refusal("a.obj", head + "f 1 2 0\n").what(), HasSubstr("line 4"));
  EXPECT_THAT(refusal("a.obj", head + "f 1 2 -4\n").what(), HasSubstr("line 4"));
  EXPECT_THAT(refusal("a.obj", head + "f 1 2 x\n").what(), HasSubstr("line 4"));
  EXPECT_THAT(refusal("a.obj", head + "f 1/1 2/1 3/1\n").what(), HasSubstr("texture"));
  EXPECT_THAT(refusal("a.obj", head + "v 1 2\nf 1 2 3\n").what(), HasSubstr("line 4"));
  EXPECT_THAT(refusal("a.obj", head).what(), HasSubstr("no faces"));
  EXPECT_THAT(refusal("a.obj", head + "f 1 2 99999999999999999999\n").what(), HasSubstr("line 4"));
}

TEST_F(Import, ObjMaterialWithItsPicture) {
  const std::string png = std::string("\x89PNG\r\n\x1a\n", 8) + "picture";
  write("weave (1).png", png);
  write("a.mtl", "newmtl cotton\nKd 0.5 0.25 1\nd 0.75\nmap_Kd weave (1).png\n");
  const TriangleMesh mesh = read("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl cotton\nf 1 2 3\n");
  ASSERT_EQ(mesh.material.size(), 1U);
  EXPECT_EQ(mesh.material[0].name, "cotton");
  EXPECT_FLOAT_EQ(mesh.material[0].base_color[1], 0.25F);
  EXPECT_FLOAT_EQ(mesh.material[0].base_color[3], 0.75F);
  ASSERT_EQ(mesh.image.size(), 1U);
  EXPECT_EQ(mesh.image[0].mime_type, "image/png");
  EXPECT_EQ(std::string(mesh.image[0].bytes.begin(), mesh.image[0].bytes.end()), png);
  EXPECT_EQ(mesh.material[0].base_color_image, 0U);
}

TEST_F(Import, MissingMaterialOrPictureIsNoError) {
  write("a.mtl", "newmtl cotton\nmap_Kd nothing.png\n");
  const TriangleMesh mesh =
      read("a.obj", "mtllib a.mtl\nmtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl cotton\nf 1 2 3\n");
  EXPECT_TRUE(mesh.image.empty());
  EXPECT_FALSE(mesh.material[0].base_color_image.has_value());
}

// It was asked whether the file is cut off.
TEST_F(Import, DecimalCommasInAnObjAreNamed) {
  const auto comma = AllOf(HasSubstr("line 1"), HasSubstr("'1,5' has a decimal comma"), HasSubstr("decimal points"));
  EXPECT_THAT(refusal("a.obj", "v 1,5 0,25 3\nf 1 1 1\n").what(), comma);
  EXPECT_THAT(refusal("b.obj", "vt 1,5 0\n").what(), comma);
  EXPECT_THAT(refusal("c.obj", "v 1, 2, 3\n").what(), HasSubstr("cut off"));
}

// Whoever converts or pins a shirt by its name means all of it, and not what lies before its second material.
TEST_F(Import, AnObjObjectOfSeveralMaterialsKeepsItsName) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";
  const auto parts = [&](const std::string& text) {
    std::string names;
    for (const auto& part : read("a.obj", head + text).part) names += (names.empty() ? "" : ",") + part.name;
    return names;
  };
  const std::string two = "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red\nf 2 5 6 3\n";
  EXPECT_EQ(parts("o Shirt\n" + two), "Shirt,Shirt,Shirt");
  EXPECT_EQ(parts("o Shirt\n" + two + "g cuff\nf 1 2 4\no Shirt\nf 2 5 3\n"), "Shirt,Shirt,Shirt,cuff,Shirt");
  EXPECT_EQ(parts("g\nf 1 2 3\ng\nf 1 3 4\n"), "default");
  EXPECT_EQ(parts(two), "red,blue,red");
  const TriangleMesh mesh = read("b.obj", head + "o Shirt\n" + two);
  ASSERT_EQ(mesh.vertex_groups.size(), 1U);
  EXPECT_EQ(mesh.vertex_groups[0].name, "Shirt");
  EXPECT_EQ(mesh.vertex_groups[0].source_vertex.size(), 6U);
  EXPECT_EQ(mesh.material[mesh.part[1].material].name, "blue");
}

// Programs that keep indices in 64 bits write them so.
TEST_F(Import, PlyTypesThatAreNoneAreNamedWithTheRemedy) {
  const auto ply = [](const std::string& list) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list " +
           list + " vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  EXPECT_EQ(read("a.ply", ply("uchar uint")).triangle.size(), 1U);
  EXPECT_THAT(refusal("b.ply", ply("uchar uint64")).what(), AllOf(HasSubstr("vertex_indices"), HasSubstr("as uint")));
  EXPECT_THAT(refusal("c.ply", ply("float int")).what(), HasSubstr("whole numbers"));
}

// --- polygons

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangle) {
    const Point3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
    sum += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  return sum;
}

/// All triangles counter-clockwise and of the polygon's area together: no overlap, no gap.
void expect_covers(const TriangleMesh& mesh, double expected) {
  double sum = 0;
  for (const Triangle& t : mesh.triangle) {
    TriangleMesh one = mesh;
    one.triangle = {t};
    EXPECT_GE(area(one), 0);
    sum += std::abs(area(one));
  }
  EXPECT_NEAR(sum, expected, 1e-12);
}

TEST_F(Import, ConcavePolygonsAreCutInside) {
  // An arrow head whose fan from corner 1 would leave the outline, and a comb.
  expect_covers(read("arrow.obj", "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\nf 1 2 3 4\n"), 1);
  expect_covers(read("comb.obj",
                     "v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\n"
                     "v 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6 7 8 9 10 11 12\n"),
                11);
}

TEST_F(Import, PolygonWithABridgeToItsHole) {
  expect_covers(read("ring.obj",
                     "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                     "f 1 2 3 4 1 5 6 7 8 5\n"),
                12);
}

TEST_F(Import, AQuadIsCutTheSameWayFromAnyCorner) {
  const std::vector<Point3> quad{{0, 0, 0}, {1, 0, 0.1}, {1.1, 1, 0}, {0, 1, 0.2}};
  std::set<std::set<std::set<Point3>>> ways;
  for (std::size_t first = 0; first < 4; ++first) {
    std::vector<Point3> turned = quad;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
    std::vector<Triangle> out;
    import_detail::triangulate_polygon(turned, out);
    std::set<std::set<Point3>> way;
    for (const Triangle& t : out) way.insert({turned[t[0]], turned[t[1]], turned[t[2]]});
    ways.insert(way);
  }
  EXPECT_EQ(ways.size(), 1U);
}

TEST_F(Import, ManyCornersAndDegeneratePolygons) {
  std::vector<Point3> circle;
  circle.reserve(2000);
  for (int i = 0; i < 2000; ++i) circle.push_back({std::cos(i * 0.00314159), std::sin(i * 0.00314159), 0});
  std::vector<Triangle> out;
  import_detail::triangulate_polygon(circle, out);
  EXPECT_EQ(out.size(), 1998U);
  out.clear();
  import_detail::triangulate_polygon(std::vector<Point3>(7, Point3{1, 2, 3}), out);
  EXPECT_EQ(out.size(), 5U);
}

// --- glTF

TEST_F(Import, GlbWithNodeTransformAndTextureCoordinates) {
  const TriangleMesh mesh = read("a.glb", square().glb());
  EXPECT_THAT(mesh.triangle, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_EQ(mesh.position[2], (Point3{11, 1, 0}));
  ASSERT_EQ(mesh.uv.size(), 2U);
  EXPECT_NEAR(mesh.uv[0][0][1], 0.25, 1e-7);
  EXPECT_TRUE(mesh.normal.empty());
}

TEST_F(Import, ScaleIsMetresPerUnit) {
  EXPECT_EQ(read("a.glb", square().glb(), {.scale = 0.01}).position[1], (Point3{0.11, 0, 0}));
  EXPECT_THROW(static_cast<void>(read("a.glb", square().glb(), {.scale = 0.0})), Error);
}

TEST_F(Import, GltfUnderTheEndingOfTheOtherKind) {
  Gltf g = square();
  EXPECT_EQ(read("a.gltf", g.glb()).triangle.size(), 2U);
  write("a.bin", g.binary);
  g.json["buffers"] = Json::array({{{"byteLength", g.binary.size()}, {"uri", "a.bin"}}});
  EXPECT_EQ(read("a.glb", g.json.dump()).triangle.size(), 2U);
}

TEST_F(Import, GltfWithFilesAndWithDataUris) {
  Gltf g = square();
  write("a b.bin", g.binary);
  g.json["buffers"] = Json::array({{{"byteLength", g.binary.size()}, {"uri", "a%20b.bin"}}});
  EXPECT_EQ(read("files.gltf", g.json.dump()).triangle.size(), 2U);
  g.json["buffers"][0]["uri"] = "missing.bin";
  EXPECT_THAT(refusal("missing.gltf", g.json.dump()).what(), HasSubstr("missing.bin"));

  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < g.binary.size(); i += 3) {
    uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (i + k < g.binary.size() ? static_cast<unsigned char>(g.binary[i + k]) : 0U);
    }
    for (unsigned shift = 18; shift < 32; shift -= 6) text.push_back(digits[bits >> shift & 63U]);
  }
  for (std::size_t pad = (3 - g.binary.size() % 3) % 3, k = 1; k <= pad; ++k) text[text.size() - k] = '=';
  g.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + text;
  EXPECT_EQ(read("data.gltf", g.json.dump()).triangle.size(), 2U);
  g.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,!!!!";
  EXPECT_THAT(refusal("broken.gltf", g.json.dump()).what(), HasSubstr("base64"));
}

/// A mesh from somewhere must not have other files of this machine read; one that lies beside it is taken by its name,
/// whatever folder the exporting machine had it in.
TEST_F(Import, GltfBuffersOutsideOfItsFolderAreNotOpened) {
  Gltf g = square();
  const std::filesystem::path outside = write("outside.bin", g.binary);
  std::filesystem::create_directories(outside.parent_path() / "garment/buffers");
  write("garment/buffers/inside.bin", g.binary);
  write("garment/beside.bin", g.binary);
  const auto with = [&](const std::string& uri) {
    g.json["buffers"] = Json::array({{{"byteLength", g.binary.size()}, {"uri", uri}}});
    return g.json.dump();
  };
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("%2e%2e/outside.bin"), std::string("buffers/../../outside.bin"),
        std::string("..\\outside.bin"), outside.string(), "file://" + outside.string()}) {
    const Error e = refusal("garment/a.gltf", with(uri));
    EXPECT_EQ(e.code(), ErrorCode::unsupported) << uri;
    EXPECT_THAT(e.what(), AllOf(HasSubstr("buffers[0]"), HasSubstr("outside"), HasSubstr("put it beside"))) << uri;
  }
  for (const char* uri : {"buffers/inside.bin", "buffers/../beside.bin", "../beside.bin", "/export/beside.bin",
                          "C:\\export\\beside.bin"}) {
    EXPECT_EQ(read("garment/a.gltf", with(uri)).triangle.size(), 2U) << uri;
  }
}

TEST_F(Import, GlbTwoPrimitivesTwoNodesAndASkin) {
  Gltf g = square();
  Json& primitives = g.json["meshes"][0]["primitives"];
  const auto strip = g.add_accessor<float>({0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1}, 5126, "VEC3", 3);
  const auto joints = g.add_accessor<uint8_t>(std::vector<uint8_t>(16, 0), 5121, "VEC4", 4);
  const auto weights = g.add_accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 5126, "VEC4", 4);
  primitives.push_back(
      {{"attributes", {{"POSITION", strip}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}, {"mode", 5}});
  const auto inverse = g.add_accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 5126, "MAT4", 16);
  g.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", inverse}}};
  g.json["nodes"] = {{{"mesh", 0}, {"translation", {10, 0, 0}}, {"skin", 0}}, {{"name", "arm"}}};
  g.json["scenes"][0]["nodes"] = {0, 1};
  const TriangleMesh mesh = read("a.glb", g.glb());
  EXPECT_EQ(mesh.position.size(), 8U);
  ASSERT_EQ(mesh.part.size(), 2U);
  EXPECT_EQ(mesh.triangle.size(), 4U);
  EXPECT_THAT(mesh.triangle[2], ElementsAre(4, 5, 6));
  ASSERT_FALSE(mesh.vertex_groups.empty());
  EXPECT_EQ(mesh.vertex_groups.back().name, "arm");
  EXPECT_THAT(mesh.vertex_groups.back().source_vertex, ElementsAre(4, 5, 6, 7));
  g.json["skins"][0].erase("inverseBindMatrices");
  EXPECT_EQ(read("a.glb", g.glb()).position.size(), 8U);
}

TEST_F(Import, QuantisedGltf) {
  Gltf g = square();
  const auto position =
      g.add_accessor<int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 32767, 32767, 0, 0, 0, 32767, 0, 0}, 5122, "VEC4", 4);
  g.json["accessors"][position]["type"] = "VEC3";
  g.json["accessors"][position]["normalized"] = true;
  g.json["bufferViews"][g.json["accessors"][position]["bufferView"].get<std::size_t>()]["byteStride"] = 8;
  g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = position;
  g.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(read("a.glb", g.glb()).position[2], (Point3{11, 1, 0}));
}

TEST_F(Import, AMirroringNodeKeepsTheOutsideOut) {
  Gltf g = square();
  g.json["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_GT(area(read("a.glb", g.glb())), 0);
}

TEST_F(Import, EmbeddedPictureIsKeptByteForByte) {
  Gltf g = square();
  const std::string jpeg = "\xFF\xD8\xFF\xE0 some picture";
  g.json["images"] = {{{"bufferView", g.add_view(jpeg)}, {"mimeType", "image/jpeg"}}};
  g.json["textures"] = {{{"source", 0}}};
  g.json["materials"] = {{{"name", "denim"},
                          {"alphaMode", "MASK"},
                          {"alphaCutoff", 0.25},
                          {"pbrMetallicRoughness",
                           {{"baseColorFactor", {0.5, 0.5, 1, 1}},
                            {"metallicFactor", 0.5},
                            {"roughnessFactor", 0.75},
                            {"baseColorTexture", {{"index", 0}}}}}}};
  g.json["meshes"][0]["primitives"][0]["material"] = 0;
  const TriangleMesh mesh = read("a.glb", g.glb());
  ASSERT_EQ(mesh.material.size(), 1U);
  EXPECT_EQ(mesh.material[0].name, "denim");
  EXPECT_TRUE(mesh.material[0].alpha_mask);
  EXPECT_FLOAT_EQ(mesh.material[0].alpha_cutoff, 0.25F);
  EXPECT_FLOAT_EQ(mesh.material[0].metallic, 0.5F);
  EXPECT_FLOAT_EQ(mesh.material[0].roughness, 0.75F);
  ASSERT_EQ(mesh.image.size(), 1U);
  EXPECT_EQ(mesh.image[0].mime_type, "image/jpeg");
  EXPECT_EQ(std::string(mesh.image[0].bytes.begin(), mesh.image[0].bytes.end()), jpeg);
}

TEST_F(Import, GltfThatNeedsWhatCannotBeDecodedIsRefusedWithTheRemedy) {
  Gltf g = square();
  g.json["extensionsRequired"] = {"KHR_meshopt_compression"};
  const Error e = refusal("a.glb", g.glb());
  EXPECT_EQ(e.code(), ErrorCode::unsupported);
  EXPECT_THAT(e.what(), HasSubstr("KHR_meshopt_compression"));
  EXPECT_THAT(e.what(), HasSubstr("gltf-transform"));
}

// Forty buttons of which one arrived, or a garment in a scene that is not the first, were dropped without a word.
TEST_F(Import, GltfSaysWhatOfItIsLeftOut) {
  EXPECT_THAT(read("a.glb", square().glb()).left_out, testing::IsEmpty());

  Gltf buttons = square();
  buttons.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  buttons.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = Json::object();
  const TriangleMesh one = read("b.glb", buttons.glb());
  EXPECT_EQ(one.triangle.size(), 2U);
  EXPECT_THAT(one.left_out, ElementsAre(HasSubstr("1 node stands for many copies")));

  Gltf scenes = square();
  scenes.json["nodes"] = {{{"children", {1}}}, {{"mesh", 0}}, {{"mesh", 0}}, {{"mesh", 0}}};
  scenes.json["scenes"] = {{{"nodes", {2, 3}}}, {{"nodes", {0}}}};
  scenes.json["scene"] = 1;
  const TriangleMesh shown = read("c.glb", scenes.glb());
  EXPECT_EQ(shown.triangle.size(), 2U);
  EXPECT_THAT(shown.left_out, ElementsAre(HasSubstr("2 meshes of the file are left out")));
}

TEST_F(Import, GltfWithoutASceneIsReadWhole) {
  Gltf g = square();
  g.json.erase("scene");
  g.json.erase("scenes");
  g.json["nodes"] = {{{"children", {1}}}, {{"mesh", 0}}, {{"mesh", 0}, {"translation", {10, 0, 0}}}};
  EXPECT_EQ(read("a.glb", g.glb()).triangle.size(), 4U);
}

/// Ways to break a sound glTF file, and a word of the message.
struct Break {
  const char* word;
  std::function<void(Gltf&)> apply;
};

TEST_F(Import, BrokenGltfIsRefused) {
  const std::vector<Break> breaks{
      {"index 9", [](Gltf& g) { g.binary[g.binary.size() - 2] = 9; }},
      {"beyond", [](Gltf& g) { g.json["accessors"][0]["count"] = 5; }},
      {"100 million", [](Gltf& g) { g.json["accessors"][0]["count"] = 4000000000; }},
      {"beyond", [](Gltf& g) { g.json["bufferViews"][0]["byteLength"] = 1 << 30; }},
      {"range", [](Gltf& g) { g.json["bufferViews"][0]["byteOffset"] = -4; }},
      {"only 1 meshes", [](Gltf& g) { g.json["nodes"][0]["mesh"] = 1; }},
      {"circle", [](Gltf& g) { g.json["nodes"][0]["children"] = {0}; }},
      {"two parents",
       [](Gltf& g) {
         g.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
       }},
      {"POSITION", [](Gltf& g) { g.json["meshes"][0]["primitives"][0]["attributes"].erase("POSITION"); }},
      {"differ in count", [](Gltf& g) { g.json["accessors"][1]["count"] = 3; }},
      {"unknown type", [](Gltf& g) { g.json["accessors"][0]["type"] = "VEC9"; }},
      {"matrix",
       [](Gltf& g) {
         g.json["nodes"][0]["matrix"] = {1, 2, 3};
       }},
      {"version", [](Gltf& g) { g.json["asset"]["version"] = "1.0"; }},
      {"not an array", [](Gltf& g) { g.json["meshes"] = 3; }},
      {"finite",
       [](Gltf& g) {
         const float nan = NAN;
         std::memcpy(g.binary.data(), &nan, 4);
       }},
      {"1e18",
       [](Gltf& g) {
         const float huge = 1e30F;
         std::memcpy(g.binary.data(), &huge, 4);
       }},
      {"no faces", [](Gltf& g) { g.json["meshes"][0]["primitives"][0]["mode"] = 0; }},
  };
  for (const Break& b : breaks) {
    Gltf g = square();
    b.apply(g);
    EXPECT_THAT(refusal("a.glb", g.glb()).what(), HasSubstr(b.word));
  }
}

// Said was that 'accessors' is not an array, which tells nobody what to do.
TEST_F(Import, GltfOfVersion1IsNamedWithTheRemedy) {
  const Error error = refusal("a.gltf", R"({"asset": {"version": "1.0"}, "accessors": {"a": {}}, "meshes": {}})");
  EXPECT_EQ(error.code(), ErrorCode::unsupported);
  EXPECT_THAT(error.what(), AllOf(HasSubstr("version '1.0'"), HasSubstr("export it as glTF 2.0")));
}

TEST_F(Import, DeeplyNestedJsonIsRefused) {
  const std::string deep =
      "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[') + std::string(100000, ']') + "}";
  EXPECT_THAT(refusal("a.gltf", deep).what(), HasSubstr("nested"));
}

// --- PLY, STL, OFF

std::string binary_ply(bool big) {
  std::string out = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const auto add = [&](auto value) {
    std::string bytes;
    put(bytes, value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  for (const float c : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 1.0F, 1.0F, 0.0F, 0.0F, 1.0F, 0.0F}) add(c);
  out.push_back(4);
  for (const int i : {0, 1, 2, 3}) add(i);
  return out;
}

const std::string kTextPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

/// A polygon of four corners.
void expect_one_square(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.position.size(), 4U);
  EXPECT_EQ(mesh.position[2], (Point3{1, 1, 0}));
  EXPECT_THAT(mesh.polygon, ElementsAre(0, 0));
  expect_covers(mesh, 1);
}

TEST_F(Import, Ply) {
  for (const std::string& bytes : {kTextPly, binary_ply(false), binary_ply(true)}) {
    expect_one_square(read("a.ply", bytes));
  }
}

/// A square whose elements of a camera, of tags and of a material stand before its vertices or between them and faces.
std::string ply_of_more_elements(bool binary, bool before, bool faces_first = false) {
  struct Element {
    std::string header, text, bytes;
  };
  const auto bytes = [](auto... value) {
    std::string out;
    (put(out, value), ...);
    return out;
  };
  const Element vertices{"element vertex 4\nproperty float x\nproperty float y\nproperty float z\n",
                         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n",
                         bytes(0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F)};
  const Element faces{"element face 1\nproperty list uchar int vertex_indices\n", "4 0 1 2 3\n",
                      bytes(uint8_t{4}, 0, 1, 2, 3)};
  const Element more{
      "element camera 1\nproperty float a\nproperty uchar b\nelement tags 2\n"
      "property list uchar int k\nelement material 1\nproperty int r\n",
      "5 6\n2 1 2\n1 7\n9\n", bytes(5.F, uint8_t{6}, uint8_t{2}, 1, 2, uint8_t{1}, 7, 9)};
  std::string header = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") + " 1.0\n", records;
  std::vector<Element> order{vertices, faces};
  if (faces_first) std::swap(order[0], order[1]);
  order.insert(order.begin() + (before ? 0 : 1), more);
  for (const Element& e : order) {
    header += e.header;
    records += binary ? e.bytes : e.text;
  }
  return header + "end_header\n" + records;
}

// A camera before the vertices was taken for a vertex, and a triangle was lost without a word.
TEST_F(Import, PlyElementsOfAnyNameMayStandBeforeVerticesAndFaces) {
  for (const bool binary : {false, true}) {
    for (const bool before : {false, true}) {
      for (const bool faces_first : {false, true}) {
        SCOPED_TRACE(testing::Message() << binary << before << faces_first);
        expect_one_square(read("a.ply", ply_of_more_elements(binary, before, faces_first)));
      }
    }
  }
}

// The format allows it, and the properties after the comment were lost.
TEST_F(Import, PlyCommentsMayStandBetweenProperties) {
  expect_one_square(read("a.ply", replaced(kTextPly, "property float y", "comment the height\nproperty float y")));
  expect_one_square(read("b.ply", replaced(kTextPly, "property list", "obj_info corners\nproperty list")));
}

// assimp makes room for the first of them and writes all.
TEST_F(Import, PlyOfTwoVertexElementsIsRefused) {
  const std::string more = "element vertex 4\nproperty float x\nelement face";
  EXPECT_THAT(refusal("a.ply", replaced(kTextPly, "element face", more)).what(),
              HasSubstr("more than one element 'vertex'"));
}

/// Strips over 2 x 1 squares, in the second with a restart and a stitch of equal corners; one face beside them.
std::string strips_ply(const std::string& format, const std::string& type,
                       const std::vector<std::vector<int>>& strips) {
  const bool text = format == "ascii", big = format == "binary_big_endian";
  std::string out = "ply\nformat " + format + " 1.0\nelement vertex 6\nproperty float x\nproperty float y\n" +
                    "property float z\nelement tristrips " + std::to_string(strips.size()) + "\nproperty list int " +
                    type + " vertex_indices\nend_header\n";
  const auto add = [&](auto value) {
    std::string bytes;
    put(bytes, value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    out += text ? std::to_string(value) + " " : bytes;
  };
  const auto end_line = [&] { out += text ? "\n" : ""; };
  for (const float x : {0.F, 1.F, 2.F}) {
    for (const float y : {0.F, 1.F}) {
      for (const float c : {x, y, 0.F}) add(c);
      end_line();
    }
  }
  for (const auto& strip : strips) {
    add(static_cast<int>(strip.size()));
    for (const int c : strip) type == "uchar" ? add(static_cast<uint8_t>(c)) : add(c);
    end_line();
  }
  return out;
}

/// Of each triangle, turned so that its least corner is first.
std::vector<std::array<int, 3>> turned_triangles(const TriangleMesh& mesh) {
  std::vector<std::array<int, 3>> out;
  for (const Triangle& t : mesh.triangle) {
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Point3& p = mesh.position[t[k]];
      corners[k] = static_cast<int>(2 * p[0] + p[1]);
    }
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    out.push_back(corners);
  }
  return out;
}

// Of the strips that scans and VTK write only the first triangle was kept, and those with a restart were refused.
TEST_F(Import, PlyStripsAreReadWhole) {
  const std::vector<std::vector<std::vector<int>>> files{{{0, 1, 2, 3, 4, 5}},
                                                         {{0, 1, 2, 3, -1, 2, 3, 4, 5, -1}},
                                                         {{0, 1, 2, 3}, {2, 3, 4, 5}},
                                                         {{0, 1, 2, 3, 3, 2, 2, 3, 4, 5}}};
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (const std::string type : {"int", "uchar"}) {
      for (std::size_t i = 0; i < files.size(); ++i) {
        if (format == "ascii" && type == "uchar" && i == 1) continue;  // 255 is no restart in a text
        SCOPED_TRACE(format + " " + type + " " + std::to_string(i));
        EXPECT_THAT(
            turned_triangles(read("a.ply", strips_ply(format, type, files[i]))),
            ElementsAre(ElementsAre(0, 1, 2), ElementsAre(1, 3, 2), ElementsAre(2, 3, 4), ElementsAre(3, 5, 4)));
      }
    }
  }
  const std::string beside = replaced(replaced(strips_ply("ascii", "int", {{0, 1, 2}}), "element tristrips",
                                               "element face 1\nproperty uchar flags\nproperty list uchar int "
                                               "vertex_indices\nelement tristrips"),
                                      "3 0 1 2", "7 4 2 3 5 4\n3 0 1 2");
  const TriangleMesh mesh = read("b.ply", beside);
  EXPECT_EQ(mesh.triangle.size(), 3U);
  EXPECT_THAT(refusal("c.ply", strips_ply("ascii", "int", {{0, 1, 6}})).what(), HasSubstr("vertex 6 of 6"));
  EXPECT_THAT(refusal("d.ply", strips_ply("ascii", "int", {{0, 1, -2}})).what(), HasSubstr("broken corner"));
}

TEST_F(Import, PlyThatLiesAboutItsSize) {
  std::string bytes = binary_ply(false);
  bytes.replace(bytes.find("vertex 4"), 8, "vertex 9");
  EXPECT_THAT(refusal("a.ply", bytes).what(), HasSubstr("cut off"));
  bytes = kTextPly;
  bytes.replace(bytes.find("vertex 4"), 8, "vertex 4000000000");
  EXPECT_EQ(refusal("a.ply", bytes).code(), ErrorCode::limit);
  bytes = kTextPly;
  bytes.replace(bytes.find("0 1 2 3"), 7, "0 1 2 4");
  EXPECT_THAT(refusal("a.ply", bytes).what(), HasSubstr("vertex 4 of 4"));
}

std::string binary_stl() {
  std::string out(80, ' ');
  put(out, uint32_t{2});
  const std::vector<std::array<float, 9>> facets{{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 1, 0}};
  for (const auto& facet : facets) {
    for (const float n : {0.0F, 0.0F, 1.0F}) put(out, n);
    for (const float c : facet) put(out, c);
    put(out, uint16_t{0});
  }
  return out;
}

const std::string kTextStl =
    "solid square\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid square\n";

TEST_F(Import, Stl) {
  for (const std::string& bytes : {binary_stl(), kTextStl}) {
    const TriangleMesh mesh = read("a.stl", bytes);
    EXPECT_EQ(mesh.position.size(), 6U);
    EXPECT_EQ(mesh.triangle.size(), 2U);
    expect_covers(mesh, 1);
  }
}

TEST_F(Import, StlOfOtherPrograms) {
  std::string capitals = kTextStl;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& bytes : {capitals, binary_stl() + std::string(2, '\0'), binary_stl() + "\r\n"}) {
    expect_covers(read("a.stl", bytes), 1);
  }
  EXPECT_THAT(refusal("a.stl", binary_stl() + binary_stl()).what(), HasSubstr("longer than its header says"));
}

const std::string kOff = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

TEST_F(Import, OffOfManyPrograms) {
  for (const std::string& bytes :
       {kOff,
        // comments, blanks, line ends of other systems, no number of edges, colors of faces, what comes after the faces
        std::string("# made by hand\r\nOFF # geomview\r\n\r\n4 1\r\n0 0 0 # a\r\n1 0 0\r\n\r\n1 1 0\r\n+0 1e0 0\r\n"
                    "4  0 1 2 3  0.5 0.5 0.5 1\r\n3 0 1 9\r\n"),
        std::string("OFF 4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3"),
        std::string("OFF4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"),
        std::string("NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n")}) {
    SCOPED_TRACE(bytes);
    expect_one_square(read("a.off", bytes));
  }
}

TEST_F(Import, OffThatIsBrokenIsRefusedByItsLine) {
  const auto what = [&](const std::string& old, const std::string& now) {
    std::string bytes = kOff;
    return std::string(refusal("a.off", bytes.replace(bytes.find(old), old.size(), now)).what());
  };
  EXPECT_THAT(what("4 1 0", "5 1 0"), HasSubstr("5 of 5 vertices, 0 of 1 faces"));  // the face is read as one
  EXPECT_THAT(what("4 1 0", "4 2 0"), HasSubstr("4 of 4 vertices, 1 of 2 faces"));
  EXPECT_THAT(what("4 1 0", "4000000000 1 0"), HasSubstr("100 million"));
  EXPECT_THAT(what("4 1 0", "-4 1 0"), HasSubstr("line 2: the header"));
  EXPECT_THAT(what("1 1 0", "1 1"), HasSubstr("line 5: a vertex"));
  EXPECT_THAT(what("1 1 0", "1 1 up"), HasSubstr("line 5: a vertex"));
  EXPECT_THAT(what("1 1 0", "1 1 0\\"), HasSubstr("line 5: a number"));
  EXPECT_THAT(what("1 1 0", "1 1 nan"), HasSubstr("vertex 2"));
  EXPECT_THAT(what("0 1 2 3", "0 1 2 4"), HasSubstr("line 7: a face uses vertex '4' of 4"));
  EXPECT_THAT(what("4 0 1 2 3", "5 0 1 2 3"), HasSubstr("line 7: a face needs"));
  EXPECT_THAT(what("OFF", "4OFF"), HasSubstr("four coordinates"));
  EXPECT_THAT(what("OFF", "OFF BINARY"), HasSubstr("binary OFF"));
  EXPECT_THAT(what("OFF", "off"), HasSubstr("no OFF file"));
}

// --- DAE, FBX

/// The square in inches, z up: two triangles in the x-z plane of the result.
const std::string kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 1 1 0 0 1 0</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="a"><translate>10 0 0</translate>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";

TEST_F(Import, DaeInItsUnitWithItsUpAxis) {
  const TriangleMesh mesh = read("a.dae", kDae);
  ASSERT_EQ(mesh.position.size(), 4U);
  EXPECT_THAT(mesh.polygon, ElementsAre(0, 0));
  EXPECT_NEAR(mesh.position[2][0], 11 * 0.0254, 1e-6);
  EXPECT_NEAR(mesh.position[2][1], 0, 1e-6);
  EXPECT_NEAR(mesh.position[2][2], -0.0254, 1e-6);
  EXPECT_NEAR(read("a.dae", kDae, {.scale = 2.0}).position[2][0], 22, 1e-5);
}

// As exporters on machines with a decimal comma write it, and as people line numbers up.
TEST_F(Import, DaeWithACommaInItsUnitAndBlanksAroundItsNumbers) {
  const TriangleMesh plain = read("a.dae", kDae);
  EXPECT_EQ(read("b.dae", replaced(kDae, "0.0254", "0,025400")).position, plain.position);
  const std::string material = R"(<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse>
    <color>  0.5 0.5 0.5 1.0  </color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>)";
  EXPECT_EQ(read("c.dae", replaced(kDae, "<library_geometries>", material + "<library_geometries>")).position,
            plain.position);
  EXPECT_THAT(refusal("d.dae", replaced(kDae, "0.0254", "0,0,254")).what(), HasSubstr("unit"));
}

// assimp ends the program over these where it is built as Debian builds it.
TEST_F(Import, DaeThatCountsItsPolygonsWrongly) {
  const TriangleMesh plain = read("a.dae", kDae);
  for (const std::string count : {"0", "2", "7"}) {
    const TriangleMesh mesh = read("b.dae", replaced(kDae, "polylist count=\"1\"", "polylist count=\"" + count + "\""));
    EXPECT_EQ(mesh.position, plain.position);
    EXPECT_EQ(mesh.triangle, plain.triangle);
  }
  EXPECT_THAT(refusal("c.dae", replaced(kDae, "<p>0 1 2 3</p>", "")).what(), HasSubstr("no faces"));
  EXPECT_THAT(refusal("d.dae", replaced(kDae, "<p>0 1 2 3</p>", "<p>0 1 2 3</p><p>0 1 2 3</p>")).what(),
              HasSubstr("more than one <p>"));
}

TEST_F(Import, BrokenDaeIsRefused) {
  expect_truncations_refused("a.dae", kDae, 1);
  const auto message = [&](const std::string& what, const std::string& by) {
    return std::string(refusal("a.dae", replaced(kDae, what, by)).what());
  };
  EXPECT_THAT(message(R"(count="12")", R"(count="99999999999")"), HasSubstr("count"));
  EXPECT_THAT(message(R"(stride="3")", R"(stride="300")"), HasSubstr("accessor"));
  EXPECT_THAT(message("0 1 2 3<", "0 1 x 3<"), HasSubstr("integer"));
  EXPECT_THAT(message("<instance_geometry", R"(<instance_node url="#a"/><instance_geometry)"), HasSubstr("circle"));
  EXPECT_THAT(message("0 1 2 3<", "0 1 2 4<"), HasSubstr("a.dae"));
}

// Forty library nodes, each twice the one before.
TEST_F(Import, DaeThatUnfoldsWithoutEnd) {
  std::string nodes = R"(<library_nodes><node id="n0"><instance_geometry url="#g"/></node>)";
  for (int i = 1; i <= 40; ++i) {
    const std::string below = R"(<instance_node url="#n)" + std::to_string(i - 1) + R"("/>)";
    nodes.append(R"(<node id="n)").append(std::to_string(i)).append(R"(">)").append(below).append(below);
    nodes.append("</node>");
  }
  nodes.append("</library_nodes><library_visual");
  const std::string bytes = replaced(replaced(kDae, R"(<instance_geometry url="#g"/></node></visual)",
                                              R"(<instance_node url="#n40"/></node></visual)"),
                                     "<library_visual", nodes);
  EXPECT_THAT(refusal("a.dae", bytes).what(), HasSubstr("unfold"));
}

const std::string kFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
  FBXHeaderVersion: 1003
  FBXVersion: 7400
}
GlobalSettings:  {
  Version: 1000
  Properties70:  {
    P: "UpAxis", "int", "Integer", "",1
    P: "UpAxisSign", "int", "Integer", "",1
    P: "FrontAxis", "int", "Integer", "",2
    P: "FrontAxisSign", "int", "Integer", "",1
    P: "CoordAxis", "int", "Integer", "",0
    P: "CoordAxisSign", "int", "Integer", "",1
    P: "UnitScaleFactor", "double", "Number", "",2.5
  }
}
Objects:  {
  Geometry: 1000, "Geometry::square", "Mesh" {
    Vertices: *12 {
      a: 0,0,0,1,0,0,1,1,0,0,1,0
    }
    PolygonVertexIndex: *4 {
      a: 0,1,2,-4
    }
    GeometryVersion: 124
  }
  Model: 2000, "Model::square", "Mesh" {
    Version: 232
    Properties70:  {
      P: "Lcl Translation", "Lcl Translation", "", "A",10,0,0
    }
  }
}
Connections:  {
  C: "OO",2000,0
  C: "OO",1000,2000
}
)";

TEST_F(Import, FbxInItsUnit) {
  const TriangleMesh mesh = read("a.fbx", kFbx);
  ASSERT_EQ(mesh.position.size(), 4U);
  EXPECT_THAT(mesh.polygon, ElementsAre(0, 0));
  EXPECT_NEAR(mesh.position[2][0], 11 * 0.025, 1e-6);
  EXPECT_NEAR(mesh.position[2][1], 0.025, 1e-6);
  EXPECT_NEAR(read("a.fbx", kFbx, {.scale = 1.0}).position[2][0], 11, 1e-6);
}

TEST_F(Import, FbxPolygonsOfTwoCornersAreLooseEdges) {
  std::string text = replaced(kFbx, "Vertices: *12 {\n      a: ", "Vertices: *15 {\n      a: 5,5,5,");
  text =
      replaced(text, "PolygonVertexIndex: *4 {\n      a: 0,1,2,-4", "PolygonVertexIndex: *6 {\n      a: 1,2,3,-5,0,-3");
  EXPECT_THAT(read("a.fbx", text).loose_edge, ElementsAre(ElementsAre(0, 2)));
}

TEST_F(Import, FbxWithZUp) {
  std::string text = replaced(kFbx, R"("UpAxis", "int", "Integer", "",1)", R"("UpAxis", "int", "Integer", "",2)");
  text = replaced(text, R"("FrontAxis", "int", "Integer", "",2)", R"("FrontAxis", "int", "Integer", "",1)");
  text = replaced(text, R"("FrontAxisSign", "int", "Integer", "",1)", R"("FrontAxisSign", "int", "Integer", "",-1)");
  const TriangleMesh mesh = read("a.fbx", text, {.scale = 1.0});
  EXPECT_NEAR(mesh.position[2][0], 11, 1e-6);
  EXPECT_NEAR(mesh.position[2][1], 0, 1e-6);
  EXPECT_NEAR(mesh.position[2][2], -1, 1e-6);
}

TEST_F(Import, FbxWithACircleOfConnections) {
  const std::string more = "C: \"OO\",2000,0\n  C: \"OO\",2000,1000";
  EXPECT_THAT(refusal("a.fbx", replaced(kFbx, R"(C: "OO",2000,0)", more)).what(), HasSubstr("circle"));
}

using FbxRecord = std::function<std::string(std::size_t)>;

/// One record of the binary form that begins at byte `at`: name, values already encoded, records inside.
std::string fbx_record(std::size_t at, const std::string& name, uint32_t count, const std::string& values,
                       const std::vector<FbxRecord>& inside = {}) {
  std::string body = values;
  const std::size_t head = 13 + name.size();
  for (const auto& make : inside) body += make(at + head + body.size());
  if (!inside.empty()) body.append(13, '\0');
  std::string out;
  put(out, static_cast<uint32_t>(at + head + body.size()));
  put(out, count);
  put(out, static_cast<uint32_t>(values.size()));
  out.push_back(static_cast<char>(name.size()));
  return out + name + body;
}

std::string fbx_text(const std::string& text) {
  std::string out = "S";
  put(out, static_cast<uint32_t>(text.size()));
  return out + text;
}

std::string fbx_id(int64_t id) {
  std::string out = "L";
  put(out, id);
  return out;
}

template <typename T>
std::string fbx_array(char type, const std::vector<T>& values) {
  std::string out(1, type);
  put(out, static_cast<uint32_t>(values.size()));
  put(out, uint32_t{0});
  put(out, static_cast<uint32_t>(values.size() * sizeof(T)));
  for (const T v : values) put(out, v);
  return out;
}

std::string binary_fbx() {
  std::string out("Kaydara FBX Binary  \0\x1a\0", 23);
  put(out, uint32_t{7400});
  const auto leaf = [](const std::string& name, uint32_t count, const std::string& values) -> FbxRecord {
    return [=](std::size_t at) { return fbx_record(at, name, count, values); };
  };
  const std::string zero_one("\0\x01", 2), version("I\xe8\x1c\0\0", 5);
  out += fbx_record(out.size(), "FBXHeaderExtension", 0, "", {leaf("FBXVersion", 1, version)});
  const auto geometry = [&](std::size_t at) {
    return fbx_record(at, "Geometry", 3, fbx_id(1000) + fbx_text("square" + zero_one + "Geometry") + fbx_text("Mesh"),
                      {leaf("Vertices", 1, fbx_array<double>('d', {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})),
                       leaf("PolygonVertexIndex", 1, fbx_array<int32_t>('i', {2, 3, 0, -2}))});
  };
  const auto model = [&](std::size_t at) {
    return fbx_record(at, "Model", 3, fbx_id(2000) + fbx_text("square" + zero_one + "Model") + fbx_text("Mesh"),
                      {leaf("Version", 1, version)});
  };
  out += fbx_record(out.size(), "Objects", 0, "", {geometry, model});
  out += fbx_record(out.size(), "Connections", 0, "",
                    {leaf("C", 3, fbx_text("OO") + fbx_id(2000) + fbx_id(0)),
                     leaf("C", 3, fbx_text("OO") + fbx_id(1000) + fbx_id(2000))});
  return out + std::string(13 + 64, '\0');
}

TEST_F(Import, BinaryFbx) {
  const std::string bytes = binary_fbx();
  const TriangleMesh mesh = read("a.fbx", bytes);
  EXPECT_EQ(mesh.position,
            (std::vector<Point3>{{0, 0, 0}, {.01, 0, 0}, {.01, .01, 0}, {0, .01, 0}}));  // as the file has them
  EXPECT_EQ(mesh.triangle.size(), 2U);
  expect_truncations_refused("a.fbx", bytes, 64);
  survive_damage("a.fbx", bytes, 150);
}

// --- what is no mesh

TEST_F(Import, MissingFileFolderAndUnknownEnding) {
  const auto code_of = [](const std::filesystem::path& path) {
    try {
      static_cast<void>(import_mesh(path));
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(path.filename().string()));
      return e.code();
    }
    return ErrorCode::cancelled;
  };
  EXPECT_EQ(code_of(folder_ / "missing.obj"), ErrorCode::io);
  std::filesystem::create_directory(folder_ / "folder.glb");
  EXPECT_EQ(code_of(folder_ / "folder.glb"), ErrorCode::io);
  EXPECT_EQ(code_of(write("a.usd", "x")), ErrorCode::unsupported);
  EXPECT_EQ(code_of(write("noending", "x")), ErrorCode::unsupported);
}

TEST_F(Import, RubbishUnderEveryEnding) {
  for (const std::string ending : {"obj", "gltf", "glb", "ply", "stl", "off", "fbx", "dae"}) {
    for (const std::string& bytes :
         {std::string(), std::string("\0", 1), std::string(4096, '\0'), std::string("hello, this is no mesh\n"),
          std::string("{}"), std::string("[1,2,3]"), std::string("<xml/>"), std::string(100000, '('),
          std::string("solid"), std::string("ply\n"), std::string("glTF"), std::string("Kaydara FBX Binary  \0", 21)}) {
      static_cast<void>(refusal("a." + ending, bytes));
    }
  }
}

// A bone of a skirt named as the skirt had its points added to the skirt's: pins and caches of the one had the other's.
TEST_F(Import, ABoneNamedAsAnObjectIsAGroupOfItsOwn) {
  Gltf g = test::skinned_strip();
  g.json["nodes"][2]["name"] = "strip";
  std::map<std::string, std::size_t> count;
  for (const ClothAsset::VertexGroup& group : read("a.glb", g.glb()).vertex_groups)
    count[group.name] = group.source_vertex.size();
  EXPECT_EQ(count, (std::map<std::string, std::size_t>{{"strip", 6}, {"hip", 4}, {"bone:strip", 4}}));
}

TEST_F(Import, TruncatedFilesAreRefused) {
  expect_truncations_refused("a.glb", square().glb());
  expect_truncations_refused("a.ply", binary_ply(true));
  expect_truncations_refused("a.ply", kTextPly, 1);
  expect_truncations_refused("a.ply", strips_ply("binary_big_endian", "int", {{0, 1, 2, 3, -1, 2, 3, 4, 5}}));
  expect_truncations_refused("a.ply", ply_of_more_elements(true, true));
  expect_truncations_refused("a.off", kOff, std::string(" 3\n").size());
  expect_truncations_refused("a.stl", binary_stl());
  expect_truncations_refused("a.stl", kTextStl, std::string(" square\n").size());
}

TEST_F(Import, ATruncatedObjIsAMeshOrRefused) {
  for (std::size_t n = 0; n < kSquareObj.size(); ++n) {
    try {
      EXPECT_LE(read("a.obj", kSquareObj.substr(0, n)).triangle.size(), 2U);
    } catch (const Error&) {
    }
  }
}

TEST_F(Import, SurvivesDamage) {
  survive_damage("a.glb", square().glb(), 250);
  survive_damage("a.ply", binary_ply(false), 150);
  survive_damage("a.ply", kTextPly, 150);
  survive_damage("a.ply", strips_ply("binary_little_endian", "int", {{0, 1, 2, 3, -1, 2, 3, 4, 5}}), 150);
  survive_damage("a.ply", strips_ply("ascii", "int", {{0, 1, 2, 3, -1, 2, 3, 4, 5}}), 150);
  survive_damage("a.ply", ply_of_more_elements(true, true), 150);
  survive_damage("a.ply", ply_of_more_elements(false, true), 150);
  survive_damage("a.stl", binary_stl(), 200);
  survive_damage("a.stl", kTextStl, 200);
  survive_damage("a.off", kOff, 200);
  survive_damage("a.obj", kSquareObj, 200);
}

}  // namespace
}  // namespace geocloth
