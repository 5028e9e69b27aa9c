// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of a garment that were modelled or exported apart often lie side by side with a gap that no one sees. They are
// different pieces to every program; a person wants to know.
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>

#include "geocloth/parametrize/repair.h"
#include "mesh/point_math.h"
#include "mesh/point_tree.h"
#include "repair/soup.h"

namespace geocloth {
namespace {

/// A side of a triangle on the border, both ways.
struct BorderEdge {
  uint32_t from, to;
  uint32_t apex;  ///< of the triangle
  bool operator<(const BorderEdge& o) const { return from != o.from ? from < o.from : to < o.to; }
};

class CrackFinder {
 public:
  explicit CrackFinder(const CleanSurface& surface)
      : place_(places(surface)), edge_(border_edges(surface)), shortest_(shortest_edges()), tree_(place_, ends()) {}

  Cracks find() const {
    Cracks cracks;
    for (const BorderEdge& e : edge_) {
      if (e.to < e.from) continue;
      ++cracks.of_edges;
      const std::optional<double> gap = gap_beside(e);
      if (!gap) continue;
      ++cracks.edges;
      cracks.widest = std::max(cracks.widest, *gap);
    }
    return cracks;
  }

 private:
  static std::vector<Point3> places(const CleanSurface& surface) {
    std::vector<Point3> place(surface.point_count);
    for (std::size_t v = 0; v < surface.position.size(); ++v) place[surface.point[v]] = surface.position[v];
    return place;
  }

  static std::vector<BorderEdge> border_edges(const CleanSurface& surface) {
    const std::vector<Triangle> triangle = point_triangles(surface);
    std::vector<BorderEdge> edges;
    for (const BorderSide& side : border_sides(triangle)) {
      const Triangle& t = triangle[side.triangle];
      const uint32_t a = t[side.corner], b = t[(side.corner + 1) % 3], apex = t[(side.corner + 2) % 3];
      edges.push_back({a, b, apex});
      edges.push_back({b, a, apex});
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  std::vector<double> shortest_edges() const {
    std::vector<double> shortest(place_.size(), std::numeric_limits<double>::max());
    for (const BorderEdge& e : edge_)
      shortest[e.from] = std::min(shortest[e.from], distance(place_[e.from], place_[e.to]));
    return shortest;
  }

  std::vector<uint32_t> ends() const {
    std::vector<uint32_t> points;
    for (const BorderEdge& e : edge_) {
      if (points.empty() || points.back() != e.from) points.push_back(e.from);
    }
    return points;
  }

  std::vector<uint32_t> beside(uint32_t a) const {
    constexpr double kGap = 0.1;  // of the shortest border edge at either place: folds and slits are wider
    std::vector<uint32_t> found;
    tree_.near_segment(place_[a], place_[a], kGap * shortest_[a], [&](uint32_t b) {
      if (b != a && distance(place_[a], place_[b]) <= kGap * std::min(shortest_[a], shortest_[b])) found.push_back(b);
    });
    found.push_back(a);
    return found;
  }

  /// How far the edges beside this one are, if all of them go on where its triangle ends: the hems of two layers, that
  /// joining would glue together, are no crack.
  std::optional<double> gap_beside(const BorderEdge& e) const {
    std::optional<double> widest;
    const std::vector<uint32_t> last = beside(e.to);
    for (const uint32_t from : beside(e.from)) {
      for (const uint32_t to : last) {
        if (from == e.from && to == e.to) continue;
        const auto [begin, end] = std::equal_range(edge_.begin(), edge_.end(), BorderEdge{from, to, 0});
        for (auto other = begin; other != end; ++other) {
          if (dot(inwards(e), inwards(*other)) >= 0) return std::nullopt;
          widest = std::max(widest.value_or(0),
                            std::max(distance(place_[from], place_[e.from]), distance(place_[to], place_[e.to])));
        }
      }
    }
    return widest;
  }

  /// From the edge to its triangle's apex, square to the edge.
  Point3 inwards(const BorderEdge& e) const {
    const Point3 along = place_[e.to] - place_[e.from], way = place_[e.apex] - place_[e.from];
    return way - along * (dot(way, along) / dot(along, along));
  }

  std::vector<Point3> place_;     // of points
  std::vector<BorderEdge> edge_;  // ascending
  std::vector<double> shortest_;  // per point: of its border edges
  PointTree tree_;                // of the points on the border
};

}  // namespace

Cracks find_cracks(const CleanSurface& surface) {
  return CrackFinder(surface).find();
}

}  // namespace geocloth
