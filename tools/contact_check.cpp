// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geocloth/asset/grid_mesh.h"
#include "render/camera.h"
#include "scene_warnings.h"

namespace geocloth {
namespace {

constexpr float kBuried = 2;       // spacings: points that begin so deep tear at the cloth
constexpr float kVisible = 0.05F;  // of a spacing
constexpr float kInside = 0.05F;   // of a cloth's points, that may begin deeper in a collider than its thickness
constexpr float kThrough = 0.5F, kTorn = 1.5F;  // spacings deep, and of its length, where the grid is torn open

/// Whether a collider may hold any of these points; false is certain.
bool may_reach(const SignedDistance& distance, std::span<const Vec3> points) {
  const Bounds bounds = bounds_of(points);
  return distance(bounds.center()) <= 0.5F * bounds.diagonal();
}

float longest_side(const Triangle& t, std::span<const Vec3> x) {
  return std::max({length(x[t[1]] - x[t[0]]), length(x[t[2]] - x[t[1]]), length(x[t[0]] - x[t[2]])});
}

/// [m] Deepest point of a triangle that has all corners outside of the collider.
float depth_in(const Triangle& t, std::span<const Vec3> x, const SignedDistance& distance) {
  constexpr int kParts = 4;  // of a side
  const Vec3 &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
  float deepest = 0;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; i + j <= kParts; ++j) {
      if ((i == 0) + (j == 0) + (i + j == kParts) == 2) continue;  // a corner
      const float u = static_cast<float>(i) / kParts, v = static_cast<float>(j) / kParts;
      deepest = std::max(deepest, -distance(a + (b - a) * u + (c - a) * v));
    }
  }
  return deepest;
}

struct Deepest {
  float depth = 0;    // [m]
  float stretch = 1;  // of the triangle's longest side
};

/// The deepest of the triangles that have all corners outside of the collider. A flat collider holds none.
Deepest look_between(std::span<const Triangle> triangles, std::span<const Vec3> x, std::span<const Vec3> rest,
                     const Collider& collider) {
  constexpr float kReach = 0.5774F;  // of its longest side, that a point of a triangle is from the nearest corner
  Deepest deepest;
  if (std::holds_alternative<Plane>(collider.shape) || x.empty()) return deepest;
  const SignedDistance distance(collider);
  if (!may_reach(distance, x)) return deepest;
  std::vector<float> gap;
  gap.reserve(x.size());
  for (const Vec3& p : x) gap.push_back(distance(p));
  for (const Triangle& t : triangles) {
    const float least = std::min({gap[t[0]], gap[t[1]], gap[t[2]]});
    const float side = longest_side(t, x);
    if (least < 0 || least > kReach * side) continue;
    if (const float depth = depth_in(t, x, distance); depth > deepest.depth)
      deepest = {depth, side / longest_side(t, rest)};
  }
  return deepest;
}

std::string name_of_collider(const Simulation& simulation, size_t collider) {
  const std::string& name = simulation.scene().colliders[collider].collider.name;
  return name.empty() ? fmt::format("colliders[{}]", collider) : fmt::format("collider \"{}\"", name);
}

}  // namespace

ContactCheck::ContactCheck(Simulation& simulation) : between_(simulation.cloths().size()) {
  const std::vector<Collider> colliders = simulation.colliders();
  if (colliders.empty()) return;
  for (size_t i = 0; i < simulation.cloths().size(); ++i) {
    const ClothDesc& cloth = simulation.cloths()[i];
    const auto index = static_cast<uint32_t>(i);
    std::vector<Vec3> read, x;
    simulation.solver().read_positions(index, read);
    const std::vector<uint32_t> held = simulation.held_pixels(index);
    for (uint32_t p = 0; p < read.size(); ++p) {
      if (cloth.asset->valid(p) && !std::binary_search(held.begin(), held.end(), p)) x.push_back(read[p]);
    }
    for (size_t c = 0; c < colliders.size(); ++c) {
      if (x.empty() || !meets(cloth.meets, colliders[c])) continue;
      const SignedDistance distance(colliders[c]);
      if (!may_reach(distance, x)) continue;
      constexpr float kRounding = 1.1F;
      Start start{i, c, 0, x.size(), 0, false};
      size_t deep = 0;
      for (const Vec3& p : x) {
        const float depth = -distance(p);
        start.points += static_cast<size_t>(depth > 0);
        deep += static_cast<size_t>(depth > kRounding * cloth.material.thickness);
        start.depth = std::max(start.depth, depth);
      }
      start.is_buried = start.depth > kBuried * cloth.asset->spacing * cloth.transform.scale;
      if (start.is_buried || static_cast<float>(deep) > kInside * static_cast<float>(x.size())) start_.push_back(start);
    }
  }
}

