// SPDX-License-Identifier: GPL-3.0-or-later
// Where the nodes, skins and morph targets of a checked glTF scene put points (glTF 2.0, sections 3.5, 3.7.2 and
// 3.7.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "import/gltf_data.h"
#include "import/gltf_file.h"

namespace geocloth::import_detail {

/// object[key] as numbers; empty when it is no array, 0 for what is no number.
[[nodiscard]] std::vector<double> gltf_numbers(const GltfFile::Json& object, const char* key);

struct NodePlace {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();

  [[nodiscard]] Eigen::Matrix4d matrix() const;
};

/// Of a node without a matrix.
[[nodiscard]] NodePlace node_place(const GltfFile::Json& node);
/// The place that a matrix without shear stands for.
[[nodiscard]] NodePlace node_place(const Eigen::Matrix4d& matrix);
/// What takes points of a node to its parent.
[[nodiscard]] Eigen::Matrix4d local_matrix(const GltfFile::Json& node);

/// The parent of each node, the number of nodes for those that have none.
[[nodiscard]] std::vector<std::size_t> node_parents(const GltfFile& gltf);
/// Whether the scene that the file opens with has a node; without any scene, all are shown.
[[nodiscard]] std::vector<bool> shown_nodes(const GltfFile& gltf);

/// Weights of the morph targets that a node shows its mesh with before anything moves; empty when the file has none.
[[nodiscard]] std::vector<double> morph_weights(const GltfFile& gltf, std::size_t node);
/// How many morph targets each mesh has.
[[nodiscard]] std::vector<std::size_t> count_targets(const GltfFile& gltf);
/// Adds a share of a morph target.
void add_target(std::vector<float>& values, const std::vector<float>& target, double weight);

/// Of all joints of a skin; no numbers when the file leaves them away, which stands for identities.
[[nodiscard]] std::vector<Eigen::Matrix4d> inverse_bind_matrices(const GltfFile& gltf, const GltfData& data,
                                                                 std::size_t skin);

/// A point where an affine matrix of three or four rows puts it.
template <typename Matrix>
[[nodiscard]] Eigen::Vector3d placed(const Matrix& m, const Eigen::Vector3d& p) {
  return m.template topLeftCorner<3, 3>() * p + m.template topRightCorner<3, 1>();
}

/// The joints of the vertices of one primitive and their weights, however many sets of four the file has.
class SkinWeights {
 public:
  /// @param attributes  of a primitive with JOINTS_0
  SkinWeights(const GltfData& data, const GltfFile::Json& attributes);

  /// Refuses joints beyond those of a skin.
  void check(const GltfFile& gltf, std::size_t joints) const;

  /// The matrix that takes a vertex to the world. Weights need not be one in sum; without any, the first joint decides.
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
  struct Hold {
    uint32_t joint;
    float weight;
  };

  std::vector<std::size_t> first_;  ///< of each vertex in hold_, and the end
  std::vector<Hold> hold_;
  std::size_t joints_needed_ = 0;
};

}  // namespace geocloth::import_detail
