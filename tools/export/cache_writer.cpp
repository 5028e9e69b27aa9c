// SPDX-License-Identifier: GPL-3.0-or-later
// Which ending means which format, and what the formats share.
#include "export/cache_writer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "export/cache_writers.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

using MakeWriter = std::unique_ptr<CacheWriter> (*)(const std::filesystem::path&, const CacheDescription&);

struct Format {
  std::string_view ending;
  MakeWriter make;
  bool holds_one_cloth, has_parts;
};
constexpr std::array<Format, 6> kFormats{{{".glb", make_gltf_writer, false, false},
                                          {".usda", make_usd_writer, false, false},
                                          {".obj", make_obj_writer, false, false},
                                          {".pc2", make_pc2_writer, true, true},
                                          {".mdd", make_mdd_writer, true, true},
                                          {".exr", make_exr_writer, true, false}}};

/// Null for another ending.
const Format* find_format(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto* const found =
      std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& format) { return format.ending == ending; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

std::unique_ptr<CacheWriter> make_cache_writer(const std::filesystem::path& path, const CacheDescription& description) {
  const Format* const format = find_format(path);
  return format == nullptr ? nullptr : format->make(path, description);
}

std::vector<std::filesystem::path> output_names(const std::filesystem::path& path, std::size_t cloth_count) {
  const Format* const format = find_format(path);
  if (format == nullptr || !format->holds_one_cloth) return {path};
  std::vector<std::filesystem::path> names;
  for (std::size_t i = 0; i < cloth_count; ++i) names.push_back(cloth_path(path, i, cloth_count));
  return names;
}

std::vector<std::filesystem::path> output_names(const std::filesystem::path& path,
                                                const CacheDescription& description) {
  const Format* const format = find_format(path);
  if (!description.each_part || format == nullptr || !format->has_parts) {
    return output_names(path, description.cloths.size());
  }
  std::vector<std::filesystem::path> names;
  for (const PointCacheFile& file : point_cache_files(path, description)) names.push_back(file.path);
  return names;
}

CacheDescription describe(const Simulation& simulation) {
  CacheDescription description;
  for (const ClothDesc& cloth : simulation.cloths()) description.cloths.push_back(cloth.asset);
  description.frame_rate = simulation.scene().frame_rate;
  description.frame_count = simulation.scene().frames;
  return description;
}

std::filesystem::path cloth_path(const std::filesystem::path& path, std::size_t cloth, std::size_t cloth_count) {
  if (cloth_count == 1) return path;
  return path.parent_path() / (path.stem().string() + "_" + std::to_string(cloth + 1) + path.extension().string());
}

void check_series_path(const std::filesystem::path& path) {
  const OutputFile probe(numbered_path(path, 0));  // not committed: leaves nothing
}

std::vector<Vec3> in_file_order(const SourceMesh& source, const std::vector<Vec3>& render_positions) {
  std::vector<Vec3> points(source.source_vertex_count);
  for (std::size_t i = 0; i < render_positions.size(); ++i) points[source.source_vertex[i]] = render_positions[i];
  return points;
}

}  // namespace geocloth