void ContactCheck::add_frame(const Simulation& simulation, std::span<const ClothSnapshot> cloths) {
  constexpr size_t kWork = 20'000;  // triangles that are looked at in every frame
  size_t triangles = 0;
  for (const ClothSnapshot& cloth : cloths) triangles += cloth.asset->source.triangle.size();
  const bool is_last = simulation.frame() == simulation.scene().frames;
  if (!is_last && simulation.frame() % (1 + triangles / kWork) != 0) return;
  const std::vector<Collider> colliders = simulation.colliders();
  for (size_t i = 0; i < cloths.size(); ++i) {
    for (size_t c = 0; c < colliders.size(); ++c) {
      if (!meets(simulation.cloths()[i].meets, colliders[c])) continue;
      const ClothAsset& asset = *cloths[i].asset;
      const float depth =
          look_between(asset.source.triangle, cloths[i].source_position, asset.source.position, colliders[c]).depth;
      if (depth > between_[i].depth) between_[i] = {c, depth, between_[i].stretch};
      // Large drawn triangles sink in far; those of the grid only where it is torn open.
      const float scale = simulation.cloths()[i].transform.scale;
      if (depth <= kThrough * asset.spacing * scale) continue;
      const Deepest torn = look_between(pixel_triangles(asset), cloths[i].position, asset.rest_position, colliders[c]);
      if (torn.depth > kThrough * asset.spacing * scale)
        between_[i].stretch = std::max(between_[i].stretch, torn.stretch / scale);
    }
  }
}

float ContactCheck::depth_between_vertices() const {
  float deepest = 0;
  for (const Between& b : between_) deepest = std::max(deepest, b.depth);
  return deepest;
}

std::vector<std::string> ContactCheck::warnings(const Simulation& simulation) const {
  std::vector<std::string> result;
  for (const Start& s : start_) {
    const auto& mesh = simulation.scene().colliders[s.collider].mesh;
    const bool plays_at_once = mesh && mesh->animation && !(mesh->animation->start > 0);
    const bool may_pose = plays_at_once && !simulation.scene().cloths[s.cloth].skin;
    result.push_back(fmt::format(
        "{}: {} of its {} points begin inside {}, up to {:.2g} m deep, and are pushed out at once, which {} the cloth; "
        "check that both have the same scale and pose, or move one of them{}",
        name_of_cloth(simulation.scene(), s.cloth), s.points, s.points_of_cloth,
        name_of_collider(simulation, s.collider), s.depth, s.is_buried ? "tears at" : "may stretch",
        may_pose ? "; where its file opens in another pose than its animation begins with, give the animation a "
                   "\"start\", or the cloth a \"skin\""
                 : ""));
  }
  for (size_t i = 0; i < between_.size(); ++i) {
    constexpr double kMore = 1.25, kDigits = 2000;  // of the depth; half millimetres
    const ClothDesc& cloth = simulation.cloths()[i];
    const double depth = static_cast<double>(between_[i].depth);
    const bool is_torn =
        std::any_of(start_.begin(), start_.end(), [&](const Start& s) { return s.cloth == i && s.is_buried; });
    if (is_torn || depth <= static_cast<double>(kVisible * cloth.asset->spacing * cloth.transform.scale)) continue;
    const std::string name = name_of_cloth(simulation.scene(), i);
    const std::string collider = name_of_collider(simulation, between_[i].collider);
    if (between_[i].stretch > kTorn) {
      result.push_back(
          fmt::format("{}: {} went through it or stretched it open, by up to {:.2g} m and {:.2g} times its length; "
                      "more \"substeps\" than {} let the cloth yield, and so does a slower collider",
                      name, collider, depth, between_[i].stretch, simulation.scene().substeps));
      continue;
    }
    const double thickness = std::ceil((static_cast<double>(cloth.material.thickness) + kMore * depth) * kDigits);
    constexpr double kCoarse = 3;  // pixels
    const bool is_coarse = drawn_triangle_size(*cloth.asset) > kCoarse;
    result.push_back(fmt::format(
        "{}: {} shows through, up to {:.2g} m, where what is drawn sinks in between the points of the cloth, "
        "which are kept outside; a material with \"thickness\": {} would keep it covered{}",
        name, collider, depth, thickness / kDigits,
        is_coarse ? ", and the asset of a mesh that was divided (convert --refine 1.5) with less" : ""));
  }
  return result;
}

}  // namespace geocloth
