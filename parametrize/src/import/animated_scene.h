// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that moves, whatever file it comes from: what does not change with time is read once, and a pose is a matrix
// for each node, then one for each joint, then one for each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geocloth/asset/vec.h"
#include "geocloth/parametrize/animated_mesh.h"
#include "import/deform.h"
#include "import/node_animation.h"

namespace geocloth::import_detail {

/// The vertices of a mesh as they are kept.
struct AnimatedVertices {
  std::vector<float> position;             ///< three numbers a vertex
  std::vector<std::vector<float>> target;  ///< morph targets; empty where one moves nothing
  std::optional<SkinWeights> weights;

  [[nodiscard]] std::size_t count() const { return position.size() / 3; }
};

/// Where a node shows vertices.
struct PlacedVertices {
  std::size_t vertices;  ///< number of them in the scene
  std::size_t node;
  std::optional<std::size_t> skin;
  std::size_t first;             ///< vertex of the mesh, where they stand in order
  std::vector<uint32_t> number;  ///< of each, where they do not

  [[nodiscard]] std::size_t at(std::size_t vertex) const { return number.empty() ? first + vertex : number[vertex]; }
};

struct Joints {
  std::vector<std::size_t> node;
  std::vector<Eigen::Matrix4d> inverse_bind;  ///< empty: identities
};

/// What moves, and how.
struct MovingParts {
  explicit MovingParts(NodeAnimation moves) : animation(std::move(moves)) {}

  NodeAnimation animation;
  std::vector<std::size_t> parent;  ///< of each node; the number of nodes for those that have none
  std::vector<std::size_t> order;   ///< parents before children
  std::vector<NodePose> opening;    ///< of each node when the file opens
  std::vector<NodePose> rest;       ///< of each node where the animation says nothing of it
  Eigen::Matrix4d to_world = Eigen::Matrix4d::Identity();  ///< of nodes without parent: metres, y up
  std::vector<AnimatedVertices> vertices;
  std::vector<Joints> skin;
  std::vector<PlacedVertices> placed;
  std::size_t vertex_count = 0;
};

/// Counts products of vertices and what moves each of them, so that no file of a few bytes takes hours.
class MovingWork {
 public:
  explicit MovingWork(const std::filesystem::path& file) : file_(file) {}
  /// @throws Error(limit) when it is too much
  void add(std::size_t more);

 private:
  const std::filesystem::path& file_;
  std::size_t sum_ = 0;
};

class AnimatedScene {
 public:
  using Affine = Eigen::Matrix<double, 3, 4>;

  AnimatedScene(std::filesystem::path file, MovingParts parts, const AnimationOptions& options);

  [[nodiscard]] const MovingParts& parts() const { return parts_; }
  [[nodiscard]] double duration() const { return parts_.animation.duration(); }
  [[nodiscard]] std::vector<Vec3> positions_as_opened() const;
  /// As AnimatedMesh::positions_at().
  [[nodiscard]] std::vector<Vec3> positions_at(double time) const;
  /// For each of `placed`, whether it turns triangles inside out that begin at its vertices, when the file opens.
  [[nodiscard]] std::vector<std::vector<bool>> mirrored_as_opened() const;

 private:
  using Poses = std::vector<NodePose>;
  /// From the nodes, and from what skins are bound to, to the world.
  struct Matrices {
    std::vector<Affine> node;
    std::vector<std::vector<Affine>> skin;
  };

  [[nodiscard]] Poses pose_at(double time) const;
  [[nodiscard]] Matrices matrices_of(const Poses& pose) const;
  [[nodiscard]] Affine matrix_of(const PlacedVertices& placed, const Matrices& matrices, std::size_t vertex) const;
  [[nodiscard]] std::vector<Vec3> positions(const Poses& pose) const;
  void place(const PlacedVertices& placed, const Matrices& matrices, const std::vector<double>& weight,
             std::vector<float>& morphed, std::vector<Vec3>& out) const;
  void check(const std::vector<Vec3>& position, double time) const;

  std::filesystem::path file_;
  AnimationOptions options_;
  MovingParts parts_;
  Poses begin_;  ///< when the animation begins
};

/// A scene to be played, and its surface.
struct ReadScene {
  AnimatedScene scene;
  std::vector<Triangle> triangle;  ///< as AnimatedMesh::triangle()
};

}  // namespace geocloth::import_detail
