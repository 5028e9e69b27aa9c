// SPDX-License-Identifier: Apache-2.0
// Bending of a sheet: the curvature at a pixel, once along the row and once along the column, weighted with the pixel's
// own share of the area (shaders/lib/bend.h): B (curvature along warp)^2 / 2 and the same along weft, per area. A plate
// of these two rigidities alone bends on the bias as Cooper's yarns without torsion do ("The stiffness of woven
// textiles", 1960): B cos^4 + B' sin^4. With a bend_bias the two diagonals' curvatures are added, as a list, and the
// four share the rigidity (bend_directions.cpp). At rest only what bends out of the surface counts: a grid line that
// curves within a flat sheet leaves it flat.

#include "rest/bends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "lib/bend.h"
#include "lib/yield.h"
#include "rest/bend_directions.h"
#include "rest/bend_rigidity.h"
#include "rest/seam_list.h"
#include "rest/spring_neighbors.h"
#include "rest/turned_bend.h"

namespace geocloth {
namespace {

/// Strain that straightening a grid line may cause. Where a line has a kink, in a square or at a ragged outline, a
/// cloth that is soft beside its rigidity would be pulled out of shape: there a fourth point takes the turn up.
constexpr double kLargestPull = 0.005;

/// Nor where it turns by more than this [rad]: among grid lines that turn so sharply, as those of a button or beside a
/// ragged outline do, what pulls at the sheet does not cancel, and free pieces would shake and spin.
constexpr double kLargestTurn = 0.2;

/// Diagonals with less than this share of the material's rigidity are left out.
constexpr double kLeastShare = 0.01;

/// Cosine of the largest turn of a line where it leads over a seam.
constexpr float kLeastContinued = 0.85F;

constexpr uint32_t kRowBend = 4, kColumnBend = 5;  ///< components of the bending family

class BendBuilder {
 public:
  BendBuilder(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest, ClothData& data)
      : asset_(*cloth.asset), by_share_(cloth.material.bend_stiffness), fabrics_(fabrics), rest_(rest), data_(data) {
    if (by_share_ >= 0) return;
    rows_ = split_rows(asset_);
    compute_normals(asset_, asset_.rest_position, normal_);
    rigidity_.emplace(asset_, fabrics, rest, [&](uint32_t middle, uint32_t direction, const Vec3& along) {
      return share_seen(middle - way(direction), middle, middle + way(direction), along);
    });
  }

  void build() {
    const bool springs = by_share_ >= 0;
    if (springs ? by_share_ == 0 : !(fabrics_.stiffest() > 0)) return;
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p) {
      for (const uint32_t component : {kRowBend, kColumnBend}) {
        if ((asset_.spring_mask[p] & (1U << component)) != 0)
          springs ? add_spring(p, component) : add_bend(p, component);
      }
    }
    if (springs) {
      add_seam_springs();
    } else {
      add_diagonal_bends();
      add_seam_bends();
      append(listed_);
    }
    if (!yield_.empty()) {
      const auto median = yield_.begin() + static_cast<std::ptrdiff_t>(yield_.size() / 2);
      std::nth_element(yield_.begin(), median, yield_.end());
      data_.bend_yield = *median;
    }
    if (data_.springs_per_sweep > before_) data_.bending = springs ? Bending::springs : Bending::curvature;
  }

 private:
  void store(uint32_t p, uint32_t component, double rest, float compliance) {
    shader::vec4& entry = data_.springs[2][p];
    (component == kRowBend ? entry.x : entry.z) = static_cast<float>(rest);
    (component == kRowBend ? entry.y : entry.w) = compliance;
    ++data_.springs_per_sweep;
  }

  void add_spring(uint32_t p, uint32_t component) {
    const double length = rest_.rest_length(p, p + 2 * step_of(component));
    if (length > 0) store(p, component, length, 0);
  }

