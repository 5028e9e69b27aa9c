// SPDX-License-Identifier: GPL-3.0-or-later
#include "body_reader.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <CLI/StringTools.hpp>
#include <fmt/format.h>

#include "export/cache_reader.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/parametrize/animated_mesh.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/parts.h"
#include "geocloth/solver/transform.h"

namespace geocloth {
namespace {

std::vector<Vec3> positions_of(const TriangleMesh& mesh) {
  std::vector<Vec3> position;
  position.reserve(mesh.position.size());
  for (const auto& p : mesh.position) position.push_back(to_float({p[0], p[1], p[2]}));
  return position;
}

std::vector<Vec3> between(const std::vector<Vec3>& from, const std::vector<Vec3>& to, double share) {
  const auto t = static_cast<float>(share);
  std::vector<Vec3> out(from.size());
  std::ranges::transform(from, to, out.begin(), [t](const Vec3& a, const Vec3& b) { return (1 - t) * a + t * b; });
  return out;
}

AnimationOptions options_of(const SceneMesh& body) {
  const BodyAnimation& plays = body.animation.value();
  return {plays.clip, plays.start, plays.speed, plays.loop, body.parts};
}

/// The frames of a point cache, evenly between them.
class CachedMotion {
 public:
  /// @param rate  [1/s] frames
  CachedMotion(std::vector<std::vector<Vec3>> frames, double rate, AnimationOptions options,
               std::vector<Vec3> as_opened)
      : frames_(std::move(frames)), rate_(rate), options_(std::move(options)), as_opened_(std::move(as_opened)) {}

  [[nodiscard]] double duration() const { return last_frame() / rate_; }

  [[nodiscard]] std::vector<Vec3> at(double time) const {
    if (time < options_.start) return between(as_opened_, frames_.front(), time / options_.start);
    const double frame = std::min(clip_time(options_, duration(), time) * rate_, last_frame());
    const auto before = static_cast<size_t>(frame);
    if (before + 1 >= frames_.size()) return frames_.back();
    return between(frames_[before], frames_[before + 1], frame - std::floor(frame));
  }

 private:
  [[nodiscard]] double last_frame() const { return static_cast<double>(frames_.size() - 1); }

  std::vector<std::vector<Vec3>> frames_;
  double rate_;
  AnimationOptions options_;
  std::vector<Vec3> as_opened_;
};

PlayedBody play_cache(const SceneMesh& body) {
  const BodyAnimation& plays = *body.animation;
  TriangleSurface surface = read_body(body);
  PointCache cache = read_point_cache(plays.cache);
  if (cache.points != surface.position.size()) {
    throw Error(
        ErrorCode::invalid_data,
        fmt::format("{}: has {} points, but {} has {} vertices; a point cache is played by the mesh that it was "
                    "made of, with its vertices in the same order",
                    plays.cache.string(), cache.points, body.file.string(), surface.position.size()));
  }
  for (std::vector<Vec3>& frame : cache.frames)
    for (Vec3& p : frame) p = apply(plays.cache_transform, p);
  const double rate = plays.rate.value_or(cache.frame_rate.value_or(plays.scene_rate)) / cache.step;
  const auto motion =
      std::make_shared<const CachedMotion>(std::move(cache.frames), rate, options_of(body), surface.position);
  return {std::move(surface.triangle), std::move(surface.position), [motion](double time) { return motion->at(time); },
          motion->duration()};
}

}  // namespace

TriangleSurface read_body(const SceneMesh& body) {
  TriangleMesh mesh = import_mesh(body.file);
  if (!body.parts.empty()) mesh = select_parts(with_choosable_parts(std::move(mesh)), body.parts);
  return {positions_of(mesh), {mesh.triangle.begin(), mesh.triangle.end()}};
}

PosedVertices read_vertices(const SceneStart& start) {
  const std::string ending = CLI::detail::to_lower(start.file.extension().string());
  if (ending != ".pc2" && ending != ".mdd") {
    if (start.frame)
      throw Error(ErrorCode::invalid_data,
                  start.file.string() + ": is a mesh; frames are for point caches (.pc2, .mdd)");
    const TriangleMesh mesh = import_mesh(start.file);
    return {positions_of(mesh), {mesh.triangle.begin(), mesh.triangle.end()}};
  }
  PointCache cache = read_point_cache(start.file);
  const size_t count = cache.frames.size(), frame = start.frame.value_or(count > 0 ? count - 1 : 0);
  if (frame >= count)
    throw Error(ErrorCode::invalid_data,
                fmt::format("{}: has {} frames, and no frame {}; the first is 0", start.file.string(), count, frame));
  PosedVertices vertices{std::move(cache.frames[frame])};
  if (frame > 0) vertices.before = std::move(cache.frames[frame - 1]);
  vertices.step = cache.step;
  vertices.rate = cache.frame_rate;
  return vertices;
}

PlayedBody play_body(const SceneMesh& body) {
  if (!body.animation.value().cache.empty()) return play_cache(body);
  const auto mesh = std::make_shared<const AnimatedMesh>(body.file, options_of(body));
  return {mesh->triangle(), mesh->positions_as_opened(), [mesh](double time) { return mesh->positions_at(time); },
          mesh->duration()};
}

BodyReader body_reader() {
  const auto read_moving = [](const SceneMesh& body) {
    PlayedBody played = play_body(body);
    return MovingBody{std::move(played.triangle), std::move(played.positions_at), std::move(played.as_opened)};
  };
  return {read_body, read_moving, read_vertices};
}

}  // namespace geocloth
