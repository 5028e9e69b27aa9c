// SPDX-License-Identifier: GPL-3.0-or-later
// A body that walks has to be where its file says at every time: a collider that is elsewhere, inside out or late
// pushes the cloth where nobody sees a reason.
#include "geocloth/parametrize/animated_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "animated_fixture.h"
#include "geocloth/parametrize/parts.h"

namespace geocloth::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) on node 0, and an animation "move" without channels.
Gltf triangle_file() {
  Gltf g;
  g.json = json::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "bufferViews": [], "accessors": [],
    "nodes": [{"mesh": 0}], "animations": [{"name": "move", "samplers": [], "channels": []}]})");
  const auto position = g.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3", 3);
  g.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}}}}}};
  return g;
}

struct Track {
  std::size_t node = 0;
  std::string path;
  std::vector<float> time, value;
  std::string way = {};  ///< empty: the file says none
  std::size_t clip = 0;
};

void add_track(Gltf& g, const Track& track) {
  const bool scalar = track.path == "weights", turn = track.path == "rotation";
  const auto input = g.add_accessor<float>(track.time, 5126, "SCALAR", 1);
  const auto output = g.add_accessor<float>(track.value, 5126,
                                            scalar ? "SCALAR"
                                            : turn ? "VEC4"
                                                   : "VEC3",
                                            scalar ? 1U
                                            : turn ? 4U
                                                   : 3U);
  json& animation = g.json["animations"][track.clip];
  json sampler = {{"input", input}, {"output", output}};
  if (!track.way.empty()) sampler["interpolation"] = track.way;
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", track.node}, {"path", track.path}}}});
  animation["samplers"].push_back(sampler);
}

class AnimatedMeshTest : public ImportTest {
 protected:
  AnimatedMesh open(const Gltf& g, const AnimationOptions& options = {}) const {
    return AnimatedMesh(write("body.glb", g.glb()), options);
  }

  /// Of the first vertex.
  Vec3 first_at(const Gltf& g, double time, const AnimationOptions& options = {}) const {
    return open(g, options).positions_at(time).at(0);
  }

  /// The message and code with which a file or the options are refused.
  Error refused(const std::string& name, const std::string& bytes, const AnimationOptions& options = {}) const {
    try {
      static_cast<void>(AnimatedMesh(write(name, bytes), options).positions_at(0));
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      return e;
    }
    ADD_FAILURE() << name << " was played";
    return {ErrorCode::io, ""};
  }

  /// Breaks one thing of a file with one sampler, which has to be refused by words that name it.
  void expect_refused(const Gltf& good, const std::function<void(Gltf&)>& breaking, const std::string& words) const {
    Gltf g = good;
    breaking(g);
    const Error error = refused("broken.glb", g.glb());
    EXPECT_EQ(error.code(), ErrorCode::invalid_data);
    EXPECT_THAT(error.what(), AllOf(HasSubstr("broken.glb"), HasSubstr(words)));
  }
};

// --- what moves ----------------------------------------------------------------------------------------------------

TEST_F(AnimatedMeshTest, ANodeGoesEvenlyBetweenItsKeysAndStaysOutsideOfThem) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation", .time = {1, 3}, .value = {0, 0, 0, 4, 2, 0}});
  const AnimatedMesh mesh = open(g);
  EXPECT_DOUBLE_EQ(mesh.duration(), 3);
  ASSERT_EQ(mesh.triangle().size(), 1U);
  EXPECT_EQ(mesh.triangle()[0], (Triangle{0, 1, 2}));
  expect_at(mesh.positions_at(0)[0], 0, 0, 0);
  expect_at(mesh.positions_at(1.5)[0], 1, 0.5, 0);
  expect_at(mesh.positions_at(1.5)[1], 2, 0.5, 0);
  expect_at(mesh.positions_at(100)[0], 4, 2, 0);
}

