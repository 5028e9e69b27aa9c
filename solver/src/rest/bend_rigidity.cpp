// SPDX-License-Identifier: Apache-2.0
// An outline that runs across the grid is a staircase of pixels, and the lines that end there have no bend at their
// last pixel. Nothing bends across a free edge, so that a line at a right angle to it loses nothing; but along the edge
// cloth bends as anywhere, and there the lines that meet it at a slant lost their share: a narrow strip on the bias had
// half of its rigidity. What a bend that is missing would bear is given to the next pixel that has one in that
// direction. The outermost pixels lie on the outline, so that the grid turns towards it: all is scaled so that the edge
// bends as the cloth does.

#include "rest/bend_rigidity.h"

#include <algorithm>
#include <cmath>

#include "rest/spring_neighbors.h"

namespace geocloth {
namespace {

/// How far [neighbours of neighbours] a bend is looked for that bears what is given.
constexpr int kFarthestGift = 3;

/// Of what an edge bears by its lines as they run, and inversely.
constexpr double kLargestScale = 2;

/// Grid directions within this of each other have no cross of warp and weft between them.
constexpr double kLargestCosine = 0.99;

}  // namespace

BendRigidity::BendRigidity(const ClothAsset& asset, const FabricMap& fabrics, const RestShape& rest,
                           const ShareSeen& share_seen)
    : asset_(asset), fabrics_(fabrics), rest_(rest), slanted_(asset.pixel_count(), 0), rigidity_(asset.pixel_count()) {
  std::vector<uint8_t> sewn(asset.pixel_count(), 0);  // bends lead over the seam there
  for (const uint32_t p : asset.splits.pixel) sewn[p] = 1;
  for (const auto& pair : asset.sewing)
    for (const uint32_t p : pair) sewn[p] = 1;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    slanted_[p] = asset.valid(p) && sewn[p] == 0 && is_slanted(p) ? 1 : 0;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (slanted_[p] != 0) give(p, share_seen);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    const Rigidities by_itself = own(p);
    for (uint32_t d = 0; d < kBendDirections; ++d)
      rigidity_[p][d] = by_itself[d] + rigidity_[p][d] / rest_.pixel_area(p);
  }
}

bool BendRigidity::whole(uint32_t p) const {
  for (uint32_t direction = 0; direction < kBendDirections; ++direction)
    if (!runs_through(asset_, p, direction)) return false;
  return true;
}

/// Whether a pixel lies on an outline that does not follow the grid: neither its row nor its column ends as those
/// beside it do.
bool BendRigidity::is_slanted(uint32_t p) const {
  const bool row = runs_through(asset_, p, kWeft), column = runs_through(asset_, p, kWarp);
  if (row && column) return fabrics_.has_bias() && !whole(p);
  return (!row && is_passed(p, kWeft)) || (!column && is_passed(p, kWarp));
}

/// Whether the row or the column ends at a pixel and one beside it goes on.
bool BendRigidity::is_passed(uint32_t p, uint32_t direction) const {
  const auto along = static_cast<int32_t>(step_in(asset_, direction)),
             aside = static_cast<int32_t>(step_in(asset_, direction == kWeft ? kWarp : kWeft));
  std::array<bool, 2> goes_on{}, passed{};  // forwards, backwards
  for_spring_neighbors(asset_, p, [&](uint32_t q) {
    const int32_t way = static_cast<int32_t>(q) - static_cast<int32_t>(p);
    for (const size_t side : {0U, 1U}) {
      const int32_t ahead = side == 0 ? along : -along;
      goes_on[side] = goes_on[side] || way == ahead;
      passed[side] = passed[side] || way == ahead + aside || way == ahead - aside;
    }
  });
  return (passed[0] && !goes_on[0]) || (passed[1] && !goes_on[1]);
}

/// At seams, and at an outline along the grid, row and column have weft and warp for themselves: across such an outline
/// nothing bends, and along it one of them does.
BendRigidity::Rigidities BendRigidity::own(uint32_t p) const {
  if (slanted_[p] != 0) return {};
  const Material material = fabrics_.bending_at(p);
  if (fabrics_.has_bias() && whole(p)) {
    const GridDirections grid = grid_at(p);
    if (grid.right > 0 && grid.down > 0) return spread_rigidity(material, grid);
  }
  return {material.bend_weft, material.bend_warp, 0, 0};
}

GridDirections BendRigidity::grid_at(uint32_t p) const {
  const Vec3 right = line_at(p, kWeft), down = line_at(p, kWarp);
  const double a = length(right), b = length(down);
  if (!(a > 0 && b > 0)) return {};
  const double cosine = static_cast<double>(dot(right, down)) / (a * b);
  return {a, b, std::acos(std::clamp(cosine, -kLargestCosine, kLargestCosine))};
}

