// SPDX-License-Identifier: GPL-3.0-or-later
// The project's own meshes: garments that a tailor could sew, defects that are what their names say, and files in the
// repository that the program still makes byte for byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/topology.h"
#include "geocloth/parametrize/animated_mesh.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/parts.h"
#include "meshes/mesh_file.h"
#include "meshes/walker.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::meshes {
namespace {

std::vector<Triangle> triangles_of(const ObjMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const Face& face : mesh.face) {
    for (std::size_t k = 2; k < face.size(); ++k) triangles.push_back({face[0], face[k - 1], face[k]});
  }
  return triangles;
}

Topology topology_of(const std::vector<ObjMesh>& meshes, const std::string& name) {
  for (const ObjMesh& mesh : meshes) {
    if (mesh.name == name) return measure_topology(triangles_of(mesh), static_cast<uint32_t>(mesh.position.size()));
  }
  ADD_FAILURE() << "no mesh " << name;
  return {};
}

TEST(OwnMeshes, CommittedFilesAreWhatTheProgramMakes) {
  const std::string folder = GEOCLOTH_SOURCE_DIR "/meshes/";
  for (const ObjMesh& mesh : make_garments()) {
    EXPECT_TRUE(to_obj(mesh) == test::read_text(folder + "garments/" + mesh.name + ".obj")) << mesh.name;
  }
  for (const ObjMesh& mesh : make_defects()) {
    EXPECT_TRUE(to_obj(mesh) == test::read_text(folder + "defects/" + mesh.name + ".obj")) << mesh.name;
  }
}

TEST(OwnMeshes, TheCommittedBodyIsWhatTheProgramMakes) {
  const std::vector<std::byte> made = make_walker();
  const std::string text(reinterpret_cast<const char*>(made.data()), made.size());
  EXPECT_TRUE(text == test::read_text(GEOCLOTH_SOURCE_DIR "/meshes/bodies/walker.glb"));
}

// A stride that does not close would throw the cloth once a second.
TEST(OwnMeshes, TheBodysStrideCloses) {
  const AnimatedMesh walker(GEOCLOTH_SOURCE_DIR "/meshes/bodies/walker.glb", {.clip = "walk", .loop = true});
  EXPECT_EQ(select_parts(import_mesh(GEOCLOTH_SOURCE_DIR "/meshes/bodies/walker.glb"), "-head").part.size(), 14U);
  const std::vector<Vec3> begin = walker.positions_at(0), almost = walker.positions_at(walker.duration() - 1e-4),
                          half = walker.positions_at(0.5 * walker.duration());
  float lowest = 1e9F, highest = -1e9F, farthest = 0;
  for (size_t i = 0; i < begin.size(); ++i) {
    EXPECT_LT(length(begin[i] - almost[i]), 1e-3F);
    farthest = std::max(farthest, length(begin[i] - half[i]));
    lowest = std::min(lowest, begin[i].y);
    highest = std::max(highest, begin[i].y);
  }
  EXPECT_GT(farthest, 0.3F);
  EXPECT_NEAR(lowest, 0, 0.03);
  EXPECT_NEAR(highest, 1.8, 0.05);
}

TEST(OwnMeshes, GarmentsAreCleanAndHaveTheirOpenings) {
  const std::vector<ObjMesh> garments = make_garments();
  const std::vector<std::pair<std::string, uint32_t>> openings{{"t_shirt", 4}, {"poncho", 2}, {"cape", 1},
                                                               {"skirt", 2},   {"sleeve", 2}, {"dress", 4},
                                                               {"flag", 1},    {"cushion", 0}};
  for (const auto& [name, loops] : openings) {
    const Topology found = topology_of(garments, name);
    EXPECT_EQ(found.components, 1U) << name;
    EXPECT_EQ(found.boundary_loops, loops) << name;
    EXPECT_EQ(found.euler_characteristic, 2 - static_cast<int64_t>(loops)) << name;
    EXPECT_EQ(found.non_manifold_edges + found.bow_tie_vertices + found.inconsistent_edges, 0U) << name;
  }
}

TEST(OwnMeshes, ThePatternIsFourPanelsThatAreSewnAllAround) {
  const std::vector<ObjMesh> garments = make_garments();
  const Topology found = topology_of(garments, "dress_pattern");
  EXPECT_EQ(found.components, 4U);
  EXPECT_EQ(found.boundary_loops, 4U);
  for (const ObjMesh& mesh : garments) {
    if (mesh.name != "dress_pattern") {
      EXPECT_TRUE(mesh.line.empty()) << mesh.name;
      continue;
    }
    EXPECT_GT(mesh.line.size(), 100U);
    for (const auto& [a, b] : mesh.line) {
      const Point3 &p = mesh.position[a], &q = mesh.position[b];
      const bool is_waist = p[2] == q[2];  // else from the front to the back
      EXPECT_TRUE(is_waist || (p[0] == q[0] && p[1] == q[1])) << a << " " << b;
    }
  }
}

TEST(OwnMeshes, GarmentsHaveTextureCoordinatesInTheUnitSquare) {
  for (const ObjMesh& mesh : make_garments()) {
    ASSERT_EQ(mesh.face_uv.size(), mesh.face.size());
    for (const Point2& uv : mesh.uv) EXPECT_THAT(uv, testing::Each(testing::AllOf(testing::Ge(0), testing::Le(1))));
  }
}

TEST(OwnMeshes, EveryDefectIsWhatItsNameSays) {
  const std::vector<ObjMesh> defects = make_defects();
  EXPECT_EQ(topology_of(defects, "non_manifold_edge").non_manifold_edges, 4U);
  EXPECT_EQ(topology_of(defects, "bow_tie").bow_tie_vertices, 1U);
  EXPECT_EQ(topology_of(defects, "t_junction").bow_tie_vertices, 2U);     // the ends of the slit
  EXPECT_EQ(topology_of(defects, "t_junction").euler_characteristic, 0);  // which is closed in space
  EXPECT_GT(topology_of(defects, "duplicate_face").non_manifold_edges, 0U);
  EXPECT_FALSE(topology_of(defects, "moebius").orientable);
  EXPECT_EQ(topology_of(defects, "unwelded").components, 32U);
  EXPECT_EQ(topology_of(defects, "pocket").non_manifold_edges, 8U);
  EXPECT_EQ(topology_of(defects, "closed_sphere").euler_characteristic, 2);
  EXPECT_EQ(topology_of(defects, "closed_sphere").boundary_loops, 0U);
  EXPECT_EQ(topology_of(defects, "torus").euler_characteristic, 0);
  EXPECT_EQ(topology_of(defects, "torus").boundary_loops, 0U);
  EXPECT_EQ(topology_of(defects, "opposite_orientations").inconsistent_edges, 4U);
  EXPECT_TRUE(topology_of(defects, "opposite_orientations").orientable);
  EXPECT_EQ(topology_of(defects, "single_triangle").faces, 1U);
}

}  // namespace
}  // namespace geocloth::meshes
