// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "geocloth/solver/solver.h"

namespace geocloth {

/// Which points of a cloth a pin holds; see "where" in the scene file.
struct WhereTop {
  float share;
};  ///< the highest share of the bounding box's height, at rest in the scene
struct WhereBoundary {
  std::optional<uint32_t> index;
};  ///< boundary loop, longest first; not set: the highest one
/// What a garment hangs by if nothing is said: of every connected part the highest boundary; where that goes far down,
/// is in its lower half (a hat's) or there is none, the highest 2 % of the part; of a level sheet one end.
struct WhereHanger {};
struct WhereBox {
  Vec3 min, max;
};
struct WhereSphere {
  Vec3 center;
  float radius;
};
struct WhereVertices {
  std::vector<uint32_t> source_vertex;
};
struct WhereVertexGroup {
  std::string name;
};
/// What the file has of a material, by its name.
struct WhereMaterial {
  std::string name;
};
using Where = std::variant<WhereTop, WhereBoundary, WhereBox, WhereSphere, WhereVertices, WhereVertexGroup,
                           WhereMaterial, WhereHanger>;

/// One of the numbers of what vertices are painted in.
enum class PaintChannel : uint8_t { red, green, blue, alpha };
inline constexpr std::array kPaintChannels{PaintChannel::red, PaintChannel::green, PaintChannel::blue,
                                           PaintChannel::alpha};
[[nodiscard]] const char* to_string(PaintChannel channel);
/// A number that is painted on a garment: `least` where that channel of its vertices' paint is 0, `most` where it is 1,
/// in proportion between them; `most` may be below `least`.
struct PaintedNumber {
  PaintChannel channel = PaintChannel::red;
  float least = 0, most = 0;
};

/// How far the points of a pin may be from where it would hold them. All of a garment's points may have one on the
/// skin: little where it is tight, more where it is free to swing.
struct MaxDistance {
  float least = 0;      ///< [m] >= 0; where 0 comes out, the point is held as by any pin
  float per_metre = 0;  ///< [m] >= 0 more for every metre along the cloth from the nearest point that a pin holds
  std::optional<PaintedNumber> painted = {};  ///< [m] >= 0, in place of both
};

/// See Backstop, whose `outward` follows from the skin.
struct SceneBackstop {
  float distance = 0, radius = Backstop{}.radius;  ///< [m]
  std::optional<PaintedNumber> painted = {};       ///< [m] 0 to 100, in place of the distance
};

struct ScenePin {
  Where where;
  /// "cloth" (the cloth's motion), "skin" (the cloth's, too), "world" (stays), or a collider's name.
  std::string follow = "cloth";
  Motion motion;    ///< on top of what it follows; turns about the middle of the pin's points, or the pivot
  double from = 0;  ///< [s] above 0: the points are taken hold of then, where they are
  /// [s] They are let go when the last frame that ends by then has ended: as fast as the pin is, not as what of its
  /// motion is left in the next frame.
  double until = std::numeric_limits<double>::infinity();
  float frequency = 0;  ///< [1/s] above 0: soft, see Pin
  /// Set: the points are free within that distance of where they would be held. Points that pins without one have, too,
  /// are left to these, and parts of the cloth without a point that is held to no pin if the distance is per metre.
  std::optional<MaxDistance> max_distance = {};
  /// Only with a max_distance, and where the pin follows a skin or a collider that an animation deforms: outward is as
  /// its surface is there.
  std::optional<SceneBackstop> backstop = {};
  std::optional<Vec3> pivot = {};  ///< [m] as the cloth begins: its motion turns about it

