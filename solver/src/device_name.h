// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <string_view>

namespace geocloth {

/// Whether what a user wrote is part of a device's name, in small letters or large ones; nothing is part of every name.
[[nodiscard]] inline bool is_part_of_name(std::string_view part, std::string_view name) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return part.empty() || std::search(name.begin(), name.end(), part.begin(), part.end(), same) != name.end();
}

}  // namespace geocloth
