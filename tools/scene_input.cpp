// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_input.h"

#include <algorithm>
#include <memory>
#include <thread>

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

BodyReader body_reader() {
  const auto read_moving = [](const SceneMesh& body) {
    const BodyAnimation& plays = body.animation.value();
    const AnimationOptions options{plays.clip, plays.start, plays.speed, plays.loop, body.parts};
    const auto mesh = std::make_shared<const AnimatedMesh>(body.file, options);
    return MovingBody{mesh->triangle(), [mesh](double time) { return mesh->positions_at(time); },
                      mesh->positions_as_opened()};
  };
  return {read_body, read_moving};
}

std::vector<NamedFile> files_read(const std::filesystem::path& input, const Scene& scene) {
  std::vector<NamedFile> files{{"the scene", input}};
  for (const SceneCloth& cloth : scene.cloths) {
    files.push_back({"an asset of the scene", cloth.asset});
    if (cloth.skin) files.push_back({"a skin of the scene", cloth.skin->file});
  }
  for (const SceneCollider& collider : scene.colliders) {
    if (collider.mesh) files.push_back({"a collider of the scene", collider.mesh->file});
  }
  return files;
}

}  // namespace geocloth
