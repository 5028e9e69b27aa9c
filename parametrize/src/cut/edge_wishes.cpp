// SPDX-License-Identifier: GPL-3.0-or-later

// Weights of cut paths: the geometry images of Gu, Gortler, Hoppe 2002 know lengths only; where a tailor would cut is
// told by the shape's folds, by seams that the garment has, and by its left and right sides.

#include "cut/edge_wishes.h"

#include <algorithm>
#include <cmath>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/triangle_tree.h"

namespace geocloth {
namespace {

constexpr double kBeside = 0.6;  // of a mean edge: so near to the mirror plane a path of edges can always follow it

constexpr double kFolded = 0.6;     // [rad] from which a cut edge lies on a crease
constexpr double kOnward = 0.8;     // least cosine between edges of one crease that follow each other
constexpr double kLeastRun = 0.15;  // of the root of the area: shorter folds are wrinkles

using VertexPair = std::array<uint32_t, 2>;

VertexPair sorted_pair(uint32_t a, uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Edges to be looked up with std::binary_search.
std::vector<VertexPair> sorted_seams(const CutPreferences& prefer) {
  std::vector<VertexPair> seams;
  seams.reserve(prefer.seams.size());
  for (const VertexPair& s : prefer.seams) seams.push_back(sorted_pair(s[0], s[1]));
  std::sort(seams.begin(), seams.end());
  return seams;
}

/// Cut edges that are folded and follow each other without a turn for a while.
class CreaseRuns {
 public:
  CreaseRuns(const RefinedMesh& mesh, const CutLines& lines) : mesh_(mesh), folded_(mesh.opposite.size(), 0) {
    at_.resize(mesh.position.size());
    for (uint32_t h = 0; h < folded_.size(); ++h) {
      const uint32_t o = mesh.opposite[h];
      if (o == kNone || o < h || !lines.cut[h] || lines.fixed[h] || may_go_anywhere(lines, h)) continue;
      if (fold_between(mesh.position, mesh.triangle[h / 3], mesh.triangle[o / 3]) < kFolded) continue;
      folded_[h] = 1;
      at_[tail(mesh.triangle, h)].push_back(h);
      at_[head(mesh.triangle, h)].push_back(h);
    }
  }

  /// One half-edge of every edge.
  [[nodiscard]] std::vector<uint32_t> edges() {
    std::vector<uint32_t> result, run;
    double area = 0;
    for (const auto& [a, b, c] : mesh_.triangle) {
      area += triangle_area(mesh_.position[a], mesh_.position[b], mesh_.position[c]);
    }
    const double least = kLeastRun * std::sqrt(area);
    for (uint32_t start = 0; start < folded_.size(); ++start) {
      if (folded_[start] == 0) continue;
      folded_[start] = 0;
      run = {start};
      double length = 0;
      for (size_t i = 0; i < run.size(); ++i) {
        length += edge_length(run[i]);
        for (const uint32_t v : {tail(mesh_.triangle, run[i]), head(mesh_.triangle, run[i])}) {
          for (const uint32_t next : at_[v]) {
            if (folded_[next] == 0 || !goes_on(run[i], v, next)) continue;
            folded_[next] = 0;
            run.push_back(next);
          }
        }
      }
      if (length >= least) result.insert(result.end(), run.begin(), run.end());
    }
    return result;
  }

 private:
  [[nodiscard]] bool may_go_anywhere(const CutLines& lines, uint32_t h) const {
    if (lines.rings.empty()) return false;
    return lines.rings[tail(mesh_.triangle, h)] == kNone || lines.rings[head(mesh_.triangle, h)] == kNone;
  }
  [[nodiscard]] double edge_length(uint32_t h) const {
    return distance(mesh_.position[tail(mesh_.triangle, h)], mesh_.position[head(mesh_.triangle, h)]);
  }
  [[nodiscard]] Point3 away_from(uint32_t v, uint32_t h) const {
    const uint32_t a = tail(mesh_.triangle, h), b = head(mesh_.triangle, h);
    const Point3 way = mesh_.position[a == v ? b : a] - mesh_.position[v];
    return way * (1 / length(way));
  }
  [[nodiscard]] bool goes_on(uint32_t h, uint32_t v, uint32_t next) const {
    return dot(away_from(v, h), away_from(v, next)) < -kOnward;
  }

  const RefinedMesh& mesh_;
  std::vector<char> folded_;               // per half-edge, of one of each two
  std::vector<std::vector<uint32_t>> at_;  // per vertex: those half-edges
};

double mean_edge_length(std::span<const Point3> position, std::span<const Triangle> triangle) {
  double sum = 0;
  for (uint32_t h = 0; h < 3 * triangle.size(); ++h) {
    sum += distance(position[tail(triangle, h)], position[head(triangle, h)]);
  }
  return sum / (3 * static_cast<double>(triangle.size()));
}

}  // namespace

double fold_between(std::span<const Point3> position, const Triangle& a, const Triangle& b) {
  const auto normal = [&](const Triangle& k) {
    return cross(position[k[1]] - position[k[0]], position[k[2]] - position[k[0]]);
  };
  const Point3 m = normal(a), n = normal(b);
  return std::atan2(length(cross(m, n)), dot(m, n));
}

double crease_between(std::span<const Point3> position, const Triangle& a, const Triangle& b) {
  return std::min(1.0, fold_between(position, a, b));
}

double sharp_crease_between(std::span<const Point3> position, const Triangle& a, const Triangle& b) {
  constexpr double kWrinkle = 0.4;  // [rad]
  return std::clamp((fold_between(position, a, b) - kWrinkle) / (1 - kWrinkle), 0.0, 1.0);
}

std::vector<double> wished_discounts(std::span<const Point3> position, std::span<const Triangle> triangle,
                                     std::span<const uint32_t> clean_vertex, const CutPreferences& prefer) {
  std::vector<double> discount(3 * triangle.size(), 0.0);
  if (prefer.mirror) {
    const double beside = kBeside * mean_edge_length(position, triangle);
    for (uint32_t h = 0; h < discount.size(); ++h) {
      const double a = prefer.mirror->height(position[tail(triangle, h)]);
      const double b = prefer.mirror->height(position[head(triangle, h)]);
      if (std::max(std::abs(a), std::abs(b)) <= beside) discount[h] = kMirrorDiscount;
    }
  }
  if (prefer.seams.empty()) return discount;
  const std::vector<VertexPair> seams = sorted_seams(prefer);
  for (uint32_t h = 0; h < discount.size(); ++h) {
    const VertexPair edge = sorted_pair(clean_vertex[tail(triangle, h)], clean_vertex[head(triangle, h)]);
    if (std::binary_search(seams.begin(), seams.end(), edge)) discount[h] = kSeamDiscount;
  }
  return discount;
}

void hold_wished_cuts(const RefinedMesh& mesh, const CutPreferences& prefer, CutLines& lines) {
  std::vector<uint32_t> held;
  if (prefer.creases || !lines.rings.empty()) held = CreaseRuns(mesh, lines).edges();
  const std::vector<VertexPair> seams = sorted_seams(prefer);
  for (uint32_t h = 0; h < mesh.opposite.size() && !seams.empty(); ++h) {
    const uint32_t a = mesh.clean_vertex[tail(mesh.triangle, h)], b = mesh.clean_vertex[head(mesh.triangle, h)];
    const bool inside = lines.cut[h] && mesh.opposite[h] != kNone;
    if (inside && std::binary_search(seams.begin(), seams.end(), sorted_pair(a, b))) held.push_back(h);
  }
  for (const uint32_t h : held) lines.fixed[h] = lines.fixed[mesh.opposite[h]] = 1;
}

std::vector<uint32_t> mirror_vertices(std::span<const Point3> position, std::span<const Triangle> triangle,
                                      const MirrorPlane& plane) {
  const TriangleTree tree(position, triangle);
  std::vector<uint32_t> result(position.size(), kNone);
  std::optional<TriangleTree::Place> last;
  for (const Triangle& t : triangle) {
    for (const uint32_t v : t) {
      if (result[v] != kNone) continue;
      const Point3 image = plane.image(position[v]);
      last = tree.nearest(image, last);
      if (distance(last->point, image) > plane.tolerance) continue;
      const Triangle& there = triangle[last->triangle];
      result[v] = *std::min_element(there.begin(), there.end(), [&](uint32_t a, uint32_t b) {
        return distance(position[a], image) < distance(position[b], image);
      });
    }
  }
  return result;
}

}  // namespace geocloth