  [[nodiscard]] bool holds() const { return !(frequency > 0) && !max_distance; }
  /// In a frame [s].
  [[nodiscard]] bool acts(double start, double end) const {
    constexpr double kRounding = 1e-9;
    return end > from && start < until && end <= until + kRounding;
  }
};

/// A cut by a triangle, see Solver::cut.
struct SceneCut {
  double time = 0;  ///< [s] >= 0: before the first frame that begins then or later
  std::array<Vec3, 3> triangle;
};

/// What deforms a body, and when: an animation of its file, or a point cache of all vertices of the file in its order.
struct BodyAnimation {
  std::string clip = {};             ///< its name or its number, from 0; empty: the first one; "*": all at once
  std::filesystem::path cache = {};  ///< .pc2 or .mdd, resolved against the scene file's folder; empty: a clip
  std::optional<double> rate = {};   ///< [1/s] > 0 frames of the cache; not set: as it says itself
  double scene_rate = 60;            ///< [1/s] where it does not say: as fast as the scene's
  Transform cache_transform = {};    ///< from the cache's coordinates to the file's
  /// [s] >= 0. Until then the body goes from how it stands in the file to the animation's first pose.
  double start = 0;
  double speed = 1;   ///< > 0
  bool loop = false;  ///< else it keeps its last pose
};
/// A body: of a collider of shape "mesh", say. It is read when the scene is played.
struct SceneMesh {
  std::filesystem::path file = {};  ///< resolved against the scene file's folder
  std::string parts = {};           ///< which parts of the file, as `convert --parts` takes them; empty: all
  Transform transform = {};         ///< from the file's coordinates to the scene's
  std::optional<BodyAnimation> animation = {};  ///< not set: the body keeps the shape that it has in the file
};

/// A keyframe of what a cloth is made of: between keys it is as mix() has it, held before the first and after the last.
struct MaterialKey {
  double time = 0;  ///< [s], ascending
  Material material = {};
};

/// Where a cloth is of another fabric, see Fabric.
struct SceneFabric {
  Where where;      ///< the corners of its cells
  float width = 0;  ///< [m] >= 0 along the cloth at rest: points so near to those are its corners, too
  Material material = {};
  std::vector<MaterialKey> material_motion = {};  ///< in place of `material`; empty: it stays
};

/// A keyframe of Solver::set_pressure, which is linear between keys and held before the first and after the last.
struct PressureKey {
  double time = 0;     ///< [s], ascending
  float pressure = 0;  ///< [Pa]
};

/// When the panels of a sewing pattern are drawn together, see Solver::set_sewing. They stay sewn.
struct SceneSewing {
  double start = 0;        ///< [s] >= 0
  double duration = 1;     ///< [s] >= 0 until seams are closed; they close evenly
  bool weightless = true;  ///< the cloth weighs nothing until seams are closed
};

/// How a cloth stands at the beginning, where that is not as it was converted.
struct SceneStart {
  std::filesystem::path file = {};     ///< a mesh or a point cache with the vertices that the asset was converted
                                       ///< from, or with those of its welded grid mesh
  std::optional<uint32_t> frame = {};  ///< of a point cache, from 0; not set: the last one
  bool moving = false;                 ///< as fast as it goes there from the frame before
  Transform transform = {};            ///< from the file's coordinates to the scene's
};

struct SceneCloth {
  std::filesystem::path asset;  ///< resolved against the scene file's folder
  Material material;
  std::vector<MaterialKey> material_motion;  ///< in place of `material`; empty: it stays
  std::vector<SceneFabric> fabrics;
  Transform transform;
  Motion motion;  ///< of the parent: the cloth starts at motion(0) * transform; pins with follow "cloth" take part
  Vec3 inertia_scale{1, 1, 1};  ///< see Solver::set_parent
  std::vector<ScenePin> pins;
  /// The garment as an animation moves it, in the asset's coordinates after the mesh's transform: what pins with follow
  /// "skin" ride on. It need not be closed, and nothing collides with it.
  std::optional<SceneMesh> skin = {};
  /// In place of where transform, motion and skin have it. Its shape at rest is the asset's; pins take hold of it
  /// there.
  std::optional<SceneStart> start = {};
  std::optional<SelfCollision> self_collision = {};    ///< see ClothDesc
  std::optional<InterCollision> inter_collision = {};  ///< see ClothDesc
  uint32_t meets = ~uint32_t{0};                       ///< see ClothDesc
  /// Of an asset with pixels to be sewn; none: they are left apart.
  std::optional<SceneSewing> sewing = SceneSewing{};
  bool names_sewing = false;  ///< the scene says that it is sewn: there has to be something to sew
  std::vector<SceneCut> cuts;
  float gravity_scale = 1;                   ///< see Solver::set_gravity_scale
  float wind_scale = 1;                      ///< see Solver::set_wind_scale
  float pressure = 0;                        ///< [Pa] see Solver::set_pressure
  std::vector<PressureKey> pressure_motion;  ///< in place of `pressure`; empty: it stays
  float tear = 0;                            ///< above 1: the stretch that it tears at, see Solver::tear; 0: never
};

/// Reads the triangles of a body, in the file's coordinates [m].
using ReadSurface = std::function<TriangleSurface(const SceneMesh&)>;
/// The garment in an asset, as it was in its file. @throws as read_asset; Error(unsupported) for only some of its parts
[[nodiscard]] TriangleSurface read_asset_surface(const SceneMesh& mesh);
/// A body that deforms.
struct MovingBody {
  std::vector<std::array<uint32_t, 3>> triangle;               ///< of all vertices; they stay
  std::function<std::vector<Vec3>(double time)> positions_at;  ///< [m] of all vertices at a time of the scene [s] >= 0
  /// [m] Of all vertices as the file opens, which garments are made for; empty: as at time 0.
  std::vector<Vec3> as_opened = {};
};
/// Of a mesh with an animation.
using ReadMovingBody = std::function<MovingBody(const SceneMesh&)>;
/// All vertices of a mesh in the order of their file, as they stand in a frame.
struct PosedVertices {
  std::vector<Vec3> position;        ///< [m]
  std::vector<Triangle> triangle{};  ///< of a mesh, which tell a grid from a mesh of as many vertices; else empty
  std::vector<Vec3> before = {};     ///< [m] in the frame before; empty where there is none
  std::optional<double> rate = {};   ///< [1/s] frames; not set: the file does not say
  double step = 1;                   ///< of those from one to the next that is in the file
};
/// Of a start.
using ReadVertices = std::function<PosedVertices(const SceneStart&)>;
/// How what a scene names is read, but for assets.
struct BodyReader {
  ReadSurface surface = read_asset_surface;
  ReadMovingBody moving = {};  ///< not set: scenes with animated bodies are refused
  ReadVertices vertices = {};  ///< not set: scenes with cloths that have a start are refused
};
/// Makes the solver of a simulation, on a device of the application say (make_vulkan_solver).
using MakeSolver = std::function<Solver(std::span<const ClothDesc>, const SolverSettings&)>;

struct SceneCollider {
  Collider collider;              ///< of a mesh without its field; Simulation::colliders() have it
  std::optional<Vec3> center;     ///< [m] in place of the shape's own: what is told, or of a body that deforms
  Motion motion;                  ///< turns about the centre (a plane's point, the middle of a capsule)
  std::optional<SceneMesh> mesh;  ///< of shape "mesh"
  float field_spacing = 0;        ///< [m] of the mesh's field of distances; 0: as many nodes as are usual
};

/// A keyframe of the wind, which is linear between keys and held before the first and after the last.
struct WindKey {
  double time = 0;  ///< [s], ascending
  Vec3 velocity = {};
  float turbulence = 0;
};

/// A scene file, version 1, checked.
struct Scene {
  std::filesystem::path path;
  double frame_rate = 60;  ///< [1/s]
  uint32_t frames = 120;
  uint32_t substeps = 16, relaxation_steps = 1;
  bool keep_momentum = false;  ///< see SolverSettings
  Vec3 gravity{0, -9.81F, 0};
  float imperfection = 0;  ///< see SolverSettings
  std::vector<SceneCloth> cloths;
  std::vector<SceneCollider> colliders;
  bool contact_forces = false;       ///< see SolverSettings
  float sleep_speed = 0;             ///< [m/s] see SolverSettings
  float sleep_time = 0.5F;           ///< [s]
  std::optional<Wind> wind;          ///< not set: no air at all; set: the air also brakes cloth when it stands still
  std::vector<WindKey> wind_motion;  ///< of `wind`; empty: it does not change
};

/// Parses a scene. Unknown keys are errors that name the nearest known key; wrong types and ranges name the JSON path.
/// @throws Error(io), Error(invalid_data), Error(unsupported) for what the file format has and this version does not do
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);
[[nodiscard]] Scene parse_scene(std::string_view text, const std::filesystem::path& path);

