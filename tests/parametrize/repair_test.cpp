// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/repair.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/import.h"
#include "parametrize/expect_clean.h"

namespace geocloth {
namespace {

/// A mesh whose polygons are given by positions' numbers; polygons are fanned.
TriangleMesh make_mesh(std::vector<Point3> position, const std::vector<std::vector<uint32_t>>& polygons) {
  TriangleMesh mesh;
  mesh.name = "made";
  mesh.position = std::move(position);
  for (uint32_t p = 0; p < polygons.size(); ++p) {
    for (std::size_t k = 2; k < polygons[p].size(); ++k) {
      mesh.triangle.push_back({polygons[p][0], polygons[p][k - 1], polygons[p][k]});
      mesh.polygon.push_back(p);
    }
  }
  mesh.part.push_back({"made", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  mesh.material.emplace_back();
  return mesh;
}

/// A flat sheet of nx x ny quads in the plane z = 0, spacing 1, points row by row.
TriangleMesh sheet(uint32_t nx, uint32_t ny) {
  std::vector<Point3> position;
  for (uint32_t y = 0; y <= ny; ++y) {
    for (uint32_t x = 0; x <= nx; ++x) position.push_back({double(x), double(y), 0});
  }
  std::vector<std::vector<uint32_t>> quads;
  for (uint32_t y = 0; y < ny; ++y) {
    for (uint32_t x = 0; x < nx; ++x) {
      const uint32_t a = y * (nx + 1) + x;
      quads.push_back({a, a + 1, a + nx + 2, a + nx + 1});
    }
  }
  return make_mesh(std::move(position), quads);
}

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto base = static_cast<uint32_t>(mesh.position.size());
  const uint32_t polygons = mesh.polygon.empty() ? 0 : mesh.polygon.back() + 1;
  const auto first = static_cast<uint32_t>(mesh.triangle.size());
  mesh.position.insert(mesh.position.end(), more.position.begin(), more.position.end());
  for (const Triangle& t : more.triangle) mesh.triangle.push_back({t[0] + base, t[1] + base, t[2] + base});
  for (const uint32_t p : more.polygon) mesh.polygon.push_back(p + polygons);
  mesh.part.push_back({"more", 0, first, static_cast<uint32_t>(more.triangle.size())});
}

TriangleMesh octahedron(const Point3& center) {
  std::vector<Point3> p;
  for (const Point3& d : std::vector<Point3>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    p.push_back({center[0] + d[0], center[1] + d[1], center[2] + d[2]});
  }
  return make_mesh(std::move(p),
                   {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

uint64_t repaired(const RepairResult& result, const std::string& kind) {
  for (const Repair& r : result.repairs) {
    if (r.kind == kind) return r.count;
  }
  return 0;
}

/// Repairs and holds the result against the contract.
RepairResult repair(const TriangleMesh& mesh) {
  RepairResult result = repair_mesh(mesh);
  test::expect_clean(result.surface, mesh);
  return result;
}

double signed_volume(const CleanSurface& s) {
  double volume = 0;
  for (const Triangle& t : s.triangle) {
    const Point3 &a = s.position[t[0]], &b = s.position[t[1]], &c = s.position[t[2]];
    volume +=
        (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) /
        6;
  }
  return volume;
}

TEST(Repair, LeavesACleanMeshAlone) {
  const TriangleMesh mesh = sheet(4, 3);
  const RepairResult r = repair(mesh);
  EXPECT_TRUE(r.repairs.empty());
  EXPECT_EQ(r.surface.triangle, mesh.triangle);
  EXPECT_EQ(r.surface.position, mesh.position);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
}

TEST(Repair, SingleTriangle) {
  const RepairResult r = repair(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  EXPECT_EQ(r.surface.triangle.size(), 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
}

TEST(Repair, RefusesAMeshWithoutArea) {
  EXPECT_THROW(static_cast<void>(repair_mesh(make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}))), Error);
  EXPECT_THROW(static_cast<void>(repair_mesh(make_mesh({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}))), Error);
  EXPECT_THROW(static_cast<void>(repair_mesh(TriangleMesh{})), Error);
}

TEST(Repair, CountsAPartThatHasNoArea) {
  TriangleMesh mesh = sheet(2, 2);
  append(mesh, make_mesh({{5, 0, 0}, {6, 0, 0}, {7, 0, 0}}, {{0, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "lost_parts"), 1U);
  EXPECT_EQ(r.surface.source_point[9], kNone);
}

// Importers leave every quad apart from its neighbours at texture seams; cloth must not fall to pieces there.
TEST(Repair, WeldsUnweldedQuads) {
  const TriangleMesh whole = sheet(5, 4);
  TriangleMesh loose = whole;
  loose.position.clear();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-1e-6, 1e-6);
  for (Triangle& t : loose.triangle) {
    for (uint32_t& v : t) {
      Point3 p = whole.position[v];
      p[2] += noise(random);
      v = static_cast<uint32_t>(loose.position.size());
      loose.position.push_back(p);
    }
  }
  const RepairResult r = repair(loose);
  EXPECT_EQ(r.surface.point_count, whole.position.size());
  EXPECT_EQ(repaired(r, "welded_vertices"), loose.position.size() - whole.position.size());
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
}

/// The triangles of a mesh, each with three vertices of its own that are shaken.
TriangleMesh shaken_soup(const TriangleMesh& whole, double most) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> noise(-most, most);
  TriangleMesh soup = whole;
  soup.position.clear();
  for (Triangle& t : soup.triangle) {
    for (uint32_t& v : t) {
      const Point3& p = whole.position[v];
      v = static_cast<uint32_t>(soup.position.size());
      soup.position.push_back({p[0] + noise(random), p[1] + noise(random), p[2] + noise(random)});
    }
  }
  return soup;
}

// Noise about as large as the weld tolerance welds some copies of a vertex and not others: worse than none at all.
TEST(Repair, SewsASoupThatWasShakenAboutTheTolerance) {
  const TriangleMesh whole = sheet(20, 20);
  for (const double share : {1e-7, 3e-7, 1e-6, 3e-6, 1e-5}) {
    const RepairResult r = repair_mesh(shaken_soup(whole, share * std::sqrt(800.0)));
    EXPECT_EQ(r.surface.point_count, whole.position.size()) << share;
    EXPECT_EQ(r.cleaned.boundary_loops, 1U) << share;
    EXPECT_EQ(r.cleaned.euler_characteristic, 1) << share;
  }
}

/// A sheet of nx x ny quads over the unit square, bent by `place`.
template <typename Place>
TriangleMesh unit_sheet(uint32_t nx, uint32_t ny, const Place& place) {
  TriangleMesh mesh = sheet(nx, ny);
  for (Point3& p : mesh.position) p = place(p[0] / nx, p[1] / ny);
  return mesh;
}

void expect_one_sheet(const RepairResult& r) {
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
  EXPECT_EQ(r.cleaned.bow_tie_vertices, 0U);
}

/// Two sheets of the same squares side by side; the second one has `finer` times as many edges along the gap.
TriangleMesh sheets_apart(double gap, uint32_t finer) {
  TriangleMesh mesh = sheet(10, 10);
  TriangleMesh other = sheet(10, 10 * finer);
  for (Point3& p : other.position) p = {p[0] + 10 + gap, p[1] / finer, p[2]};
  append(mesh, other);
  return mesh;
}

// Panels that were exported apart must be found, and hold together when the user says so, or the garment falls apart.
TEST(Repair, JoinsPiecesAcrossAGapThatIsGiven) {
  for (const uint32_t finer : {1U, 2U}) {
    const TriangleMesh mesh = sheets_apart(0.03, finer);
    const RepairResult apart = repair_mesh(mesh);
    EXPECT_EQ(apart.cleaned.components, 2U);
    const RepairResult joined = repair_mesh(mesh, {.weld_distance = 0.04});
    EXPECT_EQ(joined.cleaned.components, 1U) << finer;
    EXPECT_EQ(joined.cleaned.boundary_loops, 1U) << finer;
    EXPECT_EQ(joined.cleaned.euler_characteristic, 1) << finer;
    EXPECT_EQ(find_cracks(joined.surface).edges, 0U);
    EXPECT_EQ(repair_mesh(mesh, {.weld_distance = 0.02}).cleaned.components, 2U);
  }
}

TEST(Repair, FindsCracks) {
  const Cracks cracks = find_cracks(repair_mesh(sheets_apart(0.03, 1)).surface);
  EXPECT_EQ(cracks.edges, 20U);
  EXPECT_EQ(cracks.of_edges, 80U);
  EXPECT_NEAR(cracks.widest, 0.03, 1e-9);
  EXPECT_EQ(find_cracks(repair_mesh(sheets_apart(0.3, 1)).surface).edges, 0U) << "a slit that can be seen";
  EXPECT_EQ(find_cracks(repair_mesh(sheet(10, 10)).surface).edges, 0U);
}

// Both sides of a narrow spike end in its tip: that was told as a gap of 0 m, to be joined.
TEST(Repair, FindsNoCracksInAStar) {
  TriangleMesh star;
  star.position.push_back({0, 0, 0});
  constexpr uint32_t kSpikes = 12;
  for (uint32_t k = 0; k < 2 * kSpikes; ++k) {
    const double angle = std::numbers::pi * k / kSpikes, radius = k % 2 == 0 ? 1 : 0.1;
    star.position.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    star.triangle.push_back({0, 1 + k, 1 + (k + 1) % (2 * kSpikes)});
    star.polygon.push_back(k);
  }
  star.part = {{"star", 0, 0, 2 * kSpikes}};
  star.material = {SourceMaterial{}};
  EXPECT_EQ(find_cracks(repair_mesh(star).surface).edges, 0U);
}

/// Repairs with the distance that is to be said of the cracks.
RepairResult repair_cracks(const TriangleMesh& mesh) {
  return repair_mesh(mesh, {.weld_distance = 1.1 * find_cracks(repair_mesh(mesh).surface).widest});
}

// A side panel twice as fine, as it is often drawn, has no vertex beside most of the others' vertices.
TEST(Repair, FindsCracksBesideAFinerBorder) {
  for (const uint32_t finer : {2U, 3U}) {
    const TriangleMesh mesh = sheets_apart(0.02, finer);
    const Cracks cracks = find_cracks(repair_mesh(mesh).surface);
    EXPECT_EQ(cracks.edges, 10 + 10 * finer);
    EXPECT_EQ(cracks.of_edges, 60 + 20 * finer);
    EXPECT_NEAR(cracks.widest, 0.02, 1e-9);
    expect_one_sheet(repair_cracks(mesh));
  }
}

// Two halves of a skirt with no gap between them but the bend of their edges hung together at four points, and nothing
// said so.
TEST(Repair, FindsCracksAlongACurvedSeamOfUnlikeCounts) {
  const auto seam = [](double v) { return 0.5 + 0.1 * std::sin(3 * v); };
  for (const uint32_t right : {31U, 60U}) {
    TriangleMesh mesh = unit_sheet(9, 40, [&](double u, double v) { return Point3{u * seam(v), v, 0}; });
    append(mesh, unit_sheet(7, right, [&](double u, double v) { return Point3{seam(v) + u / 2, v, 0}; }));
    const Cracks cracks = find_cracks(repair_mesh(mesh).surface);
    EXPECT_GT(cracks.edges, 0.9 * (40 + right));
    EXPECT_LT(cracks.widest, 2e-4);
    expect_one_sheet(repair_cracks(mesh));
  }
}

// Front and back of a flat tube leave their seams at less than a right angle.
TEST(Repair, FindsCracksBetweenPanelsThatMeetAtAnAcuteAngle) {
  const auto tube = [](uint32_t back, double gap) {
    const auto bulge = [](double u) { return 0.2 * std::sin(std::numbers::pi * u); };
    TriangleMesh mesh = unit_sheet(30, 40, [&](double u, double v) { return Point3{u, v, bulge(u) + gap / 2}; });
    append(mesh, unit_sheet(23, back, [&](double u, double v) { return Point3{u, v, -bulge(u) - gap / 2}; }));
    return mesh;
  };
  for (const uint32_t back : {40U, 31U}) {
    const TriangleMesh mesh = tube(back, 0.001);
    EXPECT_GT(find_cracks(repair_mesh(mesh).surface).edges, 0.9 * (40 + back)) << back;
    const RepairResult r = repair_cracks(mesh);
    EXPECT_EQ(r.cleaned.boundary_loops, 2U) << back;
    EXPECT_EQ(r.cleaned.euler_characteristic, 0) << back;
  }
}

// A lining ends where its shell ends; sewn together by a wrong advice they would be one stiff mess.
TEST(Repair, DoesNotTakeTheHemsOfTwoLayersForCracks) {
  TriangleMesh mesh = sheet(10, 10), lining = sheet(10, 10);
  for (Point3& p : lining.position) p[2] += 0.03;
  append(mesh, lining);
  EXPECT_EQ(find_cracks(repair_mesh(mesh).surface).edges, 0U);
  TriangleMesh shell = sheet(10, 10);
  append(shell, unit_sheet(23, 31, [](double u, double v) { return Point3{10 * u, 10 * v, 0.02}; }));
  EXPECT_EQ(find_cracks(repair_mesh(shell).surface).edges, 0U) << "of unlike counts";
}

TEST(Repair, WeldsNothingThatIsApartWhereZeroIsGiven) {
  const TriangleMesh soup = shaken_soup(sheet(4, 4), 1e-7);
  EXPECT_EQ(repair_mesh(soup).cleaned.components, 1U);
  EXPECT_EQ(repair_mesh(soup, {.weld_distance = 0}).cleaned.components, 32U);
}

TEST(Repair, RefusesAWeldDistanceThatIsNone) {
  for (const double d : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(static_cast<void>(repair_mesh(sheet(2, 2), {.weld_distance = d})), Error);
}

// Whatever is asked for, no triangle that has an area is welded away.
TEST(Repair, WeldsNoTriangleAwayHoweverFarItReaches) {
  const RepairResult r = repair_mesh(sheet(5, 5), {.weld_distance = 1e6});
  EXPECT_EQ(r.surface.triangle.size(), 50U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
}

// Vertices of two needles at the ends of one edge are near each other, and nearer still to the vertex between them.
TEST(Repair, DoesNotWeldNeedlesToEachOther) {
  TriangleMesh mesh = sheet(6, 6);
  const std::vector<Triangle> whole = mesh.triangle;
  mesh.triangle.clear();
  mesh.polygon.clear();
  for (const Triangle& t : whole) {
    const Point3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
    const double near = 3e-6, rest = 1 - 2 * near;
    const auto n = static_cast<uint32_t>(mesh.position.size());
    mesh.position.push_back({rest * a[0] + near * (b[0] + c[0]), rest * a[1] + near * (b[1] + c[1]), 0});
    for (const Triangle& part : {Triangle{t[0], t[1], n}, Triangle{t[1], t[2], n}, Triangle{t[2], t[0], n}}) {
      mesh.polygon.push_back(static_cast<uint32_t>(mesh.triangle.size()));
      mesh.triangle.push_back(part);
    }
  }
  mesh.part[0].triangle_count = static_cast<uint32_t>(mesh.triangle.size());
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
}

// One face far away makes the whole so large that every other vertex is within the tolerance of every other; each has
// to be compared with its own neighbours only.
TEST(Repair, AFaceFarAwayWeldsNothing) {
  TriangleMesh mesh = sheet(150, 150);
  append(mesh, make_mesh({{1e9, 0, 0}, {1e9, 1, 0}, {1e9, 0, 1}}, {{0, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_TRUE(r.repairs.empty());
  EXPECT_EQ(r.surface.point_count, mesh.position.size());
}

// A chain of vertices each within the tolerance of the next is a fine feature, not one point.
TEST(Repair, DoesNotWeldAChainIntoOnePoint) {
  TriangleMesh mesh = sheet(1, 1);
  std::vector<Point3> p;
  std::vector<std::vector<uint32_t>> triangles;
  for (uint32_t i = 0; i <= 40; ++i) {
    p.push_back({0.5 + i * 1e-6, 0, 1});
    p.push_back({0.5 + i * 1e-6, 1.6e-6, 1});
    if (i > 0) triangles.push_back({2 * i - 2, 2 * i, 2 * i + 1, 2 * i - 1});
  }
  append(mesh, make_mesh(p, triangles));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle.size(), mesh.triangle.size());
  EXPECT_EQ(r.surface.point_count, mesh.position.size());
}

TEST(Repair, DropsCollapsedAndDuplicateFaces) {
  TriangleMesh mesh = sheet(3, 3);
  const std::size_t good = mesh.triangle.size();
  mesh.triangle.push_back({0, 1, 1});
  mesh.triangle.push_back(mesh.triangle[4]);
  mesh.triangle.push_back({mesh.triangle[6][1], mesh.triangle[6][0], mesh.triangle[6][2]});
  for (uint32_t p = 9; mesh.polygon.size() < mesh.triangle.size(); ++p) mesh.polygon.push_back(p);
  mesh.part[0].triangle_count = static_cast<uint32_t>(mesh.triangle.size());
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle.size(), good);
  EXPECT_EQ(repaired(r, "degenerate_faces"), 1U);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 2U);
}

// The second copy of a quad may come with its other diagonal; together they would be a closed pillow.
TEST(Repair, DropsADuplicateQuadCutTheOtherWay) {
  TriangleMesh mesh = sheet(2, 2);
  mesh.triangle.push_back({1, 4, 3});
  mesh.triangle.push_back({1, 3, 0});
  mesh.polygon.insert(mesh.polygon.end(), {4, 4});
  mesh.part[0].triangle_count = 10;
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle.size(), 8U);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 1U);
  EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
}

/// Two layers sewn round the border. At two corners a triangle of each has no vertex but on the border.
TriangleMesh pillow(uint32_t n) {
  TriangleMesh mesh = sheet(n, n), back = mesh;
  const auto bulge = [&](const Point3& p) {
    return 0.1 * std::sin(std::numbers::pi * p[0] / n) * std::sin(std::numbers::pi * p[1] / n);
  };
  for (auto& [x, y, z] : mesh.position) {
    const bool border = x == 0 || y == 0 || x == n || y == n;
    z = border ? 0 : bulge({x, y, z});
  }
  for (std::size_t i = 0; i < back.position.size(); ++i) {
    back.position[i] = {mesh.position[i][0], mesh.position[i][1], -mesh.position[i][2]};
  }
  for (Triangle& t : back.triangle) std::swap(t[1], t[2]);
  append(mesh, back);
  return mesh;
}

double area_of(const std::vector<Point3>& position, const std::vector<Triangle>& triangle) {
  double area = 0;
  for (const auto& [a, b, c] : triangle) {
    std::array<double, 3> p{}, q{};
    for (size_t k = 0; k < 3; ++k) {
      p[k] = position[b][k] - position[a][k];
      q[k] = position[c][k] - position[a][k];
    }
    area += std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]) / 2;
  }
  return area;
}

// One of the two taken away would leave the pillow open, both would leave it without a piece of cloth.
TEST(Repair, KeepsAPillowWholeWhoseCornersAreFlat) {
  for (const uint32_t n : {2U, 3U, 4U, 10U}) {
    for (const bool has_ways : {true, false}) {
      TriangleMesh mesh = pillow(n);
      for (size_t t = 0; t < mesh.triangle.size() && !has_ways; t += 3) {
        const Triangle& k = mesh.triangle[t];  // no corner of the pillow: those are two faces by their ways round
        if (std::ranges::any_of(k, [&](uint32_t v) { return mesh.position[v][2] != 0; }))
          std::swap(mesh.triangle[t][0], mesh.triangle[t][1]);
      }
      const RepairResult r = repair(mesh);
      EXPECT_EQ(repaired(r, "duplicate_faces"), 0U);
      EXPECT_NEAR(area_of(r.surface.position, r.surface.triangle), area_of(mesh.position, mesh.triangle), 1e-9) << n;
      EXPECT_EQ(r.cleaned.components, 1U);
      EXPECT_EQ(r.cleaned.boundary_loops, 0U);
      EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
      EXPECT_EQ(r.cleaned.euler_characteristic, 2);
      EXPECT_EQ(r.folded_faces, 0U);
    }
  }
}

TEST(Repair, KeepsTexturesOfFlatCornersAsTheyAre) {
  TriangleMesh mesh = pillow(4);
  for (const Triangle& t : mesh.triangle) {
    auto& uv = mesh.uv.emplace_back();
    for (size_t k = 0; k < 3; ++k) uv[k] = {mesh.position[t[k]][0] / 4, mesh.position[t[k]][1] / 4};
  }
  const RepairResult r = repair(mesh);
  ASSERT_EQ(r.surface.uv.size(), r.surface.triangle.size());
  for (size_t t = 0; t < r.surface.uv.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const Point3& at = r.surface.position[r.surface.triangle[t][k]];
      EXPECT_NEAR(r.surface.uv[t][k][0], at[0] / 4, 1e-9);
      EXPECT_NEAR(r.surface.uv[t][k][1], at[1] / 4, 1e-9);
    }
  }
}

// One of the two was kept before, a flap that held the pillow open there.
TEST(Repair, ClosesAPillowWhoseCornersAreFlat) {
  for (const uint32_t n : {2U, 3U, 10U}) {
    const RepairResult r = repair(pillow(n));
    EXPECT_EQ(r.surface.triangle.size(), 4 * n * n + 8U) << "a triangle more for each of two layers and their sides";
    EXPECT_EQ(r.cleaned.boundary_loops, 0U);
    EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
    EXPECT_EQ(r.cleaned.euler_characteristic, 2);
  }
}

TEST(Repair, ClosesAPillowWithACornerStackedThreeTimes) {
  TriangleMesh mesh = pillow(4);
  // The corner in which vertex 4 is the only one of its quad that is in no other.
  const auto corner = std::find_if(mesh.triangle.begin(), mesh.triangle.end(), [](const Triangle& t) {
    return std::count(t.begin(), t.end(), 4U) > 0 && std::count(t.begin(), t.end(), 9U) > 0;
  });
  ASSERT_NE(corner, mesh.triangle.end());
  append(mesh, make_mesh({mesh.position[(*corner)[0]], mesh.position[(*corner)[1]], mesh.position[(*corner)[2]]},
                         {{0, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 0U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 2);
}

TEST(Repair, KeepsOneOfTwoTrianglesThatAreAPartOfTheirOwn) {
  TriangleMesh mesh = sheet(2, 2);
  append(mesh, make_mesh({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}, {{0, 1, 2}, {0, 2, 1}, {0, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 2U);
  EXPECT_EQ(r.cleaned.components, 2U);
}

// The backs of a double-sided label that is sewn on by an edge are duplicates as they are everywhere else.
TEST(Repair, KeepsADoubleSidedLabelOnASheet) {
  TriangleMesh mesh = sheet(4, 4);
  append(mesh, make_mesh({{2, 1, 0}, {2, 2, 0}, {2, 1, 1}, {2, 2, 1}}, {{0, 1, 2}, {1, 3, 2}, {1, 0, 2}, {3, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 2U);
  EXPECT_EQ(r.surface.triangle.size(), 34U);
}

/// A sheet with a bend, and its back with other diagonals, each triangle a face as in glTF.
TriangleMesh double_sided_sheet(uint32_t nx, uint32_t ny) {
  TriangleMesh mesh = sheet(nx, ny);
  for (Point3& p : mesh.position) p[2] = 0.1 * std::sin(p[0] + 0.5 * p[1]);
  const std::size_t front = mesh.triangle.size();
  for (std::size_t t = 0; t < front; t += 2) {
    const auto [a, b, c] = mesh.triangle[t];
    const uint32_t d = mesh.triangle[t + 1][2];
    mesh.triangle.push_back({a, d, b});
    mesh.triangle.push_back({b, d, c});
  }
  mesh.polygon.clear();
  mesh.part[0].triangle_count = static_cast<uint32_t>(mesh.triangle.size());
  return mesh;
}

// Without quads to tell them by, the backs would make a closed pillow of every quad.
TEST(Repair, DropsTheBackOfADoubleSidedSheetCutTheOtherWay) {
  const TriangleMesh mesh = double_sided_sheet(7, 5);
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle, sheet(7, 5).triangle);
  EXPECT_EQ(repaired(r, "duplicate_faces"), 70U);
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
}

// A back with vertices of its own, in the same places, and in another part of the file.
TEST(Repair, DropsABackWithVerticesOfItsOwn) {
  const TriangleMesh both = double_sided_sheet(4, 4);
  const std::size_t half = both.triangle.size() / 2;
  TriangleMesh mesh = both, back = both;
  mesh.triangle.resize(half);
  mesh.part[0].triangle_count = static_cast<uint32_t>(half);
  back.triangle.erase(back.triangle.begin(), back.triangle.begin() + static_cast<std::ptrdiff_t>(half));
  append(mesh, back);
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle.size(), half);
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.non_manifold_edges, 0U);
}

// One pillow on a sheet is a thing of its own, and how the sheet hangs together with it is kept.
TEST(Repair, KeepsASingleFlatPillowOnASheet) {
  TriangleMesh mesh = sheet(4, 4);
  mesh.triangle.push_back({6, 11, 7});
  mesh.triangle.push_back({7, 11, 12});
  mesh.polygon.clear();
  mesh.part[0].triangle_count = static_cast<uint32_t>(mesh.triangle.size());
  EXPECT_EQ(repair(mesh).surface.triangle.size(), mesh.triangle.size());
}

// A small solid that stands on a sheet by one of its edges is no back of anything.
TEST(Repair, KeepsATetrahedronThatStandsOnASheet) {
  TriangleMesh mesh = sheet(4, 4);
  const uint32_t a = 6, b = 7, c = static_cast<uint32_t>(mesh.position.size()), d = c + 1;
  mesh.position.push_back({1.5, 0.6, 0.8});
  mesh.position.push_back({1.5, 1.4, 0.8});
  for (const Triangle& t : {Triangle{a, b, c}, Triangle{b, a, d}, Triangle{a, c, d}, Triangle{c, b, d}}) {
    mesh.triangle.push_back(t);
  }
  mesh.polygon.clear();
  mesh.part[0].triangle_count = static_cast<uint32_t>(mesh.triangle.size());
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.triangle.size(), mesh.triangle.size());
  EXPECT_EQ(repaired(r, "duplicate_faces"), 0U);
}

TEST(Repair, IgnoresVerticesThatNoFaceUses) {
  TriangleMesh mesh = sheet(2, 2);
  mesh.position.insert(mesh.position.begin(), {100, 100, 100});
  for (Triangle& t : mesh.triangle) {
    for (uint32_t& v : t) ++v;
  }
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.source_point[0], kNone);
  EXPECT_EQ(r.surface.source_point[1], 0U);
  EXPECT_EQ(r.surface.point_count, 9U);
}

TEST(Repair, OrientsShuffledFaces) {
  TriangleMesh mesh = sheet(6, 6);
  std::mt19937 random(7);
  uint64_t turned = 0;
  for (Triangle& t : mesh.triangle) {
    if (random() % 3 != 0) continue;
    std::swap(t[0], t[1]);
    ++turned;
  }
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "flipped_faces"), turned);
  EXPECT_EQ(r.cleaned.inconsistent_edges, 0U);
  for (const Triangle& t : r.surface.triangle) {
    const Point3 &a = r.surface.position[t[0]], &b = r.surface.position[t[1]], &c = r.surface.position[t[2]];
    EXPECT_GT((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]), 0);  // as most of the file
  }
}

TEST(Repair, TurnsAClosedPartInsideOut) {
  TriangleMesh mesh = octahedron({0, 0, 0});
  for (Triangle& t : mesh.triangle) std::swap(t[0], t[1]);
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "flipped_faces"), 8U);
  EXPECT_NEAR(signed_volume(r.surface), 4.0 / 3, 1e-12);
}

// --- edges with more than two faces --------------------------------------------------------------------------------

/// Sheets that meet in the edge (0,0,0)-(0,0,1), each leaving it under an angle.
TriangleMesh sheets_on_an_edge(const std::vector<double>& degrees) {
  std::vector<Point3> p{{0, 0, 0}, {0, 0, 1}};
  std::vector<std::vector<uint32_t>> quads;
  for (const double d : degrees) {
    const double c = std::cos(d * std::numbers::pi / 180), s = std::sin(d * std::numbers::pi / 180);
    const auto base = static_cast<uint32_t>(p.size());
    p.push_back({c, s, 0});
    p.push_back({c, s, 1});
    quads.push_back({0, base, base + 1, 1});
  }
  return make_mesh(std::move(p), quads);
}

/// Components of the sheets, in the order of the angles.
std::vector<uint32_t> sheet_components(const RepairResult& r) {
  std::vector<uint32_t> out;
  for (std::size_t i = 0; i < r.surface.component.size(); i += 2) out.push_back(r.surface.component[i]);
  return out;
}

TEST(Repair, KeepsTheFlattestPairOfThreeSheets) {
  const RepairResult r = repair(sheets_on_an_edge({0, 80, 175}));
  EXPECT_THAT(sheet_components(r), ::testing::ElementsAre(0, 1, 0));
  EXPECT_EQ(repaired(r, "detached_sheets"), 1U);
  EXPECT_EQ(r.cleaned.non_manifold_edges, 1U);
  EXPECT_EQ(r.cleaned.components, 1U);  // still tied
  EXPECT_EQ(r.surface.position.size(), r.surface.point_count + 2U);
}

TEST(Repair, PairsFourSheetsStraightAcross) {
  const RepairResult r = repair(sheets_on_an_edge({0, 70, 180, 250}));
  EXPECT_THAT(sheet_components(r), ::testing::ElementsAre(0, 1, 0, 1));
}

TEST(Repair, ManySheetsOnAnEdge) {
  std::vector<double> degrees;
  degrees.reserve(200);
  for (int i = 0; i < 200; ++i) degrees.push_back(i * 1.8);
  const RepairResult r = repair(sheets_on_an_edge(degrees));
  EXPECT_EQ(repaired(r, "detached_sheets"), 198U);
  EXPECT_EQ(r.cleaned.components, 1U);
}

/// A pocket sewn to the middle row of a shirt patch: bottom and sides tied, top open.
TriangleMesh patch_with_pocket() {
  TriangleMesh mesh = sheet(6, 6);
  TriangleMesh pocket = sheet(2, 2);
  for (Point3& p : pocket.position) {
    const bool top = p[1] == 2, middle = p[0] == 1 && p[1] > 0;
    p = {p[0] + 2, p[1] + 2, top || middle ? 0.4 : 0.0};
  }
  append(mesh, pocket);
  return mesh;
}

// CGAL's soup orientation tears the shirt here; the shirt has to stay in one piece, and the pocket tied to it.
TEST(Repair, PocketStaysTiedAndTheShirtWhole) {
  const RepairResult r = repair(patch_with_pocket());
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_GT(r.cleaned.non_manifold_edges, 0U);
  const auto shirt = static_cast<std::size_t>(std::count(r.surface.component.begin(), r.surface.component.end(), 0U));
  EXPECT_EQ(shirt, 72U);
  EXPECT_EQ(r.surface.component_count, 2U);
  EXPECT_EQ(repaired(r, "torn_edges"), 0U);
}

TEST(Repair, APartOfItsOwnIsDetachedEvenWhenFlatter) {
  // The odd sheet continues sheet 0 more straightly than sheet 1 does, but belongs to another part.
  TriangleMesh mesh = sheets_on_an_edge({0, 170, 185});
  mesh.part = {{"shirt", 0, 0, 4}, {"trim", 1, 4, 2}};
  mesh.material.emplace_back();
  EXPECT_THAT(sheet_components(repair(mesh)), ::testing::ElementsAre(0, 0, 1));
}

// --- vertices with more than one fan
// -----------------------------------------------------------------------------------

TEST(Repair, SplitsABowTieInsideAndTiesIt) {
  TriangleMesh mesh = octahedron({0, 0, 0});
  append(mesh, octahedron({2, 0, 0}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.surface.component_count, 2U);
  EXPECT_EQ(repaired(r, "bow_ties"), 1U);
  EXPECT_EQ(r.surface.position.size(), 12U);
  EXPECT_EQ(r.surface.point_count, 11U);
  EXPECT_EQ(r.cleaned.bow_tie_vertices, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 3);
}

// Pleats whose folds touch are joined there and cannot open, which has to be said. What hangs on a point or an edge of
// the file, or is a loose border on other cloth, is meant to hold.
TEST(Repair, CountsWherePiecesOnlyTouch) {
  TriangleMesh touching = octahedron({0, 0, 0});
  append(touching, octahedron({2, 0, 0}));
  EXPECT_EQ(repair(touching).touching_points, 1U);
  TriangleMesh joined = touching;  // by one vertex of the file
  uint32_t first = kNone;
  for (Triangle& t : joined.triangle) {
    for (uint32_t& v : t) {
      if (joined.position[v] != Point3{1, 0, 0}) continue;
      if (first == kNone) first = v;
      v = first;
    }
  }
  EXPECT_EQ(repair(joined).touching_points, 0U);
  TriangleMesh twice = octahedron({0, 0, 0});  // drawn twice, which is one body
  append(twice, octahedron({0, 0, 0}));
  EXPECT_EQ(repair(twice).touching_points, 0U);
  TriangleMesh flap = sheet(4, 4);  // stands on the middle of another with vertices of its own
  for (Point3& p : flap.position) p = {p[0], p[2], p[1]};
  TriangleMesh sewn = sheet(4, 4);
  const double middle = sewn.position[12][1];
  for (Point3& p : flap.position) p[1] += middle;
  append(sewn, flap);
  const RepairResult r = repair(sewn);
  EXPECT_GT(repaired(r, "detached_sheets"), 0U);
  EXPECT_EQ(r.touching_points, 0U);
}

TEST(Repair, SplitsABowTieOnABorder) {
  // Two holes of a sheet that touch in a corner: one component, two fans at the middle point.
  TriangleMesh mesh = sheet(4, 4);
  std::vector<Triangle> kept;
  std::vector<uint32_t> polygon;
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    if (mesh.polygon[i] == 5 || mesh.polygon[i] == 10) continue;
    kept.push_back(mesh.triangle[i]);
    polygon.push_back(mesh.polygon[i]);
  }
  mesh.triangle = kept;
  mesh.polygon = polygon;
  mesh.part[0].triangle_count = static_cast<uint32_t>(kept.size());
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "bow_ties"), 1U);
  EXPECT_EQ(r.surface.component_count, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 2U);
  EXPECT_EQ(r.cleaned.euler_characteristic, -1);
}

// --- surfaces with one side ------------------------------------------------------------------------------------------

TriangleMesh moebius(uint32_t around, uint32_t across) {
  std::vector<Point3> p;
  std::vector<std::vector<uint32_t>> quads;
  for (uint32_t i = 0; i < around; ++i) {
    const double u = 2 * std::numbers::pi * i / around;
    for (uint32_t j = 0; j <= across; ++j) {
      const double w = 0.8 * (double(j) / across - 0.5), r = 1 + w * std::cos(u / 2);
      p.push_back({r * std::cos(u), r * std::sin(u), w * std::sin(u / 2)});
    }
  }
  const auto id = [&](uint32_t i, uint32_t j) { return i < around ? i * (across + 1) + j : across - j; };
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < across; ++j) quads.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
  }
  return make_mesh(std::move(p), quads);
}

