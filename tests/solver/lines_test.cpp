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

constexpr float kLimit = 1.002F;       ///< stretch_limit
constexpr double kDiagonal = 1.00506;  ///< of the equations with 8 substeps of a 1/60 s frame

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
    std::vector<float> kept(stream.constants.size());
    cpu::run_lines(plan->lanes(), state, stream, group, 0, static_cast<uint32_t>(stream.blocks.size()), kept.data());
    return true;
  }

  [[nodiscard]] std::vector<Vec3> positions() const {
    std::vector<Vec3> all;
    for (uint32_t p = 0; p < state.pixel_count(); ++p) {
      const shader::vec3 x = state.position.at(p);
      all.push_back({x.x, x.y, x.z});
    }
    return all;
  }

  cpu::WideRows rows;
  cpu::ClothState state;
  ClothFrame frame;
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

/// What the pass has to do to the points of one run, in double precision and with all of the matrix.
void solve_run(std::vector<Point>& x, const std::vector<double>& w, const std::vector<double>& longest) {
  const size_t n = longest.size();
  std::vector<Point> d(n);
  for (size_t k = 0; k < n; ++k)
    for (size_t c = 0; c < 3; ++c) d[k][c] = x[k + 1][c] - x[k][c];
  const auto dot = [&](size_t i, size_t j) { return d[i][0] * d[j][0] + d[i][1] * d[j][1] + d[i][2] * d[j][2]; };
  std::vector<std::vector<double>> a(n, std::vector<double>(n));
  std::vector<double> error(n), loose(n);
  for (size_t k = 0; k < n; ++k) {
    a[k][k] = kDiagonal * (w[k] + w[k + 1]) * dot(k, k);
    if (k > 0 && w[k - 1] + w[k] > 0) a[k][k] += w[k] * std::max(0.0, dot(k, k) - dot(k - 1, k));
    loose[k] = w[k] + w[k + 1] > 0 ? 0 : 1;
    a[k][k] += loose[k];  // between two points that stay: nothing moves
    if (k > 0) a[k][k - 1] = a[k - 1][k] = -w[k] * dot(k - 1, k);
    error[k] = loose[k] > 0 ? 0 : std::max(0.0, 0.5 * (dot(k, k) - longest[k] * longest[k]));
  }
  const std::vector<double> multiplier = solve(a, error);
  for (size_t k = 0; k < n; ++k) {
    for (size_t c = 0; c < 3; ++c) {
      x[k][c] += w[k] * multiplier[k] * d[k][c];
      x[k + 1][c] -= w[k + 1] * multiplier[k] * d[k][c];
    }
  }
}

std::vector<Vec3> solved(const PulledCloth& cloth, uint32_t group) {
  const cpu::ClothState& state = cloth.state;
  const uint32_t width = state.data.width, height = state.data.height, next = group == 0 ? 1 : width;
  std::vector<Vec3> all = cloth.positions();
  for (uint32_t line = 0; line < (group == 0 ? height : width); ++line) {
    const uint32_t first = group == 0 ? line * width : line, points = group == 0 ? width : height;
    const auto pixel = [&](uint32_t k) { return first + k * next; };
    const auto has_spring = [&](uint32_t k) { return k + 1 < points && state.rest[group][pixel(k)] > 0; };
    for (uint32_t k = 0; k < points; ++k) {
      std::vector<Point> x;
      std::vector<double> w, longest;
      const uint32_t begin = k;
      for (;; ++k) {
        const uint32_t p = pixel(k);
        const Vec3& at = all[p];
        x.push_back({double{at.x}, double{at.y}, double{at.z}});
        const auto& copies = state.data.split_pixel;
        w.push_back(std::count(copies.begin(), copies.end(), p) > 0 ? 0.0 : double{state.inverse_mass[p]});
        if (!has_spring(k)) break;
        longest.push_back(double{state.rest[group][p]} * double{kLimit});
      }
      if (longest.empty()) continue;
      solve_run(x, w, longest);
      for (uint32_t i = begin; i <= k; ++i) {
        const Point& to = x[i - begin];
        all[pixel(i)] = {static_cast<float>(to[0]), static_cast<float>(to[1]), static_cast<float>(to[2])};
      }
    }
  }
  return all;
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
        const std::vector<Vec3> before = cloth.positions(), wanted = solved(cloth, group);
        cloth.pass(group);
        const std::vector<Vec3> found = cloth.positions();
        double moved = 0, apart = 0;
        for (size_t p = 0; p < found.size(); ++p) {
          moved = std::max(moved, static_cast<double>(length(wanted[p] - before[p])));
          apart = std::max(apart, static_cast<double>(length(wanted[p] - found[p])));
        }
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
    }
  }
}

// Copies that moved by themselves would be torn apart, and the stitch would stretch the springs beside them: a sheet
// that is cut where a ball presses was stretched by 13 % there instead of 3.
TEST(Lines, LeaveCopiesAndWhatIsHeldWhereTheyAre) {
  const ClothAsset asset = test::make_sheet({.nx = 61, .ny = 40, .charts_x = 3, .charts_y = 2, .gap = 3});
  PulledCloth cloth(asset, 0.01F, held_in(asset));
  const std::vector<Vec3> before = cloth.positions();
  for (const uint32_t group : {0U, 1U}) cloth.pass(group);
  const std::vector<Vec3> after = cloth.positions();
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
