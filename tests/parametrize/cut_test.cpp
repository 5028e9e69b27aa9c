// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/cut.h"

#include <algorithm>
#include <functional>
#include <map>
#include <ostream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/parametrize/repair.h"
#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

/// Random ones are many and tiny: a process for each would take longer than its test.
struct SurfaceSet {
  std::string name;
  std::vector<test::NamedSurface> surfaces;
};
void PrintTo(const SurfaceSet& set, std::ostream* out) {
  *out << set.name;
}

class Cut : public ::testing::TestWithParam<SurfaceSet> {
 protected:
  static void for_each(const std::function<void(const CleanSurface& surface)>& check) {
    for (const test::NamedSurface& named : GetParam().surfaces) {
      SCOPED_TRACE(named.name);
      check(named.make());
    }
  }
};

std::vector<Triangle> over_points(const std::vector<Triangle>& triangle, const std::vector<uint32_t>& point) {
  std::vector<Triangle> result;
  for (const auto& [a, b, c] : triangle) result.push_back({point[a], point[b], point[c]});
  return result;
}

// Every part must be laid out in the plane as one piece without holes.
TEST_P(Cut, EveryComponentIsADisk) {
  for_each([](const CleanSurface& surface) {
    const CutSurface cut = cut_to_disks(surface);
    ASSERT_GE(cut.triangle.size(), surface.triangle.size());
    std::vector<std::vector<Triangle>> part(cut.component_count);
    for (size_t t = 0; t < cut.triangle.size(); ++t) part[cut.component[t]].push_back(cut.triangle[t]);
    for (const auto& triangles : part) {
      const Topology topology = measure_topology(triangles, static_cast<uint32_t>(cut.position.size()));
      EXPECT_EQ(topology.components, 1U);
      EXPECT_EQ(topology.boundary_loops, 1U);
      EXPECT_EQ(topology.euler_characteristic, 1);
      EXPECT_EQ(topology.bow_tie_vertices, 0U);
      EXPECT_EQ(topology.inconsistent_edges, 0U);
      EXPECT_TRUE(topology.orientable);
    }
  });
}

// The pieces sewn together again by their points are the surface we began with, split where cuts cross its edges.
TEST_P(Cut, PointsSewItTogetherAgain) {
  for_each([](const CleanSurface& surface) {
    const CutSurface cut = cut_to_disks(surface);
    const auto sewn = over_points(cut.triangle, cut.point);
    const auto whole = over_points(surface.triangle, surface.point);
    const Topology as_cut = measure_topology(sewn, cut.point_count);
    const Topology as_was = measure_topology(whole, surface.point_count);
    EXPECT_EQ(as_cut.components, as_was.components);
    EXPECT_EQ(as_cut.boundary_loops, as_was.boundary_loops);
    EXPECT_EQ(as_cut.euler_characteristic, as_was.euler_characteristic);
    EXPECT_EQ(as_cut.non_manifold_edges, as_was.non_manifold_edges);
    EXPECT_EQ(as_cut.orientable, as_was.orientable);
    for (size_t v = 0; v < cut.position.size(); ++v) {
      if (cut.clean_vertex[v] == kNone) {
        EXPECT_GE(cut.point[v], surface.point_count);
        continue;
      }
      EXPECT_EQ(cut.position[v], surface.position[cut.clean_vertex[v]]);
      EXPECT_EQ(cut.point[v], surface.point[cut.clean_vertex[v]]);
    }
  });
}

