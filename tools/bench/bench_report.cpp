// SPDX-License-Identifier: GPL-3.0-or-later
// Benchmark results as JSON and as text. Two reports are compared case by case: a case is what was asked for (scene,
// backend, threads, size, substeps), not which path the solver took.
#include "bench/bench_report.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

using nlohmann::ordered_json;

constexpr double kMillion = 1e6;

ordered_json to_json(const BenchResult& r) {
  ordered_json passes = ordered_json::object();
  for (const auto& [pass, ms] : r.passes_ms) passes[pass] = ms;
  return {{"scene", r.scene},
          {"backend", r.backend},
          {"device", r.device},
          {"path", r.path},
          {"threads", r.threads},
          {"cloths", r.cloths},
          {"width", r.width},
          {"height", r.height},
          {"particles", r.particles},
          {"springs", r.springs},
          {"substeps", r.substeps},
          {"frames", r.frames},
          {"ms_per_frame", r.ms_per_frame},
          {"ms_per_frame_min", r.ms_per_frame_min},
          {"springs_per_second", r.springs_per_second},
          {"roofline_share", r.roofline_share},
          {"memory_bytes", r.memory_bytes},
          {"stretch", {{"max", r.stretch.max}, {"p99", r.stretch.p99}, {"mean", r.stretch.mean}}},
          {"passes_ms", passes}};
}

std::string case_name(const ordered_json& result) {
  return fmt::format("{:<8} {:<6} {} thr {:>4} x {:<4} {:>2} sub", result.at("scene").get<std::string>(),
                     result.at("backend").get<std::string>(), result.at("threads").get<uint32_t>(),
                     result.at("width").get<uint32_t>(), result.at("height").get<uint32_t>(),
                     result.at("substeps").get<uint32_t>());
}

struct Report {
  double copy = 0, gflops = 0;
  std::vector<std::pair<std::string, double>> ms;  ///< case, milliseconds of a frame
};

Report read_report(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw Error(ErrorCode::io, path.string() + ": cannot be read");
  try {
    const ordered_json json = ordered_json::parse(text);
    Report report;
    report.copy = json.at("machine").at("copy_gb_per_s");
    report.gflops = json.at("machine").at("gflops");
    for (const ordered_json& result : json.at("results")) {
      const double ms = result.at("ms_per_frame");
      if (!(std::isfinite(ms) && ms > 0)) throw Error(ErrorCode::invalid_data, path.string() + ": a time is not > 0");
      report.ms.emplace_back(case_name(result), ms);
    }
    return report;
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::invalid_data,
                path.string() + ": is not what `geocloth bench --json` writes: " + error.what());
  }
}

}  // namespace

std::string bench_report(const MachineInfo& machine, const std::vector<BenchResult>& results) {
  ordered_json list = ordered_json::array();
  for (const BenchResult& result : results) list.push_back(to_json(result));
  const ordered_json report{{"machine",
                             {{"cpu", machine.cpu},
                              {"cores", machine.cores},
                              {"copy_gb_per_s", machine.copy_gb_per_s},
                              {"gflops", machine.gflops}}},
                            {"results", list}};
  return report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string describe(const MachineInfo& machine) {
  return fmt::format("{}, {} cores: copies {:.1f} GB/s, computes {:.0f} GFLOP/s", machine.cpu, machine.cores,
                     machine.copy_gb_per_s, machine.gflops);
}

std::string bench_table_head() {
  return fmt::format("{:<8} {:<7} {:<9} {:>7} {:>11} {:>9} {:>8} {:>9} {:>10} {:>8} {:>8} {:>8} {:>7}", "scene",
                     "backend", "path", "threads", "size", "particles", "substeps", "ms/frame", "Msprings/s",
                     "roofline", "max", "mean", "MiB");
}

std::string bench_table_line(const BenchResult& r) {
  constexpr double kPercent = 100, kMebibyte = 1024.0 * 1024.0;
  return fmt::format(
      "{:<8} {:<7} {:<9} {:>7} {:>11} {:>9} {:>8} {:>9.3f} {:>10.0f} {:>7.0f}% {:>+7.2f}% {:>+7.3f}% {:>7.1f}", r.scene,
      r.backend, r.path, r.threads, fmt::format("{} x {}", r.width, r.height), r.particles, r.substeps, r.ms_per_frame,
      r.springs_per_second / kMillion, kPercent * r.roofline_share, kPercent * (r.stretch.max - 1),
      kPercent * (r.stretch.mean - 1), static_cast<double>(r.memory_bytes) / kMebibyte);
}

std::string compare_bench_reports(const std::filesystem::path& before, const std::filesystem::path& after) {
  const Report a = read_report(before), b = read_report(after);
  const std::map<std::string, double> old(a.ms.begin(), a.ms.end());
  std::string text = fmt::format("{:<44} {:>10} {:>10} {:>8}\n", "case", "ms before", "ms after", "faster");
  double logarithms = 0;
  uint32_t common = 0;
  for (const auto& [name, ms] : b.ms) {
    const auto found = old.find(name);
    if (found == old.end()) continue;
    text += fmt::format("{:<44} {:>10.3f} {:>10.3f} {:>7.2f}x\n", name, found->second, ms, found->second / ms);
    logarithms += std::log(found->second / ms);
    ++common;
  }
  if (common == 0) {
    throw Error(ErrorCode::invalid_data,
                before.string() + " and " + after.string() + " have no case in common; measure the same ones");
  }
  return text + fmt::format(
                    "{} cases, {:.2f}x as fast (geometric mean); the machine copies {:.2f}x and computes "
                    "{:.2f}x as much as before\n",
                    common, std::exp(logarithms / common), b.copy / a.copy, b.gflops / a.gflops);
}

}  // namespace geocloth