TEST(Repair, TearsAMoebiusStripOnce) {
  const RepairResult r = repair(moebius(24, 4));
  EXPECT_EQ(repaired(r, "torn_edges"), 4U);
  EXPECT_EQ(r.surface.component_count, 1U);
  EXPECT_FALSE(r.cleaned.orientable);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 0);
}

TEST(Repair, TearsAMoebiusStripOfOneQuadAcross) {
  const RepairResult r = repair(moebius(7, 1));
  EXPECT_FALSE(r.cleaned.orientable);
  EXPECT_EQ(r.cleaned.components, 1U);
}

// --- poles -----------------------------------------------------------------------------------------------------------

/// A sphere as programs compute it, row by row; the rows at its poles are rings as wide as the rounding errors.
TriangleMesh sphere_with_rings(double pole) {
  constexpr uint32_t kAround = 16, kRows = 8;
  std::vector<Point3> p;
  std::vector<std::vector<uint32_t>> quads;
  for (uint32_t j = 0; j <= kRows; ++j) {
    const double v = std::numbers::pi * j / kRows, r = j == 0 || j == kRows ? pole : std::sin(v);
    for (uint32_t i = 0; i < kAround; ++i) {
      const double u = 2 * std::numbers::pi * i / kAround;
      p.push_back({r * std::cos(u), std::cos(v), r * std::sin(u)});
    }
  }
  for (uint32_t j = 0; j < kRows; ++j) {
    for (uint32_t i = 0; i < kAround; ++i) {
      const uint32_t a = j * kAround + i, b = j * kAround + (i + 1) % kAround;
      quads.push_back({a, b, b + kAround, a + kAround});
    }
  }
  return make_mesh(std::move(p), quads);
}

