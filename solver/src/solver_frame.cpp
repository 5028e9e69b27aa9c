// SPDX-License-Identifier: Apache-2.0
// What a frame is told: substeps as fast colliders need them, pins, parents, colliders and the cloths that are asleep.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "check_input.h"
#include "colliders/ways.h"
#include "geocloth/asset/grid_mesh.h"
#include "rest/fabrics.h"
#include "rest/self_points.h"
#include "rest/upload.h"
#include "solver_impl.h"

namespace geocloth {
namespace {

using shader::vec4;

bool blows(const std::optional<Wind>& wind) {
  return wind && length(wind->velocity) > 0 && (wind->drag > 0 || wind->lift > 0);
}

constexpr float kFastWay = 0.2F;    // spacings in a substep
constexpr float kLimitSteps = 512;  // of 1: plans are made anew for another limit, which is not for every frame

/// How many substeps in place of one a collider is to have.
struct Haste {
  float way;      ///< [m] that it may go in a substep so that the cloth in its way can follow
  uint32_t most;  ///< no more than that
};

/// One that is so small that it pushes a few cells only opens them before their neighbours have its speed: many short
/// steps, the shorter the smaller it is.
/// @param most  for a small one
Haste haste_of(const shader::ColliderShape& shape, float spacing, uint32_t most) {
  constexpr float kSmall = 8, kWide = 2, kThinnest = 0.5F;  // in spacings
  constexpr uint32_t kUsual = 4;
  const float far = kFastWay * spacing;
  if (radius_of(shape) > double{kSmall * spacing}) return {far, kUsual};
  return {far * std::clamp(thickness_of(shape) / (kWide * spacing), kThinnest / kWide, 1.F), std::max(most, kUsual)};
}

/// Whether pins hold every point.
bool hangs(const ClothAsset& asset, std::span<const shader::Attachment> attachments,
           std::span<const float> inverse_mass) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && inverse_mass[p] > 0 && attachments[p].anchor == shader::kNoAnchor) return false;
  return true;
}

/// Whether few springs carry what hangs on the pins, as at a sheet's corners. Each point is attached to the pin that is
/// nearest to it, straight through those about the pin, which are drawn to it from all sides.
bool hangs_by_few(const ClothAsset& asset, std::span<const float> inverse_mass) {
  constexpr double kMuch = 3;  // times what a spring below the upper row of a square carries
  size_t springs = 0;
  for_structural_springs(asset, [&](uint32_t a, uint32_t b) {
    if ((inverse_mass[a] == 0) != (inverse_mass[b] == 0)) ++springs;
  });
  const auto hanging = std::count_if(inverse_mass.begin(), inverse_mass.end(), [](float w) { return w > 0; });
  return springs > 0 && std::sqrt(static_cast<double>(hanging)) > kMuch * static_cast<double>(springs);
}

/// [m]
template <class Cloths>
double thickest(const Cloths& cloths) {
  double thickness = 0;
  for (const auto& cloth : cloths) thickness = std::max(thickness, double{cloth.material.thickness});
  return thickness;
}

/// A fast collider pushes many cells at once, and what one gains the next takes away: several rounds settle it. At
/// seams each side pushes its own copies, which take the mean.
/// @param hasty  the frame has more substeps for a collider that the cloth may meet
uint32_t cell_rounds(float way, float spacing, bool seams, bool hasty) {
  constexpr float kSlow = 0.1F;  // in spacings
  if (hasty || way > kSlow * spacing) return 4;
  return seams ? 2 : 1;
}

/// [m] Depth of a contact that friction grows with: what weight alone presses in a long step, and what a collider may
/// go in a substep before a frame has more of them. Cloth is drawn deeper by springs that are stretched about an edge.
float grip_of(const ClothFrame& frame, float spacing) {
  constexpr float kPressed = 0.2F;  // in spacings
  const shader::vec4& fall = frame.params.gravity_step;
  return kPressed * spacing + std::hypot(fall.x, fall.y, fall.z);
}

}  // namespace

FrameClock Solver::Impl::clock() const {
  return {time_, settings_.frame_time / substeps_, substeps_};
}

