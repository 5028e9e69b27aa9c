// SPDX-License-Identifier: GPL-3.0-or-later
// Point caches that Blender's Mesh Cache modifier and Maya read. PC2 (3ds Max): a little-endian header of 32 bytes,
// then x y z floats, sample by sample. MDD (LightWave): the same big-endian, after a table of the times of all samples;
// as their number is known last, the samples wait in a scratch file and are appended to the table at the end.
#include <bit>
#include <cstring>
#include <string_view>

#include "export/cache_writers.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

using Word = std::array<std::byte, 4>;

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

class Pc2Writer final : public CacheWriter {
 public:
  Pc2Writer(const std::filesystem::path& path, const CacheDescription& description) : cloths_(description.cloths) {
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      files_.push_back(&series_.add(cloth_path(path, i, cloths_.size())));
      write_header(i);
    }
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      const std::vector<Vec3> points = in_file_order(cloths_[i]->source, cloths[i].source_position);
      files_[i]->write(std::as_bytes(std::span(points)));
    }
    ++samples_;
  }

  void finish() override {
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      files_[i]->seek(0);
      write_header(i);
    }
    series_.close();
  }
  void commit() override { series_.commit(); }

 private:
  void write_header(std::size_t cloth) {
    OutputFile& file = *files_[cloth];
    file.write(std::string_view("POINTCACHE2\0", 12));
    file.write(little_endian(int32_t{1}));  // version
    file.write(little_endian(checked_count(cloths_[cloth]->source.source_vertex_count, file.path())));
    file.write(little_endian(0.0F));  // first frame
    file.write(little_endian(1.0F));  // frames per sample
    file.write(little_endian(checked_count(samples_, file.path())));
  }

  std::vector<std::shared_ptr<const ClothAsset>> cloths_;
  OutputSeries series_;
  std::vector<OutputFile*> files_;
  std::size_t samples_ = 0;
};

class MddWriter final : public CacheWriter {
 public:
  MddWriter(const std::filesystem::path& path, const CacheDescription& description)
      : cloths_(description.cloths), frame_rate_(description.frame_rate) {
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      files_.push_back(&series_.add(cloth_path(path, i, cloths_.size())));
      scratch_.push_back(std::make_unique<OutputFile>(files_.back()->path()));
    }
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    std::vector<Word> words;
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      words.clear();
      for (const Vec3& p : in_file_order(cloths_[i]->source, cloths[i].source_position)) {
        for (const float value : {p.x, p.y, p.z}) words.push_back(big_endian(value));
      }
      scratch_[i]->write(std::as_bytes(std::span(words)));
    }
    ++samples_;
  }

  void finish() override {
    for (std::size_t i = 0; i < cloths_.size(); ++i) {
      OutputFile& file = *files_[i];
      file.write(big_endian(checked_count(samples_, file.path())));
      file.write(big_endian(checked_count(cloths_[i]->source.source_vertex_count, file.path())));
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
  std::vector<std::shared_ptr<const ClothAsset>> cloths_;
  double frame_rate_;
  OutputSeries series_;
  std::vector<OutputFile*> files_;
  std::vector<std::unique_ptr<OutputFile>> scratch_;
  std::size_t samples_ = 0;
};

}  // namespace

std::unique_ptr<CacheWriter> make_pc2_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<Pc2Writer>(path, description);
}

std::unique_ptr<CacheWriter> make_mdd_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<MddWriter>(path, description);
}

}  // namespace geocloth