// A straight line between quaternions would turn unevenly, and the long way round is a somersault.
TEST_F(AnimatedMeshTest, ANodeTurnsEvenlyTheShortWayAroundItsParent) {
  Gltf g = triangle_file();
  g.json["nodes"] = {{{"children", {1}}, {"translation", {5, 0, 0}}, {"scale", {2, 2, 2}}}, {{"mesh", 0}}};
  // 120 degrees about z; the quaternion of the second key has its sign turned.
  const auto s = static_cast<float>(std::sin(std::numbers::pi / 3)),
             c = static_cast<float>(std::cos(std::numbers::pi / 3));
  add_track(g, {.node = 1, .path = "rotation", .time = {0, 1}, .value = {0, 0, 0, 1, 0, 0, -s, -c}});
  const AnimatedMesh mesh = open(g);
  for (const double t : {0.0, 0.1, 0.25, 0.5, 1.0}) {
    const double angle = t * 2 * std::numbers::pi / 3;
    expect_at(mesh.positions_at(t)[1], 5 + 2 * std::cos(angle), 2 * std::sin(angle), 0);
  }
}

TEST_F(AnimatedMeshTest, StepsWaitForTheirKey) {
  Gltf g = triangle_file();
  add_track(g, {.path = "scale", .time = {0, 1, 2}, .value = {1, 1, 1, 2, 2, 2, 3, 3, 3}, .way = "STEP"});
  const AnimatedMesh mesh = open(g);
  expect_at(mesh.positions_at(0.99)[1], 1, 0, 0);
  expect_at(mesh.positions_at(1)[1], 2, 0, 0);
  expect_at(mesh.positions_at(1.5)[2], 0, 2, 0);
  expect_at(mesh.positions_at(5)[1], 3, 0, 0);
}

// Slopes are for a second, not for the way between two keys: over two seconds they count double.
TEST_F(AnimatedMeshTest, CubicSplinesHaveTheirSlopes) {
  Gltf g = triangle_file();
  // Of x(t) = t^3 at 0 and 2, which such a spline meets exactly. The outer slopes must not matter.
  add_track(g, {.path = "translation",
                .time = {0, 2},
                .value = {9, 9, 9, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 9, 9, 9},
                .way = "CUBICSPLINE"});
  const AnimatedMesh mesh = open(g);
  for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0}) expect_at(mesh.positions_at(t)[0], t * t * t, 0, 0);
  expect_at(mesh.positions_at(7)[0], 8, 0, 0);
}

// A spline of quaternions leaves the unit sphere; without bringing it back the body would shrink while it turns.
TEST_F(AnimatedMeshTest, ACubicTurnDoesNotScale) {
  Gltf g = triangle_file();
  const auto h = static_cast<float>(kHalf);
  add_track(g, {.path = "rotation",
                .time = {0, 1},
                .value = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, h, h, 0, 0, 0, 0},
                .way = "CUBICSPLINE"});
  const AnimatedMesh mesh = open(g);
  EXPECT_NEAR(length(mesh.positions_at(0.5)[1]), 1, 1e-6);
  expect_at(mesh.positions_at(0.5)[1], kHalf, kHalf, 0);
  expect_at(mesh.positions_at(1)[1], 0, 1, 0);
}

// Small files hold turns as integers; read as they are they would be no turns at all.
TEST_F(AnimatedMeshTest, TurnsAsNormalizedIntegers) {
  Gltf g = triangle_file();
  add_track(g, {.path = "rotation", .time = {0}, .value = {0, 0, 0, 1}});
  const auto output = g.add_accessor<int16_t>({0, 0, 23170, 23170}, 5122, "VEC4", 4);
  g.json["animations"][0]["samplers"][0]["output"] = output;
  EXPECT_THAT(refused("integers.glb", g.glb()).what(), HasSubstr("not of floats or normalized integers"));
  g.json["accessors"][output]["normalized"] = true;
  expect_at(open(g).positions_at(0)[1], 0, 1, 0);
}

