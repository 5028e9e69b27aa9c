// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest places on a mesh with CGAL's tree of axis-aligned boxes. A known place nearby bounds the search from the
// start, which spares the tree's own table of hints; consecutive queries of the callers lie close together.
#include "mesh/triangle_tree.h"

#include <algorithm>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Boxes = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(const Point3& p) {
  return {p[0], p[1], p[2]};
}

/// CGAL projects on to the plane of a triangle, which rounding makes meaningless for a needle.
bool has_plane(const Point3& a, const Point3& b, const Point3& c) {
  constexpr double kFlattest = 1e-12;  ///< height / longest edge
  const double longest = std::max({distance(a, b), distance(b, c), distance(c, a)});
  return 2 * triangle_area(a, b, c) > kFlattest * longest * longest;
}

}  // namespace

struct TriangleTree::Tree {
  Triangles triangle;
  std::vector<uint32_t> index;  ///< per triangle kept: its number in the mesh
  Boxes boxes;

  [[nodiscard]] Place place(const Boxes::Point_and_primitive_id& found) const {
    const Kernel::Point_3& p = found.first;
    return {index[static_cast<std::size_t>(found.second - triangle.cbegin())], {p.x(), p.y(), p.z()}};
  }
  /// Any place of the mesh, from which a search can start.
  [[nodiscard]] Boxes::Point_and_primitive_id start(const std::optional<Place>& near) const {
    const auto first = triangle.cbegin();
    if (!near) return {first->vertex(0), first};
    const auto found = std::lower_bound(index.begin(), index.end(), near->triangle);
    return {to_cgal(near->point), first + (found - index.begin())};
  }
};

TriangleTree::TriangleTree(std::span<const Point3> position, std::span<const Triangle> triangle)
    : tree_(std::make_unique<Tree>()) {
  for (uint32_t t = 0; t < triangle.size(); ++t) {
    const Point3 &a = position[triangle[t][0]], &b = position[triangle[t][1]], &c = position[triangle[t][2]];
    if (!has_plane(a, b, c)) continue;
    tree_->triangle.emplace_back(to_cgal(a), to_cgal(b), to_cgal(c));
    tree_->index.push_back(t);
  }
  if (tree_->triangle.empty()) {
    throw Error(ErrorCode::invalid_data, "no triangle of the surface has an area; check the coordinates of the mesh");
  }
  tree_->boxes.insert(tree_->triangle.cbegin(), tree_->triangle.cend());
  tree_->boxes.build();
}

TriangleTree::~TriangleTree() = default;
TriangleTree::TriangleTree(TriangleTree&&) noexcept = default;
TriangleTree& TriangleTree::operator=(TriangleTree&&) noexcept = default;

TriangleTree::Place TriangleTree::nearest(const Point3& p, const std::optional<Place>& near) const {
  return tree_->place(tree_->boxes.closest_point_and_primitive(to_cgal(p), tree_->start(near)));
}

std::optional<TriangleTree::Hit> TriangleTree::first_hit(const Point3& from, const Point3& direction,
                                                         uint32_t except) const {
  const auto first = tree_->triangle.cbegin();
  const auto number = [&](Triangles::const_iterator t) { return tree_->index[static_cast<std::size_t>(t - first)]; };
  const Kernel::Ray_3 ray(to_cgal(from), Kernel::Vector_3(direction[0], direction[1], direction[2]));
  const auto found =
      tree_->boxes.first_intersected_primitive(ray, [&](Triangles::const_iterator t) { return number(t) == except; });
  if (!found) return std::nullopt;
  const Kernel::Plane_3 plane = (*found)->supporting_plane();
  const Kernel::Vector_3 normal = plane.orthogonal_vector();
  const double towards = normal * ray.to_vector();
  if (towards == 0) return std::nullopt;  // it runs along the triangle
  const double distance = normal * ((*found)->vertex(0) - to_cgal(from)) / towards;
  return Hit{number(*found), std::max(distance, 0.0)};
}

}  // namespace geocloth
