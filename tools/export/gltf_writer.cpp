// SPDX-License-Identifier: GPL-3.0-or-later
// Animated glTF binary. A vertex cache becomes morph targets: frame 0 is the mesh, frame k its k-th target (deltas of
// positions and normals), and one animation turns weight k up to 1 at frame k and down again, linearly, which gives
// back every frame exactly and the line between two frames in between. three.js and Blender (as shape keys) play it.
// Deltas go to a scratch file frame by frame; only the JSON waits in memory. Faces that a cut opens are a mesh of their
// own over the same vertices, whose node is scaled to nothing when the cut comes.
#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "export/cache_writers.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "glb.h"

namespace geocloth {
namespace {

using glb::Json;

/// Beyond this, targets go without normals, and viewers shade the faces flat: half the file, a little less beauty.
constexpr uint64_t kMaxNormalBytes = uint64_t{256} << 20U;
constexpr uint64_t kMaxMotionBytes = uint64_t{4} << 30U;
/// The weights are a matrix of frames x frames, and viewers keep targets in layers of a texture, of which few have
/// more.
constexpr uint32_t kMaxFrames = 4096;

/// A cloth in the file. Every part has its own run of vertices, those that its triangles use, so that a viewer uploads
/// each vertex and each of its targets once.
class ClothNode {
 public:
  ClothNode(std::shared_ptr<const ClothAsset> cloth, bool with_normals)
      : cloth_(std::move(cloth)), with_normals_(with_normals) {
    const ClothAsset& asset = *cloth_;
    std::vector<uint32_t> local(asset.source.position.size());
    for (const SourcePart& part : asset.source.part) {
      Run& run = runs_.emplace_back();
      run.first = static_cast<uint32_t>(order_.size());
      const auto triangles = std::span(asset.source.triangle).subspan(part.first_triangle, part.triangle_count);
      for (const Triangle& t : triangles) order_.insert(order_.end(), t.begin(), t.end());
      const auto begin = order_.begin() + run.first;
      std::sort(begin, order_.end());
      order_.erase(std::unique(begin, order_.end()), order_.end());
      run.count = static_cast<uint32_t>(order_.size()) - run.first;
      for (uint32_t i = 0; i < run.count; ++i) local[order_[run.first + i]] = i;
      for (const Triangle& t : triangles) {
        run.triangle.push_back({local[t[0]], local[t[1]], local[t[2]]});
        run.open_from.push_back(kNever);
      }
      run.material = part.material;
      run.name = part.name;
    }
    if (with_normals_) bound_normals_ = bind_normals(asset);
  }

  void add_first_frame(glb::Builder& builder, const ClothSnapshot& frame) {
    first_position_ = pick(frame.source_position);
    const auto positions = add_runs(builder, first_position_);
    std::vector<uint32_t> normals, uvs;
    if (with_normals_) {
      first_normal_ = pick(normals_of(frame));
      normals = add_runs(builder, first_normal_);
    }
    if (!cloth_->source.uv.empty()) uvs = add_runs(builder, pick(cloth_->source.uv));
    const uint32_t first_material = builder.add_materials(cloth_->source);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      Json primitive = {{"attributes", {{"POSITION", positions[i]}}}, {"material", first_material + runs_[i].material}};
      if (!runs_[i].name.empty()) primitive["extras"] = {{"name", runs_[i].name}};
      if (with_normals_) primitive["attributes"]["NORMAL"] = normals[i];
      if (!uvs.empty()) primitive["attributes"]["TEXCOORD_0"] = uvs[i];
      primitives_.push_back(std::move(primitive));
    }
  }

  void add_target(glb::Builder& builder, const ClothSnapshot& frame, uint32_t number) {
    if (frame.asset && frame.asset != cloth_) follow_cut(frame.asset, number - 1);
    const auto positions = add_runs(builder, difference(pick(frame.source_position), first_position_));
    std::vector<uint32_t> normals;
    if (with_normals_) normals = add_runs(builder, difference(pick(normals_of(frame)), first_normal_));
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      Json target = {{"POSITION", positions[i]}};
      if (with_normals_) target["NORMAL"] = normals[i];
      primitives_[i]["targets"].push_back(std::move(target));
    }
  }

  /// Frames in which cuts come, kNever for what stays.
  [[nodiscard]] std::set<uint32_t> groups() const {
    std::set<uint32_t> frames;
    for (const Run& run : runs_) frames.insert(run.open_from.begin(), run.open_from.end());
    return frames;
  }

