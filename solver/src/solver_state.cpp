// SPDX-License-Identifier: Apache-2.0
// A solver's state as bytes, and back. Restoring reads everything, checks everything, and only then changes the solver.
// What follows from other things is not kept but made again as it was made before, by the same functions: attachments
// from the pins, springs from the asset. Neighbours of self-collision are kept: they last for several substeps, and
// looked up anew they would be others.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "check_input.h"
#include "geocloth/asset/grid_mesh.h"
#include "lib/self_words.h"
#include "lib/yield.h"
#include "rest/fabrics.h"
#include "rest/self_points.h"
#include "rest/upload.h"
#include "solver_impl.h"
#include "state_bytes.h"

namespace geocloth {
namespace {

using shader::vec4;

constexpr uint32_t kMagic = 0x53434C47;  // "GLCS"; read in another order of bytes it is another number
constexpr uint32_t kVersion = 11;        ///< one more whenever what is written changes, or what a frame makes of it

/// Of one point.
struct SavedPoint {
  Vec3 position, previous, carry;  ///< [m] relative to the origin
  uint32_t yield = 0;              ///< see lib/yield.h: 2^-yield
};

/// What cuts have left of an asset.
struct SavedCut {
  std::vector<uint8_t> spring_mask, cell;
  std::vector<SeamBend> seam_bends;
  SplitVertexTable splits;
  std::vector<Triangle> triangle;
  std::vector<SourcePart> part;
  std::vector<Binding> binding;
};

struct SavedCollider {
  Collider collider;
  uint64_t field = 0;    ///< of a body: mark of its field
  Transform from;        ///< its frame at the start of the next frame
  Vec3 way, place_seen;  ///< see Impl
  float deform = 0;
};

bool finite(double v) {
  return std::isfinite(v);
}
bool finite(const Vec3& v) {
  return is_finite(v);
}

void require(bool holds, const std::string& where, const char* what) {
  if (!holds) refuse_state(where + what);
}

/// The check_ functions for what users say, of what was saved.
template <class Check>
void checked(const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::limit || std::string_view(error.what()).starts_with(kSavedState)) throw;
    refuse_state(error.what());
  }
}

void check_pose(const std::optional<Transform>& pose, const std::string& where) {
  if (!pose) return;
  check(*pose, where);
  require(pose->scale == 1, where, " has a scale");
}

/// What poses of shapes and colliders make together.
void check_frame(const Transform& frame, const std::string& where) {
  const Quat& q = frame.rotate;
  const double turn2 =
      double{q.x} * double{q.x} + double{q.y} * double{q.y} + double{q.z} * double{q.z} + double{q.w} * double{q.w};
  require(finite(frame.translate) && std::abs(turn2 - 1) < 0.01 && frame.scale == 1, where, " is no pose");
}

bool same_bend(const SeamBend& a, const SeamBend& b) {
  return a.a == b.a && a.middle == b.middle && a.b == b.b && a.rest_length == b.rest_length;
}

bool same_triangles(const ClothAsset& asset, const SavedCut& cut) {
  const auto same_part = [](const SourcePart& a, const SourcePart& b) {
    return a.name == b.name && a.material == b.material && a.first_triangle == b.first_triangle &&
           a.triangle_count == b.triangle_count;
  };
  const auto same_binding = [](const Binding& a, const Binding& b) {
    return a.pixel == b.pixel && a.weight == b.weight && a.offset == b.offset;
  };
  return asset.source.triangle == cut.triangle && std::ranges::equal(asset.source.part, cut.part, same_part) &&
         std::ranges::equal(asset.binding, cut.binding, same_binding);
}

bool is_as(const ClothAsset& asset, const SavedCut& cut) {
  return asset.spring_mask == cut.spring_mask && asset.cell == cut.cell && asset.splits.offset == cut.splits.offset &&
         asset.splits.pixel == cut.splits.pixel && std::ranges::equal(asset.seam_bends, cut.seam_bends, same_bend) &&
         same_triangles(asset, cut);
}

SavedCut cut_of(const ClothAsset& asset) {
  return {asset.spring_mask,     asset.cell,        asset.seam_bends, asset.splits,
          asset.source.triangle, asset.source.part, asset.binding};
}

bool has_less(const std::vector<uint8_t>& bits, const std::vector<uint8_t>& all) {
  return std::ranges::equal(bits, all, [](uint8_t a, uint8_t b) { return (a & ~b) == 0; });
}

/// Whether every row is part of one row.
bool has_less(const SplitVertexTable& rows, const ClothAsset& all) {
  const std::vector<uint32_t> row_of = split_rows(all);
  for (uint32_t r = 0; r < rows.rows(); ++r) {
    const std::span<const uint32_t> copies = rows.copies(r);
    const uint32_t first = row_of[copies.front()];
    if (first == kNoPixel || std::ranges::any_of(copies, [&](uint32_t p) { return row_of[p] != first; })) return false;
  }
  return true;
}

