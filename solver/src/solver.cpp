// SPDX-License-Identifier: Apache-2.0
// The solver as its user sees it: checks what comes in, keeps pins and colliders between frames, chooses a backend and
// hands it one FrameInput per frame. The physics is in shaders/lib, the order of the passes in pass.cpp.

#include "geocloth/solver/solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "check_input.h"
#include "cpu/cpu_name.h"
#include "device_name.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "rest/inter_points.h"
#include "rest/sewing.h"
#include "rest/upload.h"
#include "solver_impl.h"

namespace geocloth {
namespace {

using shader::vec4;

std::string cloth_name(uint32_t number) {
  return "cloth " + std::to_string(number);
}

Vec3 vec3_of(const vec4& v) {
  return {v.x, v.y, v.z};
}

uint32_t fineness(const SolverSettings& settings) {
  if (settings.keep_momentum) return shader::kFineMomentum;
  return settings.frame_time / settings.substeps < kShortStep ? shader::kFineOffsets : shader::kFineOff;
}

/// The cpu is a device too; a GPU that goes by the same name comes before it.
bool names_cpu_only(const std::string& part) {
  return std::ranges::none_of(enumerate_devices(), [&](const DeviceInfo& device) {
    return is_part_of_name(part, device.name) ? device.backend != Backend::cpu && device.usable
                                              : device.backend == Backend::cpu;
  });
}

std::unique_ptr<SolverBackend> make_backend(SimulationData data, const SolverSettings& settings) {
  switch (settings.backend) {
    case Backend::cpu:
      if (!is_part_of_name(settings.device, cpu::cpu_name())) {
        throw Error(ErrorCode::device, "the cpu is '" + cpu::cpu_name() + "', whose name does not contain '" +
                                           settings.device + "'; name no device, or take another backend");
      }
      return make_cpu_backend(std::move(data), settings.threads);
    case Backend::vulkan:
      return make_vulkan_backend(std::move(data), settings.device);
    case Backend::automatic:
      break;
  }
  if (!settings.device.empty() && names_cpu_only(settings.device)) {
    return make_cpu_backend(std::move(data), settings.threads);
  }
  if (!settings.device.empty()) return make_vulkan_backend(std::move(data), settings.device);
  for (const DeviceInfo& device : enumerate_devices()) {
    if (device.chosen_automatically && device.backend == Backend::vulkan) {
      return make_vulkan_backend(std::move(data), device.name);
    }
  }
  return make_cpu_backend(std::move(data), settings.threads);
}

}  // namespace

Solver::Impl::Impl(std::span<const ClothDesc> cloths, const SolverSettings& settings, const BackendFactory& factory)
    : settings_(settings),
      fine_(fineness(settings)),
      calm_step_(settings.frame_time / settings.substeps),
      usual_substeps_(settings.substeps),
      substeps_(settings.substeps) {
  check(settings);
  for (uint32_t i = 0; i < cloths.size(); ++i) check(cloths[i], cloth_name(i));
  origin_ = choose_origin(cloths);

  SimulationData data;
  data.relaxation_steps = settings.relaxation_steps;
  data.fine = fine_ != shader::kFineOff;
  data.check = settings.check_copies;
  data.contact_forces = settings.contact_forces;
  data.timings = settings.timings;
  data.path = settings.path;
  for (const ClothDesc& desc : cloths)
    cloths_.push_back(made_of(desc, data.cloths.emplace_back(make_cloth_data(desc, origin_))));
  data.inter = inter_data(versions(), origin_);
  inter_origin_ = origin_;
  inter_ = data.inter.points.numbers;
  backend_ = factory(std::move(data));
}

/// @param data  the backend's
Solver::Impl::Cloth Solver::Impl::made_of(const ClothDesc& desc, const ClothData& data) {
  Cloth cloth;
  cloth.number = next_number_++;
  cloth.arrived = time_;
  cloth.asset = cloth.original = desc.asset;
  cloth.material = desc.material;
  cloth.fabrics = desc.fabrics;
  cloth.weakest = weakest_of(cloth);
  cloth.self_collision = desc.self_collision;
  cloth.inter_collision = desc.inter_collision;
  cloth.meets = desc.meets;
  cloth.start = desc.transform;
  cloth.scale = desc.transform.scale;
  cloth.displaced_in = clock().dt;
  cloth.row_of_pixel = split_rows(*desc.asset);
  cloth.particles = count_valid_pixels(*desc.asset);
  cloth.size = rest_size(*desc.asset, cloth.scale);
  cloth.middle = cloth.start_middle = box_of(*desc.asset, data.position).middle() + origin_;
  cloth.springs_per_sweep = data.springs_per_sweep;
  cloth.self = data.self.numbers;
  cloth.free_inverse_mass = inverse_masses(data);
  return cloth;
}

uint32_t Solver::Impl::add_cloth(const ClothDesc& desc) {
  check(desc, cloth_name(next_number_));
  const Vec3 place = choose_origin({&desc, 1});
  if (cloths_.empty()) {
    origin_ = place;
  } else {
    follow_cloths(place);
  }
  ClothData data = make_cloth_data(desc, origin_);
  const uint32_t number = cloths_.emplace_back(made_of(desc, data)).number;
  InterData inter;
  try {
    if (desc.inter_collision) inter = inter_data(versions(), origin_);
    backend_->add_cloth(std::move(data));
  } catch (...) {
    cloths_.pop_back();
    next_number_ = number;
    throw;
  }
  try {
    if (!inter.parts.empty()) take_inter(std::move(inter), origin_);
  } catch (...) {
    backend_->remove_cloth(static_cast<uint32_t>(cloths_.size() - 1));
    cloths_.pop_back();
    next_number_ = number;
    throw;
  }
  return number;
}

void Solver::Impl::remove_cloth(uint32_t cloth) {
  backend_->remove_cloth(cloth);
  const bool met_others = meets_others(cloths_[cloth]);
  cloths_.erase(cloths_.begin() + cloth);
  if (cloth < frame_.cloths.size()) frame_.cloths.erase(frame_.cloths.begin() + cloth);
  if (!met_others) return;
  for (Cloth& other : cloths_) other.disturbed = other.disturbed || meets_others(other);  // it may have lain on it
  take_inter_anew();
}

std::vector<uint32_t> Solver::Impl::cloths() const {
  std::vector<uint32_t> numbers(cloths_.size());
  std::ranges::transform(cloths_, numbers.begin(), &Cloth::number);
  return numbers;
}

uint32_t Solver::Impl::index_of(uint32_t number) const {
  const auto cloth = std::ranges::lower_bound(cloths_, number, {}, &Cloth::number);
  if (cloth != cloths_.end() && cloth->number == number) return static_cast<uint32_t>(cloth - cloths_.begin());
  throw Error(ErrorCode::invalid_argument,
              "solver: there is no " + cloth_name(number) + (number < next_number_ ? " any more" : "") + "; it has " +
                  std::to_string(cloths_.size()) + (cloths_.size() == 1 ? " cloth" : " cloths"));
}

std::string Solver::Impl::name_of(uint32_t cloth) const {
  return cloth_name(cloths_[cloth].number);
}

/// Of all cloths, as they are.
std::vector<Solver::Impl::Version> Solver::Impl::versions() const {
  std::vector<Version> versions;
  for (const Cloth& cloth : cloths_)
    versions.push_back({cloth.arrived, cloth.asset.get(), cloth.free_inverse_mass, cloth.material.friction});
  return versions;
}

/// Nothing where fewer than two cloths collide with others.
/// @param cloths  all
InterData Solver::Impl::inter_data(std::span<const Version> cloths, const Vec3& origin) const {
  std::vector<InterCloth> meeting;
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    const Cloth& cloth = cloths_[c];
    if (!cloth.inter_collision) continue;
    meeting.push_back({.cloth = c,
                       .number = cloth.number,
                       .arrived = cloths[c].arrived,
                       .asset = cloths[c].asset,
                       .start = cloth.start,
                       .inverse_mass = cloths[c].inverse_mass,
                       .distance = cloth.inter_collision->distance,
                       .friction = cloths[c].friction});
  }
  return meeting.size() > 1 ? make_inter_data(meeting, origin) : InterData{};
}

