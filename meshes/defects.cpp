// SPDX-License-Identifier: GPL-3.0-or-later
// One tiny mesh per defect that real garment files have (as xatlas keeps them), and the small closed and
// non-orientable surfaces that a cut has to open.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mesh_file.h"

namespace geocloth::meshes {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSize = 0.1;  // [m] of a grid cell

/// columns x rows cells of two triangles each in the plane z = 0, +z outside.
ObjMesh make_sheet(std::string name, std::string comment, uint32_t columns, uint32_t rows) {
  ObjMesh mesh{.name = std::move(name), .comment = std::move(comment)};
  for (uint32_t y = 0; y <= rows; ++y) {
    for (uint32_t x = 0; x <= columns; ++x) mesh.position.push_back({kSize * x, kSize * y, 0});
  }
  const uint32_t stride = columns + 1;
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const uint32_t a = y * stride + x;
      mesh.face.push_back({a, a + 1, a + stride + 1});
      mesh.face.push_back({a, a + stride + 1, a + stride});
    }
  }
  return mesh;
}

ObjMesh make_non_manifold_edge() {
  ObjMesh mesh = make_sheet("non_manifold_edge", "A sheet with a fin: four edges have three faces", 4, 4);
  // The fin stands on the middle column, vertices 2, 7, 12, 17, 22.
  for (uint32_t y = 0; y <= 4; ++y) mesh.position.push_back({kSize * 2, kSize * y, kSize});
  for (uint32_t y = 0; y < 4; ++y) {
    const uint32_t below = 5 * y + 2, above = 5 * y + 7, tip = 25 + y;
    mesh.face.push_back({below, above, tip + 1});
    mesh.face.push_back({below, tip + 1, tip});
  }
  return mesh;
}

ObjMesh make_bow_tie() {
  ObjMesh mesh = make_sheet("bow_tie", "Two sheets that share one vertex", 2, 2);
  for (uint32_t y = 0; y <= 2; ++y) {
    for (uint32_t x = 0; x <= 2; ++x) {
      if (x + y > 0) mesh.position.push_back({kSize * (2 + x), kSize * (2 + y), 0});
    }
  }
  const auto second = [](uint32_t x, uint32_t y) { return x + y == 0 ? 8U : 8U + 3 * y + x; };
  for (uint32_t y = 0; y < 2; ++y) {
    for (uint32_t x = 0; x < 2; ++x) {
      mesh.face.push_back({second(x, y), second(x + 1, y), second(x + 1, y + 1)});
      mesh.face.push_back({second(x, y), second(x + 1, y + 1), second(x, y + 1)});
    }
  }
  return mesh;
}

ObjMesh make_t_junction() {
  return {.name = "t_junction",
          .comment = "A long edge against two short ones: vertex 5 lies inside the edge from 2 to 3",
          .position = {{0, 0, 0},
                       {0.2, 0, 0},
                       {0.2, 0.2, 0},
                       {0, 0.2, 0},
                       {0.2, 0.1, 0},
                       {0.4, 0, 0},
                       {0.4, 0.1, 0},
                       {0.4, 0.2, 0}},
          .face = {{0, 1, 2}, {0, 2, 3}, {1, 5, 6, 4}, {4, 6, 7, 2}}};
}

ObjMesh make_duplicate_face() {
  ObjMesh mesh = make_sheet("duplicate_face", "A face twice, another once more turned over", 3, 3);
  mesh.face.push_back(mesh.face[8]);
  mesh.face.push_back({mesh.face[3][0], mesh.face[3][2], mesh.face[3][1]});
  return mesh;
}

ObjMesh make_degenerate() {
  ObjMesh mesh =
      make_sheet("degenerate", "Faces without area: a repeated vertex, three points on a line, two at one place", 3, 3);
  mesh.position.push_back(mesh.position[0]);
  const uint32_t copy = 16;
  mesh.face.push_back({5, 5, 6});
  mesh.face.push_back({4, 5, 6});
  mesh.face.push_back({0, copy, 1});
  return mesh;
}

