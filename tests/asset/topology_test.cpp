// SPDX-License-Identifier: GPL-3.0-or-later
// The counts that decide whether a garment came through a conversion whole: known surfaces have known numbers.
#include "geocloth/asset/topology.h"

#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

using Triangles = std::vector<Triangle>;

/// Triangles of an nu x nv grid of quads; a direction that wraps joins its ends, and `twist` joins them upside down.
Triangles grid(uint32_t nu, uint32_t nv, bool wrap_u, bool wrap_v, bool twist = false) {
  const uint32_t rows = wrap_v ? nv : nv + 1;
  const uint32_t columns = wrap_u ? nu : nu + 1;
  const auto vertex = [&](uint32_t i, uint32_t j) {
    if (twist && i >= columns) j = nv - j;
    return (j % rows) * columns + i % columns;
  };
  Triangles triangles;
  for (uint32_t j = 0; j < nv; ++j) {
    for (uint32_t i = 0; i < nu; ++i) {
      triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return triangles;
}

TEST(Topology, TetrahedronIsASphere) {
  const Topology t = measure_topology(Triangles{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}, 4);
  EXPECT_EQ(t.vertices, 4U);
  EXPECT_EQ(t.edges, 6U);
  EXPECT_EQ(t.faces, 4U);
  EXPECT_EQ(t.components, 1U);
  EXPECT_EQ(t.boundary_loops, 0U);
  EXPECT_EQ(t.euler_characteristic, 2);
  EXPECT_EQ(t.non_manifold_edges, 0U);
  EXPECT_EQ(t.bow_tie_vertices, 0U);
  EXPECT_EQ(t.inconsistent_edges, 0U);
  EXPECT_TRUE(t.orientable);
}

TEST(Topology, TorusHasEulerCharacteristicZeroAndNoBoundary) {
  const Topology t = measure_topology(grid(5, 4, true, true), 20);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_EQ(t.boundary_loops, 0U);
  EXPECT_EQ(t.components, 1U);
  EXPECT_TRUE(t.orientable);
}

TEST(Topology, MoebiusBandHasOneLoopAndIsNotOrientable) {
  const Topology t = measure_topology(grid(6, 1, true, false, true), 12);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_EQ(t.boundary_loops, 1U);
  EXPECT_FALSE(t.orientable);
  EXPECT_EQ(t.inconsistent_edges, 1U);
}

TEST(Topology, AnnulusHasTwoLoops) {
  const Topology t = measure_topology(grid(6, 2, true, false), 18);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_EQ(t.boundary_loops, 2U);
  EXPECT_TRUE(t.orientable);
}

TEST(Topology, AFlippedFaceIsInconsistentButOrientable) {
  Triangles triangles = grid(3, 3, false, false);
  std::swap(triangles[8][0], triangles[8][1]);
  const Topology t = measure_topology(triangles, 16);
  EXPECT_EQ(t.inconsistent_edges, 3U);
  EXPECT_TRUE(t.orientable);
}

TEST(Topology, ThreeFacesOnOneEdgeAreANonManifoldEdgeAndNoBowTie) {
  const Topology t = measure_topology(Triangles{{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}, 5);
  EXPECT_EQ(t.non_manifold_edges, 1U);
  EXPECT_EQ(t.bow_tie_vertices, 0U);
  EXPECT_EQ(t.boundary_loops, 1U);
  EXPECT_EQ(t.euler_characteristic, 1);
}

TEST(Topology, TwoFansAtAVertexAreABowTie) {
  const Topology t = measure_topology(Triangles{{0, 1, 2}, {0, 3, 4}}, 5);
  EXPECT_EQ(t.bow_tie_vertices, 1U);
  EXPECT_EQ(t.components, 1U);
  EXPECT_EQ(t.boundary_loops, 1U) << "the two outlines touch at the vertex";
  EXPECT_EQ(t.euler_characteristic, 1);
}

TEST(Topology, SeparatePartsAndUnusedVertices) {
  const Topology t = measure_topology(Triangles{{0, 1, 2}, {7, 8, 9}}, 12);
  EXPECT_EQ(t.vertices, 6U);
  EXPECT_EQ(t.components, 2U);
  EXPECT_EQ(t.boundary_loops, 2U);
  EXPECT_EQ(t.euler_characteristic, 2);
}

TEST(Topology, NothingIsNothing) {
  const Topology t = measure_topology({}, 0);
  EXPECT_EQ(t.components, 0U);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_TRUE(t.orientable);
}

TEST(Topology, RefusesIndicesOutOfRangeAndRepeatedOnes) {
  EXPECT_THROW(static_cast<void>(measure_topology(Triangles{{0, 1, 3}}, 3)), Error);
  EXPECT_THROW(static_cast<void>(measure_topology(Triangles{{0, 1, 1}}, 3)), Error);
}

}  // namespace
}  // namespace geocloth
