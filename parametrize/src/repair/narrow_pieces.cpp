// SPDX-License-Identifier: GPL-3.0-or-later
// How wide a piece is at a place: its area within a radius of the place, over twice the radius. That serves strips,
// closed threads (all around) and nets of both alike; several that lie side by side count as one wide one.
#include "repair/narrow_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "mesh/point_math.h"
#include "mesh/triangle_tree.h"
#include "repair/sewn_groups.h"

namespace geocloth {
namespace {

constexpr double kNarrow = 0.5;  // [pixels]
constexpr double kRadius = 1;    // [pixels] within which area is counted
constexpr double kStep = 0.25;   // [pixels] between places where it is counted
constexpr double kBeside = 1;    // [pixels] from the cloth that a strip lies on

/// A bit of a piece's area.
struct Speck {
  Point3 place;
  double area;
  uint32_t number;
};

/// Specks sorted into cubes as wide as the radius.
class SpeckGrid {
 public:
  SpeckGrid(const std::vector<Speck>& specks, double radius) : radius_(radius) {
    entry_.reserve(specks.size());
    for (const Speck& s : specks) entry_.emplace_back(cube(s.place), s);
    std::stable_sort(entry_.begin(), entry_.end(), before);
  }

  /// @param near, is_near  [m] specks that are no further than that from the place are marked
  [[nodiscard]] double area_around(const Point3& place, double near, std::vector<uint8_t>& is_near) const {
    const Cube middle = cube(place);
    double area = 0;
    for (int64_t x = -1; x <= 1; ++x) {
      for (int64_t y = -1; y <= 1; ++y) {
        const Entry low{{middle[0] + x, middle[1] + y, middle[2] - 1}, {}};
        auto e = std::lower_bound(entry_.begin(), entry_.end(), low, before);
        const Entry high{{middle[0] + x, middle[1] + y, middle[2] + 1}, {}};
        for (; e != entry_.end() && !before(high, *e); ++e) {
          const double away = distance(e->second.place, place);
          if (away <= radius_) area += e->second.area;
          if (away <= near) is_near[e->second.number] = 1;
        }
      }
    }
    return area;
  }

 private:
  using Cube = std::array<int64_t, 3>;
  using Entry = std::pair<Cube, Speck>;
  static bool before(const Entry& a, const Entry& b) { return a.first < b.first; }
  [[nodiscard]] Cube cube(const Point3& p) const {
    const auto index = [&](double x) { return static_cast<int64_t>(std::floor(x / radius_)); };
    return {index(p[0]), index(p[1]), index(p[2])};
  }

  double radius_;
  std::vector<Entry> entry_;
};

class NarrowFinder {
 public:
  NarrowFinder(const CleanSurface& clean, double pixel_side, double most_area, std::span<const uint8_t> left_out)
      : clean_(clean),
        pixel_side_(pixel_side),
        left_out_(left_out),
        sewn_(clean, left_out),
        area_(clean.component_count, 0),
        width_(clean.component_count, 0),
        narrow_(clean.component_count, 0) {
    for (size_t t = 0; t < clean.triangle.size(); ++t) area_[clean.component[t]] += area_of(corners(t));
    for (uint32_t c = 0; c < narrow_.size(); ++c) narrow_[c] = left_out[c] == 0 && area_[c] <= most_area ? 1 : 0;
  }

  std::vector<NarrowPieces> run() {
    drop_sewn();
    if (std::all_of(narrow_.begin(), narrow_.end(), [](uint8_t n) { return n == 0; })) return {};
    drop_wide();
    drop_sewn();
    drop_lonely();
    drop_sewn();
    std::vector<NarrowPieces> pieces(narrow_.size());
    for (uint32_t c = 0; c < narrow_.size(); ++c) {
      if (narrow_[c] == 0) continue;
      NarrowPieces& group = pieces[sewn_.group(c)];
      group.component.push_back(c);
      group.area += area_[c];
      group.width = std::max(group.width, width_[c]);
    }
    std::erase_if(pieces, [](const NarrowPieces& p) { return p.component.empty(); });
    return pieces;
  }

 private:
  using Corners = std::array<Point3, 3>;
  [[nodiscard]] Corners corners(size_t t) const {
    const Triangle& k = clean_.triangle[t];
    return {clean_.position[k[0]], clean_.position[k[1]], clean_.position[k[2]]};
  }
  static double area_of(const Corners& t) { return triangle_area(t[0], t[1], t[2]); }

  static void add_speck(const Corners& t, std::vector<Speck>& specks) {
    specks.push_back({(t[0] + t[1] + t[2]) * (1.0 / 3), area_of(t), static_cast<uint32_t>(specks.size())});
  }

