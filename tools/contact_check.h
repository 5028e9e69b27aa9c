// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "export/frame_writer.h"
#include "geocloth/solver/scene.h"

namespace geocloth {

/// What a user sees go wrong where cloth meets colliders, and which no error stops: a garment that begins inside its
/// wearer, and a wearer that shows through the garment between its points, or went through it.
class ContactCheck {
 public:
  /// Looks at where the cloths are before the first frame; reads them back.
  explicit ContactCheck(Simulation& simulation);
  /// Looks at some of the frames where there are many triangles, and at the last one.
  /// @param cloths  the state after a frame
  void add_frame(const Simulation& simulation, std::span<const ClothSnapshot> cloths);

  /// [m] Deepest point so far of a drawn triangle in a collider that holds none of its corners.
  [[nodiscard]] float depth_between_vertices() const;
  /// In plain words, with a remedy.
  [[nodiscard]] std::vector<std::string> warnings(const Simulation& simulation) const;

 private:
  /// Of a cloth in one collider.
  struct Start {
    size_t cloth = 0, collider = 0, points = 0, points_of_cloth = 0;
    float depth = 0;  // [m]
    bool is_buried = false;
  };
  struct Between {
    size_t collider = 0;
    float depth = 0;    // [m]
    float stretch = 0;  // of the grid, the most where a collider shows through it
  };

  std::vector<Start> start_;
  std::vector<Between> between_;  // per cloth: the deepest
};

}  // namespace geocloth
