// SPDX-License-Identifier: GPL-3.0-or-later
// A button of 8 mm has no place on a grid of 10 mm: whatever its pixels were, they would be too small for the
// simulation's time step. So such a piece is no cloth of its own; it rides on the cloth beside it (bind_source), and
// the report says so. A buttonhole of 8 mm is no hole of the grid either: the grid is closed there.
#include "repair/small_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <utility>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "repair/border_loops.h"
#include "repair/narrow_pieces.h"

namespace geocloth {
namespace {

constexpr double kMostCarried = 0.01;  // share of the area
constexpr double kLongestHole = 3;     // [pixels] around it: less than a pixel's own outline

double area_of(const CleanSurface& surface, const Triangle& t) {
  return triangle_area(surface.position[t[0]], surface.position[t[1]], surface.position[t[2]]);
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

/// The part of the file that a triangle of it belongs to, by number.
uint32_t part_of(const TriangleMesh& mesh, uint32_t source_triangle) {
  for (uint32_t p = 0; p < mesh.part.size(); ++p) {
    const SourcePart& part = mesh.part[p];
    if (source_triangle >= part.first_triangle && source_triangle - part.first_triangle < part.triangle_count) return p;
  }
  return 0;
}

std::string of_part(const TriangleMesh& mesh, uint32_t part) {
  return part < mesh.part.size() && !mesh.part[part].name.empty() ? " of '" + mesh.part[part].name + "'" : "";
}

/// A component to leave out, and why.
struct LeftOut {
  uint32_t component;
  std::string why;
};

/// Those of an area below a pixel's, ascending by area. @param left  [m^2] that may be left out, less what this takes
std::vector<LeftOut> too_small(const std::vector<double>& area, double pixel, double& left) {
  std::vector<uint32_t> order(area.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return area[a] < area[b]; });
  std::vector<LeftOut> result;
  for (const uint32_t c : order) {
    if (result.size() + 1 == order.size() || area[c] >= pixel || area[c] > left) break;
    left -= area[c];
    result.push_back({c, "its area is " + rounded(area[c] / pixel) + " of a pixel's"});
  }
  return result;
}

/// Those that are too narrow for one, ascending by area, as far as there is room.
void add_narrow(const CleanSurface& clean, double spacing, double left, std::vector<LeftOut>& left_out) {
  std::vector<uint8_t> is_left_out(clean.component_count, 0);
  for (const LeftOut& l : left_out) is_left_out[l.component] = 1;
  std::vector<NarrowPieces> narrow = find_narrow_pieces(clean, spacing, left, is_left_out);
  std::stable_sort(narrow.begin(), narrow.end(),
                   [](const NarrowPieces& a, const NarrowPieces& b) { return a.area < b.area; });
  for (const NarrowPieces& pieces : narrow) {
    if (pieces.area > left) break;
    left -= pieces.area;
    for (const uint32_t c : pieces.component) {
      left_out.push_back(
          {c, "it is a strip " + rounded(pieces.width / spacing) + " of a pixel wide where it is widest"});
    }
  }
}

/// The surface without some components; points stay, vertices and components are numbered anew.
CleanSurface without(const CleanSurface& clean, const std::vector<LeftOut>& left_out) {
  std::vector<uint32_t> component(clean.component_count, 0), vertex(clean.position.size(), kNone);
  for (const LeftOut& l : left_out) component[l.component] = kNone;
  CleanSurface rest;
  rest.point_count = clean.point_count;
  rest.source_point = clean.source_point;
  for (uint32_t& c : component) {
    if (c != kNone) c = rest.component_count++;
  }
  for (size_t t = 0; t < clean.triangle.size(); ++t) {
    if (component[clean.component[t]] == kNone) continue;
    Triangle corners = clean.triangle[t];
    for (uint32_t& v : corners) {
      if (vertex[v] == kNone) {
        vertex[v] = static_cast<uint32_t>(rest.position.size());
        rest.position.push_back(clean.position[v]);
        rest.point.push_back(clean.point[v]);
      }
      v = vertex[v];
    }
    rest.triangle.push_back(corners);
    rest.component.push_back(component[clean.component[t]]);
    rest.source_triangle.push_back(clean.source_triangle[t]);
    if (!clean.uv.empty()) rest.uv.push_back(clean.uv[t]);
  }
  return rest;
}

void leave_out_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean, double spacing,
                            CarriedSurface& result) {
  std::vector<double> area(clean.component_count, 0);
  for (size_t t = 0; t < clean.triangle.size(); ++t) area[clean.component[t]] += area_of(clean, clean.triangle[t]);
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  double left = kMostCarried * total;
  std::vector<LeftOut> left_out = too_small(area, spacing * spacing, left);
  add_narrow(clean, spacing, left, left_out);
  if (left_out.empty()) return;

  std::vector<uint32_t> number(clean.component_count, kNone);
  for (LeftOut& l : left_out) {
    number[l.component] = static_cast<uint32_t>(result.carried.size());
    result.carried.push_back({0, 0, area[l.component] / total, std::move(l.why)});
  }
  for (size_t t = 0; t < clean.triangle.size(); ++t) {
    const uint32_t c = number[clean.component[t]];
    if (c == kNone) continue;
    CarriedPart& piece = result.carried[c];
    if (piece.faces++ == 0 && clean.source_triangle[t] != kNone) {
      piece.part = part_of(mesh, clean.source_triangle[t]);
      piece.why = "a piece" + of_part(mesh, piece.part) + ": " + piece.why;
    }
    for (const uint32_t v : clean.triangle[t]) result.piece_of_point[clean.point[v]] = c;
  }
  result.represented = without(clean, left_out);
  for (const uint32_t p : result.represented.point) result.piece_of_point[p] = kNone;
}

/// Whether no two vertices of a loop are as far apart as `extent`.
bool fits_into(const CleanSurface& surface, const std::vector<uint32_t>& loop, double extent) {
  const auto place = [&](uint32_t h) { return surface.position[tail(surface.triangle, h)]; };
  for (size_t i = 0; i < loop.size(); ++i) {
    for (size_t k = 0; k < i; ++k) {
      if (distance(place(loop[i]), place(loop[k])) >= extent) return false;
    }
  }
  return true;
}

void close_small_holes(const TriangleMesh& mesh, double spacing, CarriedSurface& result) {
  CleanSurface& surface = result.represented;
  double total = 0;
  for (const Triangle& t : surface.triangle) total += area_of(surface, t);
  double left = kMostCarried * total;
  for (const CarriedPart& piece : result.carried) left -= piece.area_share * total;
  std::vector<std::vector<uint32_t>> loops = border_loops(surface);
  std::stable_sort(loops.begin(), loops.end(),
                   [&](const auto& a, const auto& b) { return length_around(surface, a) < length_around(surface, b); });
  std::vector<uint32_t> loops_left(surface.component_count, 0);
  for (const auto& loop : loops) ++loops_left[surface.component[loop[0] / 3]];
  for (const std::vector<uint32_t>& loop : loops) {
    const uint32_t triangle = loop[0] / 3, component = surface.component[triangle];
    const double around = length_around(surface, loop);
    // The only opening of a piece is more than a hole: without it the piece is a closed bag.
    if (around >= kLongestHole * spacing || loops_left[component] < 2) continue;
    if (!fits_into(surface, loop, spacing)) continue;  // a slit
    const double area = fill_with_fan(surface, loop, left);
    if (area <= 0) continue;
    left -= area;
    --loops_left[component];
    const uint32_t source = surface.source_triangle[triangle];
    const uint32_t part = source == kNone ? 0 : part_of(mesh, source);
    result.carried.push_back({part, 0, area / total,
                              "a hole" + of_part(mesh, part) + " that is closed in the image: it is " +
                                  rounded(around / spacing) + " pixels around"});
  }
  result.piece_of_point.resize(surface.point_count, kNone);
}

}  // namespace

CarriedSurface carry_nothing(const CleanSurface& clean) {
  return {clean, {}, std::vector<uint32_t>(clean.point_count, kNone)};
}

CarriedSurface carry_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean, const FlattenOptions& options) {
  double total = 0;
  for (const Triangle& t : clean.triangle) total += area_of(clean, t);
  const double spacing = options.spacing > 0 ? options.spacing : std::sqrt(total) / options.resolution;

  CarriedSurface result;
  result.piece_of_point.assign(clean.point_count, kNone);
  leave_out_small_pieces(mesh, clean, spacing, result);
  if (result.carried.empty()) result.represented = clean;
  close_small_holes(mesh, spacing, result);
  return result;
}

}  // namespace geocloth
