// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/seam_steps.h"

#include <algorithm>
#include <utility>

namespace geocloth {

std::vector<uint32_t> least_seam_steps(const CutSurface& cut, std::span<const Outline> outlines,
                                       std::span<const uint32_t> natural) {
  std::vector<uint32_t> least;
  std::vector<std::pair<std::pair<uint32_t, uint32_t>, uint32_t>> ends;  // both end points of a seam, the seam
  for (const Outline& outline : outlines) {
    for (size_t i = 0; i < outline.path.size(); ++i) {
      const OutlinePath& path = outline.path[i];
      const OutlinePath& next = outline.path[(i + 1) % outline.path.size()];
      if (path.seam >= least.size()) least.resize(path.seam + 1, 1);
      const auto [low, high] = std::minmax(cut.point[path.vertex.front()], cut.point[path.vertex.back()]);
      ends.push_back({{low, high}, path.seam});
      const bool folded = path.seam == next.seam && path.reversed != next.reversed;
      if (folded) least[path.seam] = std::max(least[path.seam], 2U);
      if (low == high) least[path.seam] = 3;
    }
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const auto length = [&](size_t i) { return natural.empty() ? 0 : natural[ends[i].second]; };
  for (size_t i = 0, end = 0; i < ends.size(); i = end) {
    size_t shortest = i;
    for (end = i; end < ends.size() && ends[end].first == ends[i].first; ++end) {
      if (length(end) < length(shortest)) shortest = end;
    }
    for (size_t k = i; k < end && end - i > 1; ++k) {
      if (natural.empty() || k != shortest) least[ends[k].second] = std::max(least[ends[k].second], 2U);
    }
  }
  return least;
}

}  // namespace geocloth
