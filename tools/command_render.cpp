// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth render: pictures of an asset or of a cached motion. A still, a contact sheet of several moments, or a film;
// of an asset, which does not move, the sheet and the film go round it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "command.h"
#include "export/cache_reader.h"
#include "file_error.h"
#include "geocloth/asset/asset_file.h"
#include "options.h"
#include "progress.h"
#include "render/canvas.h"
#include "render/picture_options.h"
#include "render/playback.h"
#include "render/renderer.h"
#include "render/video.h"

namespace geocloth {
namespace {

constexpr uint32_t kMaxSheet = 400;
constexpr double kTurntableRate = 30;       ///< [1/s]
constexpr uint32_t kTurntableFrames = 180;  ///< once round in six seconds

struct RenderArguments {
  std::filesystem::path input, asset, output;
  RenderOptions render;
  uint32_t frame = 0, sheet = 0;
  CLI::Option* frame_option = nullptr;
  double frame_rate = 60;
  CLI::Option* frame_rate_option = nullptr;
  bool quiet = false;
};

std::string ending_of(const std::filesystem::path& path) {
  return CLI::detail::to_lower(path.extension().string());
}

double frame_rate(const RenderArguments& options, double of_cache) {
  return options.frame_rate_option->count() > 0 ? options.frame_rate : of_cache;
}

/// Positions of the render vertices from those of the vertices of the file.
std::vector<Vec3> in_render_order(const SourceMesh& source, std::vector<Vec3> points) {
  add_middles(source, points);
  std::vector<Vec3> positions;
  positions.reserve(source.source_vertex.size());
  for (const uint32_t v : source.source_vertex) positions.push_back(points[v]);
  return positions;
}

Playback open_point_cache(const RenderArguments& options) {
  if (options.asset.empty())
    throw Error(ErrorCode::invalid_argument,
                options.input.string() + ": a point cache has no mesh; name the garment with --asset ASSET.glb");
  const SourceMesh source = read_asset(options.asset).source;
  const PointCache cache = read_point_cache(options.input);
  if (cache.points != source.file_vertex_count())
    throw Error(ErrorCode::invalid_data,
                fmt::format("{}: the cache has {} points, {} has {} vertices; give the asset that was simulated",
                            options.input.string(), cache.points, options.asset.string(), source.file_vertex_count()));
  std::vector<std::vector<std::vector<Vec3>>> frames;
  for (const std::vector<Vec3>& points : cache.frames) frames.push_back({in_render_order(source, points)});
  return play_vertices({source}, std::move(frames), frame_rate(options, cache.frame_rate.value_or(60)));
}

/// An asset where the file is one, else an animated .glb.
Playback open_gltf(const RenderArguments& options) {
  try {
    return play_asset(std::make_shared<const ClothAsset>(read_asset(options.input)));
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unsupported) throw;
  }
  Cache cache = read_gltf_cache(options.input);
  return play_vertices(std::move(cache.cloths), std::move(cache.frames), frame_rate(options, cache.frame_rate),
                       cache.open_from);
}

Playback open_playback(const RenderArguments& options) {
  Playback playback = ending_of(options.input) == ".glb" ? open_gltf(options) : open_point_cache(options);
  if (playback.frame_count == 0)
    throw Error(ErrorCode::invalid_data, options.input.string() + ": the cache has no frame; simulate again");
  return playback;
}

/// One picture of the output: a frame of the motion, or a view of what stands still.
struct Shot {
  size_t frame = 0;
  CameraChoice camera;
  std::string label;
};

/// Once round, beginning where the camera was asked for; a camera with a fixed eye stays.
CameraChoice turned(const CameraChoice& choice, double turns) {
  CameraChoice camera = choice;
  if (auto* orbit = std::get_if<OrbitCamera>(&camera)) orbit->azimuth_deg += static_cast<float>(360 * turns);
  return camera;
}

std::vector<Shot> views_round(const RenderArguments& options, uint32_t count) {
  std::vector<Shot> shots;
  for (uint32_t i = 0; i < count; ++i) {
    const double turns = static_cast<double>(i) / count;
    shots.push_back({0, turned(options.render.camera, turns), fmt::format("{:.0f} degrees", 360 * turns)});
  }
  return shots;
}

std::vector<Shot> moments(const RenderArguments& options, size_t frame_count, uint32_t count) {
  std::vector<Shot> shots;
  for (uint32_t i = 0; i < count; ++i) {
    const size_t frame = count < 2 ? frame_count - 1 : (frame_count - 1) * i / (count - 1);
    if (shots.empty() || shots.back().frame != frame)
      shots.push_back({frame, options.render.camera, fmt::format("frame {}", frame)});
  }
  return shots;
}

std::vector<Shot> plan_shots(const RenderArguments& options, const Playback& playback) {
  const bool moves = playback.frame_count > 1;
  const bool film = ending_of(options.output) == ".mp4";
  if (film && !moves) return views_round(options, kTurntableFrames);
  if (film) return moments(options, playback.frame_count, static_cast<uint32_t>(playback.frame_count));
  if (options.sheet > 0)
    return moves ? moments(options, playback.frame_count, options.sheet) : views_round(options, options.sheet);
  const size_t frame = options.frame_option->count() > 0 ? options.frame : playback.frame_count - 1;
  if (frame >= playback.frame_count)
    throw Error(ErrorCode::invalid_argument, fmt::format("{}: there is no frame {}; the last one is {}",
                                                         options.input.string(), frame, playback.frame_count - 1));
  return {{frame, options.render.camera, {}}};
}

/// Draws shot after shot and gives each picture to `take`.
template <class Take>
void draw_shots(const RenderArguments& options, const Playback& playback, const std::vector<Shot>& shots, Take&& take) {
  Renderer renderer(playback.scene, options.render);
  for (const std::string& warning : renderer.warnings()) say(fmt::format("geocloth render: {}\n", warning));
  ProgressDisplay progress("render", options.quiet);
  std::vector<PlayedCloth> state;
  std::optional<size_t> drawn;
  for (size_t i = 0; i < shots.size(); ++i) {
    if (drawn != shots[i].frame) state = playback.state(shots[i].frame);
    drawn = shots[i].frame;
    renderer.set_camera(shots[i].camera);
    std::vector<ClothState> states;
    states.reserve(state.size());
    for (const PlayedCloth& cloth : state) states.push_back({cloth.position, cloth.normal});
    take(renderer.render({}, states), shots[i]);
    progress.show("picture", static_cast<double>(i + 1) / static_cast<double>(shots.size()));
  }
}

void write_film(const RenderArguments& options, const Playback& playback, const std::vector<Shot>& shots) {
  const double rate = playback.frame_count > 1 ? playback.frame_rate : kTurntableRate;
  VideoWriter video(options.output, options.render.size.width, options.render.size.height, rate);
  draw_shots(options, playback, shots, [&](const Picture& picture, const Shot&) { video.add(picture); });
  video.finish();
  video.commit();
}

void write_picture(const RenderArguments& options, const Playback& playback, const std::vector<Shot>& shots) {
  OutputFile file(options.output);
  std::vector<Picture> pictures;
  std::vector<std::string> labels;
  draw_shots(options, playback, shots, [&](Picture picture, const Shot& shot) {
    pictures.push_back(std::move(picture));
    labels.push_back(shot.label);
  });
  const Picture result =
      options.sheet > 0 ? contact_sheet(pictures, labels, options.render.size.width) : std::move(pictures.front());
  file.write(std::span<const std::byte>(encode_png(result)));
  file.commit();
}

void run(const RenderArguments& options) {
  const bool film = ending_of(options.output) == ".mp4";
  Playback playback = name_file_in_errors(options.input, [&] { return open_playback(options); });
  if (playback.is_cache && options.render.show != Show::cloth)
    throw Error(ErrorCode::unsupported,
                options.input.string() +
                    ": a cache holds the garment and not the grid, so --show can only be cloth; "
                    "draw the scene with simulate --show, or the asset");
  const std::vector<Shot> shots = plan_shots(options, playback);
  playback.scene.all_round = playback.frame_count == 1 && shots.size() > 1;
  if (film)
    write_film(options, playback, shots);
  else
    write_picture(options, playback, shots);
  fmt::print("{}\n", options.output.string());
}

}  // namespace

