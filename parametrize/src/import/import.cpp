// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files through assimp. What assimp takes on trust is checked before it sees the bytes (import_*.cpp), it reads
// them from memory, and no post-processing step of it runs: those merge, split and reorder vertices by all attributes
// at once. Vertices, polygons, part ranges and pictures are collected from its scene here, in the order of the file.
#include "geocloth/parametrize/import.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <new>

#include <assimp/GltfMaterial.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "import/gltf_file.h"
#include "import/import_detail.h"
#include "import/import_files.h"
#include "import/scene_pose.h"
#include "import/vertex_paint.h"

#if defined(__SANITIZE_ADDRESS__)
// assimp 5.2.5 leaves tokens of a broken FBX file behind, and that is not to be laid at our door.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp";
}
#endif

namespace geocloth {
namespace import_detail {

void fail(const std::filesystem::path& file, ErrorCode code, const std::string& what) {
  std::string message = file.string() + ": " + what;
  for (char& c : message) {
    if (static_cast<unsigned char>(c) < 32) c = ' ';  // names inside hostile files must not break the line
  }
  throw Error(code, message);
}

namespace {

enum class Format { obj, gltf, glb, ply, stl, fbx, dae };

Format format_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::map<std::string, Format> known{{".obj", Format::obj}, {".gltf", Format::gltf}, {".glb", Format::glb},
                                            {".ply", Format::ply}, {".stl", Format::stl},   {".fbx", Format::fbx},
                                            {".dae", Format::dae}, {".vrm", Format::glb}};
  const auto it = known.find(ending);
  if (it != known.end()) return it->second;
  fail(file, ErrorCode::unsupported,
       "unknown ending '" + ending +
           "'; geocloth reads .obj, .gltf, .glb, .vrm, .ply, .stl, .fbx and .dae: export the mesh as one of these");
}

// --- files for assimp --------------------------------------------------------------------------------------------

class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}
  std::size_t Read(void* buffer, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(buffer, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    if (offset > bytes_.size() - base) return aiReturn_FAILURE;
    at_ = base + offset;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

/// Serves files from memory, and others from beside the mesh. Nothing can be written.
class MeshFiles final : public Assimp::IOSystem {
 public:
  MeshFiles(std::filesystem::path mesh, std::vector<MemoryFile> files)
      : mesh_(std::move(mesh)), files_(std::move(files)) {}

  bool Exists(const char* file) const override {
    std::error_code error;
    return in_memory(file) != nullptr || std::filesystem::is_regular_file(resolve(mesh_, file), error);
  }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::strchr(mode, 'w') != nullptr) return nullptr;
    if (const MemoryFile* known = in_memory(file)) return new MemoryStream(known->bytes);
    if (!Exists(file)) return nullptr;
    try {
      const std::vector<std::byte> bytes = read_file(resolve(mesh_, file), kMaxFileBytes);
      std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      const bool obj = std::string_view(files_[0].name).ends_with(".obj");
      return new MemoryStream(obj ? clean_mtl(text) : std::move(text));
    } catch (const Error&) {
      return nullptr;
    }
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const MemoryFile* in_memory(std::string_view name) const {
    if (name.starts_with("./")) name.remove_prefix(2);
    const auto it = std::find_if(files_.begin(), files_.end(), [&](const MemoryFile& f) { return f.name == name; });
    return it != files_.end() ? &*it : nullptr;
  }

  std::filesystem::path mesh_;
  std::vector<MemoryFile> files_;
};

// --- scene to mesh -------------------------------------------------------------------------------------------------

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

/// The rotation that turns an FBX file's up axis to +y and its front axis to +z; assimp leaves them as they are.
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

class MeshBuilder {
 public:
  MeshBuilder(const std::filesystem::path& file, Format format, const aiScene& scene, ObjText* obj, double scale)
      : file_(file), format_(format), scene_(scene), scale_(scale) {
    mesh_.name = file.stem().string();
    if (obj != nullptr) {
      obj_position_ = std::move(obj->position);
      obj_color_ = std::move(obj->color);
      obj_part_name_ = std::move(obj->part_name);
    }
  }

  TriangleMesh build() {
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
    finish_paint();
    sort_groups();
    return std::move(mesh_);
  }

 private:
  const aiMesh& mesh_of(const Placement& placement) const { return *scene_.mMeshes[placement.mesh]; }

  Pose pose_of(const Placement& placement) {
    // Skinned glTF comes posed already (gltf_pose.h); FBX keeps its bind pose, which is how assimp places it.
    if (format_ != Format::dae) return Pose({placement.to_world, {}});
    return Pose(pose_.matrices(scene_, *placement.node, mesh_of(placement), placement.to_world));
  }

  std::string name_of(const Placement& placement) const {
    const aiString& own = mesh_of(placement).mName;
    std::string name = own.length > 0 ? own.C_Str() : placement.node->mName.C_Str();
    if (format_ != Format::obj) return name;
    size_t number = obj_part_name_.size();
    std::from_chars(name.data(), name.data() + name.size(), number);
    return number < obj_part_name_.size() ? obj_part_name_[number] : name;
  }

  [[noreturn]] void bad(const std::string& what) const { fail(file_, ErrorCode::invalid_data, what); }

  void add_vertex(const Point3& p) {
    if (mesh_.position.size() >= kMaxElements) fail(file_, ErrorCode::limit, "more than 100 million vertices");
    const std::string which = "vertex " + std::to_string(mesh_.position.size());
    for (const double c : p) {
      if (!std::isfinite(c))
        bad(which + " has a coordinate that is not a finite number; repair it in a modelling program");
      if (std::abs(c) > kMaxCoordinate) {
        fail(file_, ErrorCode::limit,
             which + " has a coordinate beyond 1e18 m; check the file, or use --unit or --scale");
      }
    }
    mesh_.position.push_back(p);
  }

  void add_obj_vertices() {
    mesh_.position.reserve(obj_position_.size());
    for (const Point3& p : obj_position_) add_vertex({scale_ * p[0], scale_ * p[1], scale_ * p[2]});
  }

  /// Numbers in `position` of the vertices of one placed mesh.
  std::vector<uint32_t> add_vertices(const Placement& placement, const Pose& pose) {
    const aiMesh& mesh = mesh_of(placement);
    std::vector<uint32_t> number(mesh.mNumVertices);
    // FBX and DAE come with a vertex per face corner: corners at one place are one vertex, in order of first use.
    const bool merge = format_ == Format::fbx || format_ == Format::dae;
    std::map<std::array<float, 3>, uint32_t> seen;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      aiVector3D p = mesh.mVertices[i];
      if (format_ == Format::obj) {
        number[i] = decode_obj_vertex(p.x, p.y);
        continue;
      }
      if (pose.bent()) p *= pose.matrices.each[i];
      const auto fresh = static_cast<uint32_t>(mesh_.position.size());
      if (merge && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
        const auto [it, inserted] = seen.try_emplace({p.x, p.y, p.z}, fresh);
        number[i] = it->second;
        if (!inserted) continue;
      }
      number[i] = fresh;
      const Point3 at{double{p.x}, double{p.y}, double{p.z}};
      add_vertex(transform(pose.bent() ? aiMatrix4x4() : pose.matrices.all, at, scale_));
    }
    return number;
  }

  void add_part(const Placement& placement) {
    const aiMesh& mesh = mesh_of(placement);
    const Pose pose = pose_of(placement);
    const std::vector<uint32_t> number = add_vertices(placement, pose);
    const auto first = static_cast<uint32_t>(mesh_.triangle.size());
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) add_polygon(mesh, mesh.mFaces[f], number, pose);
    const auto count = static_cast<uint32_t>(mesh_.triangle.size()) - first;
    if (count == 0) return;
    const std::string name = name_of(placement);
    mesh_.part.push_back({name, material_[mesh.mMaterialIndex], first, count});
    // Parts, bones and paint are what a file has for naming points.
    add_group(name, number);
    add_bones(mesh, number);
    add_paint(mesh, number);
  }

