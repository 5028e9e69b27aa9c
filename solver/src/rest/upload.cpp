// SPDX-License-Identifier: Apache-2.0
// From an asset and a material in physical units to particles and springs.
//
// Masses: a pixel's own share of area x density, so that a copy carries the cloth of its side. What stiffness the
// springs get is told in rest_shape.cpp, and what the bends get in bends.cpp.

#include "rest/upload.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "colliders/reach.h"
#include "frame_input.h"
#include "geocloth/asset/grid_mesh.h"
#include "lib/lines.h"
#include "lib/yield.h"
#include "material_fields.h"
#include "rest/bends.h"
#include "rest/fabrics.h"
#include "rest/rest_shape.h"
#include "rest/seam_spans.h"
#include "rest/seam_ties.h"
#include "rest/self_points.h"
#include "rest/sewing.h"
#include "rest/sewn_bends.h"
#include "rest/short_seams.h"
#include "rest/surface_graph.h"
#include "rest/whole_ties.h"

namespace geocloth {
namespace {

/// Areas below this share of the mean are raised to it: a sliver at an outline would be a particle without mass.
constexpr double kSmallestAreaShare = 1e-3;

constexpr uint32_t kMembraneSprings = 4;  ///< structural and shear

/// Springs of one cloth, in the components' order.
class SpringBuilder {
 public:
  SpringBuilder(const ClothDesc& cloth, const RestShape& rest, ClothData& data)
      : asset_(*cloth.asset), by_share_(cloth.material.stiffness >= 0), rest_(rest), data_(data) {}

  void build() {
    for (auto& family : data_.springs) family.assign(asset_.pixel_count(), {0, 0, 0, 0});
    for (uint32_t y = 0; y < asset_.height; ++y)
      for (uint32_t x = 0; x < asset_.width; ++x)
        for (uint32_t c = 0; c < kMembraneSprings; ++c)
          if (asset_.spring_mask[pixel(x, y)] & (1U << c)) add_spring(c, x, y);
  }

 private:
  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }

  void add_spring(uint32_t c, uint32_t x, uint32_t y) {
    const uint32_t a = pixel(x, y);
    const auto b = static_cast<uint32_t>(static_cast<int64_t>(a) + kSpringOffset[c][0] +
                                         static_cast<int64_t>(asset_.width) * kSpringOffset[c][1]);
    const double rest = rest_.rest_length(a, b);
    if (!(rest > 0)) return;
    const double stiffness =
        c < 2 ? rest_.structural_stiffness(c, x, y, rest) : rest_.diagonal_stiffness(c, x, y, rest);
    if (!by_share_ && !(stiffness > 0)) return;
    const auto compliance = by_share_ ? 0.F : to_compliance(stiffness);
    shader::vec4& entry = data_.springs[c / 2][a];
    (c % 2 == 0 ? entry.x : entry.z) = static_cast<float>(rest);
    (c % 2 == 0 ? entry.y : entry.w) = compliance;
    ++data_.springs_per_sweep;
  }

  [[nodiscard]] static float to_compliance(double stiffness) {
    return static_cast<float>(std::min(1 / stiffness, kLargestCompliance));
  }

  const ClothAsset& asset_;
  bool by_share_;
  const RestShape& rest_;
  ClothData& data_;
};

/// [kg] of each pixel. The copies of a point have the same: what a spring moves a copy by counts for the point by the
/// copy's share of the mass, so that springs of one that had a small share would hardly hold. A cut between them leaves
/// each what it has.
std::vector<double> masses_of(const ClothDesc& cloth, const FabricMap& fabrics, const ClothAsset& uncut) {
  const ClothAsset& asset = *cloth.asset;
  const double scale = cloth.transform.scale;
  double total = 0;
  for (const float a : asset.area) total += static_cast<double>(a);
  const double smallest = kSmallestAreaShare * total / std::max(1U, count_valid_pixels(asset));
  std::vector<double> mass(asset.pixel_count(), 0);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    const double area = std::max(static_cast<double>(asset.area[p]), smallest) * scale * scale;
    mass[p] = area * static_cast<double>(fabrics.at(p).areal_density);
  }
  for (uint32_t row = 0; row < uncut.splits.rows(); ++row) {
    const std::span<const uint32_t> copies = uncut.splits.copies(row);
    double sum = 0;
    for (const uint32_t p : copies) sum += mass[p];
    for (const uint32_t p : copies) mass[p] = sum / static_cast<double>(copies.size());
  }
  return mass;
}

