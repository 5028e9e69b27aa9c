// SPDX-License-Identifier: Apache-2.0
// A scene being played: keyframes are evaluated at the end of every frame, the solver moves evenly in between.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "check_input.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"
#include "rest/fabrics.h"
#include "rest/upload.h"
#include "scene/moving_surface.h"
#include "scene/start.h"

namespace geocloth {
namespace {

Transform inverse_rigid(const Transform& t) {
  const Quat back = conjugate(t.rotate);
  return {-rotate(back, t.translate), back, 1};
}

std::vector<Collider> colliders_at(const Scene& scene, double time) {
  std::vector<Collider> colliders;
  for (const SceneCollider& c : scene.colliders) colliders.push_back(collider_at(c, time));
  return colliders;
}

/// What a pin follows, as a rigid motion from where it was at time 0.
Transform carrier(const Scene& scene, const SceneCloth& cloth, const std::string& follow, double time) {
  if (follow == "world") return {};
  if (follow == "cloth" || (follow == "skin" && cloth.skin))
    return compose(pose_at(cloth.motion, time), inverse_rigid(pose_at(cloth.motion, 0)));
  for (const SceneCollider& c : scene.colliders) {
    if (c.collider.name == follow) return compose(collider_at(c, time).pose, inverse_rigid(collider_at(c, 0).pose));
  }
  throw Error(ErrorCode::invalid_argument,
              scene.path.string() + ": a pin follows \"" + follow + "\", but there is no collider of that name");
}

/// Where in the scene, for messages.
std::string element(const Scene& scene, const char* list, size_t i) {
  return scene.path.string() + ": " + list + "[" + std::to_string(i) + "]";
}

/// Pixels of a pin or a fabric.
/// @param path  of it in the scene, for what goes wrong
std::vector<uint32_t> selected_pixels(const std::string& path, const ClothAsset& asset, const Transform& start,
                                      const Where& where) {
  try {
    return select_pixels(asset, start, where);
  } catch (const Error& error) {
    throw Error(error.code(), path + ".where: " + error.what());
  }
}

/// [m] along the cloth at rest from every pixel to the nearest one of these; endless where none is reached.
std::vector<float> ways_along_cloth(const ClothAsset& asset, float scale, const std::vector<uint32_t>& pixels) {
  std::vector<float> way;
  for (const shader::Attachment& a : make_attachments(asset, scale, pixels))
    way.push_back(a.anchor == shader::kNoAnchor ? std::numeric_limits<float>::infinity() : a.reach);
  for (const uint32_t p : pixels) way[p] = 0;
  return way;
}

std::vector<Fabric> fabrics_of(const Scene& scene, size_t cloth, const ClothAsset& asset, const Transform& start) {
  std::vector<Fabric> fabrics;
  for (const SceneFabric& fabric : scene.cloths[cloth].fabrics) {
    const std::string path = element(scene, "cloths", cloth) + ".fabrics[" + std::to_string(fabrics.size()) + "]";
    std::vector<uint32_t> pixels = selected_pixels(path, asset, start, fabric.where);
    if (fabric.width > 0) {
      const std::vector<float> way = ways_along_cloth(asset, start.scale, pixels);
      pixels.clear();
      for (uint32_t p = 0; p < asset.pixel_count(); ++p)
        if (asset.valid(p) && way[p] <= fabric.width) pixels.push_back(p);
    }
    if (!has_cell(asset, pixels)) {
      throw Error(ErrorCode::invalid_data, path +
                                               ".where: the corners of no cell of the cloth are in it; give it a "
                                               "\"width\" [m], or convert with a larger --resolution");
    }
    fabrics.push_back({std::move(pixels), material_at(fabric, 0)});
  }
  return fabrics;
}

/// Where a body that deforms has taken a place beside it.
/// @param at_start  of the frame
Vec3 carried_point(const MovingSurface& surface, const Transform& body, const SurfacePlace& place, bool at_start) {
  return apply(body, at_start ? surface.at_start(place) : surface.at_end(place));
}

Vec3 middle(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return (1.F / static_cast<float>(points.size())) * sum;
}

/// Of each of the pixels of a pin.
/// @param where  in the scene, for messages
std::vector<float> painted_numbers(const ClothAsset& asset, const PaintedNumber& painted,
                                   const std::vector<uint32_t>& pixels, const std::string& where) {
  try {
    std::vector<float> numbers = paint_at(asset, painted.channel, pixels);
    for (float& n : numbers) n = painted.least + n * (painted.most - painted.least);
    return numbers;
  } catch (const Error& error) {
    throw Error(error.code(), where + ".painted: " + error.what());
  }
}

/// The same error of something in the scene, which is data of a file.
Error error_at(const std::string& where, const Error& error, const std::string& message) {
  return {error.code() == ErrorCode::invalid_argument ? ErrorCode::invalid_data : error.code(), where + ": " + message};
}

/// Does something with a body, whose errors say where in the scene it is.
template <typename Work>
void for_body(const std::string& where, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    throw error_at(where, error, error.what());
  }
}

/// Makes the solver; what it says of cloth 2 is of cloths[2] of the scene.
Solver solver_of(const Scene& scene, std::span<const ClothDesc> cloths, const SolverSettings& settings,
                 const MakeSolver& make_solver) {
  try {
    return make_solver ? make_solver(cloths, settings) : Solver(cloths, settings);
  } catch (const Error& error) {
    const std::string message = error.what();
    for (size_t c = 0; c < cloths.size(); ++c) {
      const std::string cloth = "cloth " + std::to_string(c) + ": ";
      if (message.starts_with(cloth)) throw error_at(element(scene, "cloths", c), error, message.substr(cloth.size()));
    }
    throw;
  }
}

}  // namespace

