// SPDX-License-Identifier: GPL-3.0-or-later
// The linear systems of the flattening: solved as a dense solver solves them, alike on any number of threads, and with
// little fill, on which the time for large meshes depends.
#include "develop/element_cholesky.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include "develop/dissection.h"

namespace geocloth {
namespace {

/// A sheet of n x n vertices with a hole of fixed vertices, and a matrix for every triangle.
struct Problem {
  std::vector<Point2> place;
  std::vector<Triangle> triangle;
  std::vector<int32_t> unknown;
  std::vector<double> element;
  Eigen::Index width = 1, size = 0;
};

Problem make_problem(uint32_t n, uint32_t width) {
  Problem p;
  p.width = width;
  int32_t unknowns = 0;
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) {
      p.place.push_back({i + 0.3 * std::sin(i + 7.0 * j), j + 0.3 * std::cos(5.0 * i + j)});
      p.unknown.push_back(i == n / 2 && j % 3 == 0 ? -1 : unknowns++);
    }
  }
  p.size = unknowns * p.width;
  for (uint32_t i = 0; i + 1 < n; ++i) {
    for (uint32_t j = 0; j + 1 < n; ++j) {
      const uint32_t a = i * n + j;
      p.triangle.push_back({a, a + n, a + n + 1});
      p.triangle.push_back({a, a + n + 1, a + 1});
    }
  }
  const uint32_t rows = 3 * width;
  for (size_t t = 0; t < p.triangle.size(); ++t) {
    for (uint32_t row = 0; row < rows; ++row) {
      for (uint32_t column = 0; column <= row; ++column) {
        const double wave = std::sin(static_cast<double>(t) + 3.0 * row + 11.0 * column);
        p.element.push_back(row == column ? rows + wave : wave);
      }
    }
  }
  return p;
}

Eigen::MatrixXd dense(const Problem& p) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(p.size, p.size);
  size_t n = 0;
  for (const Triangle& t : p.triangle) {
    for (Eigen::Index row = 0; row < 3 * p.width; ++row) {
      for (Eigen::Index column = 0; column <= row; ++column, ++n) {
        const int32_t u = p.unknown[t[static_cast<size_t>(row / p.width)]];
        const int32_t v = p.unknown[t[static_cast<size_t>(column / p.width)]];
        if (u < 0 || v < 0) continue;
        const Eigen::Index r = u * p.width + row % p.width, c = v * p.width + column % p.width;
        matrix(r, c) += p.element[n];
        if (r != c) matrix(c, r) += p.element[n];
      }
    }
  }
  return matrix;
}

Eigen::MatrixXd right_sides(const Problem& p) {
  Eigen::MatrixXd right(p.size, 2);
  for (Eigen::Index i = 0; i < p.size; ++i) {
    right(i, 0) = std::sin(static_cast<double>(i));
    right(i, 1) = 1;
  }
  return right;
}

Eigen::MatrixXd solution(const Problem& p) {
  ElementCholesky solver(p.triangle, p.unknown, p.place, p.width);
  EXPECT_TRUE(solver.factorise(p.element, 0));
  Eigen::MatrixXd x = right_sides(p);
  solver.solve(x);
  return x;
}

TEST(ElementCholeskyTest, SolvesAsADenseSolverDoes) {
  for (const uint32_t width : {1U, 2U}) {
    for (const uint32_t n : {2U, 3U, 9U, 20U}) {
      const Problem p = make_problem(n, width);
      const Eigen::MatrixXd exact = dense(p).llt().solve(right_sides(p));
      EXPECT_LT((solution(p) - exact).norm(), 1e-12 * exact.norm()) << n << " " << width;
    }
  }
}

TEST(ElementCholeskyTest, TheDiagonalIsRaisedByAsMuchAsAskedFor) {
  const Problem p = make_problem(9, 2);
  ElementCholesky solver(p.triangle, p.unknown, p.place, p.width);
  ASSERT_TRUE(solver.factorise(p.element, 3));
  Eigen::MatrixXd x = right_sides(p);
  solver.solve(x);
  const Eigen::MatrixXd raised = dense(p) + 3 * Eigen::MatrixXd::Identity(p.size, p.size);
  EXPECT_LT((raised * x - right_sides(p)).norm(), 1e-12 * right_sides(p).norm());
}

