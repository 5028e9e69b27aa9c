// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <sys/types.h>

namespace geocloth::test {

/// An X server without a screen (Xvfb), as long as it lives, on a display of its own. DISPLAY names it for this process
/// and those that it starts.
class VirtualDisplay {
 public:
  VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  ~VirtualDisplay();

  /// False where Xvfb is not installed.
  [[nodiscard]] bool running() const { return !name_.empty(); }

 private:
  pid_t server_ = -1;
  std::string name_;
};

}  // namespace geocloth::test
