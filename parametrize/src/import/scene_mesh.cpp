// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/scene_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include "import/import_detail.h"
#include "import/import_files.h"
#include "import/vertex_paint.h"

namespace geocloth::import_detail {
namespace {

constexpr std::string_view kUnnamedGltfNode = "nodes[";  ///< begins what assimp calls those that have no name

/// One mesh of the scene where one node places it.
struct Placement {
  unsigned mesh;
  aiMatrix4x4 to_world;
  const aiNode* node;
};

void collect(const aiNode* node, const aiMatrix4x4& parent, std::vector<Placement>& out, ScenePose& pose) {
  const aiMatrix4x4 to_world = parent * node->mTransformation;
  pose.add(*node, to_world);
  for (unsigned i = 0; i < node->mNumMeshes; ++i) out.push_back({node->mMeshes[i], to_world, node});
  for (unsigned i = 0; i < node->mNumChildren; ++i) collect(node->mChildren[i], to_world, out, pose);
}

Point3 transform(const aiMatrix4x4& m, const Point3& p, double scale) {
  return {scale * (double{m.a1} * p[0] + double{m.a2} * p[1] + double{m.a3} * p[2] + double{m.a4}),
          scale * (double{m.b1} * p[0] + double{m.b2} * p[1] + double{m.b3} * p[2] + double{m.b4}),
          scale * (double{m.c1} * p[0] + double{m.c2} * p[1] + double{m.c3} * p[2] + double{m.c4})};
}

Point3 unit(const Point3& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 1, 0};
  return {v[0] / length, v[1] / length, v[2] / length};
}

/// Normals go by the inverse transpose.
aiMatrix3x3 normal_matrix(const aiMatrix4x4& m) {
  aiMatrix3x3 n(m);
  return n.Determinant() != 0 ? n.Inverse().Transpose() : aiMatrix3x3(m);
}

/// How the points and normals of one mesh get to the world.
struct Pose {
  explicit Pose(ScenePose::Matrices from)
      : matrices(std::move(from)),
        normal_of_all(normal_matrix(matrices.all)),
        all_mirrored(aiMatrix3x3(matrices.all).Determinant() < 0) {}

  [[nodiscard]] bool bent() const { return !matrices.each.empty(); }
  [[nodiscard]] aiMatrix3x3 normal(unsigned vertex) const {
    return bent() ? normal_matrix(matrices.each[vertex]) : normal_of_all;
  }
  /// Turns the faces at a vertex inside out.
  [[nodiscard]] bool mirrored(unsigned vertex) const {
    return bent() ? aiMatrix3x3(matrices.each[vertex]).Determinant() < 0 : all_mirrored;
  }

  ScenePose::Matrices matrices;
  aiMatrix3x3 normal_of_all;
  bool all_mirrored;
};

/// The points of a mesh of the file where a node places them.
struct PlacedPoints {
  /// A vertex of one of the meshes that were made of them.
  struct Source {
    std::size_t shown;
    unsigned vertex;
  };

  uint32_t first = 0;                         ///< vertex of the TriangleMesh
  std::size_t shown = 0;                      ///< number of the first mesh that was made of them
  std::vector<std::optional<Source>> source;  ///< of each point, where a face has it
};

class MeshBuilder {
 public:
  MeshBuilder(const std::filesystem::path& path, AssimpFile& file, double scale)
      : file_(path),
        format_(file.format),
        scene_(*file.scene),
        scale_(scale),
        points_(file.points),
        obj_position_(std::move(file.obj.position)),
        obj_part_name_(std::move(file.obj.part_name)),
        obj_color_(std::move(file.obj.color)) {
    mesh_.name = path.stem().string();
    mesh_.loose_edge = std::move(file.obj.loose_edge);
  }

  SceneMesh build() {
    std::vector<Placement> placements;
    collect(scene_.mRootNode, format_ == Format::fbx ? upright(scene_) : aiMatrix4x4(), placements, pose_);
    // Nodes stand in the order of the hierarchy; the file's order is that of the meshes.
    std::stable_sort(placements.begin(), placements.end(),
                     [](const Placement& a, const Placement& b) { return a.mesh < b.mesh; });
    const auto any = [&](auto&& has) {
      return std::any_of(placements.begin(), placements.end(), [&](const Placement& p) { return has(mesh_of(p)); });
    };
    has_uv_ = any([](const aiMesh& m) { return m.HasTextureCoords(0); });
    has_normal_ = any([](const aiMesh& m) { return m.HasNormals(); });
    add_materials();
    is_painted_ = !obj_color_.empty() || any([](const aiMesh& m) { return m.HasVertexColors(0); });
    if (format_ == Format::obj) add_obj_vertices();
    for (const Placement& placement : placements) add_part(placement);
    finish_points();
    add_bone_groups();
    add_mesh_groups();
    finish_paint();
    sort_groups();
    return {std::move(mesh_), std::move(shown_)};
  }

