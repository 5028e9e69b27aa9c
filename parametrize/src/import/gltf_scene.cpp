// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/gltf_scene.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/parts.h"
#include "import/gltf_animation.h"
#include "import/gltf_check.h"
#include "import/gltf_compression.h"
#include "import/gltf_data.h"
#include "import/gltf_file.h"
#include "import/gltf_nodes.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

using Json = GltfFile::Json;

enum : std::size_t { kTriangles = 4, kStrip = 5, kFan = 6 };

/// Triangles between corners in the order of glTF (3.7.2.1); a rest is left out.
std::vector<Triangle> make_triangles(const std::vector<uint32_t>& corner, std::size_t mode) {
  std::vector<Triangle> out;
  for (std::size_t i = 2; i < corner.size(); i += mode == kTriangles ? 3 : 1) {
    Triangle t{corner[i - 2], corner[i - 1], corner[i]};
    if (mode == kStrip && i % 2 != 0) std::swap(t[0], t[1]);
    if (mode == kFan) t[0] = corner[0];
    out.push_back(t);
  }
  return out;
}

/// Of a primitive with triangles.
AnimatedVertices read_vertices(const GltfData& data, const Json& primitive, bool skinned) {
  AnimatedVertices out;
  const Json& attributes = primitive["attributes"];
  out.position = data.floats(attributes["POSITION"].get<std::size_t>());
  if (skinned) out.weights = read_skin_weights(data, attributes);
  if (!primitive.contains("targets")) return out;
  for (const Json& target : primitive["targets"]) {
    out.target.emplace_back();
    if (target.contains("POSITION")) out.target.back() = data.floats(target["POSITION"].get<std::size_t>());
  }
  return out;
}

/// Of a primitive with triangles and that many vertices.
std::vector<Triangle> read_triangles(const GltfFile& gltf, const GltfData& data, const Json& primitive,
                                     std::size_t vertices) {
  std::vector<uint32_t> corner;
  if (primitive.contains("indices")) {
    corner = data.indices(primitive["indices"].get<std::size_t>());
  } else {
    for (std::size_t i = 0; i < vertices; ++i) corner.push_back(static_cast<uint32_t>(i));
  }
  for (const uint32_t c : corner) {
    if (c >= vertices) gltf.bad("a face uses a vertex that does not exist");
  }
  return make_triangles(corner, gltf.number(primitive, "mode", "primitive", kTriangles));
}

constexpr std::size_t kMaxParts = 20'000;  ///< that are told apart, each by all others

/// [m] How far the triangles of two parts are from each other, one by one; once it is `enough` it may be less.
double apart(const TriangleMesh& a, const SourcePart& part_a, const TriangleMesh& b, const SourcePart& part_b,
             double enough) {
  double sum = 0;
  for (uint32_t i = 0; i < part_a.triangle_count && sum < enough; ++i) {
    Eigen::Vector3d between = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      between += Eigen::Map<const Eigen::Vector3d>(a.position[a.triangle[part_a.first_triangle + i][k]].data()) -
                 Eigen::Map<const Eigen::Vector3d>(b.position[b.triangle[part_b.first_triangle + i][k]].data());
    }
    sum += between.norm() / 3;
  }
  return sum;
}

