// SPDX-License-Identifier: GPL-3.0-or-later
// The off-screen renderer: what a picture must show, and that the validation layers have nothing to say about it.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/solver/vulkan_interop.h"
#include "render/camera.h"
#include "render/playback.h"
#include "render/render_options.h"
#include "render/renderer.h"
#include "render/solid_mesh.h"
#include "support/make_sheet.h"
#include "support/vulkan_test.h"

namespace geocloth {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Two pictures differ at this share of their pixels.
double difference(const Picture& a, const Picture& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.pixel.size(); ++i) count += a.pixel[i] == b.pixel[i] ? 0U : 1U;
  return static_cast<double>(count) / static_cast<double>(a.pixel.size());
}

bool is_blue(const Color& color) {
  return color.b > color.r + 40;
}

struct Stage {
  std::shared_ptr<const ClothAsset> asset;
  std::vector<Vec3> position, normal;
  RenderScene scene;

  /// The cloth in strong blue, which nothing else in a picture is.
  explicit Stage(ClothAsset cloth) {
    for (SourceMaterial& material : cloth.source.material)
      if (!material.base_color_image) material.base_color = {0.05F, 0.15F, 0.9F, 1};
    asset = std::make_shared<const ClothAsset>(std::move(cloth));
    position = asset->rest_position;
    compute_normals(*asset, position, normal);
    scene.cloths = {make_render_cloth(asset)};
    scene.subject = bounds_of(asset->source.position);
  }
  [[nodiscard]] ClothState state() const { return {position, normal}; }
};

RenderOptions small(Show show = Show::cloth) {
  return {.size = {320, 240}, .show = show, .camera = OrbitCamera{}, .device = {}};
}

TEST(Camera, frames_every_corner_of_the_subject) {
  Bounds box;
  box.include(Vec3{-0.3F, 0.9F, -0.1F});
  box.include(Vec3{0.4F, 1.6F, 0.2F});
  for (const float azimuth : {0.F, 30.F, 90.F, 200.F})
    for (const float elevation : {-60.F, 0.F, 12.F, 90.F}) {
      const Camera camera = place_camera(OrbitCamera{azimuth, elevation, std::nullopt}, box, 16.F / 9);
      const Matrix4 m =
          perspective(camera.field_of_view_deg, 16.F / 9, 0.01F, 100) * look_at(camera.eye, camera.target);
      float reach = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                     (corner & 4) != 0 ? box.high.z : box.low.z};
        const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
        const float x = (m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12]) / w;
        const float y = (m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13]) / w;
        reach = std::max({reach, std::abs(x), std::abs(y)});
      }
      EXPECT_LT(reach, 1) << azimuth << " " << elevation;
      EXPECT_GT(reach, 0.75F) << azimuth << " " << elevation;
    }
}

TEST(Camera, reads_every_form_and_refuses_the_rest) {
  EXPECT_EQ(std::get<OrbitCamera>(parse_camera("45,10")).azimuth_deg, 45);
  EXPECT_EQ(*std::get<OrbitCamera>(parse_camera("45,10,2.5")).distance, 2.5F);
  EXPECT_EQ(std::get<Camera>(parse_camera("1,2,3,0,1,0")).eye, (Vec3{1, 2, 3}));
  for (const char* bad : {"", "1", "1,2,", "1,2,-3", "1,2,3,4", "a,b", "1,2,3,1,2,3", "nan,1", "1;2", "1,2 "})
    EXPECT_THAT(message_of([&] { static_cast<void>(parse_camera(bad)); }), HasSubstr("azimuth")) << bad;
}

TEST(PictureSize, is_checked) {
  EXPECT_EQ(parse_size("640x480").height, 480U);
  for (const char* bad : {"", "640", "640x", "x480", "640x480x", "8x8", "9999x100", "-1x20", "640X480"})
    EXPECT_THROW(static_cast<void>(parse_size(bad)), Error) << bad;
}

