// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace geocloth {

/// Text that stands for itself between tags and in quoted attributes; bytes that are no UTF-8 become U+FFFD, control
/// characters spaces.
[[nodiscard]] std::string escape_html(std::string_view text);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

}  // namespace geocloth
