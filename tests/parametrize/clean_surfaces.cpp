// SPDX-License-Identifier: GPL-3.0-or-later
#include "parametrize/clean_surfaces.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>

namespace geocloth::test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Numbers components and ties vertices: each vertex its own point unless `point` is given.
CleanSurface finish(std::vector<Point3> position, std::vector<Triangle> triangle, std::vector<uint32_t> point = {}) {
  CleanSurface s;
  s.position = std::move(position);
  s.triangle = std::move(triangle);
  s.point = std::move(point);
  if (s.point.empty()) {
    s.point.resize(s.position.size());
    std::iota(s.point.begin(), s.point.end(), 0U);
  }
  for (const uint32_t p : s.point) s.point_count = std::max(s.point_count, p + 1);
  std::vector<uint32_t> root(s.position.size());
  std::iota(root.begin(), root.end(), 0U);
  const std::function<uint32_t(uint32_t)> find = [&](uint32_t v) { return root[v] == v ? v : root[v] = find(root[v]); };
  for (const auto& [a, b, c] : s.triangle) root[find(a)] = root[find(b)] = find(c);
  std::map<uint32_t, uint32_t> number;
  for (const Triangle& t : s.triangle) {
    s.component.push_back(number.try_emplace(find(t[0]), static_cast<uint32_t>(number.size())).first->second);
  }
  s.component_count = static_cast<uint32_t>(number.size());
  s.source_triangle.resize(s.triangle.size());
  std::iota(s.source_triangle.begin(), s.source_triangle.end(), 0U);
  return s;
}

CleanSurface grid(const GridSurface& g, const std::function<Point3(uint32_t, uint32_t)>& at) {
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  for (uint32_t y = 0; y < g.ny; ++y) {
    for (uint32_t x = 0; x < g.nx; ++x) position.push_back(at(x, y));
  }
  const auto v = [&](uint32_t x, uint32_t y) { return y % g.ny * g.nx + x % g.nx; };
  for (uint32_t y = 0; y + (g.wrap_y ? 0U : 1U) < g.ny; ++y) {
    for (uint32_t x = 0; x + (g.wrap_x ? 0U : 1U) < g.nx; ++x) {
      triangle.push_back({v(x, y), v(x + 1, y), v(x + 1, y + 1)});
      triangle.push_back({v(x, y), v(x + 1, y + 1), v(x, y + 1)});
    }
  }
  return finish(std::move(position), std::move(triangle));
}

double share(uint32_t i, uint32_t n) {
  return static_cast<double>(i) / n;
}

}  // namespace

