// SPDX-License-Identifier: GPL-3.0-or-later
// Characters come as FBX more often than as anything else. What assimp makes of them has to be where the file says:
// pivots, turns before and behind, bones and blend shapes, and the pose in which the garment was fitted.
#include <cmath>
#include <sstream>

#include "animated_fixture.h"

namespace geocloth::test {
namespace {

using ::testing::HasSubstr;

std::string list(const std::vector<double>& values) {
  std::ostringstream out;
  for (std::size_t i = 0; i < values.size(); ++i) out << (i > 0 ? "," : "") << values[i];
  return out.str();
}

std::string array(const std::string& name, const std::vector<double>& values) {
  return name + ": *" + std::to_string(values.size()) + " {\na: " + list(values) + "\n}\n";
}

/// A textual FBX file (the format's objects, properties and connections as its exporters write them), in metres.
class Fbx {
 public:
  void model(int id, const std::string& name, const std::string& type, const std::string& properties = "") {
    objects_ << "Model: " << id << ", \"Model::" << name << "\", \"" << type << "\" {\nVersion: 232\nProperties70:  {\n"
             << properties << "}\n}\n";
  }
  static std::string vector(const std::string& name, double x, double y, double z) {
    return "P: \"" + name + "\", \"Vector3D\", \"Vector\", \"\"," + list({x, y, z}) + "\n";
  }
  void object(const std::string& head, const std::string& body) { objects_ << head << " {\n" << body << "}\n"; }
  void connect(int child, int parent) { connections_ << "C: \"OO\"," << child << "," << parent << "\n"; }
  void connect(int child, int parent, const std::string& property) {
    connections_ << "C: \"OP\"," << child << "," << parent << ", \"" << property << "\"\n";
  }
  /// @param stop  [s] where it ends; 0: it does not say
  void clip(int id, const std::string& name, int stop = 0) {
    const std::string ends = std::to_string(int64_t{stop} * 46'186'158'000);
    object("AnimationStack: " + std::to_string(id) + ", \"AnimStack::" + name + "\", \"\"",
           stop == 0 ? "" : "Properties70:  {\nP: \"LocalStop\", \"KTime\", \"Time\", \"\"," + ends + "\n}\n");
    object("AnimationLayer: " + std::to_string(id + 1) + ", \"AnimLayer::" + name + "\", \"\"", "");
    connect(id + 1, id);
    layer_ = id + 1;
  }
  /// Keys of one number of a property of an object, in the clip that was added last.
  /// @param part  "d|X", ...
  void curve(int id, int object_id, const std::string& property, const std::string& part,
             const std::vector<double>& seconds, const std::vector<double>& values) {
    std::vector<double> ticks;
    for (const double s : seconds) ticks.push_back(s * 46'186'158'000.0);
    std::ostringstream times;
    times.precision(0);
    times << std::fixed;
    for (std::size_t i = 0; i < ticks.size(); ++i) times << (i > 0 ? "," : "") << ticks[i];
    object("AnimationCurveNode: " + std::to_string(id) + ", \"AnimCurveNode::\", \"\"",
           "Properties70:  {\nP: \"" + part + "\", \"Number\", \"\", \"A\",0\n}\n");
    object("AnimationCurve: " + std::to_string(id + 1) + ", \"AnimCurve::\", \"\"",
           "KeyTime: *" + std::to_string(ticks.size()) + " {\na: " + times.str() + "\n}\n" +
               array("KeyValueFloat", values));
    connect(id, layer_);
    connect(id, object_id, property);
    connect(id + 1, id, part);
  }
  [[nodiscard]] std::string text() const {
    return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
           "GlobalSettings:  {\nVersion: 1000\nProperties70:  {\n"
           "P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n"
           "P: \"FrontAxis\", \"int\", \"Integer\", \"\",2\nP: \"FrontAxisSign\", \"int\", \"Integer\", \"\",1\n"
           "P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\nP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
           "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",100\n}\n}\nObjects:  {\n" +
           objects_.str() + "}\nConnections:  {\n" + connections_.str() + "}\n";
  }

 private:
  std::ostringstream objects_, connections_;
  int layer_ = 0;
};

/// A triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) on model 2000.
Fbx triangle_file(const std::string& properties = "") {
  Fbx f;
  f.object("Geometry: 1000, \"Geometry::shape\", \"Mesh\"",
           array("Vertices", {0, 0, 0, 1, 0, 0, 0, 1, 0}) + array("PolygonVertexIndex", {0, 1, -3}));
  f.model(2000, "thing", "Mesh", properties);
  f.connect(2000, 0);
  f.connect(1000, 2000);
  return f;
}

/// A strip of two squares that goes up, one bone for each, and a clip in which the upper one turns to -x in a second.
/// @param lean  degrees by which the upper bone is turned when the file opens, though the strip was bound without
Fbx strip_file(double lean = 0) {
  Fbx f;
  f.object("Geometry: 1000, \"Geometry::strip\", \"Mesh\"",
           array("Vertices", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}) +
               array("PolygonVertexIndex", {0, 1, 3, -3, 2, 3, 5, -5}));
  f.model(2000, "strip", "Mesh");
  f.model(3000, "lower", "LimbNode");
  f.model(3001, "upper", "LimbNode", Fbx::vector("Lcl Translation", 0, 1, 0) + Fbx::vector("Lcl Rotation", 0, 0, lean));
  f.object("Deformer: 4000, \"Deformer::\", \"Skin\"", "Version: 101\n");
  const auto cluster = [&](int id, const std::vector<double>& points, double height) {
    f.object("Deformer: " + std::to_string(id) + ", \"SubDeformer::\", \"Cluster\"",
             array("Indexes", points) + array("Weights", std::vector<double>(points.size(), 1)) +
                 array("Transform", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -height, 0, 1}) +
                 array("TransformLink", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, height, 0, 1}));
  };
  cluster(4001, {0, 1, 2, 3}, 0);
  cluster(4002, {4, 5}, 1);
  f.connect(2000, 0);
  f.connect(3000, 0);
  f.connect(3001, 3000);
  f.connect(1000, 2000);
  f.connect(4000, 1000);
  f.connect(4001, 4000);
  f.connect(4002, 4000);
  f.connect(3000, 4001);
  f.connect(3001, 4002);
  f.clip(5000, "rig|Bend");
  f.curve(6000, 3001, "Lcl Rotation", "d|Z", {0, 1}, {0, 90});
  return f;
}

