// SPDX-License-Identifier: Apache-2.0
// Cuts as in Zeller 2005, "Cloth Simulation on the GPU": springs that cross a triangle are gone, and so are the faces.
// On a geometry image that is a few bits: nothing is meshed anew, and a cut along a seam only parts rows of the
// split-vertex table. Every point has one side of the blade's plane, also one that lies on it, so that each element is
// judged by the same sides: a point on the plane belongs to where its springs lead, if they all lead one way.

#include "rest/cut_asset.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/vec3d.h"

namespace geocloth {
namespace {

/// A point as near to the plane, in spacings, lies on it.
constexpr double kOnPlane = 0.02;

class Blade {
 public:
  explicit Blade(const std::array<Vec3, 3>& corner)
      : corner_{to_double(corner[0]), to_double(corner[1]), to_double(corner[2])} {
    const Vec3d n = cross(corner_[1] - corner_[0], corner_[2] - corner_[0]);
    normal_ = n * (1 / length(n));
  }

  [[nodiscard]] double distance(const Vec3d& p) const { return dot(p - corner_[0], normal_); }

  /// Whether the foot of a point lies in the triangle. Its border belongs to it, so that triangles side by side leave
  /// nothing between them.
  [[nodiscard]] bool covers(const Vec3d& p) const {
    constexpr double kBorder = 1e-6;  // of a side
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d side = corner_[(i + 1) % 3] - corner_[i];
      if (dot(cross(side, p - corner_[i]), normal_) < -kBorder * dot(side, side)) return false;
    }
    return true;
  }

  /// Whether one of its sides goes through another triangle.
  [[nodiscard]] bool pierces(const std::array<Vec3d, 3>& t) const {
    for (size_t i = 0; i < 3; ++i)
      if (goes_through(corner_[i], corner_[(i + 1) % 3], t)) return true;
    return false;
  }

 private:
  static bool goes_through(const Vec3d& a, const Vec3d& b, const std::array<Vec3d, 3>& t) {
    const Vec3d n = cross(t[1] - t[0], t[2] - t[0]);
    const double da = dot(a - t[0], n), db = dot(b - t[0], n);
    if (da == db || (da > 0) == (db > 0)) return false;
    const Vec3d q = a + (b - a) * (da / (da - db));
    for (size_t i = 0; i < 3; ++i)
      if (dot(cross(t[(i + 1) % 3] - t[i], q - t[i]), n) < 0) return false;
    return true;
  }

  std::array<Vec3d, 3> corner_;
  Vec3d normal_;
};

/// Points with the side of the blade's plane that each is on.
class Sides {
 public:
  Sides(const Blade& blade, size_t count) : blade_(blade), points_(count), distance_(count), above_(count) {}

  void place(uint32_t i, const Vec3& p) {
    points_[i] = to_double(p);
    distance_[i] = blade_.distance(points_[i]);
    above_[i] = distance_[i] >= 0;
  }
  void set_above(uint32_t i, bool above) { above_[i] = above; }

  [[nodiscard]] const Vec3d& at(uint32_t i) const { return points_[i]; }
  [[nodiscard]] double distance(uint32_t i) const { return distance_[i]; }
  [[nodiscard]] bool above(uint32_t i) const { return above_[i]; }
  [[nodiscard]] bool covered(uint32_t i) const { return blade_.covers(points_[i]); }

  /// Whether the blade is between two points.
  [[nodiscard]] bool severed(uint32_t a, uint32_t b) const {
    if (above_[a] == above_[b]) return false;
    const double da = std::abs(distance_[a]), db = std::abs(distance_[b]);
    const double share = da + db > 0 ? da / (da + db) : 0.5;
    return blade_.covers(points_[a] + (points_[b] - points_[a]) * share);
  }

  /// Whether the blade goes through a triangle, or into it.
  [[nodiscard]] bool crossed(const Triangle& t) const {
    if (above_[t[0]] == above_[t[1]] && above_[t[1]] == above_[t[2]]) return false;
    return severed(t[0], t[1]) || severed(t[1], t[2]) || severed(t[2], t[0]) ||
           blade_.pierces({points_[t[0]], points_[t[1]], points_[t[2]]});
  }

 private:
  const Blade& blade_;
  std::vector<Vec3d> points_;
  std::vector<double> distance_;
  std::vector<bool> above_;
};

uint32_t end_of(const ClothAsset& asset, uint32_t pixel, uint32_t component) {
  return static_cast<uint32_t>(int64_t{pixel} + kSpringOffset[component][0] +
                               int64_t{asset.width} * kSpringOffset[component][1]);
}

/// Calls visit(pixel, component, other end) for all springs.
template <class Visit>
void for_springs(const ClothAsset& asset, const Visit& visit) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    for (uint32_t c = 0; c < kSpringCount; ++c)
      if ((asset.spring_mask[p] & (1U << c)) != 0) visit(p, c, end_of(asset, p, c));
}

