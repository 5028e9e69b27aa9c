// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/solver/collider.h"
#include "geocloth/solver/device.h"
#include "geocloth/solver/material.h"
#include "geocloth/solver/transform.h"

namespace geocloth {

/// How the layers of a cloth keep apart. Points of the grid are balls, so that it holds for the whole of the cloth (its
/// several parts too) while it is not far more stretched than the distance; see solver/README.md for what it costs.
struct SelfCollision {
  /// [m] That points keep, up to 3 spacings; below 0: 1.2 times the spacing. Other cloth comes through between points
  /// that keep less than 0.71 of it (half of a cell's diagonal).
  float distance = -1;
};

/// How a cloth keeps apart from all other cloths of the solver that have one too. Points are balls here as well. Two
/// cloths keep the mean of their distances, and three quarters of the larger one at least; points of two cloths that
/// start nearer than that keep nine tenths of what they start with. Friction is the mean of both materials'. The
/// coarsest of them has at most ten times the spacing of the finest.
struct InterCollision {
  /// [m] That points keep, up to 3 spacings; below 0: 1.2 times the spacing. Other cloth comes through between points
  /// that keep less than 0.71 of it (half of a cell's diagonal).
  float distance = -1;
};

/// Cells of a cloth that are of another fabric: a collar, a waistband, a leather patch. A cell is a fabric's if all of
/// its corners are listed, the last one's of several; pixels weigh and bend as the cells about them do.
struct Fabric {
  std::vector<uint32_t> pixels = {};  ///< valid ones, in any order
  /// Its density, stretch, shear and bending count; what else a material has is the cloth's own. In physical units.
  Material material = {};
  bool operator==(const Fabric&) const = default;
};

/// One garment in the solver.
struct ClothDesc {
  std::shared_ptr<const ClothAsset> asset = {};  ///< not null; the solver keeps it
  Material material = {};
  Transform transform = {};  ///< where its rest shape starts; scale also scales rest lengths and areas
  std::optional<SelfCollision> self_collision = {};    ///< none: it passes through itself
  std::optional<InterCollision> inter_collision = {};  ///< none: it passes through other cloths
  uint32_t meets = ~uint32_t{0};                       ///< Collider::groups that it meets; others are not there for it
  std::vector<Fabric> fabrics = {};                    ///< in other places than `material`; up to 32
};

struct Wind {
  Vec3 velocity = {};    ///< [m/s] components up to 1e4
  float turbulence = 0;  ///< gust speed as a share of |velocity|; 0..1e3
  float frequency = 1;   ///< [1/s] of the slowest gust; above 0, up to 1e4
  float drag = 1;        ///< drag coefficient across the cloth; 0..1e4
  float lift = 0;        ///< lift coefficient; 0..1e4
  bool operator==(const Wind&) const = default;
};

/// Ways to run the passes of a frame, with the same results. A cloth that one of them cannot run goes the plain way.
enum class SolverPath : uint8_t {
  automatic,  ///< the fastest: sweeps through the rows on the cpu; tiny, else tiled on a GPU; plain on a software
              ///< device
  plain,      ///< pass by pass: the reference that the others are compared with
  tiled,      ///< vulkan: two dispatches for each substep of an uncut cloth; not with several relaxation steps
  tiny        ///< vulkan: one dispatch for each frame (of a software device: substep), for cloths that fit into the
              ///< memory of a work group
};
[[nodiscard]] const char* to_string(SolverPath path);

struct SolverSettings {
  Backend backend = Backend::automatic;
  std::string device = {};       ///< part of a device's name; empty: by backend
  uint32_t threads = 1;          ///< cpu backend, 1..1024; the result does not depend on it
  double frame_time = 1.0 / 60;  ///< [s] up to 10; a substep must be 1e-7 at least
  /// Per frame, 1..256; more is stiffer and loses less energy. Where a substep is shorter than 1/5000 s as the solver
  /// is made, positions have twice the digits for good: a point at rest moves by less than one digit in such a step.
  uint32_t substeps = 16;
  uint32_t relaxation_steps = 1;  ///< sweeps over all constraints per substep, 1..256
  /// Springs pull along where they were when the substep began, on positions of twice the digits: free cloth keeps its
  /// angular momentum, which it loses else by the share w^2 dt a second of a spin w [1/s]. About seven times as slow.
  bool keep_momentum = false;
  Vec3 gravity{0, -9.81F, 0};  ///< [m/s^2] components up to 1e4
  /// How far gravity strays up and down along a wave in space, as a share of it, 0..0.01. A sheet in a plane whose
  /// forces all lie in that plane never leaves it, however much it is squeezed, as a column without imperfections never
  /// buckles: 1e-6 lets a flat curtain fold. Which folds then come hangs on rounding, on cuts and on resolution.
  float imperfection = 0;
  bool timings = false;  ///< measure every pass (slower)
  SolverPath path = SolverPath::automatic;
  /// [m/s] A cloth none of whose points has been faster for `sleep_time` is asleep: it stays as it is and costs
  /// nothing, until a collider that it meets moves so that it may touch it, comes, changes or goes, a pin of it or its
  /// parent moves, or it is cut, written to, or anything else is set to another value (a substep's length to one that
  /// differs by a quarter). Wind keeps cloth awake. 0: never; up to 1e4. Speeds are known two frames late.
  float sleep_speed = 0;
  float sleep_time = 0.5F;      ///< [s] 0..1e6
  bool check_copies = false;    ///< measure the copy gap and the penetration after every substep (slower)
  bool contact_forces = false;  ///< sum what cloth does to colliders, for Solver::contact_forces()
};

/// What a point that is free within a distance of its target must not get behind, such as the skin that it lies on: a
/// ball, which costs next to nothing where a collider that deforms has to be measured anew in every frame.
struct Backstop {
  Vec3 outward = {};    ///< unit normal of the surface that the target lies on, as the target is there
  float distance = 0;   ///< [m] from the target down to the ball; 0 to 100
  float radius = 0.5F;  ///< [m] of the ball, above 0 and up to 100: a point s aside may be s^2 / (2 radius) lower
};

/// A pinned point: it follows `target`, which is reached at the end of the next frame. Copies are pinned with it. With
/// neither a frequency nor a largest distance it is held there.
struct Pin {
  uint32_t pixel = 0;
  Vec3 target = {};  ///< [m] components up to 1e6
  /// [1/s] Above 0, up to 1e4: soft, drawn by a critically damped spring that would swing its own mass with this
  /// frequency, at substeps that are short beside it. A row of pins that cloth hangs from gives way further on a finer
  /// grid, where it is lighter.
  float frequency = 0;
  float max_distance = 0;  ///< [m] above 0, up to 1e4: it moves freely, or softly, as far as that from its target
  std::optional<Backstop> backstop = {};  ///< not of points that are held
};

struct PassTiming {
  std::string pass;    ///< name as in the pass list
  double seconds = 0;  ///< sum over the frames since the last reset
};

struct SolverStatistics {
  std::string backend, device, path;  ///< e.g. "vulkan", "llvmpipe ...", "plain"
  uint32_t threads = 1;
  uint64_t particles = 0;          ///< valid pixels
  uint64_t springs = 0;            ///< projected once per relaxation step, all families and seam bends
  uint32_t asleep = 0;             ///< cloths that the last step left as they were
  uint64_t memory_bytes = 0;       ///< state and constants of all cloths, where the solver runs
  std::vector<PassTiming> passes;  ///< with SolverSettings::timings
  double copy_gap = 0;             ///< [m] largest distance between copies after any substep, with check_copies
  double penetration = 0;  ///< [m] largest depth below a collider's surface after any substep, with check_copies
};

/// What cloth did to a collider in a frame, or one cloth: by contact and friction, not by pins that follow it.
struct ContactForce {
  Vec3 force;   ///< [N] mean over the frame; times SolverSettings::frame_time it is the impulse [N s]
  Vec3 torque;  ///< [N m] the same, about the collider's Collider::pose.translate at the frame's end
};

/// What a cut has severed, or several.
struct CutResult {
  uint64_t springs = 0;        ///< of all families, and bends over seams
  uint64_t cells = 0;          ///< of four pixels that are open now
  uint64_t parted_points = 0;  ///< of a seam: rows of the split-vertex table whose copies have come apart
  bool operator==(const CutResult&) const = default;
  CutResult& operator+=(const CutResult& other) {
    springs += other.springs;
    cells += other.cells;
    parted_points += other.parted_points;
    return *this;
  }
};

/// Simulates any number of garments. Not copyable; movable; use from one thread at a time.
class Solver {
 public:
  /// @param cloths  cloths 0, 1, 2 ... of the solver; others may come later, also to none
  /// @throws Error(invalid_argument) for a value out of range, Error(device) when no device fits
  /// @throws Error(invalid_data) for an asset that validate() refuses
  /// @throws Error(limit) for more than 32 fabrics, where too many points meet or are sewn to one, or where the device
  ///   has no images as large as an asset
  Solver(std::span<const ClothDesc> cloths, const SolverSettings& settings);
  Solver(Solver&&) noexcept;
  Solver& operator=(Solver&&) noexcept;
  ~Solver();