  /// The mesh of the faces that a cut opens in this frame (kNever: of those that stay), once all frames are in.
  /// @param number  of the cloth
  [[nodiscard]] Json mesh(glb::Builder& builder, uint32_t open_from, std::size_t number,
                          const std::vector<std::string>& target_names) const {
    Json json = {{"name", cloth_->name}, {"primitives", Json::array()}};
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      std::vector<Triangle> triangles;
      for (std::size_t t = 0; t < runs_[i].triangle.size(); ++t) {
        if (runs_[i].open_from[t] == open_from) triangles.push_back(runs_[i].triangle[t]);
      }
      if (triangles.empty()) continue;
      const uint32_t indices = builder.add_index_view(triangles, runs_[i].count);
      Json& primitive = json["primitives"].emplace_back(primitives_[i]);
      primitive["indices"] = builder.add_index_accessor(indices, 0, triangles.size(), runs_[i].count);
    }
    if (!target_names.empty()) {
      json["weights"] = std::vector<int>(target_names.size(), 0);
      json["extras"] = {{"targetNames", target_names}};  // what Blender calls the shape keys
    }
    if (groups().size() > 1) json["extras"][glb::kCloth] = number;
    if (open_from != kNever) json["extras"][glb::kOpenFrom] = open_from;
    return json;
  }

  [[nodiscard]] const std::string& name() const { return cloth_->name; }

  static constexpr uint32_t kNever = 0xFFFFFFFFU;

 private:
  struct Run {
    uint32_t first = 0, count = 0;  ///< in order_
    std::vector<Triangle> triangle;
    std::vector<uint32_t> open_from;  ///< frame in which a cut opens each of them
    uint32_t material = 0;
    std::string name;
  };

  /// The faces of the cut cloth are those of the old one in the same order, without some.
  void follow_cut(const std::shared_ptr<const ClothAsset>& cut, uint32_t frame) {
    auto kept = cut->source.triangle.begin();
    for (Run& run : runs_) {
      for (std::size_t t = 0; t < run.triangle.size(); ++t) {
        if (run.open_from[t] != kNever) continue;
        const Triangle& local = run.triangle[t];
        const Triangle corners{order_[run.first + local[0]], order_[run.first + local[1]],
                               order_[run.first + local[2]]};
        if (kept != cut->source.triangle.end() && *kept == corners) {
          ++kept;
        } else {
          run.open_from[t] = frame;
        }
      }
    }
    cloth_ = cut;
    if (with_normals_) bound_normals_ = bind_normals(*cut);
  }

  template <class T>
  [[nodiscard]] std::vector<T> pick(const std::vector<T>& values) const {
    std::vector<T> picked;
    picked.reserve(order_.size());
    for (const uint32_t v : order_) picked.push_back(values[v]);
    return picked;
  }

  static std::vector<Vec3> difference(std::vector<Vec3> a, const std::vector<Vec3>& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
    return a;
  }

  [[nodiscard]] std::vector<Vec3> normals_of(const ClothSnapshot& frame) const {
    std::vector<Vec3> normals;
    evaluate_bound_normals(*cloth_, bound_normals_, frame.position, frame.normal, normals);
    return normals;
  }

  /// One view of all values, one accessor per run.
  template <class T>
  std::vector<uint32_t> add_runs(glb::Builder& builder, const std::vector<T>& values) const {
    const uint32_t view = builder.add_view(std::as_bytes(std::span(values)), glb::Target::vertices, sizeof(T));
    std::vector<uint32_t> accessors;
    for (const Run& run : runs_) {
      const auto part = std::span(values).subspan(run.first, run.count);
      accessors.push_back(builder.add_accessor(part, view, run.first * sizeof(T)));
    }
    return accessors;
  }

  std::shared_ptr<const ClothAsset> cloth_;  ///< as the last cut left it
  bool with_normals_;
  std::vector<uint32_t> order_;  ///< render vertices, run by run
  std::vector<Run> runs_;
  std::vector<Vec3> bound_normals_, first_position_, first_normal_;
  Json primitives_ = Json::array();
};

/// Of one Vec3 at every vertex in every frame.
uint64_t motion_bytes(const CacheDescription& description) {
  uint64_t vertices = 0;
  for (const auto& cloth : description.cloths) vertices += cloth->source.position.size();
  return vertices * sizeof(Vec3) * (uint64_t{description.frame_count} + 1);
}