// Limbs that stay behind when a joint turns would leave holes for the cloth.
TEST_F(AnimatedMeshTest, AJointBendsTheSkinThatItHolds) {
  Gltf g = skinned_strip();
  g.json["animations"] = {{{"name", "bend"}, {"samplers", json::array()}, {"channels", json::array()}}};
  const auto h = static_cast<float>(kHalf);
  add_track(g, {.node = 2, .path = "rotation", .time = {0, 1}, .value = {0, 0, 0, 1, h, 0, 0, h}});  // +y to +z
  add_track(g, {.node = 1, .path = "translation", .time = {0, 1}, .value = {0, 0, 0, 10, 0, 0}});
  add_track(g, {.node = 0, .path = "translation", .time = {0, 1}, .value = {0, 0, 0, 0, 0, 50}});  // has no effect
  const AnimatedMesh mesh = open(g);
  const std::vector<Vec3> half = mesh.positions_at(0.5), end = mesh.positions_at(1);
  ASSERT_EQ(half.size(), 6U);
  expect_at(half[0], 5, 0, 0);
  expect_at(half[5], 6, 1 + kHalf, kHalf);
  expect_at(end[1], 11, 0, 0);
  expect_at(end[3], 11, 1, 0);  // of both joints
  expect_at(end[5], 11, 1, 1);
}

TEST_F(AnimatedMeshTest, MorphTargetsGoWithTheirWeights) {
  Gltf g = triangle_file();
  const auto up = g.add_accessor<float>({0, 0, 0, 0, 0, 2, 0, 0, 0}, 5126, "VEC3", 3);
  const auto aside = g.add_accessor<float>({0, 0, 0, 0, 4, 0, 0, 0, 0}, 5126, "VEC3", 3);
  g.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
  g.json["meshes"][0]["weights"] = {0, 1};
  Gltf still = g;
  add_track(g, {.path = "weights", .time = {0, 1}, .value = {0, 0, 1, 0.5F}});
  const AnimatedMesh mesh = open(g, {.start = 2});
  expect_at(mesh.positions_at(0)[1], 1, 4, 0);  // as the file opens
  expect_at(mesh.positions_at(1)[1], 1, 2, 0);
  expect_at(mesh.positions_at(2)[1], 1, 0, 0);
  expect_at(mesh.positions_at(2.5)[1], 1, 1, 1);
  expect_at(mesh.positions_at(3)[1], 1, 2, 2);
  // What no animation moves keeps the weights of the file.
  add_track(still, {.path = "translation", .time = {0, 1}, .value = {0, 0, 0, 1, 0, 0}});
  expect_at(open(still).positions_at(1)[1], 2, 4, 0);
}