// Pompoms, caps and buttons made by a formula were refused, or came out stretched a thousandfold: their poles were
// holes of 1e-16 m, whose edges kept the vertices there apart.
TEST(Repair, APoleThatRoundingErrorsOpenIsOnePoint) {
  for (const double pole : {0.0, 1e-17, 1e-12, 1e-8}) {
    const RepairResult r = repair(sphere_with_rings(pole));
    EXPECT_EQ(r.cleaned.boundary_loops, 0U) << pole;
    EXPECT_EQ(r.cleaned.euler_characteristic, 2) << pole;
  }
}

TEST(Repair, ASmallOpeningAtAPoleStaysOpen) {
  const RepairResult r = repair(sphere_with_rings(1e-4));
  EXPECT_EQ(r.cleaned.boundary_loops, 2U);
}

// --- T-junctions and triangles without area --------------------------------------------------------------------------

TEST(Repair, WeldsSheetsOfDifferentResolution) {
  // Two sheets share the line x = 4; the right one has twice and a half as many points on it.
  TriangleMesh mesh = sheet(4, 4);
  TriangleMesh fine = sheet(5, 10);
  for (Point3& p : fine.position) p = {4 + p[0] * 0.4, p[1] * 0.4, 0};
  append(mesh, fine);
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
  EXPECT_EQ(r.cleaned.bow_tie_vertices, 0U);
  EXPECT_EQ(repaired(r, "t_junctions"), 8U + 2U);
}