void Solver::Impl::set_wind(const Wind& wind) {
  check(wind, "wind");
  scene_changed_ = scene_changed_ || !wind_ || !(*wind_ == wind);
  wind_ = wind;
}

void Solver::Impl::set_gravity(const Vec3& gravity) {
  SolverSettings changed = settings_;
  changed.gravity = gravity;
  check(changed);
  scene_changed_ = scene_changed_ || !(gravity == settings_.gravity);
  settings_ = changed;
}

void Solver::Impl::set_time_step(double frame_time, uint32_t substeps) {
  SolverSettings changed = settings_;
  changed.frame_time = frame_time;
  changed.substeps = substeps;
  check(changed);
  settings_ = changed;
  constexpr double kCalm = 1.25;  // a step that differs by less leaves cloth where it lies
  const double step = frame_time / substeps;
  if (step <= kCalm * calm_step_ && calm_step_ <= kCalm * step) return;
  scene_changed_ = true;
  calm_step_ = step;
}

/// Sorts by pixel; of several on one the last one counts. Mostly they are a few lists that ascend, one after another.
void Solver::Impl::keep_last_of_each(std::vector<PixelPin>& pins) {
  constexpr int kFew = 8;
  const auto sorted_from = [&](auto first) {
    return std::ranges::is_sorted_until(first, pins.end(), {}, &PixelPin::first);
  };
  auto sorted = sorted_from(pins.begin());
  for (int merged = 0; sorted != pins.end() && merged < kFew; ++merged) {
    const auto next = sorted_from(sorted);
    std::ranges::inplace_merge(pins.begin(), sorted, next, {}, &PixelPin::first);
    sorted = next;
  }
  if (sorted != pins.end()) std::ranges::stable_sort(pins, {}, &PixelPin::first);
  size_t kept = 0;
  for (size_t k = 0; k < pins.size(); ++k)
    if (k + 1 == pins.size() || pins[k].first != pins[k + 1].first) pins[kept++] = pins[k];
  pins.resize(kept);
}