// glTF forbids to move what has a matrix; who writes it all the same means the matrix's parts.
TEST_F(AnimatedMeshTest, ANodeWithAMatrixKeepsWhatIsNotAnimated) {
  Gltf g = triangle_file();
  g.json["nodes"][0]["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1};
  add_track(g, {.path = "translation", .time = {0, 1}, .value = {0, 0, 0, 1, 0, 0}});
  const AnimatedMesh mesh = open(g, {.start = 1});
  expect_at(mesh.positions_at(0)[1], 1, 4, 3);
  expect_at(mesh.positions_at(1)[1], 0, 2, 0);
}

// --- when it plays -------------------------------------------------------------------------------------------------

// The cloth is dressed on the pose that the file opens with; a body that jumped from it would tear through.
TEST_F(AnimatedMeshTest, BeforeTheStartItGoesEvenlyFromTheFilesPoseToTheFirst) {
  Gltf g = triangle_file();
  g.json["nodes"][0]["translation"] = {0, 0, 8};
  g.json["nodes"][0]["scale"] = {3, 3, 3};
  const auto h = static_cast<float>(kHalf);
  add_track(g, {.path = "translation", .time = {0, 1}, .value = {4, 0, 0, 6, 0, 0}});
  add_track(g, {.path = "rotation", .time = {0}, .value = {0, 0, h, h}});
  add_track(g, {.path = "scale", .time = {0}, .value = {1, 1, 1}});
  const AnimatedMesh mesh = open(g, {.start = 2});
  expect_at(mesh.positions_at(0)[1], 3, 0, 8);
  expect_at(mesh.positions_at(1)[1], 2 + 2 * kHalf, 2 * kHalf, 4);
  expect_at(mesh.positions_at(2)[1], 4, 1, 0);
  expect_at(mesh.positions_at(2.5)[1], 5, 1, 0);
  EXPECT_EQ(open(g).positions_at(0), mesh.positions_at(2));  // nothing before it
}

TEST_F(AnimatedMeshTest, SpeedLoopAndHoldAtTheEnd) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation", .time = {0, 2}, .value = {0, 0, 0, 2, 0, 0}});
  expect_at(first_at(g, 3, {.start = 1, .speed = 0.5}), 1, 0, 0);
  expect_at(first_at(g, 1.5, {.start = 1, .speed = 3}), 1.5, 0, 0);
  expect_at(first_at(g, 9, {.start = 1, .speed = 3}), 2, 0, 0);
  expect_at(first_at(g, 6.5, {.start = 1, .loop = true}), 1.5, 0, 0);
  expect_at(first_at(g, 1e308, {.speed = 1e300}), 2, 0, 0);
  // One key is a pose; there is nothing to go round.
  Gltf pose = triangle_file();
  add_track(pose, {.path = "translation", .time = {0}, .value = {7, 0, 0}});
  expect_at(first_at(pose, 3, {.loop = true}), 7, 0, 0);
}

TEST_F(AnimatedMeshTest, ClipsByNameAndNumber) {
  Gltf g = triangle_file();
  g.json["animations"].push_back({{"name", "0"}, {"samplers", json::array()}, {"channels", json::array()}});
  g.json["animations"].push_back({{"samplers", json::array()}, {"channels", json::array()}});
  for (std::size_t i = 0; i < 3; ++i) {
    add_track(g, {.path = "translation", .time = {0}, .value = {static_cast<float>(i), 0, 0}, .clip = i});
  }
  EXPECT_EQ(first_at(g, 0).x, 0);
  EXPECT_EQ(first_at(g, 0, {.clip = "move"}).x, 0);
  EXPECT_EQ(first_at(g, 0, {.clip = "0"}).x, 1);  // a name before a number
  EXPECT_EQ(first_at(g, 0, {.clip = "2"}).x, 2);
  for (const char* clip : {"Move", "3", "-1", "1x", "99999999999999999999999"}) {
    const Error error = refused("a.glb", g.glb(), {.clip = clip});
    EXPECT_EQ(error.code(), ErrorCode::invalid_data);
    EXPECT_THAT(error.what(), AllOf(HasSubstr(clip), HasSubstr("0 'move', 1 '0', 2")));
  }
}

// Blender's exporter writes an animation for each object, and for the shape keys of each: one alone is half of a
// motion.
TEST_F(AnimatedMeshTest, AllClipsAtOnce) {
  Gltf g = triangle_file();
  for (const char* name : {"up", "wide"}) {
    g.json["animations"].push_back({{"name", name}, {"samplers", json::array()}, {"channels", json::array()}});
  }
  add_track(g, {.path = "translation", .time = {0, 1}, .value = {5, 0, 0, 6, 0, 0}, .clip = 0});
  add_track(g, {.path = "translation", .time = {0, 2}, .value = {0, 1, 0, 0, 3, 0}, .clip = 1});
  add_track(g, {.path = "scale", .time = {0, 1}, .value = {1, 1, 1, 2, 2, 2}, .clip = 2});
  const AnimatedMesh mesh(write("a.glb", g.glb()), {.clip = "*"});
  EXPECT_NEAR(mesh.duration(), 2, 1e-6);
  const auto width = [&](double time) {
    const std::vector<Vec3> p = mesh.positions_at(time);
    return length(p[1] - p[0]);
  };
  expect_at(mesh.positions_at(1)[0], 0, 2, 0);  // the later one of two that move it
  EXPECT_NEAR(width(1), 2 * width(0), 1e-5F);
  g.json["animations"][1]["name"] = "*";
  expect_at(first_at(g, 0, {.clip = "*"}), 0, 1, 0);
}