// Texture, parts and the binding of the source mesh are looked up by triangle: its pieces must make up the whole of it,
// in its plane and facing the same way.
TEST_P(Cut, PiecesOfATriangleMakeItUp) {
  for_each([](const CleanSurface& surface) {
    const CutSurface cut = cut_to_disks(surface);
    ASSERT_EQ(cut.clean_triangle.size(), cut.triangle.size());
    const auto normal = [](const std::vector<Point3>& position, const Triangle& t) {
      return cross(position[t[1]] - position[t[0]], position[t[2]] - position[t[0]]);
    };
    std::vector<Point3> sum(surface.triangle.size(), Point3{0, 0, 0});
    for (size_t t = 0; t < cut.triangle.size(); ++t) {
      const Point3 whole = normal(surface.position, surface.triangle[cut.clean_triangle[t]]);
      const Point3 piece = normal(cut.position, cut.triangle[t]);
      EXPECT_GT(dot(whole, piece), 0);
      sum[cut.clean_triangle[t]] = sum[cut.clean_triangle[t]] + piece;
    }
    for (size_t t = 0; t < sum.size(); ++t) {
      const Point3 whole = normal(surface.position, surface.triangle[t]);
      EXPECT_LT(length(whole - sum[t]), 1e-9 * length(whole));
    }
  });
}

// A tie in the middle of a chart could not be told to the solver: ties must lie on outlines.
TEST_P(Cut, TiesLieOnOutlines) {
  for_each([](const CleanSurface& surface) {
    const CutSurface cut = cut_to_disks(surface);
    std::vector<char> on_outline(cut.position.size(), 0);
    std::set<std::pair<uint32_t, uint32_t>> outline_edge;
    for (const Outline& outline : trace_outlines(cut)) {
      for (const OutlinePath& path : outline.path) {
        for (size_t i = 0; i + 1 < path.vertex.size(); ++i) {
          on_outline[path.vertex[i]] = on_outline[path.vertex[i + 1]] = 1;
          outline_edge.insert(std::minmax(path.vertex[i], path.vertex[i + 1]));
        }
      }
    }
    std::vector<uint32_t> copies(cut.point_count, 0);
    for (const uint32_t p : cut.point) ++copies[p];
    for (size_t v = 0; v < cut.point.size(); ++v) {
      EXPECT_TRUE(copies[cut.point[v]] == 1 || on_outline[v]) << "vertex " << v;
    }
    std::map<std::pair<uint32_t, uint32_t>, std::set<std::pair<uint32_t, uint32_t>>> edges_over;
    for (const Triangle& t : cut.triangle) {
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = t[i], b = t[(i + 1) % 3];
        edges_over[std::minmax(cut.point[a], cut.point[b])].insert(std::minmax(a, b));
      }
    }
    for (const auto& [points, edges] : edges_over) {
      if (edges.size() == 1) continue;
      for (const auto& edge : edges) EXPECT_TRUE(outline_edge.contains(edge));
    }
  });
}

// Both sides of a seam are sewn pixel by pixel: they must agree about its points, direction and length.
TEST_P(Cut, RunsOfASeamAgree) {
  for_each([](const CleanSurface& surface) {
    const CutSurface cut = cut_to_disks(surface);
    std::map<uint32_t, std::pair<std::vector<uint32_t>, double>> seam;
    size_t outline_edges = 0, border_edges = 0;
    for (const Outline& outline : trace_outlines(cut)) {
      ASSERT_FALSE(outline.path.empty());
      for (size_t i = 0; i < outline.path.size(); ++i) {
        const OutlinePath& path = outline.path[i];
        EXPECT_EQ(path.vertex.back(), outline.path[(i + 1) % outline.path.size()].vertex.front());
        std::vector<uint32_t> points;
        for (const uint32_t v : path.vertex) points.push_back(cut.point[v]);
        outline_edges += points.size() - 1;
        if (path.reversed) std::reverse(points.begin(), points.end());
        const auto& known = seam.try_emplace(path.seam, points, path.length).first->second;
        EXPECT_EQ(known.first, points);
        EXPECT_EQ(known.second, path.length);
      }
    }
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (const Triangle& t : cut.triangle) {
      for (size_t i = 0; i < 3; ++i) ++sides[std::minmax(t[i], t[(i + 1) % 3])];
    }
    for (const auto& [edge, count] : sides) border_edges += count == 1 ? 1 : 0;
    EXPECT_EQ(outline_edges, border_edges);
    std::map<uint32_t, std::set<uint32_t>> seams_through;  // inner points of seams
    for (const auto& [number, run] : seam) {
      for (size_t i = 1; i + 1 < run.first.size(); ++i) seams_through[run.first[i]].insert(number);
    }
    for (const auto& [point, numbers] : seams_through) EXPECT_EQ(numbers.size(), 1U) << "point " << point;
  });
}

