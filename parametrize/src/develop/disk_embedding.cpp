// SPDX-License-Identifier: GPL-3.0-or-later
// Floater, Mean value coordinates, 2003; Yoshizawa, Belyaev, Seidel, A fast and simple stretch-minimizing mesh
// parameterization, 2004. The mean-value weights are made symmetric (w_ij + w_ji): any positive weights embed, and a
// symmetric matrix factorises several times faster. Dividing row i by s_i and w_ij by s_j is dividing by s_i s_j, which
// keeps the symmetry and is the same equation as Yoshizawa's.
#include "develop/disk_embedding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "develop/chart.h"
#include "develop/dissection.h"
#include "develop/element_cholesky.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

// Tangents of half angles of needle triangles span many magnitudes; beyond this share of the mean they only cost
// precision.
constexpr double kLeastWeight = 1e-4, kGreatestWeight = 1e4;
// A vertex's weight changes by this factor at most in a round; a flipped triangle counts as that much stretch. (A patch
// whose outline lies on one side of the square shrinks exponentially with its depth, at first beyond all precision.)
constexpr double kStep = 16;
constexpr double kLeastExponent = 0.2;
constexpr double kSettled = 0.998;  // share of the stretch that a round must lower it to
// The way down from a wild start is not monotone: so many rounds may be worse than the best.
constexpr double kWild = 2.5;
constexpr int kPatience = 5;

/// tan(angle / 2) between two directions, finite for every input.
double half_tangent(const Point3& p, const Point3& q) {
  const double cross_length = length(cross(p, q)), scalar = dot(p, q), lengths = length(p) * length(q);
  const double tangent = cross_length / (lengths + scalar);
  return std::isfinite(tangent) ? tangent : 1e6;
}

}  // namespace

struct DiskEmbedding::Impl {
  std::vector<Triangle> triangle;
  std::vector<double> area;                           // per triangle [m^2]
  std::vector<std::array<double, 3>> squared_length;  // per triangle: of the edge from corner i to the next
  std::vector<std::array<double, 3>> weight;          // per triangle: share of the weight of that edge
  std::vector<int32_t> unknown;                       // per vertex, -1 when fixed
  int32_t unknowns = 0;
  double total_area = 0;
  std::vector<double> divisor;  // per vertex: of the weights of its edges
  std::unique_ptr<ElementCholesky> solver;

  void weigh(std::span<const Point3> position, Weights kind) {
    weight.resize(triangle.size());
    double sum = 0;
    for (size_t t = 0; t < triangle.size(); ++t) {
      for (size_t i = 0; i < 3; ++i) {
        const Point3 &a = position[triangle[t][i]], &b = position[triangle[t][(i + 1) % 3]],
                     &c = position[triangle[t][(i + 2) % 3]];
        weight[t][i] =
            kind == Weights::uniform ? 1 : (half_tangent(b - a, c - a) + half_tangent(a - b, c - b)) / distance(a, b);
        if (!std::isfinite(weight[t][i])) weight[t][i] = 1e300;
        sum += std::log(weight[t][i]);
      }
    }
    const double typical = std::exp(sum / (3 * static_cast<double>(triangle.size())));
    for (auto& w : weight) {
      for (double& x : w) x = std::clamp(x / typical, kLeastWeight, kGreatestWeight);
    }
  }

  void factorise() {
    constexpr size_t kLowerHalf = 6;
    std::vector<double> element;
    element.reserve(triangle.size() * kLowerHalf);
    double trace = 0;
    for (size_t t = 0; t < triangle.size(); ++t) {
      std::array<double, 3> w{};  // of the edge from corner i to the next
      for (size_t i = 0; i < 3; ++i)
        w[i] = weight[t][i] / (divisor[triangle[t][i]] * divisor[triangle[t][(i + 1) % 3]]);
      element.insert(element.end(), {w[0] + w[2], -w[0], w[0] + w[1], -w[2], -w[1], w[1] + w[2]});
      trace += 2 * (w[0] + w[1] + w[2]);
    }
    if (!solver) {
      solver = std::make_unique<ElementCholesky>(triangle, unknown, places_by_edges(triangle, unknown.size()), 1);
    }
    // Where weights differ by more than the precision, rounding can make the matrix indefinite.
    constexpr double kRegular = 1e-14;
    if (solver->factorise(element, 0) || solver->factorise(element, kRegular * trace / unknowns)) return;
    throw Error(ErrorCode::verification, "the embedding of a part could not be solved");
  }

