// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/animated_scene.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include "import/import_detail.h"

namespace geocloth::import_detail {

void MovingWork::add(std::size_t more) {
  constexpr std::size_t kMost = 200'000'000;
  sum_ += std::min(more, kMost + 1);
  if (sum_ > kMost) fail(file_, ErrorCode::limit, "its instances and morph targets are too many to be animated");
}

AnimatedScene::AnimatedScene(std::filesystem::path file, MovingParts parts, const AnimationOptions& options)
    : file_(std::move(file)), options_(options), parts_(std::move(parts)), begin_(parts_.rest) {
  parts_.animation.apply(0, begin_);
}

std::vector<Vec3> AnimatedScene::positions_as_opened() const {
  return positions(parts_.opening);
}

std::vector<Vec3> AnimatedScene::positions_at(double time) const {
  if (!(time >= 0 && std::isfinite(time))) {
    throw Error(ErrorCode::invalid_argument, "the time of an animation must be a number of seconds from 0 on");
  }
  std::vector<Vec3> out = positions(pose_at(time));
  check(out, time);
  return out;
}

std::vector<std::vector<bool>> AnimatedScene::mirrored_as_opened() const {
  const Matrices matrices = matrices_of(parts_.opening);
  std::vector<std::vector<bool>> out;
  for (const PlacedVertices& placed : parts_.placed) {
    std::vector<bool>& mirrored = out.emplace_back();
    for (std::size_t i = 0; i < parts_.vertices[placed.vertices].count(); ++i) {
      mirrored.push_back(matrix_of(placed, matrices, i).leftCols<3>().determinant() < 0);
    }
  }
  return out;
}

AnimatedScene::Poses AnimatedScene::pose_at(double time) const {
  if (time < options_.start) {
    Poses pose = begin_;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      pose[i] = blend_pose(parts_.opening[i], begin_[i], time / options_.start);
    }
    return pose;
  }
  Poses pose = parts_.rest;
  parts_.animation.apply(clip_time(options_, duration(), time), pose);
  return pose;
}

AnimatedScene::Matrices AnimatedScene::matrices_of(const Poses& pose) const {
  std::vector<Eigen::Matrix4d> world(pose.size());
  for (const std::size_t i : parts_.order) {
    const std::size_t parent = parts_.parent[i];
    world[i] = (parent < pose.size() ? world[parent] : parts_.to_world) * pose[i].local();
  }
  const auto affine = [](const Eigen::Matrix4d& m) -> Affine { return m.topRows<3>(); };
  Matrices out;
  for (const Eigen::Matrix4d& matrix : world) out.node.push_back(affine(matrix));
  for (const Joints& joints : parts_.skin) {
    std::vector<Affine>& joint = out.skin.emplace_back();
    for (std::size_t k = 0; k < joints.node.size(); ++k) {
      const Eigen::Matrix4d& at = world[joints.node[k]];
      joint.push_back(affine(joints.inverse_bind.empty() ? at : at * joints.inverse_bind[k]));
    }
  }
  return out;
}

AnimatedScene::Affine AnimatedScene::matrix_of(const PlacedVertices& placed, const Matrices& matrices,
                                               std::size_t vertex) const {
  if (!placed.skin) return matrices.node[placed.node];
  return parts_.vertices[placed.vertices].weights->blend(vertex, std::span(matrices.skin[*placed.skin]));
}

std::vector<Vec3> AnimatedScene::positions(const Poses& pose) const {
  const Matrices matrices = matrices_of(pose);
  std::vector<Vec3> out(parts_.vertex_count);
  std::vector<float> morphed;
  for (const PlacedVertices& placed : parts_.placed) {
    place(placed, matrices, pose[placed.node].weight, morphed, out);
  }
  return out;
}

/// @param morphed  room for the vertices with their morph targets
void AnimatedScene::place(const PlacedVertices& placed, const Matrices& matrices, const std::vector<double>& weight,
                          std::vector<float>& morphed, std::vector<Vec3>& out) const {
  const AnimatedVertices& vertices = parts_.vertices[placed.vertices];
  const std::vector<float>* from = &vertices.position;
  for (std::size_t i = 0; i < vertices.target.size(); ++i) {
    if (weight[i] == 0 || vertices.target[i].empty()) continue;
    if (from != &morphed) morphed = vertices.position;
    from = &morphed;
    add_target(morphed, vertices.target[i], weight[i]);
  }
  for (std::size_t i = 0; i < vertices.count(); ++i) {
    const Eigen::Vector3d p{double{(*from)[3 * i]}, double{(*from)[3 * i + 1]}, double{(*from)[3 * i + 2]}};
    const Eigen::Vector3d q = import_detail::placed(matrix_of(placed, matrices, i), p);
    out[placed.at(i)] = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
  }
}

void AnimatedScene::check(const std::vector<Vec3>& position, double time) const {
  constexpr auto kFar = static_cast<float>(kMaxCoordinate);
  const auto in_range = [](float c) { return std::abs(c) <= kFar; };
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3& p = position[i];
    if (in_range(p.x) && in_range(p.y) && in_range(p.z)) continue;
    std::ostringstream at;
    at << time;
    bad(file_, parts_.animation.title() + " takes vertex " + std::to_string(i) + " to no finite place at " + at.str() +
                   " s; repair it in a modelling program");
  }
}

}  // namespace geocloth::import_detail
