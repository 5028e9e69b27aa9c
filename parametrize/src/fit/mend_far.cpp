// SPDX-License-Identifier: GPL-3.0-or-later
// The largest deviation of an image is that of a handful of places: tips and folds narrower than the pixels, which a
// least squares fit under bounds on springs and angles rounds off.
#include "fit/mend_far.h"

#include <array>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>

#include "fit/place_mender.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kGoal = 1.9e-3;  // of the size
/// Around a point that move, per pass: more where fewer did not help, and once others have moved.
constexpr std::array<std::array<int, 2>, 3> kRings{{{2, 3}, {4, 2}, {5, 2}}};

/// The diameter of the smallest sphere around points: never above the diagonal of the box that deviations are relative
/// to, and, unlike it, the same however a garment is turned.
double size_of(const std::vector<Point3>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> around;
  around.reserve(points.size());
  for (const Point3& p : points) around.emplace_back(p[0], p[1], p[2]);
  return 2 * CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>(around.begin(),
                                                                                                  around.end())
                 .radius();
}

}  // namespace

void mend_far_places(const FlatSurface& flat, const Raster& raster, const std::vector<FarPlace>& far,
                     ClothAsset& asset) {
  const double goal = kGoal * size_of(flat.position);
  ImageSurface image(flat, asset);
  std::vector<Suspect> suspects = find_suspects(image, far, goal);
  if (suspects.empty()) return;
  const TriangleTree surface(flat.position, flat.triangle);
  PlaceMender mender(image, raster, surface, goal);
  for (std::size_t pass = 0; pass < kRings.size() && !suspects.empty() && !mender.is_exhausted(); ++pass) {
    if (pass > 0) suspects = find_suspects_anew(image, surface, far, goal);
    mender.begin_pass();
    for (const uint32_t p : far_points(image, mender.image_tree(), surface, suspects, goal)) {
      if (mender.is_exhausted()) break;
      if (mender.is_tried(p)) continue;
      for (const int rings : kRings.at(pass)) {
        if (mender.mend_around(p, rings)) break;
      }
    }
  }
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i) || !mender.is_moved(image.first[i])) continue;
    asset.rest_position[i] = to_single(image.place[image.first[i]]);
  }
}

}  // namespace geocloth