// --- the same surface as the importer's ------------------------------------------------------------------------------

// A mirrored body would be inside out, and push cloth into itself.
TEST_F(AnimatedMeshTest, MirroredNodesStripsAndFansAreOutsideOut) {
  for (const int mode : {4, 5, 6}) {
    Gltf g = triangle_file();
    const auto position =
        g.add_accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0, 3, 1, 0}, 5126, "VEC3", 3);
    json& primitive = g.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["POSITION"] = position;
    primitive["mode"] = mode;
    g.json["nodes"][0]["scale"] = {-1, 1, 2};
    add_track(g, {.path = "translation", .time = {0}, .value = {0, 0, 0}});
    const TriangleMesh still = read("still.glb", g.glb());
    const AnimatedMesh mesh = open(g);
    const std::vector<Vec3> position_now = mesh.positions_at(0);
    ASSERT_EQ(mesh.triangle().size(), still.triangle.size());
    for (std::size_t i = 0; i < still.triangle.size(); ++i) {
      double x = 0;
      Vec3 area{};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = position_now[mesh.triangle()[i][k]], q = position_now[mesh.triangle()[i][(k + 1) % 3]];
        area += cross(p, q);
        x += double{p.x} - still.position[still.triangle[i][k]][0];
      }
      EXPECT_NEAR(x, 0, 1e-6);
      const Point3 &a = still.position[still.triangle[i][0]], &b = still.position[still.triangle[i][1]],
                   &c = still.position[still.triangle[i][2]];
      EXPECT_NEAR(area.z, (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]), 1e-6) << mode;
    }
  }
}

// The same rock thrown twice has to be there twice, and what the file does not show must not push.
TEST_F(AnimatedMeshTest, AMeshOfTwoNodesIsThereTwiceAndHiddenOnesAreNot) {
  Gltf g = triangle_file();
  g.json["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}, {{"mesh", 0}, {"translation", {0, 0, 99}}}};
  g.json["scenes"] = {{{"nodes", {3}}}, {{"nodes", {0, 1}}}};
  g.json["scene"] = 1;
  add_track(g, {.node = 1, .path = "translation", .time = {0, 1}, .value = {0, 0, 0, 0, 0, 6}});
  const AnimatedMesh mesh = open(g);
  const std::vector<Vec3> position = mesh.positions_at(0.5);
  ASSERT_EQ(position.size(), 6U);
  ASSERT_EQ(mesh.triangle().size(), 2U);
  EXPECT_EQ(mesh.triangle()[1], (Triangle{3, 4, 5}));
  expect_at(position[1], 1, 0, 0);
  expect_at(position[4], 1, 0, 3);
  g.json["scenes"] = json::array();  // then all are shown
  g.json.erase("scene");
  EXPECT_EQ(open(g).positions_at(0).size(), 9U);
  g.json["scenes"] = {{{"nodes", {1}}}};
  g.json["nodes"][2].erase("mesh");
  EXPECT_THAT(refused("empty.glb", g.glb()).what(), HasSubstr("no faces"));
}

// A few bytes of file must not keep the machine busy for hours.
TEST_F(AnimatedMeshTest, AbsurdNumbersOfMorphTargetsAreRefused) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation", .time = {0}, .value = {0, 0, 0}});
  g.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 3'000'000},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 0}, {"indices", {{"bufferView", 0}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}}}});
  const std::size_t many = g.json["accessors"].size() - 1;
  json& primitive = g.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["POSITION"] = many;
  primitive["targets"] = json::array();
  for (int i = 0; i < 100; ++i) primitive["targets"].push_back({{"POSITION", many}});
  const Error error = refused("many.glb", g.glb());
  EXPECT_EQ(error.code(), ErrorCode::limit);
  EXPECT_THAT(error.what(), HasSubstr("morph targets are too many"));
}

