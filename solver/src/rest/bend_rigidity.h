// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "rest/bend_directions.h"
#include "rest/fabrics.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// The rigidity of the bend at each pixel in each direction, for the pixel's own area. Warp and weft by themselves, or
/// with a bend_bias all four directions; and what neighbours at a slanted outline cannot bear themselves.
class BendRigidity {
 public:
  /// Of what cloth that is bent to a cylinder stores, along a unit vector: what share the bend of a pixel in a
  /// direction sees.
  using ShareSeen = std::function<double(uint32_t pixel, uint32_t direction, const Vec3& along)>;

  /// Keeps the references, but not the function.
  BendRigidity(const ClothAsset& asset, const FabricMap& fabrics, const RestShape& rest, const ShareSeen& share_seen);

  /// [N m] Only where there is such a bend.
  [[nodiscard]] double at(uint32_t p, uint32_t direction) const { return rigidity_[p][direction]; }

 private:
  using Rigidities = std::array<double, kBendDirections>;
  /// A slanted outline at one of its pixels.
  struct SlantedEdge {
    Vec3 along;             ///< unit vector
    uint32_t inside = 0;    ///< pixel whose grid is taken for that of the cloth here: at the outline it is bent to it
    Rigidities rigidity{};  ///< [N m]
    double along_rigidity = 0;  ///< [N m] of the cloth against bending of the edge
  };

  [[nodiscard]] bool whole(uint32_t p) const;
  [[nodiscard]] bool is_slanted(uint32_t p) const;
  [[nodiscard]] bool is_passed(uint32_t p, uint32_t direction) const;
  [[nodiscard]] Rigidities own(uint32_t p) const;
  [[nodiscard]] GridDirections grid_at(uint32_t p) const;
  [[nodiscard]] Vec3 line_at(uint32_t p, uint32_t direction) const;
  [[nodiscard]] std::optional<SlantedEdge> edge_at(uint32_t p) const;
  [[nodiscard]] bool carries(uint32_t p, uint32_t direction) const;
  [[nodiscard]] std::vector<uint32_t> takers(uint32_t p, uint32_t direction) const;
  void give(uint32_t p, const ShareSeen& share_seen);

  const ClothAsset& asset_;
  const FabricMap& fabrics_;
  const RestShape& rest_;
  std::vector<uint8_t> slanted_;      ///< pixels whose rigidity is all given, to themselves or to others
  std::vector<Rigidities> rigidity_;  ///< [N m], and times the area [m^2] what a pixel is given, until all is
};

}  // namespace geocloth
