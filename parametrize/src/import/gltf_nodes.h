// SPDX-License-Identifier: GPL-3.0-or-later
// Where the nodes, skins and morph targets of a checked glTF scene put points (glTF 2.0, sections 3.5, 3.7.2 and
// 3.7.3).
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "import/deform.h"
#include "import/gltf_data.h"
#include "import/gltf_file.h"
#include "import/node_animation.h"

namespace geocloth::import_detail {

/// object[key] as numbers; empty when it is no array, 0 for what is no number.
[[nodiscard]] std::vector<double> gltf_numbers(const GltfFile::Json& object, const char* key);

/// Of a node without a matrix.
[[nodiscard]] NodePlace node_place(const GltfFile::Json& node);
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

/// Of all joints of a skin; no numbers when the file leaves them away, which stands for identities.
[[nodiscard]] std::vector<Eigen::Matrix4d> inverse_bind_matrices(const GltfFile& gltf, const GltfData& data,
                                                                 std::size_t skin);

/// The joints of a primitive with JOINTS_0, however many sets of four the file has.
[[nodiscard]] SkinWeights read_skin_weights(const GltfData& data, const GltfFile::Json& attributes);
/// Refuses joints beyond those of a skin.
void check_joints(const GltfFile& gltf, const SkinWeights& weights, std::size_t joints);

}  // namespace geocloth::import_detail