/// Where a vertex is at a time that is at (x, y, 0) when the file opens.
Vec3 at(const AnimatedMesh& mesh, double time, double x, double y) {
  const std::vector<Vec3> opened = mesh.positions_as_opened();
  for (std::size_t i = 0; i < opened.size(); ++i) {
    if (std::hypot(double{opened[i].x} - x, double{opened[i].y} - y) < 1e-5) return mesh.positions_at(time)[i];
  }
  ADD_FAILURE() << "no vertex at " << x << ", " << y;
  return {};
}

class AnimatedFbx : public ImportTest {
 protected:
  AnimatedMesh open(const Fbx& f, const AnimationOptions& options = {}) const {
    return AnimatedMesh(write("body.fbx", f.text()), options);
  }
  std::string refused(const std::string& name, const std::string& bytes, const AnimationOptions& options = {}) const {
    try {
      static_cast<void>(AnimatedMesh(write(name, bytes), options));
    } catch (const Error& e) {
      return e.what();
    }
    ADD_FAILURE() << name << " was read";
    return "";
  }
};

// Limbs that stay behind when a bone turns would leave holes for the cloth.
TEST_F(AnimatedFbx, ABoneBendsTheSkinThatItHolds) {
  const AnimatedMesh mesh = open(strip_file());
  EXPECT_EQ(count_animations(folder_ / "body.fbx"), 1U);
  EXPECT_NEAR(mesh.duration(), 1, 1e-6);
  ASSERT_EQ(mesh.positions_as_opened().size(), 6U);
  ASSERT_EQ(mesh.triangle().size(), 4U);
  expect_at(at(mesh, 0.5, 1, 0), 1, 0, 0);
  expect_at(at(mesh, 0.5, 0, 2), -kHalf, 1 + kHalf, 0);
  expect_at(at(mesh, 0.5, 1, 2), 0, 1 + 2 * kHalf, 0);
  expect_at(at(mesh, 1, 1, 1), 1, 1, 0);
  expect_at(at(mesh, 1, 1, 2), -1, 2, 0);
  expect_at(at(mesh, 7, 1, 2), -1, 2, 0);
}

