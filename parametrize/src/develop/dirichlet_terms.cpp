// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles in vectors, for every instruction set that Highway knows; the best one is chosen when the program runs. A
// lane holds a triangle, and sees the same operations in the same order whatever the vectors' length.
//
// With the map's derivative F = U S V^T, the energy's Hessian by F has known eigenvectors: see projected_hessian().
#include "develop/dirichlet_terms.h"

#include <algorithm>
#include <limits>

#include "mesh/point_math.h"
#include "vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "develop/dirichlet_terms.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GEOCLOTH_DIRICHLET_TERMS_ONCE
#define GEOCLOTH_DIRICHLET_TERMS_ONCE
namespace geocloth {

constexpr size_t kMostLanes = DirichletTerms::kAtOnce;

/// Pointers to the arrays of DirichletTerms, and to places in the plane.
struct TermsView {
  size_t count;
  std::array<const int64_t*, 3> corner;
  std::array<const double*, DirichletTerms::kUnknowns> gradient;
  const double* weight;
  const double* uv;
  double shear_price;
};

}  // namespace geocloth
#endif

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kMostLanes>;
using V = hn::Vec<D>;
constexpr size_t kLanes = hn::MaxLanes(D());

HWY_INLINE V set(double x) {
  return hn::Set(D(), x);
}
HWY_INLINE V sum_of(V a, V b, V c) {
  return hn::Add(hn::Add(a, b), c);
}

struct Corners {
  V x[3], y[3];
};

HWY_INLINE Corners corners_of(const TermsView& terms, const double* coordinates, size_t t) {
  const hn::RebindToSigned<D> di;
  Corners result;
  for (size_t k = 0; k < 3; ++k) {
    const auto at = hn::LoadU(di, terms.corner[k] + t);
    result.x[k] = hn::GatherIndex(D(), coordinates, at);
    result.y[k] = hn::GatherIndex(D(), coordinates + 1, at);
  }
  return result;
}

/// The derivative F of the map, of kLanes triangles.
struct Map {
  V f00, f10, f01, f11;
};

HWY_INLINE V determinant(const Map& f) {
  return hn::Sub(hn::Mul(f.f00, f.f11), hn::Mul(f.f10, f.f01));
}
HWY_INLINE V squared_norm(const Map& f) {
  return hn::Add(sum_of(hn::Mul(f.f00, f.f00), hn::Mul(f.f10, f.f10), hn::Mul(f.f01, f.f01)), hn::Mul(f.f11, f.f11));
}
/// Zero where the directions x and y of the plane are orthogonal on the surface.
HWY_INLINE V shear(const Map& f) {
  return hn::Add(hn::Mul(f.f00, f.f10), hn::Mul(f.f01, f.f11));
}