/// What was cut out of an asset, which it has to be a part of: memory on a device has room for no more.
std::shared_ptr<const ClothAsset> with_cut(const ClothAsset& original, SavedCut cut, const std::string& where) {
  require(has_less(cut.spring_mask, original.spring_mask), where, " has springs that it was not made with");
  require(has_less(cut.cell, original.cell), where, " has cells that it was not made with");
  require(cut.seam_bends.size() <= original.seam_bends.size(), where, " has more bends than it was made with");
  ClothAsset asset = original;
  asset.spring_mask = std::move(cut.spring_mask);
  asset.cell = std::move(cut.cell);
  asset.seam_bends = std::move(cut.seam_bends);
  asset.splits = std::move(cut.splits);
  asset.source.triangle = std::move(cut.triangle);
  asset.source.part = std::move(cut.part);
  asset.binding = std::move(cut.binding);
  checked([&] { validate(asset); });
  require(has_less(asset.splits, original), where, " has copies that it was not made with");
  return std::make_shared<const ClothAsset>(std::move(asset));
}

/// Where the parts of FoundPoints::words are for a point.
struct FoundAt {
  size_t points;
  [[nodiscard]] size_t seen(size_t point) const { return 3 * point; }
  [[nodiscard]] size_t count(size_t point) const { return 3 * points + point; }
  [[nodiscard]] size_t neighbors(size_t point) const { return 4 * points + shader::kSelfMostNeighbors * point; }
};

/// Of the lists only what they hold.
struct SavedFound {
  uint32_t age = 0;
  std::vector<uint32_t> stream;

  void keep(const FoundPoints& found, uint32_t points) {
    age = found.age;
    stream.clear();
    if (age == 0) return;
    const FoundAt at{points};
    const auto add = [&](size_t first, size_t count) {
      const auto begin = found.words.begin() + static_cast<std::ptrdiff_t>(first);
      stream.insert(stream.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
    };
    for (size_t p = 0; p < points; ++p) {
      add(at.seen(p), 3);
      add(at.count(p), 1);
      add(at.neighbors(p), found.words[at.count(p)]);
    }
  }

  [[nodiscard]] FoundPoints unpacked(uint32_t points, const std::string& where) const {
    FoundPoints found{age, std::vector<uint32_t>(kFoundWordsOfPoint * points, 0)};
    const FoundAt at{points};
    require(age <= shader::kSelfLeastAge && (age > 0 || stream.empty()), where, ": neighbours are too old");
    std::fill_n(found.words.begin(), 3 * size_t{points}, shader::floatBitsToUint(std::numeric_limits<float>::max()));
    if (age == 0) return found;
    size_t next = 0;
    const auto take = [&](size_t to, size_t count) {
      require(stream.size() - next >= count, where, ": points lack neighbours");
      std::copy_n(stream.begin() + static_cast<std::ptrdiff_t>(next), count,
                  found.words.begin() + static_cast<std::ptrdiff_t>(to));
      next += count;
    };
    for (size_t p = 0; p < points; ++p) {
      take(at.seen(p), 3);
      take(at.count(p), 1);
      const uint32_t count = found.words[at.count(p)];
      require(count <= shader::kSelfMostNeighbors, where, ": a point has too many neighbours");
      take(at.neighbors(p), count);
      for (uint32_t k = 0; k < count; ++k)
        require((found.words[at.neighbors(p) + k] & ~shader::kSelfThinBit) < points, where,
                ": a neighbour does not exist");
    }
    require(next == stream.size(), where, ": there are more neighbours than points");
    return found;
  }
};

template <size_t... kKinds>
void set_kind(ColliderShape& shape, size_t kind, std::index_sequence<kKinds...>) {
  ((kind == kKinds ? static_cast<void>(shape.emplace<kKinds>()) : static_cast<void>(0)), ...);
}

template <class Bytes>
void exchange(Bytes& bytes, SavedCollider& c) {
  bytes.text(c.collider.name);
  auto kind = static_cast<uint8_t>(c.collider.shape.index());
  bytes.value(kind);
  constexpr size_t kKinds = std::variant_size_v<ColliderShape>;
  if (kind >= kKinds) refuse_state("a collider has a shape of kind " + std::to_string(kind) + ", which is unknown");
  if (kind != c.collider.shape.index()) set_kind(c.collider.shape, kind, std::make_index_sequence<kKinds>{});
  if (auto* convex = std::get_if<Convex>(&c.collider.shape)) {
    bytes.values(convex->planes);
    bytes.values(convex->surface.position);
    bytes.values(convex->surface.triangle);
  } else {
    std::visit(
        [&](auto& shape) {
          if constexpr (std::is_trivially_copyable_v<std::remove_reference_t<decltype(shape)>>) bytes.value(shape);
        },
        c.collider.shape);
  }
  bytes.value(c.field);
  bytes.value(c.collider.friction);
  bytes.value(c.collider.groups);
  bytes.value(c.collider.pose);
  bytes.value(c.from);
  bytes.value(c.way);
  bytes.value(c.place_seen);
  bytes.value(c.deform);
}

template <class Bytes>
void exchange(Bytes& bytes, SavedCut& cut) {
  bytes.values(cut.spring_mask);
  bytes.values(cut.cell);
  bytes.values(cut.seam_bends);
  bytes.values(cut.splits.offset);
  bytes.values(cut.splits.pixel);
  bytes.values(cut.triangle);
  bytes.entries(cut.part, 20, [&](SourcePart& part) {
    bytes.text(part.name);
    bytes.value(part.material);
    bytes.value(part.first_triangle);
    bytes.value(part.triangle_count);
  });
  bytes.values(cut.binding);
}

template <class Bytes>
void exchange(Bytes& bytes, SavedFound& found) {
  bytes.value(found.age);
  bytes.values(found.stream);
}

}  // namespace

