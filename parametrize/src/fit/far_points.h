// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "fit/image_surface.h"
#include "mesh/triangle_tree.h"

namespace geocloth {

/// A place of the surface, and the one of the image that stands for it.
struct FarPlace {
  double squared = 0;  ///< [m^2] about the distance between the two surfaces there
  Point3 surface{}, image{};
};

/// A place that may be far from the other surface.
struct Suspect {
  Point3 surface;
  std::optional<Point3> image;  ///< that stands for it
};

/// Places that were found while the image was fitted, and vertices of the surface, unless their cells are near them.
/// @param goal  [m] what is nearer is near enough
[[nodiscard]] std::vector<Suspect> find_suspects(const ImageSurface& image, const std::vector<FarPlace>& far,
                                                 double goal);

/// The same once points have moved, and the places of the image itself that are far: to the comparison along the
/// surface's normals a pixel beside a fold seems near.
[[nodiscard]] std::vector<Suspect> find_suspects_anew(const ImageSurface& image, const TriangleTree& surface,
                                                      const std::vector<FarPlace>& far, double goal);

/// The points beside what is truly farther than the goal, the farthest first, and a few only: what lies beside each
/// other in the plane need not be what is nearest in space.
/// @param image_tree  the image as it is
[[nodiscard]] std::vector<uint32_t> far_points(const ImageSurface& image, const TriangleTree& image_tree,
                                               const TriangleTree& surface, const std::vector<Suspect>& suspects,
                                               double goal);

}  // namespace geocloth