/// A mesh with its parts in the order and with the names of the same mesh as it was imported, which come from assimp;
/// equal parts are those that lie at the same place.
TriangleMesh with_parts_of(const TriangleMesh& imported, TriangleMesh mesh, const std::filesystem::path& path) {
  if (mesh.part.size() > kMaxParts) fail(path, ErrorCode::limit, "has too many parts to choose from; leave out parts");
  std::vector<Triangle> triangle;
  std::vector<bool> taken(mesh.part.size(), false);
  for (const SourcePart& part : imported.part) {
    std::size_t best = mesh.part.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < mesh.part.size(); ++k) {
      if (taken[k] || mesh.part[k].triangle_count != part.triangle_count) continue;
      const double distance = apart(imported, part, mesh, mesh.part[k], least);
      if (distance < least) {
        best = k;
        least = distance;
      }
    }
    if (best == mesh.part.size()) {
      fail(path, ErrorCode::unsupported, "part " + part.name + " is another one when it is animated; leave out parts");
    }
    taken[best] = true;
    const auto from = mesh.triangle.begin() + mesh.part[best].first_triangle;
    triangle.insert(triangle.end(), from, from + part.triangle_count);
  }
  mesh.triangle = std::move(triangle);
  mesh.part = imported.part;
  mesh.part_mesh = imported.part_mesh;
  mesh.material = imported.material;
  return mesh;
}

class GltfSceneReader {
 public:
  GltfSceneReader(const GltfFile& gltf, const GltfData& data, const std::string& clip)
      : gltf_(gltf),
        data_(data),
        targets_(count_targets(gltf)),
        out_(read_gltf_animation(gltf, data, clip, targets_)) {}

  MovingParts read() {
    read_nodes();
    read_meshes();
    out_.rest = out_.opening;
    return std::move(out_);
  }

  /// Of each of the placed vertices, after read().
  [[nodiscard]] const std::vector<std::vector<Triangle>>& triangles() const { return triangle_; }

 private:
  void read_nodes() {
    const Json& nodes = gltf_.array("nodes");
    out_.parent = node_parents(gltf_);
    out_.opening.resize(nodes.size());
    out_.skin.resize(gltf_.array("skins").size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].contains("matrix")) {
        out_.opening[i].place = node_place(nodes[i]);
      } else if (out_.animation.moves(i)) {
        out_.opening[i].place = node_place(local_matrix(nodes[i]));
      } else {
        out_.opening[i].matrix = local_matrix(nodes[i]);
      }
    }
    order_nodes(nodes);
  }

  void order_nodes(const Json& nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (out_.parent[i] == nodes.size()) out_.order.push_back(i);
    }
    for (std::size_t k = 0; k < out_.order.size(); ++k) {
      const Json& node = nodes[out_.order[k]];
      if (!node.contains("children")) continue;
      for (const Json& child : node["children"]) out_.order.push_back(child.get<std::size_t>());
    }
  }

  void read_meshes() {
    const Json& nodes = gltf_.array("nodes");
    const std::vector<bool> shown = shown_nodes(gltf_);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!shown[i] || !nodes[i].contains("mesh")) continue;
      const auto mesh = nodes[i]["mesh"].get<std::size_t>();
      const Json& primitives = gltf_.json["meshes"][mesh]["primitives"];
      work_.add(primitives.size() + targets_[mesh]);
      out_.opening[i].weight = morph_weights(gltf_, i);
      out_.opening[i].weight.resize(targets_[mesh], 0);
      for (std::size_t k = 0; k < primitives.size(); ++k) read_primitive(i, k);
    }
  }

  void read_primitive(std::size_t node, std::size_t k) {
    const Json& json = gltf_.array("nodes")[node];
    const auto mesh = json["mesh"].get<std::size_t>();
    const Json& primitive = gltf_.json["meshes"][mesh]["primitives"][k];
    if (gltf_.number(primitive, "mode", "primitive", kTriangles) < kTriangles) return;  // points and lines
    const Json& attributes = primitive["attributes"];
    const bool skinned = json.contains("skin") && attributes.contains("JOINTS_0");
    const std::size_t count = data_.accessor(attributes["POSITION"].get<std::size_t>()).count;
    work_.add(count * (attributes.size() + (primitive.contains("targets") ? primitive["targets"].size() : 0)));
    PlacedVertices placed{vertices_of({mesh, k, skinned}), node, std::nullopt, out_.vertex_count, {}};
    if (skinned) {
      placed.skin = json["skin"].get<std::size_t>();
      read_skin(*placed.skin);
      check_joints(gltf_, *out_.vertices[placed.vertices].weights, out_.skin[*placed.skin].node.size());
    }
    out_.vertex_count += count;
    triangle_.push_back(read_triangles(gltf_, data_, primitive, count));
    triangle_count_ += triangle_.back().size();
    if (out_.vertex_count > kMaxElements) fail(gltf_.path, ErrorCode::limit, "more than 100 million vertices");
    if (triangle_count_ > kMaxTriangles) fail(gltf_.path, ErrorCode::limit, "more than 20 million triangles");
    out_.placed.push_back(placed);
  }

  using VerticesKey = std::tuple<std::size_t, std::size_t, bool>;  ///< mesh, primitive, and whether it has a skin

  std::size_t vertices_of(const VerticesKey& key) {
    const auto [it, is_new] = vertices_.try_emplace(key, out_.vertices.size());
    if (is_new) {
      const auto [mesh, number, skinned] = key;
      out_.vertices.push_back(read_vertices(data_, gltf_.json["meshes"][mesh]["primitives"][number], skinned));
    }
    return it->second;
  }

  void read_skin(std::size_t skin) {
    Joints& joints = out_.skin[skin];
    if (!joints.node.empty()) return;
    for (const Json& joint : gltf_.json["skins"][skin]["joints"]) joints.node.push_back(joint.get<std::size_t>());
    joints.inverse_bind = inverse_bind_matrices(gltf_, data_, skin);
  }

  const GltfFile& gltf_;
  const GltfData& data_;
  std::vector<std::size_t> targets_;  ///< of each mesh
  MovingParts out_;
  std::map<VerticesKey, std::size_t> vertices_;
  std::vector<std::vector<Triangle>> triangle_;
  std::size_t triangle_count_ = 0;
  MovingWork work_{gltf_.path};
};