/// Vertices numbered otherwise, triangles in another order.
TriangleMesh shuffled(TriangleMesh mesh) {
  std::mt19937 random(5);
  std::vector<uint32_t> number(mesh.position.size());
  std::iota(number.begin(), number.end(), 0U);
  std::shuffle(number.begin(), number.end(), random);
  std::vector<Point3> position(number.size());
  for (uint32_t v = 0; v < number.size(); ++v) position[number[v]] = mesh.position[v];
  mesh.position = std::move(position);
  for (Triangle& t : mesh.triangle) {
    for (uint32_t& v : t) v = number[v];
  }
  std::shuffle(mesh.triangle.begin(), mesh.triangle.end(), random);
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.part = {{"all", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  return mesh;
}

std::vector<Point3> sorted_places(const CleanSurface& surface) {
  std::vector<Point3> places = surface.position;
  std::sort(places.begin(), places.end());
  return places;
}

// Where points of the two sides nearly met, up to a twentieth of an edge apart, the seam stayed open on both sides of
// them: a hole for every tenth point.
TEST(Repair, SewsSeamsOfUnlikeCountsAllAlong) {
  for (const auto& [left, right] : {std::pair{20U, 53U}, {31U, 40U}, {60U, 61U}, {99U, 100U}, {1U, 90U}}) {
    SCOPED_TRACE(std::to_string(left) + " against " + std::to_string(right));
    TriangleMesh mesh = unit_sheet(5, left, [](double u, double v) { return Point3{u / 2, v, 0}; });
    append(mesh, unit_sheet(5, right, [](double u, double v) { return Point3{(1 + u) / 2, v, 0}; }));
    const RepairResult r = repair_mesh(mesh);
    expect_one_sheet(r);
    EXPECT_EQ(find_cracks(r.surface).edges, 0U);
    EXPECT_EQ(sorted_places(repair_mesh(shuffled(mesh)).surface), sorted_places(r.surface));
  }
}

TEST(Repair, SewsATubeOfTwoPanelsOfUnlikeCounts) {
  TriangleMesh mesh = unit_sheet(9, 40, [](double u, double v) { return Point3{u, v, std::sin(3 * u * (1 - u))}; });
  append(mesh, unit_sheet(7, 31, [](double u, double v) { return Point3{u, v, -std::sin(3 * u * (1 - u))}; }));
  const RepairResult r = repair_mesh(mesh);
  EXPECT_EQ(r.cleaned.boundary_loops, 2U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 0);
}

// Along a bend the points of one side lie beside the edges of the other, as far as it is bent.
TEST(Repair, SewsCurvedSeamsOfUnlikeCountsWithinTheDistanceThatIsGiven) {
  const auto seam = [](double v) { return 0.5 + 0.1 * std::sin(3 * v); };
  for (const double gap : {0.0, 0.0005}) {
    TriangleMesh mesh = unit_sheet(9, 40, [&](double u, double v) { return Point3{u * seam(v), v, 0}; });
    append(mesh, unit_sheet(7, 31, [&](double u, double v) { return Point3{seam(v) + gap + u / 2, v, 0}; }));
    for (const double weld : {0.0008, 0.001, 0.002, 0.004}) {
      SCOPED_TRACE(std::to_string(gap) + " apart, welded within " + std::to_string(weld));
      expect_one_sheet(repair_mesh(mesh, {.weld_distance = weld}));
    }
  }
}

// A narrow strip sewn to a wide one: the wide edge goes on beyond the seam.
TEST(Repair, SewsAnEdgeToAPartOfALongerOne) {
  TriangleMesh mesh = sheet(1, 1);
  append(mesh, unit_sheet(2, 3, [](double u, double v) { return Point3{1 + u, 0.25 + 0.5 * v, 0}; }));
  expect_one_sheet(repair(mesh));
}

// Cards of hair whose edges cross at a small angle lie along each other for a short way only.
TEST(Repair, DoesNotSewEdgesThatCrossAtASmallAngle) {
  TriangleMesh mesh = sheet(2, 2);
  append(mesh, unit_sheet(2, 2, [](double u, double v) { return Point3{0.05 + 2 * u, 1e-5 * (u - 0.01), 2 * v}; }));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "t_junctions"), 0U);
  EXPECT_EQ(r.cleaned.components, 2U);
}

