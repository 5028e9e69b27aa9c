// SPDX-License-Identifier: GPL-3.0-or-later
// Welding by position: first vertices at the same place, then places within a tolerance, found with a grid of that cell
// size. Pairs are joined nearest first and only while the group stays within the tolerance, so that a chain of near
// vertices does not run together; a pair that would take a corner from a triangle stays apart.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "point_math.h"
#include "soup.h"

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

struct NearPair {
  double distance;
  uint32_t a, b;
  bool operator<(const NearPair& o) const {
    return distance != o.distance ? distance < o.distance : a != o.a ? a < o.a : b < o.b;
  }
};

/// All pairs of places within the tolerance. Places are sorted by grid cell; each cell is held against the half of its
/// neighbours that come after it.
std::vector<NearPair> near_pairs(const std::vector<Point3>& place, double tolerance) {
  using Cell = std::array<int64_t, 3>;
  Point3 low = place[0];
  for (const Point3& p : place) {
    for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]);
  }
  std::vector<Cell> cell(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) cell[i][k] = static_cast<int64_t>((place[i][k] - low[k]) / tolerance);
  }
  std::vector<uint32_t> order(place.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return cell[a] < cell[b]; });

  std::vector<NearPair> pairs;
  const auto compare = [&](std::size_t i, std::size_t j) {
    const double d = distance(place[order[i]], place[order[j]]);
    if (d <= tolerance) pairs.push_back({d, std::min(order[i], order[j]), std::max(order[i], order[j])});
  };
  // Cells at (0,0,0..1) follow directly; each of the other four columns ahead has a cursor that only moves forward.
  constexpr std::array<std::array<int64_t, 2>, 4> kAhead{{{0, 1}, {1, -1}, {1, 0}, {1, 1}}};
  std::array<std::size_t, 4> cursor{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Cell& c = cell[order[i]];
    const Cell last{c[0], c[1], c[2] + 1};
    for (std::size_t j = i + 1; j < order.size() && cell[order[j]] <= last; ++j) compare(i, j);
    for (std::size_t k = 0; k < kAhead.size(); ++k) {
      const Cell from{c[0] + kAhead[k][0], c[1] + kAhead[k][1], c[2] - 1}, to{from[0], from[1], c[2] + 1};
      while (cursor[k] < order.size() && cell[order[cursor[k]]] < from) ++cursor[k];
      for (std::size_t j = cursor[k]; j < order.size() && cell[order[j]] <= to; ++j) compare(i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Groups of places, joined pair by pair under the two conditions.
class Groups {
 public:
  Groups(const std::vector<Point3>& place, std::span<const Triangle> triangle, const std::vector<uint32_t>& point,
         const std::vector<NearPair>& pairs, double tolerance)
      : place_(place), tolerance_(tolerance), parent_(place.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::vector<bool> concerned(place.size(), false);
    for (const NearPair& pair : pairs) concerned[pair.a] = concerned[pair.b] = true;
    for (const Triangle& t : triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        const uint32_t a = point[t[k]], b = point[t[(k + 1) % 3]], c = point[t[(k + 2) % 3]];
        if (a == b || b == c || c == a) continue;  // has collapsed already
        if (concerned[a] && concerned[b]) {
          neighbour_[a].push_back(b);
          neighbour_[b].push_back(a);
        }
      }
    }
  }

  void join(const NearPair& pair) {
    uint32_t a = find(pair.a), b = find(pair.b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    if (!compact(a, b) || share_triangle(a, b)) return;
    parent_[b] = a;
    std::vector<uint32_t>& all = members(a);
    const std::vector<uint32_t> more = members(b);
    all.insert(all.end(), more.begin(), more.end());
  }

  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

 private:
  std::vector<uint32_t>& members(uint32_t root) {
    const auto [it, fresh] = member_.try_emplace(root);
    if (fresh) it->second.push_back(root);
    return it->second;
  }

  bool compact(uint32_t a, uint32_t b) {
    for (const uint32_t i : std::vector<uint32_t>(members(a))) {
      for (const uint32_t j : members(b)) {
        if (distance(place_[i], place_[j]) > tolerance_) return false;
      }
    }
    return true;
  }

  bool share_triangle(uint32_t a, uint32_t b) {
    for (const uint32_t i : members(a)) {
      const auto it = neighbour_.find(i);
      if (it == neighbour_.end()) continue;
      for (const uint32_t j : it->second) {
        if (find(j) == b) return true;
      }
    }
    return false;
  }

  const std::vector<Point3>& place_;
  double tolerance_;
  std::vector<uint32_t> parent_;
  std::unordered_map<uint32_t, std::vector<uint32_t>> member_, neighbour_;
};

void weld_near(std::span<const Triangle> triangle, double tolerance, Weld& weld) {
  const std::vector<NearPair> pairs = near_pairs(weld.position, tolerance);
  if (pairs.empty()) return;
  Groups groups(weld.position, triangle, weld.point, pairs, tolerance);
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

}  // namespace

Weld weld(std::span<const Point3> position, std::span<const Triangle> triangle, double tolerance) {
  std::vector<bool> used(position.size(), false);
  for (const Triangle& t : triangle) {
    for (const uint32_t v : t) used[v] = true;
  }
  Weld out;
  weld_exact(position, used, out);
  if (tolerance > 0 && !out.position.empty()) weld_near(triangle, tolerance, out);
  return out;
}

}  // namespace geocloth