/// As the file opens, outside out; every placed primitive is a part.
TriangleMesh opening_mesh(const AnimatedScene& scene, const std::vector<std::vector<Triangle>>& triangles) {
  TriangleMesh mesh;
  for (const Vec3& p : scene.positions_as_opened()) mesh.position.push_back({double{p.x}, double{p.y}, double{p.z}});
  const std::vector<std::vector<bool>> mirrored = scene.mirrored_as_opened();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto first = static_cast<uint32_t>(scene.parts().placed[i].first);
    SourcePart part;
    part.first_triangle = static_cast<uint32_t>(mesh.triangle.size());
    for (Triangle t : triangles[i]) {
      // What a node or its joints mirror when the file opens would be inside out.
      if (mirrored[i][t[0]]) std::swap(t[1], t[2]);
      mesh.triangle.push_back({first + t[0], first + t[1], first + t[2]});
    }
    part.triangle_count = static_cast<uint32_t>(mesh.triangle.size()) - part.first_triangle;
    if (part.triangle_count > 0) mesh.part.push_back(part);
  }
  return mesh;
}

}  // namespace

ReadScene read_gltf_scene(const std::filesystem::path& path, const AnimationOptions& options) {
  const GltfBytes file = read_gltf_bytes(path);
  GltfFile gltf(path, file.bytes, file.binary);
  check_extensions(gltf);
  GltfData data(gltf);
  decode_draco(gltf, data);
  check_scene(gltf, data);
  GltfSceneReader reader(gltf, data, options.clip);
  ReadScene out{AnimatedScene(path, reader.read(), options), {}};
  TriangleMesh mesh = opening_mesh(out.scene, reader.triangles());
  if (mesh.triangle.empty()) gltf.bad("has no faces; a body needs triangles");
  if (!options.parts.empty()) {
    mesh = select_parts(with_choosable_parts(with_parts_of(import_mesh(path), std::move(mesh), path)), options.parts);
  }
  out.triangle = std::move(mesh.triangle);
  return out;
}

}  // namespace geocloth::import_detail
