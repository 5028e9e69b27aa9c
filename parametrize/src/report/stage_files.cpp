// SPDX-License-Identifier: GPL-3.0-or-later
// The intermediates of a conversion as Wavefront OBJ, which every mesh viewer opens, and the split-vertex table as CSV.
#include "report/stage_files.h"

#include <charconv>
#include <functional>
#include <string>
#include <system_error>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

constexpr const char* kImport = "1_import.obj";
constexpr const char* kClean = "2_clean.obj";
constexpr const char* kCut = "3_cut.obj";
constexpr const char* kFlat = "4_flat.obj";
constexpr const char* kImage = "5_image.obj";
constexpr const char* kSplits = "5_splits.csv";
constexpr const char* kWelded = "6_welded.obj";

void append(std::string& text, double value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

/// @param group  name of the group that triangle t belongs to; a line is written where it changes
/// @param uv     per vertex, or empty
std::string to_obj(const std::vector<Point3>& position, const std::vector<Triangle>& triangle,
                   const std::function<std::string(uint32_t t)>& group, const std::vector<Point2>& uv = {}) {
  std::string text;
  for (const Point3& p : position) {
    text += "v";
    for (const double x : p) append(text += ' ', x);
    text += '\n';
  }
  for (const Point2& p : uv) {
    append(text += "vt ", p[0]);
    append(text += ' ', p[1]);
    text += '\n';
  }
  std::string current;
  for (uint32_t t = 0; t < triangle.size(); ++t) {
    const std::string name = group(t);
    if (name != current) text += "g " + name + '\n';
    current = name;
    text += 'f';
    for (const uint32_t v : triangle[t]) {
      const std::string number = std::to_string(v + 1);
      text += ' ' + number + (uv.empty() ? "" : '/' + number);
    }
    text += '\n';
  }
  return text;
}

std::function<std::string(uint32_t)> numbered(const char* what, const std::vector<uint32_t>& number) {
  return [what, &number](uint32_t t) { return what + std::to_string(number[t]); };
}

std::string splits_csv(const ClothAsset& asset) {
  std::string text = "row,pixel,x,y,chart\n";
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    for (const uint32_t pixel : asset.splits.copies(row)) {
      text += std::to_string(row) + ',' + std::to_string(pixel) + ',' + std::to_string(pixel % asset.width) + ',' +
              std::to_string(pixel / asset.width) + ',' + std::to_string(asset.chart[pixel]) + '\n';
    }
  }
  return text;
}

}  // namespace

std::vector<std::filesystem::path> stage_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const char* name : {kImport, kClean, kCut, kFlat, kImage, kSplits, kWelded}) files.push_back(folder / name);
  return files;
}

StageFiles::StageFiles(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed || !std::filesystem::is_directory(folder_)) {
    throw Error(ErrorCode::io, folder_.string() + ": cannot make this folder for the stages; choose another");
  }
}

void StageFiles::save(const TriangleMesh& mesh) const {
  if (folder_.empty()) return;
  std::vector<uint32_t> part(mesh.triangle.size(), 0);
  for (uint32_t p = 0; p < mesh.part.size(); ++p) {
    for (uint32_t t = 0; t < mesh.part[p].triangle_count; ++t) part[mesh.part[p].first_triangle + t] = p;
  }
  write_file(folder_ / kImport, to_obj(mesh.position, mesh.triangle, numbered("part_", part)));
}

void StageFiles::save(const CleanSurface& surface) const {
  if (folder_.empty()) return;
  write_file(folder_ / kClean, to_obj(surface.position, surface.triangle, numbered("component_", surface.component)));
}

void StageFiles::save(const CutSurface& surface) const {
  if (folder_.empty()) return;
  write_file(folder_ / kCut, to_obj(surface.position, surface.triangle, numbered("component_", surface.component)));
}

void StageFiles::save(const FlatSurface& flat) const {
  if (folder_.empty()) return;
  std::vector<Point2> uv(flat.uv.size(), Point2{});
  for (std::size_t t = 0; t < flat.triangle.size(); ++t) {
    const FlatChart& chart = flat.charts[flat.chart[t]];
    for (const uint32_t v : flat.triangle[t]) {
      uv[v] = {(chart.x0 + flat.uv[v][0]) / (flat.width - 1), 1 - (chart.y0 + flat.uv[v][1]) / (flat.height - 1)};
    }
  }
  write_file(folder_ / kFlat, to_obj(flat.position, flat.triangle, numbered("chart_", flat.chart), uv));
}

void StageFiles::save(const ClothAsset& asset) const {
  if (folder_.empty()) return;
  write_file(folder_ / kImage, geocloth::to_obj(unwelded_grid_mesh(asset, asset.rest_position), true));
  write_file(folder_ / kSplits, splits_csv(asset));
  write_file(folder_ / kWelded, geocloth::to_obj(welded_grid_mesh(asset, asset.rest_position), false));
}

}  // namespace geocloth
