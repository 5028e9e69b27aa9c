// SPDX-License-Identifier: GPL-3.0-or-later
// What the window does, without a window: camera, picking, cutting, pacing, and a scene that is played and handled.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "support/make_sheet.h"
#include "support/temporary_folder.h"
#include "view/cut_line.h"
#include "view/orbit_view.h"
#include "view/pacer.h"
#include "view/pick.h"
#include "view/screen_map.h"
#include "view/session.h"

namespace geocloth::view {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr PictureSize kSize{640, 480};
const Camera kFromFront{{0, 0, 4}, {0, 0, 0}};

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  EXPECT_LT(length(a - b), tolerance) << a.x << " " << a.y << " " << a.z << ", not " << b.x << " " << b.y << " " << b.z;
}

TEST(ScreenMap, rays_go_through_the_places_of_their_points) {
  const ScreenMap screen({{1, 2, 3}, {0.2F, 0.1F, -0.4F}}, kSize);
  for (const Vec3& point : {Vec3{0, 0, 0}, Vec3{0.3F, -0.2F, 0.1F}, Vec3{-0.4F, 0.5F, -2}}) {
    const std::optional<Vec2> place = screen.place(point);
    ASSERT_TRUE(place);
    const Ray ray = screen.ray(*place);
    expect_near(ray.origin + screen.depth(point) * ray.direction, point, 1e-5F);
    expect_near(screen.in_view_plane(*place, point), point, 1e-5F);
  }
  EXPECT_FALSE(screen.place({2, 4, 6}));  // behind the eye
}

/// The picture's middle is the target, its upper edge half the field of view away, and it is not mirrored.
TEST(ScreenMap, agrees_with_the_matrices_that_pictures_are_drawn_with) {
  const Camera camera{{1, 2, 3}, {0, 0.5F, 0}};
  const Matrix4 m = perspective(camera.field_of_view_deg, 640.F / 480, 0.1F, 10) * look_at(camera.eye, camera.target);
  const ScreenMap screen(camera, kSize);
  for (const Vec3& p : {Vec3{0, 0.5F, 0}, Vec3{0.4F, 0.1F, 0.2F}, Vec3{-0.3F, 0.9F, -0.5F}}) {
    const float x = m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], y = m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13];
    const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
    const Vec2 place = screen.place(p).value();
    EXPECT_NEAR(place.x, (x / w + 1) * 320, 0.01F);
    EXPECT_NEAR(place.y, (y / w + 1) * 240, 0.01F);
  }
}

TEST(OrbitView, frames_turns_moves_and_comes_nearer) {
  Bounds box;
  box.include(Vec3{-1, 0, -1});
  box.include(Vec3{1, 2, 1});
  OrbitView view;
  view.frame(box, kSize);
  const Camera start = view.camera();
  expect_near(start.target, box.center(), 1e-5F);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1) != 0 ? 1.F : -1.F, (corner & 2) != 0 ? 2.F : 0.F, (corner & 4) != 0 ? 1.F : -1.F};
    const Vec2 place = ScreenMap(start, kSize).place(p).value();
    EXPECT_TRUE(place.x > 0 && place.x < 640 && place.y > 0 && place.y < 480) << place.x << " " << place.y;
  }

  view.orbit({100, 0});  // to the right: the near side goes to the right
  const Vec3 near_side = start.target + 0.3F * (start.eye - start.target);
  EXPECT_GT(ScreenMap(view.camera(), kSize).place(near_side)->x, 330);
  EXPECT_NEAR(length(view.camera().eye - view.camera().target), length(start.eye - start.target), 1e-4F);
  view.orbit({-100, 1e6F});  // never over the pole
  EXPECT_LT(view.camera().eye.y, length(start.eye - start.target) + 1.001F);
  view.frame(box, kSize);
  const Vec2 before = ScreenMap(view.camera(), kSize).place(box.center()).value();
  view.pan({30, -20}, kSize);
  const Vec2 after = ScreenMap(view.camera(), kSize).place(box.center()).value();
  EXPECT_NEAR(after.x - before.x, 30, 0.1F);
  EXPECT_NEAR(after.y - before.y, -20, 0.1F);

  const float distance = length(view.camera().eye - view.camera().target);
  view.zoom(2);
  EXPECT_LT(length(view.camera().eye - view.camera().target), 0.9F * distance);
  view.zoom(1e6F);
  EXPECT_GT(length(view.camera().eye - view.camera().target), 0);
  view.zoom(-1e6F);
  EXPECT_TRUE(is_finite(view.camera().eye));
}

