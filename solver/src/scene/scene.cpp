// SPDX-License-Identifier: Apache-2.0
// The scene file: JSON to Scene, every key of version 1 recognised, every value checked by the same functions that
// guard the solver. What the format has and this version cannot do is refused by its key, never ignored.

#include "geocloth/solver/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include "check_input.h"
#include "colliders/surface_bounds.h"
#include "material_fields.h"
#include "scene/collision_groups.h"
#include "scene/json_reader.h"

namespace geocloth {
namespace {

constexpr size_t kLargestSceneFile = size_t{64} << 20U;  // [bytes]
constexpr double kLongestTime = 1e9;                     // [s]

/// Runs the solver's own checks; what they refuse is the file's fault here.
template <class Check>
void checked(const Check& check_it) {
  try {
    check_it();
  } catch (const Error& error) {
    throw Error(error.code() == ErrorCode::invalid_argument ? ErrorCode::invalid_data : error.code(), error.what());
  }
}

double in_range(const JsonReader& json, double low, double high) {
  const double value = json.number();
  if (value < low || value > high) {
    json.fail("must be from " + nlohmann::json(low).dump() + " to " + nlohmann::json(high).dump());
  }
  return value;
}

/// What places a cloth or a mesh is the transform's.
void expect_no_placing(const JsonReader& json) {
  for (const auto* key : {"translate", "rotate_deg", "scale"}) {
    if (json.has(key)) json.fail("\"" + std::string(key) + "\" belongs into \"transform\"");
  }
}

Motion read_motion(const JsonReader& json) {
  Motion motion;
  for (const JsonReader& entry : json.elements()) {
    entry.expect_object({"time", "translate", "rotate_deg", "teleport"});
    Keyframe key;
    key.time = entry.at("time").number();
    if (!motion.empty() && !(key.time > motion.back().time)) entry.at("time").fail("must be later than the key before");
    entry.read("translate", key.translate);
    key.rotate_deg = entry.has("rotate_deg") ? entry.at("rotate_deg").vector() : Vec3{};
    key.rotate = quat_from_euler_deg(*key.rotate_deg);
    if (entry.has("teleport")) key.teleport = entry.at("teleport").boolean();
    checked([&] { check_position(key.translate, entry.where() + ".translate"); });
    motion.push_back(key);
  }
  return motion;
}

Motion read_motion_of(const JsonReader& json) {
  return json.has("motion") ? read_motion(json.at("motion")) : Motion{};
}

/// What a motion turns about.
std::optional<Vec3> read_pivot(const JsonReader& json) {
  if (!json.has("pivot")) return std::nullopt;
  const JsonReader pivot = json.at("pivot");
  const Vec3 point = pivot.vector();
  checked([&] { check_position(point, pivot.where()); });
  if (!json.has("motion")) pivot.fail("is what a \"motion\" turns about; there is none");
  return point;
}

Material preset_named(const JsonReader& json) {
  const std::string name = json.text();
  if (const MaterialPreset* preset = find_material_preset(name)) return preset->material;
  std::vector<std::string_view> names;
  for (const MaterialPreset& preset : material_presets()) names.push_back(preset.name);
  json.fail("there is no material preset " + in_quotes(name) + nearest_and_all(name, names));
}

/// @param material  what is not said is as there, or as in its "preset"
/// @param other     a key that it has beside those of a material
Material read_material_fields(const JsonReader& json, Material material, std::string_view other) {
  std::vector<std::string_view> keys{"preset", other};
  for (const MaterialField& field : kMaterialFields) keys.push_back(field.key);
  json.expect_object(keys);
  if (json.has("preset")) material = preset_named(json.at("preset"));
  for (const MaterialField& field : kMaterialFields) json.read(field.key, material.*field.value);
  if (json.has("max_stretch")) in_range(json.at("max_stretch"), 0, 1e6);
  for (const auto* key : {"stiffness", "bend_stiffness", "verlet_damping"}) {
    if (json.has(key)) in_range(json.at(key), 0, 1);
  }
  checked([&] { check(material, json.where()); });
  return material;
}

/// Keys, each later than the one before.
/// @param read  one of them but for its time
template <class Key, class Read>
std::vector<Key> read_keys(const JsonReader& json, const Read& read) {
  std::vector<Key> motion;
  for (const JsonReader& entry : json.elements()) {
    Key key = read(entry);
    key.time = entry.at("time").number();
    if (!motion.empty() && !(key.time > motion.back().time)) entry.at("time").fail("must be later than the key before");
    motion.push_back(std::move(key));
  }
  return motion;
}

/// A preset's name, or an object with the fields that differ from what is usual (or from its "preset"), and keys.
/// @param of  a SceneCloth or a SceneFabric
template <class Of>
void read_material(const JsonReader& json, const Material& usual, Of& of) {
  if (json.is_string()) {
    of.material = preset_named(json);
    return;
  }
  of.material = read_material_fields(json, usual, "motion");
  if (!json.has("motion")) return;
  of.material_motion = read_keys<MaterialKey>(json.at("motion"), [&](const JsonReader& entry) {
    return MaterialKey{0, read_material_fields(entry, of.material, "time")};
  });
}

/// A number, or keys.
void read_pressure(const JsonReader& json, SceneCloth& cloth) {
  const auto pressure = [](const JsonReader& number) {
    return static_cast<float>(in_range(number, -kLargestPressure, kLargestPressure));
  };
  if (!json.is_array()) {
    cloth.pressure = pressure(json);
    return;
  }
  cloth.pressure_motion = read_keys<PressureKey>(json, [&](const JsonReader& entry) {
    entry.expect_object({"time", "pressure"});
    return PressureKey{0, pressure(entry.at("pressure"))};
  });
}

std::optional<SceneSewing> read_sewing(const JsonReader& json) {
  if (!json.is_object()) return json.boolean() ? std::optional<SceneSewing>(SceneSewing{}) : std::nullopt;
  json.expect_object({"start", "duration", "weightless"});
  constexpr double kLongest = 1e4;  // [s]
  SceneSewing sewing;
  if (json.has("start")) sewing.start = in_range(json.at("start"), 0, kLongest);
  if (json.has("duration")) sewing.duration = in_range(json.at("duration"), 0, kLongest);
  if (json.has("weightless")) sewing.weightless = json.at("weightless").boolean();
  return sewing;
}

Transform read_transform(const JsonReader& json) {
  json.expect_object({"translate", "rotate_deg", "scale"});
  Transform transform;
  json.read("translate", transform.translate);
  if (json.has("rotate_deg")) transform.rotate = quat_from_euler_deg(json.at("rotate_deg").vector());
  json.read("scale", transform.scale);
  checked([&] { check(transform, json.where()); });
  return transform;
}

Where read_where(const JsonReader& json) {
  const std::vector<std::string_view> keys{"top", "boundary", "box", "sphere", "vertices", "vertex_group", "material"};
  json.expect_object(keys);
  const auto given = std::count_if(keys.begin(), keys.end(), [&](auto key) { return json.has(key); });
  if (given != 1) json.fail("must have exactly one of top, boundary, box, sphere, vertices, vertex_group, material");

  if (json.has("top")) return WhereTop{static_cast<float>(in_range(json.at("top"), 0, 1))};
  if (json.has("boundary")) {
    const JsonReader boundary = json.at("boundary");
    if (!boundary.is_string()) return WhereBoundary{boundary.count(0, kMaxImageSide)};
    if (boundary.text() != "highest") boundary.fail("must be a loop's number, longest first, or \"highest\"");
    return WhereBoundary{};
  }
  if (json.has("box")) {
    const std::vector<JsonReader> corners = json.at("box").elements();
    if (corners.size() != 2) json.at("box").fail("must be two corners [[x,y,z],[x,y,z]]");
    const WhereBox box{corners[0].vector(), corners[1].vector()};
    if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z) {
      json.at("box").fail("the first corner must not exceed the second in any component");
    }
    return box;
  }
  if (json.has("sphere")) {
    const JsonReader sphere = json.at("sphere");
    sphere.expect_object({"center", "radius"});
    const WhereSphere where{sphere.at("center").vector(), sphere.at("radius").real()};
    if (!(where.radius > 0)) sphere.at("radius").fail("must be above 0");
    return where;
  }
  if (json.has("vertices")) {
    WhereVertices where;
    for (const JsonReader& id : json.at("vertices").elements()) {
      where.source_vertex.push_back(id.count(0, kNoPixel - 1));
    }
    return where;
  }
  if (json.has("material")) return WhereMaterial{json.at("material").text()};
  return WhereVertexGroup{json.at("vertex_group").text()};
}

PaintChannel read_paint_channel(const JsonReader& json) {
  const std::string name = json.text();
  for (const PaintChannel channel : kPaintChannels)
    if (name == to_string(channel)) return channel;
  json.fail("must be red, green, blue or alpha");
}

/// @param high  [m] that it may be
PaintedNumber read_painted(const JsonReader& json, double high) {
  PaintedNumber r{read_paint_channel(json.at("painted")), 0, 0};
  if (json.has("least")) r.least = static_cast<float>(in_range(json.at("least"), 0, high));
  r.most = static_cast<float>(in_range(json.at("most"), 0, high));
  return r;
}

MaxDistance read_max_distance(const JsonReader& json) {
  if (!json.is_object()) return {static_cast<float>(in_range(json, 0, kLargestPinDistance)), 0};
  json.expect_object({"least", "per_metre", "painted", "most"});
  if (json.has("painted") == json.has("per_metre"))
    json.fail("must be a number, or have per_metre, or painted and most");
  if (json.has("painted")) return {0, 0, read_painted(json, kLargestPinDistance)};
  if (json.has("most")) json.at("most").fail("goes with painted, not with per_metre");
  const auto distance = [&](const char* key) {
    return static_cast<float>(in_range(json.at(key), 0, kLargestPinDistance));
  };
  return {json.has("least") ? distance("least") : 0, distance("per_metre")};
}

SceneBackstop read_backstop(const JsonReader& json) {
  if (!json.is_object()) return {.distance = static_cast<float>(in_range(json, 0, kLargestBackstop))};
  json.expect_object({"distance", "radius", "painted", "least", "most"});
  if (json.has("painted") == json.has("distance")) json.fail("must be a number, or have distance, or painted and most");
  SceneBackstop r;
  if (json.has("painted")) {
    r.painted = read_painted(json, kLargestBackstop);
  } else {
    for (const auto* key : {"least", "most"})
      if (json.has(key)) json.at(key).fail("goes with painted, not with distance");
    r.distance = static_cast<float>(in_range(json.at("distance"), 0, kLargestBackstop));
  }
  if (json.has("radius")) r.radius = static_cast<float>(in_range(json.at("radius"), 1e-4, kLargestBackstop));
  return r;
}

ScenePin read_pin(const JsonReader& json) {
  json.expect_object({"where", "follow", "motion", "pivot", "from", "until", "frequency", "max_distance", "backstop"});
  ScenePin pin;
  pin.where = read_where(json.at("where"));
  json.read("follow", pin.follow);
  pin.motion = read_motion_of(json);
  pin.pivot = read_pivot(json);
  if (json.has("from")) pin.from = in_range(json.at("from"), 0, kLongestTime);
  if (json.has("until")) pin.until = in_range(json.at("until"), 0, kLongestTime);
  if (pin.until <= pin.from) json.at("until").fail("must be later than \"from\"");
  if (json.has("frequency")) pin.frequency = static_cast<float>(in_range(json.at("frequency"), 0, 1000));
  if (json.has("max_distance")) pin.max_distance = read_max_distance(json.at("max_distance"));
  if (json.has("backstop")) pin.backstop = read_backstop(json.at("backstop"));
  if (pin.backstop && !pin.max_distance)
    json.at("backstop").fail("is for points that are free within a distance; give the pin a \"max_distance\"");
  return pin;
}

SceneCut read_cut(const JsonReader& json) {
  json.expect_object({"time", "triangle"});
  SceneCut cut;
  cut.time = in_range(json.at("time"), 0, kLongestTime);
  const std::vector<JsonReader> corners = json.at("triangle").elements();
  if (corners.size() != 3) json.at("triangle").fail("must be three corners [[x,y,z],[x,y,z],[x,y,z]]");
  for (size_t i = 0; i < 3; ++i) cut.triangle[i] = corners[i].vector();
  checked([&] { check_cut(cut.triangle, json.where()); });
  return cut;
}

/// true, false, or an object with what differs from the defaults.
template <class Collision>
std::optional<Collision> read_cloth_collision(const JsonReader& json) {
  if (!json.is_object()) return json.boolean() ? std::optional<Collision>(Collision{}) : std::nullopt;
  json.expect_object({"distance"});
  Collision collision;
  json.read("distance", collision.distance);
  if (collision.distance < 0 && json.has("distance")) json.at("distance").fail("must be above 0");
  checked([&] { check_distance(collision.distance, json.where()); });
  return collision;
}

/// Of something in a mesh file.
std::string name_or_number(const JsonReader& json) {
  return json.is_string() ? json.text() : std::to_string(json.count(0, 1'000'000));
}

constexpr std::string_view kPointCaches = "a point cache (.pc2 or .mdd)";

bool is_point_cache(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending == ".pc2" || ending == ".mdd";
}

/// What of an animation only point caches have.
void read_cache(const JsonReader& json, const std::filesystem::path& folder, BodyAnimation& animation) {
  constexpr double kSlowest = 1e-3, kFastest = 1e5;
  if (!json.has("file")) {
    for (const auto* key : {"rate", "transform"})
      if (json.has(key)) json.at(key).fail("is for " + std::string(kPointCaches) + ", which \"file\" names");
    return;
  }
  animation.cache = folder / std::filesystem::path(json.at("file").text());
  if (!is_point_cache(animation.cache)) json.at("file").fail("must name " + std::string(kPointCaches));
  if (json.has("clip")) json.at("clip").fail("is an animation of the mesh file; the point cache is in its place");
  if (json.has("rate")) animation.rate = in_range(json.at("rate"), kSlowest, kFastest);
  if (json.has("transform")) animation.cache_transform = read_transform(json.at("transform"));
}

BodyAnimation read_animation(const JsonReader& json, const std::filesystem::path& folder) {
  constexpr double kLongest = 1e6, kFastest = 1e3, kSlowest = 1e-3;
  BodyAnimation animation;
  if (!json.is_object()) {
    animation.clip = name_or_number(json);
    if (!is_point_cache(animation.clip)) return animation;
    animation.cache = folder / std::exchange(animation.clip, {});
    return animation;
  }
  json.expect_object({"clip", "file", "rate", "transform", "start", "speed", "loop"});
  if (json.has("clip")) animation.clip = name_or_number(json.at("clip"));
  read_cache(json, folder, animation);
  if (json.has("start")) animation.start = in_range(json.at("start"), 0, kLongest);
  if (json.has("speed")) animation.speed = in_range(json.at("speed"), kSlowest, kFastest);
  if (json.has("loop")) animation.loop = json.at("loop").boolean();
  return animation;
}

constexpr std::array<std::string_view, 4> kBodyKeys{"file", "parts", "transform", "animation"};

/// A body in a mesh file.
SceneMesh read_body(const JsonReader& json, const std::filesystem::path& folder) {
  if (json.at("file").text().empty()) json.at("file").fail("must name a mesh file");
  SceneMesh mesh{.file = folder / std::filesystem::path(json.at("file").text())};
  if (json.has("parts")) mesh.parts = name_or_number(json.at("parts"));
  if (json.has("transform")) mesh.transform = read_transform(json.at("transform"));
  if (json.has("animation")) mesh.animation = read_animation(json.at("animation"), folder);
  return mesh;
}

SceneMesh read_skin(const JsonReader& json, const std::filesystem::path& folder) {
  json.expect_object({kBodyKeys.begin(), kBodyKeys.end()});
  SceneMesh skin = read_body(json, folder);
  skin.animation = read_animation(json.at("animation"), folder);  // which must be there
  return skin;
}

/// A file, or an object with one.
SceneStart read_start(const JsonReader& json, const std::filesystem::path& folder) {
  constexpr uint32_t kMostFrames = 100'000'000;
  const JsonReader file = json.is_object() ? json.at("file") : json;
  if (file.text().empty()) file.fail("must name a mesh file or a point cache");
  SceneStart start{.file = folder / std::filesystem::path(file.text())};
  if (!json.is_object()) return start;
  json.expect_object({"file", "frame", "moving", "transform"});
  if (json.has("frame")) start.frame = json.at("frame").count(0, kMostFrames);
  if (json.has("moving")) start.moving = json.at("moving").boolean();
  if (json.has("transform")) start.transform = read_transform(json.at("transform"));
  return start;
}

/// What a material has that is the whole cloth's.
void expect_fabric_only(const JsonReader& json) {
  if (!json.is_object()) return;
  for (const MaterialField& field : kMaterialFields) {
    if (field.use != MaterialUse::fabric && json.has(field.key))
      json.at(field.key).fail("is of the whole cloth; say it in the cloth's \"material\"");
  }
  if (!json.has("motion")) return;
  for (const JsonReader& key : json.at("motion").elements()) expect_fabric_only(key);
}

SceneFabric read_fabric(const JsonReader& json, const SceneCloth& cloth) {
  json.expect_object({"where", "width", "material"});
  SceneFabric fabric{.where = read_where(json.at("where"))};
  if (json.has("width")) fabric.width = static_cast<float>(in_range(json.at("width"), 0, double{kLargestLength}));
  const JsonReader material = json.at("material");
  expect_fabric_only(material);
  read_material(material, cloth.material, fabric);
  return fabric;
}

SceneCloth read_cloth(const JsonReader& json, const std::filesystem::path& folder) {
  expect_no_placing(json);
  json.expect_object({"asset", "material", "fabrics", "transform", "inertia_scale", "motion", "pins", "skin", "start",
                      "cuts", "tear", "gravity_scale", "wind_scale", "pressure", "sewing", "self_collision",
                      "inter_collision", "collides_with", "ignores"});
  SceneCloth cloth;
  const std::string asset = json.at("asset").text();
  if (asset.empty()) json.at("asset").fail("must name an asset file");
  cloth.asset = folder / std::filesystem::path(asset);
  if (json.has("material")) read_material(json.at("material"), {}, cloth);
  if (json.has("fabrics")) {
    for (const JsonReader& fabric : json.at("fabrics").elements()) cloth.fabrics.push_back(read_fabric(fabric, cloth));
  }
  if (json.has("transform")) cloth.transform = read_transform(json.at("transform"));
  cloth.motion = read_motion_of(json);
  if (json.has("inertia_scale")) {
    cloth.inertia_scale = json.at("inertia_scale").vector();
    checked([&] { check_parent({}, cloth.inertia_scale, json.at("inertia_scale").where()); });
  }
  if (json.has("self_collision")) cloth.self_collision = read_cloth_collision<SelfCollision>(json.at("self_collision"));
  if (json.has("inter_collision"))
    cloth.inter_collision = read_cloth_collision<InterCollision>(json.at("inter_collision"));
  if (json.has("pins")) {
    for (const JsonReader& pin : json.at("pins").elements()) cloth.pins.push_back(read_pin(pin));
  }
  if (json.has("skin")) cloth.skin = read_skin(json.at("skin"), folder);
  if (json.has("start")) cloth.start = read_start(json.at("start"), folder);
  if (json.has("tear")) {
    json.read("tear", cloth.tear);
    checked([&] { check_tear(cloth.tear, json.at("tear").where()); });
  }
  if (json.has("gravity_scale")) {
    json.read("gravity_scale", cloth.gravity_scale);
    checked([&] { check_gravity_scale(cloth.gravity_scale, json.at("gravity_scale").where()); });
  }
  if (json.has("wind_scale")) {
    json.read("wind_scale", cloth.wind_scale);
    checked([&] { check_wind_scale(cloth.wind_scale, json.at("wind_scale").where()); });
  }
  if (json.has("pressure")) read_pressure(json.at("pressure"), cloth);
  if (json.has("sewing")) {
    cloth.sewing = read_sewing(json.at("sewing"));
    cloth.names_sewing = cloth.sewing.has_value();
  }
  if (json.has("cuts")) {
    for (const JsonReader& cut : json.at("cuts").elements()) cloth.cuts.push_back(read_cut(cut));
  }
  return cloth;
}

Quat read_rotation(const JsonReader& json) {
  return json.has("rotate_deg") ? quat_from_euler_deg(json.at("rotate_deg").vector()) : Quat{};
}

ColliderShape read_plane(const JsonReader& json) {
  const Vec3 normal = json.at("normal").vector();
  if (!(length(normal) > 0) || !std::isfinite(length(normal))) json.at("normal").fail("must have a direction");
  return Plane{json.at("point").vector(), normalized(normal)};
}
ColliderShape read_sphere(const JsonReader& json) {
  return Sphere{json.at("center").vector(), json.at("radius").real()};
}
ColliderShape read_capsule(const JsonReader& json) {
  Capsule capsule{json.at("a").vector(), json.at("b").vector(), json.at("radius").real(), 0};
  capsule.radius_b = json.has("radius_b") ? json.at("radius_b").real() : capsule.radius_a;
  return capsule;
}
ColliderShape read_box(const JsonReader& json) {
  return Box{json.at("center").vector(), json.at("half_extents").vector(), read_rotation(json)};
}
ColliderShape read_ellipsoid(const JsonReader& json) {
  return Ellipsoid{json.at("center").vector(), json.at("radii").vector(), read_rotation(json)};
}

std::vector<Vec3> read_points(const JsonReader& json) {
  std::vector<Vec3> points;
  for (const JsonReader& point : json.elements()) {
    points.push_back(point.vector());
    checked([&] { check_position(points.back(), point.where()); });
  }
  return points;
}

/// Runs a builder of a solid; what it complains of is at this place of the file.
template <class Build>
Convex built_at(const JsonReader& json, const Build& build) {
  try {
    return build();
  } catch (const Error& error) {
    json.fail(error.what());
  }
}

ColliderShape read_convex(const JsonReader& json) {
  if (json.has("points") == json.has("planes")) json.fail("a convex collider needs either points or planes");
  if (json.has("points")) {
    const std::vector<Vec3> points = read_points(json.at("points"));
    return built_at(json.at("points"), [&] { return convex_hull(points); });
  }
  std::vector<Plane> planes;
  for (const JsonReader& plane : json.at("planes").elements()) {
    plane.expect_object({"point", "normal"});
    planes.push_back(std::get<Plane>(read_plane(plane)));
    checked([&] { check_position(planes.back().point, plane.where() + ".point"); });
  }
  return built_at(json.at("planes"), [&] { return convex_of_planes(planes); });
}
/// Its file is read when the scene is played.
ColliderShape read_mesh(const JsonReader&) {
  return MeshSolid{};
}

std::vector<std::string_view> mesh_keys() {
  std::vector<std::string_view> keys(kBodyKeys.begin(), kBodyKeys.end());
  keys.emplace_back("spacing");
  return keys;
}

struct ShapeReader {
  std::string_view name;
  std::vector<std::string_view> keys;
  ColliderShape (*read)(const JsonReader&);
};
const std::vector<ShapeReader>& shape_readers() {
  static const std::vector<ShapeReader> readers{{"plane", {"point", "normal"}, read_plane},
                                                {"sphere", {"center", "radius"}, read_sphere},
                                                {"capsule", {"a", "b", "radius", "radius_b"}, read_capsule},
                                                {"box", {"center", "half_extents", "rotate_deg"}, read_box},
                                                {"ellipsoid", {"center", "radii", "rotate_deg"}, read_ellipsoid},
                                                {"convex", {"points", "planes"}, read_convex},
                                                {"mesh", mesh_keys(), read_mesh}};
  return readers;
}

SceneCollider read_collider(const JsonReader& json, const std::filesystem::path& folder) {
  if (!json.is_object()) json.expect_object({});
  const std::string shape = json.at("shape").text();
  std::vector<std::string_view> names;
  for (const ShapeReader& reader : shape_readers()) {
    names.push_back(reader.name);
    if (reader.name != shape) continue;
    std::vector<std::string_view> keys{"name", "shape", "friction", "motion", "pivot"};
    keys.insert(keys.end(), reader.keys.begin(), reader.keys.end());
    if (reader.read == read_mesh) expect_no_placing(json);
    json.expect_object(keys);
    SceneCollider collider;
    json.read("name", collider.collider.name);
    json.read("friction", collider.collider.friction);
    collider.collider.shape = reader.read(json);
    collider.motion = read_motion_of(json);
    collider.center = read_pivot(json);
    if (std::holds_alternative<MeshSolid>(collider.collider.shape)) {
      collider.mesh = read_body(json, folder);
      if (json.has("spacing")) collider.field_spacing = static_cast<float>(in_range(json.at("spacing"), 1e-6, 1e4));
    } else {
      checked([&] { check(collider.collider, json.where()); });
    }
    return collider;
  }
  json.at("shape").fail("there is no shape " + in_quotes(shape) + nearest_and_all(shape, names));
}

Wind read_wind(const JsonReader& json) {
  json.expect_object({"velocity", "turbulence", "frequency", "drag", "lift", "motion"});
  Wind wind;
  json.read("velocity", wind.velocity);
  json.read("turbulence", wind.turbulence);
  json.read("frequency", wind.frequency);
  json.read("drag", wind.drag);
  json.read("lift", wind.lift);
  checked([&] { check(wind, json.where()); });
  return wind;
}

/// @param wind  what a key does not say is as there
std::vector<WindKey> read_wind_motion(const JsonReader& json, const Wind& wind) {
  return read_keys<WindKey>(json, [&](const JsonReader& entry) {
    entry.expect_object({"time", "velocity", "turbulence"});
    WindKey key{0, wind.velocity, wind.turbulence};
    entry.read("velocity", key.velocity);
    entry.read("turbulence", key.turbulence);
    checked([&] { check(Wind{.velocity = key.velocity, .turbulence = key.turbulence}, entry.where()); });
    return key;
  });
}

/// The keys before and after a time, and how far between them it is, 0..1. There is one at least.
template <class Key>
std::tuple<const Key&, const Key&, float> keys_about(const std::vector<Key>& motion, double time) {
  const auto after = std::ranges::upper_bound(motion, time, {}, &Key::time);
  const Key& b = after == motion.end() ? motion.back() : *after;
  const Key& a = after == motion.begin() ? b : *(after - 1);
  return {a, b, b.time > a.time ? static_cast<float>((time - a.time) / (b.time - a.time)) : 0.F};
}

/// @param of  a SceneCloth or a SceneFabric
template <class Of>
Material material_of(const Of& of, double time) {
  if (of.material_motion.empty()) return of.material;
  const auto [a, b, t] = keys_about(of.material_motion, time);
  return mix(a.material, b.material, t);
}

/// Collider names are what pins refer to: each once, and not one of the words with a meaning of their own.
void check_names(const Scene& scene, const JsonReader& json) {
  const bool skins = std::ranges::any_of(scene.cloths, [](const SceneCloth& cloth) { return cloth.skin.has_value(); });
  std::vector<std::string_view> known{"cloth", "world"};
  for (size_t i = 0; i < scene.colliders.size(); ++i) {
    const std::string& name = scene.colliders[i].collider.name;
    if (name.empty()) continue;
    if (std::find(known.begin(), known.end(), name) != known.end() || (skins && name == "skin")) {
      json.at("colliders").elements()[i].at("name").fail("the name \"" + name + "\" is taken");
    }
    known.push_back(name);
  }
  for (size_t c = 0; c < scene.cloths.size(); ++c) {
    for (size_t p = 0; p < scene.cloths[c].pins.size(); ++p) {
      const std::string& follow = scene.cloths[c].pins[p].follow;
      if (std::find(known.begin(), known.end(), follow) != known.end()) continue;
      if (follow == "skin" && scene.cloths[c].skin) continue;
      json.at("cloths").elements()[c].at("pins").elements()[p].at("follow").fail(
          follow == "skin" ? "its cloth has no \"skin\""
                           : "there is no collider " + in_quotes(follow) + nearest_and_all(follow, known));
    }
  }
}

Vec3 middle_of_bounds(const TriangleSurface& surface) {
  const SurfaceBounds bounds = bounds_of(surface);
  return 0.5F * (bounds.low + bounds.high);
}

/// Centre about which a collider's motion turns it.
struct ShapeCenter {
  Vec3 operator()(const Plane& s) const { return s.point; }
  Vec3 operator()(const Sphere& s) const { return s.center; }
  Vec3 operator()(const Capsule& s) const { return 0.5F * (s.a + s.b); }
  Vec3 operator()(const Box& s) const { return s.center; }
  Vec3 operator()(const Ellipsoid& s) const { return s.center; }
  Vec3 operator()(const Convex& s) const {
    return s.surface.triangle.empty() ? s.planes.front().point : middle_of_bounds(s.surface);
  }
  Vec3 operator()(const MeshSolid& s) const { return s.field ? middle_of_bounds(s.field->surface) : Vec3{}; }
};

void set_cache_rates(Scene& scene) {
  const auto set_rate = [&](std::optional<SceneMesh>& mesh) {
    if (mesh && mesh->animation) mesh->animation->scene_rate = scene.frame_rate;
  };
  for (SceneCloth& cloth : scene.cloths) set_rate(cloth.skin);
  for (SceneCollider& collider : scene.colliders) set_rate(collider.mesh);
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& path) {
  const nlohmann::json document = JsonReader::parse(text, path.string());
  const JsonReader json(document, path.string());
  json.expect_object({"version", "frame_rate", "frames", "substeps", "relaxation_steps", "keep_momentum", "gravity",
                      "imperfection", "cloths", "colliders", "contact_forces", "wind", "sleep"});
  if (const double version = json.at("version").number(); version != 1) {
    json.at("version").fail("only version 1 is known", ErrorCode::unsupported);
  }
  Scene scene;
  scene.path = path;
  if (json.has("frame_rate")) scene.frame_rate = in_range(json.at("frame_rate"), 0.1, 10000);
  if (json.has("frames")) scene.frames = json.at("frames").count(0, 10'000'000);
  if (json.has("substeps")) scene.substeps = json.at("substeps").count(1, 256);
  if (json.has("relaxation_steps")) scene.relaxation_steps = json.at("relaxation_steps").count(1, 256);
  if (json.has("keep_momentum")) scene.keep_momentum = json.at("keep_momentum").boolean();
  json.read("gravity", scene.gravity);
  checked([&] { check_gravity(scene.gravity, json.where()); });
  if (json.has("imperfection")) scene.imperfection = static_cast<float>(in_range(json.at("imperfection"), 0, 0.01));
  for (const JsonReader& cloth : json.at("cloths").elements()) {
    scene.cloths.push_back(read_cloth(cloth, path.parent_path()));
  }
  if (scene.cloths.empty()) json.at("cloths").fail("must name at least one cloth");
  if (json.has("colliders")) {
    for (const JsonReader& collider : json.at("colliders").elements()) {
      scene.colliders.push_back(read_collider(collider, path.parent_path()));
    }
  }
  if (json.has("contact_forces")) scene.contact_forces = json.at("contact_forces").boolean();
  if (json.has("wind")) {
    const JsonReader wind = json.at("wind");
    scene.wind = read_wind(wind);
    if (wind.has("motion")) scene.wind_motion = read_wind_motion(wind.at("motion"), *scene.wind);
  }
  if (json.has("sleep")) {
    const JsonReader sleep = json.at("sleep");
    sleep.expect_object({"speed", "time"});
    scene.sleep_speed = static_cast<float>(in_range(sleep.at("speed"), 0, 1e4));
    if (sleep.has("time")) scene.sleep_time = static_cast<float>(in_range(sleep.at("time"), 0, 1e6));
  }
  check_names(scene, json);
  read_collision_groups(json, scene);
  set_cache_rates(scene);
  return scene;
}

Scene read_scene(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw Error(ErrorCode::io, path.string() + ": is a directory; a scene is a JSON file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::io, path.string() + ": cannot be opened; does the scene file exist?");
  const auto size = std::filesystem::file_size(path, error);
  if (!error && size > kLargestSceneFile) {
    throw Error(ErrorCode::limit, path.string() + ": is larger than 64 MiB, which no scene is");
  }
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (file.bad()) throw Error(ErrorCode::io, path.string() + ": cannot be read");
  return parse_scene(text, path);
}

Scene default_scene(const std::filesystem::path& asset) {
  Scene scene;
  scene.path = asset;
  SceneCloth cloth;
  cloth.asset = asset;
  cloth.pins.push_back({WhereHanger{}, "cloth", {}});
  scene.cloths.push_back(std::move(cloth));
  return scene;
}

Material material_at(const SceneCloth& cloth, double time) {
  return material_of(cloth, time);
}
Material material_at(const SceneFabric& fabric, double time) {
  return material_of(fabric, time);
}

Vec3 gravity_of(const Scene& scene, const SceneCloth& cloth) {
  return cloth.gravity_scale * scene.gravity;
}

float pressure_at(const SceneCloth& cloth, double time) {
  if (cloth.pressure_motion.empty()) return cloth.pressure;
  const auto [a, b, t] = keys_about(cloth.pressure_motion, time);
  return a.pressure + t * (b.pressure - a.pressure);
}

Wind wind_at(const Scene& scene, double time) {
  Wind wind = scene.wind.value_or(Wind{});
  if (scene.wind_motion.empty()) return wind;
  const auto [a, b, t] = keys_about(scene.wind_motion, time);
  wind.velocity = a.velocity + t * (b.velocity - a.velocity);
  wind.turbulence = a.turbulence + t * (b.turbulence - a.turbulence);
  return wind;
}

bool carrier_teleports(const Scene& scene, const std::string& follow, double from, double to) {
  return std::any_of(scene.colliders.begin(), scene.colliders.end(), [&](const SceneCollider& c) {
    return c.collider.name == follow && teleports(c.motion, from, to);
  });
}

Collider collider_at(const SceneCollider& collider, double time) {
  Collider result = collider.collider;
  if (collider.motion.empty()) return result;
  const Transform motion = pose_at(collider.motion, time);
  const Vec3 center = collider.center ? *collider.center : std::visit(ShapeCenter{}, collider.collider.shape);
  const Transform about_center{motion.translate + (center - rotate(motion.rotate, center)), motion.rotate, 1};
  result.pose = compose(about_center, collider.collider.pose);
  return result;
}

}  // namespace geocloth