void Solver::Impl::set_pins(uint32_t cloth, std::span<const Pin> pins) {
  const Cloth& c = cloths_[cloth];
  std::vector<PixelPin>& next = next_pins_;
  next.clear();
  std::string where = name_of(cloth) + ": pin of pixel ";
  const size_t before_pixel = where.size();
  for (const Pin& pin : pins) {
    where.resize(before_pixel);
    where += std::to_string(pin.pixel);
    if (pin.pixel >= c.asset->pixel_count() || !c.asset->valid(pin.pixel)) {
      throw Error(ErrorCode::invalid_argument, where + ": there is no cloth at that pixel");
    }
    check_position(pin.target, where);
    check_pin_hold(pin.frequency, pin.max_distance, where);
    PinState state{pin.target, pin.target, {pin.frequency, pin.max_distance}, {}};
    if (pin.backstop) {
      check_backstop(*pin.backstop, state.held(), where);
      const Vec3 middle = -(pin.backstop->distance + pin.backstop->radius) * pin.backstop->outward;
      state.back = {middle, middle, pin.backstop->radius};
    }
    const uint32_t row = c.row_of_pixel[pin.pixel];
    if (row == kNoPixel) {
      next.emplace_back(pin.pixel, state);
      continue;
    }
    for (const uint32_t copy : c.asset->splits.copies(row)) next.emplace_back(copy, state);
  }
  keep_last_of_each(next);
  if (c.placed_at != time_) {
    auto before = c.pins.begin();
    for (auto& [pixel, pin] : next) {
      while (before != c.pins.end() && before->first < pixel) ++before;
      if (before == c.pins.end() || before->first != pixel) continue;
      pin.from = before->second.target;
      if (before->second.back.radius > 0) pin.back.from = before->second.back.to;
    }
  }
  Cloth& target = cloths_[cloth];
  const bool same =
      std::equal(next.begin(), next.end(), c.pins.begin(), c.pins.end(),
                 [](const auto& a, const auto& b) { return a.first == b.first && a.second.held() == b.second.held(); });
  target.pins_changed = target.pins_changed || !same;
  if (!same) target.unruly_until = time_ + kUnruly;  // they may be far from their points
  target.disturbed = target.disturbed || !std::equal(next.begin(), next.end(), target.pins.begin(), target.pins.end(),
                                                     [](const auto& a, const auto& b) {
                                                       return a.first == b.first && a.second.is_as(b.second);
                                                     });
  std::swap(target.pins, next);
}

