// SPDX-License-Identifier: GPL-3.0-or-later
// The caches that the writers beside this file make, read back: morph targets are added to their mesh, point caches are
// cut into frames. Sizes are compared with the bytes at hand before anything is allocated.
#include "export/cache_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"
#include "glb_reader.h"

namespace geocloth {
namespace {

using glb::Json;
using glb::Reader;

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

/// A cloth of the file as it grows, primitive by primitive. Faces that a cut opens are primitives of their own over the
/// vertices of others.
class ClothReader {
 public:
  /// @param materials  of the file; a cloth takes those that it uses, which no other cloth can have then
  ClothReader(Reader& reader, std::vector<std::optional<SourceMaterial>>& materials)
      : reader_(reader), materials_(materials) {}

  SourceMesh mesh;
  std::vector<uint32_t> open_from;        ///< of each triangle
  std::vector<std::vector<Vec3>> frames;  ///< positions

  /// Whether a mesh of the file is of this cloth: it says so, or has a material of it.
  [[nodiscard]] bool owns(const Json& json) const {
    const std::optional<uint32_t> number = cloth_number(json);
    if (number && number_) return number == number_;
    const Json& primitives = reader_.array(json, "primitives");
    return !primitives.empty() && material_number_.contains(reader_.number32(primitives.front(), "material"));
  }

  void add_mesh(const Json& json) {
    const Json* extras = Reader::find(json, "extras");
    const bool opens = extras != nullptr && Reader::find(*extras, glb::kOpenFrom) != nullptr;
    const uint32_t frame = opens ? reader_.number32(*extras, glb::kOpenFrom) : kNeverOpen;
    number_ = cloth_number(json);
    for (const Json& primitive : reader_.array(json, "primitives")) add_primitive(primitive, frame);
  }

  /// Once all primitives are in.
  void finish() {
    if (frames.empty()) reader_.refuse("a mesh has no primitives");
    add_missing_normals();
    mesh.source_vertex_count = static_cast<uint32_t>(mesh.position.size());
    for (uint32_t i = 0; i < mesh.source_vertex_count; ++i) mesh.source_vertex.push_back(i);
  }

 private:
  [[nodiscard]] std::optional<uint32_t> cloth_number(const Json& json) const {
    const Json* extras = Reader::find(json, "extras");
    if (extras == nullptr || Reader::find(*extras, glb::kCloth) == nullptr) return std::nullopt;
    return reader_.number32(*extras, glb::kCloth);
  }

  /// Vertices that primitives share.
  struct Run {
    uint32_t first = 0, count = 0;
    bool has_normals = false;
  };

  void add_primitive(const Json& primitive, uint32_t frame) {
    const uint32_t positions = reader_.number32(reader_.member(primitive, "attributes"), "POSITION");
    const auto known = runs_.find(positions);
    const Run run = known != runs_.end() ? known->second : runs_[positions] = add_run(primitive);
    const auto triangles = reader_.triangles(primitive, "indices");
    mesh.part.push_back({part_name(primitive), add_material(primitive), static_cast<uint32_t>(mesh.triangle.size()),
                         static_cast<uint32_t>(triangles.size())});
    for (const Triangle& t : triangles) {
      for (const uint32_t v : t) {
        if (v >= run.count) reader_.refuse("a triangle names a vertex that is not there");
      }
      mesh.triangle.push_back({run.first + t[0], run.first + t[1], run.first + t[2]});
      open_from.push_back(frame);
    }
  }

  Run add_run(const Json& primitive) {
    const Json& attributes = reader_.member(primitive, "attributes");
    Run run{.first = static_cast<uint32_t>(mesh.position.size())};
    const auto positions = reader_.floats<Vec3>(attributes, "POSITION");
    run.count = static_cast<uint32_t>(positions.size());
    append(mesh.position, positions);
    add_uvs(attributes, positions.size());
    run.has_normals = add_normals(attributes, positions.size());
    add_targets(primitive, positions);
    return run;
  }

  [[nodiscard]] std::string part_name(const Json& primitive) const {
    const Json* extras = Reader::find(primitive, "extras");
    return extras == nullptr ? std::string{} : reader_.text_or_empty(*extras, "name");
  }

  void add_uvs(const Json& attributes, std::size_t count) {
    const bool has_uvs = Reader::find(attributes, "TEXCOORD_0") != nullptr;
    if (!runs_.empty() && has_uvs == mesh.uv.empty()) {
      reader_.refuse("only some primitives of a mesh have texture coordinates");
    }
    if (!has_uvs) return;
    const auto uvs = reader_.floats<Vec2>(attributes, "TEXCOORD_0");
    if (uvs.size() != count) reader_.refuse("there are not as many texture coordinates as positions");
    append(mesh.uv, uvs);
  }

  bool add_normals(const Json& attributes, std::size_t count) {
    std::vector<Vec3> normals(count);
    const bool has_normals = Reader::find(attributes, "NORMAL") != nullptr;
    if (has_normals) normals = reader_.floats<Vec3>(attributes, "NORMAL");
    if (normals.size() != count) reader_.refuse("there are not as many normals as positions");
    append(mesh.normal, normals);
    return has_normals;
  }

