// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures in host memory: a painter, a target to draw into, and a camera that frames what the scene is about.
#include "render/renderer.h"

#include <array>
#include <cmath>

#include "geocloth/asset/error.h"
#include "geocloth/solver/vulkan_interop.h"
#include "render/canvas.h"
#include "render/color_map.h"
#include "render/gpu_target.h"
#include "render/scene_painter.h"

namespace geocloth {
namespace {

using namespace render;

ContextPtr open_context(const RenderOptions& options, Solver* solver, bool& shared) {
  shared = false;
  if (solver != nullptr && solver->statistics().backend == to_string(Backend::vulkan)) {
    auto context = std::make_shared<const vulkan::Context>(vulkan_device(*solver));
    shared = context->graphics();
    if (shared) return context;
  }
  try {
    return std::make_shared<const vulkan::Context>(
        vulkan::DeviceWish{.name = options.device, .real_gpu = false, .graphics = true});
  } catch (const Error& error) {
    throw Error(ErrorCode::device,
                std::string("pictures need a Vulkan device that can draw (Debian has one in software: "
                            "mesa-vulkan-drivers); ") +
                    error.what());
  }
}

/// The heat scale with its ends, in the lower left corner.
void draw_strain_legend(Picture& picture, float range) {
  const int scale = picture.height >= 600 ? 2 : 1, width = 130 * scale, height = 8 * scale, margin = 10 * scale;
  const int top = static_cast<int>(picture.height) - margin - height;
  for (int i = 0; i < width; ++i)
    fill_rectangle(picture, margin + i, top, 1, height,
                   diverging_color((static_cast<float>(i) + 0.5F) / static_cast<float>(width)));
  constexpr Color kLegendInk{20, 22, 26, 255};
  const int line = top - 11 * scale;
  const auto percent = std::to_string(std::lround(range * 100)) + "%";
  draw_text(picture, margin, line, scale, "-" + percent, kLegendInk);
  draw_text(picture, margin + (width - text_width("strain", scale)) / 2, line, scale, "strain", kLegendInk);
  draw_text(picture, margin + width - text_width("+" + percent, scale), line, scale, "+" + percent, kLegendInk);
}

}  // namespace

RenderCloth make_render_cloth(std::shared_ptr<const ClothAsset> asset, float scale) {
  std::vector<Vec3> bound = bind_normals(*asset);
  return {std::move(asset), scale, std::move(bound)};
}

class Renderer::Impl {
 public:
  Impl(const RenderScene& scene, const RenderOptions& options, Solver* solver)
      : options_(options),
        first_subject_(scene.subject),
        subject_(scene.subject),
        all_round_(scene.all_round),
        context_(open_context(options, solver, shared_)),
        target_(context_, {options.size.width, options.size.height}),
        painter_(context_, scene, options.show, target_.render_pass(), shared_ ? solver : nullptr),
        commands_(context_) {
    set_camera(options.camera);
  }

  void set_camera(const CameraChoice& choice) {
    const float aspect = static_cast<float>(options_.size.width) / static_cast<float>(options_.size.height);
    painter_.set_camera(place_camera(choice, subject_, aspect, all_round_));
  }

  void follow(const Vec3& way) {
    if (first_subject_.empty()) return;
    subject_ = {first_subject_.low + way, first_subject_.high + way};
    painter_.set_subject(subject_);
    set_camera(options_.camera);
  }

  Picture render(std::span<const Collider> colliders, std::span<const ClothState> states) {
    const Layers layers{.strain_range = options_.strain_range};
    commands_.wait();
    painter_.prepare(target_.extent(), colliders, states);
    const vk::raii::CommandBuffer& commands = commands_.begin();
    painter_.record_before(commands, layers);
    target_.begin(commands);
    painter_.record_picture(commands, layers);
    target_.end(commands);
    target_.record_readback(commands);
    commands_.end();
    commands_.submit();
    commands_.wait();
    Picture picture = target_.picture();
    if (options_.show == Show::strain) draw_strain_legend(picture, options_.strain_range);
    return picture;
  }

  [[nodiscard]] bool shared() const { return shared_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return painter_.warnings(); }
  [[nodiscard]] const vulkan::Context& context() const { return *context_; }

 private:
  RenderOptions options_;
  Bounds first_subject_, subject_;
  bool all_round_;
  bool shared_ = false;
  ContextPtr context_;
  PictureTarget target_;
  ScenePainter painter_;
  vulkan::Commands commands_;  // last, so that it waits before anything that it uses dies
};

Renderer::Renderer(const RenderScene& scene, const RenderOptions& options, Solver* solver)
    : impl_(vulkan::guarded("set up a renderer", [&] { return std::make_unique<Impl>(scene, options, solver); })) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

bool Renderer::draws_from_solver() const {
  return impl_->shared();
}

Picture Renderer::render(std::span<const Collider> colliders, std::span<const ClothState> states) {
  return vulkan::guarded("draw", [&] { return impl_->render(colliders, states); });
}

void Renderer::set_camera(const CameraChoice& choice) {
  impl_->set_camera(choice);
}

void Renderer::follow(const Vec3& way) {
  impl_->follow(way);
}

const std::vector<std::string>& Renderer::warnings() const {
  return impl_->warnings();
}

const std::string& Renderer::device() const {
  return impl_->context().info().name;
}

std::shared_ptr<const ValidationLog> Renderer::validation_log() const {
  return impl_->context().validation_log();
}

}  // namespace geocloth
