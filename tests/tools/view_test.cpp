// SPDX-License-Identifier: GPL-3.0-or-later
// The window itself, on a display that nobody looks at, under the validation layers: what it shows, and what a mouse
// does in it.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "render/picture.h"
#include "support/make_sheet.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "support/virtual_display.h"
#include "support/vulkan_test.h"
#include "view/viewer.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace geocloth::view {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// What is drawn of the sheet: nothing else in a picture is as blue.
bool is_blue(const Color& color) {
  return color.b > color.r + 40;
}

size_t count_blue(const Picture& picture) {
  return static_cast<size_t>(std::count_if(picture.pixel.begin(), picture.pixel.end(), is_blue));
}

double difference(const Picture& a, const Picture& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.pixel.size(); ++i) count += a.pixel[i] == b.pixel[i] ? 0U : 1U;
  return static_cast<double>(count) / static_cast<double>(a.pixel.size());
}

class View : public test::VulkanTest {
 protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    display_ = std::make_unique<test::VirtualDisplay>();
    if (!display_->running()) {
      ASSERT_EQ(std::getenv("GEOCLOTH_REQUIRE_DEVICE"), nullptr) << "Xvfb is not installed";
      GTEST_SKIP() << "no Xvfb";
    }
    ClothAsset sheet = test::make_sheet(options_);
    for (SourceMaterial& material : sheet.source.material) material.base_color = {0.05F, 0.15F, 0.9F, 1};
    write_asset(sheet, asset_);
    folder_.write("scene.json", R"({ "version": 1, "substeps": 4,
      "cloths": [ { "asset": "sheet.glb", "material": "cotton", "pins": [ { "where": { "top": 0.01 } } ] } ],
      "colliders": [ { "name": "ball", "shape": "sphere", "center": [0.7, 1.5, 0], "radius": 0.1 } ] })");
  }

  /// In a small window without widgets, so that the scene alone is in its pictures.
  std::unique_ptr<Viewer> open(Backend backend, bool play = true) {
    ViewerOptions options{.title = "test", .size = {320, 240}, .solver = {}, .play = play, .frames = std::nullopt};
    options.solver.backend = backend;
    auto viewer = std::make_unique<Viewer>(read_scene(folder_ / "scene.json"), options);
    viewer->session().display().panel = false;
    log_ = viewer->validation_log();
    return viewer;
  }
  /// Turns until so many frames are played.
  static void play_to(Viewer& viewer, uint32_t frame) {
    for (int i = 0; i < 1000 && viewer.session().simulation().frame() < frame; ++i) ASSERT_TRUE(viewer.turn());
    ASSERT_GE(viewer.session().simulation().frame(), frame);
  }
  static Vec2 place_of(Session& session, uint32_t pixel) {
    return session.screen().place(session.positions(0)[pixel]).value();
  }

  test::TemporaryFolder folder_;
  test::SheetOptions options_{.nx = 12, .ny = 12, .center = {0, 1.5F, 0}};
  std::string asset_ = folder_ / "sheet.glb";
  std::unique_ptr<test::VirtualDisplay> display_;
  std::shared_ptr<const ValidationLog> log_;

  void TearDown() override {
    if (log_ != nullptr) {
      EXPECT_THAT(log_->messages(), IsEmpty());
    }
    VulkanTest::TearDown();
  }
};

/// A step at a time, one window after the other: both show the same, one from the solver's images.
TEST_F(View, shows_the_cloth_of_either_backend_as_it_moves) {
  std::vector<Picture> first, last;
  for (const Backend backend : {Backend::cpu, Backend::vulkan}) {
    const auto viewer = open(backend, false);
    EXPECT_EQ(viewer->draws_from_solver(), backend == Backend::vulkan);
    ASSERT_TRUE(viewer->turn());
    first.push_back(viewer->picture());
    for (int i = 0; i < 4; ++i) viewer->window().post(KeyPressed{Key::step});
    ASSERT_TRUE(viewer->turn());
    EXPECT_EQ(viewer->session().simulation().frame(), 4U);
    last.push_back(viewer->picture());
    EXPECT_THAT(log_->messages(), IsEmpty());
  }
  ASSERT_EQ(first[0].width, 320U);
  EXPECT_GT(count_blue(first[0]), 320U * 240 / 8);
  EXPECT_LT(count_blue(first[0]), 320U * 240 / 2);
  EXPECT_GT(difference(first[0], last[0]), 0.001);
  EXPECT_LT(difference(first[0], first[1]), 0.01);
  EXPECT_LT(difference(last[0], last[1]), 0.01);
}

TEST_F(View, layers_and_widgets_show) {
  const auto viewer = open(Backend::cpu, false);
  ASSERT_TRUE(viewer->turn());
  Picture before = viewer->picture();
  for (const Key key : {Key::springs, Key::pins, Key::colliders, Key::panel, Key::show_strain, Key::show_seams}) {
    viewer->window().post(KeyPressed{key});
    ASSERT_TRUE(viewer->turn());
    ASSERT_TRUE(viewer->turn());  // the library lays out a new window of widgets one picture late
    Picture now = viewer->picture();
    EXPECT_GT(difference(before, now), 0.0005) << static_cast<int>(key);
    before = std::move(now);
  }
}