 private:
  const aiMesh& mesh_of(const Placement& placement) const { return *scene_.mMeshes[placement.mesh]; }

  Pose pose_of(const Placement& placement) {
    // Skinned glTF comes posed already (gltf_pose.h); FBX keeps its bind pose, which is how assimp places it.
    if (format_ != Format::dae) return Pose({placement.to_world, {}});
    return Pose(pose_.matrices(scene_, *placement.node, mesh_of(placement), placement.to_world));
  }

  /// What the file calls the mesh, or else the node.
  std::string mesh_name_of(const Placement& placement) const {
    const aiString& own = mesh_of(placement).mName;
    std::string name = own.length > 0 ? own.C_Str() : placement.node->mName.C_Str();
    if (format_ == Format::fbx) name = name.substr(0, name.find(kFbxHelper));
    if (format_ != Format::obj) return name;
    size_t number = obj_part_name_.size();
    std::from_chars(name.data(), name.data() + name.size(), number);
    return number < obj_part_name_.size() ? obj_part_name_[number] : name;
  }

  /// What people know it by, who name objects, and leave "Plane.004" to meshes.
  std::string name_of(const Placement& placement) const {
    const std::string_view node = placement.node->mName.C_Str();
    const bool has_objects = format_ == Format::fbx || format_ == Format::dae || is_gltf();
    const bool is_named = placement.node != scene_.mRootNode && !node.empty() && !node.starts_with(kUnnamedGltfNode);
    if (!has_objects || !is_named) return mesh_name_of(placement);
    return std::string(node.substr(0, format_ == Format::fbx ? node.find(kFbxHelper) : node.npos));
  }

  bool is_gltf() const { return format_ == Format::gltf || format_ == Format::glb; }

  [[noreturn]] void bad(const std::string& what) const { fail(file_, ErrorCode::invalid_data, what); }

  void add_vertex(const Point3& p) {
    if (mesh_.position.size() >= kMaxElements) fail(file_, ErrorCode::limit, "more than 100 million vertices");
    const auto which = [&] { return "vertex " + std::to_string(mesh_.position.size()); };
    for (const double c : p) {
      if (!std::isfinite(c))
        bad(which() + " has a coordinate that is not a finite number; repair it in a modelling program");
      if (std::abs(c) > kMaxCoordinate) {
        fail(file_, ErrorCode::limit,
             which() + " has a coordinate beyond 1e18 m; check the file, or use --unit or --scale");
      }
    }
    mesh_.position.push_back(p);
  }

  void add_obj_vertices() {
    mesh_.position.reserve(obj_position_.size());
    for (const Point3& p : obj_position_) add_vertex({scale_ * p[0], scale_ * p[1], scale_ * p[2]});
  }

  /// Where a vertex of a mesh is in the world; of a point that no face has, where all are.
  Point3 place_of(const ShownVertex& shown, const ScenePose::Matrices& matrices) const {
    const bool bent = !matrices.each.empty() && shown.vertex;
    const aiVector3D p = bent ? matrices.each[*shown.vertex] * shown.position : shown.position;
    return transform(bent ? aiMatrix4x4() : matrices.all, {double{p.x}, double{p.y}, double{p.z}}, scale_);
  }

  /// Numbers in `position` of the vertices of one placed mesh.
  /// @param from  number in points_ of what the mesh was made of
  std::vector<uint32_t> add_vertices(const Placement& placement, std::size_t from, const Pose& pose) {
    const aiMesh& mesh = mesh_of(placement);
    std::vector<uint32_t> number(mesh.mNumVertices);
    if (format_ == Format::obj) {
      for (unsigned i = 0; i < mesh.mNumVertices; ++i)
        number[i] = decode_obj_vertex(mesh.mVertices[i].x, mesh.mVertices[i].y);
    } else if (format_ == Format::fbx || format_ == Format::dae) {
      shown_.push_back({placement.node, &mesh, {}, pose.matrices});
      if (from < points_.size()) {
        number_as_file(placement, from, number);
      } else {
        number_by_use(number);
      }
    } else {
      for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        number[i] = static_cast<uint32_t>(mesh_.position.size());
        add_vertex(place_of({number[i], i, mesh.mVertices[i]}, pose.matrices));
      }
    }
    return number;
  }