  void add_bend(uint32_t a, uint32_t component) {
    const uint32_t step = step_of(component), middle = a + step, b = middle + step;
    const auto along = static_cast<uint8_t>(component == kRowBend ? kSpringRight : kSpringDown);
    if ((asset_.spring_mask[a] & asset_.spring_mask[middle] & along) == 0) return;
    if (!(structural_rest(a, component) > 0 && structural_rest(middle, component) > 0)) return;  // they give the chord
    const uint32_t direction = component - kRowBend;
    const shader::SeamSpring bend =
        make_bend(a, middle, b, rest_.pixel_area(middle), rigidity_->at(middle, direction), kink(a, direction));
    if (!(bend.compliance > 0)) return;
    if (bend.turn != 0) {
      listed_.push_back(bend);
    } else {
      store(a, component, bend.rest, bend.compliance);
      const auto inverse_mass = [&](uint32_t p) { return shader::inverse_mass_of(data_.position[p].w); };
      const float w = shader::bend_weight(inverse_mass(a), inverse_mass(middle), inverse_mass(b), bend.chord);
      if (w > 0) yield_.push_back(bend.compliance / w);
    }
  }

  void add_diagonal_bends() {
    if (!fabrics_.has_bias()) return;
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p) {
      const auto stiffest = static_cast<double>(stiffest_bend(fabrics_.bending_at(p)));
      for (const uint32_t direction : {kWarp + 1, kWarp + 2}) {
        if (!runs_through(asset_, p, direction)) continue;
        const double rigidity = rigidity_->at(p, direction);
        if (!(rigidity > kLeastShare * stiffest)) continue;
        const uint32_t a = p - way(direction), b = p + way(direction);
        const shader::SeamSpring bend = make_bend(a, p, b, rest_.pixel_area(p), rigidity, kink(a, direction));
        if (bend.compliance > 0) listed_.push_back(bend);
      }
    }
  }

  /// Pixels from one to the next.
  [[nodiscard]] uint32_t way(uint32_t direction) const { return step_in(asset_, direction); }

  [[nodiscard]] uint32_t step_of(uint32_t component) const { return component == kRowBend ? 1 : asset_.width; }

  [[nodiscard]] float structural_rest(uint32_t p, uint32_t component) const {
    const shader::vec4& entry = data_.springs[0][p];
    return component == kRowBend ? entry.x : entry.z;
  }

  /// At rest, without the cloth's scale: from the middle to the chord.
  [[nodiscard]] Vec3 to_chord(uint32_t a, uint32_t middle, uint32_t b) const {
    const auto& p = asset_.rest_position;
    const Vec3 to_a = p[a] - p[middle], to_b = p[b] - p[middle];
    const float h1 = length(to_a), h2 = length(to_b);
    const float chord = h1 / (h1 + h2);
    return (1 - chord) * to_a + chord * to_b;
  }
  [[nodiscard]] Vec3 within_sheet(uint32_t a, uint32_t middle, uint32_t b) const {
    const Vec3 e = to_chord(a, middle, b);
    return e - dot(e, normal_[middle]) * normal_[middle];
  }
  /// How far [m, without scale] a grid line's turn within the sheet is from its turns at the neighbours. Where a line
  /// turns evenly, straightening it pulls evenly to both sides, and the sheet stays as it is.
  [[nodiscard]] double kink(uint32_t a, uint32_t direction) const {
    const uint32_t step = way(direction), middle = a + step, b = middle + step;
    const Vec3 own = within_sheet(a, middle, b);
    Vec3 beside{};
    float count = 0;
    for (const uint32_t p : {a, b}) {
      if (!runs_through(asset_, p, direction)) continue;
      beside = beside + within_sheet(p - step, p, p + step);
      ++count;
    }
    return static_cast<double>(count > 0 ? length(own - (1 / count) * beside) : length(own));
  }