CommandRun add_render(CLI::App& app) {
  auto options = std::make_shared<RenderArguments>();
  add_text(app, "input", "ASSET_OR_CACHE", options->input,
           "an asset (.glb), or a motion that simulate wrote (.glb, .pc2, .mdd)", "required")
      ->required()
      ->check(ends_with({".glb", ".pc2", ".mdd"}));
  add_text(app, "-o,--output", "OUT.png|.mp4", options->output,
           "a picture or a film; the film of an asset goes round it", "required")
      ->required()
      ->check(ends_with({".png", ".mp4"}));
  add_text(app, "--asset", "ASSET.glb", options->asset, "the garment of a .pc2 or .mdd", "default none")
      ->check(ends_with({".glb"}));
  add_picture_options(app, options->render);
  options->frame_option = add_number<uint32_t>(app, "--frame", "N", options->frame, 0, kMaxFrames, "frame",
                                               "which frame of a motion a picture shows", "the last");
  CLI::Option* sheet =
      add_number<uint32_t>(app, "--sheet", "N", options->sheet, 1, kMaxSheet, "pictures",
                           "a contact sheet of so many moments, or views of an asset; --size is that of each", "none");
  sheet->excludes(options->frame_option);
  options->frame_rate_option = add_number<double>(app, "--frame-rate", "R", options->frame_rate, 0.1, 1000, "1/s",
                                                  "of a film of a motion", "what the cache says, 60 for a .pc2");
  add_text(app, "--device", "NAME", options->render.device, "part of the name of a Vulkan device that can draw",
           "default the best one");
  add_quiet(app, options->quiet);
  return [options] { run(*options); };
}

}  // namespace geocloth
