// SPDX-License-Identifier: GPL-3.0-or-later
// What a layout does with several ways to cut, and with seams that cannot be drawn as straight as they might be.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "cut/fold_loops.h"
#include "cut/straight_cuts.h"
#include "develop/chart.h"
#include "develop/close_slits.h"
#include "develop/develop.h"
#include "develop/embed_chart.h"
#include "develop/mixed_cut.h"
#include "develop/symmetric_dirichlet.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/parametrize/repair.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

/// Two tubes side by side, of which the second cannot be told from the first but by its place.
CleanSurface two_tubes() {
  CleanSurface both = test::cylinder(24, 13);
  const CleanSurface one = both;
  const auto vertices = static_cast<uint32_t>(one.position.size());
  for (const Point3& p : one.position) both.position.push_back({p[0] + 5, p[1], p[2]});
  for (const uint32_t p : one.point) both.point.push_back(p + one.point_count);
  for (const Triangle& t : one.triangle) both.triangle.push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  for (const uint32_t c : one.component) both.component.push_back(c + one.component_count);
  both.point_count *= 2;
  both.component_count *= 2;
  both.source_triangle.resize(both.triangle.size());
  return both;
}

std::vector<Chart> charts_of(const CutSurface& cut) {
  std::vector<Chart> charts;
  for (std::vector<uint32_t>& own : triangles_of_components(cut)) charts.push_back(extract_chart(cut, std::move(own)));
  return charts;
}

// A button that is carried has points in the surface but no triangles: read by their numbers they must not be past the
// end, nor be those of vertices that the cuts have put in.
TEST(MixedCut, PointsThatTheImageLeavesOutKeepTheirNumbers) {
  CleanSurface tubes = two_tubes();
  tubes.point_count += 3;
  const std::vector<CutSurface> cuts{cut_to_disks(tubes), cut_to_disks(tubes)};
  std::vector<Chart> charts{charts_of(cuts[0]).front(), charts_of(cuts[1]).back()};
  const CutSurface mixed = put_together(cuts, std::vector<size_t>{0, 1}, charts);
  EXPECT_GE(mixed.point_count, tubes.point_count);
  for (size_t v = 0; v < mixed.position.size(); ++v) {
    EXPECT_LT(mixed.point[v], mixed.point_count);
    const bool inserted = mixed.clean_vertex[v] == kNone;
    EXPECT_TRUE(!inserted || mixed.point[v] >= tubes.point_count) << v;
  }
}

// Vertices that straight cuts put on edges have numbers of their own in every cut: mixed up, seams would be sewn to
// places that have nothing to do with each other.
TEST(MixedCut, PartsOfTwoCutsMakeOneSurface) {
  const CleanSurface tubes = two_tubes();
  CutOptions from_elsewhere;
  for (uint32_t v = 5; v + 24 < tubes.position.size() / 2; v += 24) {
    for (const uint32_t tube : {0U, static_cast<uint32_t>(tubes.position.size() / 2)}) {
      from_elsewhere.extra_edges.push_back({tube + v, tube + v + 24});
    }
  }
  const std::vector<CutSurface> cuts{cut_to_disks(tubes), cut_to_disks(tubes, from_elsewhere)};
  std::vector<Chart> charts, second = charts_of(cuts[1]);
  charts.push_back(charts_of(cuts[0]).front());
  charts.push_back(second.back());
  const std::vector<Chart> before = charts;
  const CutSurface mixed = put_together(cuts, std::vector<size_t>{0, 1}, charts);

  ASSERT_EQ(mixed.triangle.size(), before[0].triangle.size() + before[1].triangle.size());
  EXPECT_EQ(mixed.component_count, 2U);
  std::map<uint32_t, Point3> place;  // per point
  for (size_t v = 0; v < mixed.position.size(); ++v) {
    EXPECT_LT(mixed.point[v], mixed.point_count);
    EXPECT_EQ(place.try_emplace(mixed.point[v], mixed.position[v]).first->second, mixed.position[v]);
  }
  for (size_t c = 0; c < charts.size(); ++c) {
    for (size_t t = 0; t < charts[c].triangle.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = charts[c].triangle[t][k];
        EXPECT_EQ(mixed.triangle[charts[c].global_triangle[t]][k], charts[c].cut_vertex[v]);
        EXPECT_EQ(mixed.position[charts[c].cut_vertex[v]], before[c].position[v]);
      }
    }
  }
  // Sewn up by points these are two tubes again: V - E + F = 0.
  std::set<std::array<uint32_t, 2>> edges;
  for (const Triangle& t : mixed.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mixed.point[t[k]], mixed.point[t[(k + 1) % 3]]});
      edges.insert({low, high});
    }
  }
  EXPECT_EQ(place.size() + mixed.triangle.size(), edges.size());
}

