// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <string>

#include "export/cache_writer.h"

/// The formats behind make_cache_writer, one file each.
namespace geocloth {

[[nodiscard]] std::unique_ptr<CacheWriter> make_gltf_writer(const std::filesystem::path& path,
                                                            const CacheDescription& description);
[[nodiscard]] std::unique_ptr<CacheWriter> make_obj_writer(const std::filesystem::path& path,
                                                           const CacheDescription& description);
[[nodiscard]] std::unique_ptr<CacheWriter> make_pc2_writer(const std::filesystem::path& path,
                                                           const CacheDescription& description);
[[nodiscard]] std::unique_ptr<CacheWriter> make_mdd_writer(const std::filesystem::path& path,
                                                           const CacheDescription& description);
[[nodiscard]] std::unique_ptr<CacheWriter> make_exr_writer(const std::filesystem::path& path,
                                                           const CacheDescription& description);

[[nodiscard]] std::unique_ptr<CacheWriter> make_usd_writer(const std::filesystem::path& path,
                                                           const CacheDescription& description);

/// With as many digits as give the number back.
template <class Number>
void append_number(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

/// out.pc2, 0 of 2 -> out_1.pc2; the path itself when there is only one cloth.
[[nodiscard]] std::filesystem::path cloth_path(const std::filesystem::path& path, std::size_t cloth,
                                               std::size_t cloth_count);

/// A point cache, and the vertices of the file that it holds.
struct PointCacheFile {
  std::filesystem::path path;
  std::size_t cloth;
  std::vector<uint32_t> vertex;
};
/// One for each cloth, or for each part of it.
[[nodiscard]] std::vector<PointCacheFile> point_cache_files(const std::filesystem::path& path,
                                                            const CacheDescription& description);

/// Whether frame `frame` of a numbered series is a file: all but frame 0, unless there is no other.
[[nodiscard]] inline bool is_numbered_frame(uint32_t frame, const CacheDescription& description) {
  return frame > 0 || description.frame_count == 0;
}

/// Fails now, not after a long run, if the files of a series cannot be written. @throws Error(io)
void check_series_path(const std::filesystem::path& path);

/// Positions in the order of the vertices of the source file, then those that were added where it was divided.
[[nodiscard]] std::vector<Vec3> in_file_order(const SourceMesh& source, const std::vector<Vec3>& render_positions);

}  // namespace geocloth
