// SPDX-License-Identifier: Apache-2.0
// Which collider is which when lists change. Colliders of one name keep their order; where their number changes, those
// that stay are the longest common subsequence by equal shapes, of several as long the one that goes on most
// as in the last frame: bullets in a row are where their neighbours were.

#include "colliders/match.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "frame_input.h"

namespace geocloth {
namespace {

using Matches = std::vector<std::optional<uint32_t>>;

/// The colliders of one name.
struct Namesakes {
  std::vector<uint32_t> before, now;
};

/// Of a way to match: more pairs are better, then less distance.
struct Score {
  uint32_t pairs = 0;
  double off2 = 0;  ///< [m^2] sum over the pairs, squared distances from where they were expected
  bool operator>(const Score& b) const { return pairs != b.pairs ? pairs > b.pairs : off2 < b.off2; }
};

double squared(const Vec3& v) {
  return static_cast<double>(v.x) * v.x + static_cast<double>(v.y) * v.y + static_cast<double>(v.z) * v.z;
}

void match_in_order(std::span<const Collider> before, std::span<const Vec3> expected, std::span<const Collider> now,
                    const Namesakes& names, Matches& matches) {
  enum class Step : uint8_t { pair, drop, add };
  const size_t rows = names.before.size(), columns = names.now.size();
  std::vector<Step> steps(rows * columns);
  std::vector<Score> above(columns + 1), here(columns + 1);  // of the first colliders of either list
  std::vector<Vec3> places;
  for (const uint32_t k : names.now) places.push_back(collider_frame(now[k]).translate);
  for (size_t i = 0; i < rows; ++i) {
    const uint32_t a = names.before[i];
    for (size_t k = 0; k < columns; ++k) {
      Step step = here[k] > above[k + 1] ? Step::add : Step::drop;
      Score best = step == Step::add ? here[k] : above[k + 1];
      if (before[a].shape == now[names.now[k]].shape) {
        const Score pair{above[k].pairs + 1, above[k].off2 + squared(places[k] - expected[a])};
        if (!(best > pair)) {
          best = pair;
          step = Step::pair;
        }
      }
      here[k + 1] = best;
      steps[i * columns + k] = step;
    }
    std::swap(above, here);
  }
  for (size_t i = rows, k = columns; i > 0 && k > 0;) {
    const Step step = steps[(i - 1) * columns + k - 1];
    if (step == Step::pair) matches[names.now[k - 1]] = names.before[i - 1];
    if (step != Step::add) --i;
    if (step != Step::drop) --k;
  }
}

}  // namespace

std::vector<std::optional<uint32_t>> match_colliders(std::span<const Collider> before, std::span<const Vec3> expected,
                                                     std::span<const Collider> now) {
  Matches matches(now.size());
  std::map<std::string_view, Namesakes> names;
  for (uint32_t i = 0; i < before.size(); ++i) names[before[i].name].before.push_back(i);
  for (uint32_t i = 0; i < now.size(); ++i) names[now[i].name].now.push_back(i);
  for (const auto& [name, same] : names) {
    if (same.before.size() != same.now.size()) {
      match_in_order(before, expected, now, same, matches);
      continue;
    }
    for (size_t k = 0; k < same.now.size(); ++k) matches[same.now[k]] = same.before[k];
  }
  return matches;
}

}  // namespace geocloth