// Garments are fitted to the bound pose: the body begins there, though its bones are elsewhere when the file opens.
TEST_F(AnimatedFbx, OpensAsItWasBoundAndGoesFromThereToTheAnimation) {
  const Fbx f = strip_file(45);
  const AnimatedMesh mesh = open(f, {.start = 2});
  const TriangleMesh imported = import_mesh(folder_ / "body.fbx");
  const std::vector<Vec3> opened = mesh.positions_as_opened(), begin = mesh.positions_at(0);
  ASSERT_EQ(opened.size(), imported.position.size());
  for (std::size_t i = 0; i < opened.size(); ++i) {
    expect_at(opened[i], imported.position[i][0], imported.position[i][1], imported.position[i][2]);
    expect_at(begin[i], imported.position[i][0], imported.position[i][1], imported.position[i][2]);
  }
  expect_at(at(mesh, 3, 1, 2), -1, 2, 0);
  Fbx turned = strip_file(0);
  turned.clip(5100, "Turned");
  turned.curve(6100, 3001, "Lcl Rotation", "d|Z", {0, 1}, {90, 90});
  expect_at(at(open(turned, {.clip = "Turned", .start = 2}), 1, 0, 2), -kHalf, 1 + kHalf, 0);
}

// A point cache is laid on the mesh that a modelling program has: on its points, in its order, those of one object one
// after the other, whatever faces and materials use them first, and with those that no face uses.
TEST_F(AnimatedFbx, VerticesAreThePointsOfTheFileInItsOrder) {
  Fbx f;
  f.object("Geometry: 1000, \"Geometry::shape\", \"Mesh\"",
           array("Vertices", {5, 5, 5, 0, 2, 0, 1, 2, 0, 0, 1, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}) +
               array("PolygonVertexIndex", {5, 6, 4, -4, 7, 4, 2, -2}) +
               "LayerElementMaterial: 0 {\nVersion: 101\nName: \"\"\nMappingInformationType: \"ByPolygon\"\n"
               "ReferenceInformationType: \"IndexToDirect\"\n" +
               array("Materials", {1, 0}) +
               "}\nLayer: 0 {\nVersion: 100\nLayerElement: {\nType: \"LayerElementMaterial\"\nTypedIndex: 0\n}\n}\n");
  f.model(2000, "coat", "Mesh", Fbx::vector("Lcl Translation", 10, 0, 0));
  f.model(2001, "coat2", "Mesh");
  for (const int id : {3000, 3001}) {
    f.object("Material: " + std::to_string(id) + ", \"Material::m" + std::to_string(id) + "\", \"\"", "Version: 102\n");
  }
  for (const int model : {2000, 2001}) {
    f.connect(model, 0);
    f.connect(1000, model);
    f.connect(3000, model);
    f.connect(3001, model);
  }
  f.clip(5000, "Slide", 1);
  f.curve(6000, 2000, "Lcl Translation", "d|X", {0, 1}, {10, 11});
  const std::vector<Point3> point{{5, 5, 5}, {0, 2, 0}, {1, 2, 0}, {0, 1, 0},
                                  {1, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

  const TriangleMesh mesh = import_mesh(write("coat.fbx", f.text()));
  EXPECT_EQ(mesh.part.size(), 4U);
  ASSERT_EQ(mesh.position.size(), 2 * point.size());
  const AnimatedMesh moving(folder_ / "coat.fbx");
  const std::vector<Vec3> later = moving.positions_at(1);
  ASSERT_EQ(later.size(), mesh.position.size());
  for (std::size_t i = 0; i < mesh.position.size(); ++i) {
    const auto& [x, y, z] = point[i % point.size()];
    const double right = i < point.size() ? 10 : 0;
    EXPECT_EQ(mesh.position[i], (Point3{x + right, y, z})) << i;
    expect_at(later[i], x + right * 1.1, y, z);
  }
  // An object is a vertex group: all its points, for a cache of the object alone. So is a mesh.
  ASSERT_EQ(mesh.vertex_groups.size(), 3U);
  EXPECT_EQ(mesh.vertex_groups[0].name, "coat");
  EXPECT_EQ(mesh.vertex_groups[0].source_vertex.size(), point.size());
  EXPECT_EQ(mesh.vertex_groups[2].name, "shape");
  EXPECT_EQ(mesh.vertex_groups[2].source_vertex.size(), 2 * point.size());
}

// The lips of a closed mouth lie on each other, and go apart when it opens.
TEST_F(AnimatedFbx, PointsAtOnePlaceGoTheirOwnWays) {
  const std::string apart =
      replaced(replaced(strip_file().text(), "Vertices: *18 {\na: 0,0,0,1,0,0,0,1,0,1,1,0,0,2,0,1,2,0\n",
                        "Vertices: *24 {\na: 0,0,0,1,0,0,0,1,0,1,1,0,0,2,0,1,2,0,0,1,0,1,1,0\n"),
               "a: 0,1,3,-3,2,3,5,-5\n", "a: 0,1,3,-3,6,7,5,-5\n");
  const std::string text = replaced(replaced(apart, "Indexes: *2 {\na: 4,5\n", "Indexes: *4 {\na: 4,5,6,7\n"),
                                    "Weights: *2 {\na: 1,1\n", "Weights: *4 {\na: 1,1,1,1\n");
  const AnimatedMesh mesh(write("mouth.fbx", text));
  const std::vector<Vec3> opened = mesh.positions_as_opened(), turned = mesh.positions_at(1);
  ASSERT_EQ(opened.size(), 8U);
  expect_at(opened[3], 1, 1, 0);
  expect_at(opened[7], 1, 1, 0);
  expect_at(turned[3], 1, 1, 0);
  expect_at(turned[7], 0, 2, 0);
  EXPECT_EQ(import_mesh(folder_ / "mouth.fbx").position.size(), 8U);
}

TEST_F(AnimatedFbx, PivotsAndTurnsBeforeTheTurn) {
  Fbx pivot = triangle_file(Fbx::vector("RotationPivot", 1, 0, 0));
  pivot.clip(5000, "Turn");
  pivot.curve(6000, 2000, "Lcl Rotation", "d|Z", {0, 1}, {0, 90});
  const std::vector<Vec3> around = open(pivot).positions_at(1);
  expect_at(around[0], 1, -1, 0);
  expect_at(around[1], 1, 0, 0);
  expect_at(around[2], 0, -1, 0);

  // PreRotation, then the turn: a point goes through the turn first. Its x axis, turned about z to y, tips to z.
  Fbx before = triangle_file("P: \"RotationActive\", \"bool\", \"\", \"\",1\n" + Fbx::vector("PreRotation", 90, 0, 0) +
                             Fbx::vector("Lcl Translation", 5, 0, 0));
  before.clip(5000, "Turn");
  before.curve(6000, 2000, "Lcl Rotation", "d|Z", {0, 1}, {0, 90});
  const AnimatedMesh mesh = open(before);
  expect_at(mesh.positions_as_opened()[2], 5, 0, 1);
  expect_at(mesh.positions_at(1)[1], 5, 0, 1);
  expect_at(mesh.positions_at(1)[2], 4, 0, 0);
}

TEST_F(AnimatedFbx, InItsUnitWithItsUpAxis) {
  Fbx f = triangle_file();
  f.clip(5000, "Go");
  f.curve(6000, 2000, "Lcl Translation", "d|Z", {0, 2}, {0, 300});
  std::string text = replaced(f.text(), "\"Number\", \"\",100", "\"Number\", \"\",1");  // centimetres
  text = replaced(text, R"("UpAxis", "int", "Integer", "",1)", R"("UpAxis", "int", "Integer", "",2)");
  text = replaced(text, R"("FrontAxis", "int", "Integer", "",2)", R"("FrontAxis", "int", "Integer", "",1)");
  text = replaced(text, R"("FrontAxisSign", "int", "Integer", "",1)", R"("FrontAxisSign", "int", "Integer", "",-1)");
  const AnimatedMesh mesh(write("z.fbx", text));
  expect_at(mesh.positions_as_opened()[2], 0, 0, -0.01);
  expect_at(mesh.positions_at(1)[2], 0, 1.5, -0.01);
}

TEST_F(AnimatedFbx, BlendShapes) {
  Fbx f = triangle_file();
  f.object("Geometry: 1001, \"Geometry::tall\", \"Shape\"",
           array("Indexes", {2}) + array("Vertices", {0, 2, 0}) + array("Normals", {0, 0, 0}));
  f.object("Geometry: 1002, \"Geometry::wide\", \"Shape\"",
           array("Indexes", {1}) + array("Vertices", {4, 0, 0}) + array("Normals", {0, 0, 0}));
  f.object("Deformer: 4100, \"Deformer::\", \"BlendShape\"", "Version: 100\n");
  f.object("Deformer: 4101, \"SubDeformer::tall\", \"BlendShapeChannel\"", "DeformPercent: 0\n");
  f.object("Deformer: 4102, \"SubDeformer::wide\", \"BlendShapeChannel\"", "DeformPercent: 0\n");
  f.connect(4100, 1000);
  f.connect(4101, 4100);
  f.connect(4102, 4100);
  f.connect(1001, 4101);
  f.connect(1002, 4102);
  f.clip(5000, "Grow", 1);
  f.curve(6000, 4101, "DeformPercent", "d|DeformPercent", {0, 1}, {0, 100});
  f.curve(6100, 4102, "DeformPercent", "d|DeformPercent", {0, 0.5}, {50, 0});
  const AnimatedMesh mesh = open(f);
  expect_at(mesh.positions_as_opened()[2], 0, 1, 0);
  expect_at(mesh.positions_at(0)[1], 3, 0, 0);
  expect_at(mesh.positions_at(0.25)[1], 2, 0, 0);
  expect_at(mesh.positions_at(0.25)[2], 0, 1.5, 0);
  expect_at(mesh.positions_at(1)[1], 1, 0, 0);
  expect_at(mesh.positions_at(1)[2], 0, 3, 0);
}

// Where nothing but blend shapes moves and the file does not say how long, assimp makes times of nothing.
TEST_F(AnimatedFbx, WithoutALengthIsRefused) {
  Fbx f = triangle_file();
  f.object("Geometry: 1001, \"Geometry::tall\", \"Shape\"",
           array("Indexes", {2}) + array("Vertices", {0, 2, 0}) + array("Normals", {0, 0, 0}));
  f.object("Deformer: 4100, \"Deformer::\", \"BlendShape\"", "Version: 100\n");
  f.object("Deformer: 4101, \"SubDeformer::tall\", \"BlendShapeChannel\"", "DeformPercent: 0\n");
  f.connect(4100, 1000);
  f.connect(4101, 4100);
  f.connect(1001, 4101);
  f.clip(5000, "Grow");
  f.curve(6000, 4101, "DeformPercent", "d|DeformPercent", {0, 1}, {0, 100});
  EXPECT_THAT(refused("a.fbx", f.text()), HasSubstr("animation 0 'Grow' does not say how long it is"));
}

// assimp puts keys between two that are more than half a turn apart, one after the other until memory is full.
TEST_F(AnimatedFbx, TurnsWithoutEndAreRefused) {
  const auto turned = [&](const std::vector<double>& seconds, const std::vector<double>& degrees) {
    Fbx f = strip_file();
    f.clip(5100, "Turn");
    f.curve(6100, 3001, "Lcl Rotation", "d|Z", seconds, degrees);
    return f.text();
  };
  expect_at(at(AnimatedMesh(write("a.fbx", turned({0, 1}, {0, 720})), {.clip = "Turn"}), 0.125, 0, 2), -1, 1, 0);
  expect_at(at(AnimatedMesh(write("a.fbx", turned({0, 1}, {0, -720})), {.clip = "Turn"}), 0.125, 0, 2), 1, 1, 0);
  EXPECT_THAT(refused("a.fbx", turned({0, 1}, {0, 1e30})), HasSubstr("too far between two keys"));
  EXPECT_THAT(refused("a.fbx", turned({1, 1}, {0, 720})), HasSubstr("too far between two keys"));
  EXPECT_THAT(refused("a.fbx", turned({0, 1e8}, {0, 2e9})), HasSubstr("turns too often"));
  EXPECT_THAT(refused("a.fbx", replaced(strip_file().text(), "a: 0,90\n", "a: 0,nan\n")), HasSubstr("finite number"));
  EXPECT_THAT(refused("a.fbx", replaced(strip_file().text(), "a: 0,90\n", "a: 0,+90\n")),
              HasSubstr("'+90' where a number is to be"));
  EXPECT_EQ(import_mesh(write("a.fbx", turned({0, 1}, {0, 1e30}))).position.size(), 6U);
}

// Of nodes assimp knows no such properties, and ends the program where it is built as Debian builds it.
TEST_F(AnimatedFbx, PropertiesOfNodesThatAreTimesAreLeftOut) {
  Fbx f = triangle_file(
      "P: \"born\", \"KTime\", \"Time\", \"\",46186158000\n"
      "P: \"tint\", \"ColorAndAlpha\", \"\", \"A\",1,1,1,1\n" +
      Fbx::vector("Lcl Translation", 5, 0, 0));
  f.clip(5000, "Go", 2);
  f.curve(6000, 2000, "Lcl Translation", "d|Z", {0, 1}, {0, 3});
  const AnimatedMesh mesh = open(f);
  EXPECT_NEAR(mesh.duration(), 2, 1e-6);
  expect_at(mesh.positions_at(1)[1], 6, 0, 3);
  EXPECT_NEAR(import_mesh(folder_ / "body.fbx").position[1][0], 6, 1e-6);
}

// assimp ends the program where it is built as Debian builds it.
TEST_F(AnimatedFbx, BonesThatHoldPointsBeyondTheMeshAreRefused) {
  const std::string text = replaced(strip_file().text(), "a: 4,5\n", "a: 4,6\n");
  EXPECT_THAT(refused("a.fbx", text), HasSubstr("a bone holds point 6 of a mesh of 6"));
  EXPECT_THAT(refusal("b.fbx", text).what(), HasSubstr("a bone holds point 6 of a mesh of 6"));
  EXPECT_THAT(refusal("c.fbx", replaced(text, "a: 4,6\n", "a: 4,-1\n")).what(), HasSubstr("a bone holds point"));
  Fbx twice = strip_file();
  twice.connect(4002, 4000);
  EXPECT_THAT(refusal("d.fbx", twice.text()).what(), HasSubstr("a skin has the bone 'upper' twice"));
  EXPECT_THAT(refused("e.fbx", replaced(strip_file().text(), "Model::upper", "Model::lower")),
              HasSubstr("a skin has the bone 'lower' twice"));
}

// Blender calls what an armature does "Armature|Walk"; nobody types that.
TEST_F(AnimatedFbx, ClipsByNameByWhatTheyDoAndByNumber) {
  Fbx f = strip_file();
  f.clip(5100, "rig|Lean");
  f.curve(6100, 3000, "Lcl Rotation", "d|Z", {0, 1}, {0, 90});
  for (const std::string clip : {"rig|Lean", "Lean", "1"}) {
    expect_at(at(open(f, {.clip = clip}), 1, 1, 2), -2, 1, 0);
  }
  expect_at(at(open(f), 1, 1, 2), -1, 2, 0);
  expect_at(at(open(f, {.clip = "*"}), 1, 1, 2), -2, -1, 0);  // both turned by 90 degrees
  EXPECT_THAT(refused("a.fbx", f.text(), {.clip = "Run"}),
              HasSubstr("has no animation 'Run'; it has 0 'rig|Bend', 1 'rig|Lean'"));
}

TEST_F(AnimatedFbx, WithoutAnimationAndPartsItHasNot) {
  EXPECT_THAT(refused("a.fbx", triangle_file().text()), HasSubstr("has no animation"));
  EXPECT_EQ(count_animations(folder_ / "a.fbx"), 0U);
  EXPECT_THAT(refused("b.fbx", strip_file().text(), {.parts = "hat"}), HasSubstr("hat"));
  EXPECT_EQ(open(strip_file(), {.parts = "strip"}).triangle().size(), 4U);
}

/// The strip with its bones: the upper one turns to -x in a second, told by matrices.
const std::string kDae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="metre" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_animations><animation id="bend">
<source id="in"><float_array id="in-a" count="2">0 1</float_array><technique_common>
<accessor source="#in-a" count="2" stride="1"><param name="TIME" type="float"/></accessor></technique_common></source>
<source id="out"><float_array id="out-a" count="32">1 0 0 0 0 1 0 1 0 0 1 0 0 0 0 1
0 -1 0 0 1 0 0 1 0 0 1 0 0 0 0 1</float_array><technique_common>
<accessor source="#out-a" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common>
</source>
<source id="way"><Name_array id="way-a" count="2">LINEAR LINEAR</Name_array><technique_common>
<accessor source="#way-a" count="2" stride="1"><param name="INTERPOLATION" type="name"/></accessor></technique_common>
</source>
<sampler id="s"><input semantic="INPUT" source="#in"/><input semantic="OUTPUT" source="#out"/>
<input semantic="INTERPOLATION" source="#way"/></sampler>
<channel source="#s" target="upper/transform"/></animation>
</library_animations>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="18">0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0</float_array><technique_common>
<accessor source="#pa" count="6" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="2"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4</vcount><p>0 1 3 2 2 3 5 4</p></polylist>
</mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g">
<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>
<source id="j"><Name_array id="ja" count="2">lower upper</Name_array><technique_common>
<accessor source="#ja" count="2" stride="1"><param name="JOINT" type="name"/></accessor></technique_common></source>
<source id="b"><float_array id="ba" count="32">1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1
1 0 0 0 0 1 0 -1 0 0 1 0 0 0 0 1</float_array><technique_common>
<accessor source="#ba" count="2" stride="16"><param name="TRANSFORM" type="float4x4"/></accessor></technique_common>
</source>
<source id="w"><float_array id="wa" count="1">1</float_array><technique_common>
<accessor source="#wa" count="1" stride="1"><param name="WEIGHT" type="float"/></accessor></technique_common></source>
<joints><input semantic="JOINT" source="#j"/><input semantic="INV_BIND_MATRIX" source="#b"/></joints>
<vertex_weights count="6"><input semantic="JOINT" source="#j" offset="0"/>
<input semantic="WEIGHT" source="#w" offset="1"/><vcount>1 1 1 1 1 1</vcount><v>0 0 0 0 0 0 0 0 1 0 1 0</v>
</vertex_weights></skin></controller></library_controllers>
<library_visual_scenes><visual_scene id="scene">
<node id="lower" sid="lower" name="lower" type="JOINT"><rotate sid="turn">0 0 1 0</rotate>
<node id="upper" sid="upper" name="upper" type="JOINT"><matrix sid="transform">1 0 0 0 0 1 0 1 0 0 1 0 0 0 0 1</matrix>
</node></node>
<node id="body"><instance_controller url="#c"><skeleton>#lower</skeleton></instance_controller></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
)";

/// One more animation beside "bend": the lower bone turns by its angle, for twice as long.
const std::string kLean = R"(<animation id="lean">
<source id="in2"><float_array id="in2-a" count="2">0 2</float_array><technique_common>
<accessor source="#in2-a" count="2" stride="1"><param name="TIME" type="float"/></accessor></technique_common></source>
<source id="out2"><float_array id="out2-a" count="2">0 90</float_array><technique_common>
<accessor source="#out2-a" count="2" stride="1"><param name="ANGLE" type="float"/></accessor></technique_common></source>
<sampler id="s2"><input semantic="INPUT" source="#in2"/><input semantic="OUTPUT" source="#out2"/></sampler>
<channel source="#s2" target="lower/turn.ANGLE"/></animation>
</library_animations>)";