TEST(SolidMesh, lies_on_the_collider_and_faces_outwards) {
  const Quat turn = quat_from_euler_deg({20, 40, 60});
  const std::vector<ColliderShape> shapes{Sphere{{1, 2, 3}, 0.5F},
                                          Capsule{{0, 0, 0}, {0.3F, 1, 0.2F}, 0.3F, 0.1F},
                                          Capsule{{0, 0, 0}, {0, 0, 0}, 0.3F, 0.1F},
                                          Capsule{{0, 0, 0}, {0, 0.1F, 0}, 0.1F, 0.4F},
                                          Box{{1, 0, 0}, {0.1F, 0.2F, 0.3F}, turn},
                                          Ellipsoid{{0, 1, 0}, {0.1F, 0.5F, 0.3F}, turn}};
  for (size_t s = 0; s < shapes.size(); ++s) {
    const Collider collider{.name = "c", .shape = shapes[s], .friction = 0};
    const SolidMesh mesh = solid_mesh(collider.shape);
    ASSERT_FALSE(mesh.triangle.empty());
    for (size_t i = 0; i < mesh.position.size(); ++i) {
      EXPECT_NEAR(signed_distance(collider, mesh.position[i]), 0, 2e-5) << s;
      EXPECT_GT(signed_distance(collider, mesh.position[i] + mesh.normal[i] * 0.01F), 0.004F) << s;
    }
    for (const Triangle& t : mesh.triangle) {
      const Vec3 facet = cross(mesh.position[t[1]] - mesh.position[t[0]], mesh.position[t[2]] - mesh.position[t[0]]);
      EXPECT_GE(dot(facet, mesh.normal[t[0]] + mesh.normal[t[1]] + mesh.normal[t[2]]), -1e-9F) << s;
    }
  }
}

/// Every renderer is watched by the validation layers to its end.
class Render : public test::VulkanTest {
 protected:
  void TearDown() override {
    for (const auto& log : logs_) EXPECT_THAT(log->messages(), IsEmpty());
    VulkanTest::TearDown();
  }

  Renderer make_renderer(const RenderScene& scene, const RenderOptions& options, Solver* solver = nullptr) {
    Renderer renderer(scene, options, solver);
    logs_.push_back(renderer.validation_log());
    return renderer;
  }

  Picture draw(const Stage& stage, const RenderOptions& options) {
    const ClothState state = stage.state();
    return make_renderer(stage.scene, options).render({}, {&state, 1});
  }

 private:
  std::vector<std::shared_ptr<const ValidationLog>> logs_;
};

