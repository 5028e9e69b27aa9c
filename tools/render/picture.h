// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace geocloth {

/// 8 bits a channel, sRGB, alpha not premultiplied.
struct Color {
  uint8_t r = 0, g = 0, b = 0, a = 255;
  bool operator==(const Color&) const = default;
};

/// A picture in host memory, row by row from the top.
struct Picture {
  Picture() = default;
  Picture(uint32_t picture_width, uint32_t picture_height, Color fill = {0, 0, 0, 255});

  uint32_t width = 0, height = 0;  ///< [pixels]
  std::vector<Color> pixel;        ///< width * height

  [[nodiscard]] Color& at(uint32_t x, uint32_t y) { return pixel[size_t{y} * width + x]; }
  [[nodiscard]] const Color& at(uint32_t x, uint32_t y) const { return pixel[size_t{y} * width + x]; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return std::as_bytes(std::span(pixel)); }
};

/// PNG, RGBA of 8 bits; same picture, same bytes. @throws Error(io) when the file cannot be written
[[nodiscard]] std::vector<std::byte> encode_png(const Picture& picture);
void write_png(const Picture& picture, const std::filesystem::path& path);

/// Decodes a PNG or a JPEG, told apart by their first bytes. Safe for hostile bytes.
/// @param name  used in messages
/// @throws Error(invalid_data) for broken files, Error(unsupported) for other formats, Error(limit) above 16384 a side
[[nodiscard]] Picture decode_picture(std::span<const std::byte> bytes, const std::string& name);
[[nodiscard]] Picture read_picture(const std::filesystem::path& path);

}  // namespace geocloth