// --- what is refused -----------------------------------------------------------------------------------------------

TEST_F(AnimatedMeshTest, FilesWithoutAnAnimationAreRefused) {
  Gltf g = triangle_file();
  EXPECT_THAT(refused("idle.glb", g.glb()).what(), HasSubstr("animations[0] 'move' moves no node"));
  g.json["animations"] = json::array();
  EXPECT_THAT(refused("none.glb", g.glb()).what(), HasSubstr("has no animation"));
  const Error other = refused("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(other.code(), ErrorCode::unsupported);
  EXPECT_THAT(other.what(), HasSubstr("a.obj: only glTF"));
  EXPECT_EQ(refused("empty.glb", "").code(), ErrorCode::invalid_data);
  EXPECT_THROW(AnimatedMesh(folder_ / "missing.glb"), Error);
}

TEST_F(AnimatedMeshTest, OptionsOutOfRangeAreRefused) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation", .time = {0}, .value = {0, 0, 0}});
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double value : {-1.0, nan, infinity}) {
    EXPECT_EQ(refused("a.glb", g.glb(), {.start = value}).code(), ErrorCode::invalid_argument);
    EXPECT_EQ(refused("a.glb", g.glb(), {.speed = value}).code(), ErrorCode::invalid_argument);
    EXPECT_THROW(static_cast<void>(open(g).positions_at(value)), Error);
  }
  EXPECT_EQ(refused("a.glb", g.glb(), {.speed = 0}).code(), ErrorCode::invalid_argument);
}

// Whoever gets such a file needs to know which element is broken; a crash or a body at nowhere helps nobody.
TEST_F(AnimatedMeshTest, BrokenAnimationsAreRefusedByName) {
  Gltf good = triangle_file();
  add_track(good, {.path = "translation", .time = {0, 1}, .value = {0, 0, 0, 1, 0, 0}});
  EXPECT_EQ(first_at(good, 1).x, 1);
  const auto animation = [](Gltf& g) -> json& { return g.json["animations"][0]; };
  const auto channel = [&](Gltf& g) -> json& { return animation(g)["channels"][0]; };
  const auto sampler = [&](Gltf& g) -> json& { return animation(g)["samplers"][0]; };
  expect_refused(
      good, [&](Gltf& g) { channel(g)["target"]["node"] = 7; }, "target.node is 7, but there are only 1");
  expect_refused(
      good, [&](Gltf& g) { channel(g)["sampler"] = 1; }, "names a missing sampler");
  expect_refused(
      good, [&](Gltf& g) { channel(g)["target"]["path"] = "colour"; }, "target.path is 'colour'");
  expect_refused(
      good, [&](Gltf& g) { channel(g)["target"].erase("path"); }, "channels[0].target.path is missing");
  expect_refused(
      good, [&](Gltf& g) { channel(g)["target"]["path"] = "rotation"; }, "samplers[0].output has 3 components");
  expect_refused(
      good, [&](Gltf& g) { channel(g)["target"]["path"] = "weights"; }, "a node that has none");
  expect_refused(
      good, [&](Gltf& g) { sampler(g)["interpolation"] = "SMOOTH"; }, "interpolation is not");
  expect_refused(
      good, [&](Gltf& g) { sampler(g)["interpolation"] = "CUBICSPLINE"; }, "2 times need 6");
  expect_refused(
      good, [&](Gltf& g) { sampler(g)["input"] = 99; }, "is 99, but there are only 3 accessors");
  expect_refused(
      good, [&](Gltf& g) { sampler(g)["input"] = sampler(g)["output"]; }, "input is not of single floats");
  const auto times = [&](const std::vector<float>& time) {
    return [&, time](Gltf& g) { sampler(g)["input"] = g.add_accessor<float>(time, 5126, "SCALAR", 1); };
  };
  expect_refused(good, times({0, 1, 2}), "3 times need 3");
  expect_refused(good, times({1, 0}), "time 1 is before");
  expect_refused(good, times({0, std::numeric_limits<float>::infinity()}), "time 1 is not a finite number");
  expect_refused(good, times({}), "has no times");
}