  /// Adds a cloth, which takes part in the next step. The others go on as if it were not there, but for rounding (the
  /// origin that positions are kept relative to is near the middle of all cloths; hundreds of metres from it they
  /// tremble by more than a usual sleep_speed), and but for those that it collides with: where it begins nearer to one
  /// of them than they keep, they part at once, unless that one has come since the last step as well. Costs what making
  /// a solver of it costs, less the device; waits for the device, which is told anew what all cloths have to do.
  /// @return its number: one more than that of the cloth that was added last, never again that of another
  /// @throws Error as the constructor does, and leaves the solver as it is
  uint32_t add_cloth(const ClothDesc& cloth);
  /// Takes a cloth away with all that it has; waits for the device. Those that collided with it wake. Its number is not
  /// in use any more, the others keep theirs. @throws Error(invalid_argument) where there is no such cloth
  void remove_cloth(uint32_t cloth);
  /// The numbers of the cloths that there are, ascending.
  [[nodiscard]] std::vector<uint32_t> cloths() const;

  /// Takes effect in the next step. Each collider moves evenly over the frame from where the last call put it. Which
  /// one it is follows from its name: of those with one name (none is a name too) the first one is the first one of the
  /// last call, and so on. Where there are more or fewer of that name than there were, those stay that have the same
  /// shape as before, in their order, as many as there can be; among equal shapes those that are nearest to where
  /// they would be if all went on as in the last frame. The others are placed without a velocity, as are all with
  /// teleport. Give names to what comes and goes in one call.
  /// @throws Error(invalid_argument), as all that follow here do for values out of range and for cloths that there are
  ///   not; the solver stays as it is
  void set_colliders(std::span<const Collider> colliders, bool teleport = false);
  void set_wind(const Wind& wind);
  void set_gravity(const Vec3& gravity);
  /// Replaces the pins of a cloth. A point that was not held before goes evenly over the next step from where it is to
  /// its target; soft pins and those with a distance pull towards their targets from the first substep on.
  void set_pins(uint32_t cloth, std::span<const Pin> pins);
  /// Ascending pixels that its pins hold, all copies of a point; soft ones and those with a distance hold nothing.
  [[nodiscard]] std::vector<uint32_t> held_pixels(uint32_t cloth) const;