TriangleSurface read_asset_surface(const SceneMesh& mesh) {
  const ClothAsset asset = read_asset(mesh.file);
  if (!mesh.parts.empty()) {
    throw Error(ErrorCode::unsupported, mesh.file.string() + ": a garment of an asset is taken whole; leave out parts");
  }
  return {asset.source.position, {asset.source.triangle.begin(), asset.source.triangle.end()}};
}

Simulation::Simulation(Scene scene, SolverSettings settings, const BodyReader& bodies, const MakeSolver& make_solver)
    : scene_(std::move(scene)) {
  read_bodies(bodies);
  settings.frame_time = 1 / scene_.frame_rate;
  settings.substeps = scene_.substeps;
  settings.relaxation_steps = scene_.relaxation_steps;
  settings.keep_momentum = scene_.keep_momentum;
  settings.gravity = scene_.gravity;
  settings.imperfection = scene_.imperfection;
  settings.contact_forces = scene_.contact_forces;
  settings.sleep_speed = scene_.sleep_speed;
  settings.sleep_time = scene_.sleep_time;

  std::map<std::filesystem::path, std::shared_ptr<const ClothAsset>> assets;
  std::vector<std::optional<StartState>> posed_at(scene_.cloths.size());
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    const SceneCloth& cloth = scene_.cloths[c];
    std::shared_ptr<const ClothAsset>& asset = assets[cloth.asset];
    if (!asset) asset = std::make_shared<const ClothAsset>(read_asset(cloth.asset));
    if (cloth.names_sewing && asset->sewing.empty()) {
      throw Error(ErrorCode::invalid_data,
                  element(scene_, "cloths", c) + ".sewing: " + cloth.asset.string() +
                      " has nothing to sew; its mesh needs edges without faces between the borders of its panels");
    }
    const Transform start = compose(pose_at(cloth.motion, 0), cloth.transform);
    cloths_.push_back({asset, material_at(cloth, 0), start, cloth.self_collision, cloth.inter_collision, cloth.meets,
                       fabrics_of(scene_, c, *asset, start)});
    std::vector<Vec3> begins = asset->rest_position;
    for (Vec3& p : begins) p = apply(start, p);
    posed_at[c] = posed(c, bodies, begins);
    if (posed_at[c]) begins = posed_at[c]->position;
    for (size_t k = 0; k < cloth.pins.size(); ++k) {
      const ScenePin& pin = cloth.pins[k];
      const std::string path = element(scene_, "cloths", c) + ".pins[" + std::to_string(k) + "]";
      PinSet set{c, pin, selected_pixels(path, *asset, start, pin.where), {}, {}, false};
      for (const uint32_t p : set.pixels) set.rest.push_back(begins[p]);
      attach(set);
      if (pin.backstop && set.place.empty() && !set.pixels.empty()) {
        throw Error(ErrorCode::invalid_data,
                    path +
                        ".backstop: has no surface to be behind; let the pin follow the cloth's \"skin\", or a "
                        "collider of shape \"mesh\" with an \"animation\"");
      }
      pins_.push_back(std::move(set));
    }
    measure_distances(c);
  }
  // Points that another pin has, too, are left to it: of several pins on a point the last one counts.
  std::stable_partition(pins_.begin(), pins_.end(), [](const PinSet& set) { return set.pin.max_distance.has_value(); });
  hands_.resize(cloths_.size());
  torn_.resize(cloths_.size());
  gaps_.resize(cloths_.size());
  solver_ = std::make_unique<Solver>(solver_of(scene_, cloths_, settings, make_solver));
  for (uint32_t c = 0; c < posed_at.size(); ++c)
    if (posed_at[c]) solver_->write_state(c, posed_at[c]->position, posed_at[c]->velocity);
  solver_->set_colliders(colliders_at(scene_, 0), true);
  if (scene_.wind) solver_->set_wind(wind_at(scene_, 0));
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    const SceneCloth& cloth = scene_.cloths[c];
    if (!cloth.motion.empty()) solver_->set_parent(c, pose_at(cloth.motion, 0), cloth.inertia_scale);
    solver_->set_gravity_scale(c, cloth.gravity_scale);
    solver_->set_wind_scale(c, cloth.wind_scale);
    solver_->set_pressure(c, pressure_at(cloth, 0));
  }
}

