// SPDX-License-Identifier: GPL-3.0-or-later
// The outlines of the disks as seams. Seams are found once, in the graph of the outline edges between surface points,
// and every run of an outline over a seam refers to it: so the two sides of a cut, a third sheet that repair tied to
// it, and the torn edge of a Moebius strip all agree about length, nodes and direction.
#include <algorithm>
#include <map>
#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/cut.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

struct PointEdge {
  uint32_t low, high;     // points
  uint32_t copies = 0;    // outline half-edges over it
  uint32_t seam = kNone;  // its seam, and whether the seam goes from low to high
  bool upward = true;
};

class SeamGraph {
 public:
  explicit SeamGraph(const CutSurface& cut) : cut_(cut), opposite_(opposite_half_edges(cut.triangle)) {
    collect_edges();
    collect_incidence();
    mark_nodes();
    number_seams();
  }

  [[nodiscard]] std::vector<Outline> trace() const {
    std::vector<Outline> outline(cut_.component_count);
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      const uint32_t component = cut_.component[h / 3];
      if (opposite_[h] != kNone || !outline[component].path.empty()) continue;
      if (node_[cut_.point[tail(cut_.triangle, h)]]) outline[component] = trace_from(h);
    }
    return outline;
  }

 private:
  [[nodiscard]] uint32_t point_at(uint32_t v) const { return cut_.point[v]; }

  void collect_edges() {
    leaving_.assign(cut_.position.size(), kNone);
    entering_.assign(cut_.position.size(), kNone);
    point_position_.assign(cut_.point_count, Point3{});
    std::vector<std::pair<uint64_t, uint32_t>> keyed;
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      if (opposite_[h] != kNone) continue;
      const uint32_t a = tail(cut_.triangle, h), b = head(cut_.triangle, h);
      leaving_[a] = h;
      entering_[b] = h;
      point_position_[point_at(a)] = cut_.position[a];
      const auto [low, high] = std::minmax({point_at(a), point_at(b)});
      keyed.emplace_back((uint64_t{low} << 32U) | high, h);
    }
    std::sort(keyed.begin(), keyed.end());
    edge_of_.assign(opposite_.size(), kNone);
    for (size_t i = 0; i < keyed.size(); ++i) {
      if (i == 0 || keyed[i].first != keyed[i - 1].first) {
        edge_.push_back({static_cast<uint32_t>(keyed[i].first >> 32U), static_cast<uint32_t>(keyed[i].first)});
      }
      ++edge_.back().copies;
      edge_of_[keyed[i].second] = static_cast<uint32_t>(edge_.size() - 1);
    }
  }

  void collect_incidence() {
    incident_.assign(cut_.point_count, {});
    for (uint32_t e = 0; e < edge_.size(); ++e) {
      incident_[edge_[e].low].push_back(e);
      incident_[edge_[e].high].push_back(e);
    }
  }

  void mark_nodes() {
    node_.assign(cut_.point_count, 0);
    for (uint32_t p = 0; p < cut_.point_count; ++p) {
      const auto& around = incident_[p];
      if (around.empty()) continue;
      if (around.size() != 2 || edge_[around[0]].copies != edge_[around[1]].copies) node_[p] = 1;
    }
    // Two outlines that both turn back at a point are two cut ends that touch, not a seam that passes.
    for (uint32_t v = 0; v < leaving_.size(); ++v) {
      if (leaving_[v] != kNone && edge_of_[leaving_[v]] == edge_of_[entering_[v]]) node_[point_at(v)] = 1;
    }
  }

  void number_seams() {
    for (uint32_t p = 0; p < cut_.point_count; ++p) {
      if (!node_[p]) continue;
      for (const uint32_t e : incident_[p]) walk_seam(p, e);
    }
    // What is left are closed curves without a node; the lowest point of each becomes one.
    for (uint32_t p = 0; p < cut_.point_count; ++p) {
      if (incident_[p].empty() || edge_[incident_[p][0]].seam != kNone) continue;
      node_[p] = 1;
      walk_seam(p, incident_[p][0]);
    }
  }

  void walk_seam(uint32_t from, uint32_t e) {
    if (edge_[e].seam != kNone) return;
    const auto seam = static_cast<uint32_t>(seam_length_.size());
    double total = 0;
    for (uint32_t p = from;;) {
      edge_[e].seam = seam;
      edge_[e].upward = edge_[e].low == p;
      total += distance(point_position_[edge_[e].low], point_position_[edge_[e].high]);
      p = edge_[e].upward ? edge_[e].high : edge_[e].low;
      if (node_[p]) break;
      e = incident_[p][0] == e ? incident_[p][1] : incident_[p][0];
    }
    seam_length_.push_back(total);
  }

  [[nodiscard]] Outline trace_from(uint32_t first) const {
    Outline outline;
    uint32_t h = first;
    do {
      const PointEdge& edge = edge_[edge_of_[h]];
      OutlinePath path;
      path.seam = edge.seam;
      path.reversed = edge.upward != (edge.low == point_at(tail(cut_.triangle, h)));
      path.length = seam_length_[edge.seam];
      path.vertex.push_back(tail(cut_.triangle, h));
      do {
        path.vertex.push_back(head(cut_.triangle, h));
        h = leaving_[path.vertex.back()];
      } while (!node_[point_at(path.vertex.back())]);
      outline.path.push_back(std::move(path));
    } while (h != first);
    return outline;
  }

  const CutSurface& cut_;
  std::vector<uint32_t> opposite_;
  std::vector<uint32_t> leaving_, entering_;  // per vertex: border half-edge
  std::vector<Point3> point_position_;
  std::vector<PointEdge> edge_;
  std::vector<uint32_t> edge_of_;                // per border half-edge
  std::vector<std::vector<uint32_t>> incident_;  // per point: edges, ascending
  std::vector<char> node_;                       // per point
  std::vector<double> seam_length_;
};

}  // namespace

std::vector<Outline> trace_outlines(const CutSurface& surface) {
  return SeamGraph(surface).trace();
}

}  // namespace geocloth
