// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace geocloth::view {

/// Keeps a simulation in step with the clock. Time that it cannot keep up with is dropped: then it is slower than the
/// clock, and never owes more than a quarter of a second or one frame.
class Pacer {
 public:
  /// @param frame_time  [s] > 0
  explicit Pacer(double frame_time) : frame_time_(frame_time) {}

  /// Real time has passed [s].
  void pass(double seconds);
  /// A frame is due.
  [[nodiscard]] bool due() const;
  /// It was played.
  void played() { owed_ -= frame_time_; }
  /// The picture must be drawn now: what is still due is dropped.
  void drop();

 private:
  double frame_time_;
  double owed_ = 0;  ///< [s]
};

}  // namespace geocloth::view