  void add_missing_normals() {
    if (std::all_of(runs_.begin(), runs_.end(), [](const auto& run) { return run.second.has_normals; })) return;
    const std::vector<Vec3> smooth = smooth_normals(mesh.position, mesh.triangle);
    for (const auto& [positions, run] : runs_) {
      if (!run.has_normals) std::copy_n(smooth.begin() + run.first, run.count, mesh.normal.begin() + run.first);
    }
  }

  static std::vector<Vec3> smooth_normals(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
    std::vector<Vec3> normals(positions.size());
    for (const Triangle& t : triangles) {
      const Vec3 n = cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
      for (const uint32_t v : t) normals[v] += n;
    }
    for (Vec3& n : normals) n = dot(n, n) > 0 ? normalized(n) : Vec3{0, 1, 0};
    return normals;
  }

  void add_targets(const Json& primitive, const std::vector<Vec3>& positions) {
    const Json* targets = Reader::find(primitive, "targets") ? &reader_.array(primitive, "targets") : nullptr;
    const std::size_t target_count = targets == nullptr ? 0 : targets->size();
    if (runs_.empty()) frames.resize(target_count + 1);
    if (frames.size() != target_count + 1) reader_.refuse("the primitives of a mesh differ in morph targets");
    append(frames[0], positions);
    for (std::size_t k = 0; k < target_count; ++k) {
      const auto deltas = reader_.floats<Vec3>((*targets)[k], "POSITION");
      if (deltas.size() != positions.size()) reader_.refuse("a morph target has another size than its mesh");
      for (std::size_t i = 0; i < deltas.size(); ++i) frames[k + 1].push_back(positions[i] + deltas[i]);
    }
  }

  /// The number, within the cloth, of a primitive's material; it comes with its images when it is new.
  uint32_t add_material(const Json& primitive) {
    const uint32_t index = reader_.number32(primitive, "material");
    const auto [known, is_new] = material_number_.try_emplace(index, static_cast<uint32_t>(mesh.material.size()));
    if (is_new) {
      if (index >= materials_.size() || !materials_[index]) {
        reader_.refuse("a primitive names a material that is not there, or that another cloth has");
      }
      SourceMaterial material = *std::exchange(materials_[index], std::nullopt);
      for (auto* image : {&material.base_color_image, &material.normal_image, &material.metallic_roughness_image}) {
        if (*image) *image = add_image(**image);
      }
      mesh.material.push_back(std::move(material));
    }
    return known->second;
  }

  uint32_t add_image(uint32_t index) {
    const auto [known, is_new] = image_number_.try_emplace(index, static_cast<uint32_t>(mesh.image.size()));
    if (is_new) mesh.image.push_back(reader_.image(index));
    return known->second;
  }

  Reader& reader_;
  std::vector<std::optional<SourceMaterial>>& materials_;
  std::map<uint32_t, Run> runs_;  ///< by the accessor of their positions
  std::map<uint32_t, uint32_t> material_number_, image_number_;
  std::optional<uint32_t> number_;  ///< of the cloth
};

/// Of the animation's key times, which are evenly spaced.
double read_frame_rate(Reader& reader, std::size_t frame_count) {
  if (frame_count < 2) return 60;
  const Json& samplers = reader.array(reader.element("animations", 0), "samplers");
  if (samplers.empty()) reader.refuse("the animation has no sampler");
  const auto times = reader.floats<float>(samplers.front(), "input");
  if (times.size() != frame_count || !(times.back() > 0 && std::isfinite(times.back()))) {
    reader.refuse("the animation does not have a key for every frame");
  }
  return static_cast<double>(frame_count - 1) / double{times.back()};
}

void check_finite(const Reader& reader, const Cache& cache) {
  for (const auto& frame : cache.frames) {
    for (const auto& cloth : frame) {
      if (!std::all_of(cloth.begin(), cloth.end(), is_finite)) reader.refuse("a position is not a finite number");
    }
  }
  for (const SourceMesh& cloth : cache.cloths) {
    const auto finite = [](const Vec2& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); };
    if (!std::all_of(cloth.normal.begin(), cloth.normal.end(), is_finite) ||
        !std::all_of(cloth.uv.begin(), cloth.uv.end(), finite)) {
      reader.refuse("a normal or texture coordinate is not a finite number");
    }
  }
}

template <class T>
T word_at(std::span<const std::byte> bytes, std::size_t at, bool big_endian) {
  std::array<std::byte, sizeof(T)> word{};
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), word.begin());
  if (big_endian) std::reverse(word.begin(), word.end());
  return std::bit_cast<T>(word);
}

