// SPDX-License-Identifier: GPL-3.0-or-later
// A hole that is filled costs no cut, but a cut may come to run through it, or there may be no pixels between it and
// the outline. Then it is opened as other borders are, in the plane, and nothing has to be laid out again: without what
// fills it a disk is still one, or several.
#include "develop/met_holes.h"

#include <algorithm>
#include <utility>

#include "cut/cut_graph.h"
#include "develop/chart_energy.h"
#include "mesh/half_edges.h"

namespace geocloth {
namespace {

/// The holes whose filling has a vertex on the outline, ascending.
std::vector<uint32_t> met_holes(const Chart& chart) {
  const std::vector<uint8_t> outline = on_outline(chart);
  std::vector<uint32_t> met;
  for (size_t t = 0; t < chart.triangle.size(); ++t) {
    const Triangle& k = chart.triangle[t];
    if (chart.is_cloth(t) || std::none_of(k.begin(), k.end(), [&](uint32_t v) { return outline[v] != 0; })) continue;
    met.push_back(chart.hole[t]);
  }
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  return met;
}

/// The pieces of a chart that are left without some fillings. Where an outline would meet a vertex twice there are two.
std::vector<Chart> without(const Chart& chart, const std::vector<uint32_t>& holes) {
  Chart rest;
  rest.position = chart.position;
  rest.cut_vertex = chart.cut_vertex;
  rest.uv = chart.uv;
  for (size_t t = 0; t < chart.triangle.size(); ++t) {
    if (std::binary_search(holes.begin(), holes.end(), chart.hole[t])) continue;
    rest.triangle.push_back(chart.triangle[t]);
    rest.global_triangle.push_back(chart.global_triangle[t]);
    rest.hole.push_back(chart.hole[t]);
  }
  rest.opposite = opposite_half_edges(rest.triangle);
  return separated(opened(rest, std::vector<uint32_t>{}));
}

/// Until no outline meets a filling: without one the outline may meet another.
void take_out_met(Chart chart, std::vector<Chart>& done) {
  const std::vector<uint32_t> met = met_holes(chart);
  if (met.empty()) {
    done.push_back(std::move(chart));
    return;
  }
  for (Chart& piece : without(chart, met)) take_out_met(std::move(piece), done);
}

/// A chart cut open from a hole in it to the outline; as it is where the outline meets the hole.
Chart reached(const Chart& chart, uint32_t hole) {
  const std::vector<uint8_t> outline = on_outline(chart);
  const Distances way_out = distances(chart, outline_loop(chart), outline);
  uint32_t nearest = kNone;
  for (size_t t = 0; t < chart.triangle.size(); ++t) {
    if (chart.is_cloth(t) || chart.hole[t] != hole) continue;
    for (const uint32_t v : chart.triangle[t]) {
      if (nearest == kNone || way_out.value[v] < way_out.value[nearest]) nearest = v;
    }
  }
  if (nearest == kNone || outline[nearest] != 0 || way_out.from[nearest] == kNone) return chart;
  return opened(chart, way_out.path_from(nearest));
}

}  // namespace

bool open_met_holes(std::vector<Chart>& charts) {
  const size_t before = charts.size();
  std::vector<Chart> done;
  bool any = false;
  for (size_t i = 0; i < before; ++i) {
    if (charts[i].hole.empty()) {
      done.push_back(std::move(charts[i]));
      continue;
    }
    const size_t triangles = charts[i].triangle.size(), first = done.size();
    take_out_met(std::move(charts[i]), done);
    any = any || done.size() != first + 1 || done.back().triangle.size() != triangles;
  }
  charts = std::move(done);
  return any;
}

DevelopedSurface with_holes_cut_open(const DevelopedSurface& developed, std::span<const uint32_t> hole) {
  std::vector<Chart> charts = charts_of(developed);
  for (Chart& chart : charts) {
    std::vector<uint32_t> within;
    for (const uint32_t h : chart.hole) {
      if (std::binary_search(hole.begin(), hole.end(), h)) within.push_back(h);
    }
    std::sort(within.begin(), within.end());
    within.erase(std::unique(within.begin(), within.end()), within.end());
    for (const uint32_t h : within) chart = reached(chart, h);
  }
  open_met_holes(charts);
  return assembled(developed.cut, charts);
}

std::vector<Chart> charts_of(const DevelopedSurface& developed) {
  std::vector<Chart> charts;
  for (std::vector<uint32_t>& triangles : triangles_of_components(developed.cut)) {
    Chart& chart = charts.emplace_back(extract_chart(developed.cut, std::move(triangles)));
    for (const uint32_t v : chart.cut_vertex) chart.uv.push_back(developed.uv[v]);
  }
  return charts;
}

DevelopedSurface assembled(const CutSurface& cut, const std::vector<Chart>& charts) {
  DevelopedSurface result;
  CutSurface& out = result.cut;
  std::vector<uint32_t> number(cut.triangle.size(), kNone);
  for (const Chart& chart : charts) {
    for (const uint32_t t : chart.global_triangle) number[t] = 0;
  }
  uint32_t count = 0;
  for (uint32_t t = 0; t < number.size(); ++t) {
    if (number[t] == kNone) continue;
    number[t] = count++;
    out.clean_triangle.push_back(cut.clean_triangle[t]);
    if (!cut.hole.empty()) out.hole.push_back(cut.hole[t]);
  }
  out.triangle.resize(count);
  out.component.resize(count);
  out.point_count = cut.point_count;
  for (const Chart& chart : charts) {
    const auto first = static_cast<uint32_t>(out.position.size());
    for (size_t v = 0; v < chart.position.size(); ++v) {
      out.position.push_back(chart.position[v]);
      out.point.push_back(cut.point[chart.cut_vertex[v]]);
      out.clean_vertex.push_back(cut.clean_vertex[chart.cut_vertex[v]]);
      result.uv.push_back(chart.uv[v]);
    }
    for (size_t t = 0; t < chart.triangle.size(); ++t) {
      const Triangle& k = chart.triangle[t];
      out.triangle[number[chart.global_triangle[t]]] = {first + k[0], first + k[1], first + k[2]};
      out.component[number[chart.global_triangle[t]]] = out.component_count;
    }
    ++out.component_count;
    result.energy.push_back(chart_energy(chart).energy(chart.uv));
  }
  return result;
}

}  // namespace geocloth