// Cloth that rests on cloth is not sewn to it.
TEST(Repair, DoesNotSewATouchingCornerToAnEdge) {
  TriangleMesh mesh = sheet(2, 2);
  append(mesh, make_mesh({{2, 0.5, 0}, {3, 0.2, 1}, {3, 0.8, 1}}, {{0, 1, 2}}));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(repaired(r, "t_junctions"), 0U);
  EXPECT_EQ(r.cleaned.components, 2U);
}

TEST(Repair, ReplacesAFlatTriangleWithoutACrack) {
  // Triangle 0-1-4 has no area: 4 lies on the side 0-1 of the triangle below.
  const RepairResult r = repair(make_mesh({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -2, 0}, {1, 0, 0}},
                                          {{0, 4, 2}, {4, 1, 2}, {0, 1, 4}, {1, 0, 3}}));
  EXPECT_EQ(repaired(r, "zero_area_faces"), 1U);
  EXPECT_EQ(r.surface.triangle.size(), 4U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
  EXPECT_EQ(r.cleaned.edges, 8U);
}

// Two vertices a millionth of an edge apart: needles round the end that they share were taken for flat triangles, each
// replaced by the next round it; where many met, tens of thousands, until the work was given up.
TEST(Repair, KeepsNeedlesRoundAVertex) {
  constexpr uint32_t kSpokes = 36;
  for (uint32_t towards = 0; towards < kSpokes; ++towards) {
    const auto on_circle = [](double turn, double radius) {
      return Point3{radius * std::cos(2 * std::numbers::pi * turn), radius * std::sin(2 * std::numbers::pi * turn), 0};
    };
    std::vector<Point3> position{{0, 0, 0}, on_circle((towards + 0.5) / kSpokes, 2e-6)};
    std::vector<std::vector<uint32_t>> faces{{0, 2, 1}, {1, 2, 3}, {0, 1, 3}};
    for (uint32_t i = 0; i < kSpokes; ++i) {
      position.push_back(on_circle(static_cast<double>(i) / kSpokes, 1));
      if (i > 0) faces.push_back({0, 2 + i, 2 + (i + 1) % kSpokes});
    }
    const RepairResult r = repair(make_mesh(position, faces));
    EXPECT_LE(repaired(r, "zero_area_faces"), 2U) << towards;
    EXPECT_EQ(r.cleaned.euler_characteristic, 1) << towards;
    EXPECT_EQ(r.cleaned.boundary_loops, 1U) << towards;
  }
}

