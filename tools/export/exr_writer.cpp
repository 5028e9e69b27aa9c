// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex-animation textures: the geometry image of every frame as it stands in the solver, written with OpenEXR. A
// shader that samples RGB at a pixel's corner gets the point in metres; A says whether there is one.
#include <exception>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include "export/cache_writers.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

void write_image(OutputFile& file, const ClothAsset& asset, const std::vector<Vec3>& position) {
  struct Pixel {
    float r, g, b, a;
  };
  std::vector<Pixel> pixels(asset.pixel_count());
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) pixels[i] = {position[i].x, position[i].y, position[i].z, 1};
  }
  file.close();  // OpenEXR writes the temporary file by its name
  try {
    Imf::Header header(static_cast<int>(asset.width), static_cast<int>(asset.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    const auto add_channel = [&](const char* name, float Pixel::*member) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      char* base = reinterpret_cast<char*>(&(pixels.front().*member));
      buffer.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(Pixel), sizeof(Pixel) * asset.width));
    };
    add_channel("R", &Pixel::r);
    add_channel("G", &Pixel::g);
    add_channel("B", &Pixel::b);
    add_channel("A", &Pixel::a);
    Imf::OutputFile image(file.temporary_path().c_str(), header, 1);
    image.setFrameBuffer(buffer);
    image.writePixels(static_cast<int>(asset.height));
  } catch (const std::exception& error) {
    throw Error(ErrorCode::io, file.path().string() + ": cannot be written: " + error.what());
  }
}

class ExrWriter final : public CacheWriter {
 public:
  ExrWriter(std::filesystem::path path, const CacheDescription& description)
      : path_(std::move(path)), description_(description) {
    check_series_path(path_);
  }

  void add(std::span<const ClothSnapshot> cloths) override {
    const uint32_t frame = frame_++;
    if (!is_numbered_frame(frame, description_)) return;
    for (std::size_t i = 0; i < cloths.size(); ++i) {
      OutputFile& file = series_.open(numbered_path(cloth_path(path_, i, cloths.size()), frame));
      write_image(file, *description_.cloths[i], cloths[i].position);
    }
  }

  void finish() override { series_.close(); }
  void commit() override { series_.commit(); }

 private:
  std::filesystem::path path_;
  CacheDescription description_;
  OutputSeries series_;
  uint32_t frame_ = 0;
};

}  // namespace

std::unique_ptr<CacheWriter> make_exr_writer(const std::filesystem::path& path, const CacheDescription& description) {
  return std::make_unique<ExrWriter>(path, description);
}

}  // namespace geocloth
