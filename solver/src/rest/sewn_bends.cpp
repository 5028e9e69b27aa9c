// SPDX-License-Identifier: Apache-2.0
// Bends over seams that are sewn: from the pixel behind one of the two that a thread joins, over both of them, to the
// pixel behind the other one. Panels of a pattern lie apart at rest, so what they would be side by side is laid out
// here: x leads from one into the other, y along the seam. There the three lie in no line, as in a grid that turns, and
// a fourth point, beside the middle along the seam, takes the turn up (shaders/lib/bend.h). Seams are flat at rest.

#include "rest/sewn_bends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "rest/seam_list.h"
#include "rest/spring_neighbors.h"
#include "rest/turned_bend.h"

namespace geocloth {
namespace {

constexpr float kFarthestPair = 4;  ///< spacings from one pair of a seam to the next, on the side that is gathered
constexpr float kBorder = 0.5F;     ///< spacings that a border's neighbours lie inwards by, all together, at least
constexpr float kInwards = 0.7F;    ///< least cosine between the pixel behind another one and straight inwards
constexpr double kStraight = 0.02;  ///< of a bend's length: a turn that straightening takes no notice of

/// One side of a seam at a pair: unit vectors along it and into its panel.
struct Side {
  Vec3 along, inwards;
};

class SewnBends {
 public:
  SewnBends(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest)
      : asset_(*cloth.asset), scale_(cloth.transform.scale), fabrics_(fabrics), rest_(rest) {}

  std::vector<shader::SeamSpring> make() {
    partners_.resize(asset_.pixel_count());
    for (const auto& [a, b] : asset_.sewing) {
      partners_[a].push_back(b);
      partners_[b].push_back(a);
    }
    std::vector<shader::SeamSpring> bends;
    for (const auto& [a, b] : asset_.sewing)
      if (const std::optional<shader::SeamSpring> bend = bend_over(a, b)) bends.push_back(*bend);
    return bends;
  }

 private:
  [[nodiscard]] Vec3 way(uint32_t from, uint32_t to) const {
    return asset_.rest_position[to] - asset_.rest_position[from];
  }

  /// Where the seam leads from a pair: to those of their neighbours that are sewn to each other, too. @return whether
  /// there are some
  bool follow(uint32_t a, uint32_t b, Vec3& along_a, Vec3& along_b) const {
    along_a = along_b = {};
    for_spring_neighbors(asset_, a, [&](uint32_t next) {
      for (const uint32_t partner : partners_[next]) {
        const Vec3 of_a = way(a, next), of_b = way(b, partner);
        const float far = length(of_b);
        if (partner == b || !(far > 0) || far > kFarthestPair * asset_.spacing) continue;
        const float sign = dot(of_a, along_a) < 0 ? -1.F : 1.F;
        along_a = along_a + sign * of_a;
        along_b = along_b + sign * of_b;
      }
    });
    return length(along_a) > 0 && length(along_b) > 0;
  }

  /// @return nothing where a pixel has no cloth behind it, or cloth on all sides, as where a pocket is sewn on
  [[nodiscard]] std::optional<Side> side_of(uint32_t p, const Vec3& along) const {
    Side side{normalized(along), {}};
    for_spring_neighbors(asset_, p, [&](uint32_t next) { side.inwards = side.inwards + way(p, next); });
    side.inwards = side.inwards - dot(side.inwards, side.along) * side.along;
    if (!(length(side.inwards) > kBorder * asset_.spacing)) return std::nullopt;
    side.inwards = normalized(side.inwards);
    return side;
  }

  /// The neighbour that lies straightest behind a pixel of a seam.
  [[nodiscard]] std::optional<uint32_t> behind(uint32_t p, const Side& side) const {
    std::optional<uint32_t> best;
    float most = kInwards;
    for_spring_neighbors(asset_, p, [&](uint32_t next) {
      const Vec3 d = way(p, next);
      const float cosine = dot(d, side.inwards) / length(d);
      if (!(cosine > most)) return;
      most = cosine;
      best = next;
    });
    return best;
  }

