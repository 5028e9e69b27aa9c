// SPDX-License-Identifier: GPL-3.0-or-later
// Universal Scene Description as text (.usda): Omniverse, Houdini, Maya, Unreal and Blender read it. A cloth is a Mesh
// whose points and normals have a sample for every frame, with the points of the source file in its order, so that the
// mesh stays welded; texture coordinates and normals have their own indices. Faces that a cut opens are missing from
// its frame on, as topology may vary in time. Materials are UsdPreviewSurface in plain colours: pictures would be files
// of their own. USD is written attribute by attribute and a simulation comes frame by frame, so samples wait in scratch
// files.
#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "export/cache_writers.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

/// A name as an identifier that is not among those taken, which it joins.
std::string identifier(const std::string& name, const std::string& unnamed, std::set<std::string>& taken) {
  std::string word = name.empty() ? unnamed : name;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (char& c : word)
    if (!is_letter(c) && !is_digit(c)) c = '_';
  if (is_digit(word.front())) word.insert(word.begin(), '_');
  const std::string stem = word;
  for (uint32_t k = 2; !taken.insert(word).second; ++k) word = stem + "_" + std::to_string(k);
  return word;
}

/// "[a, b, ...]" of what `append` writes.
template <class Values, class Append>
std::string array_text(const Values& values, const Append& append) {
  std::string text = "[";
  for (const auto& value : values) {
    if (text.size() > 1) text += ", ";
    append(text, value);
  }
  return text += ']';
}

void append_tuple(std::string& text, std::initializer_list<float> values) {
  char before = '(';
  for (const float value : values) {
    text += before;
    if (before == ',') text += ' ';
    append_number(text, value);
    before = ',';
  }
  text += ')';
}
void append_point(std::string& text, const Vec3& p) {
  append_tuple(text, {p.x, p.y, p.z});
}

std::string indices_text(const std::vector<uint32_t>& indices) {
  return array_text(indices, [](std::string& text, uint32_t i) { text += std::to_string(i); });
}

/// One of the file, of the words one after the other.
void write_line(OutputFile& file, std::size_t indent, std::initializer_list<std::string_view> words) {
  std::string line(indent, ' ');
  for (const std::string_view word : words) line += word;
  file.write(line += '\n');
}

/// Values of an attribute from frames on.
class Samples {
 public:
  /// Readers hold integers until the next sample and go evenly from one sample of floats to the next.
  enum class Between : uint8_t { held, even };
  Samples() = default;
  explicit Samples(Between between) : between_(between) {}

  void add(uint32_t frame, std::string value) {
    if (sample_.empty() || sample_.back().second != value) {
      if (!sample_.empty() && between_ == Between::even && last_ > sample_.back().first)
        sample_.emplace_back(last_, sample_.back().second);
      sample_.emplace_back(frame, std::move(value));
    }
    last_ = frame;
  }
  /// @param declaration  "int[] indices"
  void write(OutputFile& file, std::size_t indent, std::string_view declaration) const {
    if (sample_.size() == 1) return write_line(file, indent, {declaration, " = ", sample_.front().second});
    write_line(file, indent, {declaration, ".timeSamples = {"});
    for (const auto& [frame, value] : sample_) write_line(file, indent + 4, {std::to_string(frame), ": ", value, ","});
    write_line(file, indent, {"}"});
  }

 private:
  Between between_ = Between::held;
  uint32_t last_ = 0;  ///< frame that was added
  std::vector<std::pair<uint32_t, std::string>> sample_;
};

/// A cloth on its way into the file.
class ClothMesh {
 public:
  ClothMesh(const std::filesystem::path& path, std::shared_ptr<const ClothAsset> cloth)
      : cloth_(std::move(cloth)), points_(path), normals_(path) {
    follow(cloth_, 0);
  }

