// SPDX-License-Identifier: Apache-2.0
// What collides with what in a cloth: one point for all copies of a pixel, and for each the points that are near along
// the surface at rest, found by a short walk with Dijkstra's order. Those never push each other: a sheet may bend,
// shear and be compressed as if it had no self-collision, and only layers meet.

#include "rest/self_points.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "lib/self_words.h"
#include "rest/surface_graph.h"

namespace geocloth {
namespace {

constexpr float kNearAlong = 1.5F;  ///< of distance or spacing: nearer along the surface nothing collides
constexpr size_t kSelfWordsOfPixel = 1 + shader::kSelfWordsOfPoint + 8;  ///< with at most 8 for buckets

/// Walks along the surface from one pixel after another, as far as `radius`.
class NearbyWalk {
 public:
  NearbyWalk(const ClothAsset& asset, float scale, double radius)
      : graph_(asset, scale, {}, Sewn::yes),
        radius_(radius),
        distance_(asset.pixel_count(), std::numeric_limits<double>::infinity()) {}

  /// Pixels nearer than the radius, itself and copies included.
  const std::vector<uint32_t>& from(uint32_t pixel) {
    for (const uint32_t p : reached_) distance_[p] = std::numeric_limits<double>::infinity();
    reached_.assign(1, pixel);
    distance_[pixel] = 0;
    for (size_t next = 0; next < reached_.size(); ++next) {
      // The nearest that has not been left yet; there are some ten of them.
      const auto nearest = std::min_element(reached_.begin() + static_cast<std::ptrdiff_t>(next), reached_.end(),
                                            [&](uint32_t a, uint32_t b) { return distance_[a] < distance_[b]; });
      std::iter_swap(reached_.begin() + static_cast<std::ptrdiff_t>(next), nearest);
      const uint32_t p = reached_[next];
      graph_.for_neighbors(p, [&](uint32_t q, double step) {
        const double d = distance_[p] + step;
        if (d >= radius_ || d >= distance_[q]) return;
        if (distance_[q] == std::numeric_limits<double>::infinity()) reached_.push_back(q);
        distance_[q] = d;
      });
    }
    return reached_;
  }

 private:
  SurfaceGraph graph_;
  double radius_;
  std::vector<double> distance_;
  std::vector<uint32_t> reached_;
};

/// For each point the points that are near along the surface.
struct NearPoints {
  std::vector<uint32_t> list;  ///< point by point; SelfPoint has the ranges
  size_t most = 0;             ///< entries when cuts have parted all copies: their ways only get longer
};

NearPoints near_points(const ClothAsset& asset, const std::vector<uint32_t>& first, NearbyWalk walk,
                       const std::vector<uint32_t>& point_of, std::vector<shader::SelfPoint>& points) {
  std::vector<uint32_t> copies(asset.pixel_count(), 0);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) ++copies[first[p]];
  NearPoints near;
  for (shader::SelfPoint& point : points) {
    point.skip_begin = static_cast<uint32_t>(near.list.size());
    for (const uint32_t q : walk.from(point.pixel)) {
      if (first[q] != q) continue;
      near.most += size_t{copies[point.pixel]} * copies[q];
      if (q != point.pixel) near.list.push_back(point_of[q]);
    }
    point.skip_end = static_cast<uint32_t>(near.list.size());
    std::sort(near.list.begin() + point.skip_begin, near.list.end());
  }
  return near;
}

shader::SelfRoom room_of(const ClothAsset& asset, const SelfNumbers& numbers) {
  shader::ClothParams params{};
  params.width = asset.width;
  params.height = asset.height;
  set_self_numbers(numbers, params);
  return shader::self_room(params);
}

}  // namespace

std::vector<float> whole_inverse_masses(std::span<const float> inverse_mass, std::span<const uint32_t> first) {
  std::vector<double> mass(inverse_mass.size(), 0);
  for (size_t p = 0; p < inverse_mass.size(); ++p)
    if (inverse_mass[p] > 0) mass[first[p]] += 1 / static_cast<double>(inverse_mass[p]);
  std::vector<float> inverse(inverse_mass.size(), 0);
  for (size_t p = 0; p < inverse_mass.size(); ++p)
    if (mass[p] > 0) inverse[p] = static_cast<float>(1 / mass[p]);
  return inverse;
}