/// As a start or a skin has it at the beginning.
/// @param begins  [m] where the pixels are without
std::optional<StartState> Simulation::posed(uint32_t cloth, const BodyReader& bodies,
                                            std::span<const Vec3> begins) const {
  std::optional<StartState> posed;
  const std::string where = element(scene_, "cloths", cloth);
  if (scene_.cloths[cloth].start) {
    const SceneStart& start = *scene_.cloths[cloth].start;
    for_body(where + ".start", [&] { posed = start_state(start, cloths_[cloth], bodies.vertices, scene_.frame_rate); });
  } else if (skins_[cloth]) {
    for_body(where + ".skin", [&] {
      if (std::optional<std::vector<Vec3>> carried = skins_[cloth]->carried_from_opening(begins))
        posed = StartState{std::move(*carried), std::vector<Vec3>(begins.size())};
    });
  }
  return posed;
}

/// The bodies of colliders of shape "mesh", and the skins of cloths.
void Simulation::read_bodies(const BodyReader& bodies) {
  const auto read_moving = [&](const SceneMesh& mesh) {
    if (!bodies.moving) throw Error(ErrorCode::unsupported, "this program reads no animations");
    return bodies.moving(mesh);
  };
  moving_.resize(scene_.colliders.size());
  for (size_t i = 0; i < scene_.colliders.size(); ++i) {
    SceneCollider& collider = scene_.colliders[i];
    if (!collider.mesh) continue;
    for_body(element(scene_, "colliders", i), [&, &mesh = *collider.mesh] {
      if (mesh.animation) {
        moving_[i] = std::make_shared<MovingCollider>(read_moving(mesh), mesh.transform, collider.field_spacing);
        collider.collider.shape = MeshSolid{moving_[i]->field()};
        if (!collider.center) collider.center = moving_[i]->middle();
        return;
      }
      TriangleSurface surface = bodies.surface(mesh);
      for (Vec3& p : surface.position) p = apply(mesh.transform, p);
      const FieldSpacing spacing{collider.field_spacing};
      collider.collider.shape = MeshSolid{
          std::make_shared<const DistanceField>(spacing.metres > 0 ? make_distance_field(std::move(surface), spacing)
                                                                   : make_distance_field(std::move(surface)))};
    });
  }
  skins_.resize(scene_.cloths.size());
  for (size_t c = 0; c < scene_.cloths.size(); ++c) {
    const SceneCloth& cloth = scene_.cloths[c];
    if (!cloth.skin) continue;
    for_body(element(scene_, "cloths", c) + ".skin", [&] {
      const Transform start = compose(pose_at(cloth.motion, 0), cloth.transform);
      skins_[c] = std::make_shared<MovingSurface>(read_moving(*cloth.skin), compose(start, cloth.skin->transform));
    });
  }
}