  /// Halves triangles until they are no longer than a step. Needles are cut across instead: halves of a needle are as
  /// long as itself, so that their number would grow faster than the length.
  void add_specks(const Corners& t, std::vector<Speck>& specks) const {
    const std::array<double, 3> edge{distance(t[0], t[1]), distance(t[1], t[2]), distance(t[2], t[0])};
    const auto k = static_cast<size_t>(std::max_element(edge.begin(), edge.end()) - edge.begin());
    const double step = kStep * pixel_side_;
    if (edge[k] <= step) return add_speck(t, specks);
    const Point3 &a = t[k], &b = t[(k + 1) % 3], &c = t[(k + 2) % 3];
    if (2 * area_of(t) <= step * edge[k]) return add_slices(a, b, c, edge[k], specks);
    const Point3 middle = (a + b) * 0.5;
    add_specks({a, middle, c}, specks);
    add_specks({middle, b, c}, specks);
  }

  /// Of a triangle that is flat on its longest edge, ab.
  void add_slices(const Point3& a, const Point3& b, const Point3& c, double length, std::vector<Speck>& specks) const {
    const Point3 along = b - a;
    const double foot = std::clamp(dot(c - a, along) / (length * length), 0.0, 1.0);
    const Point3 half_height = (c - (a + along * foot)) * 0.5;
    const double area = area_of({a, b, c});
    // Share of the area on the side of a, and height by that of c.
    const auto beside = [&](double x) {
      return x < foot || foot >= 1 ? x * x / foot : 1 - (1 - x) * (1 - x) / (1 - foot);
    };
    const auto height = [&](double x) { return x < foot ? x / foot : (1 - x) / (1 - foot); };
    const auto count = static_cast<uint32_t>(std::ceil(length / (kStep * pixel_side_)));
    for (uint32_t i = 0; i < count; ++i) {
      const double low = static_cast<double>(i) / count, high = (i + 1.0) / count, middle = (low + high) / 2;
      specks.push_back({a + along * middle + half_height * height(middle), area * (beside(high) - beside(low)),
                        static_cast<uint32_t>(specks.size())});
    }
  }

  void drop_wide() {
    std::vector<std::vector<Speck>> specks(narrow_.size());
    for (size_t t = 0; t < clean_.triangle.size(); ++t) {
      const uint32_t c = clean_.component[t];
      if (narrow_[c] != 0) add_specks(corners(t), specks[c]);
    }
    const double radius = kRadius * pixel_side_;
    for (uint32_t c = 0; c < narrow_.size(); ++c) {
      if (narrow_[c] == 0) continue;
      const SpeckGrid grid(specks[c], radius);
      std::vector<uint8_t> is_near(specks[c].size(), 0);  // a place where it was counted
      for (const Speck& s : specks[c]) {
        if (is_near[s.number] != 0) continue;
        const double area = grid.area_around(s.place, kStep * pixel_side_, is_near);
        width_[c] = std::max(width_[c], area / (2 * radius));
        if (width_[c] > kNarrow * pixel_side_) break;
      }
      if (width_[c] > kNarrow * pixel_side_) narrow_[c] = 0;
    }
  }

  /// Of pieces that are sewn together all are narrow, or none.
  void drop_sewn() {
    std::vector<uint8_t> stays(narrow_.size(), 0);
    for (uint32_t c = 0; c < narrow_.size(); ++c) {
      if (left_out_[c] == 0 && narrow_[c] == 0) stays[sewn_.group(c)] = 1;
    }
    for (uint32_t c = 0; c < narrow_.size(); ++c) {
      if (stays[sewn_.group(c)] != 0) narrow_[c] = 0;
    }
  }

  /// Those that hang about by themselves are cloth.
  void drop_lonely() {
    std::vector<Triangle> rest;
    for (size_t t = 0; t < clean_.triangle.size(); ++t) {
      const uint32_t c = clean_.component[t];
      if (left_out_[c] == 0 && narrow_[c] == 0) rest.push_back(clean_.triangle[t]);
    }
    if (rest.empty() || std::all_of(narrow_.begin(), narrow_.end(), [](uint8_t n) { return n == 0; })) {
      narrow_.assign(narrow_.size(), 0);
      return;
    }
    const TriangleTree tree(clean_.position, rest);
    std::optional<TriangleTree::Place> found;
    for (size_t t = 0; t < clean_.triangle.size(); ++t) {
      const uint32_t c = clean_.component[t];
      for (size_t k = 0; k < 3 && narrow_[c] != 0; ++k) {
        const Point3& p = clean_.position[clean_.triangle[t][k]];
        found = tree.nearest(p, found);
        if (distance(found->point, p) > kBeside * pixel_side_) narrow_[c] = 0;
      }
    }
  }

  const CleanSurface& clean_;
  double pixel_side_;
  std::span<const uint8_t> left_out_;
  SewnGroups sewn_;
  std::vector<double> area_, width_;  // per component
  std::vector<uint8_t> narrow_;
};

}  // namespace

std::vector<NarrowPieces> find_narrow_pieces(const CleanSurface& clean, double pixel_side, double most_area,
                                             std::span<const uint8_t> left_out) {
  return NarrowFinder(clean, pixel_side, most_area, left_out).run();
}

}  // namespace geocloth