  /// The pose of what carries the cloth (a rider, a dancer), scale 1; takes effect in the next step, over which it
  /// moves evenly from the pose of the last call: it turns about the middle of the cloth's pins, which goes straight,
  /// and pins whose targets turn about as it does go on its arcs. The cloth trails behind: by inertia_scale 1 it feels
  /// all of the motion, by 0 it is taken along as if the parent stood still; each axis of the parent, shift and turn,
  /// by itself. Damping acts relative to the parent. The first call places the parent; teleport takes cloth and parent
  /// there without a jerk, as they are (waits for the device). A state that is written after that, before the next
  /// step, stays where it is: the parent is there by then.
  void set_parent(uint32_t cloth, const Transform& pose, const Vec3& inertia_scale = {1, 1, 1}, bool teleport = false);

  /// [Pa] -1e6..1e6 By how much more presses on the backs of a cloth's faces than on their fronts, from the next step
  /// on: above 0 it inflates what is closed and wound outwards, and fills a sail. It is the same however large the
  /// volume is; a gas that is shut in loses pressure as it grows, which is for the caller to say. 0 for a new cloth.
  void set_pressure(uint32_t cloth, float pressure);

  /// How much of gravity a cloth feels from the next step on, -100..100; 1 for a new cloth.
  void set_gravity_scale(uint32_t cloth, float scale);

