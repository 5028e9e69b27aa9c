// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels that slide to where they fit a surface best leave springs uneven and askew. Bounds on lengths and angles, as
// contacts are treated in mechanics: those that a move would break become stiff, linearised where the pixels are, and
// the move is sought again (active sets, Nocedal and Wright 2006, chapter 16). Of lengths and angles percentiles are
// to hold, so that a share of the worst is left alone: to mend them would cost the outline its place.
#include "fit/grid_holds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "geocloth/asset/grid_mesh.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSpread = 1.46;       // longest spring / shortest, but for the few worst
constexpr double kMostMended = 1.38;   // by which springs may be more uneven than that and still be mended
constexpr double kFewLengths = 0.005;  // share of the springs at either end that may be beyond their bounds
constexpr double kPercentile = 0.01;   // of lengths, between which the spread is counted
constexpr double kMostCosine = 0.097;  // 5.6 degrees off a right angle
constexpr double kFarAngles = 0.05, kMostCosineMended = 0.28;  // a share that is farther off is past mending
constexpr double kFewAngles = 0.035;                           // share of the angles that may be farther off
constexpr double kLooser = 1.25;                               // bounds of released springs
constexpr double kReleased = 0.003;                            // share of the points
constexpr float kStiff = 4, kGentle = 0.035F;  // [pixels^2] weights beside the area that a pixel stands for

double cosine(const Point3& a, const Point3& b) {
  const double lengths = length(a) * length(b);
  return lengths > 0 ? dot(a, b) / lengths : 1;
}

/// The value above which a share of all lies.
double exceeded_by(std::vector<double> values, double share) {
  const auto at = values.end() - 1 - static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The value below which a share of all lies.
double undercut_by(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The lower one of two bounds, kSpread apart, that lengths have to change least to keep, in squares and but for the
/// few worst.
double easiest_least(std::vector<double> lengths) {
  std::sort(lengths.begin(), lengths.end());
  constexpr double kMost = 0.95, kRoom = 1.02;
  const auto few = static_cast<size_t>(kFewLengths * static_cast<double>(lengths.size()));
  const auto held = std::span(lengths).subspan(few, lengths.size() - 2 * few);
  const auto at = [&](double share) { return held[static_cast<size_t>(share * static_cast<double>(held.size() - 1))]; };
  double low = kRoom * at(kMost) / kSpread, high = at(1 - kMost) / kRoom;
  if (low > high) {
    low = held.front();
    high = held.back() / kSpread;
  }
  constexpr int kHalvings = 40;
  for (int k = 0; k < kHalvings; ++k) {
    const double least = (low + high) / 2, most = least * kSpread;
    double slope = 0;
    for (const double l : held) slope += std::max(least - l, 0.0) - kSpread * std::max(l - most, 0.0);
    (slope > 0 ? high : low) = least;
  }
  return low;
}

}  // namespace

std::vector<uint8_t> points_on_border(const ClothAsset& asset, std::span<const uint32_t> first) {
  std::vector<std::array<uint32_t, 2>> edge;
  for (const Triangle& t : pixel_triangles(asset)) {
    for (size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(first[t[k]], first[t[(k + 1) % 3]]);
      edge.push_back({low, high});
    }
  }
  std::sort(edge.begin(), edge.end());
  std::vector<uint8_t> result(asset.pixel_count(), 0);
  for (size_t i = 0, next = 0; i < edge.size(); i = next) {
    while (next < edge.size() && edge[next] == edge[i]) ++next;
    if (next == i + 1) result[edge[i][0]] = result[edge[i][1]] = 1;
  }
  return result;
}

GridHolds::GridHolds(const ClothAsset& asset, std::span<const Point3> place, std::span<const uint32_t> first,
                     std::vector<uint8_t> is_hem)
    : spacing_(asset.spacing), is_hem_(std::move(is_hem)) {
  find_springs(asset, first);
  if (!spring_.empty()) bound_lengths(place);
  if (!meeting_.empty()) bound_angles(place);
}

void GridHolds::find_springs(const ClothAsset& asset, std::span<const uint32_t> first) {
  const uint32_t w = asset.width;
  const auto joined = [&](uint32_t pixel, uint8_t bit) { return (asset.spring_mask[pixel] & bit) != 0; };
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) continue;
    const bool right = joined(i, kSpringRight), down = joined(i, kSpringDown);
    if (right) spring_.push_back({first[i], first[i + 1], 0, 0, false});
    if (down) spring_.push_back({first[i], first[i + w], 0, 0, false});
    const std::array beside{std::pair(right, i + 1), std::pair(i > 0 && joined(i - 1, kSpringRight), i - 1)};
    const std::array below{std::pair(down, i + w), std::pair(i >= w && joined(i - w, kSpringDown), i - w)};
    for (const auto& [has_beside, a] : beside) {
      for (const auto& [has_below, b] : below) {
        if (!has_beside || !has_below) continue;
        meeting_.push_back({first[i], first[a], first[b], 0, a > i && b > i, false});
      }
    }
  }
}

