// SPDX-License-Identifier: GPL-3.0-or-later
// Opens the clean surface along its cut graph (cut_graph.cpp): copies of a vertex are the runs of its triangle fan
// between cut edges. Every component that results is checked to be a disk.
#include "geocloth/parametrize/cut.h"

#include <algorithm>
#include <string>

#include "cut/cut_graph.h"
#include "cut/edge_wishes.h"
#include "cut/straight_cuts.h"
#include "geocloth/asset/error.h"
#include "mesh/half_edges.h"
#include "mesh/uneven.h"

namespace geocloth {
namespace {

/// A connected component with Euler characteristic 1 and a border has exactly one border loop, provided that no border
/// vertex is met twice.
void check_disks(const CutSurface& cut, const std::vector<uint32_t>& opposite) {
  std::vector<int64_t> euler(cut.component_count, 0);
  std::vector<char> has_border(cut.component_count, 0), border_start(cut.position.size(), 0);
  std::vector<uint32_t> component_of(cut.position.size(), kNone);
  const auto refuse = [](uint32_t component, const std::string& why) {
    throw Error(ErrorCode::verification,
                "component " + std::to_string(component) + " is no disk after cutting: " + why);
  };
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    const uint32_t component = cut.component[h / 3], v = tail(cut.triangle, h);
    if (component_of[v] == kNone) {
      component_of[v] = component;
      ++euler[component];
    }
    if (opposite[h] == kNone) {
      has_border[component] = 1;
      if (border_start[v]++ != 0) refuse(component, "its outline meets vertex " + std::to_string(v) + " twice");
    }
    if (opposite[h] == kNone || h < opposite[h]) --euler[component];
    if (h % 3 == 0) ++euler[component];
  }
  for (uint32_t i = 0; i < cut.component_count; ++i) {
    if (!has_border[i]) refuse(i, "it has no outline");
    if (euler[i] != 1) refuse(i, "its Euler characteristic is " + std::to_string(euler[i]));
  }
}

/// Where the vertices of the clean surface are, and those that straight cuts have put between them.
void put_back(const CleanSurface& surface, const Uneven& map, CutSurface& cut) {
  for (size_t v = 0; v < cut.position.size(); ++v) {
    const uint32_t clean = cut.clean_vertex[v];
    cut.position[v] = clean != kNone ? surface.position[clean] : map.undo(cut.position[v]);
  }
}

}  // namespace

CutSurface cut_to_disks(const CleanSurface& surface, const CutOptions& options, const Progress& progress) {
  if (progress) progress("cut", 0);
  const Uneven map = uneven(surface.position, surface.triangle);
  CleanSurface seen = surface;
  seen.position = map.apply(surface.position);
  CutGraph graph = find_cut_graph(seen, options, progress);
  RefinedMesh mesh = make_refined_mesh(seen, std::move(graph.opposite));
  CutLines lines{std::move(graph.cut), std::move(graph.fixed), std::move(graph.node)};
  hold_wished_cuts(mesh, options.prefer, lines);
  straighten_cuts(mesh, lines);
  CutSurface cut = open_along(mesh, lines.cut);
  put_back(surface, map, cut);
  check_disks(cut, opposite_half_edges(cut.triangle));
  if (progress) progress("cut", 1);
  return cut;
}

}  // namespace geocloth