TEST(Repair, ReplacesARowOfFlatTriangles) {
  // A fan of flat triangles from (0,0,0) along the x axis, a sheet above and below.
  std::vector<Point3> p{{0, 0, 0}};
  for (int i = 1; i <= 6; ++i) p.push_back({double(i), 0, 0});
  p.push_back({3, 2, 0});
  p.push_back({3, -2, 0});
  std::vector<std::vector<uint32_t>> t;
  for (uint32_t i = 0; i < 6; ++i) t.push_back({i, i + 1, 7});
  for (uint32_t i = 1; i < 6; ++i) t.push_back({0, i + 1, i});
  t.push_back({6, 0, 8});
  const RepairResult r = repair(make_mesh(p, t));
  EXPECT_EQ(r.cleaned.components, 1U);
  EXPECT_EQ(r.cleaned.boundary_loops, 1U);
  EXPECT_EQ(r.cleaned.euler_characteristic, 1);
  EXPECT_EQ(r.cleaned.vertices, 9U);
}

// --- independence of order
// ---------------------------------------------------------------------------------------------

TEST(Repair, TopologyDoesNotDependOnTheOrderOfTheFile) {
  TriangleMesh mesh = patch_with_pocket();
  append(mesh, octahedron({20, 0, 0}));
  append(mesh, octahedron({22, 0, 0}));
  const RepairResult straight = repair(mesh);
  std::vector<uint32_t> order(mesh.triangle.size());
  for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(3);
  std::shuffle(order.begin(), order.end(), random);
  TriangleMesh shuffled = mesh;
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.triangle[i] = mesh.triangle[order[i]];
  shuffled.polygon.clear();
  for (uint32_t i = 0; i < order.size(); ++i) shuffled.polygon.push_back(i);
  shuffled.part = {{"all", 0, 0, static_cast<uint32_t>(order.size())}};
  const RepairResult r = repair(shuffled);
  EXPECT_EQ(r.cleaned.euler_characteristic, straight.cleaned.euler_characteristic);
  EXPECT_EQ(r.surface.component_count, straight.surface.component_count);
  EXPECT_EQ(r.surface.position.size(), straight.surface.position.size());
}