TEST(ElementCholeskyTest, OneThreadGivesTheBitsOfMany) {
  const Problem p = make_problem(120, 2);
  const Eigen::MatrixXd many = solution(p);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ((many - solution(p)).cwiseAbs().maxCoeff(), 0);
}

/// A garment is laid out alike on every computer.
TEST(ElementCholeskyTest, EveryInstructionSetGivesTheSameBits) {
  const Problem p = make_problem(60, 2);
  const Eigen::MatrixXd best = solution(p);
  for (const int64_t target : {int64_t{HWY_SSE4}, int64_t{HWY_AVX2}, int64_t{HWY_AVX3}, int64_t{HWY_NEON}}) {
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    const Eigen::MatrixXd here = solution(p);
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_EQ((best - here).cwiseAbs().maxCoeff(), 0) << hwy::TargetName(target);
  }
}

TEST(ElementCholeskyTest, AnIndefiniteMatrixIsRefusedAndTheSolverGoesOn) {
  Problem p = make_problem(20, 2);
  const std::vector<double> good = p.element;
  p.element[21 * 300] = -100;
  ElementCholesky solver(p.triangle, p.unknown, p.place, p.width);
  EXPECT_FALSE(solver.factorise(p.element, 0));
  EXPECT_TRUE(solver.factorise(good, 0));
}

TEST(DissectionTest, EveryUnknownIsEliminatedOnceAndSeparatorsAreShort) {
  constexpr uint32_t kSide = 64;
  const Problem p = make_problem(kSide, 1);
  const Dissection dissection = dissect(p.triangle, p.unknown, p.place);
  std::vector<uint8_t> met(dissection.order.size(), 0);
  for (const uint32_t u : dissection.order) met[u] = 1;
  EXPECT_EQ(std::count(met.begin(), met.end(), 1), p.size);
  uint32_t at = 0;
  for (const Dissection::Node& node : dissection.node) {
    EXPECT_EQ(node.begin, at);  // in turn
    at = node.end;
    EXPECT_LE(node.end - node.begin, 3 * kSide / 2);
  }
  EXPECT_EQ(at, static_cast<uint32_t>(p.size));
}

TEST(DissectionTest, SeparatorsAreShortWhereOnlyTheMeshIsKnown) {
  constexpr uint32_t kSide = 64;
  const Problem p = make_problem(kSide, 1);
  const Dissection dissection = dissect(p.triangle, p.unknown, places_by_edges(p.triangle, p.place.size()));
  for (const Dissection::Node& node : dissection.node) EXPECT_LE(node.end - node.begin, 2 * kSide);
}

/// A skirt of needles from waist to hem took five times as long: Tutte's circle has its ends far from each other.
TEST(DissectionTest, ARingOfNeedlesOnACircleIsPartedBetweenItsNeedles) {
  constexpr uint32_t kNeedles = 1000;
  std::vector<Point2> place;
  std::vector<Triangle> triangle;
  std::vector<int32_t> unknown;
  for (uint32_t i = 0; i <= kNeedles; ++i) {
    // The waist lies on a quarter of the circle, the hem on half of it.
    const double share = double(i) / kNeedles;
    place.push_back({std::cos(2.36 - 1.57 * share), std::sin(2.36 - 1.57 * share)});
    place.push_back({std::cos(3.14 + 3.14 * share), std::sin(3.14 + 3.14 * share)});
    unknown.insert(unknown.end(), {static_cast<int32_t>(2 * i), static_cast<int32_t>(2 * i + 1)});
    if (i == 0) continue;
    triangle.push_back({2 * i - 2, 2 * i - 1, 2 * i});
    triangle.push_back({2 * i - 1, 2 * i + 1, 2 * i});
  }
  uint32_t longest = 0;
  for (const Dissection::Node& node : dissect(triangle, unknown, place).node) {
    longest = std::max(longest, node.end - node.begin);
  }
  EXPECT_LE(longest, 32U);
}

}  // namespace
}  // namespace geocloth
