// SPDX-License-Identifier: GPL-3.0-or-later
// Line relaxation, by which a frame ends: a pass must solve the equations of lib/lines.h for every run of springs, for
// what it leaves decides how far cloth on a body or on a ball hangs down too long.

#include "cpu/lines.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "cpu/sweep_plan.h"
#include "cpu/wide_rows.h"
#include "lib/lines.h"
#include "rest/upload.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

constexpr float kLimit = 1.002F;        ///< stretch_limit
constexpr double kDiagonal = 1.003456;  ///< of the equations with 8 substeps of a 1/60 s frame

/// A cloth between its substeps, pulled about, as the cpu keeps it.
struct PulledCloth {
  /// @param by  [m] that points are moved at most
  PulledCloth(const ClothAsset& asset, float by, const std::vector<uint32_t>& held)
      : rows(asset.width), state(rows.widened(make_cloth_data(test::describe(asset, {}), {})), false, false) {
    frame.params.stretch_limit = kLimit;
    frame.params.inverse_dt2 = 480 * 480;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> somewhere(-by, by);
    for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
      if (!asset.valid(p)) continue;
      const Vec3 x = 1.01F * asset.rest_position[p];
      state.position.set(rows.pixel(p), {x.x + somewhere(random), x.y + somewhere(random), x.z + somewhere(random)});
      state.previous.set(rows.pixel(p), {somewhere(random), 0.01F + somewhere(random), somewhere(random)});
    }
    for (const uint32_t p : held) state.inverse_mass[rows.pixel(p)] = 0;
  }

  void pass(uint32_t group) {
    const cpu::Threads threads(1);
    cpu::lines({FrameInput{}, frame, threads}, state, {Pass::lines, group});
  }

  /// The same by vectors.
  bool pass_in_vectors(uint32_t group) {
    const auto plan = cpu::SweepPlan::make(state, {{Pass::lines, group}}, frame, cpu::valid_runs(state), 1);
    if (!plan) return false;
    const cpu::LineStream& stream = plan->lines(group);
    std::vector<float> kept(cpu::kLinesAtOnce * cpu::line_kept(stream, plan->lanes()));
    cpu::run_lines(plan->lanes(), state, stream, group, 0, static_cast<uint32_t>(stream.blocks.size()), kept.data());
    return true;
  }

  [[nodiscard]] std::vector<Vec3> positions() const { return list_of(state.position); }
  /// In the last substep, as hold_way puts them aside.
  [[nodiscard]] std::vector<Vec3> ways() const { return list_of(state.previous); }

  cpu::WideRows rows;
  cpu::ClothState state;
  ClothFrame frame;

 private:
  [[nodiscard]] std::vector<Vec3> list_of(const cpu::Vec3Array& points) const {
    std::vector<Vec3> all;
    for (uint32_t p = 0; p < state.pixel_count(); ++p) {
      const shader::vec3 x = points.at(p);
      all.push_back({x.x, x.y, x.z});
    }
    return all;
  }
};

/// Solves a dense system by elimination.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const size_t n = b.size();
  for (size_t k = 0; k < n; ++k) {
    size_t best = k;
    for (size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[best][k])) best = i;
    std::swap(a[k], a[best]);
    std::swap(b[k], b[best]);
    for (size_t i = k + 1; i < n; ++i) {
      const double share = a[i][k] / a[k][k];
      for (size_t j = k; j < n; ++j) a[i][j] -= share * a[k][j];
      b[i] -= share * b[k];
    }
  }
  std::vector<double> x(n);
  for (size_t k = n; k-- > 0;) {
    x[k] = b[k];
    for (size_t j = k + 1; j < n; ++j) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
  }
  return x;
}

using Point = std::array<double, 3>;

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A run of springs in double precision.
struct Run {
  std::vector<Point> x, way;
  std::vector<double> w, longest;

  [[nodiscard]] size_t springs() const { return longest.size(); }
  [[nodiscard]] Point spring(const std::vector<Point>& of, size_t k) const {
    return {of[k + 1][0] - of[k][0], of[k + 1][1] - of[k][1], of[k + 1][2] - of[k][2]};
  }

  [[nodiscard]] std::vector<double> multipliers() const {
    const size_t n = springs();
    std::vector<Point> d(n);
    for (size_t k = 0; k < n; ++k) d[k] = spring(x, k);
    std::vector<std::vector<double>> a(n, std::vector<double>(n));
    std::vector<double> error(n), loose(n);
    for (size_t k = 0; k < n; ++k) {
      const double l2 = dot(d[k], d[k]), along = k > 0 ? dot(d[k - 1], d[k]) : 0;
      a[k][k] = kDiagonal * (w[k] + w[k + 1]) * l2;
      if (k > 0 && w[k - 1] + w[k] > 0) a[k][k] += w[k] * std::max(0.0, l2 - along);
      loose[k] = w[k] + w[k + 1] > 0 ? 0 : 1;
      a[k][k] += loose[k];  // between two points that stay: nothing moves
      if (k > 0) a[k][k - 1] = a[k - 1][k] = -w[k] * along;
      error[k] = loose[k] > 0 ? 0 : std::max(0.0, 0.5 * (l2 - longest[k] * longest[k]));
    }
    return solve(a, error);
  }