TEST_F(AnimatedMeshTest, PlacesThatAreNotFiniteAreRefusedWithTheirTime) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation",
                .time = {0, 1, 2},
                .value = {0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 0, 0, 3e38F, 0, 0}});
  const AnimatedMesh mesh = open(g);
  EXPECT_NO_THROW(static_cast<void>(mesh.positions_at(0)));
  for (const double time : {0.5, 2.0}) {
    try {
      static_cast<void>(mesh.positions_at(time));
      ADD_FAILURE() << time;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_data);
      EXPECT_THAT(e.what(), AllOf(HasSubstr("body.glb"), HasSubstr("'move'"), HasSubstr(time < 1 ? " 0.5 s" : " 2 s")));
    }
  }
}

// Keys at one time are a jump that some exporters write; between them there is no way to divide by.
TEST_F(AnimatedMeshTest, TwoKeysAtOneTimeAreAJump) {
  Gltf g = triangle_file();
  add_track(g, {.path = "translation", .time = {0, 1, 1, 2}, .value = {0, 0, 0, 1, 0, 0, 5, 0, 0, 6, 0, 0}});
  expect_at(first_at(g, 0.5), 0.5, 0, 0);
  expect_at(first_at(g, 1), 5, 0, 0);
  expect_at(first_at(g, 1.5), 5.5, 0, 0);
}

TEST_F(AnimatedMeshTest, DamagedFilesArePlayedOrRefused) {
  Gltf g = skinned_strip();
  g.json["animations"] = {{{"name", "bend"}, {"samplers", json::array()}, {"channels", json::array()}}};
  add_track(g, {.node = 2, .path = "rotation", .time = {0, 1}, .value = {0, 0, 0, 1, 1, 0, 0, 0}});
  add_track(g,
            {.node = 1, .path = "translation", .time = {0, 1, 2}, .value = {0, 0, 0, 1, 0, 0, 2, 0, 0}, .way = "STEP"});
  const std::string bytes = g.glb();
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::string damaged = bytes;
    for (unsigned k = 0; k <= seed % 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    expect_plays_or_is_refused(write("damaged.glb", damaged));
  }
}

// --- real bodies -----------------------------------------------------------------------------------------------------

const fs::path kBodies = fs::path(GEOCLOTH_SOURCE_DIR) / ".." / "shared" / "meshes" / "bodies";