/// Samples of `points` points each, from byte `at` to the end of the file.
void read_samples(std::span<const std::byte> bytes, std::size_t at, uint64_t samples, bool big_endian,
                  const std::filesystem::path& path, PointCache& cache) {
  const uint64_t sample_size = uint64_t{cache.points} * sizeof(Vec3);
  if (cache.points == 0 || samples == 0 || samples != (bytes.size() - at) / sample_size ||
      (bytes.size() - at) % sample_size != 0) {
    throw Error(ErrorCode::invalid_data, path.string() + ": does not hold the " + std::to_string(samples) +
                                             " samples of " + std::to_string(cache.points) +
                                             " points that its header says; make the file again");
  }
  cache.frames.resize(static_cast<std::size_t>(samples));
  for (auto& frame : cache.frames) {
    frame.resize(cache.points);
    for (Vec3& p : frame) {
      p = {word_at<float>(bytes, at, big_endian), word_at<float>(bytes, at + 4, big_endian),
           word_at<float>(bytes, at + 8, big_endian)};
      at += sizeof(Vec3);
      if (!is_finite(p)) throw Error(ErrorCode::invalid_data, path.string() + ": a position is not a finite number");
    }
  }
}

PointCache decode_pc2(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  constexpr std::size_t kHeaderSize = 32;
  if (bytes.size() < kHeaderSize || std::memcmp(bytes.data(), "POINTCACHE2\0", 12) != 0) {
    throw Error(ErrorCode::invalid_data, path.string() + ": is not a PC2 point cache");
  }
  PointCache cache;
  cache.points = word_at<uint32_t>(bytes, 16, false);
  const auto step = double{word_at<float>(bytes, 24, false)};
  if (step > 0 && std::isfinite(step)) cache.step = step;
  read_samples(bytes, kHeaderSize, word_at<uint32_t>(bytes, 28, false), false, path, cache);
  return cache;
}

PointCache decode_mdd(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  constexpr std::size_t kHeaderSize = 8;
  const uint64_t samples = bytes.size() < kHeaderSize ? 0 : word_at<uint32_t>(bytes, 0, true);
  if (samples == 0 || samples > (bytes.size() - kHeaderSize) / sizeof(float)) {
    throw Error(ErrorCode::invalid_data, path.string() + ": is not an MDD point cache");
  }
  PointCache cache;
  cache.points = word_at<uint32_t>(bytes, 4, true);
  const std::size_t first_sample = kHeaderSize + static_cast<std::size_t>(samples) * sizeof(float);
  read_samples(bytes, first_sample, samples, true, path, cache);
  const auto first_time = double{word_at<float>(bytes, kHeaderSize, true)},
             last_time = double{word_at<float>(bytes, first_sample - sizeof(float), true)};
  const double length = last_time - first_time;
  if (samples > 1 && length > 0 && std::isfinite(length)) cache.frame_rate = static_cast<double>(samples - 1) / length;
  return cache;
}

}  // namespace

Cache decode_gltf_cache(std::span<const std::byte> bytes, const std::string& name) {
  const glb::Container container = glb::parse(bytes, name);
  Reader reader(container, name);
  if (Reader::find(reader.member(reader.root(), "asset"), "generator") == nullptr ||
      reader.text_or_empty(reader.member(reader.root(), "asset"), "generator") != glb::kGenerator) {
    throw Error(ErrorCode::unsupported,
                name + ": was not written by geocloth simulate; other glTF files are not played");
  }
  const std::vector<SourceMaterial> all = reader.materials();
  std::vector<std::optional<SourceMaterial>> materials(all.begin(), all.end());
  std::vector<ClothReader> cloths;
  for (const Json& json : reader.array(reader.root(), "meshes")) {
    if (cloths.empty() || !cloths.back().owns(json)) cloths.emplace_back(reader, materials);
    cloths.back().add_mesh(json);
  }
  Cache cache;
  for (ClothReader& cloth : cloths) {
    cloth.finish();
    if (cache.cloths.empty()) cache.frames.resize(cloth.frames.size());
    if (cache.frames.size() != cloth.frames.size()) reader.refuse("the meshes differ in morph targets");
    for (std::size_t k = 0; k < cloth.frames.size(); ++k) cache.frames[k].push_back(std::move(cloth.frames[k]));
    cache.cloths.push_back(std::move(cloth.mesh));
    cache.open_from.push_back(std::move(cloth.open_from));
  }
  if (cache.cloths.empty()) reader.refuse("there is no mesh");
  cache.frame_rate = read_frame_rate(reader, cache.frames.size());
  check_finite(reader, cache);
  return cache;
}

Cache read_gltf_cache(const std::filesystem::path& path) {
  return decode_gltf_cache(read_file(path), path.string());
}

PointCache decode_point_cache(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".pc2") return decode_pc2(bytes, path);
  if (ending == ".mdd") return decode_mdd(bytes, path);
  throw Error(ErrorCode::unsupported, path.string() + ": is no point cache; .pc2 and .mdd files are read");
}

PointCache read_point_cache(const std::filesystem::path& path) {
  return decode_point_cache(read_file(path), path);
}

}  // namespace geocloth
