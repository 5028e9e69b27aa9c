// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "backend.h"
#include "frame_input.h"
#include "geocloth/solver/solver.h"

namespace geocloth {

/// What a Solver is: it checks what the caller says, keeps pins and colliders between frames, and feeds a backend.
class Solver::Impl {
 public:
  using BackendFactory = std::function<std::unique_ptr<SolverBackend>(SimulationData)>;
  Impl(std::span<const ClothDesc> cloths, const SolverSettings& settings, const BackendFactory& make_backend);

  void set_colliders(std::span<const Collider> colliders, bool teleport);
  void set_wind(const Wind& wind);
  void set_gravity(const Vec3& gravity);
  void set_pins(uint32_t cloth, std::span<const Pin> pins);
  void step();

  void read_positions(uint32_t cloth, std::vector<Vec3>& out);
  void read_normals(uint32_t cloth, std::vector<Vec3>& out);
  void read_velocities(uint32_t cloth, std::vector<Vec3>& out);
  void write_state(uint32_t cloth, std::span<const Vec3> positions, std::span<const Vec3> velocities);
  [[nodiscard]] SolverStatistics statistics();

  [[nodiscard]] SolverBackend& backend() { return *backend_; }
  [[nodiscard]] Vec3 origin() const { return origin_; }
  [[nodiscard]] uint32_t cloth_count() const { return static_cast<uint32_t>(cloths_.size()); }

 private:
  struct Cloth {
    std::shared_ptr<const ClothAsset> asset;
    Material material;
    float scale = 1;
    std::vector<float> free_inverse_mass;  ///< without pins
    std::vector<uint32_t> row_of_pixel;    ///< row of the split-vertex table, kNoPixel for a single pixel
    std::map<uint32_t, Vec3> pins;         ///< pixel -> target [m, world], all copies listed
    bool pins_changed = false;             ///< since the last step
    uint64_t particles = 0, springs_per_sweep = 0;
  };

  [[nodiscard]] const Cloth& cloth_at(uint32_t cloth) const;
  [[nodiscard]] ClothFrame cloth_frame(Cloth& cloth) const;
  [[nodiscard]] FrameClock clock() const;

  SolverSettings settings_;
  Vec3 origin_;
  std::vector<Cloth> cloths_;
  std::vector<Collider> colliders_from_, colliders_to_;  ///< at the start and the end of the next frame
  std::optional<Wind> wind_;
  uint64_t frame_ = 0;
  std::unique_ptr<SolverBackend> backend_;
};

}  // namespace geocloth
