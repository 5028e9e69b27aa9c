// SPDX-License-Identifier: GPL-3.0-or-later
#include "random_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "solver_fixture.h"

namespace geocloth::test {
namespace {

class Chance {
 public:
  explicit Chance(uint32_t seed) : random_(seed) {}
  uint32_t below(uint32_t count) { return static_cast<uint32_t>(random_()) % count; }
  bool happens(float share) { return within(0, 1) < share; }
  float within(float low, float high) { return low + (high - low) * static_cast<float>(below(100'001)) / 100'000.F; }
  /// Of any order of magnitude between powers of e.
  float power(float low, float high) { return std::exp(within(low, high)); }
  Vec3 vector(float most) { return {within(-most, most), within(-most, most), within(-most, most)}; }
  Vec3 direction() {
    const Vec3 v = vector(1);
    return length(v) > 0.1F ? normalized(v) : Vec3{0, 1, 0};
  }
  Quat turn() { return quat_from_euler_deg(vector(180)); }

 private:
  std::mt19937 random_;
};

/// Some of its pixels are to be sewn to others.
void add_sewing(Chance& chance, ClothAsset& asset) {
  for (uint32_t left = chance.below(40); left > 0; --left) {
    const uint32_t a = chance.below(asset.pixel_count()), b = chance.below(asset.pixel_count());
    if (a != b && asset.valid(a) && asset.valid(b)) asset.sewing.push_back({a, b});
  }
}

ClothAsset any_shape_of_cloth(Chance& chance) {
  const uint32_t charts_x = 1 + chance.below(3), charts_y = 1 + chance.below(2);
  if (chance.happens(0.3F)) {
    return make_tube({.nx = 6 + chance.below(14),
                      .ny = 4 + chance.below(12),
                      .radius = chance.within(0.1F, 0.4F),
                      .height = chance.within(0.3F, 1),
                      .charts_x = charts_x,
                      .charts_y = charts_y});
  }
  return make_sheet({.nx = 6 + chance.below(24),
                     .ny = 4 + chance.below(20),
                     .charts_x = charts_x,
                     .charts_y = charts_y,
                     .gap = 1 + chance.below(3),
                     .horizontal = chance.happens(0.5F),
                     .jitter = chance.within(0, 0.3F)});
}

ClothAsset any_asset(Chance& chance) {
  ClothAsset asset = any_shape_of_cloth(chance);
  if (chance.happens(0.3F)) add_sewing(chance, asset);
  return asset;
}

Material any_material(Chance& chance) {
  Material m;
  if (chance.happens(0.4F))
    m = material_presets()[chance.below(static_cast<uint32_t>(material_presets().size()))].material;
  if (chance.happens(0.5F)) {
    m.areal_density = chance.power(-3, 0);
    m.stretch_warp = chance.power(0, 9);
    m.stretch_weft = chance.power(0, 9);
    m.shear = chance.happens(0.2F) ? 0 : chance.power(0, 6);
    m.bend_warp = chance.happens(0.2F) ? 0 : chance.power(-15, -5);
    m.bend_weft = chance.happens(0.2F) ? 0 : chance.power(-15, -5);
    if (chance.happens(0.3F)) m.bend_bias = chance.power(-15, -7);
  }
  m.damping = chance.happens(0.3F) ? 0 : chance.within(0, 5);
  m.thickness = chance.happens(0.2F) ? 0 : chance.within(0, 0.02F);
  m.friction = chance.happens(0.2F) ? 0 : chance.within(0, 1.5F);
  if (chance.happens(0.2F)) m.max_speed = chance.within(1, 20);
  if (chance.happens(0.3F)) m.max_stretch = chance.happens(0.4F) ? 0 : chance.within(0.01F, 0.3F);
  if (chance.happens(0.15F)) m.stiffness = chance.within(0, 1);
  if (chance.happens(0.1F)) m.bend_stiffness = chance.within(0, 1);
  if (chance.happens(0.1F)) m.verlet_damping = chance.within(0.9F, 1);
  return m;
}

ColliderShape any_shape(Chance& chance, const std::shared_ptr<const DistanceField>& body) {
  const auto size = [&] { return chance.within(0.03F, 0.4F); };
  switch (chance.below(7)) {
    case 0:
      return Plane{{0, chance.within(-1, -0.2F), 0}, chance.happens(0.5F) ? Vec3{0, 1, 0} : chance.direction()};
    case 1:
      return Sphere{chance.vector(0.7F), size()};
    case 2:
      return Capsule{chance.vector(0.7F), chance.vector(0.7F), size(), size()};
    case 3:
      return Box{chance.vector(0.7F), {size(), size(), size()}, chance.turn()};
    case 4:
      return Ellipsoid{chance.vector(0.7F), {size(), size(), size()}, chance.turn()};
    case 5: {
      std::vector<Vec3> points(12);
      const Vec3 middle = chance.vector(0.6F);
      for (Vec3& p : points) p = middle + 0.3F * chance.direction();
      return convex_hull(points);
    }
    default:
      return MeshSolid{body};
  }
}

std::shared_ptr<const DistanceField> any_body() {
  Chance chance(7);
  std::vector<Vec3> points(30);
  for (Vec3& p : points) p = 0.3F * chance.direction();
  return std::make_shared<const DistanceField>(make_distance_field(convex_hull(points).surface, 10'000));
}

/// In physical units, as cloths of several fabrics need it.
Material any_fabric(Chance& chance) {
  Material m = any_material(chance);
  m.stiffness = m.bend_stiffness = -1;
  return m;
}

/// Some of a cloth, in order of the image.
void add_fabric(Chance& chance, ClothDesc& cloth) {
  cloth.material.stiffness = cloth.material.bend_stiffness = -1;
  Fabric& fabric = cloth.fabrics.emplace_back(Fabric{{}, any_fabric(chance)});
  const uint32_t pixels = cloth.asset->pixel_count(), first = chance.below(pixels), last = first + chance.below(pixels);
  for (uint32_t p = first; p < std::min(pixels, last); ++p)
    if (cloth.asset->valid(p)) fabric.pixels.push_back(p);
}

constexpr uint32_t kDeeds = 21;

/// On the points of a cloth that are farthest along some direction: all held, soft, or free within a distance.
std::vector<Pin> any_pins(Chance& chance, const ClothDesc& cloth, const Vec3& way) {
  const ClothAsset& asset = *cloth.asset;
  const Vec3 along = chance.direction();
  std::vector<std::pair<float, uint32_t>> order;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) order.emplace_back(dot(along, asset.rest_position[p]), p);
  std::ranges::sort(order);
  const float share = chance.within(0.01F, chance.happens(0.2F) ? 0.8F : 0.1F);
  order.resize(1 + static_cast<size_t>(share * static_cast<float>(order.size() - 1)));
  const bool soft = chance.happens(0.3F), free = chance.happens(0.3F), backed = chance.happens(0.5F);
  std::vector<Pin> pins;
  for (const auto& [height, pixel] : order) {
    Pin& pin = pins.emplace_back(Pin{pixel, apply(cloth.transform, asset.rest_position[pixel]) + way});
    if (soft && chance.happens(0.8F)) pin.frequency = chance.within(1, 10);
    if (!free || !chance.happens(0.8F)) continue;
    pin.max_distance = chance.within(0.001F, 0.2F);
    if (backed) pin.backstop = Backstop{chance.direction(), chance.within(0, 0.01F), chance.within(0.05F, 1)};
  }
  return pins;
}

/// A solver, and what each of the cloths is that it has.
struct Stage {
  std::unique_ptr<Solver> solver;
  std::vector<ClothDesc> cloths;
};

void act(const RandomScene& scene, const Deed& deed, Stage& stage) {
  constexpr size_t kMostCloths = 4;
  Chance chance(deed.seed);
  Solver& solver = *stage.solver;
  if (deed.kind == 15) {
    if (stage.cloths.size() == kMostCloths) return;
    ClothDesc& cloth = stage.cloths.emplace_back(scene.cloths[deed.cloth]);
    cloth.transform.translate += chance.vector(0.5F);
    static_cast<void>(solver.add_cloth(cloth));
    return;
  }
  if (stage.cloths.empty()) return;
  const auto place = static_cast<uint32_t>(deed.cloth % stage.cloths.size());
  const uint32_t c = solver.cloths()[place];
  const ClothDesc& cloth = stage.cloths[place];
  switch (deed.kind) {
    case 0: {
      const Vec3 way = deed.frame == 0 ? Vec3{} : chance.vector(0.2F);
      return solver.set_pins(c, any_pins(chance, cloth, way));
    }
    case 1:
      return solver.set_pins(c, {});
    case 2:
      return solver.set_wind(
          {chance.vector(8), chance.within(0, 1), chance.within(0.2F, 3), chance.within(0, 2), 0.3F});
    case 3:
      return solver.set_gravity(chance.vector(12));
    case 4: {
      const Vec3 at = chance.vector(0.3F);
      static_cast<void>(solver.cut(c, {at + chance.vector(1), at + chance.vector(1), at + chance.vector(1)}));
      return;
    }
    case 5:
      static_cast<void>(solver.tear(c, chance.within(1.1F, 1.6F)));
      return;
    case 6:
      return solver.set_pressure(c, chance.within(-50, 200));
    case 7:
      return solver.set_meets(c, chance.below(4));
    case 8:
      return solver.set_time_step(double{chance.within(0.004F, 0.04F)}, 1 + chance.below(16));
    case 9:
    case 10: {
      const Transform pose{chance.vector(0.1F), chance.turn(), 1};
      return solver.set_parent(c, pose, {chance.within(0, 1), chance.within(0, 1), 1}, deed.kind == 10);
    }
    case 11: {
      std::vector<Vec3> velocities = velocities_of(solver, c);
      const Vec3 push = chance.vector(0.3F);
      for (Vec3& v : velocities) v += push;
      return solver.write_state(c, positions_of(solver, c), velocities);
    }
    case 12: {
      const Material other = cloth.fabrics.empty() ? any_material(chance) : any_fabric(chance);
      return solver.set_material(c, mix(solver.material(c), other, chance.within(0, 1)));
    }
    case 13:
      if (!cloth.fabrics.empty()) solver.set_fabric(c, 0, any_fabric(chance));
      return;
    case 14:
      stage.cloths.erase(stage.cloths.begin() + place);
      return solver.remove_cloth(c);
    case 17:
    case 18:
      return solver.set_sewing(c, chance.happens(0.2F) ? std::nullopt : std::optional(chance.within(0, 1.5F)));
    case 19:
      return solver.set_gravity_scale(c, chance.within(-1, 2));
    case 20:
      return solver.set_wind_scale(c, chance.within(0, 3));
    default:
      return solver.restore(solver.save());
  }
}

void place_colliders(const RandomScene& scene, uint32_t frame, Solver& solver) {
  std::vector<Collider> colliders = scene.colliders;
  const auto t = static_cast<float>(frame);
  for (size_t i = 0; i < colliders.size(); ++i)
    colliders[i].pose = {t * scene.ways[i], quat_from_euler_deg(t * scene.turns[i]), 1};
  solver.set_colliders(colliders);
}

uint64_t hash_forces(Solver& solver) {
  uint64_t hash = 1;
  for (const ContactForce& contact : solver.contact_forces())
    for (const Vec3& v : {contact.force, contact.torque})
      for (const float x : {v.x, v.y, v.z}) hash = hash * 0x9E3779B97F4A7C15U + std::bit_cast<uint32_t>(x);
  return hash;
}

}  // namespace

RandomScene make_random_scene(uint32_t seed, uint32_t frames) {
  static const std::shared_ptr<const DistanceField> body = any_body();
  Chance chance(seed);
  RandomScene scene;
  const uint32_t count = chance.happens(0.6F) ? 1 : 2 + chance.below(2);
  for (uint32_t c = 0; c < count; ++c) {
    ClothDesc& cloth = scene.cloths.emplace_back(describe(any_asset(chance), any_material(chance)));
    while (chance.happens(0.2F)) add_fabric(chance, cloth);
    if (chance.happens(0.5F)) cloth.transform.rotate = chance.turn();
    if (chance.happens(0.3F)) cloth.transform.scale = chance.within(0.5F, 2);
    cloth.transform.translate = chance.vector(0.3F);
    if (chance.happens(0.3F)) cloth.self_collision = SelfCollision{};
    if (count > 1 && chance.happens(0.7F)) cloth.inter_collision = InterCollision{};
    if (chance.happens(0.2F)) cloth.meets = chance.below(4);
  }
  const auto spacing = [](const ClothDesc& cloth) { return cloth.asset->spacing * cloth.transform.scale; };
  const auto [finest, coarsest] = std::ranges::minmax(scene.cloths, {}, spacing);
  if (spacing(coarsest) > 9 * spacing(finest))  // the solver refuses ten
    for (ClothDesc& cloth : scene.cloths) cloth.inter_collision.reset();
  SolverSettings& s = scene.settings;
  s.backend = Backend::cpu;
  s.substeps = 1 + chance.below(12);
  s.relaxation_steps = chance.happens(0.8F) ? 1 : 1 + chance.below(3);
  s.keep_momentum = chance.happens(0.1F);
  if (chance.happens(0.2F)) s.gravity = chance.vector(12);
  if (chance.happens(0.2F)) s.imperfection = 1e-4F;
  if (chance.happens(0.2F)) s.sleep_speed = chance.within(0.01F, 0.3F);
  if (chance.happens(0.1F)) s.frame_time = double{chance.within(0.005F, 0.05F)};
  for (uint32_t left = chance.below(5); left > 0; --left) {
    Collider& collider = scene.colliders.emplace_back();
    if (chance.happens(0.7F)) collider.name = std::to_string(left);
    collider.shape = any_shape(chance, body);
    collider.friction = chance.within(0, 1);
    if (chance.happens(0.4F)) collider.groups = chance.below(4);
    scene.ways.push_back(chance.happens(0.4F) ? Vec3{} : chance.vector(chance.happens(0.1F) ? 0.3F : 0.02F));
    scene.turns.push_back(chance.happens(0.6F) ? Vec3{} : chance.vector(4));
  }
  for (uint32_t c = 0; c < count; ++c)
    if (chance.happens(0.6F)) scene.deeds.push_back({0, 0, c, chance.below(1U << 31U)});
  for (uint32_t left = chance.below(8); left > 0; --left)
    scene.deeds.push_back({chance.below(frames), chance.below(kDeeds), chance.below(count), chance.below(1U << 31U)});
  std::ranges::stable_sort(scene.deeds, {}, &Deed::frame);
  scene.settings.contact_forces = chance.happens(0.5F);
  return scene;
}

std::vector<uint64_t> play_random_scene(const RandomScene& scene, uint32_t frames, const SolverMaker& make_solver,
                                        bool changes_solver) {
  Stage stage{make_solver(), scene.cloths};
  std::vector<uint64_t> hashes;
  auto deed = scene.deeds.begin();
  for (uint32_t f = 0; f < frames; ++f) {
    place_colliders(scene, f, *stage.solver);
    for (; deed != scene.deeds.end() && deed->frame == f; ++deed) act(scene, *deed, stage);
    if (changes_solver && f % 3 == 1) {
      const std::vector<std::byte> state = stage.solver->save();
      std::unique_ptr<Solver> other = make_solver();
      for (uint32_t c = 0; c < scene.cloths.size(); ++c) other->remove_cloth(c);
      for (const ClothDesc& cloth : stage.cloths) static_cast<void>(other->add_cloth(cloth));
      place_colliders(scene, 0, *other);  // the body of triangles
      other->restore(state);
      stage.solver = std::move(other);
    }
    stage.solver->step();
    const std::vector<uint32_t> numbers = stage.solver->cloths();
    for (size_t c = 0; c < numbers.size(); ++c) {
      const std::vector<Vec3> positions = positions_of(*stage.solver, numbers[c]);
      EXPECT_TRUE(all_finite(positions)) << "frame " << f << ", cloth " << c;
      hashes.push_back(hash_state(*stage.cloths[c].asset, positions));
      hashes.push_back(hash_state(*stage.cloths[c].asset, velocities_of(*stage.solver, numbers[c])));
    }
    if (scene.settings.contact_forces) hashes.push_back(hash_forces(*stage.solver));
  }
  return hashes;
}

uint32_t random_scene_count(uint32_t unless_told) {
  const char* const told = std::getenv("GEOCLOTH_RANDOM_SCENES");
  return told != nullptr ? static_cast<uint32_t>(std::max(1, std::atoi(told))) : unless_told;
}

}  // namespace geocloth::test