TEST(OrbitView, frames_nothing_and_a_point) {
  OrbitView view;
  view.frame({}, kSize);
  EXPECT_TRUE(is_finite(view.camera().eye));
  Bounds point;
  point.include(Vec3{5, 5, 5});
  view.frame(point, kSize);
  expect_near(view.camera().target, {5, 5, 5}, 1e-5F);
  EXPECT_GT(length(view.camera().eye - view.camera().target), 0);
}

/// A sheet of 1 m in the plane z = 0, looked at from the front.
class Pick : public testing::Test {
 protected:
  test::SheetOptions options_{.nx = 11, .ny = 11};
  ClothAsset sheet_ = test::make_sheet(options_);
  std::vector<Vec3> position_ = sheet_.rest_position;
  ScreenMap screen_{kFromFront, kSize};

  std::optional<Picked> pick(const Vec3& at, std::span<const Collider> colliders = {}) {
    const PickedFrom cloth{&sheet_, position_};
    return pick_pixel(screen_, screen_.place(at).value(), {&cloth, 1}, colliders);
  }
};

TEST_F(Pick, takes_the_nearest_pixel_under_the_mouse) {
  const std::optional<Picked> picked = pick({0.03F, 0.22F, 0});
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->pixel, test::sheet_pixel(options_, 5, 3));
  expect_near(picked->point, {0, 0.2F, 0}, 1e-5F);
}

TEST_F(Pick, reaches_a_few_pixels_beside_the_cloth) {
  const Vec2 corner = screen_.place({0.5F, 0.5F, 0}).value();
  const PickedFrom cloth{&sheet_, position_};
  const auto beside = pick_pixel(screen_, {corner.x + 5, corner.y - 5}, {&cloth, 1}, {});
  ASSERT_TRUE(beside);
  EXPECT_EQ(beside->pixel, test::sheet_pixel(options_, 10, 0));
  EXPECT_FALSE(pick_pixel(screen_, {corner.x + 40, corner.y - 40}, {&cloth, 1}, {}));
}

TEST_F(Pick, takes_the_foremost_cloth) {
  std::vector<Vec3> behind = position_;
  for (Vec3& p : behind) p.z = -1;
  const std::array cloths{PickedFrom{&sheet_, behind}, PickedFrom{&sheet_, position_}};
  const auto picked = pick_pixel(screen_, {320, 240}, cloths, {});
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->cloth, 1U);
}

TEST_F(Pick, does_not_reach_through_colliders) {
  const Collider ball{.shape = Sphere{{0, 0, 1}, 0.2F}};
  EXPECT_FALSE(pick({0, 0, 0}, {&ball, 1}));
  ClothAsset in_centimetres = sheet_;
  in_centimetres.spacing *= 100;
  const PickedFrom scaled{&in_centimetres, position_, 0.01F};
  EXPECT_FALSE(pick_pixel(screen_, screen_.place({0, 0, 0}).value(), {&scaled, 1}, {&ball, 1}));
  EXPECT_TRUE(pick({0.45F, 0.45F, 0}, {&ball, 1}));
  const Collider behind{.shape = Sphere{{0, 0, -0.21F}, 0.2F}};  // the cloth lies on it
  EXPECT_TRUE(pick({0, 0, 0}, {&behind, 1}));
  const Collider around{.shape = Sphere{{0, 0, 4}, 1}};  // the eye is in it
  EXPECT_TRUE(pick({0, 0, 0}, {&around, 1}));
}

TEST_F(Pick, points_that_are_no_numbers_do_not_count) {
  for (Vec3& p : position_) p = {NAN, NAN, NAN};
  EXPECT_FALSE(pick({0, 0, 0}));
}

