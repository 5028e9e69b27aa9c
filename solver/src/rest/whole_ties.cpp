// SPDX-License-Identifier: Apache-2.0
// Which springs are tied by their whole points (shaders/lib/span.h): all at seams. What a tie moves of one copy of a
// seam's point, the stitch takes back for the most part, so that what hangs below a seam goes over it by half in each
// round, and springs beside it stay too long: in the end by 14 % in a dress, a short one by 61 % in a hat that falls.
// About short seams (short_seams.h), where a few springs carry all that hangs below, all springs are such ties, several
// times: one round evens out what is too long among neighbours, and there it has to go further.

#include "rest/whole_ties.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "rest/seam_list.h"
#include "rest/short_seams.h"

namespace geocloth {
namespace {

constexpr uint32_t kMostWholeTieColors = 12;
constexpr uint32_t kMoreRounds = 2;  ///< of ties about short seams

static_assert(shader::kNoRow == kNoPixel);  // split_rows() names what the shaders look for

}  // namespace

void add_whole_ties(const ClothAsset& asset, const RestShape& rest, const std::vector<bool>& short_seams,
                    ClothData& data) {
  const std::vector<uint32_t> point = first_copies(asset), row = split_rows(asset);
  const std::vector<bool> near = points_near_short_seams(asset, short_seams);
  std::map<std::pair<uint32_t, uint32_t>, shader::SeamSpring> ties;  // the sides of a seam may have the same spring
  for_structural_springs(asset, [&](uint32_t from, uint32_t to) {
    const auto [a, b] = std::minmax(point[from], point[to]);
    if (a == b) return;
    const bool at_seam = row[a] != shader::kNoRow || row[b] != shader::kNoRow;
    if (!at_seam && !near[a] && !near[b]) return;
    shader::SeamSpring tie{};
    tie.a = tie.middle = tie.beside = a;
    tie.b = b;
    tie.row_a = row[a];
    tie.row_b = row[b];
    tie.rest = static_cast<float>(rest.rest_length(a, b));
    if (tie.rest > 0) ties.try_emplace({a, b}, tie);
  });
  std::vector<shader::SeamSpring> list;
  list.reserve(ties.size());
  std::vector<shader::SeamSpring> again;
  for (const auto& [points, tie] : ties) {
    list.push_back(tie);
    if (near[points.first] || near[points.second]) again.push_back(tie);
  }
  data.whole_tie_colors = append_by_color(list, kMostWholeTieColors, data);
  for (uint32_t i = 0; i < kMoreRounds; ++i) data.whole_tie_colors += append_by_color(again, kMostWholeTieColors, data);
}

}  // namespace geocloth