TEST_P(Cut, IsDeterministic) {
  for_each([](const CleanSurface& surface) {
    const CutSurface a = cut_to_disks(surface), b = cut_to_disks(surface);
    EXPECT_EQ(a.triangle, b.triangle);
    EXPECT_EQ(a.clean_vertex, b.clean_vertex);
  });
}

std::vector<SurfaceSet> surfaces_one_by_one() {
  std::vector<SurfaceSet> sets;
  for (const test::NamedSurface& surface : test::surfaces_of_every_topology())
    sets.push_back({surface.name, {surface}});
  return sets;
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Cut, ::testing::ValuesIn(surfaces_one_by_one()),
                         [](const auto& test) { return test.param.name; });

/// What repair makes of the faces between full and empty cells of a random block, a few of them left out: handles, bow
/// ties, edges of four faces, holes and closed bags, all in one.
CleanSurface random_block(uint32_t seed) {
  constexpr uint32_t kCells = 5, kPoints = kCells + 1;
  std::mt19937 random(seed);
  TriangleMesh mesh;
  for (uint32_t i = 0; i < kPoints * kPoints * kPoints; ++i) {
    const auto shaken = [&](uint32_t at) { return at + 0.2 * static_cast<double>(random() % 1000) / 1000; };
    mesh.position.push_back({shaken(i % kPoints), shaken(i / kPoints % kPoints), shaken(i / kPoints / kPoints)});
  }
  std::vector<char> full(kCells * kCells * kCells);
  for (char& f : full) f = random() % 2 == 0 ? 1 : 0;
  const auto is_full = [&](const std::array<uint32_t, 3>& c) {
    const bool inside = c[0] < kCells && c[1] < kCells && c[2] < kCells;  // -1 is a large number
    return inside && full[c[0] + kCells * (c[1] + kCells * c[2])] != 0;
  };
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const std::array<uint32_t, 3> step{1, kPoints, kPoints * kPoints};
    const uint32_t right = step[(axis + 1) % 3], up = step[(axis + 2) % 3];
    for (uint32_t v = 0; v < mesh.position.size(); ++v) {
      const std::array<uint32_t, 3> after{v % kPoints, v / kPoints % kPoints, v / kPoints / kPoints};
      if (after[(axis + 1) % 3] == kCells || after[(axis + 2) % 3] == kCells) continue;
      std::array<uint32_t, 3> before = after;
      --before[axis];
      if (is_full(before) == is_full(after) || random() % 32 == 0) continue;
      mesh.triangle.push_back({v, v + right, v + right + up});
      mesh.triangle.push_back({v, v + right + up, v + up});
    }
  }
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
  mesh.part.push_back({"block", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  mesh.material.emplace_back();
  return repair_mesh(mesh).surface;
}

std::vector<test::NamedSurface> random_blocks() {
  std::vector<test::NamedSurface> blocks;
  for (uint32_t seed = 0; seed < 40; ++seed) {
    blocks.push_back({"block_" + std::to_string(seed), [seed] { return random_block(seed); }});
  }
  return blocks;
}

/// The least of closed surfaces, in all shapes: a cut of one edge has to grow to be an outline.
CleanSurface random_tetrahedron(uint32_t seed) {
  std::mt19937 random(seed);
  CleanSurface surface = test::tetrahedron();
  for (Point3& p : surface.position) {
    for (double& x : p) x += static_cast<double>(random() % 1000) / 500;
  }
  return surface;
}

std::vector<test::NamedSurface> random_tetrahedra() {
  std::vector<test::NamedSurface> result;
  for (uint32_t seed = 0; seed < 40; ++seed) {
    result.push_back({"tetrahedron_" + std::to_string(seed), [seed] { return random_tetrahedron(seed); }});
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(Random, Cut,
                         ::testing::Values(SurfaceSet{"tetrahedra", random_tetrahedra()},
                                           SurfaceSet{"blocks", random_blocks()}),
                         [](const auto& test) { return test.param.name; });

double cut_length(const CutSurface& cut) {
  std::map<uint32_t, int> runs;
  std::map<uint32_t, double> length;
  for (const Outline& outline : trace_outlines(cut)) {
    for (const OutlinePath& path : outline.path) {
      ++runs[path.seam];
      length[path.seam] = path.length;
    }
  }
  double sum = 0;
  for (const auto& [seam, count] : runs) sum += count > 1 ? length[seam] : 0;
  return sum;
}

// A serrated seam is longer than it need be and shows: a tube is cut along a straight line.
TEST(CutLength, TubeIsCutStraight) {
  EXPECT_NEAR(cut_length(cut_to_disks(test::cylinder(40, 21, 1, 2))), 2.0, 1e-9);
}

// The edges of a mesh rarely lead where a seam should: between the borders of a sheet with two holes the way is
// straight though every edge path is a staircase.
TEST(CutLength, SeamsRunStraightAcrossFaces) {
  // A flat ring of triangles, seen as a square with a square hole, turned against its own grid: rows are shifted by
  // half a cell, so that no edge runs across the ring.
  CleanSurface ring = test::disk(41, 41);
  for (size_t i = 0; i < ring.position.size(); ++i) {
    Point3& p = ring.position[i];
    p = {p[0] + 0.5 * p[1], p[1], p[2]};
  }
  std::vector<Triangle> kept;
  const double side = bounding_diagonal(ring.position);
  Point3 centre{0, 0, 0};
  for (const Point3& p : ring.position) centre = centre + p * (1.0 / static_cast<double>(ring.position.size()));
  for (const Triangle& t : ring.triangle) {
    const Point3 middle = (ring.position[t[0]] + ring.position[t[1]] + ring.position[t[2]]) * (1.0 / 3);
    if (distance(middle, centre) > 0.1 * side) kept.push_back(t);
  }
  ring.triangle = kept;
  ring.component.assign(kept.size(), 0);
  ring.source_triangle.assign(kept.size(), 0);
  const CutSurface cut = cut_to_disks(ring);
  for (const Outline& outline : trace_outlines(cut)) {
    for (const OutlinePath& path : outline.path) {
      const bool seam = std::count_if(outline.path.begin(), outline.path.end(),
                                      [&](const OutlinePath& p) { return p.seam == path.seam; }) == 2;
      if (!seam) continue;
      const double straight = distance(cut.position[path.vertex.front()], cut.position[path.vertex.back()]);
      EXPECT_LT(path.length, 1.01 * straight);
    }
  }
}

// A torus opens along one circle around the tube and one along it.
TEST(CutLength, TorusIsCutAlongTwoShortLoops) {
  const double length = cut_length(cut_to_disks(test::torus(24, 48)));
  EXPECT_LT(length, 6.283 + 6.283 + 1.0);
}

TEST(CutOptions, ExtraEdgesAreCut) {
  const CleanSurface surface = test::disk(9, 9);
  CutOptions options;
  options.extra_edges = {{40, 41}, {41, 42}, {42, 43}, {43, 44}};
  const CutSurface cut = cut_to_disks(surface, options);
  EXPECT_EQ(std::count(cut.clean_vertex.begin(), cut.clean_vertex.end(), 42U), 2);
}

TEST(CutOptions, AnEdgeThatDoesNotExistIsRefused) {
  CutOptions options;
  options.extra_edges = {{0, 80}};
  EXPECT_ANY_THROW((void)cut_to_disks(test::disk(9, 9), options));
}

}  // namespace
}  // namespace geocloth
