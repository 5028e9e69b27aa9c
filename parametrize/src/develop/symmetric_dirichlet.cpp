// SPDX-License-Identifier: GPL-3.0-or-later
//
// Symmetric Dirichlet energy (Schreiner et al. 2004; Smith and Schaefer 2015) by projected Newton steps.
// Per triangle psi(F) = g(s1) + g(s2) with g(s) = s^2 + s^-2 of the singular values of the map's 2 x 2 gradient F. Its
// Hessian has a closed-form eigensystem (Smith, de Goes, Kim 2019, "Analytic eigensystems for isotropic distortion
// energies"): two scalings, a twist and a flip; only the twist can be negative and is clamped, which makes every step a
// descent direction. The step is limited so that no triangle's determinant reaches zero (Smith and Schaefer 2015, 3.3).

#include "develop/symmetric_dirichlet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "develop/element_cholesky.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

using Gradient = std::array<std::array<double, 2>, 3>;  // per corner k, column j: dF(i,j) / du(k,i)
using Matrix4 = Eigen::Matrix4d;

constexpr size_t kLowerHalf = 21;  // entries of a symmetric matrix of a triangle's six coordinates

struct Element {
  Gradient gradient;
  double weight;  // share of the total area
};

Element make_element(const Point3& a, const Point3& b, const Point3& c) {
  const Point3 e1 = b - a;
  const Point3 e2 = c - a;
  const double l = length(e1);
  const double x = dot(e1, e2) / l;
  const double height = length(cross(e1, e2)) / l;
  // Inverse of the rest frame [l x; 0 height].
  const double b00 = 1 / l;
  const double b01 = -x / (l * height);
  const double b11 = 1 / height;
  return {{{{-b00, -b01 - b11}, {b00, b01}, {0, b11}}}, 0.5 * l * height};
}

struct Map {
  double f00, f10, f01, f11;
  [[nodiscard]] double determinant() const { return f00 * f11 - f01 * f10; }
  [[nodiscard]] double squared_norm() const { return f00 * f00 + f10 * f10 + f01 * f01 + f11 * f11; }
  /// Zero where the directions x and y of the plane are orthogonal on the surface.
  [[nodiscard]] double shear() const { return f00 * f10 + f01 * f11; }
};

Map map_of(const Element& e, const Triangle& t, std::span<const Point2> uv) {
  Map f{0, 0, 0, 0};
  for (size_t k = 0; k < 3; ++k) {
    const Point2& u = uv[t[k]];
    f.f00 += u[0] * e.gradient[k][0];
    f.f10 += u[1] * e.gradient[k][0];
    f.f01 += u[0] * e.gradient[k][1];
    f.f11 += u[1] * e.gradient[k][1];
  }
  return f;
}

double density(const Map& f) {
  const double d = f.determinant();
  return d > 0 ? f.squared_norm() * (1 + 1 / (d * d)) : kInfinity;
}

/// Gradient of the density by F, column-major: (00, 10, 01, 11).
Eigen::Vector4d density_gradient(const Map& f) {
  const double d = f.determinant();
  const double a = 2 * (1 + 1 / (d * d));
  const double b = -2 * f.squared_norm() / (d * d * d);
  return {a * f.f00 + b * f.f11, a * f.f10 - b * f.f01, a * f.f01 - b * f.f10, a * f.f11 + b * f.f00};
}

/// The density's Hessian with its negative eigenvalue clamped.
/// F is (s1 + s2) / 2 times a rotation R and (s1 - s2) / 2 times a reflection S; the Hessian's eigenvectors are R + S
/// and R - S, which scale, and R and S turned by a right angle: the twist and the flip. So no angle need be known.
Matrix4 projected_hessian(const Map& f) {
  const double e = (f.f00 + f.f11) / 2;
  const double m = (f.f00 - f.f11) / 2;
  const double g = (f.f10 + f.f01) / 2;
  const double h = (f.f10 - f.f01) / 2;
  const double q = std::sqrt(e * e + h * h);
  const double r = std::sqrt(m * m + g * g);
  const double i1 = 1 / (q + r);
  const double i2 = std::min((q + r) / f.determinant(), 1e300);  // 1 / (q - r) without cancellation
  const double c = e / q, s = h / q;
  const double p = r > 0 ? m / r : 1, w = r > 0 ? g / r : 0;
  const Eigen::Vector4d rotation(c, s, -s, c), twist(-s, c, -c, -s);  // of length sqrt(2)
  const Eigen::Vector4d reflection(p, w, w, -p), flip(-w, p, p, w);
  const auto second = [](double inverse) { return 2 + 6 * inverse * inverse * inverse * inverse; };
  const double twist_value = 2 - 2 * (i1 * i1 * i1 + i2 * i2 * i2) / (1 / i1 + 1 / i2);
  // (g'(s1) - g'(s2)) / (s1 - s2), written without the difference quotient.
  const double flip_value = 2 + 2 * (i1 * i1 * i1 * i2 + i1 * i1 * i2 * i2 + i1 * i2 * i2 * i2);
  const Eigen::Vector4d scale1 = (rotation + reflection) / 2, scale2 = (rotation - reflection) / 2;
  Matrix4 result = second(i1) * scale1 * scale1.transpose();
  result += second(i2) * scale2 * scale2.transpose();
  result += flip_value / 2 * flip * flip.transpose();
  result += std::max(twist_value, 0.0) / 2 * twist * twist.transpose();
  return result;
}