TEST_F(Render, every_way_of_showing_gives_another_picture) {
  const Stage stage(test::make_sheet({.nx = 24, .ny = 24, .charts_x = 2, .charts_y = 2}));
  const std::string folder = std::string(GEOCLOTH_BINARY_DIR) + "/test_output";
  std::filesystem::create_directories(folder);
  std::vector<Picture> pictures;
  for (const auto& [name, show] : kShowNames) {
    pictures.push_back(draw(stage, small(show)));
    write_png(pictures.back(), folder + "/show_" + name + ".png");
  }
  for (size_t i = 0; i < pictures.size(); ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_GT(difference(pictures[i], pictures[j]), 0.02) << i << " " << j;
}

TEST_F(Render, the_same_state_gives_the_same_bits) {
  const Stage stage(test::make_tube({}));
  EXPECT_EQ(draw(stage, small()).pixel, draw(stage, small()).pixel);
}

TEST_F(Render, vertices_are_where_the_binding_says) {
  // The reference draws the very positions that evaluate_binding gives. Offsets and a bent state, so that every term
  // of the binding counts; the scale of the garment acts on its offsets.
  ClothAsset sheet = test::make_sheet({.nx = 14, .ny = 12, .charts_x = 2, .jitter = 0.3F});
  for (size_t i = 0; i < sheet.binding.size(); ++i) {
    const float f = static_cast<float>(i);
    sheet.binding[i].offset = {0.01F * std::sin(f), 0.01F * std::cos(f), 0.02F * std::sin(2 * f)};
  }
  Stage stage(sheet);
  const float scale = 1.5F;
  for (Vec3& p : stage.position) p = Vec3{p.x, p.y, 0.2F * std::sin(4 * p.x) + 0.1F * p.y * p.y} * scale;
  compute_normals(*stage.asset, stage.position, stage.normal);
  std::vector<Vec3> expected;
  evaluate_binding(*stage.asset, stage.position, stage.normal, expected, scale);
  stage.scene.cloths = {make_render_cloth(stage.asset, scale)};
  stage.scene.subject = bounds_of(expected);

  const Picture drawn = draw(stage, small());
  Playback reference = play_vertices({stage.asset->source}, {{expected}}, 60);
  const std::vector<PlayedCloth> state = reference.state(0);
  Renderer renderer = make_renderer(reference.scene, small());
  const ClothState states{state[0].position, state[0].normal};
  const Picture wanted = renderer.render({}, {&states, 1});
  // Normals come about differently, so colours may; the silhouette may not.
  const Picture empty = [&] {
    RenderScene nothing = reference.scene;
    nothing.cloths.clear();
    return make_renderer(nothing, small()).render({}, {});
  }();
  size_t covered = 0, differing = 0;
  for (size_t i = 0; i < wanted.pixel.size(); ++i) {
    const bool in_wanted = is_blue(wanted.pixel[i]), in_drawn = is_blue(drawn.pixel[i]);
    covered += in_wanted ? 1U : 0U;
    differing += in_wanted != in_drawn ? 1U : 0U;
  }
  EXPECT_GT(covered, 5000U);
  EXPECT_LT(differing, covered / 200);
  EXPECT_GT(difference(empty, drawn), 0.1);
}

TEST_F(Render, the_inner_side_is_darker_than_the_outer_one) {
  const Stage stage(test::make_sheet({.nx = 8, .ny = 8}));
  RenderOptions options = small();
  options.camera = OrbitCamera{0, 5, std::nullopt};
  const Color outer = draw(stage, options).at(160, 120);
  options.camera = OrbitCamera{180, 5, std::nullopt};
  const Color inner = draw(stage, options).at(160, 120);
  EXPECT_LT(inner.r + inner.g + inner.b, outer.r + outer.g + outer.b - 60);
}

TEST_F(Render, the_camera_leaves_a_border_round_the_garment) {
  const Stage stage(test::make_tube({.nx = 24, .ny = 16, .radius = 0.2F, .height = 0.5F, .center = {3, 7, -2}}));
  RenderOptions options = small();
  Renderer renderer = make_renderer(stage.scene, options);
  const ClothState state = stage.state();
  const Picture with = renderer.render({}, {&state, 1});
  size_t covered = 0;
  for (uint32_t y = 0; y < with.height; ++y)
    for (uint32_t x = 0; x < with.width; ++x) {
      const bool cloth = is_blue(with.at(x, y));
      covered += cloth ? 1U : 0U;
      const bool border = x < 4 || y < 4 || x + 4 >= with.width || y + 4 >= with.height;
      EXPECT_FALSE(cloth && border) << x << " " << y;
    }
  EXPECT_GT(covered, with.pixel.size() / 20);
}

TEST_F(Render, cloth_throws_a_shadow_on_the_ground) {
  const Stage stage(test::make_sheet({.nx = 8, .ny = 8, .horizontal = true}));
  RenderOptions options = small();
  options.camera = OrbitCamera{0, 40, std::nullopt};
  RenderScene scene = stage.scene;
  scene.ground_height = -0.4F;
  RenderScene nothing = scene;
  nothing.cloths.clear();
  const ClothState state = stage.state();
  const Picture with = make_renderer(scene, options).render({}, {&state, 1});
  const Picture without = make_renderer(nothing, options).render({}, {});
  size_t darker = 0;
  for (size_t i = 0; i < with.pixel.size(); ++i) {
    const Color a = with.pixel[i], b = without.pixel[i];
    const int drop = (b.r - a.r + b.g - a.g + b.b - a.b) / 3;
    // Grey stays grey in a shadow.
    darker += drop > 15 && std::abs((a.b - a.r) - (b.b - b.r)) < 10 ? 1U : 0U;
  }
  EXPECT_GT(darker, with.pixel.size() / 50);
}

TEST_F(Render, every_collider_is_drawn_where_it_is) {
  RenderScene scene;
  scene.subject.include(Vec3{-1, 0, -1});
  scene.subject.include(Vec3{1, 1, 1});
  const std::vector<ColliderShape> shapes{Sphere{{0, 0.5F, 0}, 0.3F}, Capsule{{0, 0.2F, 0}, {0, 0.8F, 0}, 0.3F, 0.2F},
                                          Box{{0, 0.5F, 0}, {0.3F, 0.2F, 0.3F}, {}},
                                          Ellipsoid{{0, 0.5F, 0}, {0.3F, 0.4F, 0.2F}, {}}};
  for (const ColliderShape& shape : shapes) {
    Collider collider{.name = "c", .shape = shape, .friction = 0};
    scene.colliders = {collider};
    Renderer renderer = make_renderer(scene, small());
    const Picture here = renderer.render({&collider, 1});
    collider.pose.translate = {0.6F, 0, 0};
    const Picture there = renderer.render({&collider, 1});
    EXPECT_NE(here.at(160, 120), there.at(160, 120));
  }
}

TEST_F(Render, a_texture_colours_the_garment) {
  ClothAsset sheet = test::make_sheet({.nx = 4, .ny = 4});
  const std::vector<std::byte> png = encode_png(Picture(2, 2, {200, 20, 20, 255}));
  const auto* bytes = reinterpret_cast<const uint8_t*>(png.data());
  sheet.source.image = {{"red", "image/png", {bytes, bytes + png.size()}}};
  sheet.source.uv.assign(sheet.source.position.size(), {0.5F, 0.5F});
  sheet.source.material = {SourceMaterial{}};
  sheet.source.material[0].base_color_image = 0;
  for (SourcePart& part : sheet.source.part) part.material = 0;
  const Color center = draw(Stage(sheet), small()).at(160, 120);
  EXPECT_GT(center.r, 2 * center.g);

  sheet.source.image[0].bytes.resize(20);  // what remains is drawn plain, and said
  const Stage broken(sheet);
  const Renderer renderer = make_renderer(broken.scene, small());
  EXPECT_THAT(renderer.warnings(), testing::ElementsAre(HasSubstr("red")));
}

// A heap of ten cloths of one asset was one blue lump.
TEST_F(Render, cloths_without_colours_are_told_apart) {
  ClothAsset sheet = test::make_sheet({.nx = 4, .ny = 4});
  sheet.source.material.clear();
  const Stage stage(sheet);
  RenderScene scene = stage.scene;
  scene.cloths.push_back(scene.cloths.front());
  std::vector<Vec3> hidden = stage.position;
  for (Vec3& p : hidden) p.z -= 5;
  const ClothState front = stage.state(), back{hidden, stage.normal};
  const std::array first{front, back}, second{back, front};
  Renderer renderer = make_renderer(scene, small());
  const Color a = renderer.render({}, first).at(160, 120), b = renderer.render({}, second).at(160, 120);
  EXPECT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 30);
}

