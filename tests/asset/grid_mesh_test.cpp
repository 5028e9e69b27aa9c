// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that is simulated, seen as a mesh: however a cloth is cut into charts, welding gives it back.
#include "geocloth/asset/grid_mesh.h"

#include <sstream>

#include <gtest/gtest.h>

#include "support/make_sheet.h"

namespace geocloth {
namespace {

using test::make_sheet;

TEST(GridMesh, ACutSheetWeldsToADisk) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 7, .charts_x = 2, .charts_y = 2});
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  const Topology t = measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
  EXPECT_EQ(mesh.position.size(), 63U);
  EXPECT_EQ(t.components, 1U);
  EXPECT_EQ(t.boundary_loops, 1U);
  EXPECT_EQ(t.euler_characteristic, 1);
  EXPECT_EQ(t.inconsistent_edges, 0U);
}

TEST(GridMesh, UnweldedChartsStayApart) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 7, .charts_x = 2, .charts_y = 2});
  const GridMesh mesh = unwelded_grid_mesh(asset, asset.rest_position);
  const Topology t = measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
  EXPECT_EQ(t.components, 4U);
  EXPECT_EQ(mesh.position.size(), count_valid_pixels(asset));
  for (std::size_t i = 0; i < mesh.pixel.size(); ++i) {
    EXPECT_EQ(mesh.position[i], asset.rest_position[mesh.pixel[i]]);
  }
}

TEST(GridMesh, ATubeWeldsToAnAnnulus) {
  const ClothAsset asset = test::make_tube({.nx = 12, .ny = 5});
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  const Topology t = measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
  EXPECT_EQ(t.boundary_loops, 2U);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_TRUE(t.orientable);
}

TEST(GridMesh, BothDiagonalsCoverTheCell) {
  ClothAsset asset = make_sheet({.nx = 2, .ny = 2});
  for (const bool left : {false, true}) {
    asset.cell[0] = static_cast<uint8_t>(kCellFirst | kCellSecond | (left ? kCellDiagonalLeft : 0));
    float area = 0;
    for (const Triangle& t : pixel_triangles(asset)) {
      const Vec3 n = cross(asset.rest_position[t[1]] - asset.rest_position[t[0]],
                           asset.rest_position[t[2]] - asset.rest_position[t[0]]);
      EXPECT_GT(n.z, 0) << "counter-clockwise seen from the front";
      area += 0.5F * n.z;
    }
    EXPECT_FLOAT_EQ(area, 1);
  }
}

TEST(GridMesh, ObjTextGivesEveryFloatBack) {
  const ClothAsset asset = make_sheet({.nx = 4, .ny = 3, .width = 0.7F, .jitter = 0.3F});
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  std::istringstream text(to_obj(mesh, true));
  std::vector<Vec3> positions;
  std::size_t uvs = 0, faces = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "v") {
      Vec3 p;
      words >> p.x >> p.y >> p.z;
      positions.push_back(p);
    } else if (keyword == "vt") {
      ++uvs;
    } else if (keyword == "f") {
      ++faces;
    }
  }
  EXPECT_EQ(positions, mesh.position);
  EXPECT_EQ(uvs, mesh.uv.size());
  EXPECT_EQ(faces, mesh.triangle.size());
  EXPECT_EQ(to_obj(mesh, false).find("vt"), std::string::npos);
}

}  // namespace
}  // namespace geocloth
