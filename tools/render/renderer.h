// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geocloth/solver/solver.h"
#include "render/picture.h"
#include "render/render_options.h"

namespace geocloth {

class ValidationLog;

/// A garment to draw.
struct RenderCloth {
  std::shared_ptr<const ClothAsset> asset;  ///< outlives the renderer's construction only
  float scale = 1;                          ///< Transform::scale of the garment in its scene
  /// Normals of the source mesh in the frames of its binding, one per render vertex (bind_normals).
  std::vector<Vec3> bound_normal;
};
[[nodiscard]] RenderCloth make_render_cloth(std::shared_ptr<const ClothAsset> asset, float scale = 1);

/// What stays the same from picture to picture.
struct RenderScene {
  std::vector<RenderCloth> cloths;
  std::vector<Collider> colliders;  ///< shapes; their poses are given with every picture
  Bounds subject;                   ///< what the camera frames: where the garments are, over the whole motion if known
  bool all_round = false;           ///< leave room for a turntable
  bool follow = false;  ///< nothing holds the garments: the camera should go with them, see Renderer::follow
  /// [m] height of the ground that is drawn where no collider is a plane; not set: a little below the subject.
  std::optional<float> ground_height;
};

/// The state of one cloth, one entry per pixel of its asset.
struct ClothState {
  std::span<const Vec3> position, normal;
};

/// Draws garments off screen on a Vulkan device. The vertex stage fetches every vertex from the position and normal
/// images through the binding; a solver on Vulkan lends its own images, so nothing is read back but the picture.
class Renderer {
 public:
  /// @param solver  when it runs on Vulkan and its queue can draw, its device and images are used; it must outlive the
  ///                renderer. Otherwise, and with nullptr, a device of the renderer's own.
  /// @throws Error(device) when no device can draw
  Renderer(const RenderScene& scene, const RenderOptions& options, Solver* solver = nullptr);
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;
  ~Renderer();

  /// True when the pictures are drawn from the images of the solver: render() then needs no states.
  [[nodiscard]] bool draws_from_solver() const;

  /// Draws one picture.
  /// @param colliders  as many as in the scene, in their poses
  /// @param states     one per cloth; ignored when draws_from_solver()
  /// @throws Error(invalid_argument) for wrong counts, Error(device) when the device fails
  [[nodiscard]] Picture render(std::span<const Collider> colliders, std::span<const ClothState> states = {});

  /// Looks from elsewhere.
  void set_camera(const CameraChoice& choice);

  /// Frames the subject where it is after it moved by `way` [m] since the renderer was made.
  void follow(const Vec3& way);

  /// What could not be drawn as the garment has it (a texture of an unknown format): one sentence each.
  [[nodiscard]] const std::vector<std::string>& warnings() const;
  /// The device's name.
  [[nodiscard]] const std::string& device() const;
  /// Messages of the validation layers (see vulkan_interop.h); outlives the renderer.
  [[nodiscard]] std::shared_ptr<const ValidationLog> validation_log() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth
