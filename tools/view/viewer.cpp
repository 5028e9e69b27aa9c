// SPDX-License-Identifier: GPL-3.0-or-later
// The window owns the device, as an engine does (solver/README.md), and lends it to the solver. Pictures are drawn by
// the renderer's painter into a target of its own; then widgets; then the swapchain takes a copy.
#include "view/viewer.h"

#include <chrono>
#include <utility>
#include <vector>

#include "device_name.h"
#include "geocloth/asset/error.h"
#include "geocloth/solver/vulkan_interop.h"
#include "render/gpu_target.h"
#include "render/scene_painter.h"
#include "view/panel.h"
#include "view/panel_painter.h"
#include "view/swapchain.h"

namespace geocloth::view {
namespace {

using Clock = std::chrono::steady_clock;
using render::ContextPtr;
using render::RibbonLayer;

constexpr double kIdleWait = 1.0 / 30;  ///< [s] between pictures while nothing moves
constexpr Color kPinColor{232, 84, 60, 255};

/// Whether the solver's own choice (see Solver) would be a Vulkan device.
bool wants_vulkan(const SolverSettings& settings) {
  if (settings.backend != Backend::automatic) return settings.backend == Backend::vulkan;
  for (const DeviceInfo& device : enumerate_devices()) {
    if (device.backend != Backend::vulkan || !device.usable) continue;
    if (settings.device.empty() ? device.chosen_automatically : is_part_of_name(settings.device, device.name))
      return true;
  }
  return false;
}

ContextPtr open_context(const Window& window, const std::string& name, bool real_gpu) {
  return std::make_shared<const vulkan::Context>(
      vulkan::DeviceWish{.name = name,
                         .real_gpu = real_gpu,
                         .graphics = true,
                         .presents = Window::presents,
                         .instance_extensions = window.instance_extensions()});
}

/// The device of the window, and whether the solver is to run on it.
struct WindowDevice {
  ContextPtr context;
  bool for_solver = false;
};

WindowDevice open_device(const Window& window, const SolverSettings& settings) {
  if (wants_vulkan(settings)) {
    try {
      const bool real_gpu = settings.backend == Backend::automatic && settings.device.empty();
      return {open_context(window, settings.device, real_gpu), true};
    } catch (const Error& error) {
      if (error.code() != ErrorCode::device) throw;  // it may compute all the same, and another one show it
    }
  }
  return {open_context(window, {}, false), false};
}

}  // namespace

class Viewer::Impl {
 public:
  Impl(Scene scene, const ViewerOptions& options, const BodyReader& bodies)
      : size_(options.size),
        window_(options.title, options.size),
        device_(open_device(window_, options.solver)),
        swapchain_(device_.context, window_),
        commands_(device_.context),
        session_(make_setup(std::move(scene), options, bodies), options.size),
        panel_(window_),
        target_(std::in_place, device_.context, vk::Extent2D{size_.width, size_.height}),
        painter_(device_.context, session_.stage(), options.show, target_->render_pass(), lender()),
        panel_painter_(device_.context, target_->render_pass()),
        drawn_(session_.stage().cloths.size()),
        generation_(session_.generation()) {
    for (size_t i = 0; i < drawn_.size(); ++i) drawn_[i] = {session_.stage().cloths[i].asset, options.show, false, {}};
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    try {
      wait();
    } catch (const vk::SystemError&) {  // a lost device draws nothing any more
    }
  }

  bool turn() {
    if (!std::exchange(shown_, true)) {
      window_.show();
      turned_at_ = Clock::now();
    }
    const vk::Extent2D extent = swapchain_.extent();
    const bool visible = extent.width > 0;
    if (visible) session_.resize({extent.width, extent.height});
    const bool idle = !session_.playing() && session_.hand() == std::nullopt;
    for (const InputEvent& event : window_.poll(idle || !visible ? kIdleWait : 0)) take(event);
    const Clock::time_point now = Clock::now();
    session_.advance(std::chrono::duration<double>(now - std::exchange(turned_at_, now)).count());
    if (visible) {
      draw(extent);
      swapchain_.present(target_->resolved());
    }
    return !window_.wants_to_close() && !session_.finished();
  }

  Picture picture() {
    if (!drawn_once_) draw({size_.width, size_.height});
    wait();
    target_->record_readback(commands_.begin());
    commands_.end();
    commands_.submit();
    commands_.wait();
    return target_->picture();
  }

  [[nodiscard]] Window& window() { return window_; }
  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return painter_.warnings(); }
  [[nodiscard]] bool draws_from_solver() const { return device_.for_solver; }
  [[nodiscard]] std::shared_ptr<const ValidationLog> validation_log() const {
    return device_.context->validation_log();
  }

 private:
  /// What the device has of a cloth.
  struct DrawnCloth {
    std::shared_ptr<const ClothAsset> asset;
    Show show = Show::cloth;
    bool springs = false;
    std::vector<uint32_t> pins;
  };

