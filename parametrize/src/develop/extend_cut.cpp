// SPDX-License-Identifier: GPL-3.0-or-later
// Gu, Gortler, Hoppe, Geometry Images, SIGGRAPH 2002, section 4: a tube whose end is closed shrinks to a point in a
// convex map; a cut to its tip lets it unfold. The tip is where a map to the circle stretches most. Each further cut is
// kept only if the stretch falls with it.
#include "develop/extend_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>

#include "cut/cut_graph.h"
#include "develop/disk_embedding.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/refined_mesh.h"

namespace geocloth {
namespace {

constexpr double kNotable = 0.95;  // a cut must lower the stretch to this share of it
constexpr double kStretched = 2;   // squared stretch from which a triangle belongs to a region that may need a cut
constexpr double kMatters = 0.1;   // a region's share of the greatest region's stretch that earns it a cut at once
constexpr double kWorst = 1e4;
constexpr int kMaxRounds = 10;
constexpr int kRelaxRounds = 30;

/// One component by itself.
CutSurface extract(const CutSurface& cut, const std::vector<uint32_t>& triangles, std::vector<uint32_t>& local) {
  CutSurface part;
  part.component_count = 1;
  part.component.assign(triangles.size(), 0);
  part.clean_triangle.resize(triangles.size());
  std::iota(part.clean_triangle.begin(), part.clean_triangle.end(), 0U);  // within the component
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
  double stretch = kInfinity;  // L2 of the improved map
  // Per triangle of the part: squared stretch of the map as it comes and of the improved one (relative to the scale at
  // which areas agree in total), and what the latter contributes to the whole.
  std::vector<double> first, improved, weight;
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
  const auto per_triangle = [&] {
    std::vector<double> stretch(part.triangle.size(), 0.0);
    const std::vector<double> refined = embedding.stretch_per_triangle(uv);
    for (size_t t = 0; t < refined.size(); ++t) {
      stretch[mesh.clean_triangle[t]] = std::max(stretch[mesh.clean_triangle[t]], refined[t]);
    }
    return stretch;
  };
  result.first = per_triangle();
  result.stretch = embedding.relax_stretch(uv, kRelaxRounds);
  result.improved = per_triangle();
  std::vector<double> area;
  for (const auto& [a, b, c] : part.triangle) {
    area.push_back(triangle_area(part.position[a], part.position[b], part.position[c]));
  }
  const double scale = std::numbers::pi / std::accumulate(area.begin(), area.end(), 0.0);
  for (size_t t = 0; t < area.size(); ++t) {
    result.improved[t] *= scale;
    result.weight.push_back(area[t] * std::min(result.improved[t], kWorst));
  }
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

/// The vertices to cut to. Triangles that the improved map still stretches form regions; each region that matters for
/// the whole gives the vertex that the first map stretches most, farthest from the outline.
std::vector<uint32_t> find_tips(const CutSurface& part, const std::vector<uint32_t>& opposite, const Judgement& now,
                                const WayOut& way) {
  const size_t count = part.triangle.size();
  struct Region {
    double weight = 0, most = 0;
    uint32_t tip = kNone;
  };
  std::vector<Region> region;
  std::vector<char> seen(count, 0);
  std::vector<uint32_t> stack;
  for (uint32_t seed = 0; seed < count; ++seed) {
    if (seen[seed] || now.improved[seed] < kStretched) continue;
    Region r;
    seen[seed] = 1;
    stack.push_back(seed);
    while (!stack.empty()) {
      const uint32_t t = stack.back();
      stack.pop_back();
      r.weight += now.weight[t];
      for (const uint32_t v : part.triangle[t]) {
        if (!(way.distance[v] > 0) || now.first[t] < r.most) continue;
        if (now.first[t] > r.most || way.distance[v] > way.distance[r.tip]) r.tip = v;
        r.most = now.first[t];
      }
      for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (opposite[h] == kNone || seen[opposite[h] / 3] || now.improved[opposite[h] / 3] < kStretched) continue;
        seen[opposite[h] / 3] = 1;
        stack.push_back(opposite[h] / 3);
      }
    }
    if (r.tip != kNone) region.push_back(r);
  }
  std::stable_sort(region.begin(), region.end(), [](const Region& a, const Region& b) { return a.weight > b.weight; });
  std::vector<uint32_t> tips;
  for (const Region& r : region) {
    if (tips.empty() || r.weight > kMatters * region.front().weight) tips.push_back(r.tip);
  }
  return tips;
}

/// The part with cuts from the tips to the outline; copies are appended, so that old vertices keep their numbers.
CutSurface cut_to(const CutSurface& part, const std::vector<uint32_t>& opposite, const WayOut& way,
                  const std::vector<uint32_t>& tips) {
  std::vector<char> cut(opposite.size(), 0);
  for (size_t h = 0; h < opposite.size(); ++h) cut[h] = opposite[h] == kNone ? 1 : 0;
  for (const uint32_t tip : tips) {
    for (uint32_t v = tip; way.distance[v] > 0; v = head(part.triangle, way.by[v])) {
      cut[way.by[v]] = cut[opposite[way.by[v]]] = 1;
    }
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

CutSurface extend(CutSurface part, double good_stretch) {
  Judgement now = judge(part);
  for (int round = 0; round < kMaxRounds && now.stretch > good_stretch; ++round) {
    const std::vector<uint32_t> opposite = opposite_half_edges(part.triangle);
    const WayOut way = ways_out(part, opposite);
    std::vector<uint32_t> tips = find_tips(part, opposite, now, way);
    if (tips.empty()) break;
    CutSurface longer = cut_to(part, opposite, way, tips);
    Judgement then = judge(longer);
    if (std::isfinite(now.stretch) && !(then.stretch < kNotable * now.stretch)) break;
    part = std::move(longer);
    now = std::move(then);
  }
  return part;
}

}  // namespace

CutSurface extend_cuts(CutSurface cut, const std::vector<double>& good_stretch, const Progress& progress) {
  std::vector<std::vector<uint32_t>> triangles(cut.component_count);
  for (uint32_t t = 0; t < cut.triangle.size(); ++t) triangles[cut.component[t]].push_back(t);
  std::vector<uint32_t> local(cut.position.size(), kNone);
  for (uint32_t c = 0; c < cut.component_count; ++c) {
    if (progress) progress("cut extension", static_cast<double>(c) / cut.component_count);
    CutSurface part = extract(cut, triangles[c], local);
    const size_t vertices = part.position.size();
    std::vector<uint32_t> global(vertices);
    for (const uint32_t t : triangles[c]) {
      for (const uint32_t v : cut.triangle[t]) global[local[v]] = v;
    }
    part = extend(std::move(part), good_stretch[c]);
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