/// Names as in Cloth.
struct Solver::Impl::SavedCloth {
  struct PinAt {
    uint32_t pixel = 0;
    PinState pin;
  };

  uint64_t mark = 0;
  double arrived = 0;
  Material material;
  std::vector<Material> fabrics;
  std::optional<SavedCut> cut;
  std::vector<PinAt> pins;
  bool pins_changed = false, masses_changed = false;
  std::optional<Transform> parent_from, parent_to;
  Transform parent_first;
  Vec3 middle, inertia_scale;
  bool collide_cells = false, teleport = false, rides_on = false, asleep = false, disturbed = false;
  bool restless = false;
  double placed_at = 0, pulled_at = 0, calm_for = 0, alone_for = 0, displaced_in = 0, compliance_step = 0,
         last_step = 0;
  std::array<double, 2> measured_steps{};
  std::array<Ride, 2> rides;
  std::optional<Seen> seen;
  double look_again = 0;
  float limit = 0, reach = 0, strayed = 0, pressure = 0, gravity_scale = 1, wind_scale = 1;
  std::optional<float> sewn_from, sewn_to;
  uint32_t calm_frames = 0, meets = 0;
  std::array<float, 2> longest_way{};
  std::array<uint32_t, 2> left_behind{};
  Touched touched;
  std::vector<SavedPoint> points;  ///< valid pixels in their order
  std::vector<Vec3> offsets;       ///< [m] of each point; only with fine steps
  SavedFound found;

  // Made of them.
  std::shared_ptr<const ClothAsset> asset;
  std::vector<Fabric> new_fabrics;
  std::optional<ClothData> data;    ///< where asset or material are not as present
  std::vector<float> inverse_mass;  ///< of the data
  FoundPoints found_points;

  template <class Bytes>
  void exchange(Bytes& bytes) {
    const auto pose = [&](Transform& t) { bytes.value(t); };
    bytes.value(mark);
    bytes.value(arrived);
    bytes.value(material);
    bytes.values(fabrics);
    bytes.optional(cut, [&](SavedCut& c) { geocloth::exchange(bytes, c); });
    bytes.values(pins);
    bytes.flag(pins_changed);
    bytes.flag(masses_changed);
    bytes.optional(parent_from, pose);
    bytes.optional(parent_to, pose);
    bytes.value(parent_first);
    bytes.value(middle);
    bytes.value(inertia_scale);
    for (bool* flag : {&collide_cells, &teleport, &rides_on, &asleep, &disturbed, &restless}) bytes.flag(*flag);
    for (double* time : {&placed_at, &pulled_at, &calm_for, &alone_for, &displaced_in, &compliance_step, &last_step})
      bytes.value(*time);
    bytes.value(measured_steps);
    for (Ride& ride : rides) {
      bytes.optional(ride.carrier, [&](uint32_t& carrier) { bytes.value(carrier); });
      bytes.value(ride.from);
      bytes.value(ride.to);
      bytes.value(ride.time);
      bytes.optional(ride.way, [&](float& way) { bytes.value(way); });
    }
    bytes.optional(seen, [&](Seen& s) { bytes.value(s); });
    bytes.value(look_again);
    bytes.value(limit);
    bytes.value(reach);
    bytes.value(strayed);
    bytes.value(pressure);
    bytes.value(gravity_scale);
    bytes.value(wind_scale);
    for (std::optional<float>* share : {&sewn_from, &sewn_to})
      bytes.optional(*share, [&](float& s) { bytes.value(s); });
    bytes.value(meets);
    bytes.value(calm_frames);
    bytes.value(longest_way);
    bytes.value(left_behind);
    bytes.entries(touched.colliders, 1, [&](std::optional<uint32_t>& collider) {
      bytes.optional(collider, [&](uint32_t& c) { bytes.value(c); });
    });
    bytes.values(touched.about);
    bytes.value(touched.origin);
    bytes.value(touched.force);
    bytes.values(touched.restored);
    bytes.values(points);
    bytes.values(offsets);
    geocloth::exchange(bytes, found);
  }
};