std::vector<uint32_t> Solver::Impl::held_pixels(uint32_t cloth) const {
  std::vector<uint32_t> held;
  for (const auto& [pixel, pin] : cloths_[cloth].pins)
    if (pin.held()) held.push_back(pixel);
  return held;
}

void Solver::Impl::set_meets(uint32_t cloth, uint32_t groups) {
  Cloth& c = cloths_[cloth];
  c.disturbed = c.disturbed || groups != c.meets;
  c.meets = groups;
}

void Solver::Impl::set_pressure(uint32_t cloth, float pressure) {
  check_pressure(pressure, name_of(cloth));
  Cloth& c = cloths_[cloth];
  c.disturbed = c.disturbed || pressure != c.pressure;
  c.pressure = pressure;
}

void Solver::Impl::set_gravity_scale(uint32_t cloth, float scale) {
  check_gravity_scale(scale, name_of(cloth));
  Cloth& c = cloths_[cloth];
  c.disturbed = c.disturbed || scale != c.gravity_scale;
  c.gravity_scale = scale;
}

void Solver::Impl::set_wind_scale(uint32_t cloth, float scale) {
  check_wind_scale(scale, name_of(cloth));
  Cloth& c = cloths_[cloth];
  c.disturbed = c.disturbed || scale != c.wind_scale;
  c.wind_scale = scale;
}

void Solver::Impl::set_sewing(uint32_t cloth, std::optional<float> share) {
  if (share) check_sewing(*share, name_of(cloth));
  Cloth& c = cloths_[cloth];
  c.disturbed = c.disturbed || share != c.sewn_to;
  if (share && (!c.sewn_from || *share < *c.sewn_from)) c.unruly_until = time_ + kUnruly;
  if (share && !c.sewn_from) c.seen.reset();  // what is far apart may come together at once
  if (!share || !c.sewn_from) c.sewn_from = share;
  c.sewn_to = share;
}

float Solver::Impl::sewing_gap(uint32_t cloth) {
  const Cloth& c = cloths_[cloth];
  if (c.asset->sewing.empty()) return 0;
  std::vector<Vec3> position;
  read_positions(cloth, position);
  float gap = 0;
  for (const auto& [a, b] : c.asset->sewing)
    gap = std::max(gap, length(position[b] - position[a]) / sewing_thread(*c.asset, c.scale, a, b));
  return gap;
}

void Solver::Impl::set_parent(uint32_t cloth, const Transform& pose, const Vec3& inertia_scale, bool teleport) {
  check_parent(pose, inertia_scale, name_of(cloth) + ": parent");
  Cloth& c = cloths_[cloth];
  if (!c.parent_from) c.parent_from = c.parent_first = pose;
  c.disturbed =
      c.disturbed || teleport || pose.translate != c.parent_from->translate || pose.rotate != c.parent_from->rotate;
  c.parent_to = pose;
  c.inertia_scale = inertia_scale;
  c.teleport = c.teleport || teleport;
}

/// Moves the cloths of parents that jump as they are, with their velocities, from the old poses to the new ones. Pins
/// that were set to other places come from there too: soft ones draw by the speed of their targets.
void Solver::Impl::carry_over() {
  struct State {
    uint32_t cloth;
    std::vector<vec4> position, previous;
  };
  std::vector<State> states;
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    if (!cloths_[c].teleport) continue;
    State& state = states.emplace_back(State{c, {}, {}});
    backend_->read_positions(c, state.position);
    backend_->read_previous(c, state.previous);
  }
  if (states.empty()) return;
  const Vec3 origin_before = origin_;
  follow_cloths();  // what is written there has the digits that it has near the origin
  for (State& state : states) {
    Cloth& c = cloths_[state.cloth];
    const Transform& from = *c.parent_from;
    const Transform& to = *c.parent_to;
    const Quat turn = to.rotate * conjugate(from.rotate);
    for (auto& [pixel, pin] : c.pins) {
      if (pin.from != pin.target) pin.from = rotate(turn, pin.from - from.translate) + to.translate;
      if (pin.back.from != pin.back.to) pin.back.from = rotate(turn, pin.back.from);
    }
    for (uint32_t p = 0; p < state.position.size(); ++p) {
      if (!c.asset->valid(p)) continue;
      vec4 &position = state.position[p], &previous = state.previous[p];
      const Vec3 x = vec3_of(position);
      const Vec3 moved = rotate(turn, x + (origin_before - from.translate)) + (to.translate - origin_);
      const Vec3 before = moved - rotate(turn, x - vec3_of(previous));
      position = {moved.x, moved.y, moved.z, position.w};
      previous = {before.x, before.y, before.z, previous.w};
    }
    backend_->write_state(state.cloth, state.position, state.previous);
    c.rides = {};
    c.seen.reset();
    c.parent_from = c.parent_to;
    c.teleport = false;
  }
}

