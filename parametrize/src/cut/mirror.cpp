// SPDX-License-Identifier: GPL-3.0-or-later
// Planes through the middle of the surface, across its principal axes and upright all around, are tried; the best few
// are moved until the mirror images of points on the surface lie on it as well as they can: nearest places and least
// squares in turn (iterated closest points, Besl and McKay 1992, for a reflection: Podolak et al., A planar-reflective
// symmetry transform, SIGGRAPH 2006, refine theirs so).
#include "geocloth/parametrize/mirror.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>
#include <tbb/parallel_for.h>

#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"
#include "mesh/triangle_tree.h"

namespace geocloth {
namespace {

constexpr size_t kSamples = 300;     // of the surface, each of equal area
constexpr size_t kFirstSamples = 4;  // every so manyth of them judges a plane at first
constexpr int kUpright = 8;          // planes that stand upright
constexpr size_t kRefined = 4;       // planes that are moved
constexpr double kOneStart = 0.98;   // cosine between normals from which one plane is tried for both
constexpr int kRounds = 8;
constexpr double kTolerance = 0.01;   // of the surface's extent
constexpr double kOutlier = 0.05;     // of the extent: farther from the surface a mirror image has no counterpart
constexpr double kLeastShare = 0.85;  // of the surface that must have its counterpart

constexpr double kEqual = 1.5;   // times the error of the best plane: one that is as good
constexpr double kExact = 0.05;  // of the tolerance: errors that are none
constexpr double kWider = 1.1;
constexpr double kAcross = 0.2;   // cosine between the normals of planes that cross at right angles, at most
constexpr double kSameWay = 0.9;  // cosine between the normals of planes that are one

using Vector = Eigen::Vector3d;

Vector to_eigen(const Point3& p) {
  return {p[0], p[1], p[2]};
}
Point3 to_point(const Vector& v) {
  return {v[0], v[1], v[2]};
}

class MirrorFinder {
 public:
  MirrorFinder(std::span<const Point3> position, std::span<const Triangle> triangle)
      : tree_(position, triangle), sample_(even_samples(triangle_middles(position, triangle), kSamples)) {
    for (const Point3& p : sample_) middle_ = middle_ + p * (1.0 / static_cast<double>(sample_.size()));
    for (const Point3& p : sample_) extent_ = std::max(extent_, 2 * distance(p, middle_));
  }

  std::optional<MirrorPlane> find() {
    struct Judged {
      double error = 0;
      MirrorPlane plane;
    };
    const std::vector<Vector> normals = first_normals();
    std::vector<Judged> judged(normals.size());
    tbb::parallel_for(size_t{0}, normals.size(), [&](size_t i) {
      const Vector& n = normals[i];
      const MirrorPlane plane{to_point(n), n.dot(to_eigen(middle_)), 0, kTolerance * extent_};
      judged[i] = {error_of(plane, kFirstSamples), plane};
    });
    const auto better = [](const Judged& a, const Judged& b) { return a.error < b.error; };
    std::stable_sort(judged.begin(), judged.end(), better);
    std::vector<Judged> chosen;
    for (const Judged& j : judged) {
      const auto same = [&](const Judged& c) { return std::abs(dot(c.plane.normal, j.plane.normal)) > kOneStart; };
      if (chosen.size() < kRefined && std::none_of(chosen.begin(), chosen.end(), same)) chosen.push_back(j);
    }
    judged = std::move(chosen);
    tbb::parallel_for(size_t{0}, judged.size(), [&](size_t i) {
      Judged& j = judged[i];
      std::vector<TriangleTree::Place> place;
      for (int round = 0; round < kRounds; ++round) refine(j.plane, place);
      j.error = error_of(j.plane, 1);
    });
    Judged best = *std::min_element(judged.begin(), judged.end(), better);
    // What is round has no left and right: chance would choose among its planes. Where front and back are alike too,
    // left and right are farther apart.
    const double equal = kEqual * best.error + kExact * best.plane.tolerance * static_cast<double>(sample_.size());
    std::erase_if(judged, [&](const Judged& j) { return j.error > equal; });
    for (const Judged& j : judged) {
      const double same_way = std::abs(dot(j.plane.normal, best.plane.normal));
      if (same_way > kAcross && same_way < kSameWay) return std::nullopt;
    }
    for (const Judged& j : judged) {
      if (width_across(j.plane) > kWider * width_across(best.plane)) best = j;
    }
    MirrorPlane result = best.plane;
    result.share = share_of(result);
    if (result.share < kLeastShare) return std::nullopt;
    return result;
  }

