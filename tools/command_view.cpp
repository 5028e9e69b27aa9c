// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth view: a scene in a window, to be looked at and taken hold of.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "body_reader.h"
#include "command.h"
#include "file_error.h"
#include "file_names.h"
#include "geocloth/asset/output_file.h"
#include "options.h"
#include "render/picture_options.h"
#include "scene_input.h"
#include "view/controls.h"
#include "view/viewer.h"

namespace geocloth {
namespace {

std::string controls() {
  std::string text = "Mouse and keys:\n";
  for (const auto& [hand, what] : view::kControls) text += fmt::format("  {:<30}{}\n", hand, what);
  return text;
}

struct ViewArguments {
  std::filesystem::path input, screenshot;
  SolverSettings solver = default_solver_settings();
  RenderOptions picture;
  uint32_t frames = 0;
  CLI::Option* frames_option = nullptr;
  bool paused = false, play = false;
};

std::vector<NamedFile> written_files(const ViewArguments& options) {
  if (options.screenshot.empty()) return {};
  return {{"--screenshot", options.screenshot}};
}

Scene load_scene(const ViewArguments& options) {
  Scene scene = read_scene_or_asset(options.input);
  const std::string clash = find_name_clash(files_read(options.input, scene), written_files(options));
  if (!clash.empty()) throw Error(ErrorCode::invalid_argument, clash);
  return scene;
}

void run(const ViewArguments& options) {
  Scene scene = name_file_in_errors(options.input, [&] { return load_scene(options); });
  std::optional<OutputFile> screenshot;
  if (!options.screenshot.empty()) screenshot.emplace(options.screenshot);
  view::ViewerOptions window{.title = options.input.filename().string() + " - geocloth",
                             .size = options.picture.size,
                             .solver = options.solver,
                             .show = options.picture.show,
                             .play = !options.paused,
                             .frames = std::nullopt};
  if (options.frames_option->count() > 0) window.frames = options.frames;
  const auto viewer = name_file_in_errors(
      options.input, [&] { return std::make_unique<view::Viewer>(std::move(scene), window, body_reader()); });
  for (const std::string& warning : viewer->warnings()) say(fmt::format("geocloth view: {}\n", warning));
  while (viewer->turn()) {
  }
  if (!screenshot) return;
  screenshot->write(std::span<const std::byte>(encode_png(viewer->picture())));
  screenshot->commit();
  fmt::print("{}\n", options.screenshot.string());
}

}  // namespace

CommandRun add_view(CLI::App& app) {
  auto options = std::make_shared<ViewArguments>();
  app.footer(controls());
  add_scene_input(app, options->input);
  add_solver_options(app, options->solver);
  add_size_option(app, options->picture, "size of the window");
  add_show_option(app, options->picture);
  options->frames_option = add_number<uint32_t>(app, "--frames", "N", options->frames, 0, kMaxFrames, "frames",
                                                "close the window after so many were played", "none: it stays open");
  CLI::Option* paused =
      app.add_flag("--paused", options->paused, "wait for the space bar before the first frame [default off]");
  app.add_flag("--play", options->play, "play from the start [default on]")->excludes(paused);
  add_text(app, "-o,--screenshot", "FILE.png", options->screenshot, "write what the window shows when it closes",
           "default none")
      ->check(ends_with({".png"}));
  app.final_callback([options] {
    const std::string clash = find_name_clash({{"the scene", options->input}}, written_files(*options));
    if (!clash.empty()) throw CLI::ValidationError(clash);
  });
  return [options] { run(*options); };
}

}  // namespace geocloth