/// Hangs one asset for 120 frames, see WhereHanger.
[[nodiscard]] Scene default_scene(const std::filesystem::path& asset);

/// What a cloth, or a fabric of it, is made of at a time [s].
[[nodiscard]] Material material_at(const SceneCloth& cloth, double time);
[[nodiscard]] Material material_at(const SceneFabric& fabric, double time);

/// [Pa] What presses on a cloth at a time [s].
[[nodiscard]] float pressure_at(const SceneCloth& cloth, double time);

/// [m/s^2] What a cloth of a scene falls by, once its panels are sewn.
[[nodiscard]] Vec3 gravity_of(const Scene& scene, const SceneCloth& cloth);

/// The wind of a scene that has one, at a time [s].
[[nodiscard]] Wind wind_at(const Scene& scene, double time);

/// Whether the collider that pins follow by this name, if it is one's, jumps after `from` and until `to` [s].
[[nodiscard]] bool carrier_teleports(const Scene& scene, const std::string& follow, double from, double to);

/// The collider in its pose at a time [s].
[[nodiscard]] Collider collider_at(const SceneCollider& collider, double time);

/// Pixels that a selector takes, ascending, all copies included. @throws Error(invalid_data) when it selects none
[[nodiscard]] std::vector<uint32_t> select_pixels(const ClothAsset& asset, const Transform& transform,
                                                  const Where& where);