std::optional<Wind> Solver::Impl::wind_on(const Cloth& cloth) const {
  std::optional<Wind> wind = wind_;
  if (wind) wind->velocity = cloth.wind_scale * wind->velocity;
  return wind;
}

float Solver::Impl::stretch_limit(const Cloth& cloth) const {
  const float stretch = largest_stretch(cloth.weakest, gravity_of(cloth), wind_on(cloth), cloth.pressure, cloth.reach);
  return stretch > 0 ? 1 + stretch : 0;
}

/// How the parent of a cloth moves in the next frame, seen from the middle of its pins, else from where it is on the
/// parent.
std::optional<ParentWay> Solver::Impl::parent_way(const Cloth& cloth) {
  if (!cloth.parent_to) return std::nullopt;
  const Transform& from = *cloth.parent_from;
  if (from.rotate == cloth.parent_to->rotate) return ParentWay(from, *cloth.parent_to, from.translate);
  Vec3 center;
  for (const auto& [pixel, pin] : cloth.pins)
    center = center + (1 / static_cast<float>(cloth.pins.size())) * (pin.from - from.translate);
  if (cloth.pins.empty()) {
    const Quat turn = from.rotate * conjugate(cloth.parent_first.rotate);
    center = rotate(turn, cloth.start_middle - cloth.parent_first.translate);
  }
  return ParentWay(from, *cloth.parent_to, from.translate + center);
}

void Solver::Impl::fill_cloth_frame(Cloth& cloth, ClothFrame& frame) const {
  frame.params = cloth_params(cloth.material, clock(), gravity_of(cloth), wind_, cloth.wind_scale, cloth.pressure);
  frame.params.gravity_step.w = static_cast<float>(clock().dt / cloth.displaced_in);
  frame.params.inverse_dt2 = static_cast<float>(1 / (cloth.compliance_step * cloth.compliance_step));
  set_imperfection(settings_.imperfection, gravity_of(cloth), cloth.size, origin_, frame.params);
  frame.params.fine = fine_;
  frame.sewn = cloth.sewn_to.has_value();
  frame.seams_closed = cloth.sewn_from == 0.F && cloth.sewn_to == 0.F;
  frame.params.sewing_before = cloth.sewn_from.value_or(0);
  frame.params.sewing_after = cloth.sewn_to.value_or(0);
  frame.params.stretch_limit = stretch_limit(cloth);
  frame.params.width = cloth.asset->width;
  frame.params.height = cloth.asset->height;
  set_self_numbers(cloth.self, frame.params);
  if (meets_others(cloth)) {
    frame.params.inter_points = inter_.points;
    frame.params.inter_buckets = inter_.buckets;
  }
  const std::optional<ParentWay> parent = parent_way(cloth);
  if (parent) {
    set_frame_motion(frame.params, *cloth.parent_from, *cloth.parent_to, *parent, cloth.inertia_scale, substeps_,
                     origin_);
  }
  frame.pins.clear();
  cloth.pin_targets.clear();
  for (auto& [pixel, pin] : cloth.pins) {
    cloth.pin_targets.push_back(pin.target);
    const PinBow bow = parent ? parent->bow_of(pin.from, pin.target) : PinBow{};
    frame.pins.push_back(
        pin_target(pixel, pin.from - origin_, pin.target - origin_, pin.hold, pin.back, bow, clock().dt));
    pin.arrive();
  }
  frame.pulled_apart = pull_of_pins(cloth, 0) > frame.params.stretch_limit;
  if (frame.pulled_apart) {
    constexpr float kFew = 4;  // spacings: what two pins so near tear open is not worth slack everywhere
    const float pull = pull_of_pins(cloth, kFew * cloth.asset->spacing * cloth.scale);
    frame.params.stretch_limit = std::max(frame.params.stretch_limit, std::ceil(kLimitSteps * pull) / kLimitSteps);
  }
  ease_limit(cloth, frame);
  frame.slack_pins = cloth.hangs_by_few || has_pins_above(cloth) || sags_between_pins(cloth);
}

