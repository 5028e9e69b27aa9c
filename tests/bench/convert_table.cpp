// SPDX-License-Identifier: GPL-3.0-or-later
// Converts every mesh of a folder in each layout and writes what came out as Markdown tables, one line per file, with
// what misses its target marked; or the reason why a file was refused. Times stand in a table of their own, so that a
// change of the other lines in git is a change of the geometry.
//
//   convert_table FOLDER OUT.md [--resolution N] [--compare OLD.md] [--only PART_OF_NAME] [--jobs N]
//
// Rows that are done stand in OUT.md.part until the table is whole: the same program, ended early, goes on from there.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "child_run.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/parametrize/convert.h"
#include "markdown_table.h"
#include "report/targets.h"

namespace geocloth::bench {
namespace {

constexpr unsigned kLimitSeconds = 900;
constexpr char kNextCell = '\t';

struct Settings {
  std::filesystem::path folder, out, old;
  std::string only;
  uint32_t resolution = FlattenOptions{}.resolution;
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());
};

std::string number(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// The measures of the report that the table shows, and which way is better.
struct Column {
  const char* key;
  const char* title;
  Better better;
};
constexpr Column kColumns[] = {{"l2_stretch", "L2 stretch", Better::less},
                               {"symmetric_dirichlet", "Dirichlet", Better::less},
                               {"anisotropy_p95", "anisotropy p95", Better::less},
                               {"spring_p99_over_p1", "springs p99/p1", Better::less},
                               {"spring_min", "spring min", Better::more},
                               {"spring_max", "spring max", Better::less},
                               {"shear_deg_p50", "angle p50", Better::less},
                               {"shear_deg_p95", "angle p95", Better::less},
                               {"psnr_db", "PSNR", Better::more},
                               {"max_error", "deviation", Better::less},
                               {"seam_length", "seam", Better::less},
                               {"border_share", "border", Better::less},
                               {"utilisation", "utilisation", Better::more}};
constexpr const char* kMissed = "missed";

/// Seams are to be no longer than those of the best peer, where there is one (OptCuts, measured; its skirt is another
/// one of DiffCloth's, nearly a disk like this one), and squares no more stretched than by the best implementation of
/// the published method (OpenGI, measured).
struct PeerTarget {
  const char* mesh;
  Layout layout;
  const char* key;
  double at_most;
};
constexpr PeerTarget kPeerTargets[] = {{"diffcloth_tshirt", Layout::panels, "seam_length", 1.79},
                                       {"diffcloth_sock", Layout::panels, "seam_length", 1.69},
                                       {"diffcloth_skirt_handsup", Layout::panels, "seam_length", 0.59},
                                       {"diffcloth_tshirt", Layout::square, "l2_stretch", 1.434},
                                       {"diffcloth_sock", Layout::square, "l2_stretch", 1.290}};

double peer_measure(const Quality& q, const std::string& key) {
  return key == "seam_length" ? q.seam_length : q.l2_stretch;
}

/// Only garments have targets.
bool is_garment(const std::filesystem::path& file) {
  return file.parent_path().filename() == "garments";
}

/// Bold where the target is missed, in italics where it is missed by little.
std::string marked(const Measure& measure, const std::filesystem::path& file, const ConvertResult& result) {
  std::string value = measure.value.substr(0, measure.value.find_first_of(" \xC2"));  // without a unit
  Verdict verdict = is_garment(file) ? measure.verdict : Verdict::none;
  for (const PeerTarget& peer : kPeerTargets) {
    if (measure.key != peer.key || file.stem() != peer.mesh || result.asset.layout != peer.layout) continue;
    verdict = peer_measure(result.report.quality, peer.key) <= peer.at_most ? Verdict::met : Verdict::missed;
  }
  if (verdict == Verdict::missed) return "**" + value + "**";
  return verdict == Verdict::near ? "*" + value + "*" : value;
}

std::string topology(const Topology& t) {
  return std::to_string(t.components) + " / " + std::to_string(t.boundary_loops) + " / " +
         std::to_string(t.euler_characteristic);
}

/// Runs in the child: all cells but the name, then the seconds of every stage.
std::string convert_to_cells(const std::filesystem::path& file, const ConvertOptions& options) {
  const ConvertResult result = convert(file, options);
  const ConvertReport& report = result.report;
  std::vector<std::string> cells{std::to_string(report.source_faces), topology(report.represented),
                                 std::to_string(report.carried.size()), std::to_string(result.asset.chart_count)};
  const std::vector<MeasureGroup> groups = judge(result);
  std::size_t missed = 0;
  for (const Column& column : kColumns) {
    for (const MeasureGroup& group : groups) {
      for (const Measure& measure : group.measures) {
        if (measure.key != column.key) continue;
        cells.push_back(marked(measure, file, result));
        if (cells.back().starts_with('*')) ++missed;
      }
    }
  }
  cells.push_back(std::to_string(missed));
  std::string stages;
  for (const auto& [stage, seconds] : report.seconds) stages += stage + " " + number(seconds, 2) + ", ";
  cells.push_back(stages.substr(0, stages.size() - 2));
  std::string text;
  for (const std::string& cell : cells) text += cell + kNextCell;
  return text;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> cells;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find(kNextCell, at);
    cells.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return cells;
}

std::vector<std::filesystem::path> meshes_in(const Settings& settings) {
  const std::set<std::string> endings{".obj", ".gltf", ".glb", ".ply", ".stl", ".off", ".fbx", ".dae"};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(settings.folder)) {
    const bool wanted = entry.path().string().find(settings.only) != std::string::npos;
    if (wanted && endings.contains(entry.path().extension().string())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The reason of a refusal, with the file's folder left out: that is different everywhere.
std::string without_folder(std::string text, const std::filesystem::path& file) {
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
    text.erase(at, folder.size());
  return text;
}

/// A mesh in one layout.
struct Row {
  std::vector<std::string> cells;  ///< of the table of measures
  std::vector<std::string> time;   ///< of the table of times; empty where the mesh was refused
};

/// Rows that are done, by layout and mesh, kept in a file while the others are made.
class DoneRows {
 public:
  DoneRows(const Settings& settings, const std::filesystem::path& file) : file_(file) {
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
    const std::string key = std::to_string(settings.resolution) + " " +
                            std::to_string(std::filesystem::last_write_time(program).time_since_epoch().count());
    std::ifstream before(file_);
    std::string line;
    const bool same = std::getline(before, line) && line == key;
    while (same && std::getline(before, line)) {
      std::vector<std::string> cells = split(line);
      const auto at = cells.begin() + 2;
      const auto times = static_cast<std::ptrdiff_t>(std::stoul(cells[1]));
      rows_[cells[0]] = {{at + times, cells.end()}, {at, at + times}};
    }
    before.close();
    out_.open(file_, same ? std::ios::app : std::ios::trunc);
    if (!same) out_ << key << std::endl;
  }

  [[nodiscard]] const Row* find(const std::string& name) const {
    const auto found = rows_.find(name);
    return found == rows_.end() ? nullptr : &found->second;
  }
  void add(const std::string& name, const Row& row) {
    rows_[name] = row;
    out_ << name << kNextCell << row.time.size() << kNextCell;
    for (const auto& cells : {row.time, row.cells}) {
      for (const std::string& cell : cells) out_ << cell << kNextCell;
    }
    out_ << std::endl;
  }
  void forget() {
    out_.close();
    std::filesystem::remove(file_);
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::map<std::string, Row> rows_;
};

constexpr Layout kLayouts[] = {Layout::panels, Layout::square};

struct Job {
  std::string mesh;  ///< relative to the folder
  std::filesystem::path file;
  Layout layout;
  [[nodiscard]] std::string name() const { return std::string(geocloth::to_string(layout)) + " " + mesh; }
};

Row to_row(const Job& job, const ChildRun& run) {
  Row row{{job.mesh}, {}};
  if (!run.done) {
    row.cells.push_back(without_folder(run.text, job.file));
    std::replace(row.cells.back().begin(), row.cells.back().end(), '\n', ' ');
    return row;
  }
  const std::vector<std::string> cells = split(run.text);
  row.cells.insert(row.cells.end(), cells.begin(), cells.end() - 1);
  row.time = {job.mesh, number(run.cpu_seconds, 2), std::to_string(run.peak_memory_bytes >> 20U), cells.back()};
  return row;
}

/// Converts what is not done yet, the largest files first, so that no long one is alone at the end.
void make_rows(const Settings& settings, std::vector<Job> jobs, DoneRows& rows) {
  std::erase_if(jobs, [&](const Job& job) { return rows.find(job.name()) != nullptr; });
  std::stable_sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) {
    return std::filesystem::file_size(a.file) > std::filesystem::file_size(b.file);
  });
  const auto convert_one = [&](std::size_t i) {
    ConvertOptions options;
    options.flatten.layout = jobs[i].layout;
    options.flatten.resolution = settings.resolution;
    options.square_if_panels_fail = false;
    return convert_to_cells(jobs[i].file, options);
  };
  run_in_children(jobs.size(), convert_one, settings.jobs, kLimitSeconds, [&](std::size_t i, const ChildRun& run) {
    const Row row = to_row(jobs[i], run);
    rows.add(jobs[i].name(), row);
    std::cout << geocloth::to_string(jobs[i].layout) << " | ";
    for (const std::string& cell : row.cells) std::cout << cell << " | ";
    std::cout << number(run.cpu_seconds, 2) << " s" << std::endl;
  });
}

struct LayoutTables {
  MarkdownTable measures, times;
  std::string summary;
};

LayoutTables tables_of(const std::vector<Job>& jobs, Layout layout, const DoneRows& rows) {
  const std::string name = geocloth::to_string(layout);
  LayoutTables tables;
  tables.measures = {name, {"mesh", "faces", "surface", "carried", "charts"}, {}};
  for (const Column& column : kColumns) tables.measures.column.emplace_back(column.title);
  tables.measures.column.emplace_back(kMissed);
  tables.times = {name + ", time and memory", {"mesh", "CPU seconds", "MiB", "stages"}, {}};
  std::size_t all = 0, garments = 0, all_met = 0;
  for (const Job& job : jobs) {
    if (job.layout != layout) continue;
    const Row& row = *rows.find(job.name());
    ++all;
    tables.measures.row.push_back(row.cells);
    if (row.time.empty()) continue;
    tables.times.row.push_back(row.time);
    if (!is_garment(job.file)) continue;
    ++garments;
    if (row.cells.back() == "0") ++all_met;
  }
  tables.summary = "- " + name + ": " + std::to_string(tables.times.row.size()) + " of " + std::to_string(all) +
                   " converted; " + std::to_string(all_met) + " of " + std::to_string(garments) +
                   " garments miss nothing.\n";
  return tables;
}

std::string text_of(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = read_file(file);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

int run(const Settings& settings) {
  std::vector<Job> jobs;
  for (const Layout layout : kLayouts) {
    for (const auto& file : meshes_in(settings)) {
      jobs.push_back({std::filesystem::relative(file, settings.folder).string(), file, layout});
    }
  }
  DoneRows rows(settings, settings.out.string() + ".part");
  make_rows(settings, jobs, rows);
  std::string measures, times, summary;
  for (const Layout layout : kLayouts) {
    const LayoutTables tables = tables_of(jobs, layout, rows);
    measures += to_markdown(tables.measures);
    times += to_markdown(tables.times);
    summary += tables.summary;
  }
  const std::string text =
      "# Conversion of the shared meshes\n\n"
      "Made by `convert_table ../shared/meshes tests/bench/results/convert.md`; `--compare OLD.md` says what got "
      "better "
      "or worse. Resolution " +
      std::to_string(settings.resolution) +
      ". Surface: components / boundary loops / Euler characteristic, which the image has too or the asset would have "
      "been refused. Springs are structural, relative to the nominal spacing; angles in degrees off a right one, PSNR "
      "in "
      "dB, deviation relative to the diagonal, seam relative to the square root of the area, border and utilisation in "
      "percent of the pixels. Conversions run side by side, so times of stages are longer than alone; CPU seconds are "
      "not. **Bold**: a target is missed; *italics*: by little; \"missed\" counts both. Targets are "
      "those "
      "of `tools/report/targets.cpp`, and hold for garments.\n\n" +
      summary + "\n" + measures + times;
  if (!settings.old.empty()) {
    std::map<std::string, Better> direction{
        {kMissed, Better::less}, {"CPU seconds", Better::less}, {"MiB", Better::less}};
    for (const Column& column : kColumns) direction[column.title] = column.better;
    std::cout << '\n'
              << differences(parse_markdown(text_of(settings.old)), parse_markdown(text), direction) << std::flush;
  }
  write_file(settings.out, text);
  rows.forget();
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace geocloth::bench

int main(int argc, char** argv) {
  geocloth::bench::Settings settings;
  bool good = argc >= 3 && argc % 2 == 1;
  if (good) {
    settings.folder = argv[1];
    settings.out = argv[2];
  }
  try {
    for (int i = 3; good && i < argc; i += 2) {
      const std::string option = argv[i], value = argv[i + 1];
      if (option == "--resolution") {
        settings.resolution = static_cast<uint32_t>(std::stoul(value));
      } else if (option == "--compare") {
        settings.old = value;
      } else if (option == "--only") {
        settings.only = value;
      } else if (option == "--jobs") {
        settings.jobs = std::max(1U, static_cast<unsigned>(std::stoul(value)));
      } else {
        good = false;
      }
    }
    if (good) return geocloth::bench::run(settings);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return EXIT_FAILURE;
  }
  std::cerr
      << "usage: convert_table FOLDER OUT.md [--resolution N] [--compare OLD.md] [--only PART_OF_NAME] [--jobs N]\n";
  return 2;
}
