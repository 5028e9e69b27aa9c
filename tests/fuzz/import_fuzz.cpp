// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer entry for the importer and the repair. The first byte chooses the format, the rest is the file. Whatever it
// is, the outcome is an Error, or a mesh whose repair is an Error or a surface with every index in range.
// Without libFuzzer, replay_main.cpp runs the corpus.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/repair.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace geocloth;
  constexpr std::array<const char*, 8> endings{".obj", ".gltf", ".glb", ".ply", ".stl", ".fbx", ".dae", ".off"};
  if (size == 0) return 0;
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      ("geocloth_fuzz_" + std::to_string(::getpid()) + endings[data[0] % endings.size()]);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  try {
    const CleanSurface surface = repair_mesh(import_mesh(file)).surface;
    for (const Triangle& t : surface.triangle) {
      for (const uint32_t v : t) {
        if (v >= surface.position.size() || surface.point[v] >= surface.point_count) std::abort();
      }
    }
  } catch (const Error&) {
  }
  std::filesystem::remove(file);
  return 0;
}