/// From the pixel before to the one after.
Vec3 BendRigidity::line_at(uint32_t p, uint32_t direction) const {
  const uint32_t step = step_in(asset_, direction);
  return asset_.rest_position[p + step] - asset_.rest_position[p - step];
}

std::optional<BendRigidity::SlantedEdge> BendRigidity::edge_at(uint32_t p) const {
  Vec3 inwards{};
  for_spring_neighbors(asset_, p,
                       [&](uint32_t q) { inwards = inwards + asset_.rest_position[q] - asset_.rest_position[p]; });
  SlantedEdge edge;
  float most = 0;
  for_spring_neighbors(asset_, p, [&](uint32_t q) {
    const float ahead = dot(normalized(asset_.rest_position[q] - asset_.rest_position[p]), inwards);
    if (!(ahead > most) || !runs_through(asset_, q, kWeft) || !runs_through(asset_, q, kWarp)) return;
    most = ahead;
    edge.inside = q;
  });
  if (!(most > 0)) return std::nullopt;
  const GridDirections grid = grid_at(edge.inside);
  if (!(grid.right > 0 && grid.down > 0)) return std::nullopt;
  const Vec3 right = normalized(line_at(edge.inside, kWeft)), down = line_at(edge.inside, kWarp);
  const Vec3 aside = normalized(down - dot(down, right) * right);
  const double x = static_cast<double>(dot(inwards, right)), y = static_cast<double>(dot(inwards, aside));
  edge.along = normalized(static_cast<float>(-y) * right + static_cast<float>(x) * aside);
  const Material material = fabrics_.bending_at(p);
  edge.rigidity =
      fabrics_.has_bias() ? spread_rigidity(material, grid) : Rigidities{material.bend_weft, material.bend_warp, 0, 0};
  edge.along_rigidity = rigidity_along(material, angle_from_weft(grid, std::atan2(x, -y)));
  return edge;
}

bool BendRigidity::carries(uint32_t p, uint32_t direction) const {
  return runs_through(asset_, p, direction) && (direction <= kWarp || slanted_[p] != 0 || whole(p));
}

/// Those that bear the rigidity of a pixel in one direction: itself, or the next in the line, or any about it, all that
/// are as near.
std::vector<uint32_t> BendRigidity::takers(uint32_t p, uint32_t direction) const {
  if (runs_through(asset_, p, direction)) return {p};
  const uint32_t step = step_in(asset_, direction);
  std::vector<uint32_t> known{p}, found;
  for_spring_neighbors(asset_, p, [&](uint32_t q) {
    if ((q == p + step || q + step == p) && carries(q, direction)) found.push_back(q);
  });
  size_t first = 0;
  for (int ring = 0; ring < kFarthestGift && found.empty(); ++ring) {
    const size_t last = known.size();
    for (; first < last; ++first)
      for_spring_neighbors(asset_, known[first], [&](uint32_t q) {
        if (std::find(known.begin(), known.end(), q) != known.end()) return;
        known.push_back(q);
        if (carries(q, direction)) found.push_back(q);
      });
  }
  return found;
}

void BendRigidity::give(uint32_t p, const ShareSeen& share_seen) {
  const std::optional<SlantedEdge> edge = edge_at(p);
  if (!edge) {
    const Material material = fabrics_.bending_at(p);
    rigidity_[p][kWeft] += rest_.pixel_area(p) * static_cast<double>(material.bend_weft);
    rigidity_[p][kWarp] += rest_.pixel_area(p) * static_cast<double>(material.bend_warp);
    return;
  }
  std::array<std::vector<uint32_t>, kBendDirections> to;
  double borne = 0;  // [N m] along the edge
  for (uint32_t d = 0; d < kBendDirections; ++d) {
    if (edge->rigidity[d] > 0) to[d] = takers(p, d);
    const auto count = static_cast<double>(to[d].size());
    for (const uint32_t q : to[d]) borne += edge->rigidity[d] / count * share_seen(q, d, edge->along);
  }
  const double scale = borne > 0 ? std::clamp(edge->along_rigidity / borne, 1 / kLargestScale, kLargestScale) : 1;
  for (uint32_t d = 0; d < kBendDirections; ++d)
    for (const uint32_t q : to[d])
      rigidity_[q][d] += scale * edge->rigidity[d] * rest_.pixel_area(p) / static_cast<double>(to[d].size());
}

}  // namespace geocloth
