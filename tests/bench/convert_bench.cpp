// SPDX-License-Identifier: GPL-3.0-or-later
// How the time and the memory of a conversion grow with the number of triangles: the project's own garments, each face
// divided into four again and again, at the default resolution, written to a file and converted as a user would.
//
//   convert_bench OUT.md [TRIANGLES]     up to so many triangles, 600,000 without
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

#include "child_run.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/parametrize/convert.h"
#include "markdown_table.h"

namespace geocloth::bench {
namespace {

constexpr unsigned kLimitSeconds = 1200;
constexpr std::array<const char*, 9> kStages{"import", "repair", "cut",  "flatten", "rasterize",
                                             "image",  "fit",    "bind", "measure"};

struct PlainMesh {
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
};

/// Every triangle becomes four; a vertex in the middle of every edge.
PlainMesh divided(const PlainMesh& mesh) {
  PlainMesh result{mesh.position, {}};
  std::map<std::array<uint32_t, 2>, uint32_t> middle_of;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const std::array<uint32_t, 2> key{std::min(a, b), std::max(a, b)};
    const auto [place, is_new] = middle_of.try_emplace(key, static_cast<uint32_t>(result.position.size()));
    if (is_new) {
      const Point3 &p = mesh.position[a], &q = mesh.position[b];
      result.position.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
    }
    return place->second;
  };
  for (const Triangle& t : mesh.triangle) {
    const uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    result.triangle.insert(result.triangle.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }
  return result;
}

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

void write_obj(const PlainMesh& mesh, const std::filesystem::path& file) {
  std::string text;
  for (const Point3& p : mesh.position) {
    text += "v " + number(p[0], 10) + ' ' + number(p[1], 10) + ' ' + number(p[2], 10) + '\n';
  }
  for (const Triangle& t : mesh.triangle) {
    text += "f " + std::to_string(t[0] + 1) + ' ' + std::to_string(t[1] + 1) + ' ' + std::to_string(t[2] + 1) + '\n';
  }
  write_file(file, text);
}

/// Seconds of every stage and in all, one after the other.
std::string seconds_of(const std::filesystem::path& file) {
  const ConvertResult result = convert(file);
  std::string text;
  for (const char* stage : kStages) {
    double seconds = 0;
    for (const auto& [name, time] : result.report.seconds) seconds += name == stage ? time : 0;
    text += number(seconds, 3) + '\n';
  }
  return text + number(result.report.seconds.back().second, 3) + '\n';
}

MarkdownTable measure(const std::string& garment, std::size_t most) {
  MarkdownTable table{garment, {"triangles", "CPU seconds", "us / (n log2 n)", "MiB", "seconds"}, {}};
  for (const char* stage : kStages) table.column.emplace_back(stage);
  const TriangleMesh file =
      import_mesh(std::filesystem::path(GEOCLOTH_SOURCE_DIR "/meshes/garments") / (garment + ".obj"));
  PlainMesh mesh{file.position, file.triangle};
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("geocloth_convert_bench_" + std::to_string(getpid()) + ".obj");
  for (; mesh.triangle.size() <= most; mesh = divided(mesh)) {
    write_obj(mesh, path);
    const ChildRun run = run_in_child([&] { return seconds_of(path); }, kLimitSeconds);
    std::vector<std::string> row{std::to_string(mesh.triangle.size())};
    if (run.done) {
      std::vector<std::string> seconds;
      for (std::size_t at = 0, end = 0; (end = run.text.find('\n', at)) != std::string::npos; at = end + 1) {
        seconds.push_back(run.text.substr(at, end - at));
      }
      const auto n = static_cast<double>(mesh.triangle.size());
      row.push_back(number(run.cpu_seconds, 3));
      row.push_back(number(1e6 * run.cpu_seconds / (n * std::log2(n)), 2));
      row.push_back(std::to_string(run.peak_memory_bytes >> 20U));
      row.push_back(seconds.back());
      row.insert(row.end(), seconds.begin(), seconds.end() - 1);
    } else {
      row.push_back(run.text);
    }
    for (const std::string& cell : row) std::cout << cell << " | ";
    std::cout << garment << std::endl;
    table.row.push_back(row);
  }
  std::filesystem::remove(path);
  return table;
}

}  // namespace
}  // namespace geocloth::bench

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::cerr << "usage: convert_bench OUT.md [TRIANGLES]\n";
    return 2;
  }
  try {
    using namespace geocloth::bench;
    const std::size_t most = argc == 3 ? std::stoul(argv[2]) : 600'000;
    std::string text =
        "# Time of a conversion against the size of the mesh\n\n"
        "Made by `convert_bench tests/bench/results/convert_time.md`: the project's own garments, every triangle "
        "divided "
        "into four again and again, at the default resolution. Where time grows as n log n, the third column stays the "
        "same or falls. MiB is the peak of the process; seconds, of all and per stage, are wall time.\n\n";
    for (const char* garment : {"t_shirt", "poncho"}) text += to_markdown(measure(garment, most));
    geocloth::write_file(argv[1], text);
    return EXIT_SUCCESS;
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return EXIT_FAILURE;
  }
}
