// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "cpu/seam_stream.h"
#include "cpu/sweep.h"

namespace geocloth::cpu {

/// How a cloth's substep is done by sweeps: the longest runs of passes that can go through the rows together, and what
/// has to stand between them. Made anew when pins, schedule or shares change.
class SweepPlan {
 public:
  using Part = std::variant<Sweep, PassStep>;

  /// @return nothing when the image is too narrow for vectors
  [[nodiscard]] static std::unique_ptr<SweepPlan> make(const ClothState& state, const std::vector<PassStep>& substep,
                                                       const ClothFrame& cloth, const std::vector<Run>& runs,
                                                       uint32_t relaxation_steps);

  [[nodiscard]] uint32_t lanes() const { return lanes_; }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  /// Of the pass lines, along rows and along columns; empty without it.
  [[nodiscard]] const LineStream& lines(uint32_t group) const { return lines_[group]; }
  [[nodiscard]] const SeamStream& seams() const { return seams_; }
  /// Blocks of pins, see pin_rows.h; none without pins.
  [[nodiscard]] std::span<const Run> pins() const { return pins_ == nullptr ? std::span<const Run>() : pins_->runs; }
  /// Place of each pin among the anchors; none without attachments.
  [[nodiscard]] const std::vector<uint32_t>& anchor_of_pin() const { return anchor_of_pin_; }
  /// Whether a cloth that the other one was made for may work by this one: they are equal, and nothing is written
  /// there.
  [[nodiscard]] bool can_stand_for(const SweepPlan& other) const;
  [[nodiscard]] size_t memory_bytes() const;
  /// What a substep reads and writes of state and constants when every sweep goes through memory once.
  [[nodiscard]] size_t bytes_per_substep() const;

 private:
  friend class SweepPlanner;
  uint32_t lanes_ = 0;
  std::vector<std::unique_ptr<RowStream>> streams_;
  std::vector<Part> parts_;
  std::array<LineStream, 2> lines_;
  SeamStream seams_;
  const RowStream* pins_ = nullptr;  ///< one of the streams
  std::vector<uint32_t> anchor_of_pin_;
};

/// Runs of valid pixels, row by row: those that have a mass while nothing is pinned.
[[nodiscard]] std::vector<Run> valid_runs(const ClothState& state);

}  // namespace geocloth::cpu
