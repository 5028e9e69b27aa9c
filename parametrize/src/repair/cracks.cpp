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

/// Edges of one triangle, or of two with an edge in common: of a spike or a narrow strip, with the cloth between them.
bool are_of_one_strip(const BorderEdge& e, const BorderEdge& other) {
  const std::array<uint32_t, 3> points{e.from, e.to, e.apex};
  return std::ranges::count_if(points,
                               [&](uint32_t p) { return p == other.from || p == other.to || p == other.apex; }) >= 2;
}

constexpr double kGap = 0.1;  // of the shortest border edge at either place: folds and slits are wider

constexpr double kLayers = 0.7;  // cosine between triangles that lie on each other, more or less

class CrackFinder {
 public:
  explicit CrackFinder(const CleanSurface& surface)
      : place_(places(surface)), edge_(border_edges(surface)), shortest_(shortest_edges()), tree_(place_, ends()) {}

  Cracks find() {
    constexpr double kMost = 0.25;  // of the border; less of what opens so little may be the rims of thick cloth
    look_along_borders();
    Cracks cracks, acute;
    for (std::size_t i = 0; i < edge_.size(); ++i) {
      if (edge_[i].to < edge_[i].from) continue;
      ++cracks.of_edges;
      const std::optional<Gap> gap = gap_beside(i);
      if (!gap) continue;
      Cracks& sum = gap->is_acute ? acute : cracks;
      ++sum.edges;
      sum.widest = std::max(sum.widest, gap->width);
    }
    if (acute.edges > kMost * cracks.of_edges) {
      cracks.edges += acute.edges;
      cracks.widest = std::max(cracks.widest, acute.widest);
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
    std::vector<uint32_t> found;
    tree_.near_segment(place_[a], place_[a], kGap * shortest_[a], [&](uint32_t b) {
      if (b != a && distance(place_[a], place_[b]) <= kGap * std::min(shortest_[a], shortest_[b])) found.push_back(b);
    });
    found.push_back(a);
    return found;
  }

  /// Beside a border edge.
  struct Gap {
    double width;
    bool is_acute;  ///< the triangles beyond are less than a right angle apart
  };

  /// The gap to the edges beside this one, if all of them go on where its triangle ends: the hems of two layers, that
  /// joining would glue together, are no crack.
  std::optional<Gap> gap_beside(std::size_t i) const {
    const BorderEdge& e = edge_[i];
    std::optional<Gap> widest;
    const std::vector<uint32_t> last = beside(e.to);
    for (const uint32_t from : beside(e.from)) {
      for (const uint32_t to : last) {
        if (from == e.from && to == e.to) continue;
        const auto [begin, end] = std::equal_range(edge_.begin(), edge_.end(), BorderEdge{from, to, 0});
        for (auto other = begin; other != end; ++other) {
          if (are_of_one_strip(e, *other)) continue;
          const double cosine = cosine_between(e, *other);
          if (cosine >= kLayers) return std::nullopt;
          if (!widest) widest = Gap{0, false};
          widest->is_acute = widest->is_acute || cosine >= 0;
          widest->width = std::max(
              widest->width, std::max(distance(place_[from], place_[e.from]), distance(place_[to], place_[e.to])));
        }
      }
    }
    return widest ? widest : gap_along(i);
  }

  /// Between the triangles at two edges beside each other; 1 where they lie on each other.
  double cosine_between(const BorderEdge& e, const BorderEdge& other) const {
    const Point3 a = inwards(e), b = inwards(other);
    return dot(a, b) / (length(a) * length(b));
  }

  /// From the edge to its triangle's apex, square to the edge.
  Point3 inwards(const BorderEdge& e) const {
    const Point3 along = place_[e.to] - place_[e.from], way = place_[e.apex] - place_[e.from];
    return way - along * (dot(way, along) / dot(along, along));
  }

  // --- borders with other vertices -----------------------------------------------------------------------------------

  static constexpr std::array<double, 3> kSample{0.25, 0.5, 0.75};  // along an edge

  /// What of other borders is beside an edge.
  struct Beside {
    std::array<bool, kSample.size()> met{};  ///< at its samples
    double cosine = -1;                      ///< the largest between its triangle and theirs
  };

  static double distance_from(const Point3& a, const Point3& b, const Point3& p) {
    return distance(p, a + (b - a) * std::clamp(foot_on(a, b, p).at, 0.0, 1.0));
  }

  /// Asks every edge for the vertices and the samples of edges beside it.
  void look_along_borders() {
    of_edge_.resize(edge_.size());
    nearest_.assign(place_.size(), std::numeric_limits<double>::max());
    std::vector<Point3> at = place_;
    std::vector<uint32_t> all = ends(), edge_of;
    for (uint32_t i = 0; i < edge_.size(); ++i) {
      const BorderEdge& e = edge_[i];
      if (e.to < e.from) continue;
      for (const double t : kSample) {
        all.push_back(static_cast<uint32_t>(at.size()));
        at.push_back(place_[e.from] + (place_[e.to] - place_[e.from]) * t);
        edge_of.push_back(i);
      }
    }
    const PointTree tree(at, std::move(all));
    for (const BorderEdge& f : edge_) {
      if (f.to < f.from) continue;
      const Point3 &a = place_[f.from], &b = place_[f.to];
      const double most = kGap * std::min(shortest_[f.from], shortest_[f.to]);
      tree.near_segment(a, b, most, [&](uint32_t p) {
        const double d = distance_from(a, b, at[p]);
        if (d > most) return;
        if (p >= place_.size()) {
          const auto sample = p - static_cast<uint32_t>(place_.size());
          note(f, d, edge_of[sample], sample % kSample.size());
        } else if (p != f.from && p != f.to && d <= kGap * shortest_[p]) {
          nearest_[p] = std::min(nearest_[p], d);
        }
      });
    }
  }

  void note(const BorderEdge& f, double d, uint32_t i, std::size_t sample) {
    const BorderEdge& e = edge_[i];
    if (are_of_one_strip(e, f) || d > kGap * std::min(shortest_[e.from], shortest_[e.to])) return;
    of_edge_[i].met[sample] = true;
    of_edge_[i].cosine = std::max(of_edge_[i].cosine, cosine_between(e, f));
  }

  /// How far the ends of an edge are from borders that lie all along it with other vertices.
  std::optional<Gap> gap_along(std::size_t i) const {
    const auto& [met, cosine] = of_edge_[i];
    if (cosine >= kLayers || std::find(met.begin(), met.end(), false) != met.end()) return std::nullopt;
    double widest = 0;
    for (const uint32_t end : {edge_[i].from, edge_[i].to}) {
      if (nearest_[end] < std::numeric_limits<double>::max())
        widest = std::max(widest, nearest_[end]);  // or it is joined
    }
    if (!(widest > 0)) return std::nullopt;  // both ends are joined: sides of a spike
    return Gap{widest, cosine >= 0};
  }

  std::vector<Point3> place_;     // of points
  std::vector<BorderEdge> edge_;  // ascending
  std::vector<double> shortest_;  // per point: of its border edges
  PointTree tree_;                // of the points on the border
  std::vector<Beside> of_edge_;
  std::vector<double> nearest_;  // per point: how far the nearest edge of another border is
};

}  // namespace

Cracks find_cracks(const CleanSurface& surface) {
  return CrackFinder(surface).find();
}

}  // namespace geocloth
