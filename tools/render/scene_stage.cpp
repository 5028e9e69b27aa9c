// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/scene_stage.h"

#include <algorithm>

#include "render/solid_mesh.h"

namespace geocloth {
namespace {

constexpr float kSwing = 0.05F;    ///< room on every side, as a share of the garments' diagonal
constexpr float kSag = 0.1F;       ///< room below: cloth hangs longer than it was drawn, likewise
constexpr float kNearby = 0.35F;   ///< colliders are framed within this distance, likewise
constexpr float kFall = 2;         ///< how far below a garment that falls the ground is where no plane is, likewise
constexpr float kLarge = 3;        ///< larger colliders are scenery that may reach through the ground, likewise
constexpr uint32_t kMoments = 33;  ///< at which moving things are looked at

double moment(const Scene& scene, uint32_t i) {
  return scene.frames / scene.frame_rate * i / (kMoments - 1);
}

/// A garment at rest where its keyframes put it over the time of the scene.
Bounds cloth_bounds(const Scene& scene, const SceneCloth& cloth, const ClothDesc& desc) {
  std::vector<Vec3> points;
  for (const Vec3& p : desc.asset->source.position) points.push_back(apply(desc.transform, p));
  Bounds all = bounds_of(points);
  if (all.empty() || cloth.motion.empty()) return all;
  const Bounds start = all;
  const Transform first = pose_at(cloth.motion, 0);
  for (uint32_t i = 1; i < kMoments; ++i) {
    const Transform pose = pose_at(cloth.motion, moment(scene, i));
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{(corner & 1) != 0 ? start.high.x : start.low.x, (corner & 2) != 0 ? start.high.y : start.low.y,
                   (corner & 4) != 0 ? start.high.z : start.low.z};
      all.include(apply(pose, rotate(conjugate(first.rotate), p - first.translate)));
    }
  }
  return all;
}

Bounds moving_bounds(const Scene& scene, const SceneCollider& collider) {
  Bounds all = collider_bounds(collider_at(collider, 0));
  if (all.empty() || collider.motion.empty()) return all;
  for (uint32_t i = 1; i < kMoments; ++i) all.include(collider_bounds(collider_at(collider, moment(scene, i))));
  return all;
}

bool falls(const Scene& scene) {
  return std::ranges::any_of(scene.cloths, [](const SceneCloth& cloth) { return cloth.pins.empty(); });
}

}  // namespace

RenderScene stage_simulation(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  RenderScene stage;
  Bounds garments;
  for (size_t i = 0; i < simulation.cloths().size(); ++i) {
    const ClothDesc& desc = simulation.cloths()[i];
    stage.cloths.push_back(make_render_cloth(desc.asset, desc.transform.scale));
    garments.include(cloth_bounds(scene, scene.cloths[i], desc));
  }
  stage.colliders = simulation.colliders();
  const float diagonal = garments.diagonal();
  stage.subject = grown(garments, kSwing * diagonal);
  stage.subject.low.y -= kSag * diagonal;
  const Bounds nearby = grown(garments, kNearby * diagonal);
  float lowest = stage.subject.low.y;
  for (const SceneCollider& collider : scene.colliders) {
    const Bounds reach = moving_bounds(scene, collider);
    stage.subject.include(intersection(reach, nearby));
    if (reach.diagonal() < kLarge * diagonal) lowest = std::min(lowest, reach.low.y);
  }
  stage.follow = falls(scene);
  if (stage.follow) lowest = std::min(lowest, stage.subject.low.y - kFall * diagonal);
  stage.ground_height = std::min(lowest, stage.subject.low.y);
  return stage;
}

}  // namespace geocloth