/// The smallest positive root of a t^2 + b t + c with c > 0, or infinity.
double first_root(double a, double b, double c) {
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return kInfinity;
  const double root = std::sqrt(discriminant);
  if (b < 0) return 2 * c / (-b + root);
  if (a < 0) return (-b - root) / (2 * a);
  return kInfinity;
}

}  // namespace

struct SymmetricDirichlet::Impl {
  std::vector<Triangle> triangle;
  std::vector<Element> element;
  std::vector<int32_t> unknown;  // per vertex: index among the free vertices, -1 when fixed
  int32_t unknowns = 0;
  std::unique_ptr<ElementCholesky> solver;
  std::vector<double> hessian;                      // per triangle: lower half by rows
  std::vector<std::array<double, 6>> first_change;  // per triangle: gradient by its corners' coordinates
  double shear_price = 0;

  [[nodiscard]] double energy(std::span<const Point2> uv) const {
    double sum = 0;
    for (size_t t = 0; t < triangle.size(); ++t)
      sum += element[t].weight * density(map_of(element[t], triangle[t], uv));
    return sum;
  }

  /// What is minimised.
  [[nodiscard]] double cost(std::span<const Point2> uv) const {
    if (shear_price == 0) return energy(uv);
    double sum = 0;
    for (size_t t = 0; t < triangle.size(); ++t) {
      const Map f = map_of(element[t], triangle[t], uv);
      sum += element[t].weight * (density(f) + shear_price * f.shear() * f.shear());
    }
    return sum;
  }

  /// Gradient and Hessian of what a triangle adds to the cost.
  void differentiate(size_t t, std::span<const Point2> uv) {
    const Element& e = element[t];
    const Map f = map_of(e, triangle[t], uv);
    Eigen::Vector4d first = e.weight * density_gradient(f);
    Matrix4 second = e.weight * projected_hessian(f);
    if (shear_price > 0) {  // Gauss-Newton: the shear is small
      const Eigen::Vector4d change(f.f10, f.f00, f.f11, f.f01);
      first += 2 * e.weight * shear_price * f.shear() * change;
      second += 2 * e.weight * shear_price * change * change.transpose();
    }
    // Chain rule: the unknown (corner k, coordinate i) moves F(i, j) by gradient[k][j], F(i, j) at index i + 2 j.
    size_t n = t * kLowerHalf;
    for (size_t k = 0; k < 3; ++k) {
      const auto& [g0, g1] = e.gradient[k];
      for (Eigen::Index i = 0; i < 2; ++i) {
        first_change[t][2 * k + static_cast<size_t>(i)] = g0 * first[i] + g1 * first[2 + i];
        const Eigen::Vector4d row = g0 * second.col(i) + g1 * second.col(2 + i);
        for (size_t l = 0; l <= k; ++l) {
          const auto& [h0, h1] = e.gradient[l];
          for (Eigen::Index j = 0; j < (l < k ? 2 : i + 1); ++j) hessian[n++] = h0 * row[j] + h1 * row[2 + j];
        }
      }
    }
  }

