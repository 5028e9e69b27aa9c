// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Which points (first copies) lie on the border of the welded grid.
[[nodiscard]] std::vector<uint8_t> points_on_border(const ClothAsset& asset, std::span<const uint32_t> first);

/// A wish for the moves m of three points: weight * (slope[0] m0 + slope[1] m1 - (slope[0] + slope[1]) m2 - wanted)^2
/// is to be small.
struct MoveWish {
  std::array<uint32_t, 3> point;
  std::array<Vec3, 2> slope;  ///< per metre of move
  float weight;               ///< [pixels^2]
  float wanted;               ///< [m]
};

/// What is to hold of the springs of an image while its pixels move: lengths stay about as even as they are, and become
/// more even where they are too uneven; angles between springs that meet become straighter. The few worst of either are
/// only kept from becoming worse. All points are first copies.
class GridHolds {
 public:
  /// @param place  of every point
  /// @param is_hem  which points lie on a free border: angles there are not straightened for nothing
  GridHolds(const ClothAsset& asset, std::span<const Point3> place, std::span<const uint32_t> first,
            std::vector<uint8_t> is_hem);

  /// Springs and angles at the few points with the largest values are not held until this is called again.
  void release(std::span<const double> value);
  /// Starts a round of moves: every angle may as well be a little straighter.
  [[nodiscard]] std::vector<MoveWish> gentle_wishes(std::span<const Point3> place);
  /// Adds what these moves would break, if it is not among the wishes of this round yet. @returns how much that is
  size_t add_broken(std::span<const Point3> place, std::span<const Point3> move, std::vector<MoveWish>& wishes);

 private:
  struct Spring {
    uint32_t a, b;
    float least, most;  ///< [m]
    bool wished;
  };
  struct Meeting {
    uint32_t middle, beside, below;
    float most;  ///< cosine
    bool is_first, wished;
  };

  void find_springs(const ClothAsset& asset, std::span<const uint32_t> first);
  void bound_lengths(std::span<const Point3> place);
  void bound_angles(std::span<const Point3> place);
  [[nodiscard]] bool on_hem(const Meeting& m) const;

  double spacing_;
  std::vector<Spring> spring_;
  std::vector<Meeting> meeting_;
  std::vector<uint8_t> is_hem_, is_released_;
};

}  // namespace geocloth
