// SPDX-License-Identifier: Apache-2.0
// Ties on seams (shaders/lib/finish.h). A spring along a seam is there once for each side, and every side pulls its own
// copies. At the corners of charts only one side may have it: the stitch then takes back what the copies without one
// weigh, and a spring between light copies of heavy points hardly moves them (it was left 36 % too long). So where two
// points are joined by a spring, their other copies, as far as both have some, are tied to each other as well; together
// they move the points as one spring between whole points would, or a little less.

#include "rest/seam_ties.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "rest/seam_list.h"

namespace geocloth {
namespace {

constexpr uint32_t kMostTieColors = 4;

/// Springs between copies of the same two points, as pixels (of the first one, of the second one).
using PointPair = std::pair<uint32_t, uint32_t>;
using SpringsOfPoints = std::map<PointPair, std::vector<PointPair>>;

SpringsOfPoints springs_on_seams(const ClothAsset& asset, const std::vector<uint32_t>& point,
                                 const std::map<uint32_t, std::vector<uint32_t>>& copies) {
  SpringsOfPoints springs;
  for_structural_springs(asset, [&](uint32_t a, uint32_t b) {
    if (!copies.contains(point[a]) || !copies.contains(point[b]) || point[a] == point[b]) return;
    if (point[a] > point[b]) std::swap(a, b);
    springs[{point[a], point[b]}].emplace_back(a, b);
  });
  return springs;
}

}  // namespace

void add_seam_ties(const ClothAsset& asset, const RestShape& rest, ClothData& data) {
  const std::vector<uint32_t> point = first_copies(asset);
  std::map<uint32_t, std::vector<uint32_t>> copies;
  for (uint32_t r = 0; r < asset.splits.rows(); ++r) {
    const std::span<const uint32_t> row = asset.splits.copies(r);
    copies[row.front()].assign(row.begin(), row.end());
  }
  std::vector<shader::SeamSpring> ties;
  for (const auto& [points, springs] : springs_on_seams(asset, point, copies)) {
    std::vector<uint32_t> free_a = copies.at(points.first), free_b = copies.at(points.second);
    data.most_seam_springs += springs.size();  // any may be cut, and its copies be tied instead
    for (const auto& [a, b] : springs) {
      std::erase(free_a, a);
      std::erase(free_b, b);
    }
    for (size_t i = 0; i < std::min(free_a.size(), free_b.size()); ++i) {
      shader::SeamSpring tie{};
      tie.a = tie.middle = tie.beside = free_a[i];
      tie.b = free_b[i];
      tie.rest = static_cast<float>(rest.rest_length(tie.a, tie.b));
      if (tie.rest > 0) ties.push_back(tie);
    }
  }
  data.seam_tie_colors = append_by_color(ties, kMostTieColors, data);
}

}  // namespace geocloth