  /// Differentiates by all unknowns and factorises the Hessian. @returns whether that could be done
  bool linearise(std::span<const Point2> uv, Eigen::MatrixXd& gradient) {
    if (!solver) {
      solver = std::make_unique<ElementCholesky>(triangle, unknown, uv, 2);
      hessian.resize(triangle.size() * kLowerHalf);
      first_change.resize(triangle.size());
    }
    constexpr size_t kGrain = 1'000;
    tbb::parallel_for(tbb::blocked_range<size_t>(0, triangle.size(), kGrain), [&](const auto& range) {
      for (size_t t = range.begin(); t != range.end(); ++t) differentiate(t, uv);
    });
    gradient.setZero(2 * unknowns, 1);
    double trace = 0;
    for (size_t t = 0; t < triangle.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const int32_t u = unknown[triangle[t][k]];
        if (u < 0) continue;
        for (int i = 0; i < 2; ++i) {
          const size_t p = 2 * k + static_cast<size_t>(i);
          gradient(2 * u + i) += first_change[t][p];
          trace += hessian[t * kLowerHalf + (p + 1) * (p + 2) / 2 - 1];
        }
      }
    }
    // Rigid motions of a free map cost nothing: a little of the mean diagonal keeps the factorisation regular.
    constexpr int kAttempts = 3;
    double diagonal = 1e-8 * trace / (2 * unknowns);
    for (int attempt = 0; attempt < kAttempts; ++attempt, diagonal *= 100) {
      if (solver->factorise(hessian, diagonal)) return true;
    }
    return false;
  }

  /// The largest step along `direction` before a triangle's determinant becomes zero.
  [[nodiscard]] double largest_step(std::span<const Point2> uv, std::span<const Point2> direction) const {
    double limit = kInfinity;
    for (const Triangle& t : triangle) {
      const Point2 a{uv[t[1]][0] - uv[t[0]][0], uv[t[1]][1] - uv[t[0]][1]};
      const Point2 b{uv[t[2]][0] - uv[t[0]][0], uv[t[2]][1] - uv[t[0]][1]};
      const Point2 c{direction[t[1]][0] - direction[t[0]][0], direction[t[1]][1] - direction[t[0]][1]};
      const Point2 d{direction[t[2]][0] - direction[t[0]][0], direction[t[2]][1] - direction[t[0]][1]};
      limit =
          std::min(limit, first_root(c[0] * d[1] - c[1] * d[0], a[0] * d[1] - a[1] * d[0] + c[0] * b[1] - c[1] * b[0],
                                     a[0] * b[1] - a[1] * b[0]));
    }
    return limit;
  }
};

SymmetricDirichlet::SymmetricDirichlet(std::span<const Point3> position, std::span<const Triangle> triangle,
                                       std::span<const uint8_t> fixed)
    : impl_(std::make_unique<Impl>()) {
  impl_->triangle.assign(triangle.begin(), triangle.end());
  impl_->element.reserve(triangle.size());
  double area = 0;
  for (const Triangle& t : triangle) {
    impl_->element.push_back(make_element(position[t[0]], position[t[1]], position[t[2]]));
    area += impl_->element.back().weight;
  }
  for (Element& e : impl_->element) e.weight /= area;
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
  return impl_->energy(uv);
}

std::vector<double> SymmetricDirichlet::energy_per_triangle(std::span<const Point2> uv) const {
  std::vector<double> result(impl_->triangle.size());
  for (size_t t = 0; t < result.size(); ++t) result[t] = density(map_of(impl_->element[t], impl_->triangle[t], uv));
  return result;
}

void SymmetricDirichlet::set_shear_price(double price) {
  impl_->shear_price = price;
}

void SymmetricDirichlet::set_weights(std::span<const double> times) {
  for (size_t t = 0; t < times.size(); ++t) impl_->element[t].weight *= times[t];
}

double SymmetricDirichlet::minimise(std::vector<Point2>& uv, uint32_t max_iterations, double tolerance) {
  Impl& s = *impl_;
  double current = s.cost(uv);
  if (!std::isfinite(current))
    throw Error(ErrorCode::verification, "the start of the flattening has a flipped triangle");
  if (s.unknowns == 0) return current;
  Eigen::MatrixXd gradient, step;
  std::vector<Point2> direction(uv.size(), Point2{0, 0});
  std::vector<Point2> trial;
  for (uint32_t iteration = 0; iteration < max_iterations; ++iteration) {
    if (!s.linearise(uv, gradient)) break;
    step = -gradient;
    s.solver->solve(step);
    const double slope = gradient.col(0).dot(step.col(0));
    if (!std::isfinite(slope) || slope >= 0) break;
    for (size_t v = 0; v < uv.size(); ++v) {
      if (s.unknown[v] >= 0) direction[v] = {step(2 * s.unknown[v]), step(2 * s.unknown[v] + 1)};
    }
    double t = std::min(1.0, 0.9 * s.largest_step(uv, direction));
    double reached = kInfinity;
    for (int halving = 0; halving < 40; ++halving, t *= 0.5) {
      trial = uv;
      for (size_t v = 0; v < uv.size(); ++v) {
        trial[v][0] += t * direction[v][0];
        trial[v][1] += t * direction[v][1];
      }
      reached = s.cost(trial);
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