std::vector<shader::vec4> start_positions(const ClothDesc& cloth, const FabricMap& fabrics, const ClothAsset& uncut,
                                          const Vec3& origin) {
  const ClothAsset& asset = *cloth.asset;
  const std::vector<double> mass = masses_of(cloth, fabrics, uncut);
  std::vector<shader::vec4> position(asset.pixel_count(), {0, 0, 0, 0});
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    const Vec3 x = apply(cloth.transform, asset.rest_position[p]) - origin;
    position[p] = {x.x, x.y, x.z, shader::inverse_mass_of(static_cast<float>(1 / mass[p]))};
  }
  return position;
}

void add_rest(ClothBox& box, const ClothAsset& asset, const Transform& transform) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) box.add(apply(transform, asset.rest_position[p]));
}

/// Rest lengths of all structural springs.
std::vector<float> spring_lengths(const ClothAsset& asset) {
  std::vector<float> lengths;
  for_structural_springs(asset, [&](uint32_t a, uint32_t b) {
    lengths.push_back(length(asset.rest_position[b] - asset.rest_position[a]));
  });
  return lengths;
}

Evenness evenness_of(const ClothAsset& asset) {
  constexpr float kUneven = 1.2F;    // longest / shortest
  constexpr float kSqueezed = 0.7F;  // the twentieth part is shorter, in medians
  std::vector<float> lengths = spring_lengths(asset);
  if (lengths.empty()) return Evenness::even;
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  if (*longest <= kUneven * *shortest) return Evenness::even;
  const auto length_at = [&](size_t rank) {
    const auto place = lengths.begin() + static_cast<ptrdiff_t>(rank);
    std::nth_element(lengths.begin(), place, lengths.end());
    return *place;
  };
  const bool squeezed = length_at(lengths.size() / 20) < kSqueezed * length_at(lengths.size() / 2);
  return squeezed ? Evenness::squeezed : Evenness::uneven;
}

}  // namespace

bool has_attachments(const Material& material) {
  return largest_stretch(material, {}, {}, 0, 0) > 0;
}

ClothData make_cloth_data(const ClothDesc& cloth, const Vec3& origin, const ClothAsset& uncut) {
  const ClothAsset& asset = *cloth.asset;
  ClothData data;
  data.width = asset.width;
  data.height = asset.height;
  const FabricMap fabrics(cloth, uncut);
  data.position = start_positions(cloth, fabrics, uncut, origin);
  const RestShape rest(asset, cloth.transform.scale, fabrics);
  SpringBuilder(cloth, rest, data).build();
  add_bends(cloth, fabrics, rest, data);
  data.cell.assign(asset.cell.begin(), asset.cell.end());
  data.split_offset = asset.splits.offset;
  data.split_pixel = asset.splits.pixel;
  for (const uint32_t p : data.split_pixel) data.cell[p] |= shader::kCellCopyBit;
  data.attachments = has_attachments(cloth.material);
  data.may_meet_others = cloth.inter_collision.has_value();
  data.evenness = evenness_of(asset);
  if (data.attachments) {
    const std::vector<bool> short_seams = pixels_of_short_seams(uncut);
    data.short_seams = std::find(short_seams.begin(), short_seams.end(), true) != short_seams.end();
    add_seam_spans(asset, rest, cloth.transform.scale, short_seams, data);
    add_seam_ties(asset, rest, data);
    add_whole_ties(asset, rest, short_seams, data);
  }
  add_sewing(asset, cloth.transform.scale, data);
  add_sewn_bends(cloth, fabrics, rest, data);
  if (cloth.self_collision) add_self_points(cloth, data);
  return data;
}

std::vector<float> inverse_masses(const ClothData& cloth) {
  std::vector<float> masses(cloth.position.size());
  std::ranges::transform(cloth.position, masses.begin(), &shader::vec4::w);
  return masses;
}