HWY_INLINE Map map_of(const TermsView& terms, size_t t) {
  const Corners u = corners_of(terms, terms.uv, t);
  Map f{hn::Zero(D()), hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  for (size_t k = 0; k < 3; ++k) {
    const V g0 = hn::LoadU(D(), terms.gradient[2 * k] + t), g1 = hn::LoadU(D(), terms.gradient[2 * k + 1] + t);
    f.f00 = hn::Add(f.f00, hn::Mul(u.x[k], g0));
    f.f10 = hn::Add(f.f10, hn::Mul(u.y[k], g0));
    f.f01 = hn::Add(f.f01, hn::Mul(u.x[k], g1));
    f.f11 = hn::Add(f.f11, hn::Mul(u.y[k], g1));
  }
  return f;
}

HWY_INLINE V density(const Map& f) {
  const V d = determinant(f), one = set(1);
  const V value = hn::Mul(squared_norm(f), hn::Add(one, hn::Div(one, hn::Mul(d, d))));
  return hn::IfThenElse(hn::Gt(d, hn::Zero(D())), value, set(std::numeric_limits<double>::infinity()));
}

/// Gradient of the density by F, column-major: (00, 10, 01, 11).
HWY_INLINE void density_gradient(const Map& f, V* result) {
  const V d = determinant(f), one = set(1), squared = hn::Mul(d, d);
  const V a = hn::Mul(set(2), hn::Add(one, hn::Div(one, squared)));
  const V b = hn::Div(hn::Mul(set(-2), squared_norm(f)), hn::Mul(squared, d));
  result[0] = hn::Add(hn::Mul(a, f.f00), hn::Mul(b, f.f11));
  result[1] = hn::Sub(hn::Mul(a, f.f10), hn::Mul(b, f.f01));
  result[2] = hn::Sub(hn::Mul(a, f.f01), hn::Mul(b, f.f10));
  result[3] = hn::Add(hn::Mul(a, f.f11), hn::Mul(b, f.f00));
}

/// result + factor * a a^T; in place of the result where it is the first.
template <bool kFirst>
HWY_INLINE void add_square(V factor, const V* a, V (*result)[4]) {
  for (size_t i = 0; i < 4; ++i) {
    const V scaled = hn::Mul(factor, a[i]);
    for (size_t j = 0; j < 4; ++j) {
      const V product = hn::Mul(scaled, a[j]);
      if constexpr (kFirst) {
        result[i][j] = product;
      } else {
        result[i][j] = hn::Add(result[i][j], product);
      }
    }
  }
}

/// The density's Hessian with its negative eigenvalue clamped.
/// F is (s1 + s2) / 2 times a rotation R and (s1 - s2) / 2 times a reflection S; the Hessian's eigenvectors are R + S
/// and R - S, which scale, and R and S turned by a right angle: the twist and the flip. So no angle need be known.
HWY_INLINE void projected_hessian(const Map& map, V (*result)[4]) {
  const V one = set(1), two = set(2), half = set(0.5), zero = hn::Zero(D());
  const V e = hn::Mul(hn::Add(map.f00, map.f11), half);
  const V m = hn::Mul(hn::Sub(map.f00, map.f11), half);
  const V g = hn::Mul(hn::Add(map.f10, map.f01), half);
  const V h = hn::Mul(hn::Sub(map.f10, map.f01), half);
  const V q = hn::Sqrt(hn::Add(hn::Mul(e, e), hn::Mul(h, h)));
  const V r = hn::Sqrt(hn::Add(hn::Mul(m, m), hn::Mul(g, g)));
  const V sum = hn::Add(q, r);
  const V i1 = hn::Div(one, sum);
  const V most = set(1e300), quotient = hn::Div(sum, determinant(map));
  const V i2 = hn::IfThenElse(hn::Lt(most, quotient), most, quotient);  // 1 / (q - r) without cancellation
  const V c = hn::Div(e, q), s = hn::Div(h, q);
  const auto is_stretched = hn::Gt(r, zero);
  const V p = hn::IfThenElse(is_stretched, hn::Div(m, r), one), w = hn::IfThenElse(is_stretched, hn::Div(g, r), zero);
  const V rotation[4]{c, s, hn::Neg(s), c}, twist[4]{hn::Neg(s), c, hn::Neg(c), hn::Neg(s)};  // of length sqrt(2)
  const V reflection[4]{p, w, w, hn::Neg(p)}, flip[4]{hn::Neg(w), p, p, w};
  const auto second = [&](V inverse) {
    const V cubed = hn::Mul(hn::Mul(hn::Mul(set(6), inverse), inverse), inverse);
    return hn::Add(two, hn::Mul(cubed, inverse));
  };
  const V i11 = hn::Mul(i1, i1), i111 = hn::Mul(i11, i1), i22 = hn::Mul(i2, i2), i222 = hn::Mul(i22, i2);
  const V twist_value =
      hn::Sub(two, hn::Div(hn::Mul(two, hn::Add(i111, i222)), hn::Add(hn::Div(one, i1), hn::Div(one, i2))));
  // (g'(s1) - g'(s2)) / (s1 - s2), written without the difference quotient.
  const V i1122 = hn::Mul(hn::Mul(i11, i2), i2), i1222 = hn::Mul(hn::Mul(hn::Mul(i1, i2), i2), i2);
  const V flip_value = hn::Add(two, hn::Mul(two, sum_of(hn::Mul(i111, i2), i1122, i1222)));
  V scale1[4], scale2[4];
  for (size_t i = 0; i < 4; ++i) {
    scale1[i] = hn::Mul(hn::Add(rotation[i], reflection[i]), half);
    scale2[i] = hn::Mul(hn::Sub(rotation[i], reflection[i]), half);
  }
  const V kept_twist = hn::IfThenElse(hn::Lt(twist_value, zero), zero, twist_value);
  add_square<true>(second(i1), scale1, result);
  add_square<false>(second(i2), scale2, result);
  add_square<false>(hn::Mul(flip_value, half), flip, result);
  add_square<false>(hn::Mul(kept_twist, half), twist, result);
}

void densities(const TermsView& terms, double* result) {
  for (size_t t = 0; t < terms.count; t += kLanes) {
    const V value = density(map_of(terms, t));
    if (t + kLanes <= terms.count) {
      hn::StoreU(value, D(), result + t);
      continue;
    }
    double lane[kMostLanes];
    hn::StoreU(value, D(), lane);
    std::copy_n(lane, terms.count - t, result + t);
  }
}

double cost(const TermsView& terms) {
  const V price = set(terms.shear_price);
  double sum = 0;
  for (size_t t = 0; t < terms.count; t += kLanes) {
    const Map f = map_of(terms, t);
    V value = density(f);
    if (terms.shear_price > 0) {
      const V s = shear(f);
      value = hn::Add(value, hn::Mul(hn::Mul(price, s), s));
    }
    double lane[kMostLanes];
    hn::StoreU(hn::Mul(hn::LoadU(D(), terms.weight + t), value), D(), lane);
    for (size_t i = 0; i < std::min(kLanes, terms.count - t); ++i) sum += lane[i];
  }
  return sum;
}

void differentiate(const TermsView& terms, size_t first_triangle, size_t last, double* gradient, double* hessian) {
  constexpr size_t kUnknowns = DirichletTerms::kUnknowns, kLowerHalf = DirichletTerms::kLowerHalf;
  for (size_t t = first_triangle; t < last; t += kLanes) {
    const Map f = map_of(terms, t);
    const V weight = hn::LoadU(D(), terms.weight + t);
    V first[4], second[4][4];
    density_gradient(f, first);
    projected_hessian(f, second);
    for (size_t i = 0; i < 4; ++i) {
      first[i] = hn::Mul(weight, first[i]);
      for (size_t j = 0; j < 4; ++j) second[i][j] = hn::Mul(weight, second[i][j]);
    }
    if (terms.shear_price > 0) {  // Gauss-Newton: the shear is small
      const V change[4]{f.f10, f.f00, f.f11, f.f01};
      const V factor = hn::Mul(hn::Mul(set(2), weight), set(terms.shear_price));
      const V slope = hn::Mul(factor, shear(f));
      for (size_t i = 0; i < 4; ++i) first[i] = hn::Add(first[i], hn::Mul(slope, change[i]));
      add_square<false>(factor, change, second);
    }
    // Chain rule: the unknown (corner k, coordinate i) moves F(i, j) by gradient[k][j], F(i, j) at index i + 2 j.
    double of_gradient[kUnknowns][kMostLanes], of_hessian[kLowerHalf][kMostLanes];
    size_t n = 0;
    for (size_t k = 0; k < 3; ++k) {
      const V g0 = hn::LoadU(D(), terms.gradient[2 * k] + t), g1 = hn::LoadU(D(), terms.gradient[2 * k + 1] + t);
      for (size_t i = 0; i < 2; ++i) {
        hn::StoreU(hn::Add(hn::Mul(g0, first[i]), hn::Mul(g1, first[2 + i])), D(), of_gradient[2 * k + i]);
        V row[4];
        for (size_t j = 0; j < 4; ++j) row[j] = hn::Add(hn::Mul(g0, second[j][i]), hn::Mul(g1, second[j][2 + i]));
        for (size_t l = 0; l <= k; ++l) {
          const V h0 = hn::LoadU(D(), terms.gradient[2 * l] + t), h1 = hn::LoadU(D(), terms.gradient[2 * l + 1] + t);
          for (size_t j = 0; j < (l < k ? 2 : i + 1); ++j) {
            hn::StoreU(hn::Add(hn::Mul(h0, row[j]), hn::Mul(h1, row[2 + j])), D(), of_hessian[n++]);
          }
        }
      }
    }
    for (size_t lane = 0; lane < std::min(kLanes, last - t); ++lane) {
      for (size_t k = 0; k < kUnknowns; ++k) gradient[(t + lane) * kUnknowns + k] = of_gradient[k][lane];
      double* const into = hessian + (t + lane) * kLowerHalf;
      for (size_t k = 0; k < kLowerHalf; ++k) into[k] = of_hessian[k][lane];
    }
  }
}

/// The smallest positive root of a t^2 + b t + c with c > 0, or infinity.
HWY_INLINE V first_root(V a, V b, V c) {
  const V zero = hn::Zero(D()), infinity = set(std::numeric_limits<double>::infinity()), two = set(2);
  const V discriminant = hn::Sub(hn::Mul(b, b), hn::Mul(hn::Mul(set(4), a), c));
  const V root = hn::Sqrt(discriminant);
  const V falling = hn::Div(hn::Mul(two, c), hn::Add(hn::Neg(b), root));
  const V bent = hn::Div(hn::Sub(hn::Neg(b), root), hn::Mul(two, a));
  const V result = hn::IfThenElse(hn::Lt(b, zero), falling, hn::IfThenElse(hn::Lt(a, zero), bent, infinity));
  return hn::IfThenElse(hn::Lt(discriminant, zero), infinity, result);
}

double largest_step(const TermsView& terms, const double* direction) {
  const double infinity = std::numeric_limits<double>::infinity();
  V limit = set(infinity);
  for (size_t t = 0; t < terms.count; t += kLanes) {
    const Corners u = corners_of(terms, terms.uv, t), w = corners_of(terms, direction, t);
    const V ax = hn::Sub(u.x[1], u.x[0]), ay = hn::Sub(u.y[1], u.y[0]);
    const V bx = hn::Sub(u.x[2], u.x[0]), by = hn::Sub(u.y[2], u.y[0]);
    const V cx = hn::Sub(w.x[1], w.x[0]), cy = hn::Sub(w.y[1], w.y[0]);
    const V dx = hn::Sub(w.x[2], w.x[0]), dy = hn::Sub(w.y[2], w.y[0]);
    const V root =
        first_root(hn::Sub(hn::Mul(cx, dy), hn::Mul(cy, dx)),
                   hn::Sub(hn::Add(hn::Sub(hn::Mul(ax, dy), hn::Mul(ay, dx)), hn::Mul(cx, by)), hn::Mul(cy, bx)),
                   hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx)));
    limit = hn::IfThenElse(hn::Lt(root, limit), root, limit);
  }
  double lane[kMostLanes], least = infinity;
  hn::StoreU(limit, D(), lane);
  for (size_t i = 0; i < kLanes; ++i) least = std::min(least, lane[i]);
  return least;
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {
namespace {

HWY_EXPORT(densities);
HWY_EXPORT(cost);
HWY_EXPORT(differentiate);
HWY_EXPORT(largest_step);

struct Element {
  std::array<double, DirichletTerms::kUnknowns> gradient;
  double area;
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
  return {{-b00, -b01 - b11, b00, b01, 0, b11}, 0.5 * l * height};
}

}  // namespace

DirichletTerms::DirichletTerms(std::span<const Point3> position, std::span<const Triangle> triangle,
                               std::span<const double> share)
    : count_(triangle.size()) {
  const size_t filled_up = (count_ + kMostLanes - 1) / kMostLanes * kMostLanes;
  for (auto& c : corner_) c.resize(filled_up);
  for (auto& g : gradient_) g.resize(filled_up);
  weight_.resize(filled_up);
  double area = 0;
  for (size_t t = 0; t < filled_up; ++t) {
    const Triangle& k = triangle[std::min(t, count_ - 1)];
    const Element e = make_element(position[k[0]], position[k[1]], position[k[2]]);
    for (size_t i = 0; i < k.size(); ++i) corner_[i][t] = 2 * static_cast<int64_t>(k[i]);
    for (size_t i = 0; i < kUnknowns; ++i) gradient_[i][t] = e.gradient[i];
    weight_[t] = share.empty() ? e.area : e.area * share[std::min(t, count_ - 1)];
    if (t < count_) area += weight_[t];
  }
  for (double& w : weight_) w /= area;
}

void DirichletTerms::multiply_weights(std::span<const double> times) {
  for (size_t t = 0; t < times.size(); ++t) weight_[t] *= times[t];
}

std::vector<double> DirichletTerms::densities(std::span<const Point2> uv) const {
  std::vector<double> result(count_);
  HWY_DYNAMIC_DISPATCH(densities)(view(uv, 0), result.data());
  return result;
}

double DirichletTerms::cost(std::span<const Point2> uv, double shear_price) const {
  return HWY_DYNAMIC_DISPATCH(cost)(view(uv, shear_price));
}

void DirichletTerms::differentiate(size_t first, size_t last, std::span<const Point2> uv, double shear_price,
                                   std::span<double> gradient, std::span<double> hessian) const {
  HWY_DYNAMIC_DISPATCH(differentiate)(view(uv, shear_price), first, last, gradient.data(), hessian.data());
}

double DirichletTerms::largest_step(std::span<const Point2> uv, std::span<const Point2> direction) const {
  return HWY_DYNAMIC_DISPATCH(largest_step)(view(uv, 0), direction.empty() ? nullptr : direction.front().data());
}

TermsView DirichletTerms::view(std::span<const Point2> uv, double shear_price) const {
  TermsView result{count_, {}, {}, weight_.data(), uv.empty() ? nullptr : uv.front().data(), shear_price};
  for (size_t i = 0; i < corner_.size(); ++i) result.corner[i] = corner_[i].data();
  for (size_t i = 0; i < gradient_.size(); ++i) result.gradient[i] = gradient_[i].data();
  return result;
}

}  // namespace geocloth
#endif