/// What was pulled apart and is let go draws itself together; attachments that were short at once would throw it.
void Solver::Impl::ease_limit(Cloth& cloth, ClothFrame& frame) const {
  constexpr double kHold = 0.25;  // [s]
  constexpr float kEase = 0.05F;  // [1/s]
  float& limit = frame.params.stretch_limit;
  if (frame.pulled_apart) cloth.pulled_at = time_;
  if (time_ - cloth.pulled_at > kHold) cloth.limit -= kEase * static_cast<float>(settings_.frame_time);
  cloth.limit = std::max(cloth.limit, limit);
  if (limit == cloth.limit) return;
  limit = std::ceil(kLimitSteps * cloth.limit) / kLimitSteps;
  frame.pulled_apart = true;
}

/// How many times as far as along the cloth two pins are from each other, at most. Attachments that were shorter would
/// hold each half of the cloth to its own pin, and one row of springs between them would take all of the stretch.
/// @param least  [m] shorter ways do not count
float Solver::Impl::pull_of_pins(const Cloth& cloth, float least) {
  float pull = 0;
  for (const PinWay& way : cloth.pin_ways) {
    if (!(way.length > least)) continue;
    pull = std::max(pull, length(cloth.pin_targets[way.b] - cloth.pin_targets[way.a]) / way.length);
  }
  return pull;
}

/// Cloth falls past the lower ones and hangs from the upper ones, from whose way its attachments lead astray.
bool Solver::Impl::has_pins_above(const Cloth& cloth) const {
  constexpr float kSteep = 0.25F;  // of the longest way to a pin
  const Vec3 gravity = gravity_of(cloth);
  if (!(length(gravity) > 0)) return false;
  const Vec3 down = normalized(gravity);
  float highest = std::numeric_limits<float>::max(), lowest = -highest;
  for (const auto& [pixel, pin] : cloth.pins) {
    if (!pin.held()) continue;
    highest = std::min(highest, dot(down, pin.target));
    lowest = std::max(lowest, dot(down, pin.target));
  }
  return lowest - highest > kSteep * cloth.reach;
}

/// Cloth hangs in a bow between pins that are nearer to each other than along it: straight to either pin its points
/// have a shorter way than along the bow, so that no attachment keeps its length.
bool Solver::Impl::sags_between_pins(const Cloth& cloth) {
  constexpr float kLong = 0.5F;  // of the longest way to a pin: what sags between neighbours is the fold of a moment
  constexpr float kNear = 0.9F;  // of the way along the cloth
  return std::any_of(cloth.pin_ways.begin(), cloth.pin_ways.end(), [&](const PinWay& way) {
    return way.length > kLong * cloth.reach &&
           length(cloth.pin_targets[way.b] - cloth.pin_targets[way.a]) < kNear * way.length;
  });
}

/// What a frame says of other pins than the one before had.
void Solver::Impl::change_pins(Cloth& cloth, ClothFrame& frame) const {
  const bool pins_changed = std::exchange(cloth.pins_changed, false);
  const bool masses_changed = std::exchange(cloth.masses_changed, false);
  cloth.pins_anew = pins_changed || masses_changed;
  frame.attachments.clear();
  if (pins_changed) {
    take_pins(cloth, frame);
  } else if (masses_changed) {
    frame.inverse_mass = masses_of(cloth);
  }
}

/// [1/kg] The inverse ones of all pixels.
std::vector<float> Solver::Impl::masses_of(const Cloth& cloth) {
  std::vector<float> masses = cloth.free_inverse_mass;
  for (const auto& [pixel, pin] : cloth.pins)
    if (pin.held()) masses[pixel] = 0;
  return masses;
}

