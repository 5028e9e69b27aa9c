// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/import.h"

#include <cmath>
#include <new>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"
#include "import/assimp_animation.h"
#include "import/assimp_file.h"
#include "import/gltf_file.h"
#include "import/import_detail.h"
#include "import/scene_mesh.h"

namespace geocloth {
namespace import_detail {

void fail(const std::filesystem::path& file, ErrorCode code, const std::string& what) {
  std::string message = file.string() + ": " + what;
  for (char& c : message) {
    if (static_cast<unsigned char>(c) < 32) c = ' ';  // names inside hostile files must not break the line
  }
  throw Error(code, message);
}

namespace {

TriangleMesh read(const std::filesystem::path& path, const ImportOptions& options) {
  AssimpFile file(path, false);
  const double scale = options.scale ? *options.scale / file.applied_unit : metres_per_unit(file);
  TriangleMesh mesh = mesh_of_scene(path, file, scale).mesh;
  if (mesh.triangle.empty()) {
    fail(path, ErrorCode::invalid_data,
         file.left_out.empty() ? "has no faces; cloth needs triangles or polygons"
                               : "has no faces to convert: " + file.left_out.front());
  }
  mesh.left_out = std::move(file.left_out);
  return mesh;
}

}  // namespace
}  // namespace import_detail

size_t count_animations(const std::filesystem::path& path) {
  using namespace import_detail;
  const Format format = format_of(path);
  if (is_gltf(path)) {
    const GltfBytes file = read_gltf_bytes(path);
    return GltfFile(path, file.bytes, file.binary).array("animations").size();
  }
  return format == Format::fbx || format == Format::dae ? count_clips(AssimpFile(path, true)) : 0;
}

TriangleMesh import_mesh(const std::filesystem::path& path, const ImportOptions& options) {
  if (options.scale && !(std::isfinite(*options.scale) && *options.scale > 0)) {
    throw Error(ErrorCode::invalid_argument, "import scale must be a positive number");
  }
  try {
    return import_detail::read(path, options);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    import_detail::fail(path, ErrorCode::limit, "does not fit into memory; reduce the mesh");
  } catch (const std::exception& e) {
    import_detail::fail(path, ErrorCode::invalid_data, std::string("cannot be read as a mesh (") + e.what() + ")");
  }
}

}  // namespace geocloth
