// SPDX-License-Identifier: GPL-3.0-or-later
//
// Symmetric Dirichlet energy (Schreiner et al. 2004; Smith and Schaefer 2015) by projected Newton steps.
// Per triangle psi(F) = g(s1) + g(s2) with g(s) = s^2 + s^-2 of the singular values of the map's 2 x 2 gradient F. Its
// Hessian has a closed-form eigensystem (Smith, de Goes, Kim 2019, "Analytic eigensystems for isotropic distortion
// energies"): two scalings, a twist and a flip; only the twist can be negative and is clamped, which makes every step a
// descent direction. The step is limited so that no triangle's determinant reaches zero (Smith and Schaefer 2015, 3.3).

#include "develop/symmetric_dirichlet.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "develop/dirichlet_terms.h"
#include "develop/element_cholesky.h"
#include "develop/number_store.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {

struct SymmetricDirichlet::Impl {
  Impl(std::span<const Point3> position, std::span<const Triangle> triangles, std::span<const double> share)
      : triangle(triangles.begin(), triangles.end()), terms(position, triangles, share) {}

  std::vector<Triangle> triangle;
  DirichletTerms terms;
  std::vector<int32_t> unknown;  // per vertex: index among the free vertices, -1 when fixed
  int32_t unknowns = 0;
  std::unique_ptr<ElementCholesky> solver;
  // Per triangle, while there is something to minimise: gradient, and lower half of the Hessian by rows.
  NumberStore first_change, hessian;
  double shear_price = 0;

  /// Differentiates by all unknowns and factorises the Hessian. @returns whether that could be done
  bool linearise(std::span<const Point2> uv, Eigen::MatrixXd& gradient) {
    constexpr size_t kUnknowns = DirichletTerms::kUnknowns, kLowerHalf = DirichletTerms::kLowerHalf;
    if (!solver) solver = std::make_unique<ElementCholesky>(triangle, unknown, uv, 2);
    if (hessian.empty()) {
      first_change = NumberStore(triangle.size() * kUnknowns);
      hessian = NumberStore(triangle.size() * kLowerHalf);
    }
    const std::span<double> first(first_change.data(), triangle.size() * kUnknowns);
    const std::span<double> second(hessian.data(), triangle.size() * kLowerHalf);
    constexpr size_t kGrain = 1'000;
    tbb::parallel_for(size_t{0}, (triangle.size() + kGrain - 1) / kGrain, [&](size_t i) {
      terms.differentiate(i * kGrain, std::min(triangle.size(), (i + 1) * kGrain), uv, shear_price, first, second);
    });
    gradient.setZero(2 * unknowns, 1);
    double trace = 0;
    for (size_t t = 0; t < triangle.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const int32_t u = unknown[triangle[t][k]];
        if (u < 0) continue;
        for (int i = 0; i < 2; ++i) {
          const size_t p = 2 * k + static_cast<size_t>(i);
          gradient(2 * u + i) += first[t * kUnknowns + p];
          trace += second[t * kLowerHalf + (p + 1) * (p + 2) / 2 - 1];
        }
      }
    }
    // Rigid motions of a free map cost nothing: a little of the mean diagonal keeps the factorisation regular.
    constexpr int kAttempts = 3;
    double diagonal = 1e-8 * trace / (2 * unknowns);
    for (int attempt = 0; attempt < kAttempts; ++attempt, diagonal *= 100) {
      if (solver->factorise(second, diagonal)) return true;
    }
    return false;
  }

  /// What a step needs is no longer needed: whoever takes the next step has it while it is in the cache.
  void forget_step() {
    first_change = NumberStore();
    hessian = NumberStore();
    if (solver) solver->forget_factor();
  }

  double minimise(std::vector<Point2>& uv, uint32_t max_iterations, double tolerance);
};

SymmetricDirichlet::SymmetricDirichlet(std::span<const Point3> position, std::span<const Triangle> triangle,
                                       std::span<const uint8_t> fixed, std::span<const double> share)
    : impl_(std::make_unique<Impl>(position, triangle, share)) {
  impl_->unknown.assign(position.size(), -1);
  std::vector<uint8_t> used(position.size(), 0);
  for (const Triangle& t : triangle) used[t[0]] = used[t[1]] = used[t[2]] = 1;
  for (size_t v = 0; v < position.size(); ++v) {
    if (used[v] != 0 && (fixed.empty() || fixed[v] == 0)) impl_->unknown[v] = impl_->unknowns++;
  }
}

SymmetricDirichlet::SymmetricDirichlet(SymmetricDirichlet&&) noexcept = default;
SymmetricDirichlet& SymmetricDirichlet::operator=(SymmetricDirichlet&&) noexcept = default;
SymmetricDirichlet::~SymmetricDirichlet() = default;

double SymmetricDirichlet::energy(std::span<const Point2> uv) const {
  return impl_->terms.cost(uv, 0);
}

std::vector<double> SymmetricDirichlet::energy_per_triangle(std::span<const Point2> uv) const {
  return impl_->terms.densities(uv);
}

void SymmetricDirichlet::set_shear_price(double price) {
  impl_->shear_price = price;
}

void SymmetricDirichlet::set_weights(std::span<const double> times) {
  impl_->terms.multiply_weights(times);
}

double SymmetricDirichlet::minimise(std::vector<Point2>& uv, uint32_t max_iterations, double tolerance) {
  const double reached = impl_->minimise(uv, max_iterations, tolerance);
  impl_->forget_step();
  return reached;
}

double SymmetricDirichlet::Impl::minimise(std::vector<Point2>& uv, uint32_t max_iterations, double tolerance) {
  double current = terms.cost(uv, shear_price);
  if (!std::isfinite(current))
    throw Error(ErrorCode::verification, "the start of the flattening has a flipped triangle");
  if (unknowns == 0) return current;
  Eigen::MatrixXd gradient, step;
  std::vector<Point2> direction(uv.size(), Point2{0, 0});
  std::vector<Point2> trial;
  for (uint32_t iteration = 0; iteration < max_iterations; ++iteration) {
    if (!linearise(uv, gradient)) break;
    step = -gradient;
    solver->solve(step);
    const double slope = gradient.col(0).dot(step.col(0));
    if (!std::isfinite(slope) || slope >= 0) break;
    for (size_t v = 0; v < uv.size(); ++v) {
      if (unknown[v] >= 0) direction[v] = {step(2 * unknown[v]), step(2 * unknown[v] + 1)};
    }
    double t = std::min(1.0, 0.9 * terms.largest_step(uv, direction));
    double reached = kInfinity;
    for (int halving = 0; halving < 40; ++halving, t *= 0.5) {
      trial = uv;
      for (size_t v = 0; v < uv.size(); ++v) {
        trial[v][0] += t * direction[v][0];
        trial[v][1] += t * direction[v][1];
      }
      reached = terms.cost(trial, shear_price);
      if (reached <= current + 1e-4 * t * slope) break;
      reached = kInfinity;
    }
    if (!std::isfinite(reached)) break;
    uv.swap(trial);
    const double fall = current - reached;
    current = reached;
    if (fall < tolerance * current) break;
  }
  return current;
}

}  // namespace geocloth
