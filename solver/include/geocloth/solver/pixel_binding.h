// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

struct RestPlace;

/// Where the pixels of a cloth are by the points of a surface that is the same garment: the vertices of its mesh (the
/// other way round than evaluate_binding()), as it was modelled or animated; or the pixels of another asset of that
/// mesh, of another resolution or layout, to which a garment changes while it moves:
///
///     const PixelBinding to_coarse(*coarse, *fine);          // once
///     to_coarse.evaluate(fine_positions, coarse_positions);  // and the velocities with evaluate_rates()
///     solver.write_state(coarse_cloth, coarse_positions, coarse_velocities);
///
/// Every pixel goes along with the triangle that it is nearest to at rest, of its own part of the garment, and keeps
/// its place beside it, as that triangle sees it. Copies of a point get the same place.
class PixelBinding {
 public:
  /// By the vertices of its `source` (render vertices).
  explicit PixelBinding(const ClothAsset& asset);
  /// By the pixels of another asset. Both as they were loaded: Solver::asset() of cloth that has been cut lacks
  /// triangles. @throws Error(invalid_argument) when the other was converted from another mesh, or only one is cut
  PixelBinding(const ClothAsset& asset, const ClothAsset& from);

  /// @param points  [m] one per vertex, or per pixel of the other asset
  /// @param out     [m] resized to one per pixel, zero where not valid
  /// @param scale   of the garment in its scene: what lies beside the triangles grows with it
  /// @throws Error(invalid_argument) for another number of points
  void evaluate(std::span<const Vec3> points, std::vector<Vec3>& out, float scale = 1) const;
  /// The same of velocities, which what lies beside the triangles is not turned by.
  void evaluate_rates(std::span<const Vec3> rates, std::vector<Vec3>& out) const;

 private:
  struct Place {
    uint32_t pixel = 0;
    Triangle triangle{};
    Vec3 corner_share, off;  ///< of a triangle's corners; [m] at rest, see PlaceBeside
  };
  [[nodiscard]] static Place place_at(uint32_t pixel, const RestPlace& place);
  void check_count(size_t points) const;

  uint32_t pixels_;
  size_t points_;
  std::vector<Place> places_;  ///< of valid pixels
};

}  // namespace geocloth