  template <typename Visit>
  void for_each_side(const Visit& visit) const {
    for (size_t t = 0; t < triangle.size(); ++t) {
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = triangle[t][i], b = triangle[t][(i + 1) % 3];
        visit(a, b, weight[t][i] / (divisor[a] * divisor[b]));
      }
    }
  }

  void solve(std::vector<Point2>& uv) const {
    if (unknowns == 0) return;
    Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(unknowns, 2);
    for_each_side([&](uint32_t a, uint32_t b, double w) {
      for (int swap = 0; swap < 2; ++swap, std::swap(a, b)) {
        if (unknown[a] < 0 || unknown[b] >= 0) continue;
        solution(unknown[a], 0) += w * uv[b][0];
        solution(unknown[a], 1) += w * uv[b][1];
      }
    });
    solver->solve(solution);
    for (size_t v = 0; v < unknown.size(); ++v) {
      if (unknown[v] >= 0) uv[v] = {solution(unknown[v], 0), solution(unknown[v], 1)};
    }
  }

  /// Multiplies the divisor of every vertex by a power of its stretch in `uv`, in units of the mean.
  void divide_by_stretch(std::span<const Point2> uv, double exponent) {
    std::vector<double> sum(unknown.size(), 0.0), around(unknown.size(), 0.0);
    for (size_t t = 0; t < triangle.size(); ++t) {
      const double stretch = squared_stretch(t, uv);
      for (const uint32_t v : triangle[t]) {
        sum[v] += area[t] * stretch;
        around[v] += area[t];
      }
    }
    double logarithm = 0, weighed = 0;
    for (size_t v = 0; v < sum.size(); ++v) {
      if (!std::isfinite(sum[v]) || !(sum[v] > 0)) continue;
      logarithm += around[v] * std::log(sum[v] / around[v]);
      weighed += around[v];
    }
    const double mean = weighed > 0 ? std::exp(logarithm / weighed) : 1;
    for (size_t v = 0; v < sum.size(); ++v) {
      if (around[v] > 0)
        divisor[v] *= std::clamp(std::pow(sum[v] / around[v] / mean, 0.5 * exponent), 1 / kStep, kStep);
    }
  }

  /// Half the squared norm of the map from the plane to the surface: (a + c) / 2 in Sander's notation. By the cotangent
  /// formula with the sides' roles exchanged: the squared length of a plane edge weighs the opposite angle of the
  /// surface.
  [[nodiscard]] double squared_stretch(size_t t, std::span<const Point2> uv) const {
    const Point2 &a = uv[triangle[t][0]], &b = uv[triangle[t][1]], &c = uv[triangle[t][2]];
    const double flat = signed_area(a, b, c);
    if (!(flat > 0)) return kInfinity;
    const auto squared = [](const Point2& p, const Point2& q) {
      return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
    };
    const std::array<double, 3> plane{squared(a, b), squared(b, c), squared(c, a)};
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
      sum += squared_length[t][i] * (plane[(i + 1) % 3] + plane[(i + 2) % 3] - plane[i]);
    }
    const double stretch = sum / (16 * flat * flat);
    if (!std::isfinite(stretch) || stretch <= 0) return kInfinity;
    return stretch;
  }
};

DiskEmbedding::DiskEmbedding(std::span<const Point3> position, std::span<const Triangle> triangle,
                             std::span<const uint8_t> fixed, Weights weights)
    : impl_(std::make_unique<Impl>()) {
  Impl& s = *impl_;
  s.triangle.assign(triangle.begin(), triangle.end());
  for (const Triangle& t : triangle) {
    s.area.push_back(triangle_area(position[t[0]], position[t[1]], position[t[2]]));
    s.total_area += s.area.back();
    std::array<double, 3> squared{};
    for (size_t i = 0; i < 3; ++i) {
      const Point3 edge = position[t[(i + 1) % 3]] - position[t[i]];
      squared[i] = dot(edge, edge);
    }
    s.squared_length.push_back(squared);
  }
  s.unknown.assign(position.size(), -1);
  for (size_t v = 0; v < position.size(); ++v) {
    if (fixed[v] == 0) s.unknown[v] = s.unknowns++;
  }
  s.divisor.assign(position.size(), 1.0);
  s.weigh(position, weights);
  if (s.unknowns > 0) s.factorise();
}

DiskEmbedding::DiskEmbedding(DiskEmbedding&&) noexcept = default;
DiskEmbedding& DiskEmbedding::operator=(DiskEmbedding&&) noexcept = default;
DiskEmbedding::~DiskEmbedding() = default;

void DiskEmbedding::solve(std::vector<Point2>& uv) const {
  impl_->solve(uv);
}

void DiskEmbedding::weigh_by(std::span<const Point2> uv) {
  std::vector<Point3> flat;
  for (const Point2& p : uv) flat.push_back({p[0], p[1], 0});
  std::fill(impl_->divisor.begin(), impl_->divisor.end(), 1.0);
  impl_->weigh(flat, Weights::mean_value);
  if (impl_->unknowns > 0) impl_->factorise();
}

double DiskEmbedding::l2_stretch(std::span<const Point2> uv) const {
  double sum = 0, flat_area = 0;
  for (size_t t = 0; t < impl_->triangle.size(); ++t) {
    const Triangle& corners = impl_->triangle[t];
    sum += impl_->area[t] * impl_->squared_stretch(t, uv);
    flat_area += signed_area(uv[corners[0]], uv[corners[1]], uv[corners[2]]);
  }
  const double squared = sum / impl_->total_area * (flat_area / impl_->total_area);
  return std::isfinite(squared) ? std::sqrt(squared) : kInfinity;
}

std::vector<double> DiskEmbedding::stretch_per_triangle(std::span<const Point2> uv) const {
  std::vector<double> result(impl_->triangle.size());
  for (size_t t = 0; t < result.size(); ++t) result[t] = impl_->squared_stretch(t, uv);
  return result;
}

double DiskEmbedding::relax_stretch(std::vector<Point2>& uv, int rounds) {
  Impl& s = *impl_;
  double best = l2_stretch(uv);
  if (s.unknowns == 0) return best;
  std::vector<Point2> trial = uv;
  std::vector<double> best_divisor = s.divisor;
  double exponent = 1;
  int worse = 0;  // rounds since the best
  for (int round = 0; round < rounds && exponent >= kLeastExponent; ++round) {
    s.divide_by_stretch(trial, exponent);
    s.factorise();
    s.solve(trial);
    const double reached = l2_stretch(trial);
    if (reached < best) {
      const bool settled = reached > best * kSettled;
      best = reached;
      best_divisor = s.divisor;
      uv = trial;
      worse = 0;
      if (settled) break;
    } else if (++worse > (best > kWild ? kPatience : 0)) {
      s.divisor = best_divisor;
      trial = uv;
      exponent *= 0.5;
      worse = 0;
    }
  }
  s.divisor = best_divisor;
  return best;
}

}  // namespace geocloth
