// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks to flat charts. A disk starts from Tutte's embedding with its outline on a circle, which cannot flip, and is
// relaxed to the least symmetric Dirichlet energy with a free outline. Opening a path that ends on the outline keeps
// the disk a disk and keeps every triangle where it is in the plane, so a cut is a warm start. A long tube that ends in
// a cap has no usable Tutte embedding (its far end shrinks exponentially): such a disk is cut towards its far end
// first.

#include "develop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <string>

#include <Eigen/SparseCholesky>

#include "cut_graph.h"
#include "geocloth/asset/error.h"
#include "half_edges.h"
#include "point_math.h"
#include "predicates.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One disk, by itself. Triangles keep their order through all cuts.
struct Chart {
  std::vector<Triangle> triangle;
  std::vector<uint32_t> global_triangle;  // per triangle: triangle of the cut surface
  std::vector<uint32_t> opposite;
  std::vector<Point3> position;
  std::vector<uint32_t> cut_vertex;  // per vertex: vertex of the cut surface
  std::vector<Point2> uv;            // empty until embedded
};

double total_area(const Chart& c) {
  double area = 0;
  for (const Triangle& t : c.triangle) area += triangle_area(c.position[t[0]], c.position[t[1]], c.position[t[2]]);
  return area;
}

std::vector<uint32_t> outline_loop(const Chart& c) {
  std::vector<uint32_t> next(c.position.size(), kNone);
  uint32_t first = kNone;
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    if (c.opposite[h] != kNone) continue;
    next[tail(c.triangle, h)] = head(c.triangle, h);
    if (first == kNone) first = tail(c.triangle, h);
  }
  std::vector<uint32_t> loop;
  for (uint32_t v = first; loop.empty() || v != first; v = next[v]) loop.push_back(v);
  return loop;
}

struct Neighbour {
  uint32_t vertex;
  double length;  // of the edge [m]
  bool outline;   // the edge is one of the outline
};

std::vector<std::vector<Neighbour>> neighbours(const Chart& c) {
  std::vector<std::vector<Neighbour>> result(c.position.size());
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    const bool outline = c.opposite[h] == kNone;
    if (!outline && c.opposite[h] < h) continue;
    const uint32_t a = tail(c.triangle, h), b = head(c.triangle, h);
    const double l = distance(c.position[a], c.position[b]);
    result[a].push_back({b, l, outline});
    result[b].push_back({a, l, outline});
  }
  return result;
}

/// Dijkstra's distances from a set of vertices along edges, with the way back. `closed` vertices are ends, never
/// passed.
struct Distances {
  std::vector<double> value;
  std::vector<uint32_t> from;
  [[nodiscard]] std::vector<uint32_t> path_from(uint32_t v) const {
    std::vector<uint32_t> path{v};
    while (from[path.back()] != kNone) path.push_back(from[path.back()]);
    return path;
  }
};

Distances distances(const Chart& c, const std::vector<uint32_t>& sources, const std::vector<uint8_t>& closed) {
  const auto around = neighbours(c);
  Distances d{std::vector<double>(c.position.size(), kInfinity), std::vector<uint32_t>(c.position.size(), kNone)};
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const uint32_t v : sources) {
    d.value[v] = 0;
    queue.emplace(0.0, v);
  }
  while (!queue.empty()) {
    const auto [value, v] = queue.top();
    queue.pop();
    if (value > d.value[v] || (value > 0 && closed[v] != 0)) continue;
    for (const auto& [w, l, outline] : around[v]) {
      if (outline || value + l >= d.value[w]) continue;
      d.value[w] = value + l;
      d.from[w] = v;
      queue.emplace(d.value[w], w);
    }
  }
  return d;
}

std::vector<uint8_t> on_outline(const Chart& c) {
  std::vector<uint8_t> result(c.position.size(), 0);
  for (const uint32_t v : outline_loop(c)) result[v] = 1;
  return result;
}

