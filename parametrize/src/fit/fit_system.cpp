// SPDX-License-Identifier: GPL-3.0-or-later
// Preconditioned conjugate gradients (Hestenes and Stiefel 1952) with the blocks of the diagonal, one per point: the
// mass matrix so scaled has all eigenvalues in [1/2, 2] (Wathen 1987), and wishes add few large ones.
#include "fit/fit_system.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kMostSteps = 80;
constexpr size_t kPart = 2'000;                      // points or wishes that are worth a task
constexpr std::array<size_t, 3> kDiagonal{0, 3, 5};  // of a symmetric matrix

constexpr size_t parts_of(size_t count) {
  return (count + kPart - 1) / kPart;
}

/// Calls body(part, begin, end) for each part of 0 .. count - 1.
template <class Body>
void for_parts(size_t count, const Body& body) {
  tbb::parallel_for(size_t{0}, parts_of(count),
                    [&](size_t part) { body(part, part * kPart, std::min(count, (part + 1) * kPart)); });
}

/// Calls body(i) for 0 <= i < count.
template <class Body>
void for_each(size_t count, const Body& body) {
  for_parts(count, [&](size_t, size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) body(i);
  });
}

/// Sum of body(i), part by part.
template <class Body>
double sum_of_each(size_t count, const Body& body) {
  std::vector<double> sums(parts_of(count));
  for_parts(count, [&](size_t part, size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += body(i);
    sums[part] = sum;
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Of a wish, for its k-th point.
Point3 slope_of(const MoveWish& wish, size_t k) {
  const Point3 a = to_double(wish.slope[0]), b = to_double(wish.slope[1]);
  return k == 0 ? a : k == 1 ? b : (a + b) * -1;
}

}  // namespace

template <class Item>
void FitSystem::CornersOfPoints::list(size_t points, std::span<const Item> items) {
  first.assign(points + 1, 0);
  for (const Item& item : items)
    for (const uint32_t i : item.point) ++first[i + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  corner.resize(first.back());
  std::vector<uint32_t> end = first;
  for (uint32_t n = 0; n < items.size(); ++n)
    for (uint32_t k = 0; k < 3; ++k) corner[end[items[n].point[k]]++] = 3 * n + k;
}

FitSystem::FitSystem(size_t points, std::vector<FitTriangle> triangles)
    : triangle_(std::move(triangles)), block_(points, Symmetric{}) {
  of_triangles_.list(points, std::span<const FitTriangle>(triangle_));
  of_wishes_.list(points, std::span<const MoveWish>());
  for (const FitTriangle& t : triangle_) {
    for (const uint32_t i : t.point) {
      const double weight = t.area / 6;
      add_square(block_[i], t.normal, (1 - t.slack) * weight);
      for (const size_t k : kDiagonal) block_[i][k] += t.slack * weight;
    }
  }
}

void FitSystem::add(std::span<const MoveWish> wishes, size_t begin) {
  for (const MoveWish& wish : wishes.subspan(begin)) {
    for (size_t k = 0; k < 3; ++k) {
      Symmetric& block = block_[wish.point[k]];
      if (moves(block)) add_square(block, slope_of(wish, k), wish.weight);
    }
  }
  of_wishes_.list(block_.size(), wishes);
}

bool FitSystem::moves(const Symmetric& block) {
  return block[0] + block[3] + block[5] > 0;
}

void FitSystem::add_square(Symmetric& m, const Point3& v, double weight) {
  m[0] += weight * v[0] * v[0];
  m[1] += weight * v[0] * v[1];
  m[2] += weight * v[0] * v[2];
  m[3] += weight * v[1] * v[1];
  m[4] += weight * v[1] * v[2];
  m[5] += weight * v[2] * v[2];
}

/// Cramer's rule; nothing for a block of zeros.
Point3 FitSystem::solved(const Symmetric& m, const Point3& r) {
  const auto [xx, xy, xz, yy, yz, zz] = m;
  const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const double determinant = xx * a + xy * b + xz * c;
  if (!(determinant > 0)) return {0, 0, 0};
  const double d = xx * zz - xz * xz, e = xy * xz - xx * yz, f = xx * yy - xy * xy;
  return Point3{a * r[0] + b * r[1] + c * r[2], b * r[0] + d * r[1] + e * r[2], c * r[0] + e * r[1] + f * r[2]} *
         (1 / determinant);
}

Point3 FitSystem::triangles_pull(size_t i, const std::vector<Point3>& x) const {
  Point3 pull{};
  for (const uint32_t corner : of_triangles_.of(i)) {
    const FitTriangle& t = triangle_[corner / 3];
    const Point3 sum = x[t.point[0]] + x[t.point[1]] + x[t.point[2]];
    const Point3 v = (x[i] + sum) * (t.area / 12);
    pull = pull + v * t.slack + t.normal * ((1 - t.slack) * dot(t.normal, v));
  }
  return pull;
}

void FitSystem::add_wishes(size_t i, std::span<const MoveWish> wishes, const std::vector<double>& pull,
                           Point3& v) const {
  for (const uint32_t corner : of_wishes_.of(i)) {
    v = v + slope_of(wishes[corner / 3], corner % 3) * pull[corner / 3];
  }
}

double FitSystem::multiply(const std::vector<Point3>& x, std::span<const MoveWish> wishes, std::vector<double>& pull,
                           std::vector<Point3>& y) const {
  for_each(wishes.size(), [&](size_t w) {
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) sum += dot(slope_of(wishes[w], k), x[wishes[w].point[k]]);
    pull[w] = wishes[w].weight * sum;
  });
  return sum_of_each(x.size(), [&](size_t i) {
    y[i] = triangles_pull(i, x);
    add_wishes(i, wishes, pull, y[i]);
    return dot(x[i], y[i]);
  });
}

void FitSystem::solve(const std::vector<Point3>& pull, std::span<const MoveWish> wishes, double enough,
                      std::vector<Point3>& x) const {
  const size_t points = x.size();
  std::vector<Point3> r = pull, p(points), product(points), z(points);
  std::vector<double> pull_of_wish(wishes.size());
  for_each(wishes.size(), [&](size_t w) { pull_of_wish[w] = wishes[w].weight * wishes[w].wanted; });
  const double all = sum_of_each(points, [&](size_t i) {
    add_wishes(i, wishes, pull_of_wish, r[i]);
    return dot(r[i], solved(block_[i], r[i]));
  });
  multiply(x, wishes, pull_of_wish, product);
  double rz = sum_of_each(points, [&](size_t i) {
    r[i] = r[i] - product[i];
    p[i] = solved(block_[i], r[i]);
    return dot(r[i], p[i]);
  });
  for (int step = 0; step < kMostSteps && rz > enough * all; ++step) {
    const double alpha = rz / multiply(p, wishes, pull_of_wish, product), before = rz;
    rz = sum_of_each(points, [&](size_t i) {
      x[i] = x[i] + p[i] * alpha;
      r[i] = r[i] - product[i] * alpha;
      z[i] = solved(block_[i], r[i]);
      return dot(r[i], z[i]);
    });
    const double beta = rz / before;
    for_each(points, [&](size_t i) { p[i] = z[i] + p[i] * beta; });
  }
}

}  // namespace geocloth
