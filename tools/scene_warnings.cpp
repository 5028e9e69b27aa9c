// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "body_reader.h"
#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/import.h"
#include "render/camera.h"

namespace geocloth {
namespace {

/// [s] when the last frame ends.
double end_of(const Scene& scene) {
  return scene.frames / scene.frame_rate;
}

/// A part of a cloth that hangs together, by seams that are sewn as well.
struct Part {
  std::vector<uint32_t> pixel;
  bool held = false;
};

/// By their first pixels.
/// @param is_sewn  what the asset names to be sewn is
std::map<uint32_t, Part> parts_of(const ClothAsset& asset, bool is_sewn) {
  const std::vector<uint32_t> part = connected_parts(asset);
  DisjointSets sewn(asset.pixel_count());
  if (is_sewn)
    for (const auto& [a, b] : asset.sewing) sewn.join(part[a], part[b]);
  std::map<uint32_t, Part> parts;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) parts[sewn.find(part[p])].pixel.push_back(p);
  return parts;
}

/// A vertex of the file that a pin of it would hold the part by.
std::optional<uint32_t> vertex_of(const ClothAsset& asset, const Part& part) {
  for (size_t v = 0; v < asset.binding.size(); ++v) {
    const Binding& binding = asset.binding[v];
    const auto largest = std::max_element(binding.weight.begin(), binding.weight.end()) - binding.weight.begin();
    if (std::binary_search(part.pixel.begin(), part.pixel.end(), binding.pixel[static_cast<size_t>(largest)]))
      return asset.source.source_vertex[v];
  }
  return std::nullopt;
}

bool falls(const Scene& scene, const SceneCloth& cloth) {
  return length(scene.gravity) > 0 && cloth.gravity_scale > 0;
}

/// Where other parts of a cloth hang by pins and these by none.
void warn_of_loose_parts(const Simulation& simulation, size_t index, std::vector<std::string>& warnings) {
  const Scene& scene = simulation.scene();
  const ClothDesc& cloth = simulation.cloths()[index];
  if (!falls(scene, scene.cloths[index])) return;
  const std::optional<SceneSewing>& sewing = scene.cloths[index].sewing;
  std::map<uint32_t, Part> parts = parts_of(*cloth.asset, sewing && sewing->start < end_of(scene));
  if (parts.size() < 2) return;
  std::vector<uint32_t> held;
  for (const ScenePin& pin : scene.cloths[index].pins) {
    if (pin.from >= end_of(scene)) continue;
    const std::vector<uint32_t> pixels = select_pixels(*cloth.asset, cloth.transform, pin.where);
    held.insert(held.end(), pixels.begin(), pixels.end());
  }
  if (held.empty()) return;
  std::sort(held.begin(), held.end());
  const Part* largest = nullptr;
  size_t count = 0, points = 0;
  for (auto& [first, part] : parts) {
    part.held = std::any_of(part.pixel.begin(), part.pixel.end(),
                            [&](uint32_t p) { return std::binary_search(held.begin(), held.end(), p); });
    if (part.held) continue;
    ++count;
    points += part.pixel.size();
    if (largest == nullptr || part.pixel.size() > largest->pixel.size()) largest = &part;
  }
  if (largest == nullptr) return;
  const std::optional<uint32_t> vertex = vertex_of(*cloth.asset, *largest);
  const Vec3 at = apply(cloth.transform, cloth.asset->rest_position[largest->pixel[largest->pixel.size() / 2]]);
  const std::string place = fmt::format("{}at [{:.3g}, {:.3g}, {:.3g}]",
                                        vertex ? fmt::format("near vertex {}, ", *vertex) : "", at.x, at.y, at.z);
  const std::string what =
      count == 1
          ? fmt::format("a part of it ({} points, {}) is held by no pin and falls", points, place)
          : fmt::format("{} parts of it ({} points; the largest {}) are held by no pin and fall", count, points, place);
  const char* them = count == 1 ? "it" : "them";
  warnings.push_back(
      fmt::format("{}: {} where no collider carries {}; pin {} too, convert with --parts without {}, or with "
                  "a coarser --resolution, by which small parts ride on the cloth beside them",
                  name_of_cloth(scene, index), what, them, them, them));
}

/// Elements of an array of a cloth: the first of many.
std::string list_of(const char* key, const std::vector<size_t>& indices) {
  constexpr size_t kNamed = 3;
  std::string list;
  for (size_t i = 0; i < std::min(kNamed, indices.size()); ++i)
    list += fmt::format("{}{}[{}]", i == 0 ? "" : ", ", key, indices[i]);
  return indices.size() > kNamed ? fmt::format("{} and {} more", list, indices.size() - kNamed) : list;
}

/// What would come after the last frame.
void warn_of_late_parts(const Scene& scene, size_t index, std::vector<std::string>& warnings) {
  constexpr double kSameTime = 1e-9;  // [s] as for the cuts themselves
  if (scene.frames == 0) return;      // nothing is asked for but the first state
  const SceneCloth& cloth = scene.cloths[index];
  const double last = (scene.frames - 1) / scene.frame_rate;
  std::vector<size_t> cuts, pins;
  for (size_t k = 0; k < cloth.cuts.size(); ++k)
    if (cloth.cuts[k].time > last + kSameTime) cuts.push_back(k);
  for (size_t k = 0; k < cloth.pins.size(); ++k)
    if (cloth.pins[k].from >= end_of(scene)) pins.push_back(k);
  const std::string name = name_of_cloth(scene, index);
  if (!cuts.empty()) {
    warnings.push_back(
        fmt::format("{}: {} would come after the last frame, which begins at {:.6g} s, so nothing is cut; "
                    "play more frames, or set an earlier \"time\"",
                    name, list_of("cuts", cuts), last));
  }
  if (!pins.empty()) {
    warnings.push_back(
        fmt::format("{}: {} would take hold after the last frame, which ends at {:.6g} s; play more "
                    "frames, or set an earlier \"from\"",
                    name, list_of("pins", pins), end_of(scene)));
  }
}

/// The frame, counted from 1, in which a time [s] comes.
uint32_t frame_of(const Scene& scene, double time) {
  auto frame = static_cast<uint32_t>(std::ceil(time * scene.frame_rate));
  while (frame > 0 && (frame - 1) / scene.frame_rate >= time) --frame;
  while (frame / scene.frame_rate < time) ++frame;
  return frame;
}

/// Whether a pin jumps in a frame [s], by itself or with the collider that it follows.
bool jumps_in(const Scene& scene, const ScenePin& pin, double start, double end) {
  return teleports(pin.motion, start, end) || carrier_teleports(scene, pin.follow, start, end);
}

/// Whether the pins' own motions take the cloth apart in a frame [s]: pins turn about their own middles, or pivots.
bool part_in(const std::vector<ScenePin>& pins, double start, double end) {
  const ScenePin* first = nullptr;
  Vec3 first_way;
  for (const ScenePin& pin : pins) {
    if (!pin.acts(start, end) || !teleports(pin.motion, start, end)) continue;
    const Transform from = pose_at(pin.motion, start), to = pose_at(pin.motion, end);
    const Vec3 way = to.translate - from.translate;
    const bool turn_alike = first != nullptr && pin.pivot && pin.pivot == first->pivot &&
                            from.rotate == pose_at(first->motion, start).rotate &&
                            to.rotate == pose_at(first->motion, end).rotate;
    if (first != nullptr && ((!(from.rotate == to.rotate) && !turn_alike) || length(way - first_way) > 1e-3F))
      return true;
    if (first == nullptr) first_way = way;
    first = &pin;
  }
  return false;
}

/// A key that is jumped to.
struct Jump {
  double time;           // [s]
  std::string collider;  // that jumps; empty: a pin does
};

/// Where only some of the pins jump, or not alike, the cloth cannot jump with them.
void warn_of_torn_jumps(const Scene& scene, size_t index, std::vector<std::string>& warnings) {
  const std::vector<ScenePin>& pins = scene.cloths[index].pins;
  std::vector<Jump> jumps;
  const auto collect = [&](const Motion& motion, const std::string& whose) {
    for (const Keyframe& key : motion)
      if (key.teleport && key.time > 0 && key.time <= end_of(scene)) jumps.push_back({key.time, whose});
  };
  for (const SceneCollider& collider : scene.colliders) collect(collider.motion, collider.collider.name);
  for (const ScenePin& pin : pins) collect(pin.motion, "");
  for (const Jump& jump : jumps) {
    const uint32_t frame = frame_of(scene, jump.time);
    const double start = (frame - 1) / scene.frame_rate, end = frame / scene.frame_rate;
    const auto count = [&](const auto& is_so) {
      return std::count_if(pins.begin(), pins.end(),
                           [&](const auto& pin) { return pin.acts(start, end) && is_so(pin); });
    };
    const auto acting = count([](const ScenePin&) { return true; });
    const auto jumping = count([&](const ScenePin& pin) { return jumps_in(scene, pin, start, end); });
    const auto following =
        count([&](const ScenePin& pin) { return !jump.collider.empty() && pin.follow == jump.collider; });
    const std::string name = name_of_cloth(scene, index);
    if (following > 0 && jumping != acting) {
      warnings.push_back(fmt::format(
          "{}: {} of its {} pins follow \"{}\", which jumps at {:.6g} s, and pull the cloth open there; let "
          "all pins follow that collider, and the cloth jumps with it",
          name, following, acting, jump.collider, jump.time));
      return;
    }
    if (jumping > 0 && jumping != acting) {
      warnings.push_back(
          fmt::format("{}: {} of its {} pins jump at {:.6g} s and pull the cloth open there; let all pins jump alike, "
                      "and the cloth jumps with them",
                      name, jumping, acting, jump.time));
      return;
    }
    if (part_in(pins, start, end)) {
      warnings.push_back(fmt::format(
          "{}: its pins jump at {:.6g} s, but apart, and pull the cloth open; give them the same way without a turn, "
          "or "
          "the same \"pivot\" (each turns about its own middle), or make one pin of them, and the cloth jumps with it",
          name, jump.time));
      return;
    }
  }
}

/// Broken animations that nobody plays are no fault of the scene.
size_t animations_of(const std::filesystem::path& file) {
  try {
    return count_animations(file);
  } catch (const Error&) {
    return 0;
  }
}

/// A walker stood still, and nothing said why.
void warn_of_animated_bodies(const Scene& scene, std::vector<std::string>& warnings) {
  for (size_t i = 0; i < scene.colliders.size(); ++i) {
    const SceneCollider& collider = scene.colliders[i];
    if (!collider.mesh || collider.mesh->animation) continue;
    const size_t animations = animations_of(collider.mesh->file);
    if (animations == 0) continue;
    warnings.push_back(
        fmt::format("colliders[{}] ({}): the file has {} animation{}, which {} not played: the collider keeps the pose "
                    "that the file opens with; \"animation\": 0, or the name of one, plays it",
                    i, collider.mesh->file.filename().string(), animations, animations == 1 ? "" : "s",
                    animations == 1 ? "is" : "are"));
  }
}

/// [m] How far any vertex is from where it was.
float farthest_way(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  float way = 0;
  for (size_t i = 0; i < from.size(); ++i) way = std::max(way, length(to[i] - from[i]));
  return way;
}

/// A walk that goes on for two metres and begins anew where it began throws what is worn.
void warn_of_open_loop(const SceneMesh& mesh, const std::string& name, double frame_rate,
                       std::vector<std::string>& warnings) {
  if (!mesh.animation || !mesh.animation->loop) return;
  constexpr int kSamples = 60;
  constexpr float kTimes = 3;     // as far as in the fastest frame
  constexpr float kSeen = 0.01F;  // of the body's size
  SceneMesh once = mesh;
  once.animation->start = 0;
  once.animation->speed = 1;
  once.animation->loop = false;
  const PlayedBody played = play_body(once);
  if (!(played.duration > 0)) return;
  const std::vector<Vec3> first = played.positions_at(0);
  std::vector<Vec3> last = first;
  float fastest = 0;  // [m] in one of the samples
  for (int k = 1; k <= kSamples; ++k) {
    std::vector<Vec3> next = played.positions_at(played.duration * k / kSamples);
    fastest = std::max(fastest, farthest_way(last, next));
    last = std::move(next);
  }
  const double frame = mesh.animation->speed / frame_rate, sample = played.duration / kSamples;
  const float way = farthest_way(last, first), usual = fastest * static_cast<float>(frame / sample);
  if (way <= std::max(kTimes * usual, kSeen * bounds_of(first).diagonal())) return;
  warnings.push_back(fmt::format(
      "{} ({}): its animation ends up to {:.2g} m from where it begins, and the body jumps there when it loops; "
      "export it as one that stays on the spot, or leave out \"loop\"",
      name, mesh.file.filename().string(), mesh.transform.scale * way));
}

void warn_of_open_loops(const Scene& scene, std::vector<std::string>& warnings) {
  for (size_t i = 0; i < scene.colliders.size(); ++i) {
    const auto& mesh = scene.colliders[i].mesh;
    if (mesh) warn_of_open_loop(*mesh, fmt::format("colliders[{}]", i), scene.frame_rate, warnings);
  }
  for (size_t c = 0; c < scene.cloths.size(); ++c) {
    const auto& skin = scene.cloths[c].skin;
    if (skin) warn_of_open_loop(*skin, fmt::format("cloths[{}].skin", c), scene.frame_rate, warnings);
  }
}

/// A garment and its skin are the same surface: pins that are elsewhere swing about on levers.
void warn_of_skin(const Simulation& simulation, size_t index, std::vector<std::string>& warnings) {
  const SceneCloth& cloth = simulation.scene().cloths[index];
  if (!cloth.skin) return;
  const std::string name = name_of_cloth(simulation.scene(), index);
  if (std::ranges::none_of(cloth.pins, [](const ScenePin& pin) { return pin.follow == "skin"; })) {
    warnings.push_back(fmt::format("{}: it has a skin, which moves nothing; let pins \"follow\": \"skin\"", name));
    return;
  }
  const ClothDesc& desc = simulation.cloths()[index];
  const float away = simulation.farthest_from_skin(static_cast<uint32_t>(index));
  if (away <= desc.asset->spacing * desc.transform.scale) return;
  warnings.push_back(fmt::format(
      "{}: its pins begin up to {:.2g} m away from its skin; check that \"parts\" of {} are the garment, and "
      "its \"transform\", if the garment was converted with a --unit or --scale",
      name, away, cloth.skin->file.filename().string()));
}

/// The surface that pins follow, if it deforms, by its path in the scene.
std::pair<std::string, const SceneMesh*> surface_of(const Scene& scene, size_t cloth, const std::string& follow) {
  const auto& skin = scene.cloths[cloth].skin;
  if (follow == "skin" && skin) return {fmt::format("cloths[{}].skin", cloth), &*skin};
  for (size_t i = 0; i < scene.colliders.size(); ++i) {
    const SceneCollider& collider = scene.colliders[i];
    if (collider.collider.name == follow && collider.mesh && collider.mesh->animation)
      return {fmt::format("colliders[{}]", i), &*collider.mesh};
  }
  return {};
}

/// From 1, of a surface that faces away from its middle everywhere, to -1, of one that faces it. By Gauss's theorem it
/// has the sign of the volume of one that is closed, or nearly, as garments are.
double outwardness(const std::vector<Vec3>& position, const std::vector<Triangle>& triangle) {
  const auto middle_of = [&](const Triangle& t) {
    return (1.0F / 3) * (position[t[0]] + position[t[1]] + position[t[2]]);
  };
  const auto area_of = [&](const Triangle& t) {
    return cross(position[t[1]] - position[t[0]], position[t[2]] - position[t[0]]);
  };
  double area = 0, outward = 0, all = 0;
  std::array<double, 3> sum{};
  for (const Triangle& t : triangle) {
    const Vec3 m = middle_of(t);
    const double a = length(area_of(t));
    area += a;
    sum[0] += a * m.x;
    sum[1] += a * m.y;
    sum[2] += a * m.z;
  }
  if (!(area > 0)) return 0;
  const Vec3 centre{static_cast<float>(sum[0] / area), static_cast<float>(sum[1] / area),
                    static_cast<float>(sum[2] / area)};
  for (const Triangle& t : triangle) {
    const Vec3 way = middle_of(t) - centre, normal = area_of(t);
    outward += dot(way, normal);
    all += length(way) * length(normal);
  }
  return all > 0 ? outward / all : 0;
}

/// What is behind a skin that is wound inwards is before it: its cloth could not leave its wearer.
void warn_of_inward_skins(const Scene& scene, size_t index, std::vector<std::string>& warnings) {
  constexpr double kInward = -0.15;
  std::set<std::string> told;
  for (const ScenePin& pin : scene.cloths[index].pins) {
    if (!pin.backstop) continue;
    const auto [name, mesh] = surface_of(scene, index, pin.follow);
    if (mesh == nullptr || !told.insert(name).second) continue;
    const TriangleSurface surface = read_body(*mesh);
    if (outwardness(surface.position, surface.triangle) >= kInward) continue;
    warnings.push_back(fmt::format(
        "{}: its \"backstop\" keeps points behind the surface of {} ({}) instead of before it, because most of its "
        "triangles face inwards; turn them over in the program that wrote the file (often \"flip normals\")",
        name_of_cloth(scene, index), name, mesh->file.filename().string()));
  }
}

/// What is set and changes nothing, and cloth that nothing can hold.
void warn_of_idle_settings(const Scene& scene, size_t index, std::vector<std::string>& warnings) {
  const SceneCloth& cloth = scene.cloths[index];
  const std::string name = name_of_cloth(scene, index);
  const auto meeting = std::count_if(scene.cloths.begin(), scene.cloths.end(),
                                     [](const SceneCloth& c) { return c.inter_collision.has_value(); });
  if (cloth.inter_collision && meeting < 2) {
    warnings.push_back(
        fmt::format("{}: \"inter_collision\" has no effect, since no other cloth has it; \"self_collision\" keeps the "
                    "layers of one cloth apart",
                    name));
  }
  if (cloth.motion.empty() && cloth.inertia_scale != Vec3{1, 1, 1})
    warnings.push_back(fmt::format("{}: \"inertia_scale\" has no effect without a \"motion\" of the cloth", name));
  const bool meets_cloth = cloth.inter_collision && meeting > 1;
  const bool meets_collider =
      std::ranges::any_of(scene.colliders, [&](const SceneCollider& c) { return meets(cloth.meets, c.collider); });
  if (cloth.pins.empty() && !meets_collider && !meets_cloth && falls(scene, cloth) && scene.frames > 0) {
    warnings.push_back(fmt::format("{}: it has no pins, and {}: it only falls; give it \"pins\", or {}", name,
                                   scene.colliders.empty() ? "there are no colliders" : "it meets no collider",
                                   scene.colliders.empty() ? "the scene a floor" : "a collider to meet"));
  }
}

/// Points that are no wider than that fit between those of another layer, in the middle of a cell.
void warn_of_narrow_points(const Simulation& simulation, size_t index, std::vector<std::string>& warnings) {
  constexpr float kFits = 0.71F, kHolds = 0.85F;  // spacings
  const SceneCloth& cloth = simulation.scene().cloths[index];
  const ClothDesc& made = simulation.cloths()[index];
  const float spacing = made.asset->spacing * made.transform.scale;
  const auto check = [&](const char* key, float distance) {
    if (distance < 0 || distance > kFits * spacing) return;
    warnings.push_back(fmt::format(
        "{}: \"{}\" keeps points {:.3g} m apart, which are {:.3g} m from their neighbours: other cloth comes "
        "through between them; give it a \"distance\" of {:.2g} or more, or convert the cloth with a larger "
        "--resolution",
        name_of_cloth(simulation.scene(), index), key, distance, spacing, kHolds * spacing));
  };
  if (cloth.self_collision) check("self_collision", cloth.self_collision->distance);
  if (cloth.inter_collision) check("inter_collision", cloth.inter_collision->distance);
}

/// Whether points lie in a plane, to a hundred thousandth of how far they are apart.
bool are_coplanar(const std::vector<Vec3>& points) {
  constexpr float kOff = 1e-5F;
  const auto farthest = [&](const auto& distance) {
    return *std::max_element(points.begin(), points.end(),
                             [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  };
  const Vec3 origin = points.front();
  const Vec3 along = farthest([&](const Vec3& p) { return length(p - origin); }) - origin;
  const auto off_line = [&](const Vec3& p) { return length(cross(along, p - origin)); };
  const Vec3 normal = cross(along, farthest(off_line) - origin);
  if (!(length(normal) > 0)) return true;
  const Vec3 n = normalized(normal);
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& p) { return std::abs(dot(n, p - origin)) <= kOff * length(along); });
}

/// Cloth that is squeezed in its plane and has nothing that would let it leave it.
void warn_of_flat_cloth(Simulation& simulation, std::vector<std::string>& warnings) {
  constexpr double kSqueezed = 0.99;  // of the springs' length, in the mean
  if (simulation.scene().imperfection > 0) return;
  for (size_t c = 0; c < simulation.cloths().size(); ++c) {
    const ClothDesc& cloth = simulation.cloths()[c];
    std::vector<Vec3> positions, points;
    simulation.solver().read_positions(static_cast<uint32_t>(c), positions);
    for (uint32_t p = 0; p < positions.size(); ++p)
      if (cloth.asset->valid(p)) points.push_back(positions[p]);
    if (points.empty() || !are_coplanar(points)) continue;
    if (measure_stretch(*cloth.asset, cloth.transform.scale, positions).mean > kSqueezed) continue;
    warnings.push_back(
        fmt::format("{}: it is squeezed in the plane that it lies in, and cannot fold: nothing draws it out of there; "
                    "give the scene an \"imperfection\" of 1e-6",
                    name_of_cloth(simulation.scene(), c)));
  }
}

/// [m] The radius of a ball with the area of a cloth at rest.
double ball_radius(const ClothAsset& asset, double scale) {
  const auto triangles = static_cast<double>(pixel_triangles(asset).size());
  const double side = double{asset.spacing} * scale;
  return std::sqrt(0.5 * triangles * side * side / (4 * std::numbers::pi));
}

/// Cloth that a pressure stretches because the substeps are too long for its springs, not because it is elastic. What
/// it stretches may be half of the springs, those around a tube, and cloth that did not hold may lie crumpled: then it
/// is as much as a ball of its area would be.
void warn_of_stretching_pressure(Simulation& simulation, std::vector<std::string>& warnings) {
  constexpr double kMuch = 0.03, kWanted = 0.02, kHalf = 0.5;
  constexpr double kMostSubsteps = 256, kFastest = 5000;  // [1/s] shorter substeps take 1.7 times as long
  const Scene& scene = simulation.scene();
  for (size_t c = 0; c < simulation.cloths().size(); ++c) {
    const auto index = static_cast<uint32_t>(c);
    const float pressure = pressure_at(scene.cloths[c], simulation.time());
    const Material& material = simulation.solver().material(index);
    if (pressure == 0 || material.stiffness >= 0) continue;
    const std::shared_ptr<const ClothAsset> asset = simulation.solver().asset(index);
    const float scale = simulation.cloths()[c].transform.scale;
    std::vector<Vec3> positions;
    simulation.solver().read_positions(index, positions);
    const StretchStatistics stretch = measure_stretch(*asset, scale, positions);
    // In a step of dt a spring resists like one of rho h^2 / dt^2 [N/m] that is in a row with its own.
    const double own = double{std::max(material.stretch_warp, material.stretch_weft)};
    const double way = double{asset->spacing} * double{scale} * scene.frame_rate * scene.substeps;
    const double resists = double{material.areal_density} * way * way * scene.relaxation_steps;
    const double as_ball = std::abs(pressure) * ball_radius(*asset, double{scale}) * (1 / own + 1 / resists);
    const bool shows = stretch.p99 - 1 > kHalf * as_ball || stretch.mean < 1 - kMuch;
    const double strain = shows ? std::max(stretch.mean - 1, as_ball) : stretch.mean - 1;
    const double too_long = strain * own / (own + resists);
    if (!(too_long > kMuch) || !std::isfinite(too_long) || scene.substeps >= kMostSubsteps) continue;
    const double fast = std::floor(kFastest / scene.frame_rate), most = scene.substeps < fast ? fast : kMostSubsteps;
    const double wanted = std::min(most, 8 * std::ceil(scene.substeps * std::sqrt(too_long / kWanted) / 8));
    warnings.push_back(fmt::format(
        "{}: its pressure of {:g} Pa stretches it by about {:.2g} %, its material alone by {:.2g} %: its springs "
        "do not keep up in {} substeps; give the scene about {:.0f} \"substeps\", or less pressure",
        name_of_cloth(scene, c), pressure, 100 * strain, 100 * (strain - too_long), scene.substeps, wanted));
  }
}

}  // namespace