/// Names as in Impl.
struct Solver::Impl::Saved {
  uint32_t magic = kMagic, version = kVersion;
  uint64_t settings_mark = 0;
  double frame_time = 0;
  uint32_t substeps = 0;
  Vec3 gravity;
  std::optional<Wind> wind;
  Vec3 origin, inter_origin;
  double time = 0, step_length = 0, calm_step = 0;
  uint32_t motion_word = 0, groups_changed = 0;
  bool scene_changed = false;
  bool has_colliders = false;  ///< set_colliders() was called
  std::vector<SavedCollider> colliders;
  std::vector<SavedCloth> cloths;
  SavedFound found;

  // Made of them.
  std::optional<InterData> inter;  ///< where it is not the present one
  FoundPoints found_points;

  template <class Bytes>
  void exchange_header(Bytes& bytes) {
    bytes.value(magic);
    bytes.value(version);
  }
  template <class Bytes>
  void exchange(Bytes& bytes) {
    constexpr size_t kLeast = 64;  // bytes of a collider or cloth
    bytes.value(settings_mark);
    bytes.value(frame_time);
    bytes.value(substeps);
    bytes.value(gravity);
    bytes.optional(wind, [&](Wind& w) { bytes.value(w); });
    bytes.value(origin);
    bytes.value(inter_origin);
    for (double* time_of : {&time, &step_length, &calm_step}) bytes.value(*time_of);
    bytes.value(motion_word);
    bytes.flag(scene_changed);
    bytes.value(groups_changed);
    bytes.flag(has_colliders);
    bytes.entries(colliders, kLeast, [&](SavedCollider& c) { geocloth::exchange(bytes, c); });
    bytes.entries(cloths, kLeast, [&](SavedCloth& c) { c.exchange(bytes); });
    geocloth::exchange(bytes, found);
  }
};

/// Of what a cloth was made with, as far as its motion follows from it.
uint64_t Solver::Impl::mark_of_cloth(Cloth& cloth) const {
  if (cloth.mark) return *cloth.mark;
  static_assert(sizeof(SeamBend) == 16);
  const ClothAsset& asset = *cloth.original;
  StateMark mark;
  mark.add(asset.width);
  mark.add(asset.height);
  mark.add(asset.spacing);
  mark.add(asset.rest_position);
  mark.add(asset.chart);
  mark.add(asset.spring_mask);
  mark.add(asset.cell);
  mark.add(asset.area);
  mark.add(asset.splits.offset);
  mark.add(asset.splits.pixel);
  mark.add(asset.seam_bends);
  mark.add(asset.sewing);
  mark.add(cloth.start);
  mark.add(cloth.self_collision ? cloth.self_collision->distance : 0);
  mark.add(cloth.inter_collision ? cloth.inter_collision->distance : 0);
  for (const Fabric& fabric : cloth.fabrics) mark.add(fabric.pixels);
  cloth.mark = mark.get();
  return *cloth.mark;
}

/// Of the settings that stay as they are.
uint64_t Solver::Impl::mark_of_settings() const {
  StateMark mark;
  mark.add(settings_.relaxation_steps);
  mark.add(settings_.imperfection);
  mark.add(fine_);
  mark.add(settings_.sleep_speed);
  mark.add(settings_.sleep_time);
  return mark.get();
}

uint64_t Solver::Impl::mark_of_field(const std::shared_ptr<const DistanceField>& field) {
  const auto known = std::ranges::find(field_marks_, field, [](const auto& entry) { return entry.first; });
  if (known != field_marks_.end()) return known->second;
  std::erase_if(field_marks_, [&](const auto& entry) {  // those that nothing is left of
    return std::ranges::none_of(colliders_to_, [&](const Collider& c) {
      const auto* body = std::get_if<MeshSolid>(&c.shape);
      return body != nullptr && body->field == entry.first;
    });
  });
  StateMark mark;
  mark.add(field->size);
  mark.add(field->low);
  mark.add(field->spacing);
  for (const Vec3& way : field->way) mark.add(way);
  mark.add(field->margin);
  mark.add(field->distance);
  return field_marks_.emplace_back(field, mark.get()).second;
}