  void add_polygon(const aiMesh& mesh, const aiFace& face, const std::vector<uint32_t>& number, const Pose& pose) {
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
      add_group(bone.mName.C_Str(), members);
    }
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
    const bool gltf = format_ == Format::gltf || format_ == Format::glb;
    if (!gltf && from.Get(AI_MATKEY_OPACITY, value) == aiReturn_SUCCESS) to.base_color[3] = share(value);
    read_alpha(from, to);
    to.base_color_image = add_image(from, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
    to.normal_image = add_image(from, {aiTextureType_NORMALS});
    if (gltf) to.metallic_roughness_image = add_image(from, {aiTextureType_METALNESS, aiTextureType_UNKNOWN});
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
  std::vector<Point3> obj_position_;
  std::vector<std::string> obj_part_name_;
  TriangleMesh mesh_;
  bool has_uv_ = false, has_normal_ = false;
  uint32_t polygon_count_ = 0;
  std::vector<uint32_t> material_;  ///< per material of the scene: its number in mesh_
  std::map<std::string, std::optional<uint32_t>> image_;
  std::map<std::string, std::size_t> group_;
  std::vector<std::array<float, 3>> obj_color_;
  bool is_painted_ = false;
  VertexPaint paint_;
  std::vector<Point3> corner_position_;
  std::vector<Triangle> cut_;
};

/// Metres per unit of what assimp returns.
double file_unit(const aiScene& scene, Format format) {
  if (format != Format::fbx || scene.mMetaData == nullptr) return 1;
  double centimetres = 0;
  float single = 0;
  if (!scene.mMetaData->Get("UnitScaleFactor", centimetres)) {
    if (!scene.mMetaData->Get("UnitScaleFactor", single)) return 1;
    centimetres = double{single};
  }
  return std::isfinite(centimetres) && centimetres > 0 ? centimetres * 0.01 : 1;
}

/// Some editors open every UTF-8 text with it.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// By its byte order mark, or by the zero beside its first letter.
bool looks_like_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  if (text.size() < 4) return false;
  const auto is_ascii = [](char c) { return c > 0 && c < 127; };
  return (is_ascii(text[0]) && text[1] == 0 && is_ascii(text[2]) && text[3] == 0) ||
         (text[0] == 0 && is_ascii(text[1]) && text[2] == 0 && is_ascii(text[3]));
}

