// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include <CLI/App.hpp>

namespace geocloth {

/// What a command does once its options are parsed. Throws geocloth::Error when the work fails (exit status 1).
using CommandRun = std::function<void()>;

/// Each tools/command_<name>.cpp defines one of these: it adds the command's options to `app` and returns its work.
/// Results go to standard output, progress and messages to standard error.
[[nodiscard]] CommandRun add_convert(CLI::App& app);
[[nodiscard]] CommandRun add_inspect(CLI::App& app);
[[nodiscard]] CommandRun add_simulate(CLI::App& app);
[[nodiscard]] CommandRun add_render(CLI::App& app);
[[nodiscard]] CommandRun add_view(CLI::App& app);
[[nodiscard]] CommandRun add_devices(CLI::App& app);
[[nodiscard]] CommandRun add_bench(CLI::App& app);

}  // namespace geocloth