 private:
  [[nodiscard]] std::vector<Vector> first_normals() const {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Point3& p : sample_) {
      const Vector d = to_eigen(p - middle_);
      covariance += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
    std::vector<Vector> normals;
    normals.reserve(3 + kUpright);
    for (int k = 0; k < 3; ++k) normals.emplace_back(axes.eigenvectors().col(k));
    // Upright planes, from the longest level axis around.
    const Eigen::Matrix2d level{{covariance(0, 0), covariance(0, 2)}, {covariance(2, 0), covariance(2, 2)}};
    const Eigen::Vector2d longest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(level).eigenvectors().col(1);
    const double first = std::atan2(longest[1], longest[0]);
    for (int k = 0; k < kUpright; ++k) {
      const double angle = first + k * std::numbers::pi / kUpright;
      normals.emplace_back(std::cos(angle), 0, std::sin(angle));
    }
    return normals;
  }

  /// Distance of the mirror images of every so manyth sample from the surface.
  [[nodiscard]] std::vector<double> off(const MirrorPlane& plane, size_t step) const {
    std::vector<double> result;
    std::optional<TriangleTree::Place> last;
    for (size_t i = 0; i < sample_.size(); i += step) {
      const Point3 image = plane.image(sample_[i]);
      last = tree_.nearest(image, last);
      result.push_back(distance(image, last->point));
    }
    return result;
  }

  /// How wide the surface is across an upright plane; 0 for one that does not stand.
  [[nodiscard]] double width_across(const MirrorPlane& plane) const {
    if (std::abs(plane.normal[1]) > 0.5) return 0;
    double width = 0;
    for (const Point3& p : sample_) width = std::max(width, std::abs(plane.height(p)));
    return width;
  }

  /// What has no counterpart counts as far.
  [[nodiscard]] double error_of(const MirrorPlane& plane, size_t step) const {
    double sum = 0;
    for (const double d : off(plane, step)) sum += std::min(d, kOutlier * extent_);
    return sum * static_cast<double>(step);
  }

  [[nodiscard]] double share_of(const MirrorPlane& plane) const {
    const std::vector<double> distances = off(plane, 1);
    const auto on_it =
        std::count_if(distances.begin(), distances.end(), [&](double d) { return d <= plane.tolerance; });
    return static_cast<double>(on_it) / static_cast<double>(distances.size());
  }

  /// The plane that takes points to the places nearest to their present mirror images: |p - 2 (n p) n - q|^2, from the
  /// pairs' common middle, is least for the n with the least n' (p q') n.
  /// @param place  per sample: where its mirror image's nearest place was before; filled in
  void refine(MirrorPlane& plane, std::vector<TriangleTree::Place>& place) const {
    std::vector<std::pair<Vector, Vector>> pair;
    Vector middle = Vector::Zero();
    for (size_t i = 0; i < sample_.size(); ++i) {
      const Point3 &p = sample_[i], image = plane.image(p);
      if (i == place.size()) {
        place.push_back(i == 0 ? tree_.nearest(image) : tree_.nearest(image, place.back()));
      } else {
        place[i] = tree_.nearest(image, place[i]);
      }
      if (distance(image, place[i].point) > kOutlier * extent_) continue;
      pair.emplace_back(to_eigen(p), to_eigen(place[i].point));
      middle += (pair.back().first + pair.back().second) / 2;
    }
    if (pair.size() < sample_.size() / 2) return;
    middle /= static_cast<double>(pair.size());
    Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
    for (const auto& [p, q] : pair) product += (p - middle) * (q - middle).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(product + product.transpose());
    const Vector normal = axes.eigenvectors().col(0);
    plane.normal = to_point(normal);
    plane.offset = normal.dot(middle);
  }

  TriangleTree tree_;
  std::vector<Point3> sample_;
  Point3 middle_{};
  double extent_ = 0;  // [m]
};

}  // namespace

std::optional<MirrorPlane> find_mirror_plane(std::span<const Point3> position, std::span<const Triangle> triangle) {
  return MirrorFinder(position, triangle).find();
}

}  // namespace geocloth