TEST_F(AnimatedFbx, DaeBendsTheSkinThatItsJointsHold) {
  const AnimatedMesh mesh(write("body.dae", kDae));
  EXPECT_EQ(count_animations(folder_ / "body.dae"), 1U);
  EXPECT_NEAR(mesh.duration(), 1, 1e-6);
  ASSERT_EQ(mesh.positions_as_opened().size(), 6U);
  expect_at(at(mesh, 0.5, 1, 2), 0, 1 + 2 * kHalf, 0);
  expect_at(at(mesh, 1, 1, 2), -1, 2, 0);
  expect_at(at(mesh, 1, 1, 1), 1, 1, 0);
}

// Exporters write an animation for each joint, of any length; played one by one, one joint would move.
TEST_F(AnimatedFbx, AllThatMovesInADaeFilePlaysAtOnce) {
  const std::string text = replaced(kDae, "</library_animations>", kLean);
  const AnimatedMesh mesh(write("body.dae", text));
  EXPECT_EQ(count_animations(folder_ / "body.dae"), 1U);
  EXPECT_NEAR(mesh.duration(), 2, 1e-6);
  expect_at(at(mesh, 2, 1, 2), -2, -1, 0);  // both turned by 90 degrees
  expect_at(at(mesh, 2, 1, 0), 0, 1, 0);
}

