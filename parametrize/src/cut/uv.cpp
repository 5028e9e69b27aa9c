// SPDX-License-Identifier: GPL-3.0-or-later
// Garments made in a pattern program carry their sewing pattern as texture coordinates; others carry an atlas that cuts
// and stretches the cloth for the painter's sake. The two are told apart by distortion (symmetric Dirichlet, Smith and
// Schaefer 2015), by scale (a pattern has one for all pieces) and by the number of pieces.
#include "geocloth/parametrize/uv.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geocloth/asset/disjoint_sets.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSamePlace = 1e-5;     // of the extent of all texture coordinates: files round them
constexpr double kMostEnergy = 4.5;     // what can still be called the shape of the cloth
constexpr double kPatternEnergy = 4.1;  // of a sewing pattern
constexpr double kFragmentFaces = 8;    // mean faces of a piece; below, the coordinates are in fragments
constexpr double kPatternFaces = 50;    // the same for a sewing pattern
constexpr double kStray = 0.01;         // share of a patch up to which triangles that lie the other way up are mistakes

/// Sums over triangles whose quotient is the best scale and whose product the energy at it: with the plane scaled by s
/// the energy is s^2 `stretch` + `shrink` / s^2.
struct Distortion {
  double area = 0, stretch = 0, shrink = 0;

  void add(const Distortion& other) {
    area += other.area;
    stretch += other.stretch;
    shrink += other.shrink;
  }
  [[nodiscard]] double scale() const { return std::pow(shrink / stretch, 0.25); }
  [[nodiscard]] double energy() const {
    const double e = 2 * std::sqrt(stretch) * std::sqrt(shrink) / area;
    return std::isfinite(e) ? e : std::numeric_limits<double>::infinity();
  }
};

double area_in_uv(const std::array<Point2, 3>& t) {
  return 0.5 * signed_area_twice(t[0], t[1], t[2]);
}

Distortion distortion(const std::array<Point3, 3>& p, const std::array<Point2, 3>& t) {
  const Point3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  const double l = length(e1), x = dot(e1, e2) / l, y = length(cross(e1, e2)) / l;
  Distortion result;
  result.area = 0.5 * l * y;
  double squares = 0;
  for (size_t k = 0; k < 2; ++k) {
    const double along = (t[1][k] - t[0][k]) / l, across = (t[2][k] - t[0][k] - along * x) / y;
    squares += along * along + across * across;
  }
  const double determinant = area_in_uv(t) / result.area;
  result.stretch = result.area * squares;
  result.shrink = result.area * squares / (determinant * determinant);
  return result;
}

class PatternReader {
 public:
  explicit PatternReader(const CleanSurface& surface)
      : surface_(surface), opposite_(opposite_half_edges(surface.triangle)) {}

  UvPattern read() {
    if (surface_.uv.empty()) {
      pattern_.refusal = "the mesh has no texture coordinates";
      return std::move(pattern_);
    }
    measure_extent();
    find_islands();
    measure_islands();
    judge();
    return std::move(pattern_);
  }

 private:
  void measure_extent() {
    Point2 low = surface_.uv[0][0], high = low;
    for (const auto& corners : surface_.uv) {
      for (const Point2& p : corners) {
        for (size_t k = 0; k < 2; ++k) {
          low[k] = std::min(low[k], p[k]);
          high[k] = std::max(high[k], p[k]);
        }
      }
    }
    tolerance_ = kSamePlace * std::hypot(high[0] - low[0], high[1] - low[1]);
  }

  [[nodiscard]] bool agree(const Point2& a, const Point2& b) const {
    return std::abs(a[0] - b[0]) <= tolerance_ && std::abs(a[1] - b[1]) <= tolerance_;
  }
  [[nodiscard]] const Point2& uv_of(uint32_t half_edge) const { return surface_.uv[half_edge / 3][half_edge % 3]; }
  [[nodiscard]] bool continuous(uint32_t h) const {
    const uint32_t g = opposite_[h];
    return agree(uv_of(h), uv_of(next_half_edge(g))) && agree(uv_of(next_half_edge(h)), uv_of(g));
  }