void Solver::Impl::keep_cloth(uint32_t index, SavedCloth& saved) {
  Cloth& cloth = cloths_[index];
  saved.mark = mark_of_cloth(cloth);
  saved.arrived = cloth.arrived;
  saved.material = cloth.material;
  for (const Fabric& fabric : cloth.fabrics) saved.fabrics.push_back(fabric.material);
  if (cloth.asset != cloth.original) saved.cut = cut_of(*cloth.asset);
  for (const auto& [pixel, pin] : cloth.pins) saved.pins.push_back({pixel, pin});
  saved.pins_changed = cloth.pins_changed;
  saved.masses_changed = cloth.masses_changed;
  saved.parent_from = cloth.parent_from;
  saved.parent_to = cloth.parent_to;
  saved.parent_first = cloth.parent_first;
  saved.middle = cloth.middle;
  saved.inertia_scale = cloth.inertia_scale;
  saved.collide_cells = cloth.collide_cells;
  saved.teleport = cloth.teleport;
  saved.rides_on = cloth.rides_on;
  saved.asleep = cloth.asleep;
  saved.disturbed = cloth.disturbed;
  saved.restless = cloth.restless;
  saved.placed_at = cloth.placed_at;
  saved.pulled_at = cloth.pulled_at;
  saved.calm_for = cloth.calm_for;
  saved.alone_for = cloth.alone_for;
  saved.displaced_in = cloth.displaced_in;
  saved.compliance_step = cloth.compliance_step;
  saved.last_step = cloth.last_step;
  saved.measured_steps = cloth.measured_steps;
  saved.rides = cloth.rides;
  saved.seen = cloth.seen;
  saved.look_again = cloth.look_again;
  saved.limit = cloth.limit;
  saved.reach = cloth.reach;
  saved.strayed = cloth.strayed;
  saved.pressure = cloth.pressure;
  saved.gravity_scale = cloth.gravity_scale;
  saved.wind_scale = cloth.wind_scale;
  saved.sewn_from = cloth.sewn_from;
  saved.sewn_to = cloth.sewn_to;
  saved.meets = cloth.meets;
  saved.calm_frames = cloth.calm_frames;
  saved.touched = cloth.touched;
  if (!saved.touched.colliders.empty()) read_contacts(index, saved.touched.restored);
  ClothMemory memory;
  backend_->read_memory(index, memory);
  saved.longest_way = memory.longest_way;
  saved.left_behind = memory.left_behind;
  const auto xyz = [](const vec4& v) { return Vec3{v.x, v.y, v.z}; };
  for (uint32_t p = 0; p < cloth.asset->pixel_count(); ++p) {
    if (!cloth.asset->valid(p)) continue;
    saved.points.push_back({xyz(memory.position[p]), xyz(memory.previous[p]), xyz(memory.carry[p]),
                            shader::floatBitsToUint(memory.position[p].w) & shader::kYieldBits});
    if (!memory.offset.empty()) saved.offsets.push_back(xyz(memory.offset[p]));
  }
  saved.found.keep(memory.found, cloth.self.points);
}

void Solver::Impl::save(std::vector<std::byte>& out) {
  Saved saved;
  saved.settings_mark = mark_of_settings();
  saved.frame_time = settings_.frame_time;
  saved.substeps = settings_.substeps;
  saved.gravity = settings_.gravity;
  saved.wind = wind_;
  saved.origin = origin_;
  saved.inter_origin = inter_origin_;
  saved.time = time_;
  saved.step_length = step_length_;
  saved.calm_step = calm_step_;
  saved.motion_word = frame_.motion_word;
  saved.scene_changed = scene_changed_;
  saved.groups_changed = groups_changed_;
  saved.has_colliders = collider_numbers_ != nullptr;
  for (size_t i = 0; i < colliders_to_.size(); ++i) {
    SavedCollider& c = saved.colliders.emplace_back();
    c = {colliders_to_[i], 0, frames_from_[i], collider_ways_[i], places_seen_[i], deform_[i]};
    if (const auto* body = std::get_if<MeshSolid>(&c.collider.shape)) c.field = mark_of_field(body->field);
  }
  saved.cloths.resize(cloths_.size());
  for (uint32_t c = 0; c < cloths_.size(); ++c) keep_cloth(c, saved.cloths[c]);
  if (inter_.points > 0) {
    FoundPoints found;
    backend_->read_found(found);
    saved.found.keep(found, inter_.points);
  }
  StateWriter writer(out);
  saved.exchange_header(writer);
  saved.exchange(writer);
}

void Solver::Impl::check_scene(const Saved& saved) const {
  if (saved.cloths.size() != cloths_.size()) {
    refuse_state("it has " + std::to_string(saved.cloths.size()) + " cloths, the solver has " +
                 std::to_string(cloths_.size()) +
                 "; remove those that were added since, and add those that were removed in the order that they had");
  }
  if (saved.settings_mark != mark_of_settings()) {
    refuse_state(
        "the solver was made with another number of relaxation_steps, another sleep_speed or sleep_time, another "
        "keep_momentum or imperfection, or with substeps on the other side of 1/5000 s");
  }
  SolverSettings settings = settings_;
  settings.frame_time = saved.frame_time;
  settings.substeps = saved.substeps;
  settings.gravity = saved.gravity;
  check(settings);
  if (saved.wind) check(*saved.wind, "wind");
  require(finite(saved.origin) && finite(saved.inter_origin), "the origin", " is not finite");
  for (const double time : {saved.time, saved.step_length})
    require(finite(time) && time >= 0, "a time", " is not finite, or below 0");
  require(finite(saved.calm_step) && saved.calm_step > 0, "calm_step", " is not above 0");
  require(saved.motion_word <= 1, "motion_word", " is not 0 or 1");
  require(saved.has_colliders || saved.colliders.empty(), "colliders", " were never set");
}

