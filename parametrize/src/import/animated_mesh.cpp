// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/animated_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "import/animated_scene.h"
#include "import/assimp_scene.h"
#include "import/gltf_scene.h"
#include "import/import_detail.h"

namespace geocloth {
namespace import_detail {
namespace {

ReadScene read_scene(const std::filesystem::path& path, const AnimationOptions& options) {
  if (is_gltf(path)) return read_gltf_scene(path, options);
  return read_assimp_scene(path, options);
}

void check_options(const AnimationOptions& options) {
  if (!(options.start >= 0 && std::isfinite(options.start))) {
    throw Error(ErrorCode::invalid_argument, "an animation must start at a number of seconds from 0 on");
  }
  if (!(options.speed > 0 && std::isfinite(options.speed))) {
    throw Error(ErrorCode::invalid_argument, "the speed of an animation must be a positive number");
  }
}

}  // namespace
}  // namespace import_detail

double clip_time(const AnimationOptions& options, double duration, double time) {
  const double at = std::min((time - options.start) * options.speed, std::numeric_limits<double>::max());
  if (!options.loop) return std::min(at, duration);
  return duration > 0 ? std::fmod(at, duration) : 0;
}

struct AnimatedMesh::Impl {
  import_detail::ReadScene read;
};

AnimatedMesh::AnimatedMesh(const std::filesystem::path& path, const AnimationOptions& options) {
  import_detail::check_options(options);
  try {
    impl_ = std::make_unique<Impl>(Impl{import_detail::read_scene(path, options)});
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    import_detail::fail(path, ErrorCode::limit, "does not fit into memory; reduce the mesh");
  } catch (const std::exception& e) {
    import_detail::fail(path, ErrorCode::invalid_data,
                        std::string("cannot be read as an animation (") + e.what() + ")");
  }
}

AnimatedMesh::~AnimatedMesh() = default;
AnimatedMesh::AnimatedMesh(AnimatedMesh&&) noexcept = default;
AnimatedMesh& AnimatedMesh::operator=(AnimatedMesh&&) noexcept = default;

const std::vector<Triangle>& AnimatedMesh::triangle() const {
  return impl_->read.triangle;
}

double AnimatedMesh::duration() const {
  return impl_->read.scene.duration();
}

std::vector<Vec3> AnimatedMesh::positions_as_opened() const {
  return impl_->read.scene.positions_as_opened();
}

std::vector<Vec3> AnimatedMesh::positions_at(double time) const {
  return impl_->read.scene.positions_at(time);
}

}  // namespace geocloth
