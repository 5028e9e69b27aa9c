// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace geocloth {

/// On standard error, where it can be written.
void say(const std::string& words);

/// Says on standard error how far a long command is: a bar that redraws itself on a terminal, otherwise a plain line
/// when a stage starts and then at most one in two seconds; nothing when quiet. Use from one thread.
class ProgressDisplay {
 public:
  ProgressDisplay(std::string command, bool quiet);
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;
  /// Takes the bar away, so that a message after it stands on a line of its own.
  ~ProgressDisplay();

  /// @param fraction  0..1 of that stage
  void show(std::string_view stage, double fraction);

 private:
  std::string command_;
  bool quiet_;
  bool terminal_;
  std::string stage_;
  int percent_ = -1;
  std::chrono::steady_clock::time_point shown_at_;
};

/// From here on Ctrl-C, SIGTERM, a closed terminal or pipe, and a spent `ulimit -t` remove the unfinished output files
/// and end the program with status 128 + the signal's number.
/// Call it in the thread that opens the output files, before any other thread starts.
void remove_unfinished_files_on_interrupt();

}  // namespace geocloth
