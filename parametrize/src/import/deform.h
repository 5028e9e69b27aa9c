// SPDX-License-Identifier: GPL-3.0-or-later
// How joints and morph targets move the vertices of a mesh, whatever file it comes from.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace geocloth::import_detail {

/// A point where an affine matrix of three or four rows puts it.
template <typename Matrix>
[[nodiscard]] Eigen::Vector3d placed(const Matrix& m, const Eigen::Vector3d& p) {
  return m.template topLeftCorner<3, 3>() * p + m.template topRightCorner<3, 1>();
}

/// Adds a share of a morph target.
inline void add_target(std::vector<float>& values, const std::vector<float>& target, double weight) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<float>(double{values[i]} + weight * double{target[i]});
  }
}

/// The joints of the vertices of a mesh and their weights, however many a vertex has.
class SkinWeights {
 public:
  struct Hold {
    uint32_t joint;
    float weight;
  };

  /// What holds the next vertex; not empty. Weights need not be one in sum; without any, the first joint decides.
  void add(std::span<const Hold> holds) {
    double sum = 0;
    for (const Hold& hold : holds) {
      joints_needed_ = std::max(joints_needed_, std::size_t{hold.joint} + 1);
      if (hold.weight == 0) continue;
      hold_.push_back(hold);
      sum += double{hold.weight};
    }
    if (!(sum > 0)) {
      hold_.resize(first_.back());
      hold_.push_back({holds[0].joint, 1});
    }
    first_.push_back(hold_.size());
  }

  /// How many joints a skin must have, those without weight counted.
  [[nodiscard]] std::size_t joints_needed() const { return joints_needed_; }

  /// The matrix that takes a vertex to the world.
  /// @param joint  of the skin: from where the mesh is bound to the world
  template <typename Matrix>
  [[nodiscard]] Matrix blend(std::size_t vertex, std::span<const Matrix> joint) const {
    Matrix sum = Matrix::Zero();
    double weight = 0;
    for (std::size_t k = first_[vertex]; k < first_[vertex + 1]; ++k) {
      sum += double{hold_[k].weight} * joint[hold_[k].joint];
      weight += double{hold_[k].weight};
    }
    return sum / weight;
  }

 private:
  std::vector<std::size_t> first_{0};  ///< of each vertex in hold_, and the end
  std::vector<Hold> hold_;
  std::size_t joints_needed_ = 0;
};

}  // namespace geocloth::import_detail