  /// How much of the wind a cloth feels from the next step on, mean and gusts, 0..100; 1 for a new cloth. Below 1 it is
  /// in the lee: indoors, or a lining under a coat. By 0 the air about it is still, and drags all the same.
  void set_wind_scale(uint32_t cloth, float scale);

  /// Sews what ClothAsset::sewing names: at the end of the next step such points are no farther apart than this share,
  /// 0..1e6, of what they are at rest (at least one spacing), and on the way there the share goes on evenly from that
  /// of the last call. So seams close as it sinks to 0, and are held closed by 0. The first call holds points from then
  /// on as far apart as it says: begin with sewing_gap(). None: nothing is sewn, as of a new cloth, and seams that were
  /// come apart.
  void set_sewing(uint32_t cloth, std::optional<float> share);
  /// The largest share of what they are apart at rest that points to be sewn are apart now; 0 without any. Waits for
  /// the device and reads the positions.
  [[nodiscard]] float sewing_gap(uint32_t cloth);

  /// Makes a cloth of another material, from the next step on: it stays where it is and as fast as it is, also where it
  /// is heavier or lighter by then. Springs that are stretched and become stiffer pull at once as they pull from then
  /// on; mix() between two materials, a little further in every frame, is what takes that without a jerk. Where no more
  /// than damping, thickness, friction, max_speed, verlet_damping or a max_stretch changes it costs nothing; else it
  /// waits for the device and makes the springs anew, about 0.5 us a point.
  /// @throws Error(invalid_argument)
  void set_material(uint32_t cloth, const Material& material);
  [[nodiscard]] const Material& material(uint32_t cloth) const;
  /// The same for one of the fabrics that the cloth was made with. Costs as much where anything changes.
  void set_fabric(uint32_t cloth, uint32_t fabric, const Material& material);
  [[nodiscard]] const Material& fabric(uint32_t cloth, uint32_t fabric) const;

  /// From the next step on a cloth meets the colliders that are in one of these groups (bits), and no others: a cape
  /// may pass through the arms of its wearer, and each of many characters have its own. A cloth moves as if the others
  /// did not exist, and costs as much. Pins may follow colliders that their cloth does not meet.
  void set_meets(uint32_t cloth, uint32_t groups);