Sides sides_of_pixels(const ClothAsset& asset, const ClothPose& pose, const Blade& blade) {
  Sides sides(blade, asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) sides.place(p, pose.position[p]);

  const double near = kOnPlane * static_cast<double>(asset.spacing * pose.scale);
  const auto on_plane = [&](uint32_t p) { return std::abs(sides.distance(p)) <= near; };
  std::vector<bool> leads_up(asset.pixel_count()), leads_down(asset.pixel_count());
  for_springs(asset, [&](uint32_t a, uint32_t component, uint32_t b) {
    if (component >= 4) return;
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
      if (!on_plane(from) || on_plane(to)) continue;
      (sides.distance(to) > 0 ? leads_up : leads_down)[from] = true;
    }
  });
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && on_plane(p)) sides.set_above(p, leads_up[p] || !leads_down[p]);
  return sides;
}

class Cutter {
 public:
  Cutter(const ClothAsset& asset, const ClothPose& pose, const std::array<Vec3, 3>& triangle)
      : old_(asset), pose_(pose), blade_(triangle), pixels_(sides_of_pixels(asset, pose, blade_)) {}

  CutCloth run() {
    cut_.spring_mask = kept_springs();
    cut_.cell = kept_cells();
    cut_.seam_bends = kept_seam_bends();
    cut_.splits = kept_copies();
    if (result_ == CutResult{}) return {};
    cut_source();
    return {std::make_shared<const ClothAsset>(std::move(cut_)), result_};
  }

 private:
  [[nodiscard]] std::vector<uint8_t> kept_springs() {
    std::vector<uint8_t> mask = old_.spring_mask;
    for_springs(old_, [&](uint32_t a, uint32_t component, uint32_t b) {
      const uint32_t middle = component >= 4 ? end_of(old_, a, component - 4) : a;
      if (!pixels_.severed(a, b) && !pixels_.severed(a, middle) && !pixels_.severed(middle, b)) return;
      mask[a] = static_cast<uint8_t>(mask[a] & ~(1U << component));
      ++result_.springs;
    });
    return mask;
  }

  [[nodiscard]] std::vector<uint8_t> kept_cells() {
    std::vector<uint8_t> cell = old_.cell;
    for (uint32_t p = 0; p < old_.pixel_count(); ++p) {
      const CellTriangles triangles = cell_triangles(old_, p);
      if (std::none_of(triangles.begin(), triangles.end(), [&](const Triangle& t) { return pixels_.crossed(t); })) {
        continue;
      }
      cell[p] = 0;
      ++result_.cells;
    }
    return cell;
  }

  [[nodiscard]] std::vector<SeamBend> kept_seam_bends() {
    std::vector<SeamBend> bends;
    for (const SeamBend& bend : old_.seam_bends) {
      if (pixels_.severed(bend.a, bend.middle) || pixels_.severed(bend.middle, bend.b)) {
        ++result_.springs;
      } else {
        bends.push_back(bend);
      }
    }
    return bends;
  }

  /// Copies lie in one place, so those on different sides lie on the plane: there the cut runs along a seam.
  [[nodiscard]] SplitVertexTable kept_copies() {
    std::vector<std::vector<uint32_t>> rows;
    for (uint32_t r = 0; r < old_.splits.rows(); ++r) {
      const std::span<const uint32_t> copies = old_.splits.copies(r);
      std::vector<uint32_t> one(copies.begin(), copies.end()), other;
      if (pixels_.covered(one.front())) {
        const auto part = std::stable_partition(
            one.begin(), one.end(), [&](uint32_t p) { return pixels_.above(p) == pixels_.above(copies.front()); });
        other.assign(part, one.end());
        one.erase(part, one.end());
      }
      if (!other.empty()) ++result_.parted_points;
      for (std::vector<uint32_t>* row : {&one, &other})
        if (row->size() > 1) rows.push_back(std::move(*row));
    }
    std::sort(rows.begin(), rows.end());
    SplitVertexTable table;
    for (const std::vector<uint32_t>& row : rows) {
      if (table.offset.empty()) table.offset.push_back(0);
      table.pixel.insert(table.pixel.end(), row.begin(), row.end());
      table.offset.push_back(static_cast<uint32_t>(table.pixel.size()));
    }
    return table;
  }