/// What the vertices are painted in, 0..1, at each of those pixels, in proportion within triangles of the mesh.
/// @throws Error(invalid_data) when the asset has no paint
[[nodiscard]] std::vector<float> paint_at(const ClothAsset& asset, PaintChannel channel,
                                          std::span<const uint32_t> pixels);

/// For every pixel the first one of the connected part that it is of, over springs and copies; itself where not valid.
[[nodiscard]] std::vector<uint32_t> connected_parts(const ClothAsset& asset);

/// A place beside a body's surface, which it keeps while the body deforms.
struct SurfacePlace {
  uint32_t triangle = 0;
  Vec3 corner_share;  ///< of the point of the triangle that it is nearest to
  Vec3 off;           ///< [m] from there, along the triangle's first side, across it, and along its normal
};
class MovingCollider;
class MovingSurface;
struct StartState;

/// A scene being played: assets loaded, pins chosen, keyframes evaluated frame by frame. A cloth all of whose pins jump
/// alike, by their own keys or by those of colliders that they follow, jumps with them (what hangs on the pins does).
class Simulation {
 public:
  /// Reads the assets and meshes that the scene names. Settings' substeps, relaxation_steps, keep_momentum,
  /// imperfection, frame_time and gravity come from the scene.
  /// @param make_solver  not set: the solver's own constructor
  Simulation(Scene scene, SolverSettings settings, const BodyReader& bodies = {}, const MakeSolver& make_solver = {});

  /// Advances one frame.
  void step();

  [[nodiscard]] uint32_t frame() const { return frame_; }  ///< frames done
  [[nodiscard]] double time() const;                       ///< [s]
  [[nodiscard]] const Scene& scene() const { return scene_; }
  /// Their assets and materials are the solver's: a cut gives a cloth another one, see Solver::asset, and keys another
  /// material.
  [[nodiscard]] const std::vector<ClothDesc>& cloths() const { return cloths_; }
  [[nodiscard]] std::vector<Collider> colliders() const;  ///< at time()
  [[nodiscard]] Solver& solver() { return *solver_; }

  /// A cut of the scene that was made.
  struct CutMade {
    uint32_t cloth, cut;  ///< cut: of SceneCloth::cuts
    CutResult result;
  };
  [[nodiscard]] const std::vector<CutMade>& cuts_made() const { return cuts_made_; }
  /// What has been torn of a cloth until now.
  [[nodiscard]] const CutResult& torn(uint32_t cloth) const { return torn_.at(cloth); }