/// What follows from which points are pinned.
void Solver::Impl::take_pins(Cloth& cloth, ClothFrame& frame) const {
  cloth.hangs = cloth.hangs_by_few = false;
  cloth.pin_ways.clear();
  cloth.reach = 0;
  frame.inverse_mass = masses_of(cloth);
  std::vector<uint32_t> pixels, pinned;
  for (const auto& [pixel, pin] : cloth.pins) {
    pixels.push_back(pixel);
    if (pin.held()) pinned.push_back(pixel);
  }
  if (stretch_limit(cloth) > 0) {
    frame.attachments = make_attachments(*cloth.asset, cloth.scale, pinned);
    cloth.pin_ways = ways_between_pins(*cloth.asset, cloth.scale, frame.attachments, pinned);
    const auto number_of = [&](uint32_t pixel) {
      return static_cast<uint32_t>(std::lower_bound(pixels.begin(), pixels.end(), pixel) - pixels.begin());
    };
    for (PinWay& way : cloth.pin_ways) way = {number_of(way.a), number_of(way.b), way.length};
    if (pinned.empty()) cloth.reach = cloth.size;
    for (const shader::Attachment& a : frame.attachments) cloth.reach = std::max(cloth.reach, a.reach);
    if (!cloth.fabrics.empty())
      frame.attachments = make_attachments(*cloth.asset, cloth.scale, pinned, stretch_shares(cloth));
    cloth.hangs = hangs(*cloth.asset, frame.attachments, frame.inverse_mass);
    cloth.hangs_by_few = hangs_by_few(*cloth.asset, frame.inverse_mass);
  }
}

/// How much longer than at rest each fabric may be, in shares of the one that stretches most, by which the limit is. A
/// stiff shirt is held tight below an elastic band. By the least load that there is: more of it holds stiff cloth
/// looser than need be, never below its length at rest.
std::vector<float> Solver::Impl::stretch_shares(const Cloth& cloth) {
  const FabricMap fabrics({.material = cloth.material, .fabrics = cloth.fabrics}, *cloth.original);
  const auto longest = [&](const Material& material) { return 1 + largest_stretch(material, {}, {}, 0, cloth.reach); };
  const float most = longest(cloth.weakest);
  std::vector<float> shares(cloth.original->pixel_count(), 1);
  for (uint32_t p = 0; p < shares.size(); ++p) {
    if (!cloth.original->valid(p)) continue;
    Material own = cloth.weakest;
    const Material fabric = fabrics.at(p);
    own.stretch_warp = fabric.stretch_warp;
    own.stretch_weft = fabric.stretch_weft;
    shares[p] = longest(own) / most;
  }
  return shares;
}

/// What took a cloth along two frames ago, which is what is known; null where nothing did.
const Solver::Impl::Ride* Solver::Impl::ride_of(uint32_t cloth) {
  constexpr float kMostLeft = 0.01F;  // of the points: those in clefts tremble
  constexpr float kMostLost = 0.4F;   // of them while it rides: with fewer substeps it finds another rest
  const uint32_t word = 1 - frame_.motion_word;
  const Cloth& c = cloths_[cloth];
  if (!c.rides[word].carrier) return nullptr;
  const float most = (c.rides_on ? kMostLost : kMostLeft) * static_cast<float>(c.particles);
  return static_cast<float>(backend_->left_behind(cloth, word)) > most ? nullptr : &c.rides[word];
}

/// [m] How far a fast collider goes in a substep as seen from a cloth that rides on it or on another. A garment on a
/// runner hardly meets a fast body.
/// @param ride  of the cloth, if it rides
float Solver::Impl::way_seen_from(const Ride* ride, uint32_t collider) const {
  const float way = frame_.shapes[collider].way;
  if (ride == nullptr) return way;
  const double steps = ride->time / (settings_.frame_time / usual_substeps_);
  const shader::FrameField motion = motion_field(ride->from, ride->to, static_cast<float>(1 / steps), origin_);
  return std::min(way, way_beside(frame_.shapes, frame_.poses, collider, motion, static_cast<float>(steps - 1)));
}

