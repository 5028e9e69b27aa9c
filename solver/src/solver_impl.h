// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backend.h"
#include "colliders/reach.h"
#include "frame_input.h"
#include "geocloth/solver/solver.h"
#include "rest/upload.h"

namespace geocloth {

/// [s] Cloth that was put somewhere may be drawn from there so hard that nobody knows where it goes.
inline constexpr double kUnruly = 0.5;

/// [s] In a shorter step what a position moves by is lost in its rounding.
inline constexpr double kShortStep = 1.0 / 5000;

/// What a Solver is: it checks what the caller says, keeps pins and colliders between frames, and feeds a backend.
class Solver::Impl {
 public:
  using BackendFactory = std::function<std::unique_ptr<SolverBackend>(SimulationData)>;
  Impl(std::span<const ClothDesc> cloths, const SolverSettings& settings, const BackendFactory& make_backend);

  uint32_t add_cloth(const ClothDesc& cloth);
  [[nodiscard]] std::vector<uint32_t> cloths() const;
  /// The functions below know a cloth by its place among those that there are, not by its number.
  [[nodiscard]] uint32_t index_of(uint32_t number) const;
  void remove_cloth(uint32_t cloth);

  void set_colliders(std::span<const Collider> colliders, bool teleport);
  void set_wind(const Wind& wind);
  void set_gravity(const Vec3& gravity);
  void set_time_step(double frame_time, uint32_t substeps);
  void set_pins(uint32_t cloth, std::span<const Pin> pins);
  [[nodiscard]] std::vector<uint32_t> held_pixels(uint32_t cloth) const;
  void set_pressure(uint32_t cloth, float pressure);
  void set_gravity_scale(uint32_t cloth, float scale);
  void set_wind_scale(uint32_t cloth, float scale);
  void set_sewing(uint32_t cloth, std::optional<float> share);
  [[nodiscard]] float sewing_gap(uint32_t cloth);
  void set_material(uint32_t cloth, const Material& material);
  [[nodiscard]] const Material& material(uint32_t cloth) const { return cloths_[cloth].material; }
  void set_fabric(uint32_t cloth, uint32_t fabric, const Material& material);
  [[nodiscard]] const Material& fabric(uint32_t cloth, uint32_t fabric) const;
  void set_meets(uint32_t cloth, uint32_t groups);
  void set_parent(uint32_t cloth, const Transform& pose, const Vec3& inertia_scale, bool teleport);
  CutResult cut(uint32_t cloth, const std::array<Vec3, 3>& triangle);
  CutResult tear(uint32_t cloth, float stretch);
  [[nodiscard]] const std::shared_ptr<const ClothAsset>& asset(uint32_t cloth) const { return cloths_[cloth].asset; }
  void step();