double seam_of(const DevelopedSurface& d) {
  double outline = 0, area = 0;
  for (const Chart& c : charts_of(d.cut)) {
    outline += outline_length(c);
    area += total_area(c);
  }
  return outline / 2 / std::sqrt(area);
}

// Left and right alike is worth little: nobody would want twice the seams for it.
TEST(CutChoice, AWishThatCostsMuchIsNotGranted) {
  const CleanSurface tubes = two_tubes();
  CutOptions needless;
  for (uint32_t v = 0; v < 24; ++v) needless.extra_edges.push_back({v + 6 * 24, (v + 1) % 24 + 6 * 24});
  const CutSurface plain = cut_to_disks(tubes), wished = cut_to_disks(tubes, needless);
  DevelopOptions options;
  options.straight_cuts = false;
  const std::vector<CutSurface> cuts{plain, wished};
  EXPECT_NEAR(seam_of(develop(cuts, options)), seam_of(develop(plain, options)), 1e-9);
}

/// Distance in steps of the grid between vertices of a sheet of 41 x 41.
int steps(uint32_t v, uint32_t w) {
  const auto apart = [](uint32_t a, uint32_t b) { return std::abs(static_cast<int>(a) - static_cast<int>(b)); };
  return std::max(apart(v % 41, w % 41), apart(v / 41, w / 41));
}

// Where a straight seam would leave out what its corner is for, it may still lose its serration.
TEST(StraightCuts, APathStaysAsNearAsItIsToldTo) {
  const CleanSurface sheet = test::disk(41, 41);
  std::vector<uint32_t> path;  // a staircase to the middle and back to the same side
  for (uint32_t k = 0; k <= 20; ++k) {
    path.push_back(k * 41 + k);
    if (k < 20) path.push_back(k * 41 + k + 1);
  }
  for (uint32_t k = 1; k <= 20; ++k) path.push_back((20 - k) * 41 + 20);
  const auto straightened = [&](uint32_t rings) {
    RefinedMesh mesh = make_refined_mesh(sheet, opposite_half_edges(sheet.triangle));
    const size_t half_edges = mesh.opposite.size(), vertices = mesh.position.size();
    CutLines lines{std::vector<char>(half_edges, 0), std::vector<char>(half_edges, 0), std::vector<char>(vertices, 0),
                   std::vector<uint32_t>(vertices, kNone)};
    std::set<std::array<uint32_t, 2>> on_path;
    for (size_t i = 1; i < path.size(); ++i) on_path.insert({path[i - 1], path[i]});
    for (uint32_t h = 0; h < half_edges; ++h) {
      const uint32_t a = tail(mesh.triangle, h), b = head(mesh.triangle, h);
      const bool border = mesh.opposite[h] == kNone;
      if (border || on_path.contains({a, b}) || on_path.contains({b, a})) lines.cut[h] = 1;
      if (border) lines.fixed[h] = 1;
    }
    for (const uint32_t v : path) lines.rings[v] = rings;
    straighten_cuts(mesh, lines);
    double length = 0;
    int farthest = 0;
    for (uint32_t h = 0; h < mesh.opposite.size(); ++h) {
      if (!lines.cut[h] || mesh.opposite[h] == kNone || h < mesh.opposite[h]) continue;
      const uint32_t a = tail(mesh.triangle, h), b = head(mesh.triangle, h);
      length += distance(mesh.position[a], mesh.position[b]);
      for (const uint32_t v : {a, b}) {
        const Point3& p = mesh.position[v];
        const auto column = static_cast<uint32_t>(std::lround(40 * p[0])),
                   row = static_cast<uint32_t>(std::lround(40 * p[1]));
        int nearest = 41;
        for (const uint32_t w : path) nearest = std::min(nearest, steps(row * 41 + column, w));
        farthest = std::max(farthest, nearest);
      }
    }
    return std::pair{length, farthest};
  };
  constexpr double kSerrated = 60.0 / 40;
  const auto [near, near_way] = straightened(2);
  const auto [free, free_way] = straightened(kNone);
  EXPECT_LE(near_way, 2);
  EXPECT_GT(free_way, 5);
  EXPECT_LT(near, 0.8 * kSerrated);
  EXPECT_LT(free, 0.9 * near);
}