bool make_same_data(const Material& a, const Material& b) {
  Material alike = a;
  for (const MaterialField& field : kMaterialFields)
    if (field.use == MaterialUse::frame) alike.*field.value = b.*field.value;
  return alike == b && has_attachments(a) == has_attachments(b);
}

bool make_same_data(std::span<const Fabric> a, std::span<const Fabric> b) {
  return std::ranges::equal(a, b, [](const Fabric& x, const Fabric& y) {
    Material own = x.material;  // what it has that is the cloth's
    own.max_stretch = y.material.max_stretch;
    return make_same_data(own, y.material);
  });
}

Vec3 choose_origin(std::span<const ClothDesc> cloths) {
  constexpr float kGrid = 4;  // [m]
  ClothBox bounds;
  for (const ClothDesc& cloth : cloths) add_rest(bounds, *cloth.asset, cloth.transform);
  if (bounds.empty()) return {};
  const auto middle = [&](float a, float b) { return kGrid * std::round((0.5F * a + 0.5F * b) / kGrid) + 0.F; };
  const Vec3& low = bounds.low;
  const Vec3& high = bounds.high;
  return {middle(low.x, high.x), middle(low.y, high.y), middle(low.z, high.z)};
}

float rest_size(const ClothAsset& asset, float scale) {
  ClothBox bounds;
  Transform scaled;
  scaled.scale = scale;
  add_rest(bounds, asset, scaled);
  return bounds.empty() ? 0 : length(bounds.high - bounds.low);
}

std::vector<shader::Attachment> make_attachments(const ClothAsset& asset, float scale, std::span<const uint32_t> pinned,
                                                 std::span<const float> shares) {
  const SurfaceGraph graph(asset, scale, shares);
  std::vector<double> distance(asset.pixel_count(), std::numeric_limits<double>::infinity());
  std::vector<uint32_t> anchor(asset.pixel_count(), shader::kNoAnchor);
  for (const uint32_t p : pinned) {
    distance[p] = 0;
    anchor[p] = p;
  }
  spread(
      graph, pinned, [&](uint32_t p) { return distance[p]; },
      [&](uint32_t from, uint32_t p, double d, double) {
        if (d >= distance[p]) return false;
        distance[p] = d;
        anchor[p] = anchor[from];
        return true;
      });
  // Copies lie at the same distance, but half-way between two pins they may have been reached from different ones: all
  // of them take the first one's anchor, so that they stay together.
  const std::vector<uint32_t> first = first_copies(asset);
  std::vector<shader::Attachment> attachments(asset.pixel_count(), {shader::kNoAnchor, 0});
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const uint32_t f = asset.valid(p) ? first[p] : p;
    if (distance[f] > 0 && anchor[f] != shader::kNoAnchor)
      attachments[p] = {anchor[f], static_cast<float>(distance[f])};
  }
  return attachments;
}

std::vector<PinWay> ways_between_pins(const ClothAsset& asset, float scale,
                                      std::span<const shader::Attachment> attachments,
                                      std::span<const uint32_t> pinned) {
  std::vector<shader::Attachment> nearest(attachments.begin(), attachments.end());
  for (const uint32_t p : pinned) nearest[p] = {p, 0};
  const SurfaceGraph graph(asset, scale);
  std::map<std::pair<uint32_t, uint32_t>, double> shortest;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const shader::Attachment& from = nearest[p];
    if (from.anchor == shader::kNoAnchor) continue;
    graph.for_neighbors(p, [&](uint32_t q, double step) {
      const shader::Attachment& to = nearest[q];
      if (to.anchor == shader::kNoAnchor || from.anchor >= to.anchor) return;
      const double way = static_cast<double>(from.reach) + step + static_cast<double>(to.reach);
      const auto [known, added] = shortest.try_emplace({from.anchor, to.anchor}, way);
      if (!added) known->second = std::min(known->second, way);
    });
  }
  std::vector<PinWay> ways;
  ways.reserve(shortest.size());
  for (const auto& [pins, way] : shortest) ways.push_back({pins.first, pins.second, static_cast<float>(way)});
  return ways;
}

}  // namespace geocloth