void refuse_utf16(const std::filesystem::path& file, std::string_view text) {
  if (!looks_like_utf16(text)) return;
  fail(file, ErrorCode::unsupported, "its text is UTF-16, as some editors and shells write it; save it as UTF-8");
}

std::string_view without_mark(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::vector<std::byte> read_not_empty(const std::filesystem::path& file) {
  std::vector<std::byte> bytes = read_file(file, kMaxFileBytes);
  if (bytes.empty()) fail(file, ErrorCode::invalid_data, "the file is empty");
  return bytes;
}

/// Whether a glTF file is GLB, which shows in its first byte, whatever the ending says.
bool is_container(Format format, std::string_view text) {
  return format == Format::glb ? !text.starts_with('{') : text.starts_with("glTF");
}

/// What assimp gets to see of a file: the file first, then what goes with it. The name's ending decides the reader.
/// @param obj           filled when the file is an OBJ
/// @param applied_unit  metres per unit of the file that assimp applies by itself
/// @param left_out      filled with what of the file is not in them
std::vector<MemoryFile> prepare(const std::filesystem::path& file, Format format, std::span<const std::byte> bytes,
                                ObjText& obj, double& applied_unit, std::vector<std::string>& left_out) {
  std::string text(without_mark(bytes));
  if (format != Format::stl) refuse_utf16(file, text);  // a binary STL opens with whatever its program likes
  switch (format) {
    case Format::gltf:
    case Format::glb:
      return read_gltf(file, bytes, is_container(format, text), left_out);
    case Format::obj:
      obj = read_obj(file, text);
      return {{"mesh.obj", std::move(obj.coded)}};
    case Format::ply:
      check_ply(file, text);
      return {{"mesh.ply", std::move(text)}};
    case Format::stl:
      return {{"mesh.stl", checked_stl(file, std::move(text))}};
    case Format::fbx:
      check_fbx(file, text);
      return {{"mesh.fbx", std::move(text)}};
    case Format::dae: {
      DaeText dae = read_dae(file, text);
      applied_unit = dae.metres_per_unit;
      return {{"mesh.dae", std::move(dae.text)}};
    }
  }
  return {};
}

TriangleMesh read(const std::filesystem::path& file, const ImportOptions& options) {
  const Format format = format_of(file);
  const std::vector<std::byte> bytes = read_not_empty(file);
  ObjText obj;
  double applied_unit = 1;
  std::vector<std::string> left_out;
  std::vector<MemoryFile> files = prepare(file, format, bytes, obj, applied_unit, left_out);
  const std::string name = files[0].name;
  Assimp::Importer importer;
  importer.SetIOHandler(new MeshFiles(file, std::move(files)));
  // FBX: every vertex as it is, no helper nodes that only carry pivots.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    fail(file, ErrorCode::invalid_data,
         "cannot be read as a mesh (" + std::string(importer.GetErrorString()) + "); is the file cut off or damaged?");
  }
  const double scale = options.scale ? *options.scale / applied_unit : file_unit(*scene, format);
  TriangleMesh mesh = MeshBuilder(file, format, *scene, format == Format::obj ? &obj : nullptr, scale).build();
  if (mesh.triangle.empty()) fail(file, ErrorCode::invalid_data, "has no faces; cloth needs triangles or polygons");
  mesh.left_out = std::move(left_out);
  return mesh;
}

}  // namespace

bool is_gltf(const std::filesystem::path& file) {
  const Format format = format_of(file);
  return format == Format::gltf || format == Format::glb;
}

GltfBytes read_gltf_bytes(const std::filesystem::path& file) {
  GltfBytes out{read_not_empty(file)};
  const std::string_view text = without_mark(out.bytes);
  refuse_utf16(file, text);
  out.binary = is_container(format_of(file), text);
  return out;
}

}  // namespace import_detail

size_t count_animations(const std::filesystem::path& path) {
  if (!import_detail::is_gltf(path)) return 0;
  const import_detail::GltfBytes file = import_detail::read_gltf_bytes(path);
  return import_detail::GltfFile(path, file.bytes, file.binary).array("animations").size();
}

TriangleMesh import_mesh(const std::filesystem::path& path, const ImportOptions& options) {
  if (options.scale && !(std::isfinite(*options.scale) && *options.scale > 0)) {
    throw Error(ErrorCode::invalid_argument, "import scale must be a positive number");
  }
  try {
    return import_detail::read(path, options);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    import_detail::fail(path, ErrorCode::limit, "does not fit into memory; reduce the mesh");
  } catch (const std::exception& e) {
    import_detail::fail(path, ErrorCode::invalid_data, std::string("cannot be read as a mesh (") + e.what() + ")");
  }
}

}  // namespace geocloth
