// SPDX-License-Identifier: Apache-2.0
// Threads of ClothAsset::sewing (shaders/lib/span.h): each as long as its points lie apart at rest, but no shorter than
// a pixel, so that a share of it is something for those that begin together, too.

#include "rest/sewing.h"

#include <algorithm>
#include <vector>

#include "rest/seam_list.h"

namespace geocloth {
namespace {

constexpr uint32_t kMostSewingColors = 32;  ///< and threads to one point: what is gathered there

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
  data.sewing_colors = append_by_color(threads, kMostSewingColors, data);
}

}  // namespace geocloth