/// A sheet of 41 x 41 vertices, cut open from its side to its middle, as it lies in the plane.
/// @param height  above the plane, per vertex of the unit square
template <class Height>
std::pair<CutSurface, std::vector<Chart>> slit_sheet(const Height& height) {
  CleanSurface sheet = test::disk(41, 41);
  for (Point3& p : sheet.position) p[2] = height(p);
  CutSurface cut = cut_to_disks(sheet);
  std::vector<uint32_t> path;
  for (uint32_t k = 0; k <= 20; ++k) path.push_back(k * 41 + 20);
  std::vector<Chart> charts = charts_of(cut);
  std::map<uint32_t, uint32_t> of_clean;  // per vertex of the sheet: its vertex in the chart
  for (uint32_t v = 0; v < charts[0].position.size(); ++v) of_clean[cut.clean_vertex[charts[0].cut_vertex[v]]] = v;
  for (uint32_t& v : path) v = of_clean.at(v);
  charts[0] = opened(charts[0], path);
  EXPECT_TRUE(embed_on_circle(charts[0]));
  SymmetricDirichlet(charts[0].position, charts[0].triangle, {}).minimise(charts[0].uv, 100, 1e-6);
  return {std::move(cut), std::move(charts)};
}

double cone(const Point3& p) {
  return 0.5 - std::hypot(p[0] - 0.5, p[1] - 0.5);
}

// A cut that brings next to nothing costs a seam, pixels and a hinge.
TEST(CloseSlits, AnIdleSlitIsSewnShut) {
  auto [cut, charts] = slit_sheet([](const Point3& p) { return 0.05 * cone(p); });
  const double area = total_area(charts[0]), outline = outline_length(charts[0]);
  close_slits(charts, find_sheet(cut), {});
  ASSERT_EQ(charts.size(), 1U);
  EXPECT_LT(outline_length(charts[0]), outline - 0.99);
  EXPECT_NEAR(total_area(charts[0]), area, 1e-12);
  EXPECT_TRUE(flip_free(charts[0]));
  EXPECT_LT(SymmetricDirichlet(charts[0].position, charts[0].triangle, {}).energy(charts[0].uv), 4.001);
}

// The top of a cone does not lie flat without its slit.
TEST(CloseSlits, ASlitThatIsNeededStays) {
  auto [cut, charts] = slit_sheet([](const Point3& p) { return 0.5 - std::hypot(p[0] - 0.5, p[1] - 0.5); });
  const double outline = outline_length(charts[0]);
  close_slits(charts, find_sheet(cut), {});
  EXPECT_GT(outline_length(charts[0]), 0.9 * outline);
  EXPECT_LT(SymmetricDirichlet(charts[0].position, charts[0].triangle, {}).energy(charts[0].uv), 4.03);
}

