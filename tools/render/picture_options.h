// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/App.hpp>

#include "render/render_options.h"

namespace geocloth {

/// --size. @param what  begins the help's sentence: "size of the pictures"
void add_size_option(CLI::App& app, RenderOptions& options, const std::string& what);
/// --show
void add_show_option(CLI::App& app, RenderOptions& options);
/// Adds --camera, --size and --show, the same in every command that draws files.
void add_picture_options(CLI::App& app, RenderOptions& options);

}  // namespace geocloth
