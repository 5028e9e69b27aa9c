// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include <CLI/App.hpp>

#include "file_names.h"
#include "geocloth/solver/scene.h"

namespace geocloth {

// What every command that plays scenes takes, reads and says alike.

/// The scene or asset itself.
void add_scene_input(CLI::App& app, std::filesystem::path& input);
/// --backend, --device and --threads.
void add_solver_options(CLI::App& app, SolverSettings& settings);
/// What those options begin with: all threads of the machine.
[[nodiscard]] SolverSettings default_solver_settings();

/// A scene file, or an asset (.glb), hung as default_scene says. @throws as read_scene
[[nodiscard]] Scene read_scene_or_asset(const std::filesystem::path& input);
/// Every file that playing a scene reads.
[[nodiscard]] std::vector<NamedFile> files_read(const std::filesystem::path& input, const Scene& scene);

}  // namespace geocloth
