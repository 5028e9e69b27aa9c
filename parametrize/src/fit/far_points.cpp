// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/far_points.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geocloth/asset/grid_mesh.h"
#include "mesh/nearest_weights.h"

namespace geocloth {
namespace {

constexpr double kSameFar = 1e-3;    // of the goal: on a garment's two sides only rounding differs
constexpr double kFewPoints = 3e-3;  // share of the points around which is mended
constexpr std::size_t kFewPlaces = 50;

}  // namespace

std::vector<Suspect> find_suspects(const ImageSurface& image, const std::vector<FarPlace>& far, double goal) {
  std::vector<Suspect> suspects;
  for (const FarPlace& place : far) {
    if (place.squared > goal * goal) suspects.push_back({place.surface, place.image});
  }
  image.for_each_vertex([&](uint32_t cell, const Point3& p) {
    bool is_near = false;
    for (const Triangle& t : cell_triangles(image.asset, cell)) {
      const std::array<Point3, 3> corner{image.place[image.first[t[0]]], image.place[image.first[t[1]]],
                                         image.place[image.first[t[2]]]};
      is_near = is_near || distance(at(corner, nearest_weights(corner[0], corner[1], corner[2], p)), p) <= goal;
    }
    if (!is_near) suspects.push_back({p, std::nullopt});
  });
  return suspects;
}

std::vector<Suspect> find_suspects_anew(const ImageSurface& image, const TriangleTree& surface,
                                        const std::vector<FarPlace>& far, double goal) {
  std::vector<Suspect> suspects = find_suspects(image, far, goal);
  for (Suspect& s : suspects) s.image.reset();  // it was that of the pixels as they were
  std::vector<Point3> place;
  for (uint32_t i = 0; i < image.asset.pixel_count(); ++i) {
    if (image.asset.valid(i) && image.first[i] == i) place.push_back(image.place[i]);
  }
  for (uint32_t t = 0; t < image.points.size(); ++t) place.push_back(at(image.corners(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}));
  std::vector<Point3> near(place.size());
  constexpr std::size_t kBatch = 256;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, place.size(), kBatch), [&](const auto& range) {
    std::optional<TriangleTree::Place> found;
    for (std::size_t k = range.begin(); k != range.end(); ++k) {
      found = surface.nearest(place[k], found);
      near[k] = found->point;
    }
  });
  for (std::size_t k = 0; k < place.size(); ++k) {
    if (distance(near[k], place[k]) > goal) suspects.push_back({near[k], place[k]});
  }
  return suspects;
}

std::vector<uint32_t> far_points(const ImageSurface& image, const TriangleTree& image_tree, const TriangleTree& surface,
                                 const std::vector<Suspect>& suspects, double goal) {
  std::vector<double> farthest(image.asset.pixel_count(), 0);
  const auto note = [&](const Point3& place, const TriangleTree::Place& in_image, double d) {
    const Triangle& t = image.points[in_image.triangle];
    const uint32_t point = *std::min_element(t.begin(), t.end(), [&](uint32_t a, uint32_t b) {
      return distance(image.place[a], place) < distance(image.place[b], place);
    });
    farthest[point] = std::max(farthest[point], d);
  };
  for (const Suspect& s : suspects) {
    const TriangleTree::Place found = image_tree.nearest(s.surface);
    note(s.surface, found, distance(found.point, s.surface));
    if (!s.image) continue;
    const double away = distance(surface.nearest(*s.image).point, *s.image);
    if (away > goal) note(*s.image, image_tree.nearest(*s.image), away);
  }
  std::vector<uint32_t> points;
  for (uint32_t p = 0; p < farthest.size(); ++p) {
    if (farthest[p] > goal) points.push_back(p);
  }
  const auto level = [&](uint32_t p) { return std::round(farthest[p] / (kSameFar * goal)); };
  std::stable_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) { return level(a) > level(b); });
  const auto few = static_cast<std::size_t>(std::ceil(kFewPoints * count_valid_pixels(image.asset)));
  points.resize(std::min({points.size(), few, kFewPlaces}));
  return points;
}

}  // namespace geocloth