TEST(CutLine, goes_through_the_eye_and_behind_everything) {
  Bounds box;
  box.include(Vec3{-1, -1, -2});
  box.include(Vec3{1, 1, 0});
  const ScreenMap screen(kFromFront, kSize);
  const auto triangle = cut_triangle(screen, {100, 200}, {500, 220}, box);
  ASSERT_TRUE(triangle);
  expect_near((*triangle)[0], kFromFront.eye, 1e-6F);
  EXPECT_LT((*triangle)[1].z, -2);
  EXPECT_LT((*triangle)[2].z, -2);
  EXPECT_NEAR(screen.place((*triangle)[1])->x, 100, 0.01F);
  EXPECT_NEAR(screen.place((*triangle)[2])->y, 220, 0.01F);
}

TEST(CutLine, a_click_and_what_is_behind_cut_nothing) {
  Bounds box;
  box.include(Vec3{-1, -1, 5});
  box.include(Vec3{1, 1, 6});
  const ScreenMap screen(kFromFront, kSize);
  EXPECT_FALSE(cut_triangle(screen, {100, 200}, {500, 220}, box));
  box.include(Vec3{0, 0, 0});
  EXPECT_FALSE(cut_triangle(screen, {100, 200}, {101, 200}, box));
  EXPECT_FALSE(cut_triangle(screen, {100, 200}, {500, 220}, {}));
}

uint32_t play(Pacer& pacer, double seconds) {
  pacer.pass(seconds);
  uint32_t frames = 0;
  for (; pacer.due(); ++frames) pacer.played();
  pacer.drop();
  return frames;
}

TEST(Pacer, keeps_up_with_the_clock) {
  Pacer pacer(1.0 / 60);
  uint32_t frames = 0;
  for (int picture = 0; picture < 144; ++picture) frames += play(pacer, 1.0 / 144);
  EXPECT_NEAR(frames, 60, 1);
  EXPECT_EQ(play(pacer, 0), 0U);
  for (int picture = 0; picture < 60; ++picture) EXPECT_EQ(play(pacer, 1.0 / 60), 1U);
}

TEST(Pacer, drops_what_it_cannot_keep_up_with) {
  Pacer pacer(1.0 / 60);
  EXPECT_LE(play(pacer, 10), 15U);
  EXPECT_EQ(play(pacer, 0), 0U);
  for (int picture = 0; picture < 20; ++picture) {  // one frame takes longer than the clock gives: one a picture
    pacer.pass(0.1);
    ASSERT_TRUE(pacer.due());
    pacer.played();
    pacer.drop();
    EXPECT_FALSE(pacer.due());
  }
  EXPECT_EQ(play(pacer, -5), 0U);
}

/// A sheet that hangs by its upper edge, 2 m above a floor, in a picture of 640 x 480 from the front.
class SessionTest : public testing::Test {
 protected:
  static constexpr double kFrame = 1.0 / 60;
  test::SheetOptions options_{.nx = 16, .ny = 16, .center = {0, 2, 0}};
  test::TemporaryFolder folder_;
  Session::Setup setup_;

  void SetUp() override {
    write_asset(test::make_sheet(options_), folder_ / "sheet.glb");
    setup_.scene = parse_scene(R"({ "version": 1, "substeps": 8,
      "cloths": [ { "asset": "sheet.glb", "material": "cotton", "pins": [ { "where": { "top": 0.01 } } ] } ],
      "colliders": [ { "name": "floor", "shape": "plane", "point": [0, 0, 0], "normal": [0, 1, 0] } ] })",
                               folder_ / "scene.json");
    setup_.settings.backend = Backend::cpu;
  }
  static void play(Session& session, int frames) {
    for (int i = 0; i < frames; ++i) session.advance(kFrame);
  }
  static Vec2 place_of(Session& session, uint32_t pixel) {
    return session.screen().place(session.positions(0)[pixel]).value();
  }
};

