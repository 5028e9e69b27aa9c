// SPDX-License-Identifier: GPL-3.0-or-later
// A button of 8 mm has no place on a grid of 10 mm: whatever its pixels were, they would be too small for the
// simulation's time step. So such a piece is no cloth of its own; it rides on the cloth beside it (bind_source), and
// the report says so. A buttonhole of 8 mm is no hole of the grid either: the grid is closed there.
//
// A button of 20 mm has its pixels, but is sewn to nothing in a mesh: as a cloth it would stay where it is while the
// shirt moves away. So what is small beside the garment and lies on it all over rides on it too, whatever the pixels.
#include "repair/small_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/triangle_tree.h"
#include "repair/border_loops.h"
#include "repair/narrow_pieces.h"
#include "repair/part_words.h"
#include "repair/sewn_groups.h"

namespace geocloth {
namespace {

constexpr double kMostCarried = 0.01;       // share of the area
constexpr double kLongestHole = 3;          // [pixels] around it: less than a pixel's own outline
constexpr double kBall = std::numbers::pi;  // [pixels] area of a ball as wide as one

// Loose pieces that are small beside the garment:
constexpr double kSmallAcross = 0.05;  // share of the garment's diagonal
constexpr double kFewPixels = 3;       // or as far across in pixels
constexpr double kSmallArea = 0.01;    // share of the area
constexpr double kMostSmall = 0.25;    // share of the area that they are together: more is no trimming
constexpr double kOffBySize = 2;       // how far they are off the cloth at most, in their own diagonals
constexpr double kOff = 0.03;          // and as a share of the garment's

constexpr double kMuchSmaller = 0.02;  // share of the largest piece's area that is no garment beside it
constexpr double kLong = 0.25;         // share of the diagonal: no small piece, however narrow

double area_of(const CleanSurface& surface, const Triangle& t) {
  return triangle_area(surface.position[t[0]], surface.position[t[1]], surface.position[t[2]]);
}

std::vector<double> component_areas(const CleanSurface& clean) {
  std::vector<double> area(clean.component_count, 0);
  for (size_t t = 0; t < clean.triangle.size(); ++t) area[clean.component[t]] += area_of(clean, clean.triangle[t]);
  return area;
}

/// The part of the file that a triangle of it belongs to, by number.
uint32_t part_of(const TriangleMesh& mesh, uint32_t source_triangle) {
  for (uint32_t p = 0; p < mesh.part.size(); ++p) {
    const SourcePart& part = mesh.part[p];
    if (source_triangle >= part.first_triangle && source_triangle - part.first_triangle < part.triangle_count) return p;
  }
  return 0;
}

/// Components to leave out as one piece, and why.
struct LeftOut {
  std::vector<uint32_t> component;
  std::string why;
  bool is_asked = false;  ///< CarriedPart::is_asked
};

/// Components that are sewn together, as one.
struct LoosePiece {
  std::vector<uint32_t> component;
  double area = 0;
  Point3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
};

/// What of a surface is a garment, and what is loose and small beside it.
struct LoosePieces {
  std::vector<LoosePiece> small;
  std::vector<uint8_t> is_small;  ///< per component
  bool have_garment = false;      ///< most of the surface is not small
  double diagonal = 0;            ///< [m] of the whole
};

std::vector<LoosePiece> loose_pieces(const CleanSurface& clean, const std::vector<double>& area) {
  std::vector<LoosePiece> piece(clean.component_count);
  const SewnGroups sewn(clean);
  for (uint32_t c = 0; c < clean.component_count; ++c) {
    piece[sewn.group(c)].component.push_back(c);
    piece[sewn.group(c)].area += area[c];
  }
  for (size_t t = 0; t < clean.triangle.size(); ++t) {
    LoosePiece& of = piece[sewn.group(clean.component[t])];
    for (const uint32_t v : clean.triangle[t]) {
      for (size_t k = 0; k < 3; ++k) {
        of.low[k] = std::min(of.low[k], clean.position[v][k]);
        of.high[k] = std::max(of.high[k], clean.position[v][k]);
      }
    }
  }
  std::erase_if(piece, [](const LoosePiece& p) { return p.component.empty(); });
  return piece;
}

LoosePieces find_small_ones(const CleanSurface& clean, const std::vector<double>& area, double spacing) {
  LoosePieces result{{}, std::vector<uint8_t>(clean.component_count, 0), false, bounding_diagonal(clean.position)};
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  const double across = std::max(kSmallAcross * result.diagonal, kFewPixels * spacing);
  double small = 0;
  for (LoosePiece& p : loose_pieces(clean, area)) {
    if (distance(p.low, p.high) > across || p.area > kSmallArea * total) continue;
    for (const uint32_t c : p.component) result.is_small[c] = 1;
    small += p.area;
    result.small.push_back(std::move(p));
  }
  result.have_garment = small <= kMostSmall * total;
  return result;
}

std::vector<uint32_t> component_triangles(const CleanSurface& clean) {
  std::vector<uint32_t> triangles(clean.component_count, 0);
  for (const uint32_t c : clean.component) ++triangles[c];
  return triangles;
}

/// What pieces of one kind have in common, such as sequins or the teeth of a zipper.
struct PieceKind {
  double area = 0;
  uint32_t triangles = 0;
};

bool is_same_kind(const PieceKind& a, const PieceKind& b) {
  constexpr double kRounding = 1e-3;  // of coordinates as texts have them
  return a.triangles == b.triangles && std::abs(a.area - b.area) <= kRounding * a.area;
}

/// Pieces by area, in groups of one kind.
std::vector<std::vector<uint32_t>> by_kind(const std::vector<PieceKind>& piece) {
  std::vector<uint32_t> order(piece.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return piece[a].area < piece[b].area; });
  std::vector<std::vector<uint32_t>> groups;
  for (const uint32_t p : order) {
    if (groups.empty() || !is_same_kind(piece[groups.back()[0]], piece[p])) groups.emplace_back();
    groups.back().push_back(p);
  }
  return groups;
}

std::vector<std::vector<uint32_t>> components_by_kind(const CleanSurface& clean, const std::vector<double>& area) {
  const std::vector<uint32_t> triangles = component_triangles(clean);
  std::vector<PieceKind> kind;
  for (size_t c = 0; c < area.size(); ++c) kind.push_back({area[c], triangles[c]});
  return by_kind(kind);
}

/// [pixels] Per component, the area below which it has no place on the grid. What is closed, such as a button, needs
/// more: pressed flat it would be two triangles back to back, whose normals cancel.
std::vector<double> least_areas(const CleanSurface& clean) {
  std::vector<double> least(clean.component_count, kBall);
  const std::vector<uint32_t> opposite = opposite_half_edges(clean.triangle);
  for (size_t h = 0; h < opposite.size(); ++h)
    if (opposite[h] == kNone) least[clean.component[h / 3]] = 1;
  return least;
}

/// Those that are smaller than a pixel, ascending by area. Of equal sequins all are left out or none: beside a garment
/// loose ones are, also beyond what may be left out usually.
/// @param left  [m^2] that may be left out, less what this takes
std::vector<LeftOut> too_small(const CleanSurface& clean, const std::vector<double>& area, const LoosePieces& loose,
                               double pixel, double& left) {
  const std::vector<double> least = least_areas(clean);
  const auto rides_anyhow = [&](uint32_t c) { return loose.have_garment && loose.is_small[c] != 0; };
  std::vector<LeftOut> result;
  for (std::vector<uint32_t>& group : components_by_kind(clean, area)) {
    std::erase_if(group, [&](uint32_t c) { return area[c] >= least[c] * pixel; });
    double asked = 0;
    for (const uint32_t c : group) asked += rides_anyhow(c) ? 0 : area[c];
    const bool all_fit = asked <= left;
    for (const uint32_t c : group) {
      if (result.size() + 1 == area.size()) return result;
      if (!all_fit && !rides_anyhow(c)) continue;
      left -= area[c];
      const char* shape = least[c] > 1 ? "it is closed, and its area is " : "its area is ";
      result.push_back({{c}, shape + rounded(area[c] / pixel) + " of a pixel's"});
    }
  }
  return result;
}

std::vector<std::vector<uint32_t>> narrow_by_kind(const CleanSurface& clean, const std::vector<NarrowPieces>& narrow) {
  const std::vector<uint32_t> triangles = component_triangles(clean);
  std::vector<PieceKind> kind;
  for (const NarrowPieces& pieces : narrow) {
    kind.push_back({pieces.area, 0});
    for (const uint32_t c : pieces.component) kind.back().triangles += triangles[c];
  }
  return by_kind(kind);
}

/// Those that are too narrow for one, ascending by area, as far as there is room for all of a kind.
void add_narrow(const CleanSurface& clean, double spacing, double left, std::vector<LeftOut>& left_out) {
  std::vector<uint8_t> is_left_out(clean.component_count, 0);
  for (const LeftOut& l : left_out) is_left_out[l.component[0]] = 1;
  const std::vector<NarrowPieces> narrow = find_narrow_pieces(clean, spacing, left, is_left_out);
  for (const std::vector<uint32_t>& group : narrow_by_kind(clean, narrow)) {
    double area = 0;
    for (const uint32_t i : group) area += narrow[i].area;
    if (area > left) continue;
    left -= area;
    for (const uint32_t i : group) {
      for (const uint32_t c : narrow[i].component) {
        left_out.push_back(
            {{c}, "it is a strip " + rounded(narrow[i].width / spacing) + " of a pixel wide where it is widest"});
      }
    }
  }
}

/// Those that lie on the garment all over.
std::vector<LoosePiece> find_riding(const CleanSurface& clean, const LoosePieces& loose,
                                    const std::vector<LeftOut>& left_out) {
  std::vector<uint8_t> is_left_out(clean.component_count, 0);
  for (const LeftOut& l : left_out) is_left_out[l.component[0]] = 1;
  const auto is_gone = [&](uint32_t c) { return is_left_out[c] != 0; };
  std::vector<LoosePiece> small = loose.small;
  for (LoosePiece& p : small) std::erase_if(p.component, is_gone);
  std::erase_if(small, [](const LoosePiece& p) { return p.component.empty(); });
  if (!loose.have_garment || small.empty()) return {};
  std::vector<Triangle> garment;
  std::vector<std::vector<uint32_t>> vertices(clean.component_count);
  for (size_t t = 0; t < clean.triangle.size(); ++t) {
    const uint32_t c = clean.component[t];
    if (is_gone(c)) continue;
    if (loose.is_small[c] == 0) {
      garment.push_back(clean.triangle[t]);
    } else {
      for (const uint32_t v : clean.triangle[t]) vertices[c].push_back(v);
    }
  }
  if (garment.empty()) return {};
  const TriangleTree tree(clean.position, garment);
  std::optional<TriangleTree::Place> found;
  const auto is_off_cloth = [&](const LoosePiece& p) {
    const double across = distance(p.low, p.high), most_off = std::min(kOffBySize * across, kOff * loose.diagonal);
    return !std::all_of(p.component.begin(), p.component.end(), [&](uint32_t c) {
      return std::all_of(vertices[c].begin(), vertices[c].end(), [&](uint32_t v) {
        found = tree.nearest(clean.position[v], found);
        return distance(found->point, clean.position[v]) <= most_off;
      });
    });
  };
  std::erase_if(small, is_off_cloth);
  return small;
}

void add_riding(const CleanSurface& clean, const LoosePieces& loose, std::vector<LeftOut>& left_out) {
  for (LoosePiece& p : find_riding(clean, loose, left_out)) {
    const double across = distance(p.low, p.high);
    left_out.push_back({std::move(p.component),
                        "it is attached to nothing, lies on other cloth and is " +
                            rounded(100 * across / loose.diagonal) + " % of the garment across",
                        true});
  }
}

/// The surface without some components; points stay, vertices and components are numbered anew.
CleanSurface without(const CleanSurface& clean, const std::vector<LeftOut>& left_out) {
  std::vector<uint32_t> component(clean.component_count, 0), vertex(clean.position.size(), kNone);
  for (const LeftOut& l : left_out) {
    for (const uint32_t c : l.component) component[c] = kNone;
  }
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

void leave_out_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean, double spacing, bool carry_loose,
                            CarriedSurface& result) {
  const std::vector<double> area = component_areas(clean);
  const double total = std::accumulate(area.begin(), area.end(), 0.0);
  double left = kMostCarried * total;
  const LoosePieces loose = carry_loose ? find_small_ones(clean, area, spacing)
                                        : LoosePieces{{}, std::vector<uint8_t>(clean.component_count, 0), false, 0};
  std::vector<LeftOut> left_out = too_small(clean, area, loose, spacing * spacing, left);
  add_narrow(clean, spacing, left, left_out);
  result.too_small = left_out.size();
  add_riding(clean, loose, left_out);
  if (left_out.empty()) return;

  std::vector<uint32_t> number(clean.component_count, kNone);
  for (LeftOut& l : left_out) {
    double share = 0;
    for (const uint32_t c : l.component) {
      number[c] = static_cast<uint32_t>(result.carried.size());
      share += area[c] / total;
    }
    result.carried.push_back({0, 0, share, std::move(l.why), false, l.is_asked});
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
  for (size_t i = 0; i < result.too_small; ++i) left -= result.carried[i].area_share * total;
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

LoosePiecesLeft find_loose_pieces(const CleanSurface& clean, double spacing) {
  LoosePiecesLeft result;
  const std::vector<double> area = component_areas(clean);
  const std::vector<LoosePiece> piece = loose_pieces(clean, area);
  double largest = 0;
  for (const LoosePiece& p : piece) largest = std::max(largest, p.area);
  std::vector<uint8_t> would_ride(clean.component_count, 0);
  if (spacing > 0) {
    const LoosePieces loose = find_small_ones(clean, area, spacing);
    double none_left = 0;
    std::vector<LeftOut> left_out = too_small(clean, area, loose, spacing * spacing, none_left);
    add_riding(clean, loose, left_out);
    for (const LeftOut& l : left_out) {
      for (const uint32_t c : l.component) would_ride[c] = 1;
    }
  }
  for (const LoosePiece& p : piece) {
    if (p.area > kMuchSmaller * largest) continue;
    ++result.count;
    result.across = std::max(result.across, distance(p.low, p.high));
    const auto rides = [&](uint32_t c) { return would_ride[c] != 0; };
    if (std::all_of(p.component.begin(), p.component.end(), rides)) ++result.would_ride;
  }
  result.are_small = result.across <= kLong * bounding_diagonal(clean.position);
  return result;
}

CarriedSurface carry_nothing(const CleanSurface& clean) {
  return {clean, {}, 0, std::vector<uint32_t>(clean.point_count, kNone), 0};
}

CarriedSurface carry_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean, const FlattenOptions& options,
                                  bool carry_loose) {
  double total = 0;
  for (const Triangle& t : clean.triangle) total += area_of(clean, t);
  const double spacing = options.spacing > 0 ? options.spacing : std::sqrt(total) / options.resolution;

  CarriedSurface result;
  result.spacing = spacing;
  result.piece_of_point.assign(clean.point_count, kNone);
  leave_out_small_pieces(mesh, clean, spacing, carry_loose, result);
  if (result.carried.empty()) result.represented = clean;
  close_small_holes(mesh, spacing, result);
  return result;
}

}  // namespace geocloth