/// To how they are at the end of the frame.
void Simulation::advance_bodies() {
  std::ostringstream at;
  at << ": at " << time() << " s";
  for (size_t i = 0; i < moving_.size(); ++i) {
    if (!moving_[i]) continue;
    for_body(element(scene_, "colliders", i) + at.str(), [&] { moving_[i]->advance(time()); });
    scene_.colliders[i].collider.shape = MeshSolid{moving_[i]->field()};
  }
  for (size_t c = 0; c < skins_.size(); ++c) {
    if (!skins_[c]) continue;
    for_body(element(scene_, "cloths", c) + ".skin" + at.str(), [&] { skins_[c]->advance(time()); });
  }
}

Simulation::Carrier Simulation::moving_carrier(const PinSet& set) const {
  const std::string& follow = set.pin.follow;
  if (follow == "skin" && skins_[set.cloth]) return {skins_[set.cloth].get(), {}};
  for (size_t i = 0; i < moving_.size(); ++i) {
    const SceneCollider& collider = scene_.colliders[i];
    if (moving_[i] && collider.collider.name == follow) return {&moving_[i]->surface(), collider_at(collider, 0).pose};
  }
  return {};
}

/// To the surface that the pin follows, if it deforms, as it was when the frame began.
void Simulation::attach(PinSet& set) const {
  const Carrier carrier = moving_carrier(set);
  if (carrier.surface == nullptr) return;
  const Transform back = inverse_rigid(carrier.pose);
  std::vector<Vec3> points;
  points.reserve(set.rest.size());
  for (const Vec3& p : set.rest) points.push_back(apply(back, p));
  if (set.pin.pivot) points.push_back(apply(back, *set.pin.pivot));
  set.place = carrier.surface->places_of(points);
  if (!set.pin.pivot) return;
  set.pivot_place = set.place.back();
  set.place.pop_back();
}

float Simulation::farthest_from_skin(uint32_t cloth) const {
  float farthest = 0;
  for (const PinSet& set : pins_) {
    if (set.cloth != cloth || moving_carrier(set).surface != skins_[cloth].get()) continue;
    for (const SurfacePlace& place : set.place) farthest = std::max(farthest, length(place.off));
  }
  return farthest;
}

double Simulation::time() const {
  return frame_ / scene_.frame_rate;
}

std::vector<Collider> Simulation::colliders() const {
  return colliders_at(scene_, time());
}

/// The pin begins to act: its points' places are what moves from now on.
void Simulation::take_hold(PinSet& set, double start) {
  set.acts = true;
  if (!(set.pin.from > 0)) return;
  std::vector<Vec3> position;
  solver_->read_positions(set.cloth, position);
  const Transform back = inverse_rigid(carrier(scene_, scene_.cloths[set.cloth], set.pin.follow, start));
  for (size_t k = 0; k < set.pixels.size(); ++k) set.rest[k] = apply(back, position[set.pixels[k]]);
  set.own_start = pose_at(set.pin.motion, start);
  attach(set);
}

/// Of the pins of a cloth that let their points go so far, and how far behind the skin.
void Simulation::measure_distances(uint32_t cloth) {
  const auto first = std::ranges::find_if(pins_, [&](const PinSet& set) { return set.cloth == cloth; });
  const std::span<PinSet> sets(first, pins_.end());
  constexpr auto kFree = static_cast<float>(kLargestPinDistance);
  std::vector<uint32_t> held;
  for (const PinSet& set : sets)
    if (set.pin.holds()) held.insert(held.end(), set.pixels.begin(), set.pixels.end());
  std::vector<float> way;
  for (size_t k = 0; k < sets.size(); ++k) {
    PinSet& set = sets[k];
    if (!set.pin.max_distance) continue;
    const MaxDistance& most = *set.pin.max_distance;
    set.max_distance.assign(set.pixels.size(), most.least);
    const std::string pin = element(scene_, "cloths", cloth) + ".pins[" + std::to_string(k) + "]";
    const std::string where = pin + ".max_distance";
    const ClothAsset& asset = *cloths_[cloth].asset;
    if (most.painted) set.max_distance = painted_numbers(asset, *most.painted, set.pixels, where);
    if (const auto& back = set.pin.backstop) {
      set.backstop.assign(set.pixels.size(), back->distance);
      if (back->painted) set.backstop = painted_numbers(asset, *back->painted, set.pixels, pin + ".backstop");
    }
    if (!(most.per_metre > 0)) continue;
    if (held.empty()) {
      throw Error(ErrorCode::invalid_data,
                  where +
                      ": grows from the points that pins of the cloth hold, and none holds any; give a "
                      "pin without frequency and max_distance, or one distance for all");
    }
    if (way.empty()) way = ways_along_cloth(*cloths_[cloth].asset, cloths_[cloth].transform.scale, held);
    for (size_t i = 0; i < set.pixels.size(); ++i) {
      const float distance = most.least + most.per_metre * way[set.pixels[i]];
      set.max_distance[i] = distance > kFree ? std::numeric_limits<float>::infinity() : distance;
    }
  }
}