  /// Patches are continuous in uv; where both faces of the cloth show in one (halves that share a texture), its sides
  /// are islands of their own. A few triangles that a file's rounding flipped do not make a side.
  void find_islands() {
    const auto triangles = static_cast<uint32_t>(surface_.triangle.size());
    DisjointSets patches(triangles), islands(triangles);
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      if (opposite_[h] != kNone && h < opposite_[h] && continuous(h)) patches.join(h / 3, opposite_[h] / 3);
    }
    std::vector<double> up(triangles, 0), all(triangles, 0);  // [m^2] per patch, by the number of its set
    for (uint32_t t = 0; t < triangles; ++t) {
      const auto& [a, b, c] = surface_.triangle[t];
      const double area = triangle_area(surface_.position[a], surface_.position[b], surface_.position[c]);
      all[patches.find(t)] += area;
      if (face_up(t)) up[patches.find(t)] += area;
    }
    const auto two_sided = [&](uint32_t patch) {
      return up[patch] > kStray * all[patch] && up[patch] < (1 - kStray) * all[patch];
    };
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      const uint32_t g = opposite_[h];
      if (g == kNone || g < h) continue;
      const bool folded = face_up(h / 3) != face_up(g / 3) && two_sided(patches.find(h / 3));
      if (continuous(h) && !folded) {
        islands.join(h / 3, g / 3);
      } else {
        pattern_.seam.push_back({tail(surface_.triangle, h), head(surface_.triangle, h)});
      }
    }
    std::vector<uint32_t> number(triangles, kNone);
    for (uint32_t t = 0; t < triangles; ++t) {
      uint32_t& island = number[islands.find(t)];
      if (island == kNone) {
        const uint32_t patch = patches.find(t);
        island = static_cast<uint32_t>(pattern_.island.size());
        pattern_.island.push_back({.mirrored = two_sided(patch) ? !face_up(t) : up[patch] < 0.5 * all[patch]});
        patch_area_.push_back(all[patch]);
      }
      pattern_.island_of.push_back(island);
    }
  }

  [[nodiscard]] bool face_up(uint32_t t) const { return area_in_uv(surface_.uv[t]) > 0; }
  [[nodiscard]] bool is_flipped(uint32_t t) const {
    const double area = area_in_uv(surface_.uv[t]);
    return pattern_.island[pattern_.island_of[t]].mirrored ? area >= 0 : area <= 0;
  }

  void measure_islands() {
    std::vector<Distortion> of_island(pattern_.island.size());
    std::vector<uint32_t> flipped_of(pattern_.island.size());
    Distortion all;
    double flipped_area = 0;
    for (uint32_t t = 0; t < surface_.triangle.size(); ++t) {
      const auto& [a, b, c] = surface_.triangle[t];
      UvPattern::Island& island = pattern_.island[pattern_.island_of[t]];
      const Distortion d =
          distortion({surface_.position[a], surface_.position[b], surface_.position[c]}, surface_.uv[t]);
      island.area += d.area;
      ++island.faces;
      if (is_flipped(t)) {
        ++flipped_;
        ++flipped_of[pattern_.island_of[t]];
        flipped_area += d.area;
        continue;
      }
      of_island[pattern_.island_of[t]].add(d);
      all.add(d);
    }
    flipped_share_ = flipped_area / (flipped_area + all.area);
    std::vector<bool> is_flipped_piece(of_island.size(), false);
    for (size_t i = 0; i < of_island.size(); ++i) {
      UvPattern::Island& island = pattern_.island[i];
      island.scale = of_island[i].scale();
      island.energy = of_island[i].energy();
      const bool all_flipped = of_island[i].area == 0;
      if (!all_flipped) own_scale_energy_ += island.energy * of_island[i].area / all.area;
      if (!all_flipped && island.area >= kStray * patch_area_[i]) continue;
      flipped_pieces_ = true;
      flipped_ += island.faces - flipped_of[i];
      is_flipped_piece[i] = true;
    }
    for (uint32_t t = 0; t < surface_.triangle.size() && first_flipped_ == kNone; ++t) {
      if (is_flipped(t) || is_flipped_piece[pattern_.island_of[t]]) first_flipped_ = t;
    }
    pattern_.energy = all.energy();
  }

  [[nodiscard]] double edge_length(uint32_t a, uint32_t b) const {
    return distance(surface_.position[a], surface_.position[b]);
  }

  void judge() {
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      if (opposite_[h] == kNone)
        pattern_.outline += edge_length(tail(surface_.triangle, h), head(surface_.triangle, h));
    }
    for (const auto& [a, b] : pattern_.seam) pattern_.outline += 2 * edge_length(a, b);
    const double faces = static_cast<double>(surface_.triangle.size()) / static_cast<double>(pattern_.island.size());
    const auto number = [](double x) {
      char text[32];
      std::snprintf(text, sizeof text, "%.3g", x);
      return std::string(text);
    };
    if (flipped_share_ > kStray || flipped_pieces_) {
      pattern_.refusal = std::to_string(flipped_) + " triangles are flipped or without area in the texture coordinates";
      if (first_flipped_ != kNone) {
        const auto& [a, b, c] = surface_.triangle[first_flipped_];
        const Point3 middle = (surface_.position[a] + surface_.position[b] + surface_.position[c]) * (1.0 / 3);
        pattern_.refusal +=
            ", one of them at (" + number(middle[0]) + ", " + number(middle[1]) + ", " + number(middle[2]) + ") m";
      }
    } else if (faces < kFragmentFaces && pattern_.island.size() > surface_.component_count) {
      pattern_.refusal = "the texture coordinates are in " + std::to_string(pattern_.island.size()) + " fragments of " +
                         number(faces) + " triangles on average";
    } else if (!(own_scale_energy_ <= kMostEnergy)) {
      pattern_.refusal = "the texture coordinates distort the cloth too much (symmetric Dirichlet energy " +
                         number(own_scale_energy_) + "; 4 is none, " + number(kMostEnergy) + " the limit)";
    }
    pattern_.is_sewing_pattern = pattern_.refusal.empty() && pattern_.energy <= kPatternEnergy &&
                                 (faces >= kPatternFaces || pattern_.island.size() == surface_.component_count);
  }

  const CleanSurface& surface_;
  std::vector<uint32_t> opposite_;
  UvPattern pattern_;
  double tolerance_ = 0, own_scale_energy_ = 0, flipped_share_ = 0;
  uint32_t flipped_ = 0, first_flipped_ = kNone;
  bool flipped_pieces_ = false;
  std::vector<double> patch_area_;  // [m^2] per island: of the patch it is part of
};

}  // namespace

UvPattern read_uv_pattern(const CleanSurface& surface) {
  return PatternReader(surface).read();
}

}  // namespace geocloth
