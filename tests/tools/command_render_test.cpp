// SPDX-License-Identifier: GPL-3.0-or-later
// `geocloth render` and the pictures of `geocloth simulate`, as their users call them.
#include <algorithm>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "render/picture.h"
#include "support/make_sheet.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CommandRender : public testing::Test {
 protected:
  void SetUp() override {
    SheetOptions sheet;
    sheet.nx = sheet.ny = 12;
    write_asset(make_sheet(sheet), asset_);
    if (run_program({"render", asset_, "-o", folder_ / "probe.png", "--size", "32x32", "-q"}).status != 0)
      GTEST_SKIP() << "no Vulkan device that can draw";
    std::filesystem::remove(folder_ / "probe.png");
  }

  ProgramResult render(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"--size", "96x64", "-q"});
    return run_program(arguments);
  }
  /// One line about `about`, status 1, and no file beside the inputs.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& about) {
    const std::vector<std::string> before = folder_.entries();
    const ProgramResult result = render(arguments);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(about));
    EXPECT_EQ(folder_.entries(), before);
  }
  static bool has_ffmpeg() { return std::system("ffmpeg -version > /dev/null 2>&1") == 0; }

  TemporaryFolder folder_;
  std::string asset_ = folder_ / "sheet.glb";
};

TEST_F(CommandRender, draws_an_asset_in_every_way) {
  for (const char* show : {"cloth", "grid", "strain", "charts", "seams"}) {
    const std::string picture = folder_ / (std::string(show) + ".png");
    EXPECT_EQ(render({asset_, "-o", picture, "--show", show}).status, 0) << show;
    EXPECT_EQ(read_picture(picture).width, 96U) << show;
  }
}

TEST_F(CommandRender, a_sheet_of_views_is_larger_than_one_view) {
  ASSERT_EQ(render({asset_, "-o", folder_ / "sheet.png", "--sheet", "6"}).status, 0);
  const Picture sheet = read_picture(folder_ / "sheet.png");
  EXPECT_GT(sheet.width * sheet.height, 6U * 96 * 64);
}