void GridHolds::bound_lengths(std::span<const Point3> place) {
  std::vector<double> lengths;
  lengths.reserve(spring_.size());
  for (const Spring& s : spring_) lengths.push_back(distance(place[s.a], place[s.b]));
  double least = undercut_by(lengths, kPercentile), most = exceeded_by(lengths, kPercentile);
  if (!(least > 0)) least = most / kSpread;
  const double spread = most / least;
  if (spread <= kSpread) {
    const double room = std::sqrt(kSpread / spread);
    least /= room;
    most *= room;
  } else if (spread <= kSpread * kMostMended) {
    least = easiest_least(lengths);
    most = least * kSpread;
  }
  const double few = undercut_by(lengths, kFewLengths), many = exceeded_by(lengths, kFewLengths);
  for (size_t k = 0; k < spring_.size(); ++k) {
    const double l = lengths[k];
    spring_[k].least = static_cast<float>(l < few ? std::min(l, least) : least);
    spring_[k].most = static_cast<float>(l > many ? std::max(l, most) : most);
  }
}

void GridHolds::bound_angles(std::span<const Point3> place) {
  std::vector<double> cosines;
  cosines.reserve(meeting_.size());
  for (const Meeting& m : meeting_) {
    cosines.push_back(std::abs(cosine(place[m.beside] - place[m.middle], place[m.below] - place[m.middle])));
  }
  const double many = exceeded_by(cosines, kFewAngles);
  const bool mend = exceeded_by(cosines, kFarAngles) <= kMostCosineMended;
  for (size_t k = 0; k < meeting_.size(); ++k) {
    const bool stays = cosines[k] > many || !mend;
    meeting_[k].most = static_cast<float>(stays ? std::max(cosines[k], kMostCosine) : kMostCosine);
  }
}

void GridHolds::release(std::span<const double> value) {
  std::vector<double> above_zero;
  std::copy_if(value.begin(), value.end(), std::back_inserter(above_zero), [](double v) { return v > 0; });
  is_released_.assign(value.size(), 0);
  if (above_zero.empty()) return;
  const double many = exceeded_by(std::move(above_zero), kReleased);
  for (size_t p = 0; p < value.size(); ++p) is_released_[p] = value[p] > many ? 1 : 0;
}

bool GridHolds::on_hem(const Meeting& m) const {
  return is_hem_[m.middle] != 0 || is_hem_[m.beside] != 0 || is_hem_[m.below] != 0;
}

namespace {

/// That the cosine of an angle becomes `wanted`.
MoveWish wish_for_angle(const std::array<uint32_t, 3>& point, const Point3& a, const Point3& b, double wanted,
                        float weight, double spacing) {
  const double la = length(a), lb = length(b), now = dot(a, b) / (la * lb);
  const Point3 slope_a = (b * (1 / (la * lb)) - a * (now / (la * la))) * spacing;
  const Point3 slope_b = (a * (1 / (la * lb)) - b * (now / (lb * lb))) * spacing;
  return {point, {to_single(slope_a), to_single(slope_b)}, weight, static_cast<float>((wanted - now) * spacing)};
}

}  // namespace

std::vector<MoveWish> GridHolds::gentle_wishes(std::span<const Point3> place) {
  std::vector<MoveWish> wishes;
  for (Spring& s : spring_) s.wished = false;
  for (Meeting& m : meeting_) {
    m.wished = false;
    if (!m.is_first || on_hem(m)) continue;
    const Point3 a = place[m.beside] - place[m.middle], b = place[m.below] - place[m.middle];
    if (!(length(a) > 0) || !(length(b) > 0)) continue;
    wishes.push_back(wish_for_angle({m.beside, m.below, m.middle}, a, b, 0, kGentle, spacing_));
  }
  return wishes;
}

size_t GridHolds::add_broken(std::span<const Point3> place, std::span<const Point3> move,
                             std::vector<MoveWish>& wishes) {
  const size_t before = wishes.size();
  const auto now = [&](uint32_t from, uint32_t to) { return place[to] - place[from]; };
  const auto then = [&](uint32_t from, uint32_t to) { return now(from, to) + (move[to] - move[from]); };
  for (Spring& s : spring_) {
    if (s.wished) continue;
    const double looser = is_released_[s.a] != 0 || is_released_[s.b] != 0 ? kLooser : 1;
    const double moved = length(then(s.a, s.b)), bounded = std::clamp(moved, s.least / looser, s.most * looser);
    const Point3 along = now(s.a, s.b);
    const double l = length(along);
    if (moved == bounded || !(l > 0)) continue;
    wishes.push_back({{s.b, s.b, s.a}, {to_single(along * (1 / l)), Vec3{}}, kStiff, static_cast<float>(bounded - l)});
    s.wished = true;
  }
  for (Meeting& m : meeting_) {
    if (m.wished || is_released_[m.middle] != 0) continue;
    const double moved = cosine(then(m.middle, m.beside), then(m.middle, m.below));
    const Point3 a = now(m.middle, m.beside), b = now(m.middle, m.below);
    if (std::abs(moved) <= m.most || !(length(a) > 0) || !(length(b) > 0)) continue;
    const double most = moved > 0 ? m.most : -m.most;
    wishes.push_back(wish_for_angle({m.beside, m.below, m.middle}, a, b, most, kStiff, spacing_));
    m.wished = true;
  }
  return wishes.size() - before;
}

}  // namespace geocloth
