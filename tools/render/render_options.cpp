// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/render_options.h"

#include <charconv>

#include <fmt/format.h>

#include "geocloth/asset/error.h"

namespace geocloth {

PictureSize parse_size(const std::string& text) {
  PictureSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  const bool has_cross = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = has_cross ? std::from_chars(width.ptr + 1, end, size.height) : width;
  const auto fits = [](uint32_t side) { return side >= kMinPictureSide && side <= kMaxRenderSide; };
  if (!has_cross || height.ec != std::errc() || height.ptr != end || !fits(size.width) || !fits(size.height))
    throw Error(ErrorCode::invalid_argument, fmt::format("{} is no picture size; give WIDTHxHEIGHT, each from {} to {}",
                                                         text, kMinPictureSide, kMaxRenderSide));
  return size;
}

}  // namespace geocloth