TEST_F(CommandRender, plays_what_simulate_wrote) {
  const ProgramResult result = run_program({"simulate", asset_, "-o", folder_ / "a.glb", "-o", folder_ / "a.pc2", "-o",
                                            folder_ / "a.mdd", "--frames", "3", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(render({folder_ / "a.glb", "-o", folder_ / "glb.png", "--frame", "2"}).status, 0);
  EXPECT_EQ(render({folder_ / "a.pc2", "--asset", asset_, "-o", folder_ / "pc2.png", "--frame", "2"}).status, 0);
  EXPECT_EQ(render({folder_ / "a.mdd", "--asset", asset_, "-o", folder_ / "mdd.png", "--frame", "2"}).status, 0);
  EXPECT_EQ(read_picture(folder_ / "pc2.png").pixel, read_picture(folder_ / "mdd.png").pixel);

  expect_refused({folder_ / "a.pc2", "-o", folder_ / "x.png"}, "--asset");
  expect_refused({folder_ / "a.glb", "-o", folder_ / "x.png", "--frame", "4"}, "the last one is 3");
  expect_refused({folder_ / "a.glb", "-o", folder_ / "x.png", "--show", "grid"}, "--show");
  SheetOptions other;
  other.nx = 5;
  write_asset(make_sheet(other), folder_ / "other.glb");
  expect_refused({folder_ / "a.pc2", "--asset", folder_ / "other.glb", "-o", folder_ / "x.png"}, "144 points");
}

/// Later cuts were open from the first frame on.
TEST_F(CommandRender, cuts_of_a_motion_come_at_their_time) {
  const auto motion = [&](const std::string& name, const std::string& cuts) {
    const std::string scene = folder_.write(name + ".json", R"({"version":1,"frames":8,"gravity":[0,0,0],"cloths":[)"
                                                            R"({"asset":"sheet.glb","cuts":[)" +
                                                                cuts + "]}]}");
    const ProgramResult result =
        run_program({"simulate", scene, "-o", folder_ / (name + ".glb"), "--backend", "cpu", "-q"});
    EXPECT_EQ(result.status, 0) << result.err;
    std::vector<Picture> pictures;
    for (const char* frame : {"1", "8"}) {
      EXPECT_EQ(render({folder_ / (name + ".glb"), "-o", folder_ / "p.png", "--frame", frame}).status, 0);
      pictures.push_back(read_picture(folder_ / "p.png"));
    }
    return pictures;
  };
  const std::string cut = R"("triangle":[[-2,0.02,-2],[2,0.02,-2],[0,0.02,4]]})";
  const std::vector<Picture> whole = motion("whole", ""), late = motion("late", R"({"time":0.1,)" + cut),
                             early = motion("early", R"({"time":0,)" + cut);
  const auto differing = [](const Picture& a, const Picture& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.pixel.size(); ++i) count += a.pixel[i] == b.pixel[i] ? 0U : 1U;
    return count;
  };
  EXPECT_EQ(differing(late[0], whole[0]), 0U);
  EXPECT_GT(differing(late[1], whole[1]), 20U);
  EXPECT_EQ(differing(late[1], early[1]), 0U);
  EXPECT_EQ(differing(early[0], early[1]), 0U);
}

// A shirt whose texture kept something else in its alpha was drawn as nothing but its shadow.
TEST_F(CommandRender, what_is_opaque_is_drawn_whatever_its_alpha_is) {
  const auto drawn = [&](float alpha, bool blends) {
    ClothAsset sheet = make_sheet({.nx = 12, .ny = 12});
    sheet.source.material.resize(1);
    sheet.source.material[0].base_color = {0.8F, 0.2F, 0.1F, alpha};
    sheet.source.material[0].alpha_blend = blends;
    write_asset(sheet, folder_ / "alpha.glb");
    EXPECT_EQ(render({folder_ / "alpha.glb", "-o", folder_ / "alpha.png"}).status, 0);
    return read_picture(folder_ / "alpha.png").pixel;
  };
  const auto opaque = drawn(1, false);
  EXPECT_EQ(drawn(0, false), opaque);
  EXPECT_NE(drawn(0, true), opaque);
}

// An asset's grid is known, that of the garment in a cache is not, however few frames it has.
TEST_F(CommandRender, a_cache_of_one_frame_has_no_grid) {
  ASSERT_EQ(run_program({"simulate", asset_, "-o", folder_ / "still.glb", "--frames", "0", "-q"}).status, 0);
  expect_refused({folder_ / "still.glb", "-o", folder_ / "grid.png", "--show", "grid"}, "--show can only be cloth");
}

TEST_F(CommandRender, simulate_numbers_its_pictures_from_one) {
  ASSERT_EQ(run_program({"simulate", asset_, "-o", folder_ / "p.png", "--frames", "2", "--size", "64x64", "-q"}).status,
            0);
  EXPECT_THAT(folder_.entries(), ElementsAre("p_0001.png", "p_0002.png", "sheet.glb"));
}

TEST_F(CommandRender, both_backends_draw_the_same_pictures) {
  for (const char* backend : {"cpu", "vulkan"}) {
    const ProgramResult result = run_program({"simulate", asset_, "-o", folder_ / (std::string(backend) + ".png"),
                                              "--frames", "3", "--size", "96x64", "--backend", backend, "-q"});
    ASSERT_EQ(result.status, 0) << result.err;
  }
  const Picture cpu = read_picture(folder_ / "cpu_0003.png"), vulkan = read_picture(folder_ / "vulkan_0003.png");
  size_t differing = 0;
  for (size_t i = 0; i < cpu.pixel.size(); ++i) differing += cpu.pixel[i] == vulkan.pixel[i] ? 0U : 1U;
  EXPECT_LT(differing, cpu.pixel.size() / 50);
}

// ffmpeg ends as if all were well when the disk is full, and the film took the place of an older one.
TEST_F(CommandRender, a_film_that_does_not_fit_is_refused) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string said = folder_ / "said", film = folder_ / "a.mp4";
  EXPECT_EQ(
      run_in_shell("simulate " + asset_ + " --frames 30 -o " + film + " --size 256x256 -q 2> " + said, "ulimit -f 4"),
      1);
  EXPECT_THAT(read_text(said), HasSubstr("a.mp4"));
  EXPECT_THAT(folder_.entries(), ElementsAre("said", "sheet.glb"));
}

TEST_F(CommandRender, a_film_may_have_a_colon_in_its_name) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const ProgramResult result =
      run_program({"simulate", asset_, "-o", folder_ / "a:b.mp4", "--frames", "2", "--size", "64x64", "-q"});
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(CommandRender, an_interrupted_film_leaves_nothing) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const ProgramResult result = run_program({"simulate", asset_, "-o", folder_ / "a.mp4", "-o", folder_ / "b.png",
                                            "--frames", "100000", "--size", "64x64", "-q"},
                                           std::chrono::milliseconds(1500));
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(folder_.entries(), ElementsAre("sheet.glb"));
}

TEST_F(CommandRender, bad_input_is_one_line_and_no_file) {
  expect_refused({folder_ / "missing.glb", "-o", folder_ / "x.png"}, "missing.glb");
  expect_refused({folder_.write("text.glb", "no mesh"), "-o", folder_ / "x.png"}, "text.glb");
  expect_refused({folder_.write("empty.pc2", ""), "--asset", asset_, "-o", folder_ / "x.png"}, "empty.pc2");
  expect_refused({asset_, "-o", folder_ / "nowhere/x.png"}, "nowhere");
  expect_refused({asset_, "-o", folder_ / "x.png", "--device", "Voodoo 2"}, "Voodoo 2");
  const std::string whole = read_text(asset_);
  for (size_t length = 0; length < whole.size(); length += whole.size() / 7)
    expect_refused({folder_.write("cut.glb", whole.substr(0, length)), "-o", folder_ / "x.png"}, "cut.glb");
}

}  // namespace
}  // namespace geocloth::test