  [[nodiscard]] std::optional<shader::SeamSpring> bend_over(uint32_t a, uint32_t b) const {
    Vec3 along_a, along_b;
    if (!follow(a, b, along_a, along_b) && !follow(b, a, along_b, along_a)) return std::nullopt;
    const std::optional<Side> side_a = side_of(a, along_a), side_b = side_of(b, along_b);
    if (!side_a || !side_b) return std::nullopt;
    const std::optional<uint32_t> behind_a = behind(a, *side_a), behind_b = behind(b, *side_b);
    if (!behind_a || !behind_b) return std::nullopt;

    shader::SeamSpring bend{};
    bend.a = *behind_a;
    bend.middle = bend.beside = a;
    bend.b = *behind_b;
    bend.middle_share = 1;
    // Seen from the pair when it is sewn: x leads out of the second panel into the first one, y along the seam.
    const auto seen_on = [](const Side& side, const Vec3& d, double towards) {
      const double x = towards * static_cast<double>(dot(d, side.inwards)), y = static_cast<double>(dot(d, side.along));
      return SeenPoint{x, y, 0, x * x + y * y};
    };
    const SeenPoint pa = seen_on(*side_a, way(a, bend.a), 1), pb = seen_on(*side_b, way(b, bend.b), -1);
    const double h1 = std::sqrt(pa.square), h2 = std::sqrt(pb.square), straight = h1 / (h1 + h2);
    TurnedBend numbers{straight, 0, 0.5 * h1 * h2, 0};
    if (std::abs((1 - straight) * pa.y + straight * pb.y) > kStraight * (h1 + h2)) {
      double most = 0;
      for_spring_neighbors(asset_, a, [&](uint32_t p) {
        const SeenPoint c = seen_on(*side_a, way(a, p), 1);
        const double along = std::abs(c.y) / std::sqrt(c.square);
        if (p == bend.a || !(along > most)) return;
        const std::optional<TurnedBend> turned = turned_bend(pa, pb, c);
        if (!turned) return;
        most = along;
        numbers = *turned;
        bend.beside = p;
      });
      if (most == 0) return std::nullopt;
    }
    const double area = 0.5 * (rest_.pixel_area(bend.a) + rest_.pixel_area(bend.b));
    const double rigidity = 0.5 * (rigidity_of(bend.a, side_a->inwards) + rigidity_of(bend.b, side_b->inwards));
    const double seen = numbers.seen * static_cast<double>(scale_) * static_cast<double>(scale_);
    if (!(rigidity > 0 && area > 0)) return std::nullopt;
    bend.chord = static_cast<float>(numbers.chord);
    bend.turn = static_cast<float>(numbers.weight);
    bend.compliance = bend_compliance(seen, rigidity, area);
    return bend;
  }

  /// [N m] against bending along a direction: the warp leads down the columns. As Cooper's yarns, see bends.cpp.
  [[nodiscard]] double rigidity_of(uint32_t p, const Vec3& direction) const {
    const Material material = fabrics_.bending_at(p);
    double warp = 0, weft = 0;
    for_spring_neighbors(asset_, p, [&](uint32_t next) {
      const double cosine = static_cast<double>(dot(normalized(way(p, next)), direction));
      const bool in_row = next == p + 1 || next + 1 == p,
                 in_column = next == p + asset_.width || next + asset_.width == p;
      if (in_row) weft = std::max(weft, cosine * cosine);
      if (in_column) warp = std::max(warp, cosine * cosine);
    });
    return static_cast<double>(material.bend_warp) * warp * warp +
           static_cast<double>(material.bend_weft) * weft * weft;
  }

  const ClothAsset& asset_;
  float scale_;
  const FabricMap& fabrics_;
  const RestShape& rest_;
  std::vector<std::vector<uint32_t>> partners_;  ///< of each pixel, that it is sewn to
};

}  // namespace

void add_sewn_bends(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest, ClothData& data) {
  if (data.bending != Bending::curvature || cloth.asset->sewing.empty()) return;
  const std::vector<shader::SeamSpring> bends = SewnBends(cloth, fabrics, rest).make();
  data.sewn_bend_colors = append_by_color(bends, std::numeric_limits<uint32_t>::max(), data);
}

}  // namespace geocloth
