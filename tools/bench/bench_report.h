// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_run.h"
#include "bench/machine.h"

namespace geocloth {

/// `machine` and `results` as JSON text, for programs and for compare_bench_reports().
[[nodiscard]] std::string bench_report(const MachineInfo& machine, const std::vector<BenchResult>& results);

/// Lines for people.
[[nodiscard]] std::string describe(const MachineInfo& machine);
[[nodiscard]] std::string bench_table_head();
[[nodiscard]] std::string bench_table_line(const BenchResult& result);

/// Case by case, how much faster the second report is than the first, with the machines' own change beside it.
/// @throws Error(io), Error(invalid_data) naming the file that is no such report, or when they have no case in common
[[nodiscard]] std::string compare_bench_reports(const std::filesystem::path& before,
                                                const std::filesystem::path& after);

}  // namespace geocloth
