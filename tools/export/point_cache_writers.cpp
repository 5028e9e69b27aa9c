// SPDX-License-Identifier: GPL-3.0-or-later
// Point caches that Blender's Mesh Cache modifier and Maya read. PC2 (3ds Max): a little-endian header of 32 bytes,
// then x y z floats, sample by sample. MDD (LightWave): the same big-endian, after a table of the times of all samples;
// as their number is known last, the samples wait in a scratch file and are appended to the table at the end.
#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include "export/cache_writers.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

using Word = std::array<std::byte, 4>;
using Cloths = std::vector<std::shared_ptr<const ClothAsset>>;

template <class T>
Word little_endian(T value) {
  static_assert(sizeof(T) == 4 && std::endian::native == std::endian::little);
  return std::bit_cast<Word>(value);
}
template <class T>
Word big_endian(T value) {
  Word word = little_endian(value);
  std::swap(word[0], word[3]);
  std::swap(word[1], word[2]);
  return word;
}

int32_t checked_count(std::size_t count, const std::filesystem::path& path) {
  if (count > 0x7FFFFFFFU) throw Error(ErrorCode::limit, path.string() + ": too many points or frames for the format");
  return static_cast<int32_t>(count);
}

/// The vertices of the file that a part has, ascending: all of the object's where the file names them, else those of
/// its triangles.
std::vector<uint32_t> vertices_of(const ClothAsset& asset, const std::string& name) {
  const SourceMesh& source = asset.source;
  std::vector<bool> has(source.source_vertex_count);
  const auto group = std::find_if(asset.vertex_groups.begin(), asset.vertex_groups.end(),
                                  [&](const ClothAsset::VertexGroup& g) { return g.name == name; });
  if (group != asset.vertex_groups.end()) {
    for (const uint32_t v : group->source_vertex) has[v] = true;
  }
  for (const SourcePart& part : source.part) {
    if (part.name != name) continue;
    for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
      for (const uint32_t v : source.triangle[t]) has[source.source_vertex[v]] = true;
    }
  }
  std::vector<uint32_t> vertices;
  for (uint32_t v = 0; v < source.file_vertex_count(); ++v)
    if (has[v]) vertices.push_back(v);
  return vertices;
}

/// As far as file names may have it.
std::string in_file_name(const std::string& name) {
  std::string word = name.empty() ? "part" : name;
  for (char& c : word) {
    const bool may_stay = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '_' ||
                          static_cast<unsigned char>(c) >= 0x80;
    if (!may_stay) c = '_';
  }
  return word;
}

/// Names that would be those of other files get a number.
std::filesystem::path part_path(const std::filesystem::path& cloth, const std::string& part,
                                std::set<std::string>& taken) {
  const std::string stem = cloth.stem().string() + "_" + in_file_name(part);
  std::string name = stem;
  for (int number = 2; !taken.insert(name).second; ++number) name = stem + "_" + std::to_string(number);
  return cloth.parent_path() / (name + cloth.extension().string());
}

std::vector<Vec3> points_of(const PointCacheFile& cache, const Cloths& cloths, std::span<const ClothSnapshot> state) {
  const std::vector<Vec3> all = in_file_order(cloths[cache.cloth]->source, state[cache.cloth].source_position);
  std::vector<Vec3> points;
  points.reserve(cache.vertex.size());
  for (const uint32_t v : cache.vertex) points.push_back(all[v]);
  return points;
}

class Pc2Writer final : public CacheWriter {
 public:
  Pc2Writer(const std::filesystem::path& path, const CacheDescription& description)
      : cloths_(description.cloths), caches_(point_cache_files(path, description)) {
    for (std::size_t i = 0; i < caches_.size(); ++i) {
      files_.push_back(&series_.add(caches_[i].path));
      write_header(i);
    }
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    for (std::size_t i = 0; i < caches_.size(); ++i) {
      const std::vector<Vec3> points = points_of(caches_[i], cloths_, cloths);
      files_[i]->write(std::as_bytes(std::span(points)));
    }
    ++samples_;
  }