/// Bodies get the fields of those that the solver has.
void Solver::Impl::check_colliders(Saved& saved) {
  for (size_t i = 0; i < saved.colliders.size(); ++i) {
    SavedCollider& c = saved.colliders[i];
    const std::string where = "colliders[" + std::to_string(i) + "]";
    if (auto* body = std::get_if<MeshSolid>(&c.collider.shape)) {
      for (const Collider& known : colliders_to_) {
        const auto* own = std::get_if<MeshSolid>(&known.shape);
        if (own != nullptr && mark_of_field(own->field) == c.field) body->field = own->field;
      }
      if (!body->field) {
        refuse_state(where + " \"" + c.collider.name +
                     "\" is a body of triangles whose field the solver does not have: fields are not saved; call "
                     "set_colliders() with that body before restore()");
      }
    }
    check(c.collider, where, true);
    check_frame(c.from, where + ": from");
    require(finite(c.way) && finite(c.place_seen), where, ": its way is not finite");
    const float most = longest_deformation(c.collider);
    require(c.deform == 0 || c.deform == most, where, ": it deforms by another way than its field");
  }
}

/// What cuts have left and what they are made of, and what follows from it.
void Solver::Impl::check_versions(Saved& saved) const {
  bool others_differ = inter_.points > 0 && !(saved.inter_origin == inter_origin_);
  std::vector<Version> all = versions();
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    const Cloth& cloth = cloths_[c];
    SavedCloth& s = saved.cloths[c];
    s.asset = cloth.original;
    if (s.cut) s.asset = is_as(*cloth.asset, *s.cut) ? cloth.asset : with_cut(*cloth.original, *s.cut, name_of(c));
    check(s.material, name_of(c) + ": material");
    require(s.fabrics.size() == cloth.fabrics.size(), name_of(c), " has another number of fabrics");
    s.new_fabrics = cloth.fabrics;
    for (size_t f = 0; f < s.fabrics.size(); ++f) s.new_fabrics[f].material = s.fabrics[f];
    check_fabrics(s.material, s.new_fabrics, name_of(c));
    all[c].arrived = s.arrived;
    all[c].asset = s.asset.get();
    all[c].friction = s.material.friction;
    const bool same_data = s.asset == cloth.asset && make_same_data(s.material, cloth.material) &&
                           make_same_data(s.new_fabrics, cloth.fabrics);
    if (!same_data) {
      s.data = cloth_data(cloth, s.asset, s.material, s.new_fabrics);
      s.inverse_mass = inverse_masses(*s.data);
      all[c].inverse_mass = s.inverse_mass;
    }
    others_differ = others_differ || (meets_others(cloth) && (!same_data || s.arrived != cloth.arrived ||
                                                              s.material.friction != cloth.material.friction));
  }
  if (others_differ) saved.inter = inter_data(all, saved.inter_origin);
  const uint32_t points = saved.inter ? saved.inter->points.numbers.points : inter_.points;
  saved.found_points = saved.found.unpacked(points, "cloths that collide with each other");
}

