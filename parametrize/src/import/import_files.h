// SPDX-License-Identifier: GPL-3.0-or-later
// Files that a mesh file refers to: buffers, material libraries, pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace geocloth::import_detail {

inline constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30U;

/// Where a reference of a mesh file points to: relative to the mesh file, percent signs decoded, backslashes taken as
/// slashes. An absolute path of another machine is looked for by its file name beside the mesh.
[[nodiscard]] std::filesystem::path resolve(const std::filesystem::path& mesh_file, std::string_view reference);

/// Bytes of a data URI or of the file that a URI names.
/// @param where  the element that holds the URI, for messages
/// @throws Error(io) when there is no such file, Error(unsupported) when it is not in the mesh file's folder or below
///         (a mesh from somewhere must not have files of this machine read), Error(invalid_data) when a data URI is
///         broken
[[nodiscard]] std::vector<std::byte> read_uri(const std::filesystem::path& mesh_file, const std::string& uri,
                                              const std::string& where);

/// "image/png" or "image/jpeg" by the first bytes, or nothing for any other content.
[[nodiscard]] std::optional<std::string> picture_type(const std::vector<uint8_t>& bytes);

/// Bytes of a picture that a mesh refers to; nothing when it is missing, unreadable or neither PNG nor JPEG.
[[nodiscard]] std::optional<std::vector<uint8_t>> read_picture(const std::filesystem::path& mesh_file,
                                                               std::string_view reference);

}  // namespace geocloth::import_detail
