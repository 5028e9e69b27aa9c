// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_options.h"

#include <fmt/format.h>

#include "geocloth/asset/error.h"
#include "options.h"

namespace geocloth {
namespace {

/// An option whose text is read by a function that throws Error when it is not good: then it is wrong usage.
template <class Value, class Parse>
void add_parsed(CLI::App& app, const std::string& name, const std::string& placeholder, Value& value, Parse parse,
                const std::string& text) {
  const auto take = [&value, parse, name](const std::string& given) {
    try {
      value = parse(given);
    } catch (const Error& error) {
      throw CLI::ValidationError(name + ": " + error.what());
    }
  };
  app.add_option_function<std::string>(name, take, text)->option_text(placeholder);
}

}  // namespace

void add_size_option(CLI::App& app, RenderOptions& options, const std::string& what) {
  add_parsed(app, "--size", "WxH", options.size, parse_size,
             fmt::format("{0} [pixels; from {1}x{1} to {2}x{2}; default {3}x{4}]", what, kMinPictureSide,
                         kMaxRenderSide, options.size.width, options.size.height));
}

void add_show_option(CLI::App& app, RenderOptions& options) {
  add_choice<Show>(app, "--show", options.show, {kShowNames.begin(), kShowNames.end()},
                   "the garment, or the grid that is simulated: plain, by strain, by chart, with its seams");
}

void add_picture_options(CLI::App& app, RenderOptions& options) {
  add_parsed(
      app, "--camera", "A,E[,D]", options.camera, parse_camera,
      "where to look from: azimuth,elevation or azimuth,elevation,distance round the garment (azimuth 0 from +z, "
      "90 from +x), or six numbers: eye and target [degrees, m; default 30,12, as near as all is seen]");
  add_size_option(app, options, "size of the pictures");
  add_show_option(app, options);
}

}  // namespace geocloth