std::vector<std::string> body_names() {
  std::vector<std::string> names;
  if (!fs::is_directory(kBodies)) return names;
  for (const auto& entry : fs::directory_iterator(kBodies)) {
    if (entry.path().extension() == ".glb") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Centre and area vector of a triangle, to find it again in another order.
struct Face {
  std::array<double, 6> number{};
  bool operator<(const Face& other) const { return number[0] < other.number[0]; }
};

std::vector<Face> faces_of(const std::vector<Triangle>& triangle, const std::function<Point3(uint32_t)>& position) {
  std::vector<Face> out;
  for (const Triangle& t : triangle) {
    const std::array<Point3, 3> p{position(t[0]), position(t[1]), position(t[2])};
    Face face;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      face.number[i] = (p[0][i] + p[1][i] + p[2][i]) / 3;
      face.number[3 + i] = (p[1][j] - p[0][j]) * (p[2][k] - p[0][k]) - (p[1][k] - p[0][k]) * (p[2][j] - p[0][j]);
    }
    out.push_back(face);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Faces of `a` that `b` lacks.
std::size_t count_missing(const std::vector<Face>& a, const std::vector<Face>& b, double size) {
  std::size_t missing = 0;
  const double near = 3e-4 * size;
  for (const Face& face : a) {
    Face low = face;
    low.number[0] -= near;
    bool found = false;
    for (auto it = std::lower_bound(b.begin(), b.end(), low); !found && it != b.end(); ++it) {
      if (it->number[0] > face.number[0] + near) break;
      found = true;
      for (std::size_t k = 0; k < 6; ++k) {
        found = found && std::abs(it->number[k] - face.number[k]) <= (k < 3 ? near : near * size);
      }
    }
    missing += found ? 0 : 1;
  }
  return missing;
}

double size_of(const std::vector<Vec3>& position) {
  Vec3 low = position.at(0), high = low;
  for (const Vec3& p : position) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return double{length(high - low)};
}

class AnimatedBody : public ::testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(AnimatedBody);

// The garment is fitted to what the importer shows: the body that moves has to begin as the same surface.
TEST_P(AnimatedBody, BeginsAsTheMeshThatIsImportedAndPlaysAllItsClips) {
  const fs::path path = kBodies / (GetParam() + ".glb");
  const size_t clips = count_animations(path);
  if (clips == 0) GTEST_SKIP() << "has no animations";
  const TriangleMesh still = import_mesh(path);
  const std::vector<Face> expected = faces_of(still.triangle, [&](uint32_t i) { return still.position[i]; });
  for (size_t clip = 0; clip < clips; ++clip) {
    const AnimatedMesh mesh(path, {.clip = std::to_string(clip), .start = 1});
    const std::vector<Vec3> opening = mesh.positions_at(0);
    const double size = size_of(opening);
    const std::vector<Face> faces = faces_of(mesh.triangle(), [&](uint32_t i) {
      return Point3{double{opening[i].x}, double{opening[i].y}, double{opening[i].z}};
    });
    ASSERT_EQ(faces.size(), expected.size());
    EXPECT_EQ(count_missing(expected, faces, size), 0U);
    EXPECT_EQ(count_missing(faces, expected, size), 0U);
    for (const double share : {-0.5, 0.0, 0.3, 0.77, 1.0, 3.0}) {
      const std::vector<Vec3> position = mesh.positions_at(std::max(0.0, 1 + share * mesh.duration()));
      EXPECT_TRUE(std::all_of(position.begin(), position.end(), is_finite));
      const double now = size_of(position);
      EXPECT_TRUE(now > 0.3 * size && now < 3 * size) << now << " of " << size << " m in clip " << clip;
    }
  }
}

// What `convert --parts list` calls the cape has to be the cape when the body moves.
TEST_P(AnimatedBody, HasThePartsOfTheMeshThatIsImported) {
  const fs::path path = kBodies / (GetParam() + ".glb");
  if (count_animations(path) == 0) GTEST_SKIP() << "has no animations";
  const TriangleMesh still = with_choosable_parts(import_mesh(path));
  for (size_t part = 0; part < still.part.size(); ++part) {
    const std::string number = std::to_string(part);
    const TriangleMesh chosen = select_parts(still, number);
    const AnimatedMesh mesh(path, {.start = 1, .parts = number});
    const std::vector<Vec3> opening = mesh.positions_at(0);
    const std::vector<Face> expected = faces_of(chosen.triangle, [&](uint32_t i) { return still.position[i]; });
    const std::vector<Face> faces = faces_of(mesh.triangle(), [&](uint32_t i) {
      return Point3{double{opening[i].x}, double{opening[i].y}, double{opening[i].z}};
    });
    ASSERT_EQ(faces.size(), expected.size()) << part;
    EXPECT_EQ(count_missing(expected, faces, size_of(opening)), 0U) << part;
    if (still.part.size() == 1) continue;
    EXPECT_EQ(AnimatedMesh(path, {.parts = "-" + number}).triangle().size() + faces.size(), still.triangle.size());
  }
  EXPECT_THROW(AnimatedMesh(path, {.parts = "no such part"}), Error);
}

INSTANTIATE_TEST_SUITE_P(All, AnimatedBody, ::testing::ValuesIn(body_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace geocloth::test