TEST_F(View, a_mouse_drags_the_cloth) {
  const auto viewer = open(Backend::cpu);
  play_to(*viewer, 2);
  const uint32_t pixel = test::sheet_pixel(options_, 6, 10);
  const Vec2 from = place_of(viewer->session(), pixel), to{from.x - 40, from.y - 30};
  viewer->window().post(MousePressed{MouseButton::left, from});
  viewer->window().post(MouseMoved{to});
  play_to(*viewer, 30);
  const auto way_to_go = [&] {
    const Vec2 now = place_of(viewer->session(), pixel);
    return std::hypot(now.x - to.x, now.y - to.y);
  };
  const float held = way_to_go();  // of 50 pixels; the cloth pulls back, and the hand has its limit
  EXPECT_LT(held, 25);
  viewer->window().post(MouseReleased{MouseButton::left, to});
  play_to(*viewer, 90);
  EXPECT_GT(way_to_go(), held + 10);
}

/// With the images of a solver on the same device, whose cells the cut opens.
TEST_F(View, a_line_cuts_the_cloth_and_what_is_cut_off_falls_out_of_the_picture) {
  const auto viewer = open(Backend::vulkan);
  ASSERT_TRUE(viewer->turn());
  const size_t whole = count_blue(viewer->picture());
  const Vec2 left = place_of(viewer->session(), test::sheet_pixel(options_, 0, 5)),
             right = place_of(viewer->session(), test::sheet_pixel(options_, 11, 5));
  viewer->window().post(MousePressed{MouseButton::left, {left.x - 10, left.y + 3}, false, true});
  viewer->window().post(MouseReleased{MouseButton::left, {right.x + 10, right.y + 3}});
  play_to(*viewer, 50);
  const size_t left_over = count_blue(viewer->picture());
  EXPECT_GT(left_over, whole / 4);
  EXPECT_LT(left_over, 3 * whole / 4);
}

TEST_F(View, a_restart_draws_the_new_solver) {
  const auto viewer = open(Backend::vulkan, false);
  ASSERT_TRUE(viewer->turn());
  const Picture start = viewer->picture();
  for (int i = 0; i < 3; ++i) viewer->window().post(KeyPressed{Key::step});
  ASSERT_TRUE(viewer->turn());
  EXPECT_GT(difference(start, viewer->picture()), 0.001);
  viewer->window().post(KeyPressed{Key::restart});
  ASSERT_TRUE(viewer->turn());
  EXPECT_EQ(difference(start, viewer->picture()), 0);
}

TEST_F(View, takes_every_size_of_its_window) {
  const auto viewer = open(Backend::cpu, false);
  ASSERT_TRUE(viewer->turn());
  for (const auto& [width, height] : {std::pair{500, 300}, {200, 400}, {1, 1}, {320, 240}}) {
    glfwSetWindowSize(viewer->window().handle(), width, height);
    for (int i = 0; i < 50 && viewer->picture().width != static_cast<uint32_t>(width); ++i) ASSERT_TRUE(viewer->turn());
    EXPECT_EQ(viewer->picture().width, static_cast<uint32_t>(width));
    EXPECT_EQ(viewer->picture().height, static_cast<uint32_t>(height));
  }
  EXPECT_GT(count_blue(viewer->picture()), 320U * 240 / 8);
}

TEST_F(View, closes_when_it_is_told_to) {
  const auto viewer = open(Backend::cpu);
  ASSERT_TRUE(viewer->turn());
  glfwSetWindowShouldClose(viewer->window().handle(), GLFW_TRUE);
  EXPECT_FALSE(viewer->turn());
}

TEST_F(View, the_program_plays_a_garment_and_leaves_what_it_showed) {
  const std::string shot = folder_ / "shot.png";
  const test::ProgramResult result =
      test::run_program({"view", asset_, "--frames", "8", "-o", shot, "--size", "800x600"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());  // the validation layers print there
  EXPECT_THAT(result.out, HasSubstr("shot.png"));
  const Picture picture = read_picture(shot);
  EXPECT_EQ(picture.width, 800U);
  EXPECT_GT(count_blue(picture), 800U * 600 / 16);
}

TEST(ViewCommand, says_what_to_do_without_a_display) {
  const test::TemporaryFolder folder;
  test::SheetOptions small;
  small.nx = small.ny = 4;
  write_asset(test::make_sheet(small), folder / "sheet.glb");
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const test::ProgramResult result =
      test::run_program({"view", folder / "sheet.glb", "-o", folder / "shot.png", "--frames", "1"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("no display"));
  EXPECT_THAT(result.err, testing::Not(HasSubstr("sheet.glb"))) << "the scene is not to blame";
  EXPECT_THAT(result.err, HasSubstr("geocloth render"));
  EXPECT_THAT(folder.entries(), testing::ElementsAre("sheet.glb"));
}

TEST(ViewCommand, a_bad_scene_is_refused_as_by_simulate) {
  const test::TemporaryFolder folder;
  const std::string scene = folder.write("bad.json", R"({ "version": 1, "cloth": [] })");
  const auto message = [](const test::ProgramResult& result) { return result.err.substr(result.err.find(": ")); };
  const test::ProgramResult viewed = test::run_program({"view", scene}),
                            simulated = test::run_program({"simulate", scene, "--check"});
  EXPECT_EQ(viewed.status, 1);
  EXPECT_EQ(message(viewed), message(simulated));
}

}  // namespace
}  // namespace geocloth::view
