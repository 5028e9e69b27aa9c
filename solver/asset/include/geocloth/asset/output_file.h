// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace geocloth {

/// Whole content of a file. @throws Error(io) when it is missing, a directory, unreadable or larger than max_bytes
[[nodiscard]] std::vector<std::byte> read_file(const std::filesystem::path& path,
                                               std::uintmax_t max_bytes = std::uintmax_t{4} << 30U);

/// A file that appears whole or not at all: bytes go to a temporary name in the same folder, commit() renames it.
/// Without commit() (an exception, Ctrl-C through remove_unfinished_files) the temporary file is removed.
class OutputFile {
 public:
  /// @throws Error(io) if the folder does not exist or cannot be written
  explicit OutputFile(std::filesystem::path path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// The temporary name, for programs that write by themselves (ffmpeg). It keeps the ending of the final name.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Flushes and renames to the final name. @throws Error(io) on any write error
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
  bool committed_ = false;
};

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

/// Removes the temporary files of all OutputFile objects that are alive. Async-signal-safe: for a SIGINT handler.
void remove_unfinished_files() noexcept;

}  // namespace geocloth