  /// A wind in place of the scene's and its keyframes.
  void set_wind(const Wind& wind);
  /// A material of a cloth in place of the scene's and its keyframes. @throws as Solver::set_material
  void set_material(uint32_t cloth, const Material& material);
  /// The same of one of its fabrics. @throws as Solver::set_fabric
  void set_fabric(uint32_t cloth, uint32_t fabric, const Material& material);

  /// [m] How far the pins of a cloth that follow its skin are from it, at most, as they took hold; 0 without.
  [[nodiscard]] float farthest_from_skin(uint32_t cloth) const;

  /// Pixels that the pins of the scene hold at time(), if only softly, ascending, all copies included. Those that are
  /// free within a distance are not.
  [[nodiscard]] std::vector<uint32_t> held_pixels(uint32_t cloth) const;
  /// Pins beside those of the scene, and in place of them where both hold a pixel: a hand that drags the cloth. From
  /// the next step on, until the next call. @throws Error(invalid_argument) when there is no such cloth
  void set_hand(uint32_t cloth, std::vector<Pin> pins);

 private:
  void cut(double start);
  void sew(uint32_t cloth, double start);
  void update_pins();
  void jump(double start);

  Scene scene_;
  std::vector<ClothDesc> cloths_;
  struct PinSet {
    uint32_t cloth;
    ScenePin pin;
    std::vector<uint32_t> pixels;
    std::vector<Vec3> rest;  ///< positions in the scene at time 0, or where they were taken hold of, carried back to it
    Transform own_start;     ///< of the pin's motion, when they were taken hold of
    bool acts = false;
    std::vector<SurfacePlace> place = {};          ///< beside the body that they follow, if it deforms
    std::optional<SurfacePlace> pivot_place = {};  ///< the same of ScenePin::pivot
    std::vector<float> max_distance = {};          ///< [m] of a pin that has one
    std::vector<float> backstop = {};              ///< [m] its distance, of a pin that has one
  };
  void take_hold(PinSet& set, double start);
  [[nodiscard]] std::optional<StartState> posed(uint32_t cloth, const BodyReader& bodies,
                                                std::span<const Vec3> begins) const;
  void measure_distances(uint32_t cloth);
  void read_bodies(const BodyReader& bodies);
  void advance_bodies();
  /// The surface that pins follow, if it deforms.
  struct Carrier {
    const MovingSurface* surface = nullptr;
    Transform pose;  ///< from its coordinates to the scene's, but for what moves it as a whole
  };
  [[nodiscard]] Carrier moving_carrier(const PinSet& set) const;
  void attach(PinSet& set) const;
  /// [s] Of what moves a pin's points.
  struct PinTimes {
    double carrier, own;  ///< of what the pin follows, and of its own motion
  };
  struct PinPlace {
    Transform carried, own;
  };
  [[nodiscard]] PinTimes times_of_jump(const PinSet& set, double start) const;
  [[nodiscard]] PinPlace place_of(const PinSet& set, const PinTimes& times) const;
  [[nodiscard]] std::vector<Pin> pins_of(uint32_t cloth, double start, bool only_jumps) const;
  [[nodiscard]] Vec3 center_of(const PinSet& set, bool at_start) const;
  void add_pins(const PinSet& set, const PinPlace& place, bool at_start, std::vector<Pin>& pins) const;
  [[nodiscard]] std::optional<Transform> way_of_jump(uint32_t cloth, double start) const;

  std::vector<PinSet> pins_;
  std::vector<std::shared_ptr<MovingCollider>> moving_;  ///< of the colliders; null: it keeps its shape
  std::vector<std::shared_ptr<MovingSurface>> skins_;    ///< of the cloths; null: it has none
  std::vector<CutMade> cuts_made_;
  std::vector<CutResult> torn_;             ///< per cloth
  std::vector<std::optional<float>> gaps_;  ///< per cloth: share that its seams were open by when sewing began
  std::vector<std::vector<Pin>> hands_;     ///< per cloth
  std::unique_ptr<Solver> solver_;
  uint32_t frame_ = 0;
};

}  // namespace geocloth