  /// Numbers the corners that shown_.back() has, those at one place alike, in the order of their first use.
  void number_by_use(std::vector<uint32_t>& number) {
    ShownMesh& shown = shown_.back();
    std::map<FilePoint, uint32_t> seen;
    for (unsigned i = 0; i < number.size(); ++i) {
      const aiVector3D p = shown.mesh->mVertices[i];
      number[i] = static_cast<uint32_t>(mesh_.position.size());
      if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
        const auto [it, is_new] = seen.try_emplace({p.x, p.y, p.z}, number[i]);
        number[i] = it->second;
        if (!is_new) continue;
      }
      shown.vertex.push_back({number[i], i, p});
      add_vertex(place_of(shown.vertex.back(), shown.matrices));
    }
  }

  /// Numbers the corners that shown_.back() has as the points of the file. The meshes of a node that were made of one,
  /// a mesh for each material, share them.
  void number_as_file(const Placement& placement, std::size_t from, std::vector<uint32_t>& number) {
    const FilePoints& points = points_[from];
    const std::size_t shown = shown_.size() - 1;
    const auto [it, is_new] = placed_points_.try_emplace({placement.node, from});
    PlacedPoints& placed = it->second;
    if (is_new) {
      placed = {static_cast<uint32_t>(mesh_.position.size()), shown, {}};
      placed.source.resize(points.size());
      for (uint32_t k = 0; k < points.size(); ++k)
        add_vertex(place_of(loose_point(points, k, placed), shown_[shown].matrices));
    }
    const std::vector<uint32_t> point = points.points_of(*shown_[shown].mesh);
    for (unsigned i = 0; i < number.size(); ++i) {
      number[i] = placed.first + point[i];
      if (placed.source[point[i]]) continue;
      placed.source[point[i]] = {shown, i};
      show({shown, i}, number[i]);
    }
  }

  static ShownVertex loose_point(const FilePoints& points, uint32_t k, const PlacedPoints& placed) {
    const auto& [x, y, z] = points.position(k);
    return {placed.first + k, std::nullopt, {x, y, z}};
  }

  /// Has a vertex move as one of a mesh does.
  void show(const PlacedPoints::Source& source, uint32_t number) {
    ShownMesh& shown = shown_[source.shown];
    shown.vertex.push_back({number, source.vertex, shown.mesh->mVertices[source.vertex]});
    mesh_.position[number] = place_of(shown.vertex.back(), shown.matrices);
  }

  /// Points that no face has move with one that lies where they do, or else with their nodes, and are painted as others
  /// are.
  void finish_points() {
    for (const auto& [key, placed] : placed_points_) {
      const FilePoints& points = points_[key.second];
      std::vector<uint32_t> shown_at(points.size(), kNone);  // one that a face has, by the first point at its place
      for (uint32_t k = 0; k < points.size(); ++k) {
        uint32_t& known = shown_at[points.first_at(k)];
        if (known == kNone && placed.source[k]) known = k;
      }
      const uint32_t any = shown_[placed.shown].vertex.empty() ? 0 : shown_[placed.shown].vertex[0].number;
      for (uint32_t k = 0; k < points.size(); ++k) {
        const uint32_t number = placed.first + k, twin = shown_at[points.first_at(k)];
        if (is_painted_) paint_.copy(twin != kNone ? placed.first + twin : any, number);
        if (placed.source[k]) continue;
        if (twin != kNone) {
          show(*placed.source[twin], number);
        } else {
          shown_[placed.shown].vertex.push_back(loose_point(points, k, placed));
        }
      }
    }
  }

  /// The vertices of an object: the points that its file has of it, or those of its faces.
  std::vector<uint32_t> vertices_of(const Placement& placement, std::size_t from,
                                    const std::vector<uint32_t>& number) const {
    const auto placed = placed_points_.find({placement.node, from});
    if (placed == placed_points_.end()) return number;
    std::vector<uint32_t> out(placed->second.source.size());
    std::iota(out.begin(), out.end(), placed->second.first);
    return out;
  }

  void add_part(const Placement& placement) {
    const aiMesh& mesh = mesh_of(placement);
    const Pose pose = pose_of(placement);
    const std::size_t from = find_points(points_, mesh);
    const std::vector<uint32_t> number = add_vertices(placement, from, pose);
    const auto first = static_cast<uint32_t>(mesh_.triangle.size());
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) add_polygon(mesh, mesh.mFaces[f], number, pose);
    const auto count = static_cast<uint32_t>(mesh_.triangle.size()) - first;
    if (count == 0) return;
    const std::string name = name_of(placement), mesh_name = mesh_name_of(placement);
    mesh_.part.push_back({name, material_[mesh.mMaterialIndex], first, count});
    mesh_.part_mesh.push_back(mesh_name);
    // Parts, bones and paint are what a file has for naming points.
    std::vector<uint32_t> all = vertices_of(placement, from, number);
    add_group(name, all);
    if (mesh_name != name) vertices_of_mesh_.emplace_back(mesh_name, std::move(all));
    add_bones(mesh, number);
    add_paint(mesh, number);
  }

  void add_loose_edge(const std::array<unsigned, 2>& end, const std::vector<uint32_t>& number) {
    for (const unsigned e : end) {
      if (e >= number.size() || number[e] >= mesh_.position.size()) bad("a line uses a vertex that does not exist");
    }
    if (number[end[0]] != number[end[1]]) mesh_.loose_edge.push_back({number[end[0]], number[end[1]]});
  }

  void add_polygon(const aiMesh& mesh, const aiFace& face, const std::vector<uint32_t>& number, const Pose& pose) {
    if (face.mNumIndices == 2) add_loose_edge({face.mIndices[0], face.mIndices[1]}, number);
    if (face.mNumIndices < 3) return;  // points and lines
    if (face.mNumIndices > kMaxPolygonCorners) {
      bad("a polygon of more than 4096 corners; triangulate it before exporting");
    }
    std::vector<unsigned> corner(face.mIndices, face.mIndices + face.mNumIndices);
    for (const unsigned c : corner) {
      if (c >= number.size() || number[c] >= mesh_.position.size()) bad("a face uses a vertex that does not exist");
    }
    // A mirroring node turns the faces inside out.
    if (pose.mirrored(corner[0])) std::reverse(corner.begin(), corner.end());
    corner_position_.clear();
    for (const unsigned c : corner) corner_position_.push_back(mesh_.position[number[c]]);
    cut_.clear();
    triangulate_polygon(corner_position_, cut_);
    for (const Triangle& t : cut_) {
      const std::array<unsigned, 3> c{corner[t[0]], corner[t[1]], corner[t[2]]};
      mesh_.triangle.push_back({number[c[0]], number[c[1]], number[c[2]]});
      mesh_.polygon.push_back(polygon_count_);
      add_corners(mesh, c, pose);
    }
    ++polygon_count_;
    if (mesh_.triangle.size() > kMaxTriangles) fail(file_, ErrorCode::limit, "more than 20 million triangles");
  }

  void add_corners(const aiMesh& mesh, const std::array<unsigned, 3>& c, const Pose& pose) {
    if (has_uv_) {
      std::array<Point2, 3> uv{};
      for (std::size_t k = 0; mesh.HasTextureCoords(0) && k < 3; ++k) {
        const aiVector3D& t = mesh.mTextureCoords[0][c[k]];
        // assimp counts v upwards.
        if (std::isfinite(t.x) && std::isfinite(t.y)) uv[k] = {double{t.x}, 1.0 - double{t.y}};
      }
      mesh_.uv.push_back(uv);
    }
    if (has_normal_) mesh_.normal.push_back(mesh.HasNormals() ? given_normals(mesh, c, pose) : flat_normal());
  }

  std::array<Point3, 3> given_normals(const aiMesh& mesh, const std::array<unsigned, 3>& c, const Pose& pose) const {
    std::array<Point3, 3> normal;
    for (std::size_t k = 0; k < 3; ++k) {
      const aiVector3D n = pose.normal(c[k]) * mesh.mNormals[c[k]];
      normal[k] = unit({double{n.x}, double{n.y}, double{n.z}});
    }
    return normal;
  }

  /// Of the triangle added last.
  std::array<Point3, 3> flat_normal() const {
    const Triangle& t = mesh_.triangle.back();
    const Point3 &a = mesh_.position[t[0]], &b = mesh_.position[t[1]], &c = mesh_.position[t[2]];
    const Point3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    const Point3 n = unit({u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]});
    return {n, n, n};
  }

  /// A bone is a vertex group: the vertices that follow it more than anything else.
  void add_bones(const aiMesh& mesh, const std::vector<uint32_t>& number) {
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      std::vector<uint32_t> members;
      for (unsigned w = 0; w < bone.mNumWeights; ++w) {
        const aiVertexWeight& weight = bone.mWeights[w];
        if (weight.mWeight >= 0.5F && weight.mVertexId < number.size()) members.push_back(number[weight.mVertexId]);
      }
      vertices_of_bone_.emplace_back(bone.mName.C_Str(), std::move(members));
    }
  }

  /// A bone that is named as an object or its mesh, as that of a skirt often is, has more to its name: its points and
  /// theirs are two things.
  void add_bone_groups() {
    std::set<std::string_view> others;
    for (const SourcePart& part : mesh_.part) others.insert(part.name);
    for (const std::string& name : mesh_.part_mesh) others.insert(name);
    for (const auto& [name, vertices] : vertices_of_bone_)
      add_group(others.contains(name) ? "bone:" + name : name, vertices);
  }

  void add_paint(const aiMesh& mesh, const std::vector<uint32_t>& number) {
    if (!is_painted_ || format_ == Format::obj) return;  // read_obj has it
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiColor4D color = mesh.HasVertexColors(0) ? mesh.mColors[0][v] : aiColor4D(1, 1, 1, 1);
      paint_.add(number[v], {color.r, color.g, color.b, color.a});
    }
  }

  void finish_paint() {
    if (!is_painted_) return;
    for (uint32_t v = 0; v < obj_color_.size(); ++v) {
      const auto& [red, green, blue] = obj_color_[v];
      paint_.add(v, {red, green, blue, 1});
    }
    mesh_.paint = paint_.colors(mesh_.position.size());
    for (const ClothAsset::VertexGroup& group : paint_.groups(mesh_.position.size()))
      add_group(group.name, group.source_vertex);
  }

  void add_group(const std::string& name, const std::vector<uint32_t>& members) {
    if (members.empty() || name.empty()) return;
    const auto [it, fresh] = group_.try_emplace(name, mesh_.vertex_groups.size());
    if (fresh) mesh_.vertex_groups.push_back({name, {}});
    std::vector<uint32_t>& all = mesh_.vertex_groups[it->second].source_vertex;
    all.insert(all.end(), members.begin(), members.end());
  }

  /// The vertices of meshes by their names, as far as these are not those of objects.
  void add_mesh_groups() {
    std::set<std::string_view> objects;
    for (const SourcePart& part : mesh_.part) objects.insert(part.name);
    for (const auto& [name, vertices] : vertices_of_mesh_) {
      if (!objects.contains(name)) add_group(name, vertices);
    }
  }

  void sort_groups() {
    for (ClothAsset::VertexGroup& group : mesh_.vertex_groups) {
      std::vector<uint32_t>& all = group.source_vertex;
      std::sort(all.begin(), all.end());
      all.erase(std::unique(all.begin(), all.end()), all.end());
    }
  }

  // --- materials ---------------------------------------------------------------------------------------------------

  /// Only materials that a mesh uses: assimp adds one of its own.
  void add_materials() {
    material_.assign(scene_.mNumMaterials, 0);
    std::vector<bool> used(scene_.mNumMaterials, false);
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i) {
      const unsigned material = scene_.mMeshes[i]->mMaterialIndex;
      if (material >= scene_.mNumMaterials) bad("a mesh uses a material that does not exist");
      used[material] = true;
    }
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
      if (!used[i]) continue;
      material_[i] = static_cast<uint32_t>(mesh_.material.size());
      mesh_.material.push_back(read_material(*scene_.mMaterials[i]));
    }
  }

  SourceMaterial read_material(const aiMaterial& from) {
    SourceMaterial to;
    aiString text;
    if (from.Get(AI_MATKEY_NAME, text) == aiReturn_SUCCESS) to.name = text.C_Str();
    aiColor4D color(1, 1, 1, 1);
    if (from.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS ||
        from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) {
      to.base_color = {share(color.r), share(color.g), share(color.b), share(color.a)};
    }
    ai_real value = 0;
    if (from.Get(AI_MATKEY_METALLIC_FACTOR, value) == aiReturn_SUCCESS) to.metallic = share(value);
    if (from.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == aiReturn_SUCCESS) to.roughness = share(value);
    if (!is_gltf() && from.Get(AI_MATKEY_OPACITY, value) == aiReturn_SUCCESS) to.base_color[3] = share(value);
    read_alpha(from, to);
    to.base_color_image = add_image(from, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    to.normal_image = add_image(from, {aiTextureType_NORMALS});
    if (is_gltf()) to.metallic_roughness_image = add_image(from, {aiTextureType_METALNESS, aiTextureType_UNKNOWN});
    return to;
  }

  static float share(float value) { return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 1.0F; }

  static void read_alpha(const aiMaterial& from, SourceMaterial& to) {
    aiString mode;
    ai_real cutoff = 0;
    if (from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
      to.alpha_mask = std::strcmp(mode.C_Str(), "MASK") == 0;
      to.alpha_blend = std::strcmp(mode.C_Str(), "BLEND") == 0;
      if (from.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff) == aiReturn_SUCCESS) to.alpha_cutoff = share(cutoff);
    } else {
      to.alpha_blend = to.base_color[3] < 1;
    }
  }

  std::optional<uint32_t> add_image(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    aiString path;
    for (const aiTextureType type : types) {
      if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) continue;
      const std::string name = path.C_Str();
      const auto [it, inserted] = image_.try_emplace(name, std::nullopt);
      if (inserted) it->second = load_image(name);
      if (it->second) return it->second;
    }
    return std::nullopt;
  }

  /// Pictures are kept as the bytes they are. A missing one only costs looks.
  std::optional<uint32_t> load_image(const std::string& name) {
    std::optional<std::vector<uint8_t>> bytes;
    std::string title = std::filesystem::path(name).stem().string();
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str()); embedded != nullptr) {
      if (embedded->mHeight != 0) return std::nullopt;  // raw texels, of no format that glTF knows
      const auto* data = reinterpret_cast<const uint8_t*>(embedded->pcData);
      bytes.emplace(data, data + embedded->mWidth);
      if (embedded->mFilename.length > 0) title = std::filesystem::path(embedded->mFilename.C_Str()).stem().string();
    } else {
      bytes = read_picture(file_, name);
    }
    const std::optional<std::string> type = bytes ? picture_type(*bytes) : std::nullopt;
    if (!type) return std::nullopt;
    mesh_.image.push_back({title, *type, std::move(*bytes)});
    return static_cast<uint32_t>(mesh_.image.size() - 1);
  }

  const std::filesystem::path& file_;
  Format format_;
  const aiScene& scene_;
  double scale_;
  ScenePose pose_;
  std::span<const FilePoints> points_;
  std::map<std::pair<const aiNode*, std::size_t>, PlacedPoints> placed_points_;  ///< by node and number in points_
  std::vector<Point3> obj_position_;
  std::vector<std::string> obj_part_name_;
  std::vector<std::array<float, 3>> obj_color_;
  TriangleMesh mesh_;
  std::vector<ShownMesh> shown_;
  bool has_uv_ = false, has_normal_ = false;
  uint32_t polygon_count_ = 0;
  std::vector<uint32_t> material_;  ///< per material of the scene: its number in mesh_
  std::map<std::string, std::optional<uint32_t>> image_;
  std::map<std::string, std::size_t> group_;
  std::vector<std::pair<std::string, std::vector<uint32_t>>> vertices_of_mesh_;  ///< where a part has another name
  std::vector<std::pair<std::string, std::vector<uint32_t>>> vertices_of_bone_;
  bool is_painted_ = false;
  VertexPaint paint_;
  std::vector<Point3> corner_position_;
  std::vector<Triangle> cut_;
};

}  // namespace

aiMatrix4x4 upright(const aiScene& scene) {
  const auto axis = [&](const char* name) {
    int32_t number = -1, sign = 0;
    aiVector3D direction;
    const aiMetadata* data = scene.mMetaData;
    const bool known = data != nullptr && data->Get(std::string(name) + "Axis", number) &&
                       data->Get(std::string(name) + "AxisSign", sign) && number >= 0 && number < 3 && sign != 0;
    if (known) direction[static_cast<unsigned>(number)] = sign < 0 ? -1.0F : 1.0F;
    return direction;
  };
  const aiVector3D up = axis("Up"), front = axis("Front"), right = up ^ front;
  if (right.SquareLength() == 0) return {};
  return {right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, front.x, front.y, front.z, 0, 0, 0, 0, 1};
}

SceneMesh mesh_of_scene(const std::filesystem::path& path, AssimpFile& file, double scale) {
  return MeshBuilder(path, file, scale).build();
}

}  // namespace geocloth::import_detail