  /// Of the energy of a cylinder, which bends along a unit vector: the share that a bend stores of what it would if it
  /// lay along it.
  [[nodiscard]] double share_seen(uint32_t a, uint32_t middle, uint32_t b, const Vec3& along) const {
    const Vec3& at = asset_.rest_position[middle];
    const auto square_along = [&](uint32_t p) {
      const auto projected = static_cast<double>(dot(asset_.rest_position[p] - at, along));
      return projected * projected;
    };
    const Vec3 e = to_chord(a, middle, b);
    const bool turns = length(within_sheet(a, middle, b)) > std::abs(dot(e, normal_[middle]));
    const Turn turn = turns ? take_up_turn(a, middle, b) : Turn{};
    const double h1 = length(asset_.rest_position[a] - at), h2 = length(asset_.rest_position[b] - at);
    const bool taken_up = turn.bend.weight != 0;
    const double chord = taken_up ? turn.bend.chord : h1 / (h1 + h2), seen = taken_up ? turn.bend.seen : 0.5 * h1 * h2;
    const double turned = taken_up ? turn.bend.weight * square_along(turn.beside) : 0;
    const double along_seen = 0.5 * ((1 - chord) * square_along(a) + chord * square_along(b) - turned);
    return seen > 0 ? along_seen * along_seen / (seen * seen) : 0;
  }

  /// @param area  [m^2] whose curvature it is
  /// @param kink  see kink(). Compliance 0 when there is nothing to bend.
  [[nodiscard]] shader::SeamSpring make_bend(uint32_t a, uint32_t middle, uint32_t b, double area, double rigidity,
                                             double kink) const {
    shader::SeamSpring bend{};
    bend.a = a;
    bend.middle = middle;
    bend.b = b;
    bend.beside = middle;
    const double h1 = rest_.rest_length(a, middle), h2 = rest_.rest_length(middle, b);
    if (!(h1 > 0 && h2 > 0 && area > 0 && rigidity > 0)) return bend;
    const double scale = h1 / static_cast<double>(length(asset_.rest_position[a] - asset_.rest_position[middle]));
    const Vec3 e = to_chord(a, middle, b);
    const double whole = scale * static_cast<double>(length(e));
    const double out_of_plane = scale * std::abs(static_cast<double>(dot(e, normal_[middle])));
    const double within = std::sqrt(std::max(0.0, whole * whole - out_of_plane * out_of_plane));
    // [N/m] if rest were out_of_plane
    const double pull = 2 * rigidity * (2 * scale * kink / (h1 * h2)) / (0.5 * (h1 + h2));
    const Material material = fabrics_.at(middle);
    const double softest = std::min(material.stretch_warp, material.stretch_weft);
    const double turned = within * (h1 + h2) / (h1 * h2);
    const bool turns = within > out_of_plane;
    const bool straighten = turns && pull <= kLargestPull * softest && turned <= kLargestTurn;
    const Turn turn = turns && !straighten ? take_up_turn(a, middle, b) : Turn{};
    const bool taken_up = turn.bend.weight != 0;
    const double seen = taken_up ? scale * scale * turn.bend.seen : 0.5 * h1 * h2;
    bend.rest = static_cast<float>(straighten ? out_of_plane : taken_up ? scale * turn.bend.rest : whole);
    bend.compliance = bend_compliance(seen, rigidity, area);
    bend.chord = static_cast<float>(taken_up ? turn.bend.chord : h1 / (h1 + h2));
    bend.middle_share = 1;
    if (taken_up) {
      bend.turn = static_cast<float>(turn.bend.weight);
      bend.beside = turn.beside;
    }
    return bend;
  }

  /// The fourth point of a bend, see lib/bend.h; lengths without the cloth's scale.
  struct Turn {
    uint32_t beside = 0;
    TurnedBend bend;  ///< weight 0: no neighbour can take the turn up
  };
  [[nodiscard]] Turn take_up_turn(uint32_t a, uint32_t middle, uint32_t b) const {
    const Vec3 x = normalized(within_sheet(a, middle, b)), y = cross(normal_[middle], x);
    const Vec3& at = asset_.rest_position[middle];
    const auto seen_from_middle = [&](uint32_t p) {
      const Vec3 d = asset_.rest_position[p] - at;
      return SeenPoint{dot(d, x), dot(d, y), dot(d, normal_[middle]), dot(d, d)};
    };
    const SeenPoint pa = seen_from_middle(a), pb = seen_from_middle(b);
    Turn best;
    double most = 0;
    for_spring_neighbors(asset_, middle, [&](uint32_t p) {
      if (p == a || p == b) return;
      const SeenPoint c = seen_from_middle(p);
      const double along = std::abs(c.x) / std::sqrt(c.square);
      if (!(along > most)) return;
      const std::optional<TurnedBend> turned = turned_bend(pa, pb, c);
      if (!turned) return;
      most = along;
      best = {p, *turned};
    });
    return best;
  }