double path_length(const Chart& c, const std::vector<uint32_t>& path) {
  double sum = 0;
  for (size_t i = 1; i < path.size(); ++i) sum += distance(c.position[path[i - 1]], c.position[path[i]]);
  return sum;
}

/// The chart cut open along a path of vertices; the plane's coordinates stay.
Chart opened(const Chart& c, const std::vector<uint32_t>& path) {
  std::vector<uint32_t> place(c.position.size(), kNone);
  for (uint32_t i = 0; i < path.size(); ++i) place[path[i]] = i;
  std::vector<char> cut(c.opposite.size(), 0);
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    const uint32_t a = place[tail(c.triangle, h)], b = place[head(c.triangle, h)];
    const bool on_path = a != kNone && b != kNone && (a + 1 == b || b + 1 == a);
    if (c.opposite[h] == kNone || on_path) cut[h] = 1;
  }
  OpenedVertices o = open_along(c.triangle, c.opposite, cut);
  Chart result;
  result.triangle = std::move(o.triangle);
  result.global_triangle = c.global_triangle;
  result.opposite = opposite_half_edges(result.triangle);
  for (const uint32_t v : o.original) {
    result.position.push_back(c.position[v]);
    result.cut_vertex.push_back(c.cut_vertex[v]);
    if (!c.uv.empty()) result.uv.push_back(c.uv[v]);
  }
  return result;
}

/// The edge-connected pieces of a chart, in the order of their first triangles.
std::vector<Chart> separated(const Chart& c) {
  const Components components = connected_components(c.opposite);
  std::vector<Chart> pieces(components.count);
  std::vector<uint32_t> number(c.position.size(), kNone);
  for (uint32_t t = 0; t < c.triangle.size(); ++t) {
    Chart& piece = pieces[components.of_triangle[t]];
    Triangle corners{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = c.triangle[t][k];
      if (number[v] == kNone) {
        number[v] = static_cast<uint32_t>(piece.position.size());
        piece.position.push_back(c.position[v]);
        piece.cut_vertex.push_back(c.cut_vertex[v]);
        if (!c.uv.empty()) piece.uv.push_back(c.uv[v]);
      }
      corners[k] = number[v];
    }
    piece.triangle.push_back(corners);
    piece.global_triangle.push_back(c.global_triangle[t]);
  }
  for (Chart& piece : pieces) piece.opposite = opposite_half_edges(piece.triangle);
  return pieces;
}

// ------------------------------------------------------------------------------------------------ embedding

