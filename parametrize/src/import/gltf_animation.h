// SPDX-License-Identifier: GPL-3.0-or-later
// One animation of a glTF file (glTF 2.0, section 3.11 and appendix C).
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "import/gltf_data.h"
#include "import/gltf_file.h"
#include "import/gltf_nodes.h"

namespace geocloth::import_detail {

/// What an animation changes of a node.
struct NodePose {
  std::optional<Eigen::Matrix4d> matrix;  ///< in place of `place`; of nodes that nothing moves
  NodePlace place;
  std::vector<double> weight;  ///< of the morph targets of its mesh; empty where it shows none

  [[nodiscard]] Eigen::Matrix4d local() const { return matrix ? *matrix : place.matrix(); }
};

/// The pose at `share` of the way from one to another: turns go the short way.
[[nodiscard]] NodePose blend_pose(const NodePose& from, const NodePose& to, double share);

class GltfAnimation {
 public:
  /// Reads and checks an animation of a checked scene. Only what is played is checked here, so that a broken animation
  /// does not cost the mesh.
  /// @param clip     its name or number; empty: the first
  /// @param targets  numbers of morph targets, of each mesh
  /// @throws Error(invalid_data) when there is none, or when it is broken; Error(limit) when it is too large
  GltfAnimation(const GltfFile& gltf, const GltfData& data, const std::string& clip,
                const std::vector<std::size_t>& targets);

  [[nodiscard]] const std::string& title() const { return title_; }  ///< "animations[2] 'Walk'"
  [[nodiscard]] double duration() const { return duration_; }        ///< [s] the time of its last key

  /// Whether it changes the place of a node.
  [[nodiscard]] bool moves(std::size_t node) const { return moved_.contains(node); }
  /// Gives the nodes what the animation says at a time [s]; outside of its keys the nearest one holds.
  /// @param pose  of each node of the file
  void apply(double time, std::vector<NodePose>& pose) const;

 private:
  using Json = GltfFile::Json;
  enum class Path { translation, rotation, scale, weights };
  enum class Way { step, linear, cubic };
  struct Sampler {
    Way way = Way::linear;
    std::vector<float> time;   ///< of the keys [s], never descending
    std::vector<float> value;  ///< of each key; between its tangents for Way::cubic
  };
  struct Channel {
    std::size_t node, sampler;
    Path path;
    std::size_t width;  ///< numbers of a value
  };

  void read_channel(const GltfFile& gltf, const GltfData& data, const Json& animation, std::size_t i,
                    const std::vector<std::size_t>& targets);
  Sampler read_sampler(const GltfFile& gltf, const GltfData& data, const Json& sampler, const std::string& where);
  void count_numbers(const GltfFile& gltf, std::size_t more);
  void check_keys(const GltfFile& gltf, const Sampler& sampler, const std::string& where) const;
  void check_values(const GltfFile& gltf, const GltfData& data, const Json& sampler, const Channel& channel,
                    const std::string& where) const;
  static void sample(const Sampler& sampler, const Channel& channel, double time, std::vector<double>& out);

  std::string title_;
  double duration_ = 0;
  std::size_t numbers_ = 0;  ///< read so far, and those of one pose
  std::map<std::size_t, Sampler> sampler_;
  std::vector<Channel> channel_;
  std::set<std::size_t> moved_;  ///< nodes
};

}  // namespace geocloth::import_detail
