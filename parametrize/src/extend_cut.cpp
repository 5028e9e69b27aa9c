// SPDX-License-Identifier: GPL-3.0-or-later
// Gu, Gortler, Hoppe, Geometry Images, SIGGRAPH 2002, section 4: a tube whose end is closed shrinks to a point in a
// convex map; a cut to its tip lets it unfold. The tip is where a map to the circle stretches most. Each further cut is
// kept only if the stretch falls with it.
#include "extend_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>

#include "cut_graph.h"
#include "disk_embedding.h"
#include "half_edges.h"
#include "point_math.h"
#include "refined_mesh.h"

namespace geocloth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGoodStretch = 1.2;  // no cut is worth while below
constexpr double kNotable = 0.95;     // a cut must lower the stretch to this share of it
constexpr int kMaxCuts = 12;
constexpr int kRelaxRounds = 12;

/// One component by itself.
CutSurface extract(const CutSurface& cut, const std::vector<uint32_t>& triangles, std::vector<uint32_t>& local) {
  CutSurface part;
  part.component_count = 1;
  part.component.assign(triangles.size(), 0);
  for (const uint32_t t : triangles) {
    Triangle corners{};
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t v = cut.triangle[t][i];
      if (local[v] == kNone) {
        local[v] = static_cast<uint32_t>(part.position.size());
        part.position.push_back(cut.position[v]);
        part.point.push_back(cut.point[v]);
        part.clean_vertex.push_back(cut.clean_vertex[v]);
      }
      corners[i] = local[v];
    }
    part.triangle.push_back(corners);
  }
  part.point_count = cut.point_count;
  return part;
}

struct Judgement {
  double stretch = kInfinity;        // L2 of the improved map
  std::vector<double> per_triangle;  // stretch of the map as it comes, per triangle of the part
};

Judgement judge(const CutSurface& part) {
  RefinedMesh mesh = make_refined_mesh(part);
  split_edges_across(mesh);
  std::vector<uint8_t> fixed(mesh.position.size(), 0);
  std::vector<Point2> uv(mesh.position.size(), Point2{0, 0});
  std::vector<std::pair<uint32_t, double>> outline;  // vertex, arc length so far
  double total = 0;
  const auto start = static_cast<uint32_t>(
      std::find_if(mesh.leaving.begin(), mesh.leaving.end(), [](uint32_t h) { return h != kNone; }) -
      mesh.leaving.begin());
  for (uint32_t v = start; outline.empty() || v != start;) {
    outline.emplace_back(v, total);
    const uint32_t next = head(mesh.triangle, mesh.leaving[v]);
    total += distance(mesh.position[v], mesh.position[next]);
    v = next;
  }
  for (const auto& [v, arc] : outline) {
    const double angle = 2 * std::numbers::pi * arc / total;
    fixed[v] = 1;
    uv[v] = {std::cos(angle), std::sin(angle)};
  }
  DiskEmbedding embedding(mesh.position, mesh.triangle, fixed, DiskEmbedding::Weights::mean_value);
  embedding.solve(uv);
  Judgement result;
  result.per_triangle.assign(part.triangle.size(), 0);
  const std::vector<double> refined = embedding.stretch_per_triangle(uv);
  for (size_t t = 0; t < refined.size(); ++t) {
    double& stretch = result.per_triangle[mesh.clean_triangle[t]];
    stretch = std::max(stretch, refined[t]);
  }
  result.stretch = embedding.relax_stretch(uv, kRelaxRounds);
  return result;
}

/// Distance of every vertex from the outline along edges, and the half-edge (from the vertex) by which the way there
/// starts.
struct WayOut {
  std::vector<double> distance;
  std::vector<uint32_t> by;
};

WayOut ways_out(const CutSurface& part, const std::vector<uint32_t>& opposite) {
  WayOut way{std::vector<double>(part.position.size(), kInfinity), std::vector<uint32_t>(part.position.size(), kNone)};
  std::vector<std::vector<uint32_t>> entering(part.position.size());  // half-edges that end in the vertex
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    entering[head(part.triangle, h)].push_back(h);
    if (opposite[h] != kNone) continue;
    for (const uint32_t v : {tail(part.triangle, h), head(part.triangle, h)}) {
      if (way.distance[v] == 0) continue;
      way.distance[v] = 0;
      queue.emplace(0.0, v);
    }
  }
  while (!queue.empty()) {
    const auto [so_far, v] = queue.top();
    queue.pop();
    if (so_far > way.distance[v]) continue;
    for (const uint32_t h : entering[v]) {
      const uint32_t w = tail(part.triangle, h);
      const double through = so_far + distance(part.position[v], part.position[w]);
      if (!(through < way.distance[w])) continue;
      way.distance[w] = through;
      way.by[w] = h;
      queue.emplace(through, w);
    }
  }
  return way;
}

