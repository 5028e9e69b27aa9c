// SPDX-License-Identifier: Apache-2.0
// Threads of ClothAsset::sewing (shaders/lib/span.h): each as long as its points lie apart at rest, but no shorter than
// a pixel, so that a share of it is something for those that begin together, too.

#include "rest/sewing.h"

#include <algorithm>
#include <string>
#include <vector>

#include "geocloth/asset/error.h"
#include "rest/seam_list.h"

namespace geocloth {
namespace {

/// Threads to one point follow each other: these are more than edges of a pattern lead to a vertex.
constexpr uint32_t kMostSewingColors = 1024;
/// Of threads to points that have several, as where four panels meet: what one of them closes the next one opens. The
/// widest gap of a dress is 6.7 mm without, 2.0 with one round more, 0.2 with four (16,000 points, 16 substeps).
constexpr uint32_t kRoundsWhereSeamsMeet = 4;

bool has_several(const std::vector<uint32_t>& threads_of, const shader::SeamSpring& thread) {
  return threads_of[thread.a] > 1 || threads_of[thread.b] > 1;
}

}  // namespace

float sewing_thread(const ClothAsset& asset, float scale, uint32_t a, uint32_t b) {
  return scale * std::max(length(asset.rest_position[b] - asset.rest_position[a]), asset.spacing);
}

void add_sewing(const ClothAsset& asset, float scale, ClothData& data) {
  std::vector<shader::SeamSpring> threads;
  threads.reserve(asset.sewing.size());
  for (const auto& [a, b] : asset.sewing) {
    shader::SeamSpring thread{};
    thread.a = thread.middle = thread.beside = a;
    thread.b = b;
    thread.rest = sewing_thread(asset, scale, a, b);
    threads.push_back(thread);
  }
  const size_t others = data.seam_springs.size();
  data.sewing_colors = append_by_color(threads, kMostSewingColors, data);
  if (data.seam_springs.size() - others < threads.size())
    throw Error(ErrorCode::limit, "sewing: so many pixels are sewn to one that they take more than " +
                                      std::to_string(kMostSewingColors) +
                                      " turns; gather fewer edges in one vertex of the pattern");
  std::vector<uint32_t> threads_of(asset.pixel_count(), 0);
  for (const shader::SeamSpring& thread : threads)
    for (const uint32_t pixel : {thread.a, thread.b}) ++threads_of[pixel];
  std::erase_if(threads, [&](const shader::SeamSpring& thread) { return !has_several(threads_of, thread); });
  for (uint32_t i = 0; i < kRoundsWhereSeamsMeet; ++i)
    data.more_sewing_colors += append_by_color(threads, kMostSewingColors, data);
}

}  // namespace geocloth