  void cut_source() {
    std::vector<Vec3> vertex;
    evaluate_binding(old_, pose_.position, pose_.normal, vertex, pose_.scale);
    Sides vertices(blade_, vertex.size());
    row_of_ = split_rows(cut_);
    for (uint32_t v = 0; v < vertex.size(); ++v) {
      const uint32_t main = main_pixel(old_.binding[v]);
      vertices.place(v, vertex[v]);
      vertices.set_above(v, pixels_.above(main));
      const auto& pixel = old_.binding[v].pixel;
      if (std::any_of(pixel.begin(), pixel.end(), [&](uint32_t p) { return pixels_.severed(main, p); })) {
        cut_.binding[v] = bound_on_one_side(vertex[v], main);
      }
    }
    drop_triangles(vertices);
  }

  /// Those that are still together with it.
  [[nodiscard]] std::vector<uint32_t> copies_of(uint32_t pixel) const {
    const uint32_t row = row_of_[pixel];
    if (row == kNoPixel) return {pixel};
    const std::span<const uint32_t> copies = cut_.splits.copies(row);
    return {copies.begin(), copies.end()};
  }

  static uint32_t main_pixel(const Binding& binding) {
    const auto largest = std::max_element(binding.weight.begin(), binding.weight.end());
    return binding.pixel[static_cast<size_t>(largest - binding.weight.begin())];
  }

  void drop_triangles(const Sides& vertices) {
    cut_.source.triangle.clear();
    cut_.source.part.clear();
    for (SourcePart part : old_.source.part) {
      const auto begin = old_.source.triangle.begin() + part.first_triangle;
      part.first_triangle = static_cast<uint32_t>(cut_.source.triangle.size());
      std::copy_if(begin, begin + part.triangle_count, std::back_inserter(cut_.source.triangle),
                   [&](const Triangle& t) { return !vertices.crossed(t); });
      part.triangle_count = static_cast<uint32_t>(cut_.source.triangle.size()) - part.first_triangle;
      if (part.triangle_count > 0) cut_.source.part.push_back(part);
    }
  }

  /// To the triangle at the main pixel that reaches the vertex best, or to that pixel alone.
  [[nodiscard]] Binding bound_on_one_side(const Vec3& vertex, uint32_t main) const {
    constexpr double kFarthest = -2;  // smallest weight: two cells outside the triangle
    Binding best{{main, main, main}, {1, 0, 0}, {}};
    double nearest = kFarthest;
    for (const uint32_t p : copies_of(main)) {
      for (const uint32_t corner : {p, p - 1, p - cut_.width, p - cut_.width - 1}) {
        if (corner >= cut_.pixel_count()) continue;  // above or left of the image
        for (const Triangle& t : cell_triangles(cut_, corner)) {
          const std::optional<std::array<double, 3>> weight = weights_in(t, to_double(vertex));
          if (!weight || std::find(t.begin(), t.end(), p) == t.end()) continue;
          const double reach = std::min({(*weight)[0], (*weight)[1], (*weight)[2]});
          if (!(reach > nearest)) continue;
          nearest = reach;
          const auto w1 = static_cast<float>((*weight)[1]), w2 = static_cast<float>((*weight)[2]);
          best = {t, {1 - w1 - w2, w1, w2}, {}};
        }
      }
    }
    best.offset = binding_offset(best, pose_.position, pose_.normal, vertex, pose_.scale);
    return best;
  }

  /// Barycentric weights of a point's foot in the plane of a triangle.
  [[nodiscard]] std::optional<std::array<double, 3>> weights_in(const Triangle& t, const Vec3d& p) const {
    const Vec3d a = pixels_.at(t[0]), u = pixels_.at(t[1]) - a, v = pixels_.at(t[2]) - a, n = cross(u, v);
    const double area2 = dot(n, n);
    if (!(area2 > 0)) return {};
    const double w1 = dot(cross(p - a, v), n) / area2, w2 = dot(cross(u, p - a), n) / area2;
    return std::array{1 - w1 - w2, w1, w2};
  }

  const ClothAsset& old_;
  const ClothPose& pose_;
  Blade blade_;
  Sides pixels_;
  ClothAsset cut_ = old_;
  std::vector<uint32_t> row_of_;  ///< of the cut asset's split-vertex table, kNoPixel for a single pixel
  CutResult result_;
};

}  // namespace

CutCloth cut_asset(const ClothAsset& asset, const ClothPose& pose, const std::array<Vec3, 3>& blade) {
  return Cutter(asset, pose, blade).run();
}

}  // namespace geocloth