TEST_F(SessionTest, plays_steps_stops_and_restarts) {
  setup_.frames = 12;
  Session session(setup_, kSize);
  const Vec3 start = session.positions(0)[test::sheet_pixel(options_, 8, 15)];
  play(session, 5);
  EXPECT_EQ(session.simulation().frame(), 5U);
  session.handle(KeyPressed{Key::play});
  play(session, 5);
  EXPECT_EQ(session.simulation().frame(), 5U);
  session.handle(KeyPressed{Key::step});
  EXPECT_EQ(session.simulation().frame(), 6U);
  EXPECT_NE(session.positions(0)[test::sheet_pixel(options_, 8, 15)], start);
  EXPECT_FALSE(session.finished());

  const uint32_t generation = session.generation();
  session.handle(KeyPressed{Key::restart});
  EXPECT_NE(session.generation(), generation);
  EXPECT_EQ(session.simulation().frame(), 0U);
  EXPECT_EQ(session.positions(0)[test::sheet_pixel(options_, 8, 15)], start);
  session.handle(KeyPressed{Key::play});
  play(session, 20);
  EXPECT_TRUE(session.finished());
  EXPECT_EQ(session.simulation().frame(), 6U);  // twelve in all
}

TEST_F(SessionTest, a_restart_that_cannot_read_its_asset_says_so_and_goes_on) {
  Session session(setup_, kSize);
  play(session, 2);
  std::filesystem::remove(folder_ / "sheet.glb");
  session.handle(KeyPressed{Key::restart});
  EXPECT_THAT(session.note(), HasSubstr("sheet.glb"));
  play(session, 1);
  EXPECT_EQ(session.simulation().frame(), 3U);
}

TEST_F(SessionTest, the_mouse_drags_a_point_and_lets_it_go) {
  Session session(setup_, kSize);
  play(session, 5);
  const uint32_t pixel = test::sheet_pixel(options_, 8, 14);
  const Vec2 from = place_of(session, pixel), to{from.x + 60, from.y - 40};
  session.handle(MousePressed{MouseButton::left, from});
  ASSERT_TRUE(session.hand());
  EXPECT_EQ(session.hand()->pixel(), pixel);
  session.handle(MouseMoved{to});
  play(session, 30);
  Vec2 now = place_of(session, pixel);
  EXPECT_LT(std::hypot(now.x - to.x, now.y - to.y), 10) << now.x << " " << now.y;

  session.handle(MouseReleased{MouseButton::left, to});
  EXPECT_FALSE(session.hand());
  play(session, 60);
  now = place_of(session, pixel);
  EXPECT_GT(std::hypot(now.x - to.x, now.y - to.y), 20);
}

/// Pulled to where it cannot be, the cloth is stretched, and not torn apart.
TEST_F(SessionTest, a_hand_does_not_tear_the_cloth) {
  Session session(setup_, kSize);
  session.handle(MousePressed{MouseButton::left, place_of(session, test::sheet_pixel(options_, 8, 15))});
  session.handle(MouseMoved{{320, 5000}});
  play(session, 60);
  session.handle(KeyPressed{Key::step});
  EXPECT_LT(session.measures().stretch.max, 1.5);
}

TEST_F(SessionTest, a_pinned_point_comes_back_when_it_is_let_go) {
  Session session(setup_, kSize);
  const uint32_t pixel = test::sheet_pixel(options_, 8, 0);
  const Vec3 pinned = session.positions(0)[pixel];
  const Vec2 from = place_of(session, pixel);
  session.handle(MousePressed{MouseButton::left, from});
  session.handle(MouseMoved{{from.x, from.y - 30}});
  play(session, 20);
  EXPECT_GT(length(session.positions(0)[pixel] - pinned), 0.005F);
  session.handle(KeyPressed{Key::cancel});
  play(session, 5);
  expect_near(session.positions(0)[pixel], pinned, 1e-4F);
}

TEST_F(SessionTest, knows_the_pins_of_the_scene) {
  Session session(setup_, kSize);
  EXPECT_THAT(session.simulation().held_pixels(0), testing::SizeIs(16));
  EXPECT_THAT(session.simulation().held_pixels(0), testing::Contains(test::sheet_pixel(options_, 3, 0)));
  setup_.scene.cloths[0].pins[0].from = 0.1;
  setup_.scene.cloths[0].pins[0].until = 0.2;
  Session later(setup_, kSize);
  EXPECT_THAT(later.simulation().held_pixels(0), IsEmpty());
  play(later, 9);
  EXPECT_THAT(later.simulation().held_pixels(0), testing::SizeIs(16));
  play(later, 9);
  EXPECT_THAT(later.simulation().held_pixels(0), IsEmpty());
  EXPECT_THROW(later.simulation().set_hand(1, {}), Error);
}