/// At the beginning of the frame, but for what jumps in it: that has jumped.
Simulation::PinTimes Simulation::times_of_jump(const PinSet& set, double start) const {
  return {carrier_teleports(scene_, set.pin.follow, start, time()) ? time() : start,
          teleports(set.pin.motion, start, time()) ? time() : start};
}

/// What the pin follows, and its own way about the middle of its points since it began to act.
Simulation::PinPlace Simulation::place_of(const PinSet& set, const PinTimes& times) const {
  return {carrier(scene_, scene_.cloths[set.cloth], set.pin.follow, times.carrier),
          compose(pose_at(set.pin.motion, times.own), inverse_rigid(set.own_start))};
}

/// Of the frame that begins at `start`, where they are at its end.
/// @param only_jumps  where they are at its beginning, once what jumps in the frame has jumped
std::vector<Pin> Simulation::pins_of(uint32_t cloth, double start, bool only_jumps) const {
  std::vector<Pin> pins;
  for (const PinSet& set : pins_) {
    if (set.cloth != cloth || !set.pin.acts(start, time())) continue;
    const PinPlace place = place_of(set, only_jumps ? times_of_jump(set, start) : PinTimes{time(), time()});
    add_pins(set, place, only_jumps, pins);
  }
  return pins;
}

/// What a pin's own motion turns about: a body that deforms takes it along.
/// @param at_start  of the frame
Vec3 Simulation::center_of(const PinSet& set, bool at_start) const {
  const Carrier carrier = moving_carrier(set);
  if (carrier.surface == nullptr) return set.pin.pivot ? *set.pin.pivot : middle(set.rest);
  const auto carried = [&](const SurfacePlace& place) {
    return carried_point(*carrier.surface, carrier.pose, place, at_start);
  };
  if (set.pivot_place) return carried(*set.pivot_place);
  std::vector<Vec3> points;
  points.reserve(set.place.size());
  for (const SurfacePlace& place : set.place) points.push_back(carried(place));
  return middle(points);
}

/// @param at_start  of the frame, as far as a surface that deforms carries them
void Simulation::add_pins(const PinSet& set, const PinPlace& place, bool at_start, std::vector<Pin>& pins) const {
  const Transform &carried = place.carried, &own = place.own;
  const Carrier carrier = moving_carrier(set);
  const MovingSurface* const surface = carrier.surface;
  const bool backed = set.pin.backstop.has_value(), moves = !set.pin.motion.empty();
  const Vec3 center = moves ? center_of(set, at_start) : Vec3{};
  const Quat turn = carried.rotate * (own.rotate * carrier.pose.rotate);
  const auto distance_of = [&](size_t k) { return set.max_distance.empty() ? 0 : set.max_distance[k]; };
  const auto pin_of = [&](size_t k) {
    Vec3 x = set.rest[k];
    if (surface != nullptr) x = carried_point(*surface, carrier.pose, set.place[k], at_start);
    // Without a motion of its own the point must not even be rounded.
    if (moves) x = center + rotate(own.rotate, x - center) + own.translate;
    const float most = std::min(distance_of(k), static_cast<float>(kLargestPinDistance));
    Pin pin{set.pixels[k], apply(carried, x), set.pin.frequency, most};
    if (!backed || !(most > 0)) return pin;
    const Vec3 n = at_start ? surface->normal_at_start(set.place[k]) : surface->normal_at_end(set.place[k]);
    pin.backstop = Backstop{rotate(turn, n), set.backstop[k], set.pin.backstop->radius};
    return pin;
  };
  std::vector<size_t> told;
  told.reserve(set.pixels.size());
  for (size_t k = 0; k < set.pixels.size(); ++k)
    if (backed || !std::isinf(distance_of(k))) told.push_back(k);
  const size_t first = pins.size();
  pins.resize(first + told.size());
  constexpr size_t kGrain = 512;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, told.size(), kGrain), [&](const auto& range) {
    for (size_t n = range.begin(); n < range.end(); ++n) pins[first + n] = pin_of(told[n]);
  });
}