/// Two square layers of n x n quads that share their border: a cushion, `bulge` [m] high in the middle.
TriangleMesh cushion(uint32_t n, double bulge) {
  TriangleMesh mesh;
  mesh.name = "cushion";
  std::map<std::array<uint32_t, 3>, uint32_t> number;
  const auto vertex = [&](uint32_t side, uint32_t x, uint32_t y) {
    const bool on_rim = x == 0 || y == 0 || x == n || y == n;
    const auto fresh = static_cast<uint32_t>(mesh.position.size());
    const auto [found, is_new] = number.try_emplace({on_rim ? 0 : side, x, y}, fresh);
    if (is_new) {
      const double u = x / static_cast<double>(n), v = y / static_cast<double>(n);
      const double height = on_rim ? 0 : 4 * bulge * std::sqrt(u * (1 - u) * v * (1 - v));
      mesh.position.push_back({0.5 * u, 0.5 * v, side == 0 ? height : -height});
    }
    return found->second;
  };
  for (const uint32_t side : {0U, 1U}) {
    for (uint32_t y = 0; y < n; ++y) {
      for (uint32_t x = 0; x < n; ++x) {
        const uint32_t a = vertex(side, x, y), b = vertex(side, x + 1, y), c = vertex(side, x + 1, y + 1),
                       d = vertex(side, x, y + 1);
        mesh.triangle.push_back(side == 0 ? Triangle{a, b, c} : Triangle{a, c, b});
        mesh.triangle.push_back(side == 0 ? Triangle{a, c, d} : Triangle{a, d, c});
      }
    }
  }
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
  mesh.material = {SourceMaterial{}};
  mesh.part.push_back({"cushion", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  return mesh;
}

/// A sheet of strips one beside the other, each turned against the one before by an angle [rad], one way and back.
TriangleMesh pleated(uint32_t strips, double angle, uint32_t rows = 20) {
  TriangleMesh mesh;
  mesh.name = "pleated";
  double x = 0, z = 0;
  for (uint32_t s = 0; s <= strips; ++s) {
    for (uint32_t r = 0; r <= rows; ++r) mesh.position.push_back({x, r / static_cast<double>(rows), z});
    const double turn = s % 2 == 0 ? angle / 2 : -angle / 2;
    x += 0.05 * std::cos(turn);
    z += 0.05 * std::sin(turn);
  }
  for (uint32_t s = 0; s < strips; ++s) {
    for (uint32_t r = 0; r < rows; ++r) {
      const uint32_t a = s * (rows + 1) + r, b = a + rows + 1;
      mesh.triangle.push_back({a, b, b + 1});
      mesh.triangle.push_back({a, b + 1, a + 1});
    }
  }
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
  mesh.material = {SourceMaterial{}};
  mesh.part.push_back({"pleated", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  return mesh;
}

TEST(FoldLoops, GoAllRoundWhereTwoLayersMeet) {
  constexpr uint32_t kSide = 12;
  constexpr size_t kMost = 10'000;
  const CleanSurface surface = repair_mesh(cushion(kSide, 0.01)).surface;
  const std::vector<std::array<uint32_t, 2>> loops = fold_loops(surface, kMost);
  EXPECT_TRUE(std::is_sorted(loops.begin(), loops.end()));
  std::map<uint32_t, int> ends;
  double length = 0;
  for (const auto& [a, b] : loops) {
    length += distance(surface.position[a], surface.position[b]);
    for (const uint32_t v : {a, b}) {
      EXPECT_EQ(surface.position[v][2], 0) << "only the rim is folded";
      ++ends[v];
    }
  }
  EXPECT_NEAR(length, 2, 1e-6);
  EXPECT_TRUE(std::all_of(ends.begin(), ends.end(), [](const auto& e) { return e.second == 2; }));
  EXPECT_TRUE(fold_loops(surface, surface.triangle.size() - 1).empty()) << "time grows with every way to cut";
}

// A skirt of pleats hangs together; cut at every one it would be a heap of strips.
TEST(FoldLoops, AreNoPleatsAndNoWrinkles) {
  constexpr size_t kMost = 10'000;
  EXPECT_EQ(fold_loops(repair_mesh(pleated(2, 1.5)).surface, kMost).size(), 20U) << "a line from border to border";
  EXPECT_TRUE(fold_loops(repair_mesh(pleated(40, 1.5)).surface, kMost).empty());
  EXPECT_TRUE(fold_loops(repair_mesh(pleated(2, 0.5)).surface, kMost).empty());
  TriangleMesh ends_within = pleated(2, 1.5);
  for (uint32_t r = 10; r <= 20; ++r) ends_within.position[21 + r][2] = 0;
  EXPECT_TRUE(fold_loops(repair_mesh(ends_within).surface, kMost).empty());
}

// Cut across its sides as the shortest seam would have it, a cushion is an envelope of triangles: half of the image is
// empty, and lines run over the cloth that no tailor would draw.
TEST(CutChoice, ACushionIsTwoPiecesSewnAllRound) {
  ConvertOptions options;
  options.flatten.resolution = 64;
  const ConvertResult result = convert(cushion(20, 0.01), options);
  const double side = std::sqrt(2 * 0.5 * 0.5);
  EXPECT_NEAR(result.report.quality.seam_length, 2 / side, 0.03 * 2 / side);
  EXPECT_LT(result.report.quality.l2_stretch, 1.001);
  EXPECT_GT(count_valid_pixels(result.asset), 0.9 * result.asset.width * result.asset.height);
  ASSERT_EQ(result.flat.charts.size(), 2U);
  EXPECT_EQ(result.flat.charts[0].outline.size(), result.flat.charts[1].outline.size()) << "sewn point to point";
}

}  // namespace
}  // namespace geocloth