  /// The backward Euler step with these pulls, of places or of ways.
  [[nodiscard]] std::vector<Point> evened(const std::vector<Point>& of, const std::vector<double>& m) const {
    const size_t n = of.size();
    std::vector<std::vector<double>> a(n, std::vector<double>(n));
    for (size_t k = 0; k < n; ++k) {
      const double before = k > 0 ? double{shader::kLineSmoothing} * w[k] * std::max(0.0, m[k - 1]) : 0;
      const double after = k + 1 < n ? double{shader::kLineSmoothing} * w[k] * std::max(0.0, m[k]) : 0;
      a[k][k] = 1 + before + after;
      if (k > 0) a[k][k - 1] = -before;
      if (k + 1 < n) a[k][k + 1] = -after;
    }
    std::vector<Point> to(n);
    for (size_t c = 0; c < 3; ++c) {
      std::vector<double> of_axis(n);
      for (size_t k = 0; k < n; ++k) of_axis[k] = of[k][c];
      const std::vector<double> solution = solve(a, of_axis);
      for (size_t k = 0; k < n; ++k) to[k][c] = solution[k];
    }
    return to;
  }

  /// What the pass has to do.
  void relax() {
    const std::vector<double> m = multipliers();
    const std::vector<Point> after = evened(x, m), from = x;
    way = evened(way, m);
    for (size_t k = 0; k < springs(); ++k) {
      const Point d = spring(from, k), to = spring(after, k);
      Point turned = d;
      for (size_t c = 0; c < 3; ++c) turned[c] += double{shader::kLineTurn} * (to[c] - d[c]);
      const double pull = m[k] * dot(d, turned) / dot(turned, turned);
      for (size_t c = 0; c < 3; ++c) {
        x[k][c] += w[k] * pull * turned[c];
        x[k + 1][c] -= w[k + 1] * pull * turned[c];
      }
    }
  }
};

struct Solved {
  std::vector<Vec3> positions, ways;
};

Solved solved(const PulledCloth& cloth, uint32_t group) {
  const cpu::ClothState& state = cloth.state;
  const uint32_t width = state.data.width, height = state.data.height, next = group == 0 ? 1 : width;
  Solved all{cloth.positions(), cloth.ways()};
  const auto point = [](const Vec3& v) { return Point{double{v.x}, double{v.y}, double{v.z}}; };
  const auto vector = [](const Point& p) {
    return Vec3{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  };
  for (uint32_t line = 0; line < (group == 0 ? height : width); ++line) {
    const uint32_t first = group == 0 ? line * width : line, points = group == 0 ? width : height;
    const auto pixel = [&](uint32_t k) { return first + k * next; };
    const auto has_spring = [&](uint32_t k) { return k + 1 < points && state.rest[group][pixel(k)] > 0; };
    for (uint32_t k = 0; k < points; ++k) {
      Run run;
      const uint32_t begin = k;
      for (;; ++k) {
        const uint32_t p = pixel(k);
        const auto& copies = state.data.split_pixel;
        run.x.push_back(point(all.positions[p]));
        run.way.push_back(state.inverse_mass[p] > 0 ? point(all.ways[p]) : Point{});
        run.w.push_back(std::count(copies.begin(), copies.end(), p) > 0 ? 0.0 : double{state.inverse_mass[p]});
        if (!has_spring(k)) break;
        run.longest.push_back(double{state.rest[group][p]} * double{kLimit});
      }
      if (run.longest.empty()) continue;
      run.relax();
      for (uint32_t i = begin; i <= k; ++i) {
        if (run.w[i - begin] == 0) continue;
        all.positions[pixel(i)] = vector(run.x[i - begin]);
        all.ways[pixel(i)] = vector(run.way[i - begin]);
      }
    }
  }
  return all;
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (size_t p = 0; p < a.size(); ++p) largest = std::max(largest, static_cast<double>(length(a[p] - b[p])));
  return largest;
}

/// A sheet whose springs are cut here and there, some of them on both sides of a point.
ClothAsset torn(ClothAsset asset) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (p % 11 == 5) asset.spring_mask[p] &= static_cast<uint8_t>(~kSpringRight);
    if (p % 13 == 7 || p % 13 == 8) asset.spring_mask[p] &= static_cast<uint8_t>(~kSpringDown);
  }
  return asset;
}

/// The edge, two points of a row with others between, and two neighbours.
std::vector<uint32_t> held_in(const ClothAsset& asset) {
  const uint32_t w = asset.width, middle = asset.height / 2 * w;
  return {0, 1, 2, w - 1, middle + 3, middle + 9, middle + 10, 2 * w + w / 2};
}

