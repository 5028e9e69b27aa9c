// SPDX-License-Identifier: GPL-3.0-or-later
// A glTF scene that moves: what does not change with time is read once, and a pose is a matrix for each node, then one
// for each joint, then one for each vertex.
#include "geocloth/parametrize/animated_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <span>
#include <sstream>
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

namespace geocloth {
namespace import_detail {
namespace {

using Json = GltfFile::Json;
using Affine = Eigen::Matrix<double, 3, 4>;

/// Products of vertices and what moves each of them, at most, so that no file of a few bytes takes hours.
constexpr std::size_t kMaxWork = 200'000'000;

Affine affine(const Eigen::Matrix4d& m) {
  return m.topRows<3>();
}

/// One primitive of the file as it is kept.
struct Surface {
  std::vector<float> position;             ///< three numbers a vertex
  std::vector<std::vector<float>> target;  ///< morph targets; empty where one moves nothing
  std::optional<SkinWeights> weights;
  std::vector<Triangle> triangle;

  [[nodiscard]] std::size_t vertices() const { return position.size() / 3; }
};

/// Where a node shows a primitive.
struct Placed {
  const Surface* surface;
  std::size_t node;
  std::optional<std::size_t> skin;
  std::size_t first;  ///< vertex of the mesh
};

struct Joints {
  std::vector<std::size_t> node;
  std::vector<Eigen::Matrix4d> inverse_bind;  ///< empty: identities
};

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
Surface read_surface(const GltfFile& gltf, const GltfData& data, const Json& primitive, bool skinned) {
  Surface out;
  const Json& attributes = primitive["attributes"];
  out.position = data.floats(attributes["POSITION"].get<std::size_t>());
  std::vector<uint32_t> corner;
  if (primitive.contains("indices")) {
    corner = data.indices(primitive["indices"].get<std::size_t>());
  } else {
    for (std::size_t i = 0; i < out.vertices(); ++i) corner.push_back(static_cast<uint32_t>(i));
  }
  for (const uint32_t c : corner) {
    if (c >= out.vertices()) gltf.bad("a face uses a vertex that does not exist");
  }
  out.triangle = make_triangles(corner, gltf.number(primitive, "mode", "primitive", kTriangles));
  if (skinned) out.weights.emplace(data, attributes);
  if (!primitive.contains("targets")) return out;
  for (const Json& target : primitive["targets"]) {
    out.target.emplace_back();
    if (target.contains("POSITION")) out.target.back() = data.floats(target["POSITION"].get<std::size_t>());
  }
  return out;
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
  mesh.material = imported.material;
  return mesh;
}

class AnimatedScene {
 public:
  AnimatedScene(const std::filesystem::path& path, const GltfFile& gltf, const GltfData& data,
                const AnimationOptions& options)
      : path_(path), options_(options), targets_(count_targets(gltf)), animation_(gltf, data, options.clip, targets_) {
    read_nodes(gltf);
    read_meshes(gltf, data);
    begin_ = opening_;
    animation_.apply(0, begin_);
    TriangleMesh all = opening_mesh();
    if (all.triangle.empty()) gltf.bad("has no faces; a body needs triangles");
    triangle_ = options.parts.empty() ? std::move(all.triangle) : selected(std::move(all));
  }

  [[nodiscard]] const std::vector<Triangle>& triangle() const { return triangle_; }
  [[nodiscard]] double duration() const { return animation_.duration(); }

  [[nodiscard]] std::vector<Vec3> positions_as_opened() const { return positions(opening_, matrices_of(opening_)); }

  [[nodiscard]] std::vector<Vec3> positions_at(double time) const {
    if (!(time >= 0 && std::isfinite(time))) {
      throw Error(ErrorCode::invalid_argument, "the time of an animation must be a number of seconds from 0 on");
    }
    const Poses pose = pose_at(time);
    std::vector<Vec3> out = positions(pose, matrices_of(pose));
    check(out, time);
    return out;
  }