std::string name_of_cloth(const Scene& scene, size_t cloth) {
  return fmt::format("cloths[{}] ({})", cloth, scene.cloths[cloth].asset.filename().string());
}

std::vector<std::string> scene_warnings(const Simulation& simulation) {
  std::vector<std::string> warnings;
  for (size_t c = 0; c < simulation.cloths().size(); ++c) {
    warn_of_loose_parts(simulation, c, warnings);
    warn_of_late_parts(simulation.scene(), c, warnings);
    warn_of_torn_jumps(simulation.scene(), c, warnings);
    warn_of_idle_settings(simulation.scene(), c, warnings);
    warn_of_narrow_points(simulation, c, warnings);
    warn_of_skin(simulation, c, warnings);
    warn_of_inward_skins(simulation.scene(), c, warnings);
  }
  warn_of_animated_bodies(simulation.scene(), warnings);
  warn_of_open_loops(simulation.scene(), warnings);
  return warnings;
}

std::vector<std::string> played_warnings(Simulation& simulation) {
  std::map<size_t, std::vector<size_t>> missed;  // by cloth
  for (const Simulation::CutMade& made : simulation.cuts_made())
    if (made.result == CutResult{}) missed[made.cloth].push_back(made.cut);
  std::vector<std::string> warnings;
  for (auto& [cloth, cuts] : missed) {
    std::sort(cuts.begin(), cuts.end());
    warnings.push_back(
        fmt::format("{}: {} met no cloth, so nothing was cut; check where the cloth is at that \"time\", "
                    "and the corners of the triangle",
                    name_of_cloth(simulation.scene(), cloth), list_of("cuts", cuts)));
  }
  warn_of_flat_cloth(simulation, warnings);
  warn_of_stretching_pressure(simulation, warnings);
  return warnings;
}

}  // namespace geocloth