TEST_F(SessionTest, a_line_cuts_the_cloth_in_two) {
  Session session(setup_, kSize);
  const auto before = session.asset(0);
  const Vec2 left = place_of(session, test::sheet_pixel(options_, 0, 7)),
             right = place_of(session, test::sheet_pixel(options_, 15, 7));
  session.handle(MousePressed{MouseButton::left, {left.x - 20, left.y + 4}, false, true});
  session.handle(MouseMoved{{320, left.y}});
  EXPECT_TRUE(session.cut_line());
  session.handle(MouseReleased{MouseButton::left, {right.x + 20, right.y + 4}});
  EXPECT_FALSE(session.cut_line());
  EXPECT_NE(session.asset(0), before);
  EXPECT_EQ(session.stage().cloths[0].asset, session.asset(0));
  EXPECT_THAT(session.note(), HasSubstr("cut"));
  play(session, 40);
  EXPECT_LT(session.positions(0)[test::sheet_pixel(options_, 8, 15)].y, 0.5F);  // fell
  EXPECT_GT(session.positions(0)[test::sheet_pixel(options_, 8, 3)].y, 2);      // hangs

  session.restart();
  EXPECT_EQ(session.stage().cloths[0].asset->spring_mask, before->spring_mask);
}

TEST_F(SessionTest, the_key_for_cutting_turns_the_left_button_into_a_knife_until_it_is_put_away) {
  Session session(setup_, kSize);
  session.handle(KeyPressed{Key::cut});
  session.handle(MousePressed{MouseButton::left, {320, 240}});
  EXPECT_TRUE(session.cut_line());
  session.handle(KeyPressed{Key::cancel});
  session.handle(MouseReleased{MouseButton::left, {10, 240}});
  EXPECT_THAT(session.note(), IsEmpty());
  session.handle(MousePressed{MouseButton::left, place_of(session, test::sheet_pixel(options_, 8, 8))});
  EXPECT_TRUE(session.hand());
}

TEST_F(SessionTest, beside_the_cloth_the_mouse_moves_the_camera) {
  Session session(setup_, kSize);
  const Camera start = session.camera();
  session.handle(MousePressed{MouseButton::left, {3, 3}});
  session.handle(MouseMoved{{103, 3}});
  session.handle(MouseReleased{MouseButton::left, {103, 3}});
  EXPECT_GT(length(session.camera().eye - start.eye), 0.1F);
  expect_near(session.camera().target, start.target, 1e-5F);
  session.handle(MousePressed{MouseButton::middle, {100, 100}});
  session.handle(MousePressed{MouseButton::left, {100, 100}});  // a second button changes nothing
  session.handle(MouseMoved{{150, 100}});
  EXPECT_GT(length(session.camera().target - start.target), 0.01F);
  session.handle(MouseReleased{MouseButton::left, {150, 100}});
  session.handle(MouseReleased{MouseButton::middle, {150, 100}});
  session.handle(KeyPressed{Key::frame_all});
  EXPECT_LT(length(session.camera().target - start.target), 0.3F);
}

TEST_F(SessionTest, forces_and_substeps_change_while_it_plays) {
  Session session(setup_, kSize);
  session.set_gravity({0, 0, 0});
  play(session, 10);
  EXPECT_LT(std::abs(session.positions(0)[test::sheet_pixel(options_, 8, 15)].y - 1.5F), 1e-3F);
  session.set_wind({.velocity = {0, 0, 8}});
  session.set_substeps(4);
  play(session, 20);
  EXPECT_GT(session.positions(0)[test::sheet_pixel(options_, 8, 15)].z, 0.02F);
  session.restart();  // they stay
  EXPECT_EQ(session.scene().substeps, 4U);
  EXPECT_EQ(session.wind().velocity.z, 8);
}

TEST_F(SessionTest, wind_that_is_set_goes_before_the_keys_of_the_scene) {
  setup_.scene.wind = Wind{};
  setup_.scene.wind_motion = {{0, {0, 0, 0}, 0}, {1, {0, 0, 6}, 0}};
  Session session(setup_, kSize);
  play(session, 30);
  EXPECT_NEAR(session.wind().velocity.z, 3, 0.3);
  session.set_wind({.velocity = {0, 0, -1}});
  play(session, 5);
  EXPECT_EQ(session.wind().velocity.z, -1);
  session.restart();
  EXPECT_EQ(session.wind().velocity.z, -1);
}

