// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// The state of one cloth at one frame, read back once for all writers that need it.
struct ClothSnapshot {
  std::shared_ptr<const ClothAsset> asset;  ///< as cuts have left it; null: as it was in the first frame
  std::vector<Vec3> position;               ///< [m] one per pixel
  std::vector<Vec3> normal;                 ///< one per pixel
  std::vector<Vec3> source_position;        ///< [m] one per render vertex of the source mesh (evaluate_binding)
};

/// One output of a simulation, fed frame by frame. Nothing stands under a final name before commit(); a writer that is
/// destroyed without commit() leaves nothing behind.
class FrameWriter {
 public:
  FrameWriter() = default;
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;
  virtual ~FrameWriter() = default;

  /// True when add_frame wants the positions on the host; a writer that draws from the device says false.
  [[nodiscard]] virtual bool needs_cloth_snapshots() const { return true; }
  /// Called for frame 0 (the state before the first step) and after every step.
  /// @param cloths  one per cloth of the simulation; empty when no writer asked for them
  virtual void add_frame(Simulation& simulation, std::span<const ClothSnapshot> cloths) = 0;
  /// Completes the temporary files. @throws Error(io)
  virtual void finish() = 0;
  /// Gives them their final names; after finish().
  virtual void commit() = 0;
};

}  // namespace geocloth