void Simulation::update_pins() {
  const double start = (frame_ - 1) / scene_.frame_rate;
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    std::vector<Pin> pins = pins_of(c, start, false);
    pins.insert(pins.end(), hands_[c].begin(), hands_[c].end());
    solver_->set_pins(c, pins);
  }
}

/// The way that all pins of a cloth jump in this frame, if it is the same for all. A cloth that jumps with its own
/// motion has been taken along.
std::optional<Transform> Simulation::way_of_jump(uint32_t cloth, double start) const {
  constexpr float kAlike = 0.05F;  // of a spacing, that the ways of two pins may take a point apart
  if (teleports(scene_.cloths[cloth].motion, start, time())) return std::nullopt;
  std::optional<Transform> way;
  for (const PinSet& set : pins_) {
    if (set.cloth != cloth || !set.pin.acts(start, time())) continue;
    const PinTimes times = times_of_jump(set, start);
    if (times.carrier == start && times.own == start) return std::nullopt;
    const auto from_rest = [&, center = center_of(set, true)](const PinPlace& place) {
      const Transform& own = place.own;
      return compose(place.carried, {center - rotate(own.rotate, center) + own.translate, own.rotate, 1});
    };
    const Transform before = from_rest(place_of(set, {start, start}));
    const Transform own_way = compose(from_rest(place_of(set, times)), inverse_rigid(before));
    if (!way) way = own_way;
    const float apart = kAlike * cloths_[cloth].asset->spacing * cloths_[cloth].transform.scale;
    for (const Vec3& rest : set.rest) {
      const Vec3 x = apply(before, rest);
      if (length(apply(own_way, x) - apply(*way, x)) > apart) return std::nullopt;
    }
  }
  return way;
}

/// Takes cloths along, as they are, to where the pins that hold them jump.
void Simulation::jump(double start) {
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    const std::optional<Transform> found = way_of_jump(c, start);
    if (!found) continue;
    const Transform& way = *found;
    const std::vector<Pin> pins = pins_of(c, start, true);
    const std::vector<uint32_t> part = connected_parts(*cloths_[c].asset);
    std::vector<bool> hangs(part.size());
    for (const Pin& pin : pins) hangs[part[pin.pixel]] = true;
    std::vector<Vec3> position, velocity;
    solver_->read_positions(c, position);
    solver_->read_velocities(c, velocity);
    for (uint32_t p = 0; p < part.size(); ++p) {
      if (!hangs[part[p]]) continue;
      position[p] = apply(way, position[p]);
      velocity[p] = rotate(way.rotate, velocity[p]);
    }
    solver_->write_state(c, position, velocity);
    // Pins that were there before would come from where they were.
    solver_->set_pins(c, {});
    solver_->set_pins(c, pins);
  }
}

std::vector<uint32_t> Simulation::held_pixels(uint32_t cloth) const {
  std::vector<uint32_t> pixels;
  for (const PinSet& set : pins_) {
    if (set.cloth == cloth && !set.pin.max_distance && set.pin.from <= time() && time() < set.pin.until)
      pixels.insert(pixels.end(), set.pixels.begin(), set.pixels.end());
  }
  std::ranges::sort(pixels);
  pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
  return pixels;
}

void Simulation::set_hand(uint32_t cloth, std::vector<Pin> pins) {
  if (cloth >= hands_.size())
    throw Error(ErrorCode::invalid_argument,
                "there is no cloth " + std::to_string(cloth) + "; the scene has " + std::to_string(hands_.size()));
  hands_[cloth] = std::move(pins);
}

