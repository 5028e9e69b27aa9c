// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/gpu_cloth.h"
#include "render/renderer.h"

namespace geocloth::render {

/// What is drawn beside cloth and ground.
struct Layers {
  bool colliders = true;  ///< planes are ground
  bool springs = false, pins = false;
  float strain_range = kStrainRange;
};

/// Records how a scene is drawn, for pictures and for windows alike. What it draws into is the caller's, and so is the
/// order: prepare(), then record_before(), then record_picture() inside of the pass. Whatever is not const asks that
/// the device is not drawing.
class ScenePainter {
 public:
  /// @param picture_pass  of a PictureTarget; it may be made anew in another size, pipelines stay
  /// @param lender        a solver on the same device: its images are drawn. nullptr: prepare() takes states
  ScenePainter(ContextPtr context, const RenderScene& scene, Show show, vk::RenderPass picture_pass, Solver* lender);
  ScenePainter(const ScenePainter&) = delete;
  ScenePainter& operator=(const ScenePainter&) = delete;
  ~ScenePainter();

  /// Shows a cloth in another way or, after a cut, with other faces. Its layers of ribbons are empty then.
  void set_cloth(size_t index, const RenderCloth& cloth, Show show);
  /// Another solver lends its images from now on, in place of the one before; set_cloth() for every cloth must follow.
  void set_lender(Solver* lender);
  void set_ribbons(size_t cloth, RibbonLayer layer, std::span<const RibbonInstance> ribbons);
  void set_camera(const Camera& camera);
  /// What light and depth range are about.
  void set_subject(const Bounds& subject);

  /// @param colliders  as many as in the scene, in their poses
  /// @param states     one per cloth; ignored when a solver lends its images
  /// @throws Error(invalid_argument) for wrong counts
  void prepare(vk::Extent2D extent, std::span<const Collider> colliders, std::span<const ClothState> states);
  /// Copies and the shadow map.
  void record_before(const vk::raii::CommandBuffer& commands, const Layers& layers) const;
  void record_picture(const vk::raii::CommandBuffer& commands, const Layers& layers) const;

  /// See Renderer::warnings.
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth::render