void Solver::Impl::check_cloth(SavedCloth& saved, uint32_t index) const {
  const Cloth& cloth = cloths_[index];
  const std::string where = name_of(index);
  const std::string of_a_pin = where + ": a pin";
  std::optional<uint32_t> last;
  for (const auto& [pixel, pin] : saved.pins) {
    require(pixel < cloth.asset->pixel_count() && cloth.asset->valid(pixel) && (!last || *last < pixel), where,
            ": a pin is where no cloth is, or out of order");
    last = pixel;
    require(finite(pin.from) && finite(pin.back.from) && finite(pin.back.to), where, ": a pin is not finite");
    require(pin.back.radius >= 0 && pin.back.radius <= kLargestBackstop, where, ": a pin has no such backstop");
    check_position(pin.target, of_a_pin);
    check_pin_hold(pin.hold.frequency, pin.hold.max_distance, of_a_pin);
  }
  check_pose(saved.parent_from, where + ": parent");
  check_pose(saved.parent_to, where + ": parent");
  require(saved.parent_from.has_value() == saved.parent_to.has_value(), where, " has half a parent");
  require(!saved.teleport || saved.parent_to, where, " follows a parent that it does not have");
  check_parent(saved.parent_first, saved.inertia_scale, where + ": parent");
  require(finite(saved.middle) && finite(saved.strayed), where, ": its place is not finite");
  for (const double time :
       {saved.arrived, saved.placed_at, saved.pulled_at, saved.calm_for, saved.alone_for, saved.look_again})
    require(finite(time), where, ": a time is not finite");
  for (const double time : {saved.compliance_step, saved.last_step, saved.measured_steps[0], saved.measured_steps[1]})
    require(finite(time) && time >= 0, where, ": a step is not finite, or below 0");
  check_pressure(saved.pressure, where);
  check_gravity_scale(saved.gravity_scale, where);
  check_wind_scale(saved.wind_scale, where);
  for (const std::optional<float>& share : {saved.sewn_from, saved.sewn_to}) check_sewing(share.value_or(0), where);
  require(saved.sewn_from.has_value() == saved.sewn_to.has_value(), where, " is half sewn");
  require(finite(saved.displaced_in) && saved.displaced_in > 0, where, ": displaced_in is not above 0");
  for (const Ride& ride : saved.rides) {
    check_frame(ride.from, where + ": what carries it");
    check_frame(ride.to, where + ": what carries it");
    require(finite(ride.time) && (!ride.carrier || ride.time > 0) && finite(ride.way.value_or(0)), where,
            ": how it was carried is not finite");
  }
  require(!saved.seen || (finite(saved.seen->box.low) && finite(saved.seen->box.high) && finite(saved.seen->speed)),
          where, ": where it was seen is not finite");
  require(finite(saved.limit) && saved.limit >= 0 && finite(saved.reach) && saved.reach >= 0, where,
          ": its attachments are not finite, or below 0");
  for (const float way : saved.longest_way)
    require(finite(way) && way >= 0, where, ": a way is not finite, or below 0");
  require(saved.points.size() == cloth.particles, where, " has another number of points");
  require(saved.offsets.size() == (fine_ != shader::kFineOff ? saved.points.size() : 0), where,
          " has another number of offsets");
  constexpr uint32_t kLeast = 10;  // of kLeastYield
  const auto bad = std::ranges::find_if_not(saved.points, [](const SavedPoint& p) {
    return finite(p.position) && finite(p.previous) && finite(p.carry) && p.yield <= kLeast;
  });
  if (bad != saved.points.end())
    refuse_state(where + ": point " + std::to_string(bad - saved.points.begin()) +
                 " is not finite, or yields too much");
  require(std::ranges::all_of(saved.offsets, [](const Vec3& v) { return finite(v); }), where,
          ": an offset is not finite");
  saved.found_points = saved.found.unpacked(saved.data ? saved.data->self.numbers.points : cloth.self.points, where);
}

/// @param colliders  that were saved
void Solver::Impl::check_touched(const Touched& touched, size_t colliders, const std::string& where) {
  constexpr double kMostForce = 1e12;  // [N] that the sum's last digit may stand for
  const size_t count = touched.colliders.size();
  require(touched.about.size() == count && touched.restored.size() == count, where, ": its contacts do not agree");
  for (const std::optional<uint32_t>& collider : touched.colliders)
    require(!collider || *collider < colliders, where, ": it touched a collider that is not there");
  require(std::ranges::all_of(touched.about, [](const Vec3& v) { return finite(v); }) && finite(touched.origin), where,
          ": what it touched is not finite");
  require(touched.force >= 0 && touched.force <= kMostForce, where, ": its contacts have no such force");
}

void Solver::Impl::take_scene(Saved& saved) {
  settings_.frame_time = saved.frame_time;
  settings_.substeps = saved.substeps;
  settings_.gravity = saved.gravity;
  wind_ = saved.wind;
  origin_ = saved.origin;
  time_ = saved.time;
  step_length_ = saved.step_length;
  calm_step_ = saved.calm_step;
  frame_.motion_word = saved.motion_word;
  const std::vector<Collider> before = std::exchange(colliders_to_, {});
  frames_from_.clear();
  collider_ways_.clear();
  places_seen_.clear();
  deform_.clear();
  for (SavedCollider& c : saved.colliders) {
    colliders_to_.push_back(std::move(c.collider));
    frames_from_.push_back(c.from);
    collider_ways_.push_back(c.way);
    places_seen_.push_back(c.place_seen);
    deform_.push_back(c.deform);
  }
  if (saved.has_colliders) {
    take_shapes(before, Matches(colliders_to_.size()));
  } else {
    shapes_.clear();
    collider_numbers_.reset();
  }
  scene_changed_ = saved.scene_changed;
  groups_changed_ = saved.groups_changed;
}

