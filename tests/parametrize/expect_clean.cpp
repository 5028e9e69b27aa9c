// SPDX-License-Identifier: GPL-3.0-or-later
#include "parametrize/expect_clean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

namespace geocloth::test {
namespace {

double area(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
}

/// Counts violations and names the first.
class Tally {
 public:
  explicit Tally(std::string rule) : rule_(std::move(rule)) {}
  Tally(const Tally&) = delete;
  Tally& operator=(const Tally&) = delete;
  ~Tally() { EXPECT_EQ(count_, 0U) << rule_ << ", first at " << first_; }
  void require(bool holds, std::size_t where) {
    if (holds) return;
    if (count_++ == 0) first_ = where;
  }

 private:
  std::string rule_;
  std::size_t count_ = 0, first_ = 0;
};

bool expect_tables(const CleanSurface& s, const TriangleMesh& source) {
  EXPECT_EQ(s.point.size(), s.position.size());
  EXPECT_EQ(s.component.size(), s.triangle.size());
  EXPECT_EQ(s.source_triangle.size(), s.triangle.size());
  EXPECT_EQ(s.source_point.size(), source.position.size());
  EXPECT_FALSE(s.triangle.empty());
  const auto below = [](const std::vector<uint32_t>& values, uint32_t limit) {
    return std::all_of(values.begin(), values.end(), [&](uint32_t v) { return v < limit; });
  };
  EXPECT_TRUE(below(s.point, s.point_count));
  EXPECT_TRUE(below(s.component, s.component_count));
  for (const uint32_t t : s.source_triangle) EXPECT_TRUE(t == kNone || t < source.triangle.size());
  for (const uint32_t p : s.source_point) EXPECT_TRUE(p == kNone || p < s.point_count);
  for (const Triangle& t : s.triangle) {
    for (const uint32_t v : t) EXPECT_LT(v, s.position.size());
  }
  // Numbers are used without gaps.
  EXPECT_EQ(std::set<uint32_t>(s.point.begin(), s.point.end()).size(), s.point_count);
  EXPECT_EQ(std::set<uint32_t>(s.component.begin(), s.component.end()).size(), s.component_count);
  return !::testing::Test::HasFailure();
}

void expect_proper_triangles(const CleanSurface& s) {
  Tally points("a triangle has three different points"), areas("a triangle has a positive area"),
      twice("no two triangles of one sheet are over the same points");
  std::set<Triangle> seen;
  for (std::size_t i = 0; i < s.triangle.size(); ++i) {
    const Triangle& t = s.triangle[i];
    Triangle p{s.point[t[0]], s.point[t[1]], s.point[t[2]]};
    points.require(p[0] != p[1] && p[1] != p[2] && p[2] != p[0], i);
    areas.require(area(s.position[t[0]], s.position[t[1]], s.position[t[2]]) > 0, i);
    std::sort(p.begin(), p.end());
    twice.require(seen.insert(p).second, i);
  }
}

void expect_copies_coincide(const CleanSurface& s) {
  Tally same("vertices of one point have the same position, bit for bit"),
      different("different points have different positions");
  std::vector<uint32_t> first(s.point_count, kNone);
  std::map<Point3, uint32_t> at;
  for (uint32_t v = 0; v < s.position.size(); ++v) {
    uint32_t& f = first[s.point[v]];
    if (f == kNone) f = v;
    same.require(s.position[f] == s.position[v], v);
    different.require(at.try_emplace(s.position[v], s.point[v]).first->second == s.point[v], v);
  }
}

/// Edges as vertex numbers, with the corners where their sides begin.
using Edges = std::map<std::array<uint32_t, 2>, std::vector<std::size_t>>;

Edges collect_edges(const CleanSurface& s) {
  Edges edges;
  for (std::size_t c = 0; c < s.triangle.size() * 3; ++c) {
    const uint32_t a = s.triangle[c / 3][c % 3], b = s.triangle[c / 3][(c + 1) % 3];
    edges[{std::min(a, b), std::max(a, b)}].push_back(c);
  }
  return edges;
}

void expect_manifold(const CleanSurface& s) {
  const Edges edges = collect_edges(s);
  Tally two("an edge has at most two triangles"), way("its triangles run along an edge in opposite directions"),
      one_component("joined triangles are of one component"), used("every vertex is used"), fan("a vertex has one fan");
  std::vector<std::size_t> parent(s.triangle.size() * 3);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto find = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& [edge, sides] : edges) {
    two.require(sides.size() <= 2, edge[0]);
    if (sides.size() != 2) continue;
    const std::size_t a = sides[0], b = sides[1];
    way.require(s.triangle[a / 3][a % 3] != s.triangle[b / 3][b % 3], edge[0]);
    one_component.require(s.component[a / 3] == s.component[b / 3], edge[0]);
    const std::size_t after_a = a % 3 == 2 ? a - 2 : a + 1, after_b = b % 3 == 2 ? b - 2 : b + 1;
    parent[find(a)] = find(after_b);
    parent[find(after_a)] = find(b);
  }
  std::vector<std::size_t> fan_of(s.position.size(), SIZE_MAX);
  for (std::size_t c = 0; c < s.triangle.size() * 3; ++c) {
    std::size_t& known = fan_of[s.triangle[c / 3][c % 3]];
    if (known == SIZE_MAX) known = find(c);
    fan.require(known == find(c), s.triangle[c / 3][c % 3]);
  }
  for (std::size_t v = 0; v < fan_of.size(); ++v) used.require(fan_of[v] != SIZE_MAX, v);
}

/// Components are told apart exactly by connection over vertices.
void expect_components(const CleanSurface& s) {
  std::vector<uint32_t> parent(s.position.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto find = [&](uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const Triangle& t : s.triangle) {
    parent[find(t[0])] = find(t[1]);
    parent[find(t[1])] = find(t[2]);
  }
  Tally same("a connected sheet has one component number, and only it");
  std::map<uint32_t, uint32_t> number, root;
  for (std::size_t i = 0; i < s.triangle.size(); ++i) {
    const uint32_t r = find(s.triangle[i][0]), c = s.component[i];
    same.require(number.try_emplace(r, c).first->second == c && root.try_emplace(c, r).first->second == r, i);
  }
}

void expect_source(const CleanSurface& s, const TriangleMesh& source) {
  Point3 low = source.position[source.triangle[0][0]], high = low;
  std::vector<bool> used(source.position.size(), false);
  for (const Triangle& t : source.triangle) {
    for (const uint32_t v : t) {
      used[v] = true;
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], source.position[v][k]);
        high[k] = std::max(high[k], source.position[v][k]);
      }
    }
  }
  const double diagonal = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  std::vector<Point3> place(s.point_count);
  for (std::size_t v = 0; v < s.position.size(); ++v) place[s.point[v]] = s.position[v];
  Tally near("a source vertex is within the tolerance of its point"), none("a vertex that no face uses has no point");
  for (std::size_t v = 0; v < source.position.size(); ++v) {
    if (s.source_point[v] == kNone) continue;
    none.require(used[v], v);
    const Point3 &p = source.position[v], &q = place[s.source_point[v]];
    near.require(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) <= 1.0001e-6 * diagonal, v);
  }
}

}  // namespace

void expect_clean(const CleanSurface& surface, const TriangleMesh& source) {
  if (!expect_tables(surface, source)) return;
  expect_proper_triangles(surface);
  expect_copies_coincide(surface);
  expect_manifold(surface);
  expect_components(surface);
  expect_source(surface, source);
}

}  // namespace geocloth::test