TEST_F(Render, strain_shows_stretch_red_and_compression_blue) {
  for (const float factor : {1.06F, 0.94F}) {
    Stage stage(test::make_sheet({.nx = 12, .ny = 12}));
    for (Vec3& p : stage.position) p = p * factor;
    RenderOptions options = small(Show::strain);
    options.camera = OrbitCamera{0, 5, std::nullopt};
    const Color center = draw(stage, options).at(160, 120);
    EXPECT_EQ(center.r > center.b, factor > 1) << int{center.r} << " " << int{center.b};
  }
}

TEST_F(Render, refuses_a_state_of_another_size) {
  const Stage stage(test::make_sheet({}));
  Renderer renderer = make_renderer(stage.scene, small());
  EXPECT_THROW(static_cast<void>(renderer.render({}, {})), Error);
  const ClothState state{std::span(stage.position).first(3), stage.normal};
  EXPECT_THROW(static_cast<void>(renderer.render({}, {&state, 1})), Error);
}

TEST_F(Render, an_unknown_device_is_named) {
  RenderOptions options = small();
  options.device = "Voodoo 2";
  const Stage stage(test::make_sheet({}));
  EXPECT_THAT(message_of([&] { Renderer(stage.scene, options); }), HasSubstr("Voodoo 2"));
}

/// Both backends from the same state, one drawn from the solver's images, the other from what was read back.
TEST_F(Render, draws_from_the_images_of_a_solver_on_vulkan) {
  const Stage stage(test::make_sheet({.nx = 20, .ny = 20, .charts_x = 2, .center = {5, 9, -7}}));
  const ClothDesc cloth{stage.asset, {}, {}};
  SolverSettings settings;
  settings.substeps = 4;
  settings.backend = Backend::vulkan;
  Solver vulkan({&cloth, 1}, settings);
  watch(vulkan);
  settings.backend = Backend::cpu;
  Solver cpu({&cloth, 1}, settings);
  const std::vector<uint32_t>& top = stage.asset->splits.pixel;  // hangs by its seam
  std::vector<Pin> pins;
  for (const uint32_t pixel : top) pins.push_back({pixel, stage.asset->rest_position[pixel]});

  Renderer direct = make_renderer(stage.scene, small(), &vulkan);
  Renderer uploaded = make_renderer(stage.scene, small(), &cpu);
  EXPECT_TRUE(direct.draws_from_solver());
  EXPECT_FALSE(uploaded.draws_from_solver());
  for (Solver* solver : {&vulkan, &cpu}) solver->set_pins(0, pins);
  for (int frame = 0; frame < 4; ++frame) {
    std::vector<Vec3> position, normal;
    cpu.read_positions(0, position);
    cpu.read_normals(0, normal);
    const ClothState state{position, normal};
    EXPECT_LT(difference(direct.render({}), uploaded.render({}, {&state, 1})), 0.01) << frame;
    vulkan.step();
    cpu.step();
  }
}

}  // namespace
}  // namespace geocloth
