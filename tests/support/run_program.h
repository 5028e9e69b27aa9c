// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace geocloth::test {

/// How a program ended and what it said.
struct ProgramResult {
  int status = -1;  ///< exit status, or 128 + the signal that killed it
  std::string out, err;
};

/// Runs `geocloth` with arguments, no shell between, and waits for it.
/// @param interrupt_after  when not zero, SIGINT is sent after that time
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& arguments,
                                        std::chrono::milliseconds interrupt_after = {});

/// A folder of its own for a test, removed with everything in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Names of everything in it, in order.
  [[nodiscard]] std::vector<std::string> entries() const;
  /// Writes a file into it and returns its path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace geocloth::test