std::vector<uint32_t> first_self_words(const shader::SelfRoom& room) {
  constexpr float kNowhere = std::numeric_limits<float>::max();
  std::vector<uint32_t> words(shader::self_skip_word(room), 0);
  std::ranges::copy(first_header(0), words.begin());
  std::fill_n(words.begin() + shader::self_seen_word(room, 0), size_t{3} * room.points,
              shader::floatBitsToUint(kNowhere));
  return words;
}

void set_self_numbers(const SelfNumbers& numbers, shader::ClothParams& params) {
  params.self_points = numbers.points;
  params.self_buckets = numbers.buckets;
  params.self_distance = numbers.distance;
  params.self_reach = numbers.reach;
  params.self_most_in_bucket = numbers.most_in_bucket;
}

std::array<uint32_t, shader::kSelfHeader> first_header(uint32_t age) {
  std::array<uint32_t, shader::kSelfHeader> header{};
  std::fill_n(header.begin() + shader::kSelfLow, 3, shader::kSelfNone);
  header[shader::kSelfAge] = age;
  return header;
}

FoundWords found_words(const SelfNumbers& numbers, size_t pixels) {
  shader::ClothParams params{};
  set_self_numbers(numbers, params);
  shader::SelfRoom room = shader::self_room(params);
  room.first += static_cast<uint32_t>(pixels);
  const size_t first = shader::self_seen_word(room, 0);
  return {first, shader::self_push_word(room, 0) - first};
}

void add_self_points(const ClothDesc& cloth, ClothData& data) {
  const ClothAsset& asset = *cloth.asset;
  const float scale = cloth.transform.scale, spacing = asset.spacing * scale;
  SelfData& self = data.self;
  SelfNumbers& numbers = self.numbers;
  numbers.distance = cloth.self_collision->distance > 0 ? cloth.self_collision->distance : kSelfDistance * spacing;
  numbers.reach = (1 + kSelfMargin) * numbers.distance;

  const std::vector<uint32_t> first = first_copies(asset);
  std::vector<float> inverse_mass;
  for (const shader::vec4& position : data.position) inverse_mass.push_back(position.w);
  inverse_mass = whole_inverse_masses(inverse_mass, first);
  std::vector<uint32_t> point_of(asset.pixel_count(), shader::kSelfNone);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    if (first[p] == p) {
      const Vec3 rest = scale * asset.rest_position[p];
      point_of[p] = static_cast<uint32_t>(self.points.size());
      shader::SelfPoint& point = self.points.emplace_back();
      point.rest = {rest.x, rest.y, rest.z, inverse_mass[p]};
      point.pixel = p;
    }
    point_of[p] = point_of[first[p]];
  }
  const double radius = static_cast<double>(kNearAlong) * std::max(numbers.distance, spacing);
  const NearPoints near = near_points(asset, first, NearbyWalk(asset, scale, radius), point_of, self.points);

  self.most_points = count_valid_pixels(asset);
  if ((kSelfWordsOfPixel * asset.pixel_count()) + near.most > kMostSelfWords) {
    throw Error(ErrorCode::limit, "self_collision: " + std::to_string(self.most_points) +
                                      " points are too many for it; convert with fewer, or set it to false");
  }
  numbers.buckets = std::bit_ceil(std::max(2 * static_cast<uint32_t>(self.most_points), 64U));
  numbers.points = static_cast<uint32_t>(self.most_points);
  self.most_words = shader::self_skip_word(room_of(asset, numbers)) + near.most;
  numbers.points = static_cast<uint32_t>(self.points.size());
  self.words = first_self_words(room_of(asset, numbers));
  std::copy(point_of.begin(), point_of.end(), self.words.begin() + shader::self_point_word(0));
  self.words.insert(self.words.end(), near.list.begin(), near.list.end());
}

}  // namespace geocloth