 private:
  using Poses = std::vector<NodePose>;
  /// From the nodes, and from what skins are bound to, to the world.
  struct Matrices {
    std::vector<Affine> node;
    std::map<std::size_t, std::vector<Affine>> skin;
  };

  // --- reading -----------------------------------------------------------------------------------------------------

  void read_nodes(const GltfFile& gltf) {
    const Json& nodes = gltf.array("nodes");
    parent_ = node_parents(gltf);
    opening_.resize(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].contains("matrix")) {
        opening_[i].place = node_place(nodes[i]);
      } else if (animation_.moves(i)) {
        opening_[i].place = node_place(local_matrix(nodes[i]));
      } else {
        opening_[i].matrix = local_matrix(nodes[i]);
      }
    }
    order_nodes(nodes);
  }

  /// Parents before children.
  void order_nodes(const Json& nodes) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (parent_[i] == nodes.size()) order_.push_back(i);
    }
    for (std::size_t k = 0; k < order_.size(); ++k) {
      const Json& node = nodes[order_[k]];
      if (!node.contains("children")) continue;
      for (const Json& child : node["children"]) order_.push_back(child.get<std::size_t>());
    }
  }

  void read_meshes(const GltfFile& gltf, const GltfData& data) {
    const Json& nodes = gltf.array("nodes");
    const std::vector<bool> shown = shown_nodes(gltf);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!shown[i] || !nodes[i].contains("mesh")) continue;
      const auto mesh = nodes[i]["mesh"].get<std::size_t>();
      const Json& primitives = gltf.json["meshes"][mesh]["primitives"];
      count_work(primitives.size() + targets_[mesh]);
      opening_[i].weight = morph_weights(gltf, i);
      opening_[i].weight.resize(targets_[mesh], 0);
      for (std::size_t k = 0; k < primitives.size(); ++k) read_primitive(gltf, data, i, k);
    }
  }

  void read_primitive(const GltfFile& gltf, const GltfData& data, std::size_t node, std::size_t k) {
    const Json& json = gltf.array("nodes")[node];
    const auto mesh = json["mesh"].get<std::size_t>();
    const Json& primitive = gltf.json["meshes"][mesh]["primitives"][k];
    if (gltf.number(primitive, "mode", "primitive", kTriangles) < kTriangles) return;  // points and lines
    const Json& attributes = primitive["attributes"];
    const bool skinned = json.contains("skin") && attributes.contains("JOINTS_0");
    const std::size_t count = data.accessor(attributes["POSITION"].get<std::size_t>()).count;
    count_work(count * (attributes.size() + (primitive.contains("targets") ? primitive["targets"].size() : 0)));
    Surface& surface = surface_of(gltf, data, {mesh, k, skinned});
    Placed placed{&surface, node, std::nullopt, vertices_};
    if (skinned) {
      placed.skin = json["skin"].get<std::size_t>();
      read_skin(gltf, data, *placed.skin);
      surface.weights->check(gltf, skin_[*placed.skin].node.size());
    }
    vertices_ += count;
    triangles_ += surface.triangle.size();
    if (vertices_ > kMaxElements) fail(path_, ErrorCode::limit, "more than 100 million vertices");
    if (triangles_ > kMaxTriangles) fail(path_, ErrorCode::limit, "more than 20 million triangles");
    placed_.push_back(placed);
  }

  using SurfaceKey = std::tuple<std::size_t, std::size_t, bool>;  ///< mesh, primitive, and whether it has a skin

  Surface& surface_of(const GltfFile& gltf, const GltfData& data, const SurfaceKey& key) {
    if (const auto it = surface_.find(key); it != surface_.end()) return it->second;
    const auto [mesh, number, skinned] = key;
    const Json& primitive = gltf.json["meshes"][mesh]["primitives"][number];
    return surface_.emplace(key, read_surface(gltf, data, primitive, skinned)).first->second;
  }

  void read_skin(const GltfFile& gltf, const GltfData& data, std::size_t skin) {
    if (skin_.contains(skin)) return;
    Joints joints;
    for (const Json& joint : gltf.json["skins"][skin]["joints"]) joints.node.push_back(joint.get<std::size_t>());
    joints.inverse_bind = inverse_bind_matrices(gltf, data, skin);
    skin_.emplace(skin, std::move(joints));
  }

  void count_work(std::size_t more) {
    work_ += more;
    if (work_ > kMaxWork) fail(path_, ErrorCode::limit, "its instances and morph targets are too many to be animated");
  }

  /// As the file opens; every placed primitive is a part.
  [[nodiscard]] TriangleMesh opening_mesh() const {
    const Matrices matrices = matrices_of(opening_);
    TriangleMesh mesh;
    for (const Vec3& p : positions(opening_, matrices)) {
      mesh.position.push_back({double{p.x}, double{p.y}, double{p.z}});
    }
    for (const Placed& placed : placed_) {
      const auto first = static_cast<uint32_t>(placed.first);
      SourcePart part;
      part.first_triangle = static_cast<uint32_t>(mesh.triangle.size());
      for (Triangle t : placed.surface->triangle) {
        // What a node or its joints mirror when the file opens would be inside out.
        if (matrix_of(placed, matrices, t[0]).leftCols<3>().determinant() < 0) std::swap(t[1], t[2]);
        mesh.triangle.push_back({first + t[0], first + t[1], first + t[2]});
      }
      part.triangle_count = static_cast<uint32_t>(mesh.triangle.size()) - part.first_triangle;
      if (part.triangle_count > 0) mesh.part.push_back(part);
    }
    return mesh;
  }

  /// The triangles of the parts that were asked for.
  [[nodiscard]] std::vector<Triangle> selected(TriangleMesh all) const {
    return select_parts(with_choosable_parts(with_parts_of(import_mesh(path_), std::move(all), path_)), options_.parts)
        .triangle;
  }

  // --- playing -----------------------------------------------------------------------------------------------------

  [[nodiscard]] Poses pose_at(double time) const {
    if (time < options_.start) {
      Poses pose = begin_;
      for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = blend_pose(opening_[i], begin_[i], time / options_.start);
      return pose;
    }
    Poses pose = opening_;
    animation_.apply(clip_time(time), pose);
    return pose;
  }

  [[nodiscard]] std::vector<Vec3> positions(const Poses& pose, const Matrices& matrices) const {
    std::vector<Vec3> out(vertices_);
    std::vector<float> morphed;
    for (const Placed& placed : placed_) place(placed, matrices, pose[placed.node].weight, morphed, out);
    return out;
  }

  [[nodiscard]] double clip_time(double time) const {
    const double length = animation_.duration();
    const double at = std::min((time - options_.start) * options_.speed, std::numeric_limits<double>::max());
    if (!options_.loop) return std::min(at, length);
    return length > 0 ? std::fmod(at, length) : 0;
  }

  [[nodiscard]] Matrices matrices_of(const Poses& pose) const {
    std::vector<Eigen::Matrix4d> world(pose.size());
    for (const std::size_t i : order_) {
      world[i] = pose[i].local();
      if (parent_[i] < pose.size()) world[i] = world[parent_[i]] * world[i];
    }
    Matrices out;
    for (const Eigen::Matrix4d& matrix : world) out.node.push_back(affine(matrix));
    for (const auto& [skin, joints] : skin_) {
      std::vector<Affine>& joint = out.skin[skin];
      for (std::size_t k = 0; k < joints.node.size(); ++k) {
        const Eigen::Matrix4d& at = world[joints.node[k]];
        joint.push_back(affine(joints.inverse_bind.empty() ? at : at * joints.inverse_bind[k]));
      }
    }
    return out;
  }

  [[nodiscard]] static Affine matrix_of(const Placed& placed, const Matrices& matrices, std::size_t vertex) {
    if (!placed.skin) return matrices.node[placed.node];
    return placed.surface->weights->blend(vertex, std::span(matrices.skin.at(*placed.skin)));
  }

  /// @param morphed  room for the mesh with its morph targets
  static void place(const Placed& placed, const Matrices& matrices, const std::vector<double>& weight,
                    std::vector<float>& morphed, std::vector<Vec3>& out) {
    const Surface& surface = *placed.surface;
    const std::vector<float>* from = &surface.position;
    for (std::size_t i = 0; i < surface.target.size(); ++i) {
      if (weight[i] == 0 || surface.target[i].empty()) continue;
      if (from != &morphed) morphed = surface.position;
      from = &morphed;
      add_target(morphed, surface.target[i], weight[i]);
    }
    std::span<const Affine> joint;
    if (placed.skin) joint = matrices.skin.at(*placed.skin);
    const Affine& whole = matrices.node[placed.node];
    for (std::size_t i = 0; i < surface.vertices(); ++i) {
      const Eigen::Vector3d p{double{(*from)[3 * i]}, double{(*from)[3 * i + 1]}, double{(*from)[3 * i + 2]}};
      const Eigen::Vector3d q =
          placed.skin ? import_detail::placed(surface.weights->blend(i, joint), p) : import_detail::placed(whole, p);
      out[placed.first + i] = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2])};
    }
  }

  void check(const std::vector<Vec3>& position, double time) const {
    constexpr auto kFar = static_cast<float>(kMaxCoordinate);
    const auto in_range = [](float c) { return std::abs(c) <= kFar; };
    for (std::size_t i = 0; i < position.size(); ++i) {
      const Vec3& p = position[i];
      if (in_range(p.x) && in_range(p.y) && in_range(p.z)) continue;
      std::ostringstream at;
      at << time;
      bad(path_, animation_.title() + " takes vertex " + std::to_string(i) + " to no finite place at " + at.str() +
                     " s; repair it in a modelling program");
    }
  }

  std::filesystem::path path_;
  AnimationOptions options_;
  std::vector<std::size_t> targets_;  ///< of each mesh
  GltfAnimation animation_;
  std::vector<std::size_t> parent_, order_;
  Poses opening_, begin_;  ///< when the file opens, and when the animation begins
  std::map<SurfaceKey, Surface> surface_;
  std::map<std::size_t, Joints> skin_;  ///< those that are used
  std::vector<Placed> placed_;
  std::vector<Triangle> triangle_;
  std::size_t vertices_ = 0, triangles_ = 0, work_ = 0;
};