double signed_area(const Point2& a, const Point2& b, const Point2& c) {
  return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

bool flip_free(const Chart& c, const std::vector<Point2>& uv) {
  return std::all_of(c.triangle.begin(), c.triangle.end(),
                     [&](const Triangle& t) { return signed_area(uv[t[0]], uv[t[1]], uv[t[2]]) > 0; });
}

/// Tutte's embedding on a circle of the surface's area, with weights 1.
std::vector<Point2> tutte_embedding(const Chart& c) {
  const std::vector<uint32_t> loop = outline_loop(c);
  double length = 0;
  std::vector<double> arc;
  for (size_t i = 0; i < loop.size(); ++i) {
    arc.push_back(length);
    length += distance(c.position[loop[i]], c.position[loop[(i + 1) % loop.size()]]);
  }
  const double radius = std::sqrt(total_area(c) / std::acos(-1.0));
  std::vector<Point2> uv(c.position.size(), Point2{0, 0});
  std::vector<int32_t> unknown(c.position.size(), 0);
  for (size_t i = 0; i < loop.size(); ++i) {
    const double angle = 2 * std::acos(-1.0) * arc[i] / length;
    uv[loop[i]] = {radius * std::cos(angle), radius * std::sin(angle)};
    unknown[loop[i]] = -1;
  }
  int32_t unknowns = 0;
  for (int32_t& u : unknown) {
    if (u == 0) u = unknowns++;
  }
  if (unknowns == 0) return uv;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(unknowns, 2);
  const auto around = neighbours(c);
  for (uint32_t v = 0; v < around.size(); ++v) {
    if (unknown[v] < 0) continue;
    entries.emplace_back(unknown[v], unknown[v], static_cast<double>(around[v].size()));
    for (const auto& [w, l, outline] : around[v]) {
      if (unknown[w] < 0) {
        right(unknown[v], 0) += uv[w][0];
        right(unknown[v], 1) += uv[w][1];
      } else if (unknown[w] < unknown[v]) {
        entries.emplace_back(unknown[v], unknown[w], -1.0);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(laplacian);
  const Eigen::MatrixX2d solution = solver.solve(right);
  for (size_t v = 0; v < uv.size(); ++v) {
    if (unknown[v] >= 0) uv[v] = {solution(unknown[v], 0), solution(unknown[v], 1)};
  }
  return uv;
}

/// From the vertex farthest from the outline straight to it.
struct Farthest {
  double depth = 0;
  std::vector<uint32_t> path;
};
Farthest farthest_from_outline(const Chart& c) {
  const Distances d = distances(c, outline_loop(c), on_outline(c));
  const auto deepest = static_cast<uint32_t>(std::max_element(d.value.begin(), d.value.end()) - d.value.begin());
  return {d.value[deepest], d.path_from(deepest)};
}

double outline_length(const Chart& c) {
  const std::vector<uint32_t> loop = outline_loop(c);
  double sum = 0;
  for (size_t i = 0; i < loop.size(); ++i)
    sum += distance(c.position[loop[i]], c.position[loop[(i + 1) % loop.size()]]);
  return sum;
}

void embed(Chart& c) {
  // A flat disc is 0.16 outlines deep, a hemisphere 0.25: what is deeper is a tube or a bag.
  constexpr double kDeep = 0.3;
  constexpr int kTries = 12;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Farthest farthest = farthest_from_outline(c);
    if (farthest.path.size() > 1 && farthest.depth > kDeep * outline_length(c)) {
      c = opened(c, farthest.path);
      continue;
    }
    c.uv = tutte_embedding(c);
    if (flip_free(c, c.uv)) return;
    if (farthest.path.size() < 2) break;
    c = opened(c, farthest.path);
  }
  c.uv = tutte_embedding(c);
  if (!flip_free(c, c.uv)) {
    throw Error(ErrorCode::verification, "a part of " + std::to_string(c.triangle.size()) +
                                             " triangles cannot be laid flat in double precision; remesh it with "
                                             "triangles of more even size");
  }
}

// ------------------------------------------------------------------------------------------------ overlap

/// Two outline edges (by their places in the loop) that properly cross in the plane.
std::optional<std::array<size_t, 2>> crossing_edges(const Chart& c, const std::vector<uint32_t>& loop) {
  const size_t n = loop.size();
  double low_x = kInfinity, low_y = kInfinity, high_x = -kInfinity, high_y = -kInfinity, length = 0;
  for (size_t i = 0; i < n; ++i) {
    const Point2& a = c.uv[loop[i]];
    const Point2& b = c.uv[loop[(i + 1) % n]];
    low_x = std::min(low_x, a[0]);
    low_y = std::min(low_y, a[1]);
    high_x = std::max(high_x, a[0]);
    high_y = std::max(high_y, a[1]);
    length += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  const double cell = std::max(length / static_cast<double>(n), 1e-3 * std::max(high_x - low_x, high_y - low_y));
  const auto column = [&](double x) { return static_cast<int64_t>((x - low_x) / cell); };
  const auto row = [&](double y) { return static_cast<int64_t>((y - low_y) / cell); };
  const int64_t columns = column(high_x) + 1;
  std::vector<std::pair<int64_t, size_t>> entry;  // cell, edge
  for (size_t i = 0; i < n; ++i) {
    const Point2& a = c.uv[loop[i]];
    const Point2& b = c.uv[loop[(i + 1) % n]];
    for (int64_t y = row(std::min(a[1], b[1])); y <= row(std::max(a[1], b[1])); ++y) {
      for (int64_t x = column(std::min(a[0], b[0])); x <= column(std::max(a[0], b[0])); ++x) {
        entry.emplace_back(y * columns + x, i);
      }
    }
  }
  std::sort(entry.begin(), entry.end());
  std::optional<std::array<size_t, 2>> best;
  for (size_t begin = 0, end = 0; begin < entry.size(); begin = end) {
    while (end < entry.size() && entry[end].first == entry[begin].first) ++end;
    for (size_t p = begin; p < end; ++p) {
      for (size_t q = p + 1; q < end; ++q) {
        const size_t i = entry[p].second, j = entry[q].second;
        if (j == i + 1 || (i == 0 && j == n - 1)) continue;
        const Point2 &a = c.uv[loop[i]], &b = c.uv[loop[i + 1]], &d = c.uv[loop[j]], &e = c.uv[loop[(j + 1) % n]];
        if (orientation(a, b, d) * orientation(a, b, e) < 0 && orientation(d, e, a) * orientation(d, e, b) < 0) {
          if (!best || std::array{i, j} < *best) best = {i, j};
        }
      }
    }
  }
  return best;
}

/// A path that parts the two crossing edges: from the middle of the outline between them to the middle of the rest.
std::vector<uint32_t> parting_path(const Chart& c, const std::vector<uint32_t>& loop, std::array<size_t, 2> crossing) {
  const size_t n = loop.size();
  const size_t first = crossing[1] - crossing[0];
  const auto middle = [&](size_t begin, size_t count, size_t share) {
    // The middle part of a stretch of the outline, at least one vertex.
    std::vector<uint32_t> vertices;
    const size_t margin = count / share;
    for (size_t k = 1 + margin; k + margin <= count; ++k) vertices.push_back(loop[(begin + k) % n]);
    if (vertices.empty()) vertices.push_back(loop[(begin + (count + 1) / 2) % n]);
    return vertices;
  };
  const std::vector<uint8_t> closed = on_outline(c);
  // Prefer a path between the middles; a thin neck may leave none, then any two vertices of the stretches will do.
  for (const size_t share : {size_t{3}, size_t{6}, n + 1}) {
    const std::vector<uint32_t> from = middle(crossing[0], first, share);
    const std::vector<uint32_t> to = middle(crossing[1], n - first, share);
    const Distances d = distances(c, from, closed);
    uint32_t best = kNone;
    for (const uint32_t v : to) {
      if (std::isfinite(d.value[v]) && d.from[v] != kNone && (best == kNone || d.value[v] < d.value[best])) best = v;
    }
    if (best != kNone) return d.path_from(best);
  }
  return {};
}

// ------------------------------------------------------------------------------------------------ cuts that pay

/// Places worth a cut, worst first: interior vertices by the excess energy of the triangles within two rings.
std::vector<uint32_t> worst_vertices(const Chart& c, const std::vector<double>& energy,
                                     const std::vector<uint8_t>& closed) {
  std::vector<double> ring(c.position.size(), 0), score(c.position.size(), 0);
  for (size_t t = 0; t < c.triangle.size(); ++t) {
    const Triangle& k = c.triangle[t];
    const double excess = (energy[t] - 4) * triangle_area(c.position[k[0]], c.position[k[1]], c.position[k[2]]);
    for (const uint32_t v : k) ring[v] += excess;
  }
  for (const Triangle& k : c.triangle) {
    for (size_t i = 0; i < 3; ++i) score[k[i]] += ring[k[(i + 1) % 3]] + ring[k[(i + 2) % 3]];
  }
  std::vector<uint32_t> order;
  for (uint32_t v = 0; v < score.size(); ++v) {
    if (closed[v] == 0) order.push_back(v);
  }
  const size_t keep = std::min<size_t>(order.size(), 64);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(keep), order.end(),
                    [&](uint32_t a, uint32_t b) { return score[a] != score[b] ? score[a] > score[b] : a < b; });
  order.resize(keep);
  return order;
}

class Developer {
 public:
  Developer(const CutSurface& cut, const DevelopOptions& options) : cut_(cut), options_(options) {}

  /// Lays one component out; returns its charts.
  std::vector<Chart> develop_component(std::vector<uint32_t> triangles) {
    cuts_left_ = options_.max_cuts_per_chart;
    std::vector<Chart> done, open;
    open.push_back(extract(std::move(triangles)));
    while (!open.empty()) {
      Chart chart = std::move(open.back());
      open.pop_back();
      if (chart.uv.empty()) embed(chart);
      relax(chart);
      std::vector<Chart> pieces = without_overlap(chart);
      if (pieces.empty()) {
        done.push_back(std::move(chart));
      } else {
        for (Chart& piece : pieces) open.push_back(std::move(piece));
      }
    }
    for (Chart& chart : done) turn_upright(chart);
    return done;
  }

 private:
  Chart extract(std::vector<uint32_t> triangles) const {
    Chart c;
    c.global_triangle = std::move(triangles);
    std::vector<std::pair<uint32_t, uint32_t>> corner;
    for (uint32_t i = 0; i < c.global_triangle.size(); ++i) {
      for (uint32_t k = 0; k < 3; ++k) corner.emplace_back(cut_.triangle[c.global_triangle[i]][k], 3 * i + k);
    }
    std::sort(corner.begin(), corner.end());
    c.triangle.resize(c.global_triangle.size());
    for (const auto& [v, h] : corner) {
      if (c.cut_vertex.empty() || c.cut_vertex.back() != v) {
        c.cut_vertex.push_back(v);
        c.position.push_back(cut_.position[v]);
      }
      c.triangle[h / 3][h % 3] = static_cast<uint32_t>(c.cut_vertex.size() - 1);
    }
    c.opposite = opposite_half_edges(c.triangle);
    return c;
  }

  /// Minimises the energy and opens cuts while they pay.
  void relax(Chart& chart) {
    double energy = minimise(chart, 80, 1e-4);
    int refused = 0;
    while (energy > options_.target_energy && cuts_left_ > 0 && refused < 3) {
      const std::vector<uint8_t> closed = on_outline(chart);
      const std::vector<double> per_triangle =
          SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
      const std::vector<uint32_t> worst = worst_vertices(chart, per_triangle, closed);
      const auto candidate = static_cast<size_t>(refused) * 20;
      if (candidate >= worst.size()) break;
      const std::vector<uint32_t> path = distances(chart, outline_loop(chart), closed).path_from(worst[candidate]);
      if (path.size() < 2) break;
      if (path_length(chart, path) < options_.least_cut) {
        ++refused;
        continue;
      }
      Chart trial = opened(chart, path);
      const double reached = minimise(trial, 12, 1e-3);
      const double price = options_.cut_price * path_length(chart, path) / std::sqrt(total_area(chart));
      if (energy - reached > price) {
        chart = std::move(trial);
        energy = reached;
        --cuts_left_;
        refused = 0;
      } else {
        ++refused;
      }
    }
    minimise(chart, 30, 1e-6);
  }

  static double minimise(Chart& chart, uint32_t iterations, double tolerance) {
    return SymmetricDirichlet(chart.position, chart.triangle, {}).minimise(chart.uv, iterations, tolerance);
  }

  /// The pieces of a chart whose outline crosses itself, or nothing when it does not.
  std::vector<Chart> without_overlap(const Chart& chart) {
    const std::vector<uint32_t> loop = outline_loop(chart);
    const auto crossing = crossing_edges(chart, loop);
    if (!crossing) return {};
    const std::vector<uint32_t> path = parting_path(chart, loop, *crossing);
    if (path.size() < 2) {
      throw Error(ErrorCode::verification, "a chart of " + std::to_string(chart.triangle.size()) +
                                               " triangles overlaps itself in the plane and cannot be parted; try "
                                               "--layout square");
    }
    return separated(opened(chart, path));
  }

  static void turn_upright(Chart& c) {
    // Mean gradient of the height over the plane; where the panel lies level, its long axis.
    Point2 up{0, 0};
    double area = 0;
    for (const Triangle& t : c.triangle) {
      const Point2 &a = c.uv[t[0]], &b = c.uv[t[1]], &d = c.uv[t[2]];
      const double h1 = c.position[t[1]][1] - c.position[t[0]][1];
      const double h2 = c.position[t[2]][1] - c.position[t[0]][1];
      // Half of (gradient x twice the area).
      up[0] += (h1 * (d[1] - a[1]) - h2 * (b[1] - a[1])) / 2;
      up[1] += (h2 * (b[0] - a[0]) - h1 * (d[0] - a[0])) / 2;
      area += signed_area(a, b, d);
    }
    constexpr double kLevel = 0.1;  // slope below which a panel counts as level
    constexpr double kSlender = 6;  // ribbons and trims: their grain runs along them
    const LongAxis axis = long_axis(c);
    if (std::hypot(up[0], up[1]) < kLevel * area || axis.ratio > kSlender) {
      // The end that is higher stays up.
      const bool turn = up[0] * axis.direction[0] + up[1] * axis.direction[1] < 0;
      up = turn ? Point2{-axis.direction[0], -axis.direction[1]} : axis.direction;
    }
    const double l = std::hypot(up[0], up[1]);
    for (Point2& p : c.uv) p = {(p[0] * up[1] - p[1] * up[0]) / l, (p[0] * up[0] + p[1] * up[1]) / l};
  }

  struct LongAxis {
    Point2 direction;
    double ratio;  // of the spreads along it and across
  };
  static LongAxis long_axis(const Chart& c) {
    double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    const auto n = static_cast<double>(c.uv.size());
    for (const Point2& p : c.uv) {
      mx += p[0] / n;
      my += p[1] / n;
    }
    for (const Point2& p : c.uv) {
      xx += (p[0] - mx) * (p[0] - mx);
      xy += (p[0] - mx) * (p[1] - my);
      yy += (p[1] - my) * (p[1] - my);
    }
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const double mean = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
    return {{std::cos(angle), std::sin(angle)}, std::sqrt((mean + spread) / std::max(mean - spread, 1e-12 * mean))};
  }

  const CutSurface& cut_;
  DevelopOptions options_;
  uint32_t cuts_left_ = 0;
};

}  // namespace

DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options, const Progress& progress) {
  std::vector<std::vector<uint32_t>> triangles(cut.component_count);
  for (uint32_t t = 0; t < cut.triangle.size(); ++t) triangles[cut.component[t]].push_back(t);
  Developer developer(cut, options);
  DevelopedSurface result;
  CutSurface& out = result.cut;
  out.triangle.resize(cut.triangle.size());
  out.component.resize(cut.triangle.size());
  out.point_count = cut.point_count;
  size_t finished = 0;
  for (std::vector<uint32_t>& part : triangles) {
    finished += part.size();
    for (const Chart& chart : developer.develop_component(std::move(part))) {
      const auto first = static_cast<uint32_t>(out.position.size());
      for (size_t v = 0; v < chart.position.size(); ++v) {
        out.position.push_back(chart.position[v]);
        out.point.push_back(cut.point[chart.cut_vertex[v]]);
        out.clean_vertex.push_back(cut.clean_vertex[chart.cut_vertex[v]]);
        result.uv.push_back(chart.uv[v]);
      }
      for (size_t t = 0; t < chart.triangle.size(); ++t) {
        const Triangle& k = chart.triangle[t];
        out.triangle[chart.global_triangle[t]] = {first + k[0], first + k[1], first + k[2]};
        out.component[chart.global_triangle[t]] = out.component_count;
      }
      ++out.component_count;
      result.energy.push_back(SymmetricDirichlet(chart.position, chart.triangle, {}).energy(chart.uv));
    }
    if (progress) progress("flatten", static_cast<double>(finished) / static_cast<double>(cut.triangle.size()));
  }
  return result;
}

}  // namespace geocloth