TEST_F(AnimatedFbx, BrokenDaeAnimationsAreRefused) {
  const auto message = [&](const std::string& what, const std::string& by) {
    return refused("a.dae", replaced(kDae, what, by));
  };
  EXPECT_THAT(message(">0 1</float_array>", ">0 nan</float_array>"), HasSubstr("time 'nan'"));
  EXPECT_THAT(message(">0 1</float_array>", ">0 1e300</float_array>"), HasSubstr("time '1e300'"));
  EXPECT_THAT(message(R"(#out-a" count="2")", R"(#out-a" count="1")"), HasSubstr("a value for each time"));
  EXPECT_THAT(
      message(R"(stride="1"><param name="TIME" type="float"/>)", R"(stride="1"><param name="TIME" type="float4x4"/>)"),
      HasSubstr("impossible size"));
  EXPECT_THAT(message("upper/transform\"", "upper/transform(3)(3)\""), HasSubstr("impossible size"));
  EXPECT_THAT(message("upper/transform\"", "nobody/transform\""), HasSubstr("has no animation"));
  // The mesh is whole: only those who want the animation are told.
  EXPECT_EQ(
      import_mesh(write("still.dae", replaced(kDae, ">0 1</float_array>", ">0 nan</float_array>"))).position.size(),
      6U);
}

// assimp takes the number of entries for that of points.
TEST_F(AnimatedFbx, DaeSkinsWithFewerEntriesThanPointsAreRefused) {
  const std::string fewer = replaced(kDae, "<vertex_weights count=\"6\"", "<vertex_weights count=\"2\"");
  EXPECT_THAT(refusal("a.dae", fewer).what(), HasSubstr("an entry for each point"));
  const std::string vcount = "<vcount>1 1 1 1 1 1</vcount>";
  EXPECT_THAT(refusal("a.dae", replaced(fewer, vcount, "<vcount>1 1</vcount>")).what(),
              HasSubstr("an entry for each point"));
}

TEST_F(AnimatedFbx, TooManyKeysOfADaeFileAreRefused) {
  constexpr int kKeys = 150'000;
  std::string times, values;
  for (int i = 0; i < kKeys; ++i) {
    times += std::to_string(i) + " ";
    values += "0 ";
  }
  const std::string count = std::to_string(kKeys);
  std::string lean = replaced(kLean, R"(count="2">0 2<)", "count=\"" + count + "\">" + times + "<");
  lean = replaced(lean, R"(count="2">0 90<)", "count=\"" + count + "\">" + values + "<");
  for (int k = 0; k < 2; ++k) lean = replaced(lean, R"(count="2" stride)", "count=\"" + count + "\" stride");
  EXPECT_THAT(refused("a.dae", replaced(kDae, "</library_animations>", lean)), HasSubstr("too many keys"));
}

TEST_F(AnimatedFbx, DamagedFilesArePlayedOrRefused) {
  const std::string fbx = strip_file().text();
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    const bool dae = seed % 2 == 0;
    std::string damaged = dae ? kDae : fbx;
    for (unsigned k = 0; k <= seed % 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    expect_plays_or_is_refused(write(dae ? "damaged.dae" : "damaged.fbx", damaged));
  }
}

}  // namespace
}  // namespace geocloth::test