/// Where a cloth is in the next frame as far as it is told by pins or a parent; else where it was seen last.
Vec3 Solver::Impl::middle_of_told(const Cloth& cloth) const {
  Vec3 sum;
  float held = 0;
  for (const auto& [pixel, pin] : cloth.pins) {
    sum = sum + pin.target;
    held += 1;
  }
  if (held > 0) return (1 / held) * sum;
  if (!cloth.parent_to) return cloth.middle;
  const Quat turn = cloth.parent_to->rotate * conjugate(cloth.parent_first.rotate);
  return cloth.parent_to->translate + rotate(turn, cloth.start_middle - cloth.parent_first.translate);
}

/// Keeps the origin near the cloths, whose positions have no more digits than single precision. Only where they go is
/// looked at that is told; cloth that nothing holds is looked for where it or colliders may have gone far.
/// @param arriving  [m] place of a cloth that comes now
void Solver::Impl::follow_cloths(const std::optional<Vec3>& arriving) {
  if (cloths_.empty()) return;
  constexpr float kFar = 3, kLooked = 1;  // [m] until the origin comes after, and where cloth was just looked for
  bool looked = false, colliders_went = false;
  for (size_t i = 0; i < colliders_to_.size(); ++i)
    colliders_went = colliders_went || length(colliders_to_[i].pose.translate - places_seen_[i]) > kFar;
  if (colliders_went) places_seen_ = collider_places();
  ClothBox middles;
  if (arriving) middles.add(*arriving);
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    if (cloth.is_free() && (colliders_went || cloth.strayed > kFar)) {
      cloth.strayed = 0;
      looked = true;
      std::vector<vec4> position;
      backend_->read_positions(c, position);
      const Vec3 middle = box_of(*cloth.asset, position).middle() + origin_;
      if (is_finite(middle)) cloth.middle = middle;
    }
    middles.add(middle_of_told(cloth));
  }
  const float most = looked ? kLooked : kFar;
  const auto whole_metres = [&](float away) { return std::abs(away) > most ? std::round(away) : 0.F; };
  const Vec3 away = middles.middle() - origin_;
  const Vec3 by{whole_metres(away.x), whole_metres(away.y), whole_metres(away.z)};
  if (by == Vec3{}) return;
  backend_->shift(by);
  origin_ = origin_ + by;
  for (Cloth& cloth : cloths_) {
    cloth.resting.reset();
    cloth.seen.reset();
  }
}

void Solver::Impl::read_positions(uint32_t cloth, std::vector<Vec3>& out) {
  const ClothAsset& asset = *cloths_[cloth].asset;
  std::vector<vec4> raw;
  backend_->read_positions(cloth, raw);
  out.assign(raw.size(), {});
  for (uint32_t p = 0; p < raw.size(); ++p)
    if (asset.valid(p)) out[p] = vec3_of(raw[p]) + origin_;
}

void Solver::Impl::read_normals(uint32_t cloth, std::vector<Vec3>& out) {
  std::vector<vec4> raw;
  backend_->read_normals(cloth, raw);
  out.resize(raw.size());
  std::transform(raw.begin(), raw.end(), out.begin(), vec3_of);
}

void Solver::Impl::read_velocities(uint32_t cloth, std::vector<Vec3>& out) {
  std::vector<vec4> now, before, carry;
  backend_->read_positions(cloth, now);
  backend_->read_previous(cloth, before);
  backend_->read_carry(cloth, carry);
  const auto inverse_dt = static_cast<float>(1 / cloths_[cloth].displaced_in);
  out.resize(now.size());
  for (size_t p = 0; p < now.size(); ++p)
    out[p] = inverse_dt * (vec3_of(now[p]) - vec3_of(before[p]) + vec3_of(carry[p]));
}

