// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geocloth/solver/scene.h"
#include "render/picture.h"
#include "view/session.h"
#include "view/window.h"

namespace geocloth {

class ValidationLog;

namespace view {

struct ViewerOptions {
  std::string title = "geocloth";
  PictureSize size;
  SolverSettings solver;
  Show show = Show::cloth;
  bool play = true;
  std::optional<uint32_t> frames;  ///< close after so many of the simulation
};

/// A scene in a window. A solver on Vulkan runs on the window's device where that can show pictures, and is drawn from
/// its own images; otherwise its state is read back and uploaded for every picture. Use from the main thread.
class Viewer {
 public:
  /// The window stays hidden until the first turn.
  /// @throws Error(device) when there is no display or no device, and as Simulation
  Viewer(Scene scene, const ViewerOptions& options, const BodyReader& bodies = {});
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer();

  /// Takes what the user did, plays what is due and shows it.
  /// @return false once the window is to close
  bool turn();
  /// What the window shows, widgets included. Drawn in the size that was asked for when nothing was shown yet.
  [[nodiscard]] Picture picture();

  [[nodiscard]] Window& window();
  [[nodiscard]] Session& session();
  /// See Renderer::warnings.
  [[nodiscard]] const std::vector<std::string>& warnings() const;
  /// Whether the solver's own images are drawn.
  [[nodiscard]] bool draws_from_solver() const;
  /// Of the device of the window; outlives the viewer.
  [[nodiscard]] std::shared_ptr<const ValidationLog> validation_log() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace view
}  // namespace geocloth
