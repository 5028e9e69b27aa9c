// SPDX-License-Identifier: GPL-3.0-or-later
// How the time and the memory of a conversion grow with the number of triangles: a garment of the project's own, each
// face divided into 1, 4, 16, 49 and 121, at the default resolution, written to a file and converted as a user would.
// Then with the number of pixels: the same garment, undivided, in images of 64 x 64 to 1024 x 1024.
//
//   convert_bench OUT.md [TRIANGLES [PIXELS]]     up to so many of each, 300,000 and 1,100,000 without
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <utility>
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

/// Every side of a triangle in n parts, every triangle in n^2.
PlainMesh divided(const PlainMesh& mesh, uint32_t n) {
  PlainMesh result{mesh.position, {}};
  std::map<std::array<uint32_t, 3>, uint32_t> on_edge;  // lower vertex, upper vertex, steps from the lower one
  const auto add = [&](const Triangle& t, const std::array<double, 3>& weight) {
    Point3 p{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (std::size_t k = 0; k < 3; ++k) p[k] += mesh.position[t[corner]][k] * weight[corner] / n;
    }
    result.position.push_back(p);
    return static_cast<uint32_t>(result.position.size() - 1);
  };
  // The point i steps from corner 0 to corner 1 and j steps to corner 2.
  const auto point = [&](const Triangle& t, uint32_t i, uint32_t j) {
    const std::array<uint32_t, 3> weight{n - i - j, i, j};
    for (std::size_t k = 0; k < 3; ++k) {
      if (weight[k] == n) return t[k];
    }
    const std::array<double, 3> weights{double(weight[0]), double(weight[1]), double(weight[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      if (weight[k] != 0) continue;
      const uint32_t a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      const std::array<uint32_t, 3> key{std::min(a, b), std::max(a, b),
                                        a < b ? weight[(k + 2) % 3] : weight[(k + 1) % 3]};
      const auto known = on_edge.find(key);
      return known != on_edge.end() ? known->second : on_edge[key] = add(t, weights);
    }
    return add(t, weights);
  };
  for (const Triangle& t : mesh.triangle) {
    std::vector<std::vector<uint32_t>> row(n + 1);
    for (uint32_t j = 0; j <= n; ++j) {
      for (uint32_t i = 0; i + j <= n; ++i) row[j].push_back(point(t, i, j));
    }
    for (uint32_t j = 0; j < n; ++j) {
      for (uint32_t i = 0; i + j < n; ++i) {
        result.triangle.push_back({row[j][i], row[j][i + 1], row[j + 1][i]});
        if (i + j + 1 < n) result.triangle.push_back({row[j][i + 1], row[j + 1][i + 1], row[j + 1][i]});
      }
    }
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
std::string seconds_of(const std::filesystem::path& file, const ConvertOptions& options) {
  const ConvertResult result = convert(file, options);
  std::string text;
  for (const char* stage : kStages) {
    double seconds = 0;
    for (const auto& [name, time] : result.report.seconds) seconds += name == stage ? time : 0;
    text += number(seconds, 3) + '\n';
  }
  return text + number(result.report.seconds.back().second, 3) + '\n';
}

struct Sample {
  double size, seconds;
};

/// The exponent e of the power law seconds ~ cost(size)^e that fits best: a line through the logarithms.
template <class Cost>
double exponent(const std::vector<Sample>& samples, const Cost& cost) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Sample& s : samples) {
    const double lx = std::log(cost(s.size)), ly = std::log(s.seconds);
    x += lx;
    y += ly;
    xx += lx * lx;
    xy += lx * ly;
  }
  const auto n = static_cast<double>(samples.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

/// A table of conversions that differ by the size of their work, a row each.
class TimeTable {
 public:
  /// @param unit  what the size is counted in
  TimeTable(std::string name, std::string unit)
      : table_{std::move(name), {std::move(unit), "CPU seconds", "us / (n log2 n)", "MiB", "seconds"}, {}} {
    for (const char* stage : kStages) table_.column.emplace_back(stage);
  }

  void add(std::size_t size, const std::filesystem::path& file, const ConvertOptions& options) {
    const ChildRun run = run_in_child([&] { return seconds_of(file, options); }, kLimitSeconds);
    std::vector<std::string> row{std::to_string(size)};
    if (run.done) {
      std::vector<std::string> seconds;
      for (std::size_t at = 0, end = 0; (end = run.text.find('\n', at)) != std::string::npos; at = end + 1) {
        seconds.push_back(run.text.substr(at, end - at));
      }
      const auto n = static_cast<double>(size);
      samples_.push_back({n, run.cpu_seconds});
      row.push_back(number(run.cpu_seconds, 3));
      row.push_back(number(1e6 * run.cpu_seconds / (n * std::log2(n)), 2));
      row.push_back(std::to_string(run.peak_memory_bytes >> 20U));
      row.push_back(seconds.back());
      row.insert(row.end(), seconds.begin(), seconds.end() - 1);
    } else {
      row.push_back(run.text);
    }
    for (const std::string& cell : row) std::cout << cell << " | ";
    std::cout << table_.heading << std::endl;
    table_.row.push_back(row);
  }

  /// With how time grows below it.
  [[nodiscard]] std::string text() const { return to_markdown(table_) + growth_in_words(); }

 private:
  /// Over all sizes, and over the last two, where what is the same for any size counts least.
  [[nodiscard]] std::string growth_in_words() const {
    if (samples_.size() < 2) return {};
    const auto exponents = [](const std::vector<Sample>& some) {
      return "n^" + number(exponent(some, [](double n) { return n; }), 3) + ", which is (n log n)^" +
             number(exponent(some, [](double n) { return n * std::log(n); }), 3);
    };
    return "CPU time grows as " + exponents(samples_) + "; from " + number(samples_[samples_.size() - 2].size, 7) +
           " to " + number(samples_.back().size, 7) + ' ' + table_.column.front() + " as " +
           exponents({samples_.end() - 2, samples_.end()}) + ".\n\n";
  }

  MarkdownTable table_;
  std::vector<Sample> samples_;
};

ConvertOptions options_of(Layout layout) {
  ConvertOptions options;
  options.flatten.layout = layout;
  options.square_if_panels_fail = false;
  return options;
}

std::string by_triangles(const PlainMesh& garment, Layout layout, std::size_t most) {
  TimeTable table(geocloth::to_string(layout), "triangles");
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("geocloth_convert_bench_" + std::to_string(getpid()) + ".obj");
  for (const uint32_t parts : {1U, 2U, 4U, 7U, 11U}) {
    if (garment.triangle.size() * parts * parts > most) break;
    const PlainMesh mesh = divided(garment, parts);
    write_obj(mesh, path);
    table.add(mesh.triangle.size(), path, options_of(layout));
  }
  std::filesystem::remove(path);
  return table.text();
}

std::string by_pixels(const std::filesystem::path& garment, Layout layout, std::size_t most) {
  TimeTable table(std::string(geocloth::to_string(layout)) + ", images", "pixels");
  for (const uint32_t side : {64U, 128U, 256U, 512U, 1024U}) {
    if (std::size_t{side} * side > most) break;
    ConvertOptions options = options_of(layout);
    options.flatten.resolution = side;
    table.add(std::size_t{side} * side, garment, options);
  }
  return table.text();
}

}  // namespace
}  // namespace geocloth::bench

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::cerr << "usage: convert_bench OUT.md [TRIANGLES [PIXELS]]\n";
    return 2;
  }
  try {
    using namespace geocloth::bench;
    using geocloth::Layout;
    const std::size_t most_triangles = argc > 2 ? std::stoul(argv[2]) : 300'000;
    const std::size_t most_pixels = argc > 3 ? std::stoul(argv[3]) : 1'100'000;
    std::string text =
        "# Time of a conversion against the size of the mesh and of the image\n\n"
        "Made by `convert_bench tests/bench/results/convert_time.md`: the project's own T-shirt, every triangle "
        "divided into 1 to 121, at the default resolution; then undivided, at resolutions of 64 to 1024. Where time "
        "grows as n log n, the third column stays the same or falls. CPU seconds are of all threads; MiB is the peak "
        "of the process; seconds, of all and per stage, are wall time.\n\n";
    const std::filesystem::path garment = GEOCLOTH_SOURCE_DIR "/meshes/garments/t_shirt.obj";
    const geocloth::TriangleMesh mesh = geocloth::import_mesh(garment);
    for (const Layout layout : {Layout::panels, Layout::square})
      text += by_triangles({mesh.position, mesh.triangle}, layout, most_triangles);
    for (const Layout layout : {Layout::panels, Layout::square}) text += by_pixels(garment, layout, most_pixels);
    geocloth::write_file(argv[1], text);
    return EXIT_SUCCESS;
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return EXIT_FAILURE;
  }
}