  void add(const ClothSnapshot& state, uint32_t frame) {
    if (state.asset && state.asset != cloth_) follow(state.asset, frame);
    const std::vector<Vec3> points = in_file_order(cloth_->source, state.source_position);
    add_sample(points_, frame, array_text(points, append_point));
    std::vector<Vec3> normals;
    evaluate_bound_normals(*cloth_, bound_normals_, state.position, state.normal, normals);
    add_sample(normals_, frame, array_text(normals, append_point));
    constexpr float kFar = std::numeric_limits<float>::max();
    Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
    for (const Vec3& p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    extent_.add(frame, array_text(std::array{low, high}, append_point));
  }

  /// @param taken  names in its scope
  void write(OutputFile& file, std::set<std::string>& taken) {
    const std::string name = identifier(cloth_->name, "cloth", taken), path = "/World/" + name + "/";
    std::set<std::string> taken_inside;
    std::vector<std::string> material;
    for (const SourceMaterial& m : cloth_->source.material)
      material.push_back(identifier(m.name, "material", taken_inside));

    write_line(file, 4, {"def Mesh \"", name, "\" ("});
    write_line(file, 8, {kBindsMaterial});
    write_line(file, 4, {")"});
    write_line(file, 4, {"{"});
    write_line(file, 8, {"uniform bool doubleSided = 1"});
    write_line(file, 8, {"uniform token subdivisionScheme = \"none\""});
    extent_.write(file, 8, "float3[] extent");
    counts_.write(file, 8, "int[] faceVertexCounts");
    corners_.write(file, 8, "int[] faceVertexIndices");
    write_samples(file, points_, "point3f[] points");
    write_line(file, 8, {"normal3f[] primvars:normals ("});
    write_line(file, 12, {kByCorner});
    write_line(file, 8, {")"});
    write_samples(file, normals_, "normal3f[] primvars:normals");
    render_corners_.write(file, 8, "int[] primvars:normals:indices");
    if (!cloth_->source.uv.empty()) write_uv(file);
    if (parts_.size() == 1) {
      write_line(file, 8, {"rel material:binding = <", path, material[parts_.front().material], ">"});
    } else {
      write_line(file, 8, {"uniform token subsetFamily:materialBind:familyType = \"nonOverlapping\""});
      for (const Part& part : parts_)
        write_part(file, part, identifier(part.name, "part", taken_inside), path + material[part.material]);
    }
    for (size_t m = 0; m < material.size(); ++m)
      write_material(file, cloth_->source.material[m], material[m], path + material[m]);
    write_line(file, 4, {"}"});
  }

 private:
  static constexpr std::string_view kBindsMaterial = "prepend apiSchemas = [\"MaterialBindingAPI\"]";
  static constexpr std::string_view kByCorner = "interpolation = \"faceVarying\"";

  struct Part {
    std::string name;
    uint32_t material = 0;
    Samples faces;
  };

  /// The faces that there are from a frame on.
  void follow(std::shared_ptr<const ClothAsset> cloth, uint32_t frame) {
    cloth_ = std::move(cloth);
    bound_normals_ = bind_normals(*cloth_);
    const SourceMesh& source = cloth_->source;
    std::vector<uint32_t> corners, render_corners;
    for (const Triangle& t : source.triangle) {
      for (const uint32_t v : t) {
        corners.push_back(source.source_vertex[v]);
        render_corners.push_back(v);
      }
    }
    counts_.add(frame, indices_text(std::vector<uint32_t>(source.triangle.size(), 3)));
    corners_.add(frame, indices_text(corners));
    render_corners_.add(frame, indices_text(render_corners));
    std::map<std::pair<std::string, uint32_t>, std::vector<uint32_t>> faces;
    for (const SourcePart& part : source.part) {
      std::vector<uint32_t>& of_part = faces[{part.name, part.material}];
      for (uint32_t t = 0; t < part.triangle_count; ++t) of_part.push_back(part.first_triangle + t);
      const auto same = [&](const Part& p) { return p.name == part.name && p.material == part.material; };
      if (std::ranges::none_of(parts_, same)) parts_.push_back({part.name, part.material, {}});
    }
    for (Part& part : parts_) part.faces.add(frame, indices_text(faces[{part.name, part.material}]));
  }

  static void add_sample(OutputFile& scratch, uint32_t frame, const std::string& value) {
    write_line(scratch, 12, {std::to_string(frame), ": ", value, ","});
  }

  static void write_samples(OutputFile& file, OutputFile& scratch, std::string_view declaration) {
    scratch.close();
    write_line(file, 8, {declaration, ".timeSamples = {"});
    file.append_file(scratch.temporary_path());
    write_line(file, 8, {"}"});
  }

  void write_uv(OutputFile& file) const {
    const auto append_uv = [](std::string& text, const Vec2& uv) { append_tuple(text, {uv.x, 1 - uv.y}); };
    write_line(file, 8, {"texCoord2f[] primvars:st = ", array_text(cloth_->source.uv, append_uv), " ("});
    write_line(file, 12, {kByCorner});
    write_line(file, 8, {")"});
    render_corners_.write(file, 8, "int[] primvars:st:indices");
  }

  /// @param material  its path
  static void write_part(OutputFile& file, const Part& part, std::string_view name, std::string_view material) {
    write_line(file, 0, {});
    write_line(file, 8, {"def GeomSubset \"", name, "\" ("});
    write_line(file, 12, {kBindsMaterial});
    write_line(file, 8, {")"});
    write_line(file, 8, {"{"});
    write_line(file, 12, {"uniform token elementType = \"face\""});
    write_line(file, 12, {"uniform token familyName = \"materialBind\""});
    part.faces.write(file, 12, "int[] indices");
    write_line(file, 12, {"rel material:binding = <", material, ">"});
    write_line(file, 8, {"}"});
  }

  static void write_material(OutputFile& file, const SourceMaterial& material, std::string_view name,
                             std::string_view path) {
    const auto input = [&](std::string_view declaration, float value) {
      std::string text;
      append_number(text, value);
      write_line(file, 16, {declaration, " = ", text});
    };
    std::string color;
    append_tuple(color, {material.base_color[0], material.base_color[1], material.base_color[2]});
    write_line(file, 0, {});
    write_line(file, 8, {"def Material \"", name, "\""});
    write_line(file, 8, {"{"});
    write_line(file, 12, {"token outputs:surface.connect = <", path, "/surface.outputs:surface>"});
    write_line(file, 0, {});
    write_line(file, 12, {"def Shader \"surface\""});
    write_line(file, 12, {"{"});
    write_line(file, 16, {"uniform token info:id = \"UsdPreviewSurface\""});
    write_line(file, 16, {"color3f inputs:diffuseColor = ", color});
    input("float inputs:metallic", material.metallic);
    input("float inputs:roughness", material.roughness);
    if (material.alpha_mask || material.alpha_blend) input("float inputs:opacity", material.base_color[3]);
    if (material.alpha_mask) input("float inputs:opacityThreshold", material.alpha_cutoff);
    write_line(file, 16, {"token outputs:surface"});
    write_line(file, 12, {"}"});
    write_line(file, 8, {"}"});
  }

  std::shared_ptr<const ClothAsset> cloth_;  ///< as the last cut left it
  std::vector<Vec3> bound_normals_;
  OutputFile points_, normals_;
  Samples extent_{Samples::Between::even}, counts_, corners_, render_corners_;
  std::vector<Part> parts_;
};

class UsdWriter final : public CacheWriter {
 public:
  UsdWriter(const std::filesystem::path& path, const CacheDescription& description)
      : frame_rate_(description.frame_rate), file_(path) {
    for (const auto& cloth : description.cloths) meshes_.push_back(std::make_unique<ClothMesh>(path, cloth));
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    for (std::size_t i = 0; i < meshes_.size(); ++i) meshes_[i]->add(cloths[i], frame_);
    ++frame_;
  }

