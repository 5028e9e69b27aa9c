// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "scene_warnings.h"

namespace geocloth {
namespace {

constexpr float kBuried = 2;       // spacings: points that begin so deep tear at the cloth
constexpr float kVisible = 0.05F;  // of a spacing

/// Whether a collider may hold any of these points; false is certain.
bool may_reach(const Collider& collider, std::span<const Vec3> points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return signed_distance(collider, (low + high) * 0.5F) <= 0.5F * length(high - low);
}

/// Deepest point [m] of the triangles that have all corners outside of the collider. A flat collider holds none.
float depth_between(std::span<const Triangle> triangles, std::span<const Vec3> x, const Collider& collider) {
  constexpr float kReach = 0.5774F;  // of its longest side, that a point of a triangle is from the nearest corner
  constexpr int kParts = 4;          // of a side
  if (std::holds_alternative<Plane>(collider.shape) || x.empty() || !may_reach(collider, x)) return 0;
  std::vector<float> gap;
  gap.reserve(x.size());
  for (const Vec3& p : x) gap.push_back(signed_distance(collider, p));
  float deepest = 0;
  for (const auto& [a, b, c] : triangles) {
    const float least = std::min({gap[a], gap[b], gap[c]});
    const float side = std::max({length(x[b] - x[a]), length(x[c] - x[b]), length(x[a] - x[c])});
    if (least < 0 || least > kReach * side) continue;
    for (int i = 0; i <= kParts; ++i) {
      for (int j = 0; i + j <= kParts; ++j) {
        if ((i == 0) + (j == 0) + (i + j == kParts) == 2) continue;  // a corner
        const float u = static_cast<float>(i) / kParts, v = static_cast<float>(j) / kParts;
        deepest = std::max(deepest, -signed_distance(collider, x[a] + (x[b] - x[a]) * u + (x[c] - x[a]) * v));
      }
    }
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
      if (x.empty() || !may_reach(colliders[c], x)) continue;
      Start start{i, c, 0, x.size(), 0};
      for (const Vec3& p : x) {
        const float depth = -signed_distance(colliders[c], p);
        start.points += static_cast<size_t>(depth > 0);
        start.depth = std::max(start.depth, depth);
      }
      if (start.depth > kBuried * cloth.asset->spacing * cloth.transform.scale) start_.push_back(start);
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
      const float depth = depth_between(cloths[i].asset->source.triangle, cloths[i].source_position, colliders[c]);
      if (depth > between_[i].depth) between_[i] = {c, depth};
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
    result.push_back(fmt::format(
        "{}: {} of its {} points begin inside {}, up to {:.2g} m deep, and are pushed out at once, which tears at the "
        "cloth; check that both have the same scale and pose, or move one of them",
        name_of_cloth(simulation.scene(), s.cloth), s.points, s.points_of_cloth,
        name_of_collider(simulation, s.collider), s.depth));
  }
  for (size_t i = 0; i < between_.size(); ++i) {
    constexpr double kMore = 1.25, kDigits = 2000;  // of the depth; half millimetres
    const ClothDesc& cloth = simulation.cloths()[i];
    const double depth = static_cast<double>(between_[i].depth);
    const bool is_torn = std::any_of(start_.begin(), start_.end(), [&](const Start& s) { return s.cloth == i; });
    if (is_torn || depth <= static_cast<double>(kVisible * cloth.asset->spacing * cloth.transform.scale)) continue;
    const double thickness = std::ceil((static_cast<double>(cloth.material.thickness) + kMore * depth) * kDigits);
    result.push_back(
        fmt::format("{}: {} shows through, up to {:.2g} m, between the garment's vertices, which stay outside; a "
                    "material with \"thickness\": {} would keep it covered",
                    name_of_cloth(simulation.scene(), i), name_of_collider(simulation, between_[i].collider), depth,
                    thickness / kDigits));
  }
  return result;
}

}  // namespace geocloth
