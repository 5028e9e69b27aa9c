// SPDX-License-Identifier: GPL-3.0-or-later
// PNG through libpng's simplified interface, which needs no setjmp; JPEG through libjpeg, whose errors leave by
// longjmp: the one function that calls it therefore owns nothing that has a destructor.
#include "render/picture.h"

#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <jpeglib.h>
#include <png.h>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

constexpr uint32_t kMaxPictureSide = 16384;

void check_size(uint32_t width, uint32_t height, const std::string& name) {
  if (width == 0 || height == 0) throw Error(ErrorCode::invalid_data, name + ": the picture has no pixels");
  if (width > kMaxPictureSide || height > kMaxPictureSide)
    throw Error(ErrorCode::limit, name + ": the picture has " + std::to_string(width) + " x " + std::to_string(height) +
                                      " pixels, more than " + std::to_string(kMaxPictureSide) +
                                      " a side; scale it down");
}

Picture decode_png(std::span<const std::byte> bytes, const std::string& name) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0)
    throw Error(ErrorCode::invalid_data, name + ": broken PNG (" + image.message + "); export it again");
  try {
    check_size(image.width, image.height, name);
    image.format = PNG_FORMAT_RGBA;
    Picture picture(image.width, image.height);
    if (png_image_finish_read(&image, nullptr, picture.pixel.data(), 0, nullptr) == 0)
      throw Error(ErrorCode::invalid_data, name + ": broken PNG (" + image.message + "); export it again");
    return picture;
  } catch (...) {
    png_image_free(&image);
    throw;
  }
}

struct JpegError {
  jpeg_error_mgr manager{};
  std::jmp_buf return_point{};
  char message[JMSG_LENGTH_MAX]{};
};

struct JpegTarget {
  uint32_t width = 0, height = 0;
  Color* pixel = nullptr;  ///< null: only the size is wanted
};

[[noreturn]] void leave_jpeg(j_common_ptr info) {
  auto* error = reinterpret_cast<JpegError*>(info->err);
  info->err->format_message(info, error->message);
  std::longjmp(error->return_point, 1);
}

/// Reads the size, and the pixels when the target has room for them. False with error.message when it failed.
bool read_jpeg(std::span<const std::byte> bytes, JpegError& error, JpegTarget& target) {
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&error.manager);
  error.manager.error_exit = leave_jpeg;
  error.manager.output_message = [](j_common_ptr) {};
  if (setjmp(error.return_point) != 0) {
    jpeg_destroy_decompress(&info);
    return false;
  }
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (target.pixel == nullptr) {
    target.width = info.image_width;
    target.height = info.image_height;
    jpeg_destroy_decompress(&info);
    return true;
  }
  info.out_color_space = JCS_EXT_RGBA;
  jpeg_start_decompress(&info);
  while (info.output_scanline < info.output_height) {
    auto* row = reinterpret_cast<JSAMPROW>(target.pixel + size_t{info.output_scanline} * target.width);
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  jpeg_destroy_decompress(&info);
  return true;
}

Picture decode_jpeg(std::span<const std::byte> bytes, const std::string& name) {
  JpegError error;
  JpegTarget target;
  const auto read = [&] {
    if (!read_jpeg(bytes, error, target))
      throw Error(ErrorCode::invalid_data, name + ": broken JPEG (" + error.message + "); export it again");
  };
  read();
  check_size(target.width, target.height, name);
  Picture picture(target.width, target.height);
  target.pixel = picture.pixel.data();
  read();
  return picture;
}

bool starts_with(std::span<const std::byte> bytes, std::span<const uint8_t> magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

Picture::Picture(uint32_t picture_width, uint32_t picture_height, Color fill)
    : width(picture_width), height(picture_height), pixel(size_t{picture_width} * picture_height, fill) {}

std::vector<std::byte> encode_png(const Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = PNG_FORMAT_RGBA;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.pixel.data(), 0, nullptr) == 0)
    throw Error(ErrorCode::limit, std::string("a picture of ") + std::to_string(picture.width) + " x " +
                                      std::to_string(picture.height) + " pixels cannot be written as PNG (" +
                                      image.message + "); choose another size");
  bytes.resize(size);
  return bytes;
}

void write_png(const Picture& picture, const std::filesystem::path& path) {
  write_file(path, std::span<const std::byte>(encode_png(picture)));
}

Picture decode_picture(std::span<const std::byte> bytes, const std::string& name) {
  constexpr uint8_t kPng[] = {0x89, 'P', 'N', 'G'};
  constexpr uint8_t kJpeg[] = {0xFF, 0xD8, 0xFF};
  if (starts_with(bytes, kPng)) return decode_png(bytes, name);
  if (starts_with(bytes, kJpeg)) return decode_jpeg(bytes, name);
  throw Error(ErrorCode::unsupported, name + ": neither a PNG nor a JPEG; convert it to one of them");
}

Picture read_picture(const std::filesystem::path& path) {
  return decode_picture(read_file(path), path.string());
}

}  // namespace geocloth