void Solver::Impl::write_state(uint32_t cloth, std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  const Cloth& c = cloths_[cloth];
  const ClothAsset& asset = *c.asset;
  if (positions.size() != asset.pixel_count() || velocities.size() != asset.pixel_count()) {
    throw Error(ErrorCode::invalid_argument, name_of(cloth) +
                                                 ": write_state needs one position and one velocity for each of its " +
                                                 std::to_string(asset.pixel_count()) + " pixels");
  }
  // Everything is checked before anything changes, and no text is put together of what is right.
  const auto where = [&](uint32_t p) { return name_of(cloth) + ": pixel " + std::to_string(p); };
  const auto source_of = [&](uint32_t p) {
    const uint32_t row = c.row_of_pixel[p];
    return row == kNoPixel ? p : asset.splits.copies(row).front();
  };
  ClothBox box;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    if (!is_position(positions[p])) check_position(positions[p], where(p));
    if (!is_velocity(velocities[p])) check_velocity(velocities[p], where(p));
    box.add(positions[p]);
  }
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p) || !(length(positions[p] - positions[source_of(p)]) > 1e-6F)) continue;
    throw Error(ErrorCode::invalid_argument, where(p) + " is a copy of pixel " + std::to_string(source_of(p)) +
                                                 ", but lies elsewhere; copies must agree");
  }
  std::vector<vec4> position(asset.pixel_count(), {0, 0, 0, 0}), previous(asset.pixel_count(), {0, 0, 0, 0});
  if (!box.empty()) cloths_[cloth].middle = box.middle();
  follow_cloths();
  const auto dt = static_cast<float>(c.displaced_in);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    const uint32_t source = source_of(p);
    const Vec3 x = positions[source] - origin_;
    const Vec3 before = x - dt * velocities[source];
    position[p] = {x.x, x.y, x.z, c.holds(p) ? 0.F : c.free_inverse_mass[p]};
    previous[p] = {before.x, before.y, before.z, 0};
  }
  Cloth& written = cloths_[cloth];
  written.disturbed = true;
  written.unruly_until = time_ + kUnruly;
  written.rides = {};
  written.seen.reset();
  if (written.teleport) {  // the state is where the parent has jumped to, and so are the pins
    written.teleport = false;
    written.parent_from = written.parent_to;
    written.placed_at = time_;
    for (auto& [pixel, pin] : written.pins) pin.arrive();
  }
  backend_->write_state(cloth, position, previous);
}

SolverStatistics Solver::Impl::statistics() {
  SolverStatistics statistics;
  for (const Cloth& cloth : cloths_) {
    statistics.particles += cloth.particles;
    statistics.springs += cloth.springs_per_sweep;
    statistics.asleep += cloth.asleep ? 1 : 0;
  }
  backend_->fill_statistics(statistics);
  return statistics;
}

const char* to_string(SolverPath path) {
  switch (path) {
    case SolverPath::plain:
      return "plain";
    case SolverPath::tiled:
      return "tiled";
    case SolverPath::tiny:
      return "tiny";
    case SolverPath::automatic:
      break;
  }
  return "auto";
}

Solver::Solver(std::span<const ClothDesc> cloths, const SolverSettings& settings)
    : Solver(std::make_unique<Impl>(cloths, settings,
                                    [&](SimulationData data) { return make_backend(std::move(data), settings); })) {}