struct Tested {
  const char* name;
  ClothAsset asset;
};
std::vector<Tested> tested() {
  return {{"whole", test::make_sheet({.nx = 61, .ny = 37})},
          {"charts", test::make_sheet({.nx = 61, .ny = 40, .charts_x = 3, .charts_y = 2, .gap = 3})},
          {"torn", torn(test::make_sheet({.nx = 64, .ny = 29}))}};
}

TEST(Lines, SolveEveryRun) {
  for (const Tested& sheet : tested()) {
    for (const float by : {0.F, 0.002F, 0.02F}) {  // [m], of a spacing of 1.6 cm: straight, bent and folded
      for (const uint32_t group : {0U, 1U}) {
        PulledCloth cloth(sheet.asset, by, held_in(sheet.asset));
        const std::vector<Vec3> before = cloth.positions();
        const Solved wanted = solved(cloth, group);
        cloth.pass(group);
        const double moved = largest_distance(before, wanted.positions);
        const double apart = std::max(largest_distance(cloth.positions(), wanted.positions),
                                      largest_distance(cloth.ways(), wanted.ways));
        EXPECT_GT(moved, 5e-4) << sheet.name << ' ' << by << ' ' << group;
        EXPECT_LT(apart, 2e-5 * (1 + moved)) << sheet.name << ' ' << by << ' ' << group;
      }
    }
  }
}

TEST(Lines, InVectorsHaveTheSameBits) {
  for (const Tested& sheet : tested()) {
    for (const uint32_t group : {0U, 1U}) {
      PulledCloth one(sheet.asset, 0.01F, held_in(sheet.asset)), other(sheet.asset, 0.01F, held_in(sheet.asset));
      const std::vector<Vec3> before = one.positions();
      one.pass(group);
      if (!other.pass_in_vectors(group)) GTEST_SKIP() << "no vectors on this machine";
      const std::vector<Vec3> a = one.positions(), b = other.positions();
      EXPECT_NE(std::memcmp(a.data(), before.data(), sizeof(Vec3) * a.size()), 0);
      EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(Vec3) * a.size()), 0) << sheet.name << ' ' << group;
      const std::vector<Vec3> way_a = one.ways(), way_b = other.ways();
      EXPECT_EQ(std::memcmp(way_a.data(), way_b.data(), sizeof(Vec3) * way_a.size()), 0) << sheet.name << ' ' << group;
    }
  }
}

// Copies that moved by themselves would be torn apart, and the stitch would stretch the springs beside them: a sheet
// that is cut where a ball presses was stretched by 13 % there instead of 3.
TEST(Lines, LeaveCopiesAndWhatIsHeldWhereTheyAre) {
  const ClothAsset asset = test::make_sheet({.nx = 61, .ny = 40, .charts_x = 3, .charts_y = 2, .gap = 3});
  PulledCloth cloth(asset, 0.01F, held_in(asset));
  const std::vector<Vec3> before = cloth.positions(), ways_before = cloth.ways();
  for (const uint32_t group : {0U, 1U}) cloth.pass(group);
  const std::vector<Vec3> after = cloth.positions();
  EXPECT_NE(ways_before, cloth.ways());
  for (const uint32_t p : asset.splits.pixel)
    EXPECT_EQ(ways_before[cloth.rows.pixel(p)], cloth.ways()[cloth.rows.pixel(p)]);
  for (const uint32_t p : asset.splits.pixel) EXPECT_EQ(before[cloth.rows.pixel(p)], after[cloth.rows.pixel(p)]);
  for (const uint32_t p : held_in(asset)) EXPECT_EQ(before[cloth.rows.pixel(p)], after[cloth.rows.pixel(p)]);
}

// A thousand springs in a row, points that fell together, and ones whose masses differ ten-thousandfold.
TEST(Lines, StayFiniteWhateverTheyGet) {
  const ClothAsset asset = test::make_sheet({.nx = 1100, .ny = 5, .width = 11, .height = 0.04F});
  PulledCloth cloth(asset, 0.02F, {0, 1099, 1100, 2200 + 500, 4400 + 700});
  for (uint32_t p = 0; p < 1100; ++p) {
    const uint32_t first = cloth.rows.pixel(p), fourth = cloth.rows.pixel(3300 + p);
    if (p % 7 < 2) cloth.state.position.set(fourth, {0, 0, 0});
    if (p % 5 == 0) cloth.state.inverse_mass[first] = 1e4F * cloth.state.inverse_mass[first];
    if (p % 3 == 0) cloth.state.inverse_mass[fourth] = 1e-4F * cloth.state.inverse_mass[fourth];
  }
  for (uint32_t k = 0; k < 6; ++k) cloth.pass(k % 2);
  const std::vector<Vec3> after = cloth.positions();
  EXPECT_TRUE(test::all_finite(after));
  for (const Vec3& x : after) EXPECT_LT(length(x), 20);
}

}  // namespace
}  // namespace geocloth
