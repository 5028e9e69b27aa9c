// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures by which a user judges a conversion, and the files they end in.
#include "render/picture.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/asset/output_file.h"
#include "render/asset_pictures.h"
#include "render/canvas.h"
#include "render/color_map.h"
#include "render/seam_lines.h"
#include "render/video.h"
#include "support/make_sheet.h"

namespace geocloth {
namespace {

using testing::HasSubstr;

std::filesystem::path fresh_folder(const std::string& name) {
  const auto folder = std::filesystem::path(GEOCLOTH_BINARY_DIR) / "test_output" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

Picture rainbow(uint32_t width, uint32_t height) {
  Picture picture(width, height);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      picture.at(x, y) = {static_cast<uint8_t>(x * 7), static_cast<uint8_t>(y * 5), static_cast<uint8_t>(x ^ y), 255};
  return picture;
}

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Picture, comes_back_from_png_bit_by_bit) {
  const Picture picture = rainbow(37, 23);
  const Picture back = decode_picture(encode_png(picture), "memory");
  EXPECT_EQ(back.width, picture.width);
  EXPECT_EQ(back.pixel, picture.pixel);
}

TEST(Picture, truncated_png_is_an_error_at_every_length) {
  const std::vector<std::byte> bytes = encode_png(rainbow(9, 9));
  // The last 12 bytes are the empty end chunk; the picture is whole without it.
  for (size_t length = 0; length + 12 < bytes.size(); ++length)
    EXPECT_THROW(static_cast<void>(decode_picture(std::span(bytes).first(length), "cut.png")), Error) << length;
}

TEST(Picture, names_the_file_that_is_no_picture) {
  const std::vector<std::byte> text(40, std::byte{'x'});
  EXPECT_THAT(message_of([&] { static_cast<void>(decode_picture(text, "skin.webp")); }), HasSubstr("skin.webp"));
}

TEST(Picture, broken_jpeg_is_an_error) {
  const std::vector<std::byte> bytes{std::byte{0xFF}, std::byte{0xD8}, std::byte{0xFF}, std::byte{0xE0}};
  EXPECT_THROW(static_cast<void>(decode_picture(bytes, "a.jpg")), Error);
}

TEST(Canvas, contact_sheet_holds_every_picture) {
  std::vector<Picture> pictures;
  std::vector<std::string> labels;
  for (uint32_t i = 0; i < 7; ++i) {
    pictures.emplace_back(64U, 40U, distinct_color(i));
    labels.push_back(std::to_string(i));
  }
  const Picture sheet = contact_sheet(pictures, labels, 32);
  std::set<std::array<uint8_t, 3>> seen;
  for (const Color& color : sheet.pixel) seen.insert({color.r, color.g, color.b});
  for (uint32_t i = 0; i < 7; ++i) {
    const Color color = distinct_color(i);
    EXPECT_TRUE(seen.contains({color.r, color.g, color.b})) << i;
  }
}

TEST(Canvas, drawing_outside_is_clipped) {
  Picture picture(8, 8);
  draw_line(picture, -1e9F, -5, 1e9F, 50, 3, {255, 0, 0, 255});
  fill_disc(picture, 100, -100, 20, {255, 0, 0, 255});
  fill_rectangle(picture, -5, -5, 2, 2, {255, 0, 0, 255});
  draw_text(picture, -3, 6, 2, "clip \xC3\xA9", {255, 0, 0, 255});
  EXPECT_EQ(picture.pixel.size(), 64U);
}

TEST(SeamLines, an_uncut_sheet_has_only_free_borders) {
  const ClothAsset sheet = test::make_sheet({.nx = 6, .ny = 5});
  const SeamLines lines = find_seam_lines(sheet);
  EXPECT_EQ(lines.seam_count, 0U);
  EXPECT_EQ(lines.edge.size(), 2U * (5 + 4));
}

TEST(SeamLines, mates_of_a_cut_share_their_seam_and_crossings_are_nodes) {
  // Four charts: a cross of four seams that meet in the middle and end at four free borders.
  const ClothAsset sheet = test::make_sheet({.nx = 9, .ny = 9, .charts_x = 2, .charts_y = 2});
  const SeamLines lines = find_seam_lines(sheet);
  EXPECT_EQ(lines.seam_count, 4U);
  for (uint32_t row = 0; row < sheet.splits.rows(); ++row) {
    std::set<uint32_t> seams;
    const uint32_t begin = sheet.splits.offset[row], end = sheet.splits.offset[row + 1];
    for (uint32_t i = begin; i < end; ++i) seams.insert(lines.pixel_seam[sheet.splits.pixel[i]]);
    EXPECT_EQ(seams.size(), 1U) << "copies of row " << row;
    if (end - begin == 4) {
      EXPECT_TRUE(seams.contains(kSeamNode));
    }
  }
}

TEST(SeamLines, a_closed_tube_has_one_seam) {
  const SeamLines lines = find_seam_lines(test::make_tube({.nx = 12, .ny = 8}));
  EXPECT_EQ(lines.seam_count, 1U);
}

TEST(Distortion, is_that_of_a_known_linear_map) {
  // Twice as wide as its pixels say, half as high: area 1, anisotropy 4.
  ClothAsset sheet = test::make_sheet({.nx = 11, .ny = 11, .width = 1, .height = 1});
  for (Vec3& p : sheet.rest_position) p = {p.x * 2, p.y / 2, p.z};
  for (const PixelDistortion& d : measure_distortion(sheet)) {
    EXPECT_NEAR(d.area, 1, 1e-4);
    EXPECT_NEAR(d.anisotropy, 4, 1e-3);
  }
}

TEST(Distortion, of_a_shear_is_its_singular_value_ratio) {
  ClothAsset sheet = test::make_sheet({.nx = 11, .ny = 11});
  for (Vec3& p : sheet.rest_position) p = {p.x + p.y, p.y, p.z};
  const float golden = (1 + std::sqrt(5.F)) / 2;  // singular values of (1 1; 0 1) are golden and 1/golden
  for (const PixelDistortion& d : measure_distortion(sheet)) {
    EXPECT_NEAR(d.area, 1, 1e-4);
    EXPECT_NEAR(d.anisotropy, golden * golden, 1e-3);
  }
}

TEST(AssetPictures, the_geometry_image_spans_all_colours_of_the_box) {
  const ClothAsset sheet = test::make_sheet({.nx = 5, .ny = 5});
  const Picture picture = draw_geometry_image(sheet);
  ASSERT_EQ(picture.width, sheet.width);
  const Color top_left = picture.at(0, 0), bottom_right = picture.at(4, 4);
  EXPECT_EQ(top_left, (Color{0, 255, 128, 255}));  // x smallest, y largest, z flat
  EXPECT_EQ(bottom_right, (Color{255, 0, 128, 255}));
}

TEST(AssetPictures, the_normal_map_of_a_sheet_that_faces_us_is_blue) {
  const Picture picture = draw_normal_map(test::make_sheet({.nx = 5, .ny = 5}));
  for (const Color& color : picture.pixel) EXPECT_EQ(color, (Color{128, 128, 255, 255}));
}

TEST(AssetPictures, writes_every_file_and_makes_the_folder) {
  const auto folder = fresh_folder("asset_pictures") / "new" / "deep";
  const auto files = write_pictures(
      test::make_sheet({.nx = 33, .ny = 21, .charts_x = 3, .charts_y = 2, .jitter = 0.2F}), nullptr, folder);
  EXPECT_EQ(files.size(), 4U);
  for (const auto& file : files) EXPECT_GE(read_picture(file).width, 500U) << file;
}

TEST(AssetPictures, the_caption_of_a_narrow_chart_map_is_whole) {
  const Picture map = draw_chart_map(test::make_sheet({.nx = 4, .ny = 400, .width = 500, .height = 50000}));
  ASSERT_GT(map.height, 80U);
  for (uint32_t y = map.height - 80; y < map.height; ++y)
    for (uint32_t x = map.width - 10; x < map.width; ++x)
      ASSERT_EQ(map.pixel[size_t{y} * map.width + x], map.pixel.back()) << x << ", " << y;
}

TEST(AssetPictures, names_the_folder_that_is_a_file) {
  const auto folder = fresh_folder("asset_pictures_bad");
  write_file(folder / "taken", std::string_view("x"));
  const std::string message = message_of([&] { write_pictures(test::make_sheet({}), nullptr, folder / "taken"); });
  EXPECT_THAT(message, HasSubstr("taken"));
}

class Video : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  }
};