void Simulation::set_wind(const Wind& wind) {
  solver_->set_wind(wind);
  scene_.wind = wind;
  scene_.wind_motion.clear();
}

void Simulation::set_material(uint32_t cloth, const Material& material) {
  solver_->set_material(cloth, material);
  cloths_[cloth].material = scene_.cloths[cloth].material = material;
  scene_.cloths[cloth].material_motion.clear();
}

void Simulation::set_fabric(uint32_t cloth, uint32_t fabric, const Material& material) {
  solver_->set_fabric(cloth, fabric, material);
  SceneFabric& told = scene_.cloths[cloth].fabrics[fabric];
  cloths_[cloth].fabrics[fabric].material = told.material = material;
  told.material_motion.clear();
}

/// The cuts between the beginning of the last frame and that of the next one.
void Simulation::cut(double start) {
  constexpr double kSameTime = 1e-9;  // [s] what a time loses as a decimal
  const double before = frame_ > 1 ? start - 1 / scene_.frame_rate : -1;
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    for (uint32_t k = 0; k < scene_.cloths[c].cuts.size(); ++k) {
      const SceneCut& cut = scene_.cloths[c].cuts[k];
      if (cut.time > before + kSameTime && cut.time <= start + kSameTime)
        cuts_made_.push_back({c, k, solver_->cut(c, cut.triangle)});
    }
    if (scene_.cloths[c].tear > 0) torn_[c] += solver_->tear(c, scene_.cloths[c].tear);
    cloths_[c].asset = solver_->asset(c);
  }
}

/// In the frame that begins at `start`.
void Simulation::sew(uint32_t cloth, double start) {
  const std::optional<SceneSewing>& sewing = scene_.cloths[cloth].sewing;
  if (!sewing || cloths_[cloth].asset->sewing.empty()) return;
  std::optional<float>& gap = gaps_[cloth];
  if (!gap && time() > sewing->start) {
    gap = solver_->sewing_gap(cloth);
    solver_->set_sewing(cloth, *gap);
  }
  constexpr float kSewn = 0.02F;  // of what is apart at rest: it begins as it was sewn before
  const double duration = gap && *gap < kSewn ? 0 : sewing->duration;
  const auto share_over = [&](double at) {
    if (!(duration > 0)) return at >= sewing->start ? 1.0 : 0.0;
    return std::clamp((at - sewing->start) / duration, 0.0, 1.0);
  };
  if (sewing->weightless)
    solver_->set_gravity_scale(cloth, share_over(start) < 1 ? 0 : scene_.cloths[cloth].gravity_scale);
  if (gap) solver_->set_sewing(cloth, *gap * static_cast<float>(1 - share_over(time())));
}

void Simulation::step() {
  ++frame_;
  const double start = (frame_ - 1) / scene_.frame_rate;
  cut(start);
  advance_bodies();
  std::vector<Collider> solids = colliders();
  for (size_t i = 0; i < solids.size(); ++i) solids[i].teleport = teleports(scene_.colliders[i].motion, start, time());
  solver_->set_colliders(solids);
  if (scene_.wind && !scene_.wind_motion.empty()) solver_->set_wind(wind_at(scene_, time()));
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    const SceneCloth& cloth = scene_.cloths[c];
    if (!cloth.material_motion.empty()) {
      cloths_[c].material = material_at(cloth, time());
      solver_->set_material(c, cloths_[c].material);
    }
    for (uint32_t f = 0; f < cloth.fabrics.size(); ++f) {
      if (cloth.fabrics[f].material_motion.empty()) continue;
      cloths_[c].fabrics[f].material = material_at(cloth.fabrics[f], time());
      solver_->set_fabric(c, f, cloths_[c].fabrics[f].material);
    }
    if (!cloth.pressure_motion.empty()) solver_->set_pressure(c, pressure_at(cloth, time()));
    sew(c, start);
    if (cloth.motion.empty()) continue;
    solver_->set_parent(c, pose_at(cloth.motion, time()), cloth.inertia_scale, teleports(cloth.motion, start, time()));
  }
  for (PinSet& set : pins_)
    if (set.pin.acts(start, time()) && !set.acts) take_hold(set, start);
  jump(start);
  update_pins();
  solver_->step();
}

}  // namespace geocloth
