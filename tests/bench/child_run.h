// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace geocloth::bench {

/// What became of a piece of work in a process of its own.
struct ChildRun {
  bool done = false;
  std::string text;    ///< what the work returned; or in plain words what went wrong: "refused: ...", "crashed (...)"
  double seconds = 0;  ///< wall time
  double cpu_seconds = 0;  ///< of the processors, which a busy machine does not lengthen much
  uint64_t peak_memory_bytes = 0;
};

/// Runs `work` in a child process, so that its peak memory is its own, and a crash or a hang is a line in the table and
/// not the end of it.
/// @param limit_seconds  of wall time, then the child is ended
[[nodiscard]] ChildRun run_in_child(const std::function<std::string()>& work, unsigned limit_seconds);

/// The same for work(0) to work(count - 1), several at once; done(i, run) is called as they end, in whatever order.
void run_in_children(std::size_t count, const std::function<std::string(std::size_t)>& work, unsigned at_once,
                     unsigned limit_seconds, const std::function<void(std::size_t, const ChildRun&)>& done);

}  // namespace geocloth::bench
