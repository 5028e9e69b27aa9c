// SPDX-License-Identifier: Apache-2.0

#include "rest/seam_list.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

namespace geocloth {

uint32_t append_by_color(std::span<const shader::SeamSpring> entries, uint32_t most_colors, ClothData& data) {
  data.most_seam_springs += entries.size();
  std::unordered_map<uint32_t, std::vector<uint32_t>> colors_at;  // of few pixels: seams are lines
  colors_at.reserve(2 * entries.size());
  std::vector<std::vector<shader::SeamSpring>> by_color;
  std::vector<size_t> met;  // per colour: the last entry that met it at one of its pixels, counted from 1
  for (size_t i = 0; i < entries.size(); ++i) {
    const shader::SeamSpring& entry = entries[i];
    const std::array pixels{entry.a, entry.middle, entry.b, entry.beside};
    for (const uint32_t p : pixels)
      for (const uint32_t color : colors_at[p]) met[color] = i + 1;
    const auto color = static_cast<uint32_t>(
        std::find_if(met.begin(), met.end(), [&](size_t last) { return last != i + 1; }) - met.begin());
    if (color >= most_colors) continue;
    for (const uint32_t p : pixels) colors_at[p].push_back(color);  // some stand there twice
    if (color == by_color.size()) {
      by_color.emplace_back();
      met.push_back(0);
    }
    by_color[color].push_back(entry);
  }
  if (!by_color.empty() && data.seam_color_offset.empty()) data.seam_color_offset.push_back(0);
  for (const auto& list : by_color) {
    data.seam_springs.insert(data.seam_springs.end(), list.begin(), list.end());
    data.seam_color_offset.push_back(static_cast<uint32_t>(data.seam_springs.size()));
  }
  return static_cast<uint32_t>(by_color.size());
}

}  // namespace geocloth