  void finish() override {
    std::string rate;
    append_number(rate, frame_rate_);
    write_line(file_, 0, {"#usda 1.0"});
    write_line(file_, 0, {"("});
    write_line(file_, 4, {"defaultPrim = \"World\""});
    write_line(file_, 4, {"endTimeCode = ", std::to_string(std::max(frame_, 1U) - 1)});
    write_line(file_, 4, {"framesPerSecond = ", rate});
    write_line(file_, 4, {"metersPerUnit = 1"});
    write_line(file_, 4, {"startTimeCode = 0"});
    write_line(file_, 4, {"timeCodesPerSecond = ", rate});
    write_line(file_, 4, {"upAxis = \"Y\""});
    write_line(file_, 0, {")"});
    write_line(file_, 0, {});
    write_line(file_, 0, {"def Xform \"World\""});
    write_line(file_, 0, {"{"});
    std::set<std::string> taken;
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      if (i > 0) write_line(file_, 0, {});
      meshes_[i]->write(file_, taken);
    }
    write_line(file_, 0, {"}"});
    meshes_.clear();
    file_.close();
  }
  void commit() override { file_.commit(); }

 private:
  double frame_rate_;
  OutputFile file_;
  std::vector<std::unique_ptr<ClothMesh>> meshes_;
  uint32_t frame_ = 0;
};

}  // namespace

std::unique_ptr<CacheWriter> make_usd_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<UsdWriter>(path, description);
}

}  // namespace geocloth