/// Has a cloth measured in this frame as ride_of() wants to know it two frames later.
void Solver::Impl::measure_ride(Cloth& cloth, ClothFrame& frame) const {
  constexpr float kLeft = 0.1F;  // spacings in a substep without haste
  shader::ClothParams& params = frame.params;
  if (frame.asleep) cloth.ride.carrier.reset();
  if (cloth.ride.carrier) {
    cloth.ride.from = frames_from_[*cloth.ride.carrier];
    cloth.ride.to = collider_frame(colliders_to_[*cloth.ride.carrier]);
    cloth.ride.time = settings_.frame_time;
    params.carrier = motion_field(cloth.ride.from, cloth.ride.to, 1.F / static_cast<float>(substeps_), origin_);
    params.carried_at = static_cast<float>(substeps_ - 1);
    params.left_behind = kLeft * params.spacing / static_cast<float>(cloth.factor);
  }
  cloth.rides[frame_.motion_word] = cloth.ride;
}

/// As many as substeps are asked for, or so many that a substep is at most a twentieth longer or shorter than in the
/// frame before. Cloth hangs longer in long steps; where it had to become shorter within a short one it would get a
/// speed by that, and steps that go to and fro would shake it.
uint32_t Solver::Impl::even_substeps() {
  constexpr double kChange = 1.05;
  constexpr uint32_t kMost = 4;  // times as many or as few
  const double wanted = settings_.frame_time / settings_.substeps;
  if (!(step_length_ > 0)) step_length_ = wanted;
  step_length_ = std::clamp(wanted, step_length_ / kChange, step_length_ * kChange);
  if (step_length_ == wanted) return settings_.substeps;
  const double fewest = std::max(1U, settings_.substeps / kMost),
               most = std::min(kMostSubsteps, kMost * settings_.substeps);
  return static_cast<uint32_t>(std::clamp(std::round(settings_.frame_time / step_length_), fewest, most));
}

/// Springs are as stiff as their material at the length that the step has, but for a few percent while it varies: the
/// constants that hold the step need not be made anew in every frame then.
void Solver::Impl::choose_compliance_step(Cloth& cloth) const {
  constexpr double kNear = 0.02;
  const double dt = clock().dt;
  if (dt == cloth.last_step || !(std::abs(dt - cloth.compliance_step) <= kNear * dt)) cloth.compliance_step = dt;
}

/// More substeps for a cloth that may meet a collider which is too fast for it, and for those that it collides with. In
/// shorter ones cloth that hangs is less stretched, and jumps up: where a collider could come to it by the pins it is
/// looked at, too.
void Solver::Impl::choose_factors() {
  constexpr uint32_t kMost = 32;
  constexpr double kShortest = 1.0 / 16000;  // [s] for a few frames; see kShortStep
  constexpr float kNearly = 0.5F;            // of a fast way: from here on it is known whether the cloth rides
  const auto most =
      static_cast<uint32_t>(std::clamp(settings_.frame_time / (kShortest * usual_substeps_), 1.0, double{kMost}));
  collider_poses(frames_from_, colliders_to_, deform_, usual_substeps_, origin_, frame_.poses);
  frame_.deforms = anything_deforms();
  measure_ways(frame_.shapes, frame_.poses, usual_substeps_, 0);
  uint32_t others_factor = 1;  // of the cloths that collide with each other
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    uint32_t factor = 1;
    const float spacing = cloth.asset->spacing * cloth.scale;
    const float margin = cloth.reach * stretch_limit(cloth) + cloth.material.thickness + spacing;
    cloth.meets_fast = false;
    cloth.met_way.reset();
    cloth.looked_for = cloth.looked_at = false;
    cloth.ride = {};
    const Ride* const ride = ride_of(c);
    std::optional<std::optional<ClothBox>> box;  // looked for once
    float longest = 0;                           // [m] way of a collider as seen from the cloth
    float met = 0;                               // [m] the same in the world, of those that may meet it
    bool misses = false;
    for (uint32_t i = 0; i < frame_.shapes.size(); ++i) {
      const shader::ColliderShape& shape = frame_.shapes[i];
      if (shape.kind == shader::kShapePlane || !meets(cloth, i)) continue;
      const Haste haste = haste_of(shape, spacing, most);
      const bool nearly_fast = shape.way > kNearly * haste.way;
      if (nearly_fast && !box) box = box_of_pins(cloth);
      const bool by_pins = nearly_fast && (!*box || may_reach(frame_.shapes, frame_.poses, i, **box, margin));
      const bool out_of_reach = nearly_fast && !(by_pins && may_meet(c, i, ride != nullptr));
      misses = misses || out_of_reach;
      if (!out_of_reach) met = std::max(met, shape.way);
      if (!nearly_fast || out_of_reach) {
        longest = std::max(longest, shape.way);
        continue;
      }
      std::optional<uint32_t>& carrier = cloth.ride.carrier;
      if (!carrier || radius_of(shape) > radius_of(frame_.shapes[*carrier])) carrier = i;
      const float way = way_seen_from(ride, i);
      longest = std::max(longest, way);
      if (way <= haste.way) continue;
      cloth.meets_fast = true;
      while (factor < haste.most && way > haste.way * static_cast<float>(factor)) ++factor;
    }
    find_place(c);
    cloth.rides_on = ride != nullptr && cloth.ride.carrier;
    if (cloth.rides_on) cloth.ride.way = longest;
    if (misses) cloth.met_way = met;
    let_seen_go(cloth);
    cloth.factor = std::max(1U, std::min(factor, kMostSubsteps / usual_substeps_));
    if (meets_others(cloth)) others_factor = std::max(others_factor, cloth.factor);
  }
  for (Cloth& cloth : cloths_)
    if (meets_others(cloth)) cloth.factor = others_factor;
}

