// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth simulate: plays a scene frame by frame into any number of outputs and a report. All outputs are completed
// under temporary names first and get their final names together.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "body_reader.h"
#include "command.h"
#include "contact_check.h"
#include "export/cache_writer.h"
#include "file_error.h"
#include "file_names.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/output_file.h"
#include "geocloth/solver/scene.h"
#include "layer_check.h"
#include "options.h"
#include "progress.h"
#include "render/picture_options.h"
#include "render/picture_writers.h"
#include "scene_input.h"
#include "scene_warnings.h"
#include "simulation_report.h"

namespace geocloth {
namespace {

struct SimulateArguments {
  std::filesystem::path input, report, last_state;
  std::vector<std::string> outputs;
  uint32_t frames = 0;
  CLI::Option* frames_option = nullptr;
  SolverSettings solver = default_solver_settings();
  RenderOptions pictures;
  bool check = false, each_part = false, quiet = false;
};

Scene load_scene(const SimulateArguments& options) {
  Scene scene = read_scene_or_asset(options.input);
  if (options.frames_option->count() > 0) scene.frames = options.frames;
  return scene;
}

bool is_numbered(const std::filesystem::path& output) {
  const std::string ending = CLI::detail::to_lower(output.extension().string());
  return ending == ".obj" || ending == ".png" || ending == ".exr";
}

/// @param cloths  their number, several having files of their own where the format holds one; or all of them
template <typename Cloths>
std::vector<NamedFile> written_files(const SimulateArguments& options, const Cloths& cloths) {
  std::vector<NamedFile> files;
  for (const std::string& output : options.outputs) {
    for (const std::filesystem::path& path : output_names(output, cloths))
      files.push_back({"--output", path, is_numbered(output)});
  }
  if (!options.report.empty()) files.push_back({"--report", options.report});
  if (!options.last_state.empty()) files.push_back({"--last-state", options.last_state});
  return files;
}

/// What the scene names is known once it is read.
void check_files_of_scene(const SimulateArguments& options, const Scene& scene, const std::vector<NamedFile>& written) {
  const std::string clash = find_name_clash(files_read(options.input, scene), written);
  if (!clash.empty()) throw Error(ErrorCode::invalid_argument, clash);
}

SolverSettings solver_settings(const SimulateArguments& options) {
  SolverSettings settings = options.solver;
  // A scene can be checked on a machine without the device that it is to run on.
  if (options.check) settings.backend = Backend::cpu;
  settings.timings = settings.check_copies = !options.report.empty();
  return settings;
}

/// Reads every cloth back. @throws Error(verification) when a coordinate is not finite
void read_frames(Simulation& simulation, std::vector<ClothSnapshot>& frames) {
  Solver& solver = simulation.solver();
  frames.resize(solver.cloth_count());
  for (uint32_t i = 0; i < solver.cloth_count(); ++i) {
    const ClothAsset& asset = *simulation.cloths()[i].asset;
    frames[i].asset = simulation.cloths()[i].asset;
    solver.read_positions(i, frames[i].position);
    solver.read_normals(i, frames[i].normal);
    if (const uint64_t count = count_non_finite(asset, frames[i].position); count > 0) {
      throw Error(ErrorCode::verification,
                  fmt::format("frame {}, cloth {} ({}): {} of its points are not finite numbers any more: the motion "
                              "blew up; use more substeps, a softer material or slower keyframes",
                              simulation.frame(), i, simulation.scene().cloths[i].asset.string(), count));
    }
    evaluate_binding(asset, frames[i].position, frames[i].normal, frames[i].source_position,
                     simulation.cloths()[i].transform.scale);
  }
}

/// The welded grid meshes of all cloths in one.
GridMesh last_state_mesh(const Simulation& simulation, const std::vector<ClothSnapshot>& frames) {
  GridMesh all;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const GridMesh mesh = welded_grid_mesh(*simulation.cloths()[i].asset, frames[i].position);
    const auto first = static_cast<uint32_t>(all.position.size());
    all.position.insert(all.position.end(), mesh.position.begin(), mesh.position.end());
    all.pixel.insert(all.pixel.end(), mesh.pixel.begin(), mesh.pixel.end());
    all.uv.insert(all.uv.end(), mesh.uv.begin(), mesh.uv.end());
    for (const Triangle& t : mesh.triangle) all.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

std::string counted(uint64_t count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

void print_check(const SimulateArguments& options, Simulation& simulation) {
  const Scene& scene = simulation.scene();
  fmt::print("{}: good: {} with {}, {}, {} at {} a second, {}\n", options.input.string(),
             counted(scene.cloths.size(), "cloth"), counted(simulation.solver().statistics().particles, "particle"),
             counted(scene.colliders.size(), "collider"), counted(scene.frames, "frame"), scene.frame_rate,
             counted(scene.substeps, "substep"));
}

void print_warnings(const SimulateArguments& options, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings)
    say(fmt::format("geocloth simulate: {}: warning: {}\n", options.input.string(), warning));
}

CacheDescription describe_caches(const SimulateArguments& options, const Simulation& simulation) {
  CacheDescription description = describe(simulation);
  description.each_part = options.each_part;
  return description;
}

std::unique_ptr<FrameWriter> make_writer(const std::filesystem::path& path, Simulation& simulation,
                                         const SimulateArguments& options) {
  const std::string ending = CLI::detail::to_lower(path.extension().string());
  if (ending == ".png") return make_picture_series_writer(path, simulation, options.pictures);
  if (ending == ".mp4") return make_video_writer(path, simulation, options.pictures);
  return make_cache_writer(path, describe_caches(options, simulation));
}

/// What stops a scene on its way is an error of the scene, at a time.
void step(const SimulateArguments& options, Simulation& simulation) {
  try {
    simulation.step();
    simulation.solver().wait();
  } catch (const Error& error) {
    throw Error(error.code(),
                fmt::format("{}: frame {}: {}", options.input.string(), simulation.frame(), error.what()));
  }
}

void play(const SimulateArguments& options, Simulation& simulation) {
  std::vector<std::unique_ptr<FrameWriter>> writers;
  for (const std::string& output : options.outputs) writers.push_back(make_writer(output, simulation, options));
  std::vector<std::unique_ptr<OutputFile>> files;
  const auto open = [&](const std::filesystem::path& path) {
    return path.empty() ? nullptr : files.emplace_back(std::make_unique<OutputFile>(path)).get();
  };
  OutputFile* const report_file = open(options.report);
  OutputFile* const last_state_file = open(options.last_state);

  const bool read_every_frame =
      report_file != nullptr ||
      std::any_of(writers.begin(), writers.end(), [](const auto& w) { return w->needs_cloth_snapshots(); });
  const uint32_t frames = simulation.scene().frames;
  std::optional<ProgressDisplay> progress(std::in_place, "simulate", options.quiet);
  std::vector<ClothSnapshot> state;
  SimulationRecorder recorder;
  ContactCheck contact(simulation);
  const LayerCheck layers(simulation);
  std::vector<std::string> warnings = scene_warnings(simulation);
  for (uint32_t frame = 0;; ++frame) {
    if (read_every_frame || frame == frames) {
      read_frames(simulation, state);
      if (frame == frames || (frame > 0 && report_file != nullptr)) contact.add_frame(simulation, state);
    }
    for (const auto& writer : writers) writer->add_frame(simulation, state);
    progress->show("frame", frames == 0 ? 1.0 : static_cast<double>(frame) / frames);
    if (frame == frames) break;
    const auto start = std::chrono::steady_clock::now();
    step(options, simulation);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    recorder.add_frame_time(simulation, seconds.count());
    if (report_file != nullptr) {
      recorder.add_energy(simulation);
      recorder.add_contact_forces(simulation);
    }
  }

  for (const auto& more : {played_warnings(simulation), contact.warnings(simulation), layers.warnings(simulation),
                           layers.played_warnings(simulation)})
    warnings.insert(warnings.end(), more.begin(), more.end());
  if (report_file != nullptr) report_file->write(recorder.report(simulation, state, contact, warnings));
  if (last_state_file != nullptr) last_state_file->write(to_obj(last_state_mesh(simulation, state), false));
  for (const auto& file : files) file->close();
  for (const auto& writer : writers) writer->finish();
  for (const auto& writer : writers) writer->commit();
  for (const auto& file : files) file->commit();
  progress.reset();
  for (const std::string& output : options.outputs) {
    for (const std::filesystem::path& path : output_names(output, describe_caches(options, simulation)))
      fmt::print("{}\n", path.string());
  }
  fmt::print("{}\n", recorder.summary(simulation));
  print_warnings(options, warnings);
}

void run(const SimulateArguments& options) {
  Simulation simulation = name_file_in_errors(options.input, [&] {
    Scene scene = load_scene(options);
    check_files_of_scene(options, scene, written_files(options, scene.cloths.size()));
    return Simulation(std::move(scene), solver_settings(options), body_reader());
  });
  const std::vector<NamedFile> written = written_files(options, describe_caches(options, simulation));
  check_files_of_scene(options, simulation.scene(), written);
  if (options.check) {
    print_check(options, simulation);
    print_warnings(options, scene_warnings(simulation));
    print_warnings(options, ContactCheck(simulation).warnings(simulation));
    print_warnings(options, LayerCheck(simulation).warnings(simulation));
  } else {
    play(options, simulation);
  }
}

}  // namespace

CommandRun add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateArguments>();
  add_scene_input(app, options->input);
  CLI::Option* output = add_text(app, "-o,--output", "OUT", options->outputs,
                                 "what to write, by its ending: .glb (animated), .usda (the same for USD), .pc2, .mdd, "
                                 ".obj (numbered), .png (numbered), .mp4, "
                                 ".exr (numbered); may be given several times",
                                 "default none")
                            ->check(ends_with({".glb", ".usda", ".pc2", ".mdd", ".obj", ".png", ".mp4", ".exr"}))
                            ->allow_extra_args(false);
  app.add_flag("--each-part", options->each_part,
               "a point cache (.pc2, .mdd) for each part of the file that was converted, of its vertices alone, as an "
               "object of a modelling program has them: OUT_PART.pc2 [default off: of all the file's]");
  options->frames_option = add_number<uint32_t>(app, "--frames", "N", options->frames, 0, kMaxFrames, "frames",
                                                "how long to run", "what the scene says");
  add_solver_options(app, options->solver);
  add_picture_options(app, options->pictures);
  CLI::Option* report = add_text(
      app, "--report", "R.json", options->report,
      "write times, stretch, energy and checks as JSON; checks every substep, which costs time", "default none");
  CLI::Option* last_state = add_text(app, "--last-state", "OUT.obj", options->last_state,
                                     "write the welded grid mesh after the last frame", "default none")
                                ->check(ends_with({".obj"}));
  CLI::Option* check =
      app.add_flag("--check", options->check, "only read the scene and its assets and say what is wrong [default off]");
  add_quiet(app, options->quiet);
  app.final_callback([options, output, report, last_state, check] {
    if (const std::string clash = find_name_clash({{"the scene", options->input}}, written_files(*options, size_t{1}));
        !clash.empty())
      throw CLI::ValidationError(clash);
    if (output->count() + report->count() + last_state->count() + check->count() == 0) {
      throw CLI::RequiredError("one of --output, --report, --last-state or --check");
    }
  });
  return [options] { run(*options); };
}

}  // namespace geocloth
