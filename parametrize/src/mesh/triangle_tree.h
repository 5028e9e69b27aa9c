// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A triangle mesh that is asked for the place nearest to a point.
class TriangleTree {
 public:
  /// Keeps triangles that have an area; the others lie on the edges of their neighbours.
  /// @throws Error(invalid_data) when no triangle has one
  TriangleTree(std::span<const Point3> position, std::span<const Triangle> triangle);
  ~TriangleTree();
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;

  struct Place {
    uint32_t triangle;  ///< index into the triangles given
    Point3 point;       ///< nearest point of the mesh [m]
  };
  /// @param near  what this tree gave for a point nearby, if anything: the search is faster then
  [[nodiscard]] Place nearest(const Point3& p, const std::optional<Place>& near = std::nullopt) const;

  struct Hit {
    uint32_t triangle;  ///< index into the triangles given
    double distance;    ///< [m]
  };
  /// Where a ray first meets the mesh.
  /// @param direction  of unit length
  /// @param except     a triangle that it passes through, kNone: none
  [[nodiscard]] std::optional<Hit> first_hit(const Point3& from, const Point3& direction, uint32_t except) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace geocloth