void Solver::Impl::take_cloth(SavedCloth& saved, uint32_t index) {
  Cloth& cloth = cloths_[index];
  cloth.arrived = saved.arrived;
  cloth.material = saved.material;
  cloth.fabrics = std::move(saved.new_fabrics);
  cloth.weakest = weakest_of(cloth);
  cloth.pins.clear();
  for (const auto& [pixel, pin] : saved.pins) cloth.pins.emplace_back(pixel, pin);
  ClothFrame frame;
  frame.pins_changed = true;
  take_pins(cloth, frame);
  for (const auto& [pixel, pin] : saved.pins) frame.pins.emplace_back().pixel.x = pixel;
  cloth.pins_changed = saved.pins_changed;
  cloth.masses_changed = saved.masses_changed;
  cloth.parent_from = saved.parent_from;
  cloth.parent_to = saved.parent_to;
  cloth.parent_first = saved.parent_first;
  cloth.middle = saved.middle;
  cloth.inertia_scale = saved.inertia_scale;
  cloth.collide_cells = saved.collide_cells;
  cloth.teleport = saved.teleport;
  cloth.rides_on = saved.rides_on;
  cloth.touched = std::move(saved.touched);
  cloth.asleep = saved.asleep;
  cloth.disturbed = saved.disturbed;
  cloth.restless = saved.restless;
  cloth.placed_at = saved.placed_at;
  cloth.pulled_at = saved.pulled_at;
  cloth.calm_for = saved.calm_for;
  cloth.alone_for = saved.alone_for;
  cloth.displaced_in = saved.displaced_in;
  cloth.compliance_step = saved.compliance_step;
  cloth.last_step = saved.last_step;
  cloth.measured_steps = saved.measured_steps;
  cloth.rides = saved.rides;
  cloth.seen = saved.seen;
  cloth.look_again = saved.look_again;
  cloth.limit = saved.limit;
  cloth.reach = saved.reach;
  cloth.strayed = saved.strayed;
  cloth.pressure = saved.pressure;
  cloth.gravity_scale = saved.gravity_scale;
  cloth.wind_scale = saved.wind_scale;
  cloth.sewn_from = saved.sewn_from;
  cloth.sewn_to = saved.sewn_to;
  cloth.meets = saved.meets;
  cloth.calm_frames = saved.calm_frames;
  cloth.resting.reset();
  cloth.unruly_until = time_ + kUnruly;  // for all that is known it was just put there

  ClothMemory memory;
  memory.longest_way = saved.longest_way;
  memory.left_behind = saved.left_behind;
  memory.found = std::move(saved.found_points);
  const vec4 nothing{0, 0, 0, 0};
  const uint32_t pixels = cloth.asset->pixel_count();
  for (std::vector<vec4>* image : {&memory.position, &memory.previous, &memory.carry}) image->assign(pixels, nothing);
  if (!saved.offsets.empty()) memory.offset.assign(pixels, nothing);
  size_t next = 0;
  for (uint32_t p = 0; p < pixels; ++p) {
    if (!cloth.asset->valid(p)) continue;
    const SavedPoint& point = saved.points[next];
    const float w = shader::uintBitsToFloat(shader::floatBitsToUint(frame.inverse_mass[p]) | point.yield);
    const auto texel = [&](const Vec3& v) { return vec4{v.x, v.y, v.z, w}; };
    memory.position[p] = texel(point.position);
    memory.previous[p] = texel(point.previous);
    memory.carry[p] = texel(point.carry);
    if (!memory.offset.empty()) memory.offset[p] = texel(saved.offsets[next]);
    ++next;
  }
  backend_->write_memory(index, memory, frame);
}

void Solver::Impl::restore(std::span<const std::byte> bytes) {
  Saved saved;
  StateReader reader(bytes);
  saved.exchange_header(reader);
  if (saved.magic != kMagic) refuse_state("it does not begin as one; it must come from Solver::save()");
  if (saved.version != kVersion) {
    refuse_state("it has version " + std::to_string(saved.version) + ", this library reads version " +
                 std::to_string(kVersion));
  }
  saved.exchange(reader);
  reader.end();
  checked([&] { check_scene(saved); });
  for (uint32_t c = 0; c < cloths_.size(); ++c) {
    require(saved.cloths[c].mark == mark_of_cloth(cloths_[c]), name_of(c),
            " was made with another asset, transform, self_collision or inter_collision");
  }
  checked([&] {
    check_colliders(saved);
    check_versions(saved);
    for (uint32_t c = 0; c < cloths_.size(); ++c) {
      check_cloth(saved.cloths[c], c);
      check_touched(saved.cloths[c].touched, saved.colliders.size(), name_of(c));
    }
  });

  for (uint32_t c = 0; c < cloths_.size(); ++c)
    if (saved.cloths[c].data) take_version(c, saved.cloths[c].asset, std::move(*saved.cloths[c].data));
  if (saved.inter) take_inter(std::move(*saved.inter), saved.inter_origin);
  take_scene(saved);
  for (uint32_t c = 0; c < cloths_.size(); ++c) take_cloth(saved.cloths[c], c);
  if (inter_.points > 0) backend_->write_found(saved.found_points);
}

}  // namespace geocloth
