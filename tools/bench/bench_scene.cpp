// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes that are measured. Sheets are those of the NvCloth measurements that geocloth compares itself with: N x N
// points 0.01 m apart, held by their top row, all families of springs projected fully, attachments, no damping. Crowd,
// garment, walk, body and heap are made of the default material.
#include "bench/bench_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/solver/scene.h"
#include "meshes/mesh_file.h"
#include "render/solid_mesh.h"
#include "support/make_sheet.h"

namespace geocloth {
namespace {

constexpr float kSpacing = 0.01F;       // [m]
constexpr float kGarmentSide = 0.882F;  // [m] the garment of N x N points has this many Nths from one to the next
constexpr float kMaxStretch = 0.001F;   // of the attachments
constexpr uint32_t kCrowd = 32;

using SheetPtr = std::shared_ptr<const ClothAsset>;

SheetPtr make_sheet(uint32_t points, bool horizontal, float spacing = kSpacing) {
  const float side = spacing * static_cast<float>(points - 1);
  return std::make_shared<const ClothAsset>(
      test::make_sheet({.nx = points, .ny = points, .width = side, .height = side, .horizontal = horizontal}));
}

Material attached() {
  Material material;
  material.damping = 0;
  material.max_stretch = kMaxStretch;
  return material;
}

/// Every projection removes all of its spring's error, as NvCloth's do at stiffness 1.
Material sheet_material() {
  Material material = attached();
  material.stiffness = 1;
  material.bend_stiffness = 1;
  return material;
}

std::vector<Pin> hold(const ClothDesc& cloth, const std::vector<uint32_t>& pixels) {
  std::vector<Pin> pins;
  pins.reserve(pixels.size());
  for (const uint32_t pixel : pixels) {
    pins.push_back({pixel, apply(cloth.transform, cloth.asset->rest_position[pixel])});
  }
  return pins;
}

std::vector<Pin> hold_group(const ClothDesc& cloth, std::string_view name) {
  std::vector<uint32_t> pixels;
  for (const ClothAsset::VertexGroup& group : cloth.asset->vertex_groups) {
    if (group.name != name) continue;
    for (const uint32_t vertex : group.source_vertex) pixels.push_back(cloth.asset->binding[vertex].pixel[0]);
  }
  return hold(cloth, pixels);
}

/// Vertical at rest, nothing to meet: throughput without contact.
BenchScene make_hang(uint32_t size) {
  const ClothDesc cloth{make_sheet(size, false), sheet_material(), {}};
  return {{cloth}, {hold_group(cloth, "top")}, {}};
}

/// Starts level and swings down about its pinned edge onto a ball that pokes through the plane where it would hang.
BenchScene make_swing(uint32_t size) {
  const ClothDesc cloth{make_sheet(size, true), sheet_material(), {}};
  const float side = kSpacing * static_cast<float>(size - 1);
  const Sphere ball{{0, -0.55F * side, -0.5F * side}, 0.15F * side};
  return {{cloth}, {hold_group(cloth, "top")}, {{"ball", ball, 0.3F, {}}}};
}

/// Zeller's work in a frame: structural and shear springs that are projected fully, in one relaxation step. That
/// carries 100 rows only when frames are short: with 1 ms the sheet is a quarter longer at the most, with 1/60 s twenty
/// times as long.
BenchScene make_zeller(uint32_t size) {
  Material material;
  material.stiffness = 1;
  material.verlet_damping = 0.99F;
  material.bend_warp = material.bend_weft = 0;
  const ClothDesc cloth{make_sheet(size, false), material, {}};
  return {{cloth}, {hold_group(cloth, "top")}, {}, nullptr, 1e-3};
}

/// Many small cloths in one solver.
BenchScene make_crowd(uint32_t size) {
  const SheetPtr asset = make_sheet(size, false);
  const float side = kSpacing * static_cast<float>(size);
  BenchScene scene;
  for (uint32_t i = 0; i < kCrowd; ++i) {
    ClothDesc cloth{asset, attached(), {}};
    cloth.transform.translate = {1.2F * side * (static_cast<float>(i) - 0.5F * kCrowd), 0, 0};
    scene.pins.push_back(hold_group(cloth, "top"));
    scene.cloths.push_back(std::move(cloth));
  }
  return scene;
}

/// One of the project's garments as panels of about size x size pixels.
SheetPtr make_panels(const std::string& name, uint32_t size) {
  const std::vector<meshes::ObjMesh> garments = meshes::make_garments();
  const auto garment = std::find_if(garments.begin(), garments.end(), [&](const auto& g) { return g.name == name; });
  if (garment == garments.end())
    throw Error(ErrorCode::verification, "bench: there is no garment " + name + " any more");
  TriangleMesh mesh;
  mesh.name = garment->name;
  mesh.position = garment->position;
  for (uint32_t f = 0; f < garment->face.size(); ++f) {
    const meshes::Face& face = garment->face[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      mesh.triangle.push_back({face[0], face[k - 1], face[k]});
      mesh.polygon.push_back(f);
    }
  }
  mesh.part = {{"cloth", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  mesh.material = {SourceMaterial{}};
  ConvertOptions options;
  options.flatten.resolution = size;
  return std::make_shared<const ClothAsset>(convert(mesh, options).asset);
}

/// What the garment's cloth costs in one square: its material, pins and a ball that pokes through the plane. Its points
/// are as far from each other, too: bends that are stiffer for that are swept there and back.
BenchScene make_drape(uint32_t size) {
  const float spacing = kGarmentSide / static_cast<float>(size);
  const ClothDesc cloth{make_sheet(size, false, spacing), attached(), {}};
  const float side = spacing * static_cast<float>(size - 1), radius = 0.3F * side;
  const Sphere ball{{0, -0.55F * side, -0.8F * radius}, radius};
  return {{cloth}, {hold_group(cloth, "top")}, {{"ball", ball, 0.3F, {}}}};
}

/// A T-shirt of two panels, held by its collar, with a ball inside: charts with free outlines and seams.
BenchScene make_garment(uint32_t size) {
  const ClothDesc cloth{make_panels("t_shirt", size), attached(), {}};
  Vec3 low = cloth.asset->source.position.front(), high = low;
  for (const Vec3& p : cloth.asset->source.position) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Sphere ball{0.5F * (low + high), 0.4F * (high.z - low.z)};
  return {{cloth},
          {hold(cloth, select_pixels(*cloth.asset, cloth.transform, WhereBoundary{}))},
          {{"ball", ball, 0.3F, {}}}};
}

/// A T-shirt that collides with itself and falls in a heap from a hand's breadth above the floor.
BenchScene make_heap(uint32_t size) {
  constexpr float kHeight = 0.1F;  // [m]
  ClothDesc cloth{make_panels("t_shirt", size), {}, {}};
  cloth.self_collision = SelfCollision{};
  cloth.transform.rotate = quat_from_euler_deg({20, 0, 15});
  float low = std::numeric_limits<float>::max();
  for (const Vec3& p : cloth.asset->source.position) low = std::min(low, apply(cloth.transform, p).y);
  cloth.transform.translate = {0, kHeight - low, 0};
  BenchScene scene{{cloth}, {{}}, {{"floor", Plane{}, 0.5F, {}}}};
  scene.falls = true;
  return scene;
}

/// Capsules of a body that walks along +z at 1.4 m/s from 0.3 s on, with a step of its legs in half a second.
std::vector<Collider> walker_at(double time) {
  constexpr float kSpeed = 1.4F, kSwing = 35;  // [m/s], [degrees]
  const auto walked = static_cast<float>(std::max(0.0, time - 0.3));
  std::vector<Collider> body;
  const auto add = [&](const char* name, const Capsule& capsule, float swing) {
    Collider& c = body.emplace_back(Collider{name, capsule, 0.3F, {}});
    c.pose.rotate = quat_from_euler_deg({kSwing * swing, 0, 0});  // about the upper end
    c.pose.translate = capsule.a - rotate(c.pose.rotate, capsule.a) + Vec3{0, 0, kSpeed * walked};
  };
  const float phase = std::sin(2 * std::numbers::pi_v<float> * walked);
  add("torso", {{0, 0.95F, 0}, {0, 1.28F, 0}, 0.12F, 0.1F}, 0);
  add("shoulders", {{-0.15F, 1.36F, 0}, {0.15F, 1.36F, 0}, 0.05F, 0.05F}, 0);
  add("neck", {{0, 1.36F, 0}, {0, 1.55F, 0}, 0.05F, 0.05F}, 0);
  for (const float side : {-1.F, 1.F}) {
    add("arm", {{0.16F * side, 1.36F, 0}, {0.4F * side, 1.16F, 0}, 0.045F, 0.03F}, 0);
    add("leg", {{0.08F * side, 0.9F, 0}, {0.1F * side, 0.05F, 0}, 0.075F, 0.045F}, side * phase);
  }
  return body;
}

/// The body that walks, of triangles: measured anew for every frame, which counts in its time.
std::vector<Collider> body_at(double time) {
  constexpr float kNodes = 0.0175F;  // [m] from one to the next: 120,000 to 350,000, as the legs swing
  const auto surface_at = [](double at) {
    TriangleSurface surface;
    for (const Collider& c : walker_at(at)) {
      const auto first = static_cast<uint32_t>(surface.position.size());
      const SolidMesh piece = solid_mesh(c.shape);
      for (const Vec3& p : piece.position) surface.position.push_back(apply(c.pose, p));
      for (const Triangle& t : piece.triangle) surface.triangle.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return surface;
  };
  const std::vector<Vec3> before = surface_at(time - 1.0 / 60).position;
  const MeshSolid solid{std::make_shared<const DistanceField>(make_deforming_field(surface_at(time), before, kNodes))};
  return {{"body", solid, 0.3F, {}}};
}

/// A dress on somebody who walks.
BenchScene make_walk(uint32_t size) {
  Material material;
  material.thickness = 0.0135F;
  ClothDesc cloth{make_panels("dress", size), material, {}};
  cloth.transform.translate = {0, 0.04F, 0};
  return {{cloth}, {{}}, walker_at(0), walker_at};
}
BenchScene make_body(uint32_t size) {
  BenchScene scene = make_walk(size);
  scene.colliders = body_at(0);
  scene.colliders_at = body_at;
  scene.stretch_after = 1;  // a body's frame takes long to make, and a dress goes on as it began
  return scene;
}

}  // namespace

const std::vector<BenchSceneKind>& bench_scene_kinds() {
  static const std::vector<BenchSceneKind> kinds{
      {"hang",
       "a sheet that hangs from its top row",
       {64, 100, 128, 256, 512, 1024},
       {64, 256},
       {1, 4, 8, 16, 30},
       {8},
       make_hang},
      {"swing",
       "a sheet that swings down onto a ball",
       {64, 100, 128, 256, 512, 1024},
       {100},
       {1, 4, 8, 16, 30},
       {8},
       make_swing},
      {"zeller",
       "structural and shear springs, one substep in frames of 1 ms",
       {64, 100, 256},
       {100},
       {1},
       {1},
       make_zeller},
      {"crowd", "32 sheets in one solver", {32, 64}, {32}, {8}, {8}, make_crowd},
      {"drape",
       "a square sheet of the garment's cloth before a ball, to compare the garment with",
       {64, 128, 256},
       {64},
       {4, 8, 16},
       {8},
       make_drape},
      {"garment", "a T-shirt of two panels", {64, 128, 256}, {64}, {4, 8, 16}, {8}, make_garment},
      {"walk", "a dress on capsules that walk", {64, 128}, {64}, {8, 16}, {8}, make_walk},
      {"body", "a dress on a body of triangles that walks", {64, 128}, {}, {8, 16}, {8}, make_body},
      {"heap", "a T-shirt that falls in a heap and collides with itself", {64, 128}, {64}, {8, 16}, {8}, make_heap},
  };
  return kinds;
}

}  // namespace geocloth