  /// Cuts a cloth, as it is now, where it meets a triangle: springs and bends that cross it are severed, cells that it
  /// crosses are open from now on (not drawn, not met by colliders or wind), and the copies of a point part where the
  /// cut runs along their seam (the seam's points within 2 % of the spacing of the triangle's plane). Long-range
  /// attachments run around the cut from the next step on; what hangs on no pin any more has none. Masses, positions,
  /// velocities and pins stay: both copies of a pinned point that parts stay pinned until set_pins() says otherwise.
  /// Waits for the device and reads the positions, once for each cut.
  /// @param triangle  [m] corners in the world
  /// @return zeros when it meets nothing, which is no error
  /// @throws Error(invalid_argument) for a corner that is not finite, and for a triangle without an area
  CutResult cut(uint32_t cloth, const std::array<Vec3, 3>& triangle);
  /// Tears a cloth where its springs of warp and weft are longer than `stretch` times their length at rest: as if it
  /// were cut across the most stretched ones, one of those that are near each other and 16 at most. Called before every
  /// step the tears go on as what is left is stretched. A step stretches springs beyond their material, too (see
  /// measure_stretch), so 1.2 at least is of use. Waits for the device and reads the positions, and costs as much as a
  /// cut for each tear.
  /// @param stretch  above 1
  /// @return zeros when nothing tears @throws Error(invalid_argument)
  CutResult tear(uint32_t cloth, float stretch);
  /// The asset of a cloth as it is now: what it was made with, or, once cut, one with the same pixels and vertices but
  /// without the springs, cells, copies and triangles of the source mesh that cuts have taken away.
  [[nodiscard]] std::shared_ptr<const ClothAsset> asset(uint32_t cloth) const;

  /// Frames from now on are so long, of so many substeps; velocities stay. From frame to frame a substep gets at most a
  /// twentieth longer or shorter, so that cloth is not shaken where frames vary: until it is as long as asked for,
  /// there are more or fewer of them, four times as many at most. Where colliders are so fast that they would stretch
  /// a cloth open in a substep, it has up to four times as many in that frame, up to 32 times for small ones. How many
  /// digits positions have does not change with it: for substeps below 1/5000 s make the solver with such.
  /// @throws Error(invalid_argument)
  void set_time_step(double frame_time, uint32_t substeps);
  /// Advances by one frame: on Vulkan it only submits, but for cloth without pins, which it has to look for where a
  /// collider becomes fast or comes near while it is.
  void step();

  /// Waits for the device and copies positions [m] or unit normals, one per pixel (zero where not valid).
  void read_positions(uint32_t cloth, std::vector<Vec3>& out);
  void read_normals(uint32_t cloth, std::vector<Vec3>& out);
  /// Velocities [m/s] over the last substep.
  void read_velocities(uint32_t cloth, std::vector<Vec3>& out);
  /// Puts a cloth into a given state, one position [m] and velocity [m/s] per pixel, components of both up to 1e6;
  /// copies must agree to 1e-6 m. What pins hold is where they have it again in the next step.
  /// @throws Error(invalid_argument) where there are not as many as pixels, where copies disagree, or one is not finite
  ///   or out of range; the solver stays as it is
  void write_state(uint32_t cloth, std::span<const Vec3> positions, std::span<const Vec3> velocities);

  /// All that the frames to come follow from, as bytes, for rollback and replays: restored they give the same bits as
  /// if nothing had been between. May be called at any time between two frames, also after set_ functions that take
  /// effect in the next one. Waits for the device. 40 to 52 bytes a point, with self-collision 16 to 144 more. Not in
  /// it: what the solver was made with, the fields of bodies of triangles, statistics.
  [[nodiscard]] std::vector<std::byte> save();
  /// The same into bytes that are there, whose memory is used again.
  void save(std::vector<std::byte>& state);
  /// Puts everything back as it was: cloths, materials, pins, parents, colliders, wind, gravity, time step, sleep; and
  /// cuts: those made since are undone, those undone are made again. For the solver that was saved and for any other
  /// one that was made with equal settings and has cloths of equal ClothDescs in the same order, under any numbers:
  /// what was added or removed since has to be removed or added before. Materials, backend, threads, path, timings and
  /// check_copies may differ (bits then agree as far as those of backends do). Bodies of triangles have to be among the
  /// present colliders, under any name and at any place: call set_colliders() with them first. Waits for the device.
  /// Bytes are good for the version of the library that wrote them, on machines with the same order of bytes, and are
  /// checked in full: those that are damaged or come from elsewhere are refused or give a state that is safe, if wrong.
  /// @throws Error(invalid_data) for bytes that do not fit, and leaves the solver as it is
  void restore(std::span<const std::byte> state);

