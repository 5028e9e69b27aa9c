// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_input.h"

#include <algorithm>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "export/cache_reader.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/parametrize/animated_mesh.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/parts.h"
#include "options.h"

namespace geocloth {

void add_scene_input(CLI::App& app, std::filesystem::path& input) {
  add_text(
      app, "scene", "SCENE", input,
      "a scene file (.json), or an asset (.glb), which is hung by its highest boundary (by its top where that goes far "
      "down; a level sheet by one end)",
      "required")
      ->required()
      ->check(ends_with({".json", ".glb"}));
}

void add_solver_options(CLI::App& app, SolverSettings& settings) {
  add_choice<Backend>(app, "--backend", settings.backend,
                      {{"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"vulkan", Backend::vulkan}},
                      "what runs the solver; auto: a real GPU if there is one, else cpu");
  add_text(app, "--device", "NAME", settings.device, "part of a device's name as `geocloth devices` lists it",
           "default the first of the backend");
  add_number<uint32_t>(app, "--threads", "N", settings.threads, 1, kMaxThreads, "threads",
                       "for the cpu backend; the result does not depend on it", "all of the machine's");
}

SolverSettings default_solver_settings() {
  SolverSettings settings;
  settings.threads = std::clamp(std::thread::hardware_concurrency(), 1U, kMaxThreads);
  return settings;
}

Scene read_scene_or_asset(const std::filesystem::path& input) {
  const bool is_asset = CLI::detail::to_lower(input.extension().string()) == ".glb";
  return is_asset ? default_scene(input) : read_scene(input);
}

TriangleSurface read_body(const SceneMesh& body) {
  TriangleMesh mesh = import_mesh(body.file);
  if (!body.parts.empty()) mesh = select_parts(with_choosable_parts(std::move(mesh)), body.parts);
  TriangleSurface surface;
  surface.position.reserve(mesh.position.size());
  for (const auto& p : mesh.position)
    surface.position.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  surface.triangle.assign(mesh.triangle.begin(), mesh.triangle.end());
  return surface;
}

PosedVertices read_vertices(const SceneStart& start) {
  const std::string ending = CLI::detail::to_lower(start.file.extension().string());
  if (ending != ".pc2" && ending != ".mdd") {
    if (start.frame)
      throw Error(ErrorCode::invalid_data,
                  start.file.string() + ": is a mesh; frames are for point caches (.pc2, .mdd)");
    const TriangleMesh mesh = import_mesh(start.file);
    PosedVertices vertices;
    vertices.position.reserve(mesh.position.size());
    for (const auto& p : mesh.position) vertices.position.push_back(to_float({p[0], p[1], p[2]}));
    return vertices;
  }
  PointCache cache = read_point_cache(start.file);
  const size_t count = cache.frames.size(), frame = start.frame.value_or(count > 0 ? count - 1 : 0);
  if (frame >= count)
    throw Error(ErrorCode::invalid_data,
                fmt::format("{}: has {} frames, and no frame {}; the first is 0", start.file.string(), count, frame));
  PosedVertices vertices{std::move(cache.frames[frame])};
  if (frame > 0) vertices.before = std::move(cache.frames[frame - 1]);
  if (ending == ".mdd") vertices.rate = cache.frame_rate;
  return vertices;
}

BodyReader body_reader() {
  const auto read_moving = [](const SceneMesh& body) {
    const BodyAnimation& plays = body.animation.value();
    const AnimationOptions options{plays.clip, plays.start, plays.speed, plays.loop, body.parts};
    const auto mesh = std::make_shared<const AnimatedMesh>(body.file, options);
    return MovingBody{mesh->triangle(), [mesh](double time) { return mesh->positions_at(time); },
                      mesh->positions_as_opened()};
  };
  return {read_body, read_moving, read_vertices};
}

std::vector<NamedFile> files_read(const std::filesystem::path& input, const Scene& scene) {
  std::vector<NamedFile> files{{"the scene", input}};
  for (const SceneCloth& cloth : scene.cloths) {
    files.push_back({"an asset of the scene", cloth.asset});
    if (cloth.skin) files.push_back({"a skin of the scene", cloth.skin->file});
    if (cloth.start) files.push_back({"a start of the scene", cloth.start->file});
  }
  for (const SceneCollider& collider : scene.colliders) {
    if (collider.mesh) files.push_back({"a collider of the scene", collider.mesh->file});
  }
  return files;
}

}  // namespace geocloth