/// Fails now, not after a long run, if the motion cannot be held.
const CacheDescription& checked(const CacheDescription& description, const std::filesystem::path& path) {
  if (description.frame_count > kMaxFrames || motion_bytes(description) > kMaxMotionBytes) {
    throw Error(ErrorCode::limit, path.string() + ": an animated .glb holds at most " + std::to_string(kMaxFrames) +
                                      " frames and 4 GiB; write a point cache (.pc2, .mdd), or fewer frames");
  }
  return description;
}

class GltfWriter final : public CacheWriter {
 public:
  GltfWriter(const std::filesystem::path& path, const CacheDescription& description)
      : description_(checked(description, path)), file_(path), scratch_(path), builder_(&scratch_) {
    const bool with_normals = motion_bytes(description_) <= kMaxNormalBytes;
    for (const auto& cloth : description_.cloths) nodes_.emplace_back(cloth, with_normals);
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    const uint32_t frame = frame_++;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (frame == 0) {
        nodes_[i].add_first_frame(builder_, cloths[i]);
      } else {
        nodes_[i].add_target(builder_, cloths[i], frame);
      }
    }
    if (frame > 0) target_names_.push_back("frame " + std::to_string(frame));
  }

  void finish() override {
    Json& root = builder_.root;
    root["scenes"] = Json::array({{{"nodes", Json::array()}}});
    std::vector<uint32_t> open_from;  // of each node of the file
    for (std::size_t number = 0; number < nodes_.size(); ++number) {
      const ClothNode& cloth = nodes_[number];
      for (const uint32_t group : cloth.groups()) {
        const std::size_t node = open_from.size();
        const std::string part = group == ClothNode::kNever ? "" : " until cut in frame " + std::to_string(group);
        root["meshes"].push_back(cloth.mesh(builder_, group, number, target_names_));
        root["nodes"].push_back({{"name", cloth.name() + part}, {"mesh", node}});
        root["scenes"][0]["nodes"].push_back(node);
        open_from.push_back(group);
      }
    }
    if (!target_names_.empty()) root["animations"] = Json::array({animation(open_from)});
    builder_.write(file_);
    file_.close();
  }
  void commit() override { file_.commit(); }

 private:
  /// Weight k is 1 at frame k and 0 at all others: a matrix of frames x targets, shared by all cloths.
  /// @param open_from  of each node, the frame in which a cut opens it
  Json animation(const std::vector<uint32_t>& open_from) {
    const std::size_t targets = target_names_.size();
    std::vector<float> times, weights(targets * (targets + 1), 0.0F);
    for (std::size_t frame = 0; frame <= targets; ++frame) {
      times.push_back(static_cast<float>(static_cast<double>(frame) / description_.frame_rate));
      if (frame > 0) weights[frame * targets + frame - 1] = 1;
    }
    const uint32_t input = builder_.add_accessor(std::span<const float>(times), builder_.add_array(times));
    const uint32_t output = builder_.add_accessor(std::span<const float>(weights), builder_.add_array(weights));
    Json json = {{"name", "simulation"},
                 {"samplers", Json::array({{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}})},
                 {"channels", Json::array()}};
    for (std::size_t i = 0; i < open_from.size(); ++i) {
      json["channels"].push_back({{"sampler", 0}, {"target", {{"node", i}, {"path", "weights"}}}});
      if (open_from[i] != ClothNode::kNever) vanish(json, i, open_from[i]);
    }
    return json;
  }

  /// A node is there until a frame, and of no size from then on.
  void vanish(Json& animation, std::size_t node, uint32_t frame) {
    std::vector<float> times{0};
    std::vector<Vec3> scales{{1, 1, 1}};
    if (frame > 0) times.push_back(static_cast<float>(frame / description_.frame_rate));
    if (frame > 0) scales.emplace_back();
    if (frame == 0) scales.front() = {};
    const uint32_t input = builder_.add_accessor(std::span<const float>(times), builder_.add_array(times));
    const uint32_t output = builder_.add_accessor(std::span<const Vec3>(scales), builder_.add_array(scales));
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", "scale"}}}});
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", "STEP"}});
  }

  CacheDescription description_;
  OutputFile file_, scratch_;
  glb::Builder builder_;
  std::vector<ClothNode> nodes_;
  std::vector<std::string> target_names_;
  uint32_t frame_ = 0;
};

}  // namespace

std::unique_ptr<CacheWriter> make_gltf_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<GltfWriter>(path, description);
}

}  // namespace geocloth
