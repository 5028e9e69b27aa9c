// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <csignal>
#include <string>
#include <vector>

namespace geocloth::test {

/// How a program ended and what it said.
struct ProgramResult {
  int status = -1;  ///< exit status, or 128 + the signal that killed it
  std::string out, err;
};

/// Runs `geocloth` with arguments, no shell between, and waits for it.
/// @param interrupt_after  when not zero, the signal is sent after that time
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& arguments,
                                        std::chrono::milliseconds interrupt_after = {}, int signal = SIGINT);

/// Runs `geocloth` through a shell, so that arguments may redirect its streams.
/// @param before  what the shell does first, such as "ulimit -f 4"
/// @return exit status, or -1
[[nodiscard]] int run_in_shell(const std::string& arguments, const std::string& before = "true");

}  // namespace geocloth::test