// --- random rubbish
// ----------------------------------------------------------------------------------------------------

/// A process for each would take longer than its repair.
constexpr uint32_t kSoupsOfATest = 50;
class RandomSoup : public ::testing::TestWithParam<uint32_t> {};

void repair_soup(uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&](uint32_t limit) { return static_cast<uint32_t>(random() % limit); };
  const uint32_t points = 4 + below(12), faces = 1 + below(60), grid = 2 + below(3);
  std::vector<Point3> p;
  for (uint32_t i = 0; i < points; ++i) {
    p.push_back({double(below(grid)), double(below(grid)), double(below(grid))});
  }
  std::vector<std::vector<uint32_t>> t;
  for (uint32_t i = 0; i < faces; ++i) {
    t.push_back({below(points), below(points), below(points)});
  }
  try {
    static_cast<void>(repair(make_mesh(p, t)));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_data);  // nothing but flat triangles
  }
}

TEST_P(RandomSoup, AlwaysGivesACleanSurface) {
  for (uint32_t seed = GetParam(); seed < GetParam() + kSoupsOfATest; ++seed) {
    SCOPED_TRACE(seed);
    repair_soup(seed);
  }
}

INSTANTIATE_TEST_SUITE_P(SeedsFrom, RandomSoup, ::testing::Range(0U, 400U, kSoupsOfATest),
                         [](const auto& test) { return std::to_string(test.param); });

