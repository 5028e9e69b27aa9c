// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>

#include "geocloth/asset/output_file.h"
#include "render/picture.h"

namespace geocloth {

/// An MP4 (H.264, yuv420p, plays everywhere) made by the program ffmpeg, which gets raw pictures through a socket.
/// The file appears whole or not at all; ffmpeg dies with this program.
class VideoWriter {
 public:
  /// Odd sizes get one more row or column.
  /// @param frame_rate  [1/s] > 0
  /// @throws Error(io) when ffmpeg is not installed or the file cannot be written
  VideoWriter(const std::filesystem::path& path, uint32_t width, uint32_t height, double frame_rate);
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  ~VideoWriter();

  /// @throws Error(invalid_argument) for a picture of another size, Error(io) with ffmpeg's own words when it failed
  void add(const Picture& picture);
  /// Waits until ffmpeg is done. @throws Error(io)
  void finish();
  /// Gives the file its name; after finish().
  void commit();

 private:
  struct Encoder;
  [[noreturn]] void fail();

  std::filesystem::path path_;
  uint32_t width_, height_;
  OutputFile file_;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace geocloth
