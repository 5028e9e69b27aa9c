// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene_input.h"

#include <algorithm>
#include <thread>

#include "options.h"

namespace geocloth {

void add_scene_input(CLI::App& app, std::filesystem::path& input) {
  add_text(
      app, "scene", "SCENE", input,
      "a scene file (.json), or an asset (.glb), which is hung by its highest boundary (by its top where that goes far "
      "down or is below; a level sheet by one end)",
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

std::vector<NamedFile> files_read(const std::filesystem::path& input, const Scene& scene) {
  std::vector<NamedFile> files{{"the scene", input}};
  const auto add_body = [&](const char* what, const SceneMesh& body) {
    files.push_back({what, body.file});
    if (body.animation && !body.animation->cache.empty()) files.push_back({what, body.animation->cache});
  };
  for (const SceneCloth& cloth : scene.cloths) {
    files.push_back({"an asset of the scene", cloth.asset});
    if (cloth.skin) add_body("a skin of the scene", *cloth.skin);
    if (cloth.start) files.push_back({"a start of the scene", cloth.start->file});
  }
  for (const SceneCollider& collider : scene.colliders) {
    if (collider.mesh) add_body("a collider of the scene", *collider.mesh);
  }
  return files;
}

}  // namespace geocloth
