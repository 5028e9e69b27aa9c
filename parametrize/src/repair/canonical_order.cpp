// SPDX-License-Identifier: GPL-3.0-or-later
//
// A manifold component is numbered by breadth-first search over its triangles once a first triangle and its first
// corner are chosen. They are chosen by distances and areas of the surface without its symmetries (uneven.h), which
// motion leaves alone, with a tolerance for rounding; coordinates decide only where that leaves equals.

#include "repair/canonical_order.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/uneven.h"

namespace geocloth {
namespace {

constexpr double kEqual = 1e-6;  // relative

struct Start {
  uint32_t half_edge;
  double area;    // of the component
  Point3 corner;  // where the half-edge begins
};

class Renumbering {
 public:
  Renumbering(CleanSurface& surface, const Upright& upright)
      : surface_(surface), opposite_(opposite_half_edges(surface.triangle)), seen_(upright.apply(surface.position)) {
    seen_ = uneven(seen_, surface.triangle).apply(seen_);
  }

  void apply() {
    std::vector<std::vector<uint32_t>> triangles(surface_.component_count);
    for (uint32_t t = 0; t < surface_.triangle.size(); ++t) triangles[surface_.component[t]].push_back(t);
    std::vector<Start> starts;
    double largest = 0;
    for (const std::vector<uint32_t>& part : triangles) {
      starts.push_back(start_of(part));
      largest = std::max(largest, starts.back().area);
    }
    // Large components first; equal ones (left and right) by coordinates.
    const auto rank = [&](const Start& s) {
      return std::tuple(-std::llround(s.area / largest / kEqual), s.corner, s.half_edge);
    };
    std::sort(starts.begin(), starts.end(), [&](const Start& a, const Start& b) { return rank(a) < rank(b); });
    for (const Start& s : starts) number_from(s.half_edge);
    renumber();
  }

 private:
  [[nodiscard]] const Point3& at(uint32_t h) const { return seen_[tail(surface_.triangle, h)]; }
  [[nodiscard]] double edge_length(uint32_t h) const { return distance(at(h), at(next_half_edge(h))); }

  /// Corners in the order of their coordinates, so that sums over them do not depend on which is first.
  [[nodiscard]] std::array<Point3, 3> sorted_corners(uint32_t t) const {
    std::array<Point3, 3> p{at(3 * t), at(3 * t + 1), at(3 * t + 2)};
    std::sort(p.begin(), p.end());
    return p;
  }

  [[nodiscard]] Start start_of(const std::vector<uint32_t>& part) const {
    std::vector<double> area(part.size());
    std::vector<Point3> middle(part.size());
    double whole = 0;
    Point3 centre{0, 0, 0};
    for (size_t i = 0; i < part.size(); ++i) {
      const auto [a, b, c] = sorted_corners(part[i]);
      area[i] = triangle_area(a, b, c);
      middle[i] = (a + b + c) * (1.0 / 3);
      whole += area[i];
      centre = centre + middle[i] * area[i];
    }
    centre = centre * (1 / whole);
    // The triangle farthest from the centre; of several the largest; then the first by coordinates.
    std::vector<size_t> left(part.size());
    for (size_t i = 0; i < left.size(); ++i) left[i] = i;
    const auto keep_largest = [&](const auto& value) {
      double most = 0;
      for (const size_t i : left) most = std::max(most, value(i));
      left.erase(std::remove_if(left.begin(), left.end(), [&](size_t i) { return value(i) < (1 - kEqual) * most; }),
                 left.end());
    };
    keep_largest([&](size_t i) { return distance(middle[i], centre); });
    keep_largest([&](size_t i) { return area[i]; });
    const uint32_t first = part[*std::min_element(left.begin(), left.end(), [&](size_t a, size_t b) {
      return sorted_corners(part[a]) < sorted_corners(part[b]);
    })];
    uint32_t longest = 3 * first;
    for (uint32_t h = 3 * first + 1; h < 3 * first + 3; ++h) {
      const double more = edge_length(h) - edge_length(longest);
      const double tolerance = kEqual * edge_length(longest);
      if (more > tolerance || (more > -tolerance && at(h) < at(longest))) longest = h;
    }
    return {longest, whole, at(longest)};
  }

  void number_from(uint32_t start) {
    if (placed_.empty()) placed_.assign(surface_.triangle.size(), 0);
    size_t next = first_corner_.size();
    first_corner_.push_back(start);
    placed_[start / 3] = 1;
    for (; next < first_corner_.size(); ++next) {
      uint32_t h = first_corner_[next];
      for (int i = 0; i < 3; ++i, h = next_half_edge(h)) {
        const uint32_t o = opposite_[h];
        if (o == kNone || placed_[o / 3] != 0) continue;
        placed_[o / 3] = 1;
        first_corner_.push_back(o);
      }
    }
  }

  template <typename T>
  void rearrange_corners(std::vector<std::array<T, 3>>& per_triangle) const {
    if (per_triangle.empty()) return;
    std::vector<std::array<T, 3>> result;
    result.reserve(per_triangle.size());
    for (const uint32_t h : first_corner_) {
      const std::array<T, 3>& k = per_triangle[h / 3];
      result.push_back({k[h % 3], k[(h + 1) % 3], k[(h + 2) % 3]});
    }
    per_triangle = std::move(result);
  }

  void renumber() {
    rearrange_corners(surface_.triangle);
    rearrange_corners(surface_.uv);
    std::vector<uint32_t> component, source;
    std::vector<uint32_t> new_component(surface_.component_count, kNone);
    uint32_t components = 0;
    for (const uint32_t h : first_corner_) {
      uint32_t& c = new_component[surface_.component[h / 3]];
      if (c == kNone) c = components++;
      component.push_back(c);
      source.push_back(surface_.source_triangle[h / 3]);
    }
    surface_.component = std::move(component);
    surface_.source_triangle = std::move(source);

    std::vector<uint32_t> new_vertex(surface_.position.size(), kNone), new_point(surface_.point_count, kNone);
    std::vector<Point3> position;
    std::vector<uint32_t> point;
    uint32_t points = 0;
    const auto point_number = [&](uint32_t p) {
      if (new_point[p] == kNone) new_point[p] = points++;
      return new_point[p];
    };
    const auto take = [&](uint32_t v) {
      new_vertex[v] = static_cast<uint32_t>(position.size());
      position.push_back(surface_.position[v]);
      point.push_back(point_number(surface_.point[v]));
    };
    for (Triangle& t : surface_.triangle) {
      for (uint32_t& v : t) {
        if (new_vertex[v] == kNone) take(v);
        v = new_vertex[v];
      }
    }
    for (uint32_t v = 0; v < new_vertex.size(); ++v) {
      if (new_vertex[v] == kNone) take(v);
    }
    surface_.position = std::move(position);
    surface_.point = std::move(point);
    for (uint32_t& p : surface_.source_point) {
      if (p != kNone) p = point_number(p);
    }
  }

  CleanSurface& surface_;
  std::vector<uint32_t> opposite_;
  std::vector<Point3> seen_;  // the positions, upright, less their symmetries
  std::vector<uint8_t> placed_;
  std::vector<uint32_t> first_corner_;  // in the new order: the half-edge whose tail becomes the first corner
};

}  // namespace

void put_in_canonical_order(CleanSurface& surface, const Upright& upright) {
  Renumbering(surface, upright).apply();
}

}  // namespace geocloth