// Sliders of the panel: what is set goes before the keys of the scene, and stays when it begins anew.
TEST_F(SessionTest, a_material_that_is_set_stays) {
  Material heavy;
  heavy.areal_density = 2;
  setup_.scene.cloths[0].material_motion = {{0, {}}, {1, find_material_preset("denim")->material}};
  Session session(setup_, kSize);
  play(session, 5);
  EXPECT_NE(session.simulation().solver().material(0).areal_density, Material{}.areal_density);
  session.set_material(0, heavy);
  play(session, 5);
  EXPECT_TRUE(session.simulation().solver().material(0) == heavy);
  session.restart();
  play(session, 5);
  EXPECT_TRUE(session.simulation().solver().material(0) == heavy);
}

TEST_F(SessionTest, a_fabric_that_is_set_stays) {
  Material heavy;
  heavy.areal_density = 2;
  setup_.scene.cloths[0].fabrics = {{.where = WhereTop{1}},
                                    {.where = WhereTop{0.5F}, .material_motion = {{0, {}}, {1, heavy}}}};
  Session session(setup_, kSize);
  play(session, 5);
  EXPECT_NE(session.simulation().solver().fabric(0, 1).areal_density, Material{}.areal_density);
  session.set_fabric(0, 1, heavy);
  play(session, 5);
  EXPECT_TRUE(session.simulation().solver().fabric(0, 1) == heavy);
  session.restart();
  play(session, 5);
  EXPECT_TRUE(session.simulation().solver().fabric(0, 1) == heavy);
  EXPECT_TRUE(session.simulation().solver().fabric(0, 0) == Material{});
}

TEST_F(SessionTest, goes_along_with_a_garment_that_nothing_holds) {
  setup_.scene.cloths[0].pins.clear();
  setup_.scene.colliders.clear();
  Session session(setup_, kSize);
  const Vec3 start = session.camera().target;
  play(session, 60);
  EXPECT_LT(session.camera().target.y, start.y - 2);
  expect_near(session.subject().center(), session.camera().target, 0.05F);
  session.restart();
  expect_near(session.camera().target, start, 1e-3F);
}

TEST_F(SessionTest, stays_alive_when_the_cloth_flies_apart) {
  Session session(setup_, kSize);
  const std::vector<Vec3> position = session.positions(0);
  std::vector<Vec3> wild(position.size());
  for (size_t i = 0; i < wild.size(); ++i) wild[i] = (i % 2 == 0 ? 1.F : -1.F) * Vec3{1e6F, 1e6F, 1e6F};
  session.simulation().solver().write_state(0, position, wild);
  play(session, 30);
  session.frame_all();
  EXPECT_TRUE(is_finite(session.camera().eye));
  session.handle(MousePressed{MouseButton::left, {320, 240}});
  session.handle(MouseMoved{{100, 100}});
  play(session, 5);
  session.handle(MouseReleased{MouseButton::left, {100, 100}});
  session.handle(MousePressed{MouseButton::left, {0, 240}, false, true});
  session.handle(MouseReleased{MouseButton::left, {640, 240}});
  session.restart();
  EXPECT_LT(session.positions(0)[test::sheet_pixel(options_, 8, 8)].y, 3);
}

TEST_F(SessionTest, keys_switch_what_is_shown) {
  Session session(setup_, kSize);
  session.handle(KeyPressed{Key::show_strain});
  EXPECT_EQ(session.display().show, Show::strain);
  const Display before = session.display();
  session.handle(std::array<InputEvent, 4>{KeyPressed{Key::springs}, KeyPressed{Key::pins}, KeyPressed{Key::colliders},
                                           KeyPressed{Key::panel}});
  EXPECT_NE(session.display().springs, before.springs);
  EXPECT_NE(session.display().pins, before.pins);
  EXPECT_NE(session.display().colliders, before.colliders);
  EXPECT_NE(session.display().panel, before.panel);
}

}  // namespace
}  // namespace geocloth::view
