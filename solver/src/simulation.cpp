// SPDX-License-Identifier: Apache-2.0
// A scene being played: keyframes are evaluated at the end of every frame, the solver moves evenly in between.

#include <map>
#include <string>
#include <utility>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"

namespace geocloth {
namespace {

Transform inverse_rigid(const Transform& t) {
  const Quat back = conjugate(t.rotate);
  return {-rotate(back, t.translate), back, 1};
}

std::vector<Collider> colliders_at(const Scene& scene, double time) {
  std::vector<Collider> colliders;
  for (const SceneCollider& c : scene.colliders) colliders.push_back(collider_at(c, time));
  return colliders;
}

/// What a pin follows, as a rigid motion from where it was at time 0.
Transform carrier(const Scene& scene, const SceneCloth& cloth, const std::string& follow, double time) {
  if (follow == "world") return {};
  if (follow == "cloth") return compose(pose_at(cloth.motion, time), inverse_rigid(pose_at(cloth.motion, 0)));
  for (const SceneCollider& c : scene.colliders) {
    if (c.collider.name == follow) return compose(collider_at(c, time).pose, inverse_rigid(collider_at(c, 0).pose));
  }
  throw Error(ErrorCode::invalid_argument,
              scene.path.string() + ": a pin follows \"" + follow + "\", but there is no collider of that name");
}

/// Pixels of a pin, with its path in the scene on what goes wrong.
std::vector<uint32_t> selected_pixels(const Scene& scene, size_t cloth, size_t pin, const ClothAsset& asset,
                                      const Transform& start) {
  try {
    return select_pixels(asset, start, scene.cloths[cloth].pins[pin].where);
  } catch (const Error& error) {
    throw Error(error.code(), scene.path.string() + ": cloths[" + std::to_string(cloth) + "].pins[" +
                                  std::to_string(pin) + "].where: " + error.what());
  }
}

Vec3 middle(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return (1.F / static_cast<float>(points.size())) * sum;
}

}  // namespace

Simulation::Simulation(Scene scene, SolverSettings settings) : scene_(std::move(scene)) {
  settings.frame_time = 1 / scene_.frame_rate;
  settings.substeps = scene_.substeps;
  settings.relaxation_steps = scene_.relaxation_steps;
  settings.gravity = scene_.gravity;

  std::map<std::filesystem::path, std::shared_ptr<const ClothAsset>> assets;
  for (uint32_t c = 0; c < scene_.cloths.size(); ++c) {
    const SceneCloth& cloth = scene_.cloths[c];
    std::shared_ptr<const ClothAsset>& asset = assets[cloth.asset];
    if (!asset) asset = std::make_shared<const ClothAsset>(read_asset(cloth.asset));
    const Transform start = compose(pose_at(cloth.motion, 0), cloth.transform);
    cloths_.push_back({asset, cloth.material, start});
    for (size_t k = 0; k < cloth.pins.size(); ++k) {
      const ScenePin& pin = cloth.pins[k];
      PinSet set{c, pin, selected_pixels(scene_, c, k, *asset, start), {}};
      for (const uint32_t p : set.pixels) set.rest.push_back(apply(start, asset->rest_position[p]));
      pins_.push_back(std::move(set));
    }
  }
  solver_ = std::make_unique<Solver>(cloths_, settings);
  solver_->set_colliders(colliders_at(scene_, 0), true);
  if (scene_.wind) solver_->set_wind(*scene_.wind);
}

double Simulation::time() const {
  return frame_ / scene_.frame_rate;
}

std::vector<Collider> Simulation::colliders() const {
  return colliders_at(scene_, time());
}

void Simulation::update_pins() {
  std::vector<std::vector<Pin>> pins(cloths_.size());
  for (const PinSet& set : pins_) {
    const Transform carried = carrier(scene_, scene_.cloths[set.cloth], set.pin.follow, time());
    const Transform own = pose_at(set.pin.motion, time());
    const Vec3 center = middle(set.rest);
    for (size_t k = 0; k < set.pixels.size(); ++k) {
      // Without a motion of its own the point must not even be rounded.
      const Vec3 moved =
          set.pin.motion.empty() ? set.rest[k] : center + rotate(own.rotate, set.rest[k] - center) + own.translate;
      pins[set.cloth].push_back({set.pixels[k], apply(carried, moved)});
    }
  }
  for (uint32_t c = 0; c < pins.size(); ++c) solver_->set_pins(c, pins[c]);
}

void Simulation::step() {
  ++frame_;
  solver_->set_colliders(colliders());
  update_pins();
  solver_->step();
}

}  // namespace geocloth
