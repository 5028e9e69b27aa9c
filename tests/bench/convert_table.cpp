// SPDX-License-Identifier: GPL-3.0-or-later
// Converts every mesh of a folder and writes what came out as a Markdown table, one line per file: topology of the
// surface and of the welded image, the measures that tell a good image from a poor one, and the time; or the reason why
// the file was refused.
//
//   convert_table FOLDER OUT.md [RESOLUTION]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/parametrize/convert.h"

namespace {

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string topology(uint32_t components, uint32_t loops, int64_t euler) {
  return std::to_string(components) + " / " + std::to_string(loops) + " / " + std::to_string(euler);
}

std::string line_of(const std::filesystem::path& file, const geocloth::ConvertOptions& options) {
  const geocloth::ConvertResult result = geocloth::convert(file, options);
  const geocloth::ConvertReport& r = result.report;
  const geocloth::Quality& q = r.quality;
  const geocloth::ClothAsset& asset = result.asset;
  std::string line = std::to_string(r.source_faces) + " | ";
  line += topology(r.represented.components, r.represented.boundary_loops, r.represented.euler_characteristic) + " | ";
  line += topology(r.welded.components, r.welded.boundary_loops, r.welded.euler_characteristic) + " | ";
  line += std::to_string(asset.width) + " x " + std::to_string(asset.height) + " | ";
  line += std::to_string(asset.chart_count) + " | " + std::to_string(asset.splits.rows()) + " | ";
  line +=
      number(q.l2_stretch, 4) + " | " + number(q.symmetric_dirichlet, 4) + " | " + number(q.anisotropy_p95, 3) + " | ";
  line += number(q.spring_min, 2) + " - " + number(q.spring_max, 3) + " (" + number(q.spring_p99_over_p1, 3) + ") | " +
          number(q.shear_deg_p50, 2) + " / " + number(q.shear_deg_p95, 3) + " | ";
  line += number(q.seam_length, 3) + " | " + number(q.psnr_db, 3) + " | " + number(q.binding_error, 2) + " | ";
  line += number(r.seconds.back().second, 3);
  std::cout << "  ";
  for (const auto& [stage, seconds] : r.seconds) std::cout << ' ' << stage << ' ' << number(seconds, 3);
  std::cout << '\n';
  for (const std::string& warning : r.warnings) std::cout << "   warning: " << warning << '\n';
  return line;
}

std::vector<std::filesystem::path> meshes_in(const std::filesystem::path& folder) {
  const std::set<std::string> endings{".obj", ".gltf", ".glb", ".ply", ".stl", ".fbx", ".dae"};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (endings.contains(entry.path().extension().string())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

int run(const std::filesystem::path& folder, const std::filesystem::path& out, const std::string& layout,
        uint32_t resolution) {
  geocloth::ConvertOptions options;
  options.flatten.layout = layout == "panels" ? geocloth::Layout::panels : geocloth::Layout::square;
  options.flatten.resolution = resolution;
  options.square_if_panels_fail = false;
  std::string table =
      "Layout " + layout + ", resolution " + std::to_string(options.flatten.resolution) +
      ". Topology is components / boundary loops / Euler characteristic of the tied surface. Springs are structural, "
      "relative to the nominal spacing; shear is in degrees, PSNR in dB, binding relative to the diagonal.\n\n"
      "| mesh | faces | surface | welded image | pixels | charts | split points | L2 stretch | Dirichlet | anisotropy "
      "p95 | "
      "springs "
      "| shear p50 / p95 | seam | PSNR | binding | seconds "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::size_t done = 0;
  const std::vector<std::filesystem::path> files = meshes_in(folder);
  for (const auto& file : files) {
    const std::string name = std::filesystem::relative(file, folder).string();
    std::string line;
    try {
      line = line_of(file, options);
      ++done;
    } catch (const geocloth::Error& e) {
      line = "refused: " + std::string(e.what());
      for (std::string where = file.parent_path().string() + "/"; line.find(where) != std::string::npos;) {
        line.erase(line.find(where), where.size());
      }
    }
    std::cout << name << ": " << line << std::endl;
    table += "| " + name + " | " + line + " |\n";
  }
  table += "\n" + std::to_string(done) + " of " + std::to_string(files.size()) + " converted.\n";
  std::cout << done << " of " << files.size() << " converted\n";
  geocloth::write_file(out, table);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string layout = argc > 3 ? argv[3] : "square";
  if (argc < 3 || argc > 5 || (layout != "square" && layout != "panels")) {
    std::cerr << "usage: convert_table FOLDER OUT.md [square|panels [RESOLUTION]]\n";
    return 2;
  }
  try {
    return run(argv[1], argv[2], layout, argc == 5 ? static_cast<uint32_t>(std::stoul(argv[4])) : 128);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return EXIT_FAILURE;
  }
}