  void read_positions(uint32_t cloth, std::vector<Vec3>& out);
  void read_normals(uint32_t cloth, std::vector<Vec3>& out);
  void read_velocities(uint32_t cloth, std::vector<Vec3>& out);
  void write_state(uint32_t cloth, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  /// @param cloth  none: of all
  [[nodiscard]] std::vector<ContactForce> contact_forces(std::optional<uint32_t> cloth);
  [[nodiscard]] SolverStatistics statistics();
  void save(std::vector<std::byte>& out);
  void restore(std::span<const std::byte> bytes);

  [[nodiscard]] SolverBackend& backend() { return *backend_; }
  [[nodiscard]] Vec3 origin() const { return origin_; }
  [[nodiscard]] bool asleep(uint32_t cloth) const { return cloths_[cloth].asleep; }
  [[nodiscard]] uint32_t cloth_count() const { return static_cast<uint32_t>(cloths_.size()); }

 private:
  struct PinState {
    Vec3 from, target;  ///< [m, world] at the start and the end of the next frame
    PinHold hold;
    BackBall back;
    [[nodiscard]] bool held() const { return hold == PinHold(); }
    [[nodiscard]] bool is_as(const PinState& b) const {
      return target == b.target && hold == b.hold && back.to == b.back.to && back.radius == b.back.radius;
    }
    /// A frame has begun, or the point has jumped: it comes from where it is.
    void arrive() {
      from = target;
      back.from = back.to;
    }
  };
  using PixelPin = std::pair<uint32_t, PinState>;
  /// How a fast collider that may carry a cloth moves in a frame.
  struct Ride {
    std::optional<uint32_t> carrier;  ///< the collider; none where none is fast
    Transform from, to;               ///< [m, world] its poses
    double time = 0;                  ///< [s] of the frame
    std::optional<float> way;  ///< [m] that the fastest collider goes in a substep as seen from the cloth, if it rides
  };
  /// What cloths of the same groups meet, in frame_.
  struct Meets {
    uint32_t groups, first_shape, first_pose, count;
  };
  /// Where a cloth is that no pins tell of.
  struct Seen {
    ClothBox box;     ///< [m] relative to the origin, at the start of the next frame
    float speed = 0;  ///< [m/s] of its points
  };
  /// Whose contacts a cloth's last frame has summed, in which it was awake.
  struct Touched {
    std::vector<std::optional<uint32_t>> colliders;  ///< in the order in which it met them; none: not there any more
    std::vector<Vec3> about;                         ///< [m, world] where their torques turn
    Vec3 origin;                                     ///< [m, world] where moments are summed about
    double force = 0;                                ///< [N] of a sum of 1
    std::vector<ContactSum> restored;                ///< one for each, of a state until the next step; else a backend's
  };
  struct Cloth {
    uint32_t number = 0;
    double arrived = 0;                                 ///< [s] time_ when it was added
    std::shared_ptr<const ClothAsset> asset, original;  ///< as cuts have left it, and as it was given
    Material material;
    std::vector<Fabric> fabrics;
    Material weakest;  ///< see FabricMap::weakest()
    Transform start;   ///< where its rest shape started
    float scale = 1;
    std::vector<float> free_inverse_mass;  ///< [1/kg] without pins
    std::vector<uint32_t> row_of_pixel;    ///< row of the split-vertex table, kNoPixel for a single pixel
    std::vector<PixelPin> pins;            ///< ascending by pixel, all copies listed
    [[nodiscard]] bool holds(uint32_t pixel) const {
      const auto pin = std::ranges::lower_bound(pins, pixel, {}, &PixelPin::first);
      return pin != pins.end() && pin->first == pixel && pin->second.held();
    }
    bool pins_changed = false, masses_changed = false;  ///< since the last step
    std::vector<PinWay> pin_ways;                       ///< of the pins that are held, by number instead of pixel
    bool hangs_by_few = false;                          ///< few springs lead from its pins to what hangs on them
    std::vector<Vec3> pin_targets;                      ///< of all pins in their order, for a frame
    std::optional<Transform> parent_from, parent_to;    ///< at the start and the end of the next frame
    Transform parent_first;                             ///< its first one
    float size = 0;                                     ///< [m] at rest
    Vec3 start_middle, middle;                          ///< [m, world] of its points: at the start, where last seen
    float strayed = 0;                                  ///< [m] that it may have gone since then, if nothing holds it
    [[nodiscard]] bool is_free() const { return pins.empty() && !parent_to; }
    Vec3 inertia_scale{1, 1, 1};
    std::optional<SelfCollision> self_collision;
    SelfNumbers self;
    std::optional<InterCollision> inter_collision;
    float pressure = 0;  ///< [Pa]
    float gravity_scale = 1;
    float wind_scale = 1;
    std::optional<float> sewn_from, sewn_to;  ///< see set_sewing(), at the start and the end of the next frame
    uint32_t meets = 0;                       ///< groups of colliders
    bool collide_cells = false;               ///< a collider was met that may slip through between pixels
    bool teleport = false;                    ///< the parent jumps before the next frame
    double placed_at = -1;                    ///< [s] time_ when a state was written where the parent had jumped to
    bool pins_anew = false;        ///< in the next frame other points are pinned than before, or have other masses
    bool meets_fast = false;       ///< in the next frame, if a collider is fast that may meet it
    std::optional<float> met_way;  ///< [m] longest of a collider in a usual substep, if some cannot meet it
    uint32_t factor = 1;           ///< times as many substeps as usual in the next frame
    Ride ride;                     ///< in the next frame
    std::optional<Seen> seen;      ///< once it had to be looked for; grown since then by the way that it may have gone
    /// [m] Box about it in the next frame, or about the pins that hold all of it; none where that is not known.
    std::optional<ClothBox> place;
    bool held_in_place = false;  ///< of the pins
    double unruly_until = 0;     ///< [s] time_ from which on it can be where it should, after it was put elsewhere
    double look_again = 0;       ///< [s] time_ from which on it may be looked for
    bool looked_for = false, looked_at = false;  ///< in the next frame
    bool rides_on = false;                       ///< it rode in the last frame
    std::array<Ride, 2> rides;                   ///< in the last two, by the word that was measured into
    float limit = 0;                             ///< ClothParams::stretch_limit of the last frame, as it sinks
    double pulled_at = 0;                        ///< [s] when pins last pulled it apart
    bool hangs = false;                          ///< every point has an attachment or is pinned
    float reach = 0;                             ///< [m] of the longest attachment; without pins of the whole cloth
    uint64_t particles = 0, springs_per_sweep = 0;
    std::optional<uint64_t> mark;  ///< of what it was made with, once asked for

    Touched touched;  ///< only with SolverSettings::contact_forces

    bool asleep = false;
    bool disturbed = true;                   ///< since the last step
    uint32_t calm_frames = 0;                ///< since it was disturbed
    double calm_for = 0;                     ///< [s] that it has been slow
    double alone_for = 0;                    ///< [s] that nothing has disturbed it, of one that nothing holds
    bool restless = false;                   ///< it has not come to rest for long then
    std::optional<ClothBox> resting;         ///< about it where it sleeps, once a collider has moved meanwhile
    double displaced_in = 0;                 ///< [s] step length of the displacements that the backend holds
    double compliance_step = 0;              ///< [s] the length that compliances are of
    double last_step = 0;                    ///< [s] of the last frame's substeps
    std::array<double, 2> measured_steps{};  ///< [s] of the substeps in the last two frames, by motion_word
  };

  struct Saved;
  struct SavedCloth;
  void keep_cloth(uint32_t cloth, SavedCloth& saved);
  void check_scene(const Saved& saved) const;
  void check_colliders(Saved& saved);
  void check_versions(Saved& saved) const;
  void check_cloth(SavedCloth& saved, uint32_t cloth) const;
  static void check_touched(const Touched& touched, size_t colliders, const std::string& where);
  void take_scene(Saved& saved);
  void take_cloth(SavedCloth& saved, uint32_t cloth);
  [[nodiscard]] uint64_t mark_of_cloth(Cloth& cloth) const;
  [[nodiscard]] uint64_t mark_of_settings() const;
  [[nodiscard]] uint64_t mark_of_field(const std::shared_ptr<const DistanceField>& field);

  [[nodiscard]] Cloth made_of(const ClothDesc& desc, const ClothData& data);
  [[nodiscard]] std::string name_of(uint32_t cloth) const;
  static void keep_last_of_each(std::vector<PixelPin>& pins);
  void fill_cloth_frame(Cloth& cloth, ClothFrame& frame) const;
  void ease_from_present(uint32_t cloth);
  void ease_limit(Cloth& cloth, ClothFrame& frame) const;
  void change_pins(Cloth& cloth, ClothFrame& frame) const;
  [[nodiscard]] static std::vector<float> masses_of(const Cloth& cloth);
  void take_pins(Cloth& cloth, ClothFrame& frame) const;
  [[nodiscard]] static float pull_of_pins(const Cloth& cloth, float least);
  [[nodiscard]] bool has_pins_above(const Cloth& cloth) const;
  [[nodiscard]] static bool sags_between_pins(const Cloth& cloth);
  using Matches = std::vector<std::optional<uint32_t>>;  ///< of match_colliders()
  [[nodiscard]] std::vector<Vec3> collider_places() const;
  std::optional<Matches> take_places(std::span<const Collider> asked_before);
  void take_shapes(std::span<const Collider> asked_before, const std::optional<Matches>& before);
  void take_deformations(std::span<const Collider> asked_before);
  [[nodiscard]] bool anything_deforms() const;
  void carry_over();
  [[nodiscard]] Vec3 middle_of_told(const Cloth& cloth) const;
  [[nodiscard]] static std::optional<ParentWay> parent_way(const Cloth& cloth);
  void follow_cloths(const std::optional<Vec3>& arriving = std::nullopt);
  /// What may change of a cloth that others meet.
  struct Version {
    double arrived;
    const ClothAsset* asset;
    std::span<const float> inverse_mass;  ///< [1/kg] without pins
    float friction;
  };
  [[nodiscard]] std::vector<Version> versions() const;
  [[nodiscard]] ClothData cloth_data(const Cloth& cloth, const std::shared_ptr<const ClothAsset>& asset,
                                     const Material& material, const std::vector<Fabric>& fabrics) const;
  [[nodiscard]] static std::vector<float> stretch_shares(const Cloth& cloth);
  [[nodiscard]] static Material weakest_of(const Cloth& cloth);
  void change_fabrics(uint32_t cloth, const Material& material, std::vector<Fabric> fabrics);
  [[nodiscard]] InterData inter_data(std::span<const Version> cloths, const Vec3& origin) const;
  void take_cut(uint32_t cloth, std::shared_ptr<const ClothAsset> asset);
  void take_version(uint32_t cloth, std::shared_ptr<const ClothAsset> asset, ClothData data);
  void take_inter_anew();
  void take_inter(InterData inter, const Vec3& origin);
  [[nodiscard]] bool meets_others(const Cloth& cloth) const { return inter_.points > 0 && cloth.inter_collision; }
  [[nodiscard]] float stretch_limit(const Cloth& cloth) const;
  [[nodiscard]] Vec3 gravity_of(const Cloth& cloth) const { return cloth.gravity_scale * settings_.gravity; }
  [[nodiscard]] std::optional<Wind> wind_on(const Cloth& cloth) const;
  [[nodiscard]] FrameClock clock() const;
  [[nodiscard]] std::optional<ClothBox> box_of_pins(const Cloth& cloth) const;
  [[nodiscard]] uint32_t even_substeps();
  void choose_factors();
  [[nodiscard]] bool may_meet(uint32_t cloth, uint32_t collider, bool rides);
  [[nodiscard]] bool is_seen_near(const Cloth& cloth, uint32_t collider) const;
  [[nodiscard]] float fastest_about(const Cloth& cloth) const;
  [[nodiscard]] float way_from(const Cloth& cloth, float speed) const;
  void look_at(uint32_t cloth);
  void let_seen_go(Cloth& cloth) const;
  void choose_compliance_step(Cloth& cloth) const;
  [[nodiscard]] bool meets(const Cloth& cloth, size_t collider) const {
    return geocloth::meets(cloth.meets, colliders_to_[collider]);
  }
  [[nodiscard]] Meets met_in_groups(uint32_t groups);
  void find_place(uint32_t cloth);
  [[nodiscard]] ClothBox box_about(const Cloth& cloth, const Whereabouts& known, float speed) const;
  [[nodiscard]] Meets met_by(const Cloth& cloth, float stretch_limit, const Meets& shared);
  [[nodiscard]] Meets list_colliders(uint32_t groups, std::span<const uint32_t> colliders);
  [[nodiscard]] float longest_way(const Cloth& cloth) const;
  void run_group(uint32_t factor);
  void sum_contacts(Cloth& cloth, ClothFrame& frame, bool all_in_groups) const;
  void read_contacts(uint32_t cloth, std::vector<ContactSum>& sums) const;
  void follow_colliders(std::span<const std::optional<uint32_t>> before);
  [[nodiscard]] const Ride* ride_of(uint32_t cloth);
  [[nodiscard]] float way_seen_from(const Ride* ride, uint32_t collider) const;
  void measure_ride(Cloth& cloth, ClothFrame& frame) const;
  void find_movers();
  void leave_alone(uint32_t cloth, bool is_disturbed);
  [[nodiscard]] bool is_reached(uint32_t cloth);
  void fall_asleep();
  static void wake(Cloth& cloth);
  void stray(uint32_t cloth);
  [[nodiscard]] double speed_of(uint32_t cloth) const;
  [[nodiscard]] bool is_calm(uint32_t cloth);

  SolverSettings settings_;
  uint32_t fine_;                  ///< ClothParams::fine
  Vec3 origin_;                    ///< [m] whole metres, near the cloths
  std::vector<Vec3> places_seen_;  ///< [m] of the colliders when cloth was looked for
  std::vector<Cloth> cloths_;      ///< ascending by number
  uint32_t next_number_ = 0;
  std::vector<PixelPin> next_pins_;                             ///< memory of set_pins()
  SelfNumbers inter_;                                           ///< of the cloths that collide with each other
  Vec3 inter_origin_;                                           ///< [m] origin_ when it was made
  std::vector<Collider> colliders_to_;                          ///< at the end of the next frame
  std::vector<Transform> frames_from_;                          ///< [m, world] of their shapes at its start
  std::vector<float> deform_;                                   ///< [m] in the next frame, see collider_poses()
  std::vector<Vec3> collider_ways_;                             ///< [m] that their frames went in the last frame
  std::vector<shader::ColliderShape> shapes_;                   ///< of colliders_to_
  std::shared_ptr<const std::vector<float>> collider_numbers_;  ///< of their hulls and meshes
  std::optional<Wind> wind_;
  std::vector<uint32_t> movers_;  ///< colliders that go on evenly in the next frame
  std::vector<Meets> meets_;      ///< of the cloths that were told about the next frame
  std::vector<ClothBox> swept_;   ///< about each collider in that frame
  std::vector<uint32_t> met_;     ///< memory of met_by()
  bool scene_changed_ = true;     ///< since the last step, other than colliders
  uint32_t groups_changed_ = 0;   ///< of colliders that have changed since then, other than by moving evenly
  double time_ = 0;               ///< [s] at the start of the next frame
  double step_length_ = 0;        ///< [s] of a substep, that the last frame's were to have without haste; 0: no frame
  double calm_step_;              ///< [s] of a substep, about which steps may vary without waking cloth
  uint32_t usual_substeps_;       ///< of the next frame without haste
  uint32_t substeps_;             ///< of the cloths that are told about the next frame
  std::vector<std::pair<std::shared_ptr<const DistanceField>, uint64_t>> field_marks_;  ///< of saved colliders
  std::vector<shader::vec4> looked_position_, looked_previous_;                         ///< memory of look_at()
  FrameInput frame_;  ///< of the last step, whose memory the next one uses again
  std::unique_ptr<SolverBackend> backend_;
};

}  // namespace geocloth