TEST_F(Video, is_whole_and_of_even_size) {
  const auto folder = fresh_folder("video");
  const auto path = folder / "odd size.mp4";
  {
    VideoWriter video(path, 65, 33, 30);
    for (int i = 0; i < 5; ++i) video.add(rainbow(65, 33));
    video.finish();
    EXPECT_FALSE(std::filesystem::exists(path)) << "before commit";
    video.commit();
  }
  const auto probe = folder / "probe.txt";
  const std::string command =
      "ffprobe -v error -count_frames -select_streams v:0 -show_entries "
      "stream=width,height,nb_read_frames,codec_name,pix_fmt -of csv=p=0 '" +
      path.string() + "' > '" + probe.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::vector<std::byte> bytes = read_file(probe);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), "h264,66,34,yuv420p,5\n");
}

TEST_F(Video, leaves_nothing_when_it_is_abandoned) {
  const auto folder = fresh_folder("video_abandoned");
  {
    VideoWriter video(folder / "a.mp4", 64, 64, 30);
    video.add(rainbow(64, 64));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(Video, refuses_a_frame_of_another_size) {
  VideoWriter video(fresh_folder("video_size") / "a.mp4", 64, 64, 30);
  EXPECT_THROW(video.add(rainbow(63, 64)), Error);
}

TEST(VideoWithoutFfmpeg, says_what_to_install) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const auto folder = fresh_folder("video_missing");
  const std::string message = message_of([&] { VideoWriter video(folder / "a.mp4", 64, 64, 30); });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("ffmpeg"));
  EXPECT_THAT(message, HasSubstr("install"));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(VideoWithBrokenFfmpeg, passes_on_its_words) {
  const auto folder = fresh_folder("video_broken");
  const auto fake = folder / "bin" / "ffmpeg";
  std::filesystem::create_directories(fake.parent_path());
  write_file(fake, std::string_view("#!/bin/sh\necho 'Unknown encoder libx264' >&2\nexit 1\n"));
  std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (fake.parent_path().string() + ":" + path).c_str(), 1);
  const auto out = folder / "out";
  std::filesystem::create_directories(out);
  const std::string message = message_of([&] {
    VideoWriter video(out / "a.mp4", 640, 480, 30);
    for (int i = 0; i < 100; ++i) video.add(Picture(640, 480));
    video.finish();
  });
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("Unknown encoder libx264"));
  EXPECT_TRUE(std::filesystem::is_empty(out));
}

}  // namespace
}  // namespace geocloth