/// The vertex to cut to: of the triangles that stretch most, the one farthest from the outline; kNone when all vertices
/// are on the outline.
uint32_t find_tip(const CutSurface& part, const std::vector<double>& stretch, const WayOut& way) {
  double most = 0;
  for (size_t t = 0; t < stretch.size(); ++t) {
    const auto& [a, b, c] = part.triangle[t];
    if (std::max({way.distance[a], way.distance[b], way.distance[c]}) > 0) most = std::max(most, stretch[t]);
  }
  uint32_t tip = kNone;
  for (size_t t = 0; t < stretch.size(); ++t) {
    if (stretch[t] < most) continue;
    for (const uint32_t v : part.triangle[t]) {
      if (way.distance[v] > 0 && (tip == kNone || way.distance[v] > way.distance[tip])) tip = v;
    }
  }
  return tip;
}

/// The part with a cut from the tip to the outline; copies are appended, so that old vertices keep their numbers.
CutSurface cut_to(const CutSurface& part, const std::vector<uint32_t>& opposite, const WayOut& way, uint32_t tip) {
  std::vector<char> cut(opposite.size(), 0);
  for (size_t h = 0; h < opposite.size(); ++h) cut[h] = opposite[h] == kNone ? 1 : 0;
  for (uint32_t v = tip; way.distance[v] > 0; v = head(part.triangle, way.by[v])) {
    cut[way.by[v]] = cut[opposite[way.by[v]]] = 1;
  }
  const OpenedVertices opened = open_along(part.triangle, opposite, cut);
  CutSurface result = part;
  std::vector<uint32_t> number(opened.original.size(), kNone);
  std::vector<char> taken(part.position.size(), 0);
  for (size_t i = 0; i < number.size(); ++i) {
    const uint32_t v = opened.original[i];
    if (!taken[v]) {
      taken[v] = 1;
      number[i] = v;
      continue;
    }
    number[i] = static_cast<uint32_t>(result.position.size());
    result.position.push_back(part.position[v]);
    result.point.push_back(part.point[v]);
    result.clean_vertex.push_back(part.clean_vertex[v]);
  }
  for (size_t t = 0; t < result.triangle.size(); ++t) {
    for (size_t i = 0; i < 3; ++i) result.triangle[t][i] = number[opened.triangle[t][i]];
  }
  return result;
}

CutSurface extend(CutSurface part) {
  Judgement now = judge(part);
  for (int cuts = 0; cuts < kMaxCuts && now.stretch > kGoodStretch; ++cuts) {
    const std::vector<uint32_t> opposite = opposite_half_edges(part.triangle);
    const WayOut way = ways_out(part, opposite);
    const uint32_t tip = find_tip(part, now.per_triangle, way);
    if (tip == kNone) break;
    CutSurface longer = cut_to(part, opposite, way, tip);
    Judgement then = judge(longer);
    if (std::isfinite(now.stretch) && !(then.stretch < kNotable * now.stretch)) break;
    part = std::move(longer);
    now = std::move(then);
  }
  return part;
}

}  // namespace

CutSurface extend_cuts(CutSurface cut, const std::vector<char>& worthwhile, const Progress& progress) {
  std::vector<std::vector<uint32_t>> triangles(cut.component_count);
  for (uint32_t t = 0; t < cut.triangle.size(); ++t) triangles[cut.component[t]].push_back(t);
  std::vector<uint32_t> local(cut.position.size(), kNone);
  for (uint32_t c = 0; c < cut.component_count; ++c) {
    if (progress) progress("cut extension", static_cast<double>(c) / cut.component_count);
    if (!worthwhile[c]) continue;
    CutSurface part = extract(cut, triangles[c], local);
    const size_t vertices = part.position.size();
    std::vector<uint32_t> global(vertices);
    for (const uint32_t t : triangles[c]) {
      for (const uint32_t v : cut.triangle[t]) global[local[v]] = v;
    }
    part = extend(std::move(part));
    for (size_t v = vertices; v < part.position.size(); ++v) {
      global.push_back(static_cast<uint32_t>(cut.position.size()));
      cut.position.push_back(part.position[v]);
      cut.point.push_back(part.point[v]);
      cut.clean_vertex.push_back(part.clean_vertex[v]);
    }
    for (size_t i = 0; i < triangles[c].size(); ++i) {
      for (size_t k = 0; k < 3; ++k) cut.triangle[triangles[c][i]][k] = global[part.triangle[i][k]];
    }
  }
  if (progress) progress("cut extension", 1);
  return cut;
}

}  // namespace geocloth