AnimatedScene read_animated(const std::filesystem::path& path, const AnimationOptions& options) {
  if (!is_gltf(path)) {
    fail(path, ErrorCode::unsupported,
         "only glTF files (.gltf, .glb, .vrm) can be played; export the animation as one");
  }
  const GltfBytes file = read_gltf_bytes(path);
  GltfFile gltf(path, file.bytes, file.binary);
  check_extensions(gltf);
  GltfData data(gltf);
  decode_draco(gltf, data);
  check_scene(gltf, data);
  return {path, gltf, data, options};
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

struct AnimatedMesh::Impl {
  explicit Impl(import_detail::AnimatedScene&& from) : scene(std::move(from)) {}
  import_detail::AnimatedScene scene;
};

AnimatedMesh::AnimatedMesh(const std::filesystem::path& path, const AnimationOptions& options) {
  import_detail::check_options(options);
  try {
    impl_ = std::make_unique<Impl>(import_detail::read_animated(path, options));
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
  return impl_->scene.triangle();
}

double AnimatedMesh::duration() const {
  return impl_->scene.duration();
}

std::vector<Vec3> AnimatedMesh::positions_as_opened() const {
  return impl_->scene.positions_as_opened();
}

std::vector<Vec3> AnimatedMesh::positions_at(double time) const {
  return impl_->scene.positions_at(time);
}

}  // namespace geocloth
