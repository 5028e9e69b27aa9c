// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fit/image_surface.h"
#include "geocloth/parametrize/rasterize.h"
#include "image/chart_sampling.h"
#include "mesh/triangle_tree.h"
#include "mesh/users.h"

namespace geocloth {

/// Around a triangle.
struct Ball {
  Point3 middle;
  double radius;
};

/// Moves the few points around a place of an image so that it comes as near to the surface as the goal. Around the
/// place both surfaces are sampled, and every sample farther from the other surface than the goal pulls the points of
/// its triangle, as constraints are projected in position based dynamics (Mueller et al. 2007); springs are kept
/// between limits in the same way. The best state that was met is taken, measured in both directions over more than
/// what moved, so that the largest deviation does not grow.
class PlaceMender {
 public:
  /// @param surface  of the garment
  /// @param goal  [m]
  PlaceMender(ImageSurface& image, const Raster& raster, const TriangleTree& surface, double goal);

  /// Looks at the image as it is now: every point may be tried once more.
  void begin_pass();
  /// @param rings  of points that move around the place
  /// @returns whether the goal is reached
  bool mend_around(uint32_t point, int rings);

  [[nodiscard]] const TriangleTree& image_tree() const { return *image_tree_; }
  [[nodiscard]] bool is_tried(uint32_t point) const { return is_tried_[point] != 0; }  ///< in this pass
  [[nodiscard]] bool is_moved(uint32_t point) const { return is_moved_[point] != 0; }  ///< ever
  /// Where much is far, mending a part of it is of little use.
  [[nodiscard]] bool is_exhausted() const { return iterations_left_ <= 0 || searches_left_ <= 0; }

 private:
  /// A place of the image that is too far from the surface, or too far from a place of the surface.
  struct Miss {
    Triangle point;
    Point3 weight;
    Point3 way;  ///< [m] that it has to go
  };

  /// @returns false where hundreds of sheets hang on one seam: each round would look at each of them from each
  bool gather(uint32_t middle, int rings);
  const PlaneLocator& locator(uint32_t chart);
  void sample_surface();
  double find_misses(std::vector<Miss>& misses);
  void pull(const std::vector<Miss>& misses, double step);
  void limit_lengths();
  [[nodiscard]] std::vector<double> lengths() const;
  [[nodiscard]] std::vector<Point3> normals() const;
  [[nodiscard]] bool is_sound(const std::vector<Point3>& normal_before, const std::vector<double>& length_before) const;
  [[nodiscard]] std::vector<Point3> moving_places() const;
  void put(const std::vector<Point3>& places);

  ImageSurface& image_;
  const Raster& raster_;
  const TriangleTree& surface_;
  double goal_;
  int iterations_left_, searches_left_;
  std::optional<TriangleTree> image_tree_;  // the image as it was when the pass began
  std::vector<uint8_t> is_hem_;
  std::vector<std::array<uint32_t, 2>> spring_;
  Users triangles_of_, springs_of_;
  std::vector<std::vector<uint32_t>> triangles_in_;     // charts
  std::vector<std::unique_ptr<PlaneLocator>> locator_;  // per chart
  std::vector<uint8_t> is_tried_, is_moved_;            // per point
  std::vector<uint32_t> region_, moving_;               // triangles and points around the place
  std::vector<Ball> ball_;                              // around the region's triangles
  std::vector<Point3> sample_;
  std::vector<uint32_t> near_sample_;               // per sample a triangle of the image near it
  std::vector<std::optional<Point3>> near_place_;   // per place of the region's triangles one of the surface near it
  std::vector<Point3> middle_, place_in_triangle_;  // weights
};

}  // namespace geocloth
