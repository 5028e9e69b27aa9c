// SPDX-License-Identifier: Apache-2.0
// What collides with what between cloths: one point for all copies of a pixel, those of all cloths in one list.

#include "rest/inter_points.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "lib/self_words.h"
#include "rest/self_points.h"

namespace geocloth {
namespace {

constexpr float kMostUnlike = 10;  ///< a coarse spacing over a fine one
constexpr float kMostLayers = 20;  ///< in a bucket of the hash

float distance_of(const InterCloth& cloth) {
  return cloth.distance > 0 ? cloth.distance : kSelfDistance * cloth.asset->spacing * cloth.start.scale;
}

SelfNumbers numbers_of(std::span<const InterCloth> cloths) {
  SelfNumbers numbers;
  float finest = std::numeric_limits<float>::max(), coarsest = 0;
  uint32_t fine = 0, coarse = 0;
  for (const InterCloth& cloth : cloths) {
    const float spacing = cloth.asset->spacing * cloth.start.scale;
    if (spacing < finest) fine = cloth.number;
    if (spacing > coarsest) coarse = cloth.number;
    finest = std::min(finest, spacing);
    coarsest = std::max(coarsest, spacing);
    numbers.distance = std::max(numbers.distance, distance_of(cloth));
  }
  if (coarsest > kMostUnlike * finest) {
    throw Error(ErrorCode::invalid_argument, "inter_collision: cloth " + std::to_string(coarse) + " has a spacing of " +
                                                 std::to_string(coarsest) + " m and cloth " + std::to_string(fine) +
                                                 " one of " + std::to_string(finest) +
                                                 " m, less than a tenth; convert them with more and with fewer points");
  }
  numbers.reach = (1 + kSelfMargin) * numbers.distance;
  const float points = numbers.reach / finest;  // along a side of a bucket
  numbers.most_in_bucket =
      std::max(shader::kSelfMostInBucket, static_cast<uint32_t>(std::ceil(kMostLayers * points * points)));
  return numbers;
}

/// Of each cloth: how many times before its own there are at which others came.
std::vector<uint32_t> arrivals_of(std::span<const InterCloth> cloths) {
  std::vector<double> times(cloths.size());
  std::ranges::transform(cloths, times.begin(), &InterCloth::arrived);
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<uint32_t> arrivals;
  arrivals.reserve(cloths.size());
  for (const InterCloth& cloth : cloths)
    arrivals.push_back(static_cast<uint32_t>(std::ranges::lower_bound(times, cloth.arrived) - times.begin()));
  return arrivals;
}

void set_points(SelfNumbers& numbers, size_t points) {
  numbers.points = static_cast<uint32_t>(points);
  numbers.buckets = std::bit_ceil(std::max(2 * numbers.points, 64U));
}

shader::SelfRoom room_of(const SelfNumbers& numbers) {
  shader::ClothParams params{};
  set_self_numbers(numbers, params);
  return shader::self_room(params);
}

}  // namespace

InterData make_inter_data(std::span<const InterCloth> cloths, const Vec3& origin) {
  InterData inter;
  SelfData& all = inter.points;
  all.numbers = numbers_of(cloths);
  const std::vector<uint32_t> arrivals = arrivals_of(cloths);
  std::vector<uint32_t> pixels;  // with their points
  for (const InterCloth& cloth : cloths) {
    const ClothAsset& asset = *cloth.asset;
    const std::vector<uint32_t> first = first_copies(asset);
    const std::vector<float> inverse_mass = whole_inverse_masses(cloth.inverse_mass, first);
    InterPart part{.cloth = cloth.cloth,
                   .first_point = static_cast<uint32_t>(all.points.size()),
                   .first_pixel = static_cast<uint32_t>(pixels.size() / shader::kInterPixelWords)};
    std::vector<uint32_t> point_of(asset.pixel_count(), shader::kSelfNone);
    for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
      if (!asset.valid(p)) continue;
      if (first[p] == p) {
        const Vec3 start = apply(cloth.start, asset.rest_position[p]) - origin;
        point_of[p] = static_cast<uint32_t>(all.points.size());
        shader::SelfPoint& point = all.points.emplace_back();
        point.rest = {start.x, start.y, start.z, inverse_mass[p]};
        point.pixel = p;
        point.inter_cloth = static_cast<uint32_t>(inter.parts.size());
        point.inter_distance = shader::floatBitsToUint(distance_of(cloth));
        point.inter_friction = shader::floatBitsToUint(cloth.friction);
        point.inter_arrival = arrivals[inter.parts.size()];
      }
      point_of[p] = point_of[first[p]];
      pixels.insert(pixels.end(), {p, point_of[p]});
    }
    part.points = static_cast<uint32_t>(all.points.size()) - part.first_point;
    part.pixels = static_cast<uint32_t>(pixels.size() / shader::kInterPixelWords) - part.first_pixel;
    inter.parts.push_back(part);
  }
  all.most_points = pixels.size() / shader::kInterPixelWords;  // cuts part copies
  set_points(all.numbers, all.most_points);
  const auto words_for = [&] { return size_t{shader::inter_pixel_word(room_of(all.numbers), 0)} + pixels.size(); };
  constexpr size_t kWordsOfPoint = shader::kSelfWordsOfPoint + shader::kInterStateWords + shader::kInterPixelWords + 8;
  if (kWordsOfPoint * all.most_points > kMostSelfWords) {
    throw Error(ErrorCode::limit, "inter_collision: " + std::to_string(all.most_points) +
                                      " points are too many for it; convert with fewer, or leave it out");
  }
  all.most_words = words_for();
  set_points(all.numbers, all.points.size());
  all.words = first_self_words(room_of(all.numbers));
  all.words.resize(words_for() - pixels.size(), 0);
  all.words.insert(all.words.end(), pixels.begin(), pixels.end());
  return inter;
}

}  // namespace geocloth