  /// What all cloths did to the colliders in the last step, in the order of the last set_colliders(): to let a body
  /// give way, as an engine moves it, or to read how hard cloth presses and pulls. A collider that has come since then
  /// has felt nothing. A cloth that is asleep goes on pressing as it did when it fell asleep. Forces are those of
  /// substeps: with few of them they tremble where cloth rests, and are right in the mean. They are estimates where
  /// something hits cloth, and up to a third too small where cloth that collides with itself or with other cloth hangs
  /// from few points of it (solver/README.md). The same bits with any path and any number of threads. Waits for the
  /// device. Right after restore() those of the step before save().
  /// @throws Error(invalid_argument) without SolverSettings::contact_forces
  [[nodiscard]] std::vector<ContactForce> contact_forces();
  /// The same of one cloth.
  [[nodiscard]] std::vector<ContactForce> contact_forces(uint32_t cloth);

  [[nodiscard]] uint32_t cloth_count() const;
  /// Whether the last step left the cloth as it was, see SolverSettings::sleep_speed.
  [[nodiscard]] bool asleep(uint32_t cloth) const;
  [[nodiscard]] SolverStatistics statistics();
  void wait();

  class Impl;
  explicit Solver(std::unique_ptr<Impl> impl);   ///< for vulkan_interop.h
  [[nodiscard]] Impl& impl() { return *impl_; }  ///< for vulkan_interop.h

 private:
  std::unique_ptr<Impl> impl_;
};

/// Measures of a state, in double precision on the host.
struct StretchStatistics {
  /// Of length / rest length over the valid structural springs; a length that is not finite counts as infinite.
  double max = 0, p99 = 0, mean = 0;
};
/// @throws Error(invalid_argument) unless there is one position for each pixel
[[nodiscard]] StretchStatistics measure_stretch(const ClothAsset& asset, float scale, std::span<const Vec3> positions);

struct Energy {
  double kinetic = 0, potential = 0;  ///< [J]; potential is zero at the height y = 0
  /// [J] of the springs and bends at the lengths they have. With few substeps the cloth is longer than its material
  /// pulls: then this is more than what it has taken up, and nothing turns it into motion.
  double elastic = 0;
};
/// Measures the energy of a cloth in many states: what it is made of is worked out once.
class EnergyMeter {
 public:
  /// @throws Error as the constructor of a Solver does for such a cloth
  explicit EnergyMeter(const ClothDesc& cloth);
  ~EnergyMeter();
  EnergyMeter(EnergyMeter&&) noexcept;
  EnergyMeter& operator=(EnergyMeter&&) noexcept;

  /// @param held  pixels that pins hold, see Solver::held_pixels: cloth is clamped at the second row of them
  /// @throws Error(invalid_argument) unless there are one position and one velocity for each pixel, and for a held one
  /// that is out of range
  [[nodiscard]] Energy measure(const Vec3& gravity, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                               std::span<const uint32_t> held = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
/// The same for one state. @throws Error as the meter does
[[nodiscard]] Energy measure_energy(const ClothDesc& cloth, const Vec3& gravity, std::span<const Vec3> positions,
                                    std::span<const Vec3> velocities, std::span<const uint32_t> held = {});

/// 64-bit FNV-1a of the bits of the positions of the valid pixels: equal states, equal hashes.
/// @throws Error(invalid_argument) unless there is one position for each pixel
[[nodiscard]] uint64_t hash_state(const ClothAsset& asset, std::span<const Vec3> positions);

}  // namespace geocloth
