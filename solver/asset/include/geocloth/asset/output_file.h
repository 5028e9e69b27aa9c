// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
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
  /// @throws Error(io) if the folder does not exist or cannot be written, or the path is a directory or a device
  explicit OutputFile(std::filesystem::path path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }  ///< the final name
  /// The temporary name, for programs that write by themselves (ffmpeg). It keeps the ending of the final name.
  [[nodiscard]] const std::filesystem::path& temporary_path() const { return temporary_; }
  /// @throws Error(io) when the disk refuses
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  /// Appends what another file holds, a block at a time.
  void append_file(const std::filesystem::path& path);
  /// Sets where the next write() goes, for headers whose numbers are known last.
  void seek(std::uint64_t offset);
  /// Flushes and closes the temporary file, which waits for commit(): thousands can wait without a file handle each.
  void close();
  /// Closes and renames to the final name. @throws Error(io) on any write error
  void commit();

 private:
  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
  void* registration_ = nullptr;  ///< in the list that remove_unfinished_files() walks
};

/// A numbered series of files (out_0001.png ...) that appears whole or not at all: every file waits under its temporary
/// name until commit(), and a commit that fails or is interrupted takes back the files that it had already renamed.
class OutputSeries {
 public:
  OutputSeries() = default;
  OutputSeries(const OutputSeries&) = delete;
  OutputSeries& operator=(const OutputSeries&) = delete;

  /// One more file, beside those that are open. The reference lives until the series ends. @throws Error(io)
  OutputFile& add(std::filesystem::path path);
  /// Closes the file before, and adds the next.
  OutputFile& open(std::filesystem::path path);
  /// Closes all files; then only the renaming is left to do.
  void close();
  /// @throws Error(io)
  void commit();

 private:
  std::deque<OutputFile> files_;
};

/// out.obj, 7 -> out_0007.obj: the name of file `number` of a series; more digits when four do not do.
[[nodiscard]] std::filesystem::path numbered_path(const std::filesystem::path& path, std::uint32_t number);

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, std::string_view text);

/// Removes the temporary files of all OutputFile objects that are alive, and what a series is about to take back.
/// Async-signal-safe: for a SIGINT handler.
void remove_unfinished_files() noexcept;

}  // namespace geocloth
