// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/App.hpp>

#include "render/render_options.h"

namespace geocloth {

/// Adds --camera, --size and --show, the same in every command that draws.
void add_picture_options(CLI::App& app, RenderOptions& options);

}  // namespace geocloth
