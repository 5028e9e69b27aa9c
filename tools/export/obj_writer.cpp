// SPDX-License-Identifier: GPL-3.0-or-later
// Numbered Wavefront OBJ files of the source mesh: an object per cloth, a group and a material name per part. Points
// are those of the source file in its order, so frames can be loaded as shapes of the mesh that the user already has;
// texture coordinates keep their own indices, so the mesh stays welded. Digits round-trip the floats.
#include <string>

#include "export/cache_writers.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

void append_numbers(std::string& text, std::initializer_list<float> values) {
  for (const float value : values) {
    text += ' ';
    append_number(text, value);
  }
  text += '\n';
}

/// A name as one word.
std::string word(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name.empty() ? "unnamed" : name;
}

/// What stays the same from frame to frame: texture coordinates and faces of one cloth.
std::string constant_text(const ClothAsset& asset, std::size_t first_point, std::size_t first_uv) {
  const SourceMesh& source = asset.source;
  std::string text;
  for (const Vec2& uv : source.uv) {
    text += "vt";
    append_numbers(text, {uv.x, 1 - uv.y});  // OBJ counts from the lower left corner
  }
  for (const SourcePart& part : source.part) {
    text += "g " + word(part.name) + "\nusemtl " + word(source.material[part.material].name) + '\n';
    for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
      text += 'f';
      for (const uint32_t v : source.triangle[t]) {
        text += ' ' + std::to_string(first_point + source.source_vertex[v] + 1);
        if (!source.uv.empty()) text += '/' + std::to_string(first_uv + v + 1);
      }
      text += '\n';
    }
  }
  return text;
}

class ObjWriter final : public CacheWriter {
 public:
  ObjWriter(std::filesystem::path path, const CacheDescription& description)
      : path_(std::move(path)), description_(description) {
    check_series_path(path_);
    write_constant_text();
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    const uint32_t frame = frame_++;
    if (!is_numbered_frame(frame, description_)) return;
    follow_cuts(cloths);
    OutputFile& file = series_.open(numbered_path(path_, frame));
    for (std::size_t i = 0; i < cloths.size(); ++i) {
      const ClothAsset& asset = *description_.cloths[i];
      std::string text = "o " + word(asset.name) + '\n';
      for (const Vec3& p : in_file_order(asset.source, cloths[i].source_position)) {
        text += 'v';
        append_numbers(text, {p.x, p.y, p.z});
      }
      file.write(text);
      file.write(constant_[i]);
    }
  }

  void finish() override { series_.close(); }
  void commit() override { series_.commit(); }

 private:
  void write_constant_text() {
    constant_.clear();
    std::size_t first_point = 0, first_uv = 0;
    for (const auto& cloth : description_.cloths) {
      constant_.push_back(constant_text(*cloth, first_point, first_uv));
      first_point += cloth->source.source_vertex_count;
      first_uv += cloth->source.uv.size();
    }
  }

  /// Faces that a cut has opened are missing from then on; points stay, and so do their numbers.
  void follow_cuts(std::span<const ClothSnapshot> cloths) {
    bool cut = false;
    for (std::size_t i = 0; i < cloths.size(); ++i) {
      if (!cloths[i].asset || cloths[i].asset == description_.cloths[i]) continue;
      description_.cloths[i] = cloths[i].asset;
      cut = true;
    }
    if (cut) write_constant_text();
  }

  std::filesystem::path path_;
  CacheDescription description_;
  std::vector<std::string> constant_;
  OutputSeries series_;
  uint32_t frame_ = 0;
};

}  // namespace

std::unique_ptr<CacheWriter> make_obj_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<ObjWriter>(path, description);
}

}  // namespace geocloth
