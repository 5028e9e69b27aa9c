// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contact_check.h"
#include "export/frame_writer.h"
#include "geocloth/solver/scene.h"

namespace geocloth {

/// Number of valid pixels whose position is not finite.
[[nodiscard]] uint64_t count_non_finite(const ClothAsset& asset, std::span<const Vec3> positions);

/// Collects what `simulate` reports while it runs.
class SimulationRecorder {
 public:
  /// Adds the time of the step that was done last, without that of the checks which a report asks for: a run without a
  /// report does not spend it.
  /// @param seconds  wall time, the device's work included
  void add_frame_time(Simulation& simulation, double seconds);
  /// Reads positions and velocities back and adds the energy of all cloths at this frame.
  void add_energy(Simulation& simulation);

  /// Adds what cloth did to colliders in this frame, where the scene asks for that.
  void add_contact_forces(Simulation& simulation);

  /// The report as JSON text with the keys that users rely on.
  /// @param cloths    the state after the last frame
  /// @param contact   of all frames
  /// @param warnings  everything that was warned of
  [[nodiscard]] std::string report(Simulation& simulation, std::span<const ClothSnapshot> cloths,
                                   const ContactCheck& contact, std::span<const std::string> warnings) const;
  /// One line for people.
  [[nodiscard]] std::string summary(Simulation& simulation) const;

 private:
  /// Of a cloth as it is cut now, and made of.
  struct CutMeter {
    std::shared_ptr<const ClothAsset> asset;
    Material material;
    std::vector<Fabric> fabrics;
    std::optional<EnergyMeter> meter;
  };

  std::vector<double> frame_seconds_;
  double check_seconds_ = 0;  ///< of all frames so far
  std::vector<CutMeter> meters_;
  std::vector<Energy> energy_;
  std::deque<std::vector<ContactForce>> contact_forces_;  ///< of each collider, in the frames of the last second
};

}  // namespace geocloth
