// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes that move: how a scene's animation places them at a time, whatever file it comes from. Keys are as glTF 2.0
// has them (section 3.11 and appendix C).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace geocloth::import_detail {

struct NodePlace {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();

  [[nodiscard]] Eigen::Matrix4d matrix() const;
};

/// The place that a matrix without shear stands for.
[[nodiscard]] NodePlace node_place(const Eigen::Matrix4d& matrix);

/// What an animation changes of a node.
struct NodePose {
  std::optional<Eigen::Matrix4d> matrix;  ///< in place of `place`; of nodes that nothing moves
  NodePlace place;
  std::vector<double> weight;  ///< of the morph targets of its mesh; empty where it shows none

  [[nodiscard]] Eigen::Matrix4d local() const { return matrix ? *matrix : place.matrix(); }
};

/// The pose at `share` of the way from one to another: turns go the short way.
[[nodiscard]] NodePose blend_pose(const NodePose& from, const NodePose& to, double share);

/// Which of a file's animations is meant: by its name, by what of its name is behind a bar (Blender's exporters write
/// "Armature|Walk"), or by its number where none has that name, since some exporters name animations by numbers; the
/// first where nothing is said; all, which play at once, for "*", where none is called so.
/// @returns their numbers, at least one
/// @throws Error(invalid_data) that lists the names when there is none of that name or number
[[nodiscard]] std::vector<std::size_t> find_clips(const std::filesystem::path& file, std::span<const std::string> names,
                                                  const std::string& clip);

/// What messages call all animations of a file.
inline constexpr std::string_view kAllClips = "the animations";

/// How much of a name from a file is shown in a message.
inline constexpr std::size_t kShownName = 60;

class NodeAnimation {
 public:
  enum class Path { translation, rotation, scale, weights };
  enum class Way { step, linear, cubic };
  struct Sampler {
    Way way = Way::linear;
    std::vector<float> time;   ///< of the keys [s], never descending; at least one
    std::vector<float> value;  ///< of each key (turns as x, y, z, w); between its tangents for Way::cubic
  };
  struct Channel {
    std::size_t node, sampler;
    Path path;
    std::size_t width;  ///< numbers of a value
  };

  /// @param title  what messages call it
  explicit NodeAnimation(std::string title) : title_(std::move(title)) {}

  /// @returns its number
  std::size_t add_sampler(Sampler sampler);
  void add_channel(const Channel& channel);
  /// What plays at the same time; of two channels that move the same, the later one counts.
  void add(NodeAnimation other);
  /// [s] >= 0, in place of the time of its last key.
  void set_duration(double duration) { duration_ = duration; }

  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] double duration() const { return duration_; }  ///< [s]
  [[nodiscard]] bool empty() const { return channel_.empty(); }
  [[nodiscard]] const Sampler& sampler(std::size_t i) const { return sampler_[i]; }

  /// Whether it changes the place of a node.
  [[nodiscard]] bool moves(std::size_t node) const { return moved_.contains(node); }
  /// Gives the nodes what the animation says at a time [s]; outside of its keys the nearest one holds.
  /// @param pose  of each node of the file
  void apply(double time, std::vector<NodePose>& pose) const;

  /// The value of one channel at a time [s], as apply() has it.
  /// @param out  replaced; its memory is used again
  static void sample(const Sampler& sampler, const Channel& channel, double time, std::vector<double>& out);

 private:
  std::string title_;
  double duration_ = 0;
  std::vector<Sampler> sampler_;
  std::vector<Channel> channel_;
  std::set<std::size_t> moved_;  ///< nodes
};

}  // namespace geocloth::import_detail
