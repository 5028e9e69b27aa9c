// SPDX-License-Identifier: Apache-2.0
// Counting on a triangle complex: all directed edges are sorted by their unordered vertex pair, so that the faces of an
// edge stand together. Disjoint sets then answer the rest: of vertices (components), of vertices over edges with one
// face (boundary loops), of corners over edges with two faces (fans), and of faces with a parity (orientability).
#include "geocloth/asset/topology.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

/// One side of a triangle, from corner `corner` of `face` to the next.
struct Side {
  uint64_t key;  ///< smaller vertex in the upper half, larger in the lower
  uint32_t face;
  uint8_t corner;
  bool ascending;  ///< runs from the smaller vertex to the larger
};

/// Disjoint sets whose members stand in one of two relations to their root: same way round, or turned.
class OrientedSets {
 public:
  explicit OrientedSets(std::size_t size) : parent_(size), turned_(size, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  /// States that a and b stand the same way round (or not). @returns false when that contradicts what was stated before
  bool relate(uint32_t a, uint32_t b, bool opposite) {
    const bool a_turned = compress(a), b_turned = compress(b);
    const uint32_t root_a = parent_[a], root_b = parent_[b];
    const bool differ = (a_turned != b_turned) != opposite;
    if (root_a == root_b) return !differ;
    parent_[root_a] = root_b;
    turned_[root_a] = differ ? 1 : 0;
    return true;
  }

 private:
  /// Makes the root the parent of i. @returns whether i is turned against it
  bool compress(uint32_t i) {
    path_.clear();
    for (; parent_[i] != i; i = parent_[i]) path_.push_back(i);
    uint8_t turned = 0;
    for (auto it = path_.rbegin(); it != path_.rend(); ++it) {
      turned ^= turned_[*it];
      turned_[*it] = turned;
      parent_[*it] = i;
    }
    return turned != 0;
  }
  std::vector<uint32_t> parent_;
  std::vector<uint8_t> turned_;
  std::vector<uint32_t> path_;
};

void check_triangles(std::span<const Triangle> triangles, uint32_t vertex_count) {
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const Triangle& t = triangles[f];
    for (const uint32_t v : t) {
      if (v >= vertex_count) {
        throw Error(ErrorCode::invalid_argument, "triangle " + std::to_string(f) + " names vertex " +
                                                     std::to_string(v) + " of " + std::to_string(vertex_count));
      }
    }
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      throw Error(ErrorCode::invalid_argument, "triangle " + std::to_string(f) + " names a vertex twice");
    }
  }
}

std::vector<Side> sorted_sides(std::span<const Triangle> triangles) {
  std::vector<Side> sides;
  sides.reserve(triangles.size() * 3);
  for (uint32_t f = 0; f < triangles.size(); ++f) {
    for (uint8_t c = 0; c < 3; ++c) {
      const uint32_t from = triangles[f][c], to = triangles[f][(c + 1U) % 3];
      const auto [low, high] = std::minmax(from, to);
      sides.push_back({(static_cast<uint64_t>(low) << 32U) | high, f, c, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.key != b.key ? a.key < b.key : a.face < b.face; });
  return sides;
}

uint32_t low_vertex(const Side& side) {
  return static_cast<uint32_t>(side.key >> 32U);
}
uint32_t high_vertex(const Side& side) {
  return static_cast<uint32_t>(side.key);
}
/// The corner (3 * face + corner) of a side's face at the edge's smaller or larger vertex.
uint32_t corner_at_low(const Side& side) {
  return 3 * side.face + (side.ascending ? side.corner : (side.corner + 1U) % 3);
}
uint32_t corner_at_high(const Side& side) {
  return 3 * side.face + (side.ascending ? (side.corner + 1U) % 3 : side.corner);
}

}  // namespace

Topology measure_topology(std::span<const Triangle> triangles, uint32_t vertex_count) {
  if (triangles.size() > 0xFFFFFFFFU / 3) {
    throw Error(ErrorCode::invalid_argument, "too many triangles: " + std::to_string(triangles.size()));
  }
  check_triangles(triangles, vertex_count);
  const std::vector<Side> sides = sorted_sides(triangles);

  Topology result;
  result.faces = static_cast<uint32_t>(triangles.size());
  DisjointSets components(vertex_count), loops(vertex_count), fans(triangles.size() * 3);
  OrientedSets faces(triangles.size());
  std::vector<uint8_t> on_boundary(vertex_count, 0), on_non_manifold(vertex_count, 0);

  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].key == sides[begin].key) ++end;
    const Side &a = sides[begin], &b = sides[end - 1];
    const uint32_t low = low_vertex(a), high = high_vertex(a);
    ++result.edges;
    components.join(low, high);
    if (end - begin == 1) {
      loops.join(low, high);
      on_boundary[low] = on_boundary[high] = 1;
    } else if (end - begin == 2) {
      fans.join(corner_at_low(a), corner_at_low(b));
      fans.join(corner_at_high(a), corner_at_high(b));
      const bool inconsistent = a.ascending == b.ascending;
      result.inconsistent_edges += inconsistent ? 1 : 0;
      if (!faces.relate(a.face, b.face, inconsistent)) result.orientable = false;
    } else {
      ++result.non_manifold_edges;
      on_non_manifold[low] = on_non_manifold[high] = 1;
    }
  }

  std::vector<uint32_t> fan_count(vertex_count, 0);
  std::vector<uint8_t> used(vertex_count, 0);
  for (uint32_t corner = 0; corner < triangles.size() * 3; ++corner) {
    const uint32_t v = triangles[corner / 3][corner % 3];
    used[v] = 1;
    if (fans.find(corner) == corner) ++fan_count[v];
  }
  for (uint32_t v = 0; v < vertex_count; ++v) {
    if (used[v] == 0) continue;
    ++result.vertices;
    if (components.find(v) == v) ++result.components;
    if (on_boundary[v] != 0 && loops.find(v) == v) ++result.boundary_loops;
    if (fan_count[v] > 1 && on_non_manifold[v] == 0) ++result.bow_tie_vertices;
  }
  result.euler_characteristic = int64_t{result.vertices} - int64_t{result.edges} + int64_t{result.faces};
  return result;
}

}  // namespace geocloth
