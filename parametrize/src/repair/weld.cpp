// SPDX-License-Identifier: GPL-3.0-or-later
// Welding by position: first vertices at the same place, then places within a tolerance that is small beside the edges
// there, however large the whole is. Pairs are joined nearest first and only while the group stays within the
// tolerance, so that a chain of near vertices does not run together.
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "mesh/point_math.h"
#include "mesh/point_tree.h"
#include "repair/near_groups.h"
#include "repair/soup.h"

namespace geocloth {
namespace {

/// Numbers equal positions alike, in order of first appearance.
void weld_exact(std::span<const Point3> position, const std::vector<bool>& used, Weld& out) {
  const auto hash = [](const Point3& p) {
    std::size_t h = 0;
    for (const double c : p) h = (h ^ std::hash<double>()(c)) * 0x9E3779B97F4A7C15ULL;  // hash of -0 and 0 are one
    return h ^ h >> 32U;
  };
  std::unordered_map<Point3, uint32_t, decltype(hash)> known(position.size(), hash);
  out.point.assign(position.size(), kNone);
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (!used[i]) continue;
    const auto [it, fresh] = known.try_emplace(position[i], static_cast<uint32_t>(out.position.size()));
    if (fresh) out.position.push_back(position[i]);
    out.point[i] = it->second;
  }
}

/// The length of the shortest edge at every place; the largest number where there is none. Sides that are nothing
/// beside the others of their triangle are no edges: the vertices around the pole of a sphere that was computed lie
/// rounding errors apart.
std::vector<double> shortest_edges(const std::vector<Point3>& place, const std::vector<Triangle>& triangle) {
  constexpr double kNothing = 1e-7;  // of the longest side: what single precision cannot tell
  std::vector<double> shortest(place.size(), std::numeric_limits<double>::max());
  for (const Triangle& t : triangle) {
    std::array<double, 3> side{};
    for (std::size_t k = 0; k < 3; ++k) side[k] = distance(place[t[k]], place[t[(k + 1) % 3]]);
    const double longest = *std::max_element(side.begin(), side.end());
    for (std::size_t k = 0; k < 3; ++k) {
      if (side[k] <= kNothing * longest) continue;
      for (const uint32_t v : {t[k], t[(k + 1) % 3]}) shortest[v] = std::min(shortest[v], side[k]);
    }
  }
  return shortest;
}

/// All pairs of places within the reach of both.
std::vector<NearPair> near_pairs(const std::vector<Point3>& place, const std::vector<double>& reach) {
  std::vector<uint32_t> all(place.size());
  std::iota(all.begin(), all.end(), 0U);
  const PointTree tree(place, std::move(all));
  std::vector<NearPair> pairs;
  for (uint32_t i = 0; i < place.size(); ++i) {
    tree.near_segment(place[i], place[i], reach[i], [&](uint32_t j) {
      if (j <= i) return;
      const double d = distance(place[i], place[j]);
      if (d <= std::min(reach[i], reach[j])) pairs.push_back({d, i, j});
    });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Joins the places within each other's reach.
void weld_near(const std::vector<double>& reach, Weld& weld) {
  const std::vector<NearPair> pairs = near_pairs(weld.position, reach);
  if (pairs.empty()) return;
  NearGroups groups(weld.position, reach);
  for (const NearPair& pair : pairs) groups.join(pair);
  // The root of a group is its first place, so that numbers stay in order of first appearance.
  std::vector<uint32_t> number(weld.position.size(), kNone);
  std::vector<Point3> position;
  for (uint32_t i = 0; i < number.size(); ++i) {
    const uint32_t root = groups.find(i);
    if (root == i) {
      number[i] = static_cast<uint32_t>(position.size());
      position.push_back(weld.position[i]);
    } else {
      number[i] = number[root];
    }
  }
  for (uint32_t& p : weld.point) {
    if (p != kNone) p = number[p];
  }
  weld.position = std::move(position);
}

/// Sides of triangles that no other triangle shares, as share of all.
double loose_share(std::span<const Triangle> triangle, const Weld& weld) {
  const std::vector<Triangle> proper = proper_triangles(triangle, weld.point);
  return proper.empty() ? 0
                        : static_cast<double>(border_sides(proper).size()) / (3 * static_cast<double>(proper.size()));
}

}  // namespace

std::vector<Triangle> proper_triangles(std::span<const Triangle> triangle, const std::vector<uint32_t>& point) {
  std::vector<Triangle> result;
  result.reserve(triangle.size());
  for (const Triangle& t : triangle) {
    const Triangle p{point[t[0]], point[t[1]], point[t[2]]};
    if (p[0] != p[1] && p[1] != p[2] && p[2] != p[0]) result.push_back(p);
  }
  return result;
}

WeldReach weld_reach(const RepairOptions& options, double size) {
  constexpr double kShare = 1e-6;  // of the size
  return {options.weld_distance.value_or(kShare * size), options.weld_distance.has_value()};
}

Weld weld(std::span<const Point3> position, std::span<const Triangle> triangle, const WeldReach& reach) {
  constexpr double kOfShortest = 0.5;                             // nothing collapses
  constexpr double kMostInSoup = 100, kOfShortestInSoup = 0.005;  // still small beside every face
  constexpr double kLooseSoup = 0.4, kLooseCloth = 0.1;
  std::vector<bool> used(position.size(), false);
  for (const Triangle& t : triangle) {
    for (const uint32_t v : t) used[v] = true;
  }
  Weld exact;
  weld_exact(position, used, exact);
  if (!(reach.distance > 0) || exact.position.empty()) return exact;
  const std::vector<double> shortest = shortest_edges(exact.position, proper_triangles(triangle, exact.point));
  const auto within = [&](double most, double share) {
    std::vector<double> reaches(shortest.size());
    std::transform(shortest.begin(), shortest.end(), reaches.begin(),
                   [&](double l) { return std::min(most, share * l); });
    Weld result = exact;
    weld_near(reaches, result);
    return result;
  };
  Weld near = within(reach.distance, kOfShortest);
  if (reach.is_asked || loose_share(triangle, near) < kLooseSoup) return near;
  Weld nearer = within(kMostInSoup * reach.distance, kOfShortestInSoup);
  return loose_share(triangle, nearer) < kLooseCloth ? nearer : near;
}

}  // namespace geocloth
