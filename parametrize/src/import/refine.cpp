// SPDX-License-Identifier: GPL-3.0-or-later
// An edge that is too long is halved by all of its triangles at once (Rivara 1984: refinement without hanging
// vertices): a triangle becomes two, three or four, as it has long edges.

#include "geocloth/parametrize/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "geocloth/asset/error.h"
#include "import/vertex_paint.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// Corners of a triangle, and what each of them has.
struct Corner {
  uint32_t vertex;
  Point2 uv;
  Point3 normal;
};
using Corners = std::array<Corner, 3>;

/// What a mesh has for each triangle.
struct Faces {
  std::vector<Triangle> triangle;
  std::vector<uint32_t> polygon;
  std::vector<std::array<Point2, 3>> uv;
  std::vector<std::array<Point3, 3>> normal;
};

class Refinement {
 public:
  Refinement(TriangleMesh mesh, double longest)
      : mesh_(std::move(mesh)), longest_(longest), has_uv_(!mesh_.uv.empty()), has_normal_(!mesh_.normal.empty()) {}

  TriangleMesh refined() {
    check(least_triangles());
    while (halve_once()) check(static_cast<double>(mesh_.triangle.size()));
    return std::move(mesh_);
  }

 private:
  static void check(double triangles) {
    if (triangles <= static_cast<double>(kMostRefinedTriangles)) return;
    throw Error(ErrorCode::limit, "there would be more than " + std::to_string(kMostRefinedTriangles) +
                                      " triangles; give a larger --refine");
  }

  /// None has a larger area than an equilateral one.
  [[nodiscard]] double least_triangles() const {
    return surface_area(mesh_.position, mesh_.triangle) / (std::sqrt(3.0) / 4 * longest_ * longest_);
  }

  /// @return whether an edge was too long
  bool halve_once() {
    middle_.clear();
    const Faces old{std::exchange(mesh_.triangle, {}), std::exchange(mesh_.polygon, {}), std::exchange(mesh_.uv, {}),
                    std::exchange(mesh_.normal, {})};
    for (SourcePart& part : mesh_.part) {
      const uint32_t first = part.first_triangle, last = first + part.triangle_count;
      part.first_triangle = static_cast<uint32_t>(mesh_.triangle.size());
      for (uint32_t t = first; t < last; ++t) halve(corners_of(old, t), old.polygon.empty() ? t : old.polygon[t]);
      part.triangle_count = static_cast<uint32_t>(mesh_.triangle.size()) - part.first_triangle;
    }
    give_names_and_paint();
    return !middle_.empty();
  }

  [[nodiscard]] Corners corners_of(const Faces& mesh, uint32_t t) const {
    Corners corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k].vertex = mesh.triangle[t][k];
      if (has_uv_) corners[k].uv = mesh.uv[t][k];
      if (has_normal_) corners[k].normal = mesh.normal[t][k];
    }
    return corners;
  }

  [[nodiscard]] bool is_long(const Corner& a, const Corner& b) const {
    return distance(mesh_.position[a.vertex], mesh_.position[b.vertex]) > longest_;
  }

  void halve(Corners c, uint32_t polygon) {
    const auto is_long_from = [&](std::size_t k) { return is_long(c[k], c[(k + 1) % 3]); };
    const auto count = is_long_from(0) + is_long_from(1) + is_long_from(2);
    if (count == 0) return add(c, polygon);
    // So that the first edge is long, and where there are two the second one is, too.
    while (!is_long_from(0) || (count == 2 && !is_long_from(1))) std::rotate(c.begin(), c.begin() + 1, c.end());
    const Corner ab = between(c[0], c[1]);
    if (count == 1) {
      add({c[0], ab, c[2]}, polygon);
      add({ab, c[1], c[2]}, polygon);
      return;
    }
    const Corner bc = between(c[1], c[2]);
    add({ab, c[1], bc}, polygon);
    if (count == 3) {
      const Corner ca = between(c[2], c[0]);
      add({c[0], ab, ca}, polygon);
      add({ca, bc, c[2]}, polygon);
      add({ab, bc, ca}, polygon);
      return;
    }
    const auto apart = [&](const Corner& p, const Corner& q) {
      return distance(mesh_.position[p.vertex], mesh_.position[q.vertex]);
    };
    if (apart(c[0], bc) <= apart(ab, c[2])) {
      add({c[0], ab, bc}, polygon);
      add({c[0], bc, c[2]}, polygon);
    } else {
      add({c[0], ab, c[2]}, polygon);
      add({ab, bc, c[2]}, polygon);
    }
  }

  [[nodiscard]] Corner between(const Corner& a, const Corner& b) {
    const auto [low, high] = std::minmax(a.vertex, b.vertex);
    const auto [found, is_new] =
        middle_.try_emplace(uint64_t{low} << 32 | high, static_cast<uint32_t>(mesh_.position.size()));
    if (is_new) {
      mesh_.position.push_back((mesh_.position[low] + mesh_.position[high]) * 0.5);
      mesh_.middle.push_back({low, high});
    }
    const Point3 sum = a.normal + b.normal;
    return {
        found->second, {0.5 * (a.uv[0] + b.uv[0]), 0.5 * (a.uv[1] + b.uv[1])}, direction_of(sum).value_or(a.normal)};
  }

  void add(const Corners& c, uint32_t polygon) {
    mesh_.triangle.push_back({c[0].vertex, c[1].vertex, c[2].vertex});
    mesh_.polygon.push_back(polygon);
    if (has_uv_) mesh_.uv.push_back({c[0].uv, c[1].uv, c[2].uv});
    if (has_normal_) mesh_.normal.push_back({c[0].normal, c[1].normal, c[2].normal});
  }

  /// To the vertices that are new, by those at the ends of their edges.
  void give_names_and_paint() {
    std::vector<std::pair<uint32_t, std::pair<uint32_t, uint32_t>>> added;  // vertex, ends of its edge
    added.reserve(middle_.size());
    for (const auto& [edge, vertex] : middle_)
      added.push_back({vertex, {static_cast<uint32_t>(edge >> 32), static_cast<uint32_t>(edge)}});
    std::ranges::sort(added);
    for (ClothAsset::VertexGroup& group : mesh_.vertex_groups) {
      std::vector<bool> in_group(mesh_.position.size());
      for (const uint32_t v : group.source_vertex) in_group[v] = true;
      for (const auto& [vertex, ends] : added)
        if (in_group[ends.first] && in_group[ends.second]) group.source_vertex.push_back(vertex);
    }
    if (mesh_.paint.empty()) return;
    for (const auto& [vertex, ends] : added)
      mesh_.paint.push_back(import_detail::mean(mesh_.paint[ends.first], mesh_.paint[ends.second]));
  }

  TriangleMesh mesh_;
  double longest_;
  bool has_uv_, has_normal_;
  std::unordered_map<uint64_t, uint32_t> middle_;  ///< of edges that were halved, by their ends
};

}  // namespace

TriangleMesh refine_mesh(TriangleMesh mesh, double longest) {
  return Refinement(std::move(mesh), longest).refined();
}

}  // namespace geocloth