TriangleMesh as_mesh(std::vector<Point3> position, std::vector<Triangle> triangle) {
  TriangleMesh mesh;
  mesh.name = "garment";
  mesh.position = std::move(position);
  mesh.triangle = std::move(triangle);
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.part = {{"garment", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  mesh.material.emplace_back();
  return mesh;
}

CleanSurface disk(uint32_t nx, uint32_t ny, double width, double height) {
  return grid({nx, ny}, [&](uint32_t x, uint32_t y) {
    return Point3{width * share(x, nx - 1), height * share(y, ny - 1), 0.1 * width * std::sin(3 * share(x, nx - 1))};
  });
}

CleanSurface cylinder(uint32_t around, uint32_t along, double radius, double height) {
  return grid({around, along, true}, [&](uint32_t x, uint32_t y) {
    const double a = kTurn * share(x, around);
    return Point3{radius * std::sin(a), height * share(y, along - 1), radius * std::cos(a)};
  });
}

CleanSurface torus(uint32_t around, uint32_t along) {
  return grid({around, along, true, true}, [&](uint32_t x, uint32_t y) {
    const double a = kTurn * share(x, around), b = kTurn * share(y, along);
    const double r = 2 + std::cos(a);
    return Point3{r * std::cos(b), std::sin(a), r * std::sin(b)};
  });
}

CleanSurface sphere(uint32_t around, uint32_t along) {
  CleanSurface s = grid({around, along - 1, true}, [&](uint32_t x, uint32_t y) {
    const double a = kTurn * share(x, around), b = std::numbers::pi * share(y + 1, along);
    return Point3{std::sin(a) * std::sin(b), -std::cos(b), std::cos(a) * std::sin(b)};
  });
  const auto south = static_cast<uint32_t>(s.position.size()), north = south + 1, top = (along - 2) * around;
  s.position.push_back({0, -1, 0});
  s.position.push_back({0, 1, 0});
  for (uint32_t x = 0; x < around; ++x) {
    s.triangle.push_back({south, (x + 1) % around, x});
    s.triangle.push_back({north, top + x, top + (x + 1) % around});
  }
  return finish(std::move(s.position), std::move(s.triangle));
}

CleanSurface tetrahedron() {
  return finish({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
}

CleanSurface single_triangle() {
  return finish({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
}

CleanSurface moebius(uint32_t around, uint32_t across) {
  CleanSurface s = grid({around + 1, across}, [&](uint32_t x, uint32_t y) {
    // The last column is exactly the first one upside down.
    const double a = kTurn * share(x % around, around);
    const double t = (x == around ? -1.0 : 1.0) * (2 * share(y, across - 1) - 1) * 0.4;
    const double r = 1 + t * std::cos(a / 2);
    return Point3{r * std::cos(a), t * std::sin(a / 2), r * std::sin(a)};
  });
  std::vector<uint32_t> point;
  for (uint32_t y = 0; y < across; ++y) {
    for (uint32_t x = 0; x <= around; ++x) {
      const uint32_t row = x == around ? across - 1 - y : y;
      point.push_back(row * around + x % around);
      s.position[y * (around + 1) + x] = s.position[row * (around + 1) + x % around];
    }
  }
  return finish(std::move(s.position), std::move(s.triangle), std::move(point));
}

CleanSurface sheet_with_flap(uint32_t nx, uint32_t ny) {
  CleanSurface s = disk(nx, ny);
  const uint32_t row = ny / 2, first = static_cast<uint32_t>(s.position.size());
  std::vector<uint32_t> point = s.point;
  // The flap is sewn on between columns 1 and nx - 2.
  const uint32_t width = nx - 2, height = 3;
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t below = row * nx + x + 1;
      s.position.push_back(
          {s.position[below][0], s.position[below][1], s.position[below][2] + 0.2 * share(y, height - 1)});
      point.push_back(y == 0 ? below : first + y * width + x);
    }
  }
  const auto v = [&](uint32_t x, uint32_t y) { return first + y * width + x; };
  for (uint32_t y = 0; y + 1 < height; ++y) {
    for (uint32_t x = 0; x + 1 < width; ++x) {
      s.triangle.push_back({v(x, y), v(x + 1, y), v(x + 1, y + 1)});
      s.triangle.push_back({v(x, y), v(x + 1, y + 1), v(x, y + 1)});
    }
  }
  return finish(std::move(s.position), std::move(s.triangle), std::move(point));
}

CleanSurface cylinder_with_belt(uint32_t around, uint32_t along) {
  CleanSurface s = cylinder(around, along);
  const CleanSurface belt = cylinder(around, 3, 1.0, 0.2);
  const uint32_t row = along / 2, first = static_cast<uint32_t>(s.position.size());
  std::vector<uint32_t> point = s.point;
  for (uint32_t i = 0; i < belt.position.size(); ++i) {
    const uint32_t below = row * around + i % around;
    const double out = 1 + 0.3 * share(i / around, 2);
    const Point3& p = s.position[below];
    point.push_back(i < around ? below : first + i);
    s.position.push_back({p[0] * out, p[1] + (out - 1), p[2] * out});
    if (i < around) s.position.back() = p;
  }
  for (const auto& [a, b, c] : belt.triangle) s.triangle.push_back({first + a, first + b, first + c});
  return finish(std::move(s.position), std::move(s.triangle), std::move(point));
}

CleanSurface sphere_with_fin() {
  CleanSurface s = sphere(8, 6);
  std::vector<uint32_t> point = s.point;
  const auto first = static_cast<uint32_t>(s.position.size());
  for (const uint32_t below : {9U, 10U}) {
    s.position.push_back(s.position[below]);
    point.push_back(below);
  }
  s.position.push_back({2, 0, 2});
  point.push_back(first);
  s.triangle.push_back({first, first + 1, first + 2});
  return finish(std::move(s.position), std::move(s.triangle), std::move(point));
}

CleanSurface touching_spheres() {
  CleanSurface s = sphere(8, 6);
  const auto count = static_cast<uint32_t>(s.position.size());
  std::vector<uint32_t> point = s.point;
  std::vector<Triangle> triangle = s.triangle;
  for (uint32_t v = 0; v < count; ++v) {
    s.position.push_back({s.position[v][0], s.position[v][1] + 2, s.position[v][2]});
    point.push_back(count + v);
  }
  for (const auto& [a, b, c] : s.triangle) triangle.push_back({count + a, count + b, count + c});
  point[count + count - 2] = count - 1;  // the second one's south pole is the first one's north pole
  s.position[count + count - 2] = s.position[count - 1];
  return finish(std::move(s.position), std::move(triangle), std::move(point));
}

CleanSurface sheet_with_holes(uint32_t holes_x, uint32_t holes_y, bool touching) {
  const uint32_t pitch = touching ? 1 : 4;
  const uint32_t nx = 2 * 3 + holes_x * pitch + 1, ny = 2 * 3 + holes_y * pitch + 1;
  const CleanSurface full = disk(nx, ny);
  std::vector<Triangle> triangle;
  for (uint32_t t = 0; t < full.triangle.size(); ++t) {
    const uint32_t quad = t / 2, x = quad % (nx - 1), y = quad / (nx - 1);
    const bool inside = x >= 3 && y >= 3 && x < 3 + holes_x * pitch && y < 3 + holes_y * pitch;
    const bool hole = inside && (touching ? (x + y) % 2 == 0 : (x - 3) % pitch == 1 && (y - 3) % pitch == 1);
    if (!hole) triangle.push_back(full.triangle[t]);
  }
  if (!touching) return finish(full.position, std::move(triangle));
  // Corners of holes that meet make bow ties: every fan of triangles gets a vertex of its own, tied by its point.
  std::vector<Point3> position;
  std::vector<uint32_t> point;
  const auto shares_edge = [](const Triangle& a, const Triangle& b) {
    int common = 0;
    for (const uint32_t v : a) common += v == b[0] || v == b[1] || v == b[2] ? 1 : 0;
    return common >= 2;
  };
  std::vector<std::vector<uint32_t>> around(full.position.size());
  for (uint32_t t = 0; t < triangle.size(); ++t) {
    for (const uint32_t v : triangle[t]) around[v].push_back(t);
  }
  std::vector<Triangle> renumbered = triangle;
  for (uint32_t v = 0; v < around.size(); ++v) {
    std::vector<char> done(around[v].size(), 0);
    for (size_t i = 0; i < around[v].size(); ++i) {
      if (done[i]) continue;
      std::vector<size_t> fan{i};
      done[i] = 1;
      for (size_t k = 0; k < fan.size(); ++k) {
        for (size_t j = 0; j < around[v].size(); ++j) {
          if (done[j] || !shares_edge(triangle[around[v][fan[k]]], triangle[around[v][j]])) continue;
          done[j] = 1;
          fan.push_back(j);
        }
      }
      for (const size_t k : fan) {
        for (size_t c = 0; c < 3; ++c) {
          if (triangle[around[v][k]][c] == v) renumbered[around[v][k]][c] = static_cast<uint32_t>(position.size());
        }
      }
      position.push_back(full.position[v]);
      point.push_back(v);
    }
  }
  return finish(std::move(position), std::move(renumbered), std::move(point));
}

CleanSurface shirt(uint32_t detail) {
  // A flattened tube along y whose upper end is sewn together at the shoulders but for the neck; sleeves are openings
  // in its sides, extended by tubes.
  const uint32_t n = 2 * detail;  // columns of the front, and of the back
  const uint32_t rows = 3 * detail;
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  std::map<std::array<uint32_t, 3>, uint32_t> number;  // column, row, side (front or back)
  const auto v = [&](uint32_t x, uint32_t y, uint32_t side) {
    const bool shoulder = y == rows && (x <= n / 3 || x >= n - n / 3);
    const bool side_seam = x == 0 || x == n;
    const bool armhole = y > rows - detail && y < rows;
    if (shoulder || (side_seam && !armhole)) side = 0;
    const auto [at, fresh] = number.try_emplace({x, y, side}, static_cast<uint32_t>(position.size()));
    if (fresh) {
      const double bulge = 0.2 * std::sin(std::numbers::pi * share(x, n)) * (y == rows ? 0.4 : 1.0);
      const double side_bulge = side_seam && armhole ? 0.05 : 0.0;
      position.push_back({share(x, n) - 0.5, 1.3 * share(y, rows), (side == 0 ? 1 : -1) * (bulge + side_bulge)});
    }
    return at->second;
  };
  for (uint32_t side = 0; side < 2; ++side) {
    for (uint32_t y = 0; y < rows; ++y) {
      for (uint32_t x = 0; x < n; ++x) {
        Triangle a{v(x, y, side), v(x + 1, y, side), v(x + 1, y + 1, side)};
        Triangle b{v(x, y, side), v(x + 1, y + 1, side), v(x, y + 1, side)};
        if (side == 1) {
          std::swap(a[1], a[2]);
          std::swap(b[1], b[2]);
        }
        triangle.push_back(a);
        triangle.push_back(b);
      }
    }
  }
  for (const uint32_t x : {0U, n}) {
    std::vector<uint32_t> ring;
    for (uint32_t y = rows - detail; y <= rows; ++y) ring.push_back(v(x, y, 0));
    for (uint32_t y = rows - 1; y > rows - detail; --y) ring.push_back(v(x, y, 1));
    for (uint32_t k = 1; k <= detail; ++k) {
      std::vector<uint32_t> next;
      for (const uint32_t r : ring) {
        next.push_back(static_cast<uint32_t>(position.size()));
        const Point3 p = position[r];
        position.push_back({p[0] + (x == 0 ? -0.4 : 0.4) / detail, p[1] - 0.1 / detail, p[2]});
      }
      for (size_t i = 0; i < ring.size(); ++i) {
        const size_t j = (i + 1) % ring.size();
        const Triangle a{ring[i], ring[j], next[j]}, b{ring[i], next[j], next[i]};
        triangle.push_back(x != 0 ? Triangle{a[0], a[2], a[1]} : a);
        triangle.push_back(x != 0 ? Triangle{b[0], b[2], b[1]} : b);
      }
      ring = next;
    }
  }
  return finish(std::move(position), std::move(triangle));
}

void PrintTo(const NamedSurface& s, std::ostream* out) {
  *out << s.name;
}

std::vector<NamedSurface> surfaces_of_every_topology() {
  return {{"disk", [] { return disk(9, 7); }},
          {"ribbon", [] { return disk(200, 4, 50, 1); }},
          {"cylinder", [] { return cylinder(16, 9); }},
          {"tube", [] { return cylinder(12, 60, 0.3, 8); }},
          {"torus", [] { return torus(12, 16); }},
          {"coarse_torus", [] { return torus(3, 3); }},
          {"sphere", [] { return sphere(12, 8); }},
          {"tetrahedron", [] { return tetrahedron(); }},
          {"single_triangle", [] { return single_triangle(); }},
          {"moebius", [] { return moebius(24, 5); }},
          {"sheet_with_flap", [] { return sheet_with_flap(9, 7); }},
          {"cylinder_with_belt", [] { return cylinder_with_belt(16, 9); }},
          {"touching_spheres", [] { return touching_spheres(); }},
          {"sphere_with_fin", [] { return sphere_with_fin(); }},
          {"holes", [] { return sheet_with_holes(3, 2, false); }},
          {"touching_holes", [] { return sheet_with_holes(4, 4, true); }},
          {"shirt", [] { return shirt(6); }}};
}

}  // namespace geocloth::test