  void finish() override {
    for (std::size_t i = 0; i < caches_.size(); ++i) {
      files_[i]->seek(0);
      write_header(i);
    }
    series_.close();
  }
  void commit() override { series_.commit(); }

 private:
  void write_header(std::size_t cache) {
    OutputFile& file = *files_[cache];
    file.write(std::string_view("POINTCACHE2\0", 12));
    file.write(little_endian(int32_t{1}));  // version
    file.write(little_endian(checked_count(caches_[cache].vertex.size(), file.path())));
    file.write(little_endian(0.0F));  // first frame
    file.write(little_endian(1.0F));  // frames per sample
    file.write(little_endian(checked_count(samples_, file.path())));
  }

  Cloths cloths_;
  std::vector<PointCacheFile> caches_;
  OutputSeries series_;
  std::vector<OutputFile*> files_;
  std::size_t samples_ = 0;
};

class MddWriter final : public CacheWriter {
 public:
  MddWriter(const std::filesystem::path& path, const CacheDescription& description)
      : cloths_(description.cloths),
        caches_(point_cache_files(path, description)),
        frame_rate_(description.frame_rate) {
    for (const PointCacheFile& cache : caches_) {
      files_.push_back(&series_.add(cache.path));
      scratch_.push_back(std::make_unique<OutputFile>(files_.back()->path()));
    }
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    std::vector<Word> words;
    for (std::size_t i = 0; i < caches_.size(); ++i) {
      words.clear();
      for (const Vec3& p : points_of(caches_[i], cloths_, cloths)) {
        for (const float value : {p.x, p.y, p.z}) words.push_back(big_endian(value));
      }
      scratch_[i]->write(std::as_bytes(std::span(words)));
    }
    ++samples_;
  }

  void finish() override {
    for (std::size_t i = 0; i < caches_.size(); ++i) {
      OutputFile& file = *files_[i];
      file.write(big_endian(checked_count(samples_, file.path())));
      file.write(big_endian(checked_count(caches_[i].vertex.size(), file.path())));
      for (std::size_t sample = 0; sample < samples_; ++sample) {
        file.write(big_endian(static_cast<float>(static_cast<double>(sample) / frame_rate_)));
      }
      scratch_[i]->close();
      file.append_file(scratch_[i]->temporary_path());
    }
    scratch_.clear();
    series_.close();
  }
  void commit() override { series_.commit(); }

 private:
  Cloths cloths_;
  std::vector<PointCacheFile> caches_;
  double frame_rate_;
  OutputSeries series_;
  std::vector<OutputFile*> files_;
  std::vector<std::unique_ptr<OutputFile>> scratch_;
  std::size_t samples_ = 0;
};

}  // namespace

std::vector<PointCacheFile> point_cache_files(const std::filesystem::path& path, const CacheDescription& description) {
  std::vector<PointCacheFile> files;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < description.cloths.size(); ++i) {
    const ClothAsset& asset = *description.cloths[i];
    const std::filesystem::path own = cloth_path(path, i, description.cloths.size());
    if (!description.each_part) {
      std::vector<uint32_t> all(asset.source.file_vertex_count());
      std::iota(all.begin(), all.end(), 0U);
      files.push_back({own, i, std::move(all)});
      continue;
    }
    std::set<std::string> done;  // an object of several materials is several parts of one name
    for (const SourcePart& part : asset.source.part) {
      if (done.insert(part.name).second)
        files.push_back({part_path(own, part.name, taken), i, vertices_of(asset, part.name)});
    }
  }
  return files;
}

std::unique_ptr<CacheWriter> make_pc2_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<Pc2Writer>(path, description);
}

std::unique_ptr<CacheWriter> make_mdd_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<MddWriter>(path, description);
}

}  // namespace geocloth
