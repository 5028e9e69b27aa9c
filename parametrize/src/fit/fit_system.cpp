// SPDX-License-Identifier: GPL-3.0-or-later
// Preconditioned conjugate gradients (Hestenes and Stiefel 1952) with the blocks of the diagonal, one per point: the
// mass matrix so scaled has all eigenvalues in [1/2, 2] (Wathen 1987), and wishes add few large ones.
#include "fit/fit_system.h"

#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kMostSteps = 80;
constexpr size_t kGrain = 2'000;                     // points that are worth a task
constexpr std::array<size_t, 3> kDiagonal{0, 3, 5};  // of a symmetric matrix

double inner(const std::vector<Point3>& a, const std::vector<Point3>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

/// Per point of a wish.
std::array<Point3, 3> slopes(const MoveWish& wish) {
  const Point3 a = to_double(wish.slope[0]), b = to_double(wish.slope[1]);
  return {a, b, (a + b) * -1};
}

}  // namespace

FitSystem::FitSystem(size_t points, std::vector<FitTriangle> triangles)
    : triangle_(std::move(triangles)), first_(points + 1, 0), block_(points, Symmetric{}) {
  for (const FitTriangle& t : triangle_) {
    for (const uint32_t i : t.point) {
      ++first_[i + 1];
      const double weight = t.area / 6;
      add_square(block_[i], t.normal, (1 - t.slack) * weight);
      for (const size_t k : kDiagonal) block_[i][k] += t.slack * weight;
    }
  }
  for (size_t i = 0; i < points; ++i) first_[i + 1] += first_[i];
  around_.resize(first_.back());
  std::vector<uint32_t> end = first_;
  for (uint32_t t = 0; t < triangle_.size(); ++t) {
    for (const uint32_t i : triangle_[t].point) around_[end[i]++] = t;
  }
}

void FitSystem::add(std::span<const MoveWish> wishes, size_t begin) {
  for (const MoveWish& wish : wishes.subspan(begin)) {
    const std::array<Point3, 3> slope = slopes(wish);
    for (size_t k = 0; k < 3; ++k) {
      Symmetric& block = block_[wish.point[k]];
      if (moves(block)) add_square(block, slope[k], wish.weight);
    }
  }
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

std::vector<Point3> FitSystem::product(const std::vector<Point3>& x, std::span<const MoveWish> wishes) const {
  std::vector<Point3> y(x.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, x.size(), kGrain), [&](const tbb::blocked_range<size_t>& points) {
    for (size_t i = points.begin(); i < points.end(); ++i) {
      Point3 pull{};
      for (uint32_t k = first_[i]; k < first_[i + 1]; ++k) {
        const FitTriangle& t = triangle_[around_[k]];
        const Point3 sum = x[t.point[0]] + x[t.point[1]] + x[t.point[2]];
        const Point3 v = (x[i] + sum) * (t.area / 12);
        pull = pull + v * t.slack + t.normal * ((1 - t.slack) * dot(t.normal, v));
      }
      y[i] = pull;
    }
  });
  for (const MoveWish& wish : wishes) {
    const std::array<Point3, 3> slope = slopes(wish);
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) sum += dot(slope[k], x[wish.point[k]]);
    for (size_t k = 0; k < 3; ++k) y[wish.point[k]] = y[wish.point[k]] + slope[k] * (wish.weight * sum);
  }
  return y;
}

std::vector<Point3> FitSystem::preconditioned(const std::vector<Point3>& r) const {
  std::vector<Point3> z(r.size());
  for (size_t i = 0; i < r.size(); ++i) z[i] = solved(block_[i], r[i]);
  return z;
}

void FitSystem::solve(const std::vector<Point3>& pull, std::span<const MoveWish> wishes, double enough,
                      std::vector<Point3>& x) const {
  std::vector<Point3> r = pull;
  for (const MoveWish& wish : wishes) {
    const std::array<Point3, 3> slope = slopes(wish);
    for (size_t k = 0; k < 3; ++k) r[wish.point[k]] = r[wish.point[k]] + slope[k] * (wish.weight * wish.wanted);
  }
  const double left = enough * inner(r, preconditioned(r));
  const std::vector<Point3> start = product(x, wishes);
  for (size_t i = 0; i < r.size(); ++i) r[i] = r[i] - start[i];
  std::vector<Point3> p = preconditioned(r);
  double rz = inner(r, p);
  for (int step = 0; step < kMostSteps && rz > left; ++step) {
    const std::vector<Point3> mp = product(p, wishes);
    const double alpha = rz / inner(p, mp);
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] = x[i] + p[i] * alpha;
      r[i] = r[i] - mp[i] * alpha;
    }
    const std::vector<Point3> z = preconditioned(r);
    const double before = rz;
    rz = inner(r, z);
    for (size_t i = 0; i < p.size(); ++i) p[i] = z[i] + p[i] * (rz / before);
  }
}

}  // namespace geocloth