Solver::Solver(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::~Solver() = default;

uint32_t Solver::add_cloth(const ClothDesc& cloth) {
  return impl_->add_cloth(cloth);
}
void Solver::remove_cloth(uint32_t cloth) {
  impl_->remove_cloth(impl_->index_of(cloth));
}
std::vector<uint32_t> Solver::cloths() const {
  return impl_->cloths();
}
void Solver::set_colliders(std::span<const Collider> colliders, bool teleport) {
  impl_->set_colliders(colliders, teleport);
}
void Solver::set_wind(const Wind& wind) {
  impl_->set_wind(wind);
}
void Solver::set_gravity(const Vec3& gravity) {
  impl_->set_gravity(gravity);
}
void Solver::set_time_step(double frame_time, uint32_t substeps) {
  impl_->set_time_step(frame_time, substeps);
}
void Solver::set_pins(uint32_t cloth, std::span<const Pin> pins) {
  impl_->set_pins(impl_->index_of(cloth), pins);
}
std::vector<uint32_t> Solver::held_pixels(uint32_t cloth) const {
  return impl_->held_pixels(impl_->index_of(cloth));
}
void Solver::set_parent(uint32_t cloth, const Transform& pose, const Vec3& inertia_scale, bool teleport) {
  impl_->set_parent(impl_->index_of(cloth), pose, inertia_scale, teleport);
}
void Solver::set_material(uint32_t cloth, const Material& material) {
  impl_->set_material(impl_->index_of(cloth), material);
}

void Solver::set_fabric(uint32_t cloth, uint32_t fabric, const Material& material) {
  impl_->set_fabric(impl_->index_of(cloth), fabric, material);
}

const Material& Solver::fabric(uint32_t cloth, uint32_t fabric) const {
  return impl_->fabric(impl_->index_of(cloth), fabric);
}

const Material& Solver::material(uint32_t cloth) const {
  return impl_->material(impl_->index_of(cloth));
}

void Solver::set_meets(uint32_t cloth, uint32_t groups) {
  impl_->set_meets(impl_->index_of(cloth), groups);
}

void Solver::set_pressure(uint32_t cloth, float pressure) {
  impl_->set_pressure(impl_->index_of(cloth), pressure);
}

void Solver::set_gravity_scale(uint32_t cloth, float scale) {
  impl_->set_gravity_scale(impl_->index_of(cloth), scale);
}

void Solver::set_wind_scale(uint32_t cloth, float scale) {
  impl_->set_wind_scale(impl_->index_of(cloth), scale);
}

void Solver::set_sewing(uint32_t cloth, std::optional<float> share) {
  impl_->set_sewing(impl_->index_of(cloth), share);
}

float Solver::sewing_gap(uint32_t cloth) {
  return impl_->sewing_gap(impl_->index_of(cloth));
}
CutResult Solver::cut(uint32_t cloth, const std::array<Vec3, 3>& triangle) {
  return impl_->cut(impl_->index_of(cloth), triangle);
}
CutResult Solver::tear(uint32_t cloth, float stretch) {
  return impl_->tear(impl_->index_of(cloth), stretch);
}
std::shared_ptr<const ClothAsset> Solver::asset(uint32_t cloth) const {
  return impl_->asset(impl_->index_of(cloth));
}
void Solver::step() {
  impl_->step();
}
void Solver::read_positions(uint32_t cloth, std::vector<Vec3>& out) {
  impl_->read_positions(impl_->index_of(cloth), out);
}
void Solver::read_normals(uint32_t cloth, std::vector<Vec3>& out) {
  impl_->read_normals(impl_->index_of(cloth), out);
}
void Solver::read_velocities(uint32_t cloth, std::vector<Vec3>& out) {
  impl_->read_velocities(impl_->index_of(cloth), out);
}
void Solver::write_state(uint32_t cloth, std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  impl_->write_state(impl_->index_of(cloth), positions, velocities);
}
std::vector<ContactForce> Solver::contact_forces() {
  return impl_->contact_forces(std::nullopt);
}
std::vector<ContactForce> Solver::contact_forces(uint32_t cloth) {
  return impl_->contact_forces(impl_->index_of(cloth));
}
bool Solver::asleep(uint32_t cloth) const {
  return impl_->asleep(impl_->index_of(cloth));
}
uint32_t Solver::cloth_count() const {
  return impl_->cloth_count();
}
SolverStatistics Solver::statistics() {
  return impl_->statistics();
}
std::vector<std::byte> Solver::save() {
  std::vector<std::byte> state;
  impl_->save(state);
  return state;
}
void Solver::save(std::vector<std::byte>& state) {
  impl_->save(state);
}
void Solver::restore(std::span<const std::byte> state) {
  impl_->restore(state);
}
void Solver::wait() {
  impl_->backend().wait();
}

}  // namespace geocloth