  Session::Setup make_setup(Scene scene, const ViewerOptions& options, const BodyReader& bodies) {
    MakeSolver make_solver;
    if (device_.for_solver) {
      make_solver = [context = device_.context](std::span<const ClothDesc> cloths, const SolverSettings& settings) {
        return make_vulkan_solver(cloths, settings, context->handles());
      };
    }
    return {.scene = std::move(scene),
            .settings = options.solver,
            .bodies = bodies,
            .make_solver = std::move(make_solver),
            .display = {.show = options.show},
            .play = options.play,
            .frames = options.frames,
            .before_restart = [this] { wait(); }};
  }

  Solver* lender() { return device_.for_solver ? &session_.simulation().solver() : nullptr; }

  void wait() {
    commands_.wait();
    swapchain_.wait();
  }

  void take(const InputEvent& event) {
    const bool of_mouse = std::holds_alternative<MousePressed>(event) || std::holds_alternative<Scrolled>(event);
    if (of_mouse && panel_.takes_mouse()) return;
    if (std::holds_alternative<KeyPressed>(event) && panel_.takes_keys()) return;
    session_.handle(event);
  }

  /// Brings what the device has up to what is to be shown.
  void update_cloths() {
    const Display& display = session_.display();
    const bool anew = std::exchange(generation_, session_.generation()) != session_.generation();
    if (anew) painter_.set_lender(lender());
    for (uint32_t c = 0; c < drawn_.size(); ++c) {
      DrawnCloth& drawn = drawn_[c];
      const RenderCloth& cloth = session_.stage().cloths[c];
      if (anew || drawn.asset != cloth.asset || drawn.show != display.show) {
        painter_.set_cloth(c, cloth, display.show);
        drawn = {cloth.asset, display.show, false, {}};
      }
      if (display.springs && !std::exchange(drawn.springs, true))
        painter_.set_ribbons(c, RibbonLayer::springs, render::spring_ribbons(*cloth.asset));
      if (!display.pins) continue;
      std::vector<uint32_t> pins = session_.simulation().held_pixels(c);
      if (pins == drawn.pins) continue;
      painter_.set_ribbons(c, RibbonLayer::pins, render::pixel_dots(pins, kPinColor));
      drawn.pins = std::move(pins);
    }
  }

  /// Where the solver lends no images.
  std::vector<ClothState> read_states() {
    std::vector<ClothState> states;
    normals_.resize(drawn_.size());
    for (uint32_t c = 0; c < drawn_.size(); ++c) {
      session_.simulation().solver().read_normals(c, normals_[c]);
      states.push_back({session_.positions(c), normals_[c]});
    }
    return states;
  }

  void draw(vk::Extent2D extent) {
    const ImDrawData& widgets = panel_.lay_out(session_);  // may change what is shown
    const Display& display = session_.display();
    wait();
    if (target_->extent() != extent) target_.emplace(device_.context, extent);
    update_cloths();
    painter_.set_camera(session_.camera());
    painter_.set_subject(session_.subject());
    const std::vector<ClothState> states = device_.for_solver ? std::vector<ClothState>{} : read_states();
    painter_.prepare(extent, session_.simulation().colliders(), states);
    panel_painter_.prepare(widgets);
    const render::Layers layers{.colliders = display.colliders, .springs = display.springs, .pins = display.pins};
    const vk::raii::CommandBuffer& commands = commands_.begin();
    painter_.record_before(commands, layers);
    target_->begin(commands);
    painter_.record_picture(commands, layers);
    panel_painter_.record(commands, extent);
    target_->end(commands);
    commands_.end();
    commands_.submit();
    drawn_once_ = true;
  }

  PictureSize size_;
  Window window_;
  WindowDevice device_;
  Swapchain swapchain_;
  vulkan::Commands commands_;
  Session session_;
  Panel panel_;
  std::optional<render::PictureTarget> target_;
  render::ScenePainter painter_;
  PanelPainter panel_painter_;
  std::vector<DrawnCloth> drawn_;
  uint32_t generation_;
  std::vector<std::vector<Vec3>> normals_;
  Clock::time_point turned_at_;
  bool shown_ = false, drawn_once_ = false;
};

Viewer::Viewer(Scene scene, const ViewerOptions& options, const BodyReader& bodies)
    : impl_(vulkan::guarded("set up a window",
                            [&] { return std::make_unique<Impl>(std::move(scene), options, bodies); })) {}
Viewer::~Viewer() = default;

bool Viewer::turn() {
  return vulkan::guarded("draw in a window", [&] { return impl_->turn(); });
}

Picture Viewer::picture() {
  return vulkan::guarded("read a picture back", [&] { return impl_->picture(); });
}

Window& Viewer::window() {
  return impl_->window();
}

Session& Viewer::session() {
  return impl_->session();
}

const std::vector<std::string>& Viewer::warnings() const {
  return impl_->warnings();
}

bool Viewer::draws_from_solver() const {
  return impl_->draws_from_solver();
}

std::shared_ptr<const ValidationLog> Viewer::validation_log() const {
  return impl_->validation_log();
}

}  // namespace geocloth::view
