// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "view/session.h"
#include "view/window.h"

struct ImDrawData;

namespace geocloth::view {

/// The widgets over the picture. Makes the ImGui context, of which there is one at a time.
class Panel {
 public:
  explicit Panel(Window& window);
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;
  ~Panel();

  /// Whether the mouse is over a widget, or moves one: then what it does is not for the scene. Of the last lay_out().
  [[nodiscard]] bool takes_mouse() const;
  /// Whether something is being typed into a widget.
  [[nodiscard]] bool takes_keys() const;
  /// Shows what the session does and does to it what the user asks for.
  /// @return valid until the next call
  const ImDrawData& lay_out(Session& session);

 private:
  uint32_t cloth_ = 0;              ///< whose material is shown
  std::optional<uint32_t> fabric_;  ///< that of it, in place of its own
};

}  // namespace geocloth::view