ObjMesh make_moebius() {
  constexpr uint32_t kAround = 24, kAcross = 4;
  ObjMesh mesh{.name = "moebius", .comment = "Moebius strip: no orientation"};
  for (uint32_t i = 0; i < kAround; ++i) {
    for (uint32_t j = 0; j <= kAcross; ++j) {
      const double angle = 2 * kPi * i / kAround, across = kSize * (static_cast<double>(j) / kAcross - 0.5) * 2;
      const double radius = 0.4 + across * std::cos(angle / 2);
      mesh.position.push_back({radius * std::cos(angle), across * std::sin(angle / 2), radius * std::sin(angle)});
    }
  }
  // After one turn the strip arrives upside down.
  const auto vertex = [](uint32_t i, uint32_t j) { return i < kAround ? i * (kAcross + 1) + j : kAcross - j; };
  for (uint32_t i = 0; i < kAround; ++i) {
    for (uint32_t j = 0; j < kAcross; ++j) {
      mesh.face.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  }
  return mesh;
}

ObjMesh make_unwelded() {
  const ObjMesh sheet = make_sheet("", "", 4, 4);
  ObjMesh mesh{.name = "unwelded", .comment = "Every triangle has vertices of its own"};
  for (const Face& face : sheet.face) {
    const auto first = static_cast<uint32_t>(mesh.position.size());
    for (const uint32_t v : face) mesh.position.push_back(sheet.position[v]);
    mesh.face.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

ObjMesh make_pocket() {
  ObjMesh mesh = make_sheet("pocket", "A pocket sewn on along three sides, open at the top", 6, 6);
  // The pocket covers cells 2..3 x 2..4; its top row of vertices and its inside stand off the sheet.
  const auto sheet = [](uint32_t x, uint32_t y) { return 7 * y + x; };
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> vertices;
  for (uint32_t y = 2; y <= 5; ++y) {
    for (uint32_t x = 2; x <= 4; ++x) {
      const bool sewn = y == 2 || x == 2 || x == 4;
      vertices[{x, y}] = sewn ? sheet(x, y) : static_cast<uint32_t>(mesh.position.size());
      if (!sewn) mesh.position.push_back({kSize * x, kSize * y, 0.03});
    }
  }
  for (uint32_t y = 2; y < 5; ++y) {
    for (uint32_t x = 2; x < 4; ++x) {
      const uint32_t a = vertices[{x, y}], b = vertices[{x + 1, y}], c = vertices[{x, y + 1}];
      // The other diagonal than the sheet's: theirs must not coincide in the pocket's corners.
      mesh.face.push_back({a, b, c});
      mesh.face.push_back({b, vertices[{x + 1, y + 1}], c});
    }
  }
  return mesh;
}

ObjMesh make_closed_sphere() {
  constexpr double kGolden = std::numbers::phi;
  ObjMesh mesh{.name = "closed_sphere", .comment = "Closed sphere: an icosahedron divided twice"};
  mesh.position = {{-1, kGolden, 0}, {1, kGolden, 0}, {-1, -kGolden, 0}, {1, -kGolden, 0},
                   {0, -1, kGolden}, {0, 1, kGolden}, {0, -1, -kGolden}, {0, 1, -kGolden},
                   {kGolden, 0, -1}, {kGolden, 0, 1}, {-kGolden, 0, -1}, {-kGolden, 0, 1}};
  mesh.face = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
               {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
               {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < 2; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(mesh.position.size()));
      if (is_new) {
        const Point3 &p = mesh.position[a], &q = mesh.position[b];
        mesh.position.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
      }
      return place->second;
    };
    std::vector<Face> divided;
    for (const Face& f : mesh.face) {
      const uint32_t ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      divided.insert(divided.end(), {{f[0], ab, ca}, {f[1], bc, ab}, {f[2], ca, bc}, {ab, bc, ca}});
    }
    mesh.face = std::move(divided);
  }
  constexpr double kRadius = 0.3;  // [m]
  for (Point3& p : mesh.position) {
    const double length = std::hypot(p[0], p[1], p[2]);
    for (double& x : p) x *= kRadius / length;
  }
  return mesh;
}

ObjMesh make_torus() {
  constexpr uint32_t kAround = 20, kTube = 10;
  ObjMesh mesh{.name = "torus", .comment = "Closed torus: one handle"};
  for (uint32_t i = 0; i < kAround; ++i) {
    for (uint32_t j = 0; j < kTube; ++j) {
      const double a = 2 * kPi * i / kAround, b = 2 * kPi * j / kTube, radius = 0.3 + 0.12 * std::cos(b);
      mesh.position.push_back({radius * std::cos(a), 0.12 * std::sin(b), -radius * std::sin(a)});
    }
  }
  const auto vertex = [](uint32_t i, uint32_t j) { return i % kAround * kTube + j % kTube; };
  for (uint32_t i = 0; i < kAround; ++i) {
    for (uint32_t j = 0; j < kTube; ++j) {
      mesh.face.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

ObjMesh make_opposite_orientations() {
  ObjMesh mesh = make_sheet("opposite_orientations", "One half of the faces turned over", 4, 4);
  for (std::size_t i = mesh.face.size() / 2; i < mesh.face.size(); ++i) std::swap(mesh.face[i][1], mesh.face[i][2]);
  return mesh;
}

ObjMesh make_single_triangle() {
  return {.name = "single_triangle",
          .comment = "The smallest mesh there is",
          .position = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.4, 0}},
          .face = {{0, 1, 2}}};
}

}  // namespace

std::vector<ObjMesh> make_defects() {
  return {make_non_manifold_edge(),
          make_bow_tie(),
          make_t_junction(),
          make_duplicate_face(),
          make_degenerate(),
          make_moebius(),
          make_unwelded(),
          make_pocket(),
          make_closed_sphere(),
          make_torus(),
          make_opposite_orientations(),
          make_single_triangle()};
}

}  // namespace geocloth::meshes
