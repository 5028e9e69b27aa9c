// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/virtual_display.h"

#include <array>
#include <cstdlib>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace geocloth::test {

VirtualDisplay::VirtualDisplay() {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) return;
  server_ = fork();
  if (server_ == 0) {
    close(pipe_ends[0]);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    // The server looks for a free display and writes its number. It would begin anew when its last client leaves, and
    // turn away who comes meanwhile.
    const std::string end = std::to_string(pipe_ends[1]);
    execlp("Xvfb", "Xvfb", "-displayfd", end.c_str(), "-screen", "0", "1280x1024x24", "-noreset", "-nolisten", "tcp",
           nullptr);
    _exit(127);
  }
  close(pipe_ends[1]);
  std::string number;
  for (char c = 0;;) {
    pollfd ready{pipe_ends[0], POLLIN, 0};
    if (poll(&ready, 1, 20000) != 1 || read(pipe_ends[0], &c, 1) != 1 || c == '\n') break;
    number += c;
  }
  close(pipe_ends[0]);
  if (number.empty()) return;
  name_ = ":" + number;
  setenv("DISPLAY", name_.c_str(), 1);
  unsetenv("WAYLAND_DISPLAY");
}

VirtualDisplay::~VirtualDisplay() {
  if (server_ <= 0) return;
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
}

}  // namespace geocloth::test