// --- real meshes
// -------------------------------------------------------------------------------------------------------

std::filesystem::path mesh_folder() {
  return std::filesystem::path(GEOCLOTH_SOURCE_DIR) / ".." / "shared" / "meshes";
}

using Row = std::map<std::string, std::string>;

std::vector<Row> read_index() {
  std::ifstream file(mesh_folder() / "INDEX.tsv");
  std::vector<std::string> header;
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    Row row;
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, '\t'); ++column) {
      if (rows.empty() && header.size() == column && row.empty()) {
        header.push_back(cell);
      } else if (column < header.size()) {
        row[header[column]] = cell;
      }
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

class RealMesh : public ::testing::TestWithParam<Row> {};

std::string test_name(const ::testing::TestParamInfo<Row>& info) {
  std::string name = info.param.at("name");
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

TEST_P(RealMesh, KeepsTheTopologyThatAnotherProgramCounted) {
  const Row& row = GetParam();
  const TriangleMesh mesh = import_mesh(mesh_folder() / row.at("name"));
  const auto number = [&](const std::string& column) { return std::stoll(row.at(column)); };
  EXPECT_EQ(mesh.polygon.back() + 1, number("F") + number("collapsed faces") + number("duplicate faces"));
  const RepairResult r = repair(mesh);
  EXPECT_EQ(r.cleaned.vertices, number("V"));
  EXPECT_EQ(r.cleaned.components, number("components"));
  EXPECT_EQ(r.cleaned.euler_characteristic, number("Euler characteristic"));
  // Where faces without area or on top of others were taken away, edges around them have fewer faces than counted.
  if (repaired(r, "zero_area_faces") + repaired(r, "duplicate_faces") > 0) return;
  EXPECT_EQ(r.cleaned.boundary_loops, number("boundary loops"));
  EXPECT_EQ(r.cleaned.non_manifold_edges, number("non-manifold edges"));
  EXPECT_EQ(r.cleaned.bow_tie_vertices, number("bow-tie (non-manifold) vertices"));
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMesh, ::testing::ValuesIn(read_index()), test_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RealMesh);  // the meshes are not part of the repository

}  // namespace
}  // namespace geocloth