  void add_seam_springs() {
    std::vector<shader::SeamSpring> springs;
    for (const SeamBend& bend : asset_.seam_bends) {
      const double rest = rest_.rest_length(bend.a, bend.b);
      if (rest > 0)
        springs.push_back({bend.a, bend.middle, bend.b, static_cast<float>(rest), 0, 0, 1, 0, bend.middle,
                           shader::kNoRow, shader::kNoRow});
    }
    append(springs);
  }

  /// The area of a bend over a seam is that of a pixel in a row with it. Where the row itself runs along another seam,
  /// there may be a bend for each of that seam's sides: they share it.
  void add_seam_bends() {
    const std::vector<uint32_t> point = first_copies(asset_);
    std::vector<double> point_area(asset_.pixel_count(), 0);
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p) point_area[point[p]] += rest_.pixel_area(p);
    const auto ends = [&](const SeamBend& bend) {
      return std::array{std::min(point[bend.a], point[bend.b]), point[bend.middle],
                        std::max(point[bend.a], point[bend.b])};
    };
    std::map<std::array<uint32_t, 3>, uint32_t> siblings;
    for (const SeamBend& bend : asset_.seam_bends) ++siblings[ends(bend)];

    std::vector<uint32_t> bends_at(asset_.pixel_count(), 0);
    for (const SeamBend& bend : asset_.seam_bends) ++bends_at[point[bend.middle]];
    for (const SeamBend& seam : asset_.seam_bends) {
      if (bends_at[point[seam.middle]] == 1 && add_lines_over(seam, point_area[point[seam.middle]])) continue;
      const double area = 0.5 * (point_area[point[seam.a]] + point_area[point[seam.b]]) / siblings[ends(seam)];
      shader::SeamSpring bend = make_bend(seam.a, seam.middle, seam.b, area, seam_rigidity(seam),
                                          length(within_sheet(seam.a, seam.middle, seam.b)));
      if (!(bend.compliance > 0)) continue;
      bend.middle_share = static_cast<float>(std::min(1.0, rest_.pixel_area(seam.middle) / area));
      listed_.push_back(bend);
    }
  }

  /// The part of a line that a seam ends.
  struct EndedLine {
    uint32_t inside, middle, beyond;  ///< beyond: on the other side of the seam
    double rigidity;                  ///< [N m]
  };

  /// Where a seam runs across the grid, rows and columns both lead over it: one bend at a slant would not see what
  /// bends along one of them, and twist the cloth. @return whether both do on both sides
  /// @param point_area  [m^2] of all copies
  [[nodiscard]] bool add_lines_over(const SeamBend& seam, double point_area) {
    const uint32_t row = rows_[seam.middle];
    if (row == kNoPixel || asset_.splits.copies(row).size() != 2) return false;
    const std::array<uint32_t, 2> copies{asset_.splits.copies(row)[0], asset_.splits.copies(row)[1]};
    std::vector<EndedLine> lines;
    bool slanted = false;
    for (const size_t k : {0U, 1U}) {
      const size_t before = lines.size();
      if (!find_ended_lines(copies[k], copies[1 - k], lines)) return false;
      slanted = slanted || lines.size() != before + 1 || !ends_at(lines.back(), seam);
    }
    if (!slanted) return false;
    for (const EndedLine& line : lines) {
      const double area = rest_.pixel_area(line.middle);
      shader::SeamSpring bend = make_bend(line.inside, line.middle, line.beyond, area, line.rigidity,
                                          length(within_sheet(line.inside, line.middle, line.beyond)));
      if (!(bend.compliance > 0)) continue;
      bend.middle_share = static_cast<float>(std::min(1.0, area / point_area));
      listed_.push_back(bend);
    }
    return true;
  }
  [[nodiscard]] static bool ends_at(const EndedLine& line, const SeamBend& seam) {
    return (line.inside == seam.a && line.beyond == seam.b) || (line.inside == seam.b && line.beyond == seam.a);
  }
  /// @return false where one leads nowhere
  [[nodiscard]] bool find_ended_lines(uint32_t copy, uint32_t other, std::vector<EndedLine>& lines) const {
    const Material material = fabrics_.bending_at(copy);
    for (const uint32_t direction : {kWeft, kWarp}) {
      if (runs_through(asset_, copy, direction)) continue;
      uint32_t inside = kNoPixel;
      for_spring_neighbors(asset_, copy, [&](uint32_t q) {
        if (q == copy + way(direction) || q + way(direction) == copy) inside = q;
      });
      const uint32_t beyond = inside == kNoPixel ? kNoPixel : opposite(inside, copy, other);
      if (beyond == kNoPixel) return false;
      lines.push_back(
          {inside, copy, beyond, static_cast<double>(direction == kWeft ? material.bend_weft : material.bend_warp)});
    }
    return true;
  }
  /// The neighbour of the other copy that continues a line best.
  [[nodiscard]] uint32_t opposite(uint32_t inside, uint32_t copy, uint32_t other) const {
    const Vec3& at = asset_.rest_position[copy];
    const Vec3 ahead = normalized(at - asset_.rest_position[inside]);
    uint32_t best = kNoPixel;
    float most = kLeastContinued;
    for_spring_neighbors(asset_, other, [&](uint32_t q) {
      const float cosine = dot(normalized(asset_.rest_position[q] - at), ahead);
      if (!(cosine > most)) return;
      most = cosine;
      best = q;
    });
    return best;
  }

  /// Between both sides'; each bends along a row or a column of its chart, or, beside a ragged outline, along neither.
  [[nodiscard]] double seam_rigidity(const SeamBend& seam) const {
    return fabrics_.rigidity_between(side_rigidity(seam.a, seam.middle), side_rigidity(seam.b, seam.middle));
  }
  [[nodiscard]] double side_rigidity(uint32_t inside, uint32_t middle) const {
    const Vec3& at = asset_.rest_position[middle];
    const auto leads_to = [&](SpringBit bit, uint32_t step) {
      return ((asset_.spring_mask[inside] & bit) != 0 && asset_.rest_position[inside + step] == at) ||
             (inside >= step && (asset_.spring_mask[inside - step] & bit) != 0 &&
              asset_.rest_position[inside - step] == at);
    };
    const Material material = fabrics_.at(inside);
    if (leads_to(kSpringRight, 1)) return material.bend_weft;
    if (leads_to(kSpringDown, asset_.width)) return material.bend_warp;
    return 0.5 * (static_cast<double>(material.bend_warp) + static_cast<double>(material.bend_weft));
  }

  void append(std::span<const shader::SeamSpring> bends) {
    data_.seam_bend_colors = append_by_color(bends, std::numeric_limits<uint32_t>::max(), data_);
    data_.springs_per_sweep += bends.size();
  }

  const ClothAsset& asset_;
  std::vector<uint32_t> rows_;  ///< of the split-vertex table, only with a rigidity
  float by_share_;              ///< Material::bend_stiffness
  const FabricMap& fabrics_;
  const RestShape& rest_;
  ClothData& data_;
  std::vector<Vec3> normal_;                ///< at rest, only with a rigidity
  std::optional<BendRigidity> rigidity_;    ///< only then
  std::vector<shader::SeamSpring> listed_;  ///< bends that have no place in the images
  std::vector<float> yield_;                ///< see ClothData::bend_yield
  uint64_t before_ = data_.springs_per_sweep;
};

}  // namespace

void add_bends(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest, ClothData& data) {
  BendBuilder(cloth, fabrics, rest, data).build();
}

}  // namespace geocloth
