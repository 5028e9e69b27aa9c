// SPDX-License-Identifier: GPL-3.0-or-later
// The off-screen renderer: what a picture must show, and that the validation layers have nothing to say about it.
#include <cmath>
#include <cstdlib>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "render/camera.h"
#include "render/render_options.h"
#include "render/renderer.h"
#include "render/solid_mesh.h"
#include "support/make_sheet.h"

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

struct Stage {
  std::shared_ptr<const ClothAsset> asset;
  std::vector<Vec3> position, normal;
  RenderScene scene;

  explicit Stage(ClothAsset cloth) : asset(std::make_shared<const ClothAsset>(std::move(cloth))) {
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
    const Collider collider{.name = "c", .shape = shapes[s], .friction = 0, .pose = {}};
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

class Render : public testing::Test {
 protected:
  // A device that can draw is there wherever the tests run (lavapipe); the layers watch every call.
  void SetUp() override { setenv("GEOCLOTH_VULKAN_VALIDATION", "1", 1); }

  Picture draw(const Stage& stage, const RenderOptions& options, std::span<const Collider> colliders = {}) {
    Renderer renderer(stage.scene, options);
    const ClothState state = stage.state();
    Picture picture = renderer.render(colliders, {&state, 1});
    EXPECT_THAT(renderer.validation_messages(), IsEmpty());
    return picture;
  }
};

TEST_F(Render, every_way_of_showing_gives_another_picture) {
  const Stage stage(test::make_sheet({.nx = 24, .ny = 24, .charts_x = 2, .charts_y = 2}));
  std::vector<Picture> pictures;
  for (const auto& [name, show] : kShowNames) {
    pictures.push_back(draw(stage, small(show)));
    write_png(pictures.back(), std::string(GEOCLOTH_BINARY_DIR) + "/test_output/show_" + name + ".png");
  }
  for (size_t i = 0; i < pictures.size(); ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_GT(difference(pictures[i], pictures[j]), 0.02) << i << " " << j;
}

TEST_F(Render, the_same_state_gives_the_same_bits) {
  const Stage stage(test::make_tube({}));
  EXPECT_EQ(draw(stage, small()).pixel, draw(stage, small()).pixel);
}

}  // namespace
}  // namespace geocloth