void Solver::Impl::find_movers() {
  movers_.clear();
  for (uint32_t i = 0; i < colliders_to_.size(); ++i)
    if (deform_[i] > 0 || !same_place(frames_from_[i], collider_frame(colliders_to_[i]))) movers_.push_back(i);
}

/// Whether a collider that moves in this frame may touch the cloth. Waits for the device, for a sleeping cloth once.
bool Solver::Impl::is_reached(uint32_t index) {
  Cloth& cloth = cloths_[index];
  if (std::ranges::none_of(movers_, [&](uint32_t i) { return meets(cloth, i); })) return false;
  if (!cloth.resting) {
    std::vector<vec4> position;
    backend_->read_positions(index, position);
    cloth.resting = box_of(*cloth.asset, position);
  }
  const float margin = cloth.material.thickness + cloth.asset->spacing * cloth.scale;
  return std::any_of(movers_.begin(), movers_.end(), [&](uint32_t i) {
    return meets(cloth, i) && may_reach(frame_.shapes, frame_.poses, i, *cloth.resting, margin);
  });
}

/// Adds up for how long nothing has disturbed a cloth that nothing holds, whether it may sleep or not; to be asked once
/// a frame. Nor is one that falls, or is thrown, left alone, nor one that is inflated, whose ties hold it together.
///
/// Cloth that is left alone for long lies on something. What ties hold up there gravity draws down in a frame; where
/// points are faster than that, ties and colliders move them there and back, or round in a heap, and would for ever.
void Solver::Impl::leave_alone(uint32_t c, bool is_disturbed) {
  constexpr double kFast = 2, kLeast = 0.02;  // [m/s]
  constexpr double kLong = 4, kFaster = 1.25;
  Cloth& cloth = cloths_[c];
  const double speed = cloth.is_free() ? speed_of(c) : 0;
  is_disturbed = is_disturbed || !cloth.is_free() || cloth.pressure != 0 || blows(wind_on(cloth)) || !(speed < kFast) ||
                 std::ranges::any_of(movers_, [&](uint32_t i) { return meets(cloth, i); });
  cloth.alone_for = is_disturbed ? 0 : cloth.alone_for + settings_.frame_time;
  const double drawn = double{length(gravity_of(cloth))} * settings_.frame_time;
  if (is_disturbed) cloth.restless = false;
  if (cloth.alone_for >= kLong && speed > std::max(kFaster * drawn, kLeast)) cloth.restless = true;
}

/// Decides by what was measured two frames ago, on both backends, so that none waits and both decide alike.
void Solver::Impl::fall_asleep() {
  frame_.may_sleep = settings_.sleep_speed > 0;
  frame_.measure_motion = frame_.may_sleep || std::ranges::any_of(cloths_, &Cloth::is_free);
  frame_.motion_word = 1 - frame_.motion_word;
  const bool changed = std::exchange(scene_changed_, false);
  const bool stirred = changed || !frame_.may_sleep;
  const uint32_t groups_changed = std::exchange(groups_changed_, 0);
  bool others_wake = false;  // of the cloths that collide with each other
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    const bool disturbed = std::exchange(cloth.disturbed, false) || (cloth.meets & groups_changed) != 0;
    leave_alone(c, changed || disturbed);
    if (!stirred && !disturbed && !blows(wind_on(cloth)) && !(cloth.asleep && is_reached(c))) continue;
    wake(cloth);
    others_wake = others_wake || meets_others(cloth);
  }
  bool others_sleep = true;  // those that collide with each other sleep when all are calm
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    if (others_wake && meets_others(cloth)) wake(cloth);
    if (!cloth.asleep && meets_others(cloth)) others_sleep = is_calm(c) && others_sleep;
  }
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    if (!cloth.asleep) cloth.asleep = meets_others(cloth) ? others_sleep : is_calm(c);
    if (!cloth.asleep) ++cloth.calm_frames;
    if (cloth.asleep) cloth.factor = 1;
    if (cloth.is_free() && !cloth.asleep) stray(c);
  }
}

/// Adds up how far a cloth may go that nothing holds; to be asked once a frame. Where it comes to rest it is looked
/// for.
void Solver::Impl::stray(uint32_t c) {
  constexpr float kFar = 1, kMost = 1e6F;  // [m]
  constexpr double kSlow = 0.2;            // [m/s]
  float& strayed = cloths_[c].strayed;
  const double speed = speed_of(c);
  if (!std::isfinite(speed)) return;
  strayed = std::min(strayed + static_cast<float>(speed * settings_.frame_time), kMost);
  if (speed < kSlow && strayed > kFar) strayed = kMost;
}

/// [m/s] Of a cloth's fastest point two frames ago.
double Solver::Impl::speed_of(uint32_t c) const {
  const double step = cloths_[c].measured_steps[frame_.motion_word];
  return step > 0 ? static_cast<double>(backend_->longest_way(c, frame_.motion_word)) / step : 0;
}

void Solver::Impl::wake(Cloth& cloth) {
  cloth.asleep = false;
  cloth.calm_frames = 0;
  cloth.calm_for = 0;
}

/// Whether a cloth that is awake has been slow for long enough and nothing reaches it; to be asked once a frame.
bool Solver::Impl::is_calm(uint32_t c) {
  constexpr uint32_t kLatency = 2;  // frames
  Cloth& cloth = cloths_[c];
  if (cloth.calm_frames < kLatency) return false;
  cloth.calm_for = speed_of(c) <= settings_.sleep_speed ? cloth.calm_for + settings_.frame_time : 0;
  if (!(cloth.calm_for > 0 && cloth.calm_for >= settings_.sleep_time)) return false;
  cloth.resting.reset();
  if (!is_reached(c)) return true;
  cloth.calm_for = 0;
  return false;
}

/// [m] that a collider goes in a substep; planes are too thick to slip through anything.
float Solver::Impl::longest_way(const Cloth& cloth) const {
  float way = 0;
  for (size_t i = 0; i < colliders_to_.size(); ++i)
    if (frame_.shapes[i].kind != shader::kShapePlane && meets(cloth, i)) way = std::max(way, frame_.shapes[i].way);
  return way;
}

/// Runs the frame for the cloths with so many times the usual substeps. Those of other groups are left as they are.
void Solver::Impl::run_group(uint32_t factor) {
  substeps_ = usual_substeps_ * factor;
  frame_.shapes.resize(colliders_to_.size());
  frame_.poses.resize(colliders_to_.size() * (usual_substeps_ + 1));
  meets_.clear();
  if (factor > 1) {
    collider_poses(frames_from_, colliders_to_, deform_, substeps_, origin_, frame_.poses);
    measure_ways(frame_.shapes, frame_.poses, substeps_, thickest(cloths_));
  }
  swept_.clear();
  for (uint32_t i = 0; i < colliders_to_.size(); ++i) swept_.push_back(swept_box(frame_.shapes, frame_.poses, i));
  substep_inputs(clock(), wind_, origin_, frame_.substeps);
  for (size_t c = 0; c < cloths_.size(); ++c) {
    Cloth& cloth = cloths_[c];
    ClothFrame& frame = frame_.cloths[c];
    const bool belongs = cloth.factor == factor;
    frame.asleep = !belongs || cloth.asleep;
    frame.pins_changed = belongs && cloth.pins_anew;
    if (!belongs) continue;
    const float spacing = cloth.asset->spacing * cloth.scale, way = longest_way(cloth);
    const bool hasty = factor > 1 && cloth.meets_fast;
    const bool seams = cloth.asset->splits.rows() > 0;
    const auto in_step = [&](const std::optional<float>& usual) {
      return std::min(way, usual.value_or(way) / static_cast<float>(factor));
    };
    const float seen = std::min(in_step(cloth.ride.way), in_step(cloth.met_way));
    frame.cell_rounds = cloth.collide_cells ? cell_rounds(seen, spacing, seams, hasty) : 0;
    choose_compliance_step(cloth);
    fill_cloth_frame(cloth, frame);
    const Meets shared = met_in_groups(cloth.meets);
    const Meets met = met_by(cloth, frame.params.stretch_limit, shared);
    frame.params.collider_count = met.count;
    frame.params.first_shape = met.first_shape;
    frame.params.first_pose = met.first_pose;
    sum_contacts(cloth, frame, met.first_shape == shared.first_shape && met.count == shared.count);
    frame.params.spacing = spacing;
    const bool leaves = cloth.collide_cells && !hasty;
    frame.params.leave_near = leaves ? shader::kLeaveNear * spacing : 0;
    frame.restless = cloth.restless;
    const std::span<const shader::ColliderShape> shapes =
        std::span(frame_.shapes).subspan(shared.first_shape, shared.count);
    frame.held_open = hasty && may_open_cells(shapes, spacing);
    frame.params.grip = grip_of(frame, spacing);
    measure_ride(cloth, frame);
    if (!cloth.asleep) cloth.displaced_in = clock().dt;
    cloth.measured_steps[frame_.motion_word] = cloth.last_step = clock().dt;
  }
  backend_->run_frame(frame_);
}

void Solver::Impl::step() {
  carry_over();
  follow_cloths();
  frame_.shapes = shapes_;
  frame_.collider_numbers = collider_numbers_;
  frame_.cloths.resize(cloths_.size());
  for (size_t c = 0; c < cloths_.size(); ++c) change_pins(cloths_[c], frame_.cloths[c]);
  usual_substeps_ = even_substeps();
  choose_factors();
  measure_ways(frame_.shapes, frame_.poses, usual_substeps_, thickest(cloths_));
  find_movers();
  fall_asleep();
  uint32_t most = 1;
  for (Cloth& cloth : cloths_) {
    for (size_t i = 0; i < colliders_to_.size(); ++i)
      cloth.collide_cells = cloth.collide_cells ||
                            (meets(cloth, i) && may_slip_through(frame_.shapes[i], cloth.asset->spacing * cloth.scale));
    most = std::max(most, cloth.factor);
  }
  for (uint32_t factor = 1; factor <= most; ++factor)
    if (std::ranges::any_of(cloths_, [&](const Cloth& cloth) { return cloth.factor == factor; })) run_group(factor);
  for (size_t i = 0; i < colliders_to_.size(); ++i) {
    const Transform frame = collider_frame(colliders_to_[i]);
    collider_ways_[i] = frame.translate - frames_from_[i].translate;
    frames_from_[i] = frame;
    deform_[i] = 0;
  }
  for (Cloth& cloth : cloths_) {
    cloth.parent_from = cloth.parent_to;
    cloth.sewn_from = cloth.sewn_to;
  }
  time_ += settings_.frame_time;
}

}  // namespace geocloth
