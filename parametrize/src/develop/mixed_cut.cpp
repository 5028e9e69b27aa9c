// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of a surface are cut independently of each other, so the parts of one cut surface fit beside those of another.
// What cuts have inserted into them gets points of its own.
#include "develop/mixed_cut.h"

#include <algorithm>
#include <map>

namespace geocloth {
namespace {

/// Appends the triangles of one chart; vertices that came with an earlier chart are used again.
class CutMixer {
 public:
  explicit CutMixer(std::span<const CutSurface> cuts) : cuts_(cuts) {
    // Not only what the cuts use: points of pieces that the image leaves out have numbers, too.
    result_.point_count = std::min_element(cuts.begin(), cuts.end(), [](const CutSurface& a, const CutSurface& b) {
                            return a.point_count < b.point_count;
                          })->point_count;
    for (const CutSurface& cut : cuts) {
      vertex_.emplace_back(cut.position.size(), kNone);
      point_.emplace_back(cut.point_count, kNone);
      for (size_t v = 0; v < cut.position.size(); ++v) {
        if (cut.clean_vertex[v] == kNone) continue;
        // Points of the surface itself keep their numbers, which are below all inserted ones.
        point_.back()[cut.point[v]] = cut.point[v];
      }
    }
  }

  void add(const CutSurface& cut, size_t which, Chart& chart) {
    for (uint32_t& t : chart.global_triangle) {
      const Triangle& k = cut.triangle[t];
      const auto number = static_cast<uint32_t>(result_.triangle.size());
      result_.triangle.push_back({vertex(which, k[0]), vertex(which, k[1]), vertex(which, k[2])});
      result_.clean_triangle.push_back(cut.clean_triangle[t]);
      result_.hole.push_back(cut.hole.empty() ? kNone : cut.hole[t]);
      const auto fresh = static_cast<uint32_t>(component_.size());
      result_.component.push_back(component_.try_emplace({which, cut.component[t]}, fresh).first->second);
      t = number;
    }
    for (uint32_t& v : chart.cut_vertex) v = vertex(which, v);
  }

  CutSurface finish() {
    result_.component_count = static_cast<uint32_t>(component_.size());
    const bool all_cloth = std::all_of(result_.hole.begin(), result_.hole.end(), [](uint32_t h) { return h == kNone; });
    if (all_cloth) result_.hole.clear();
    return std::move(result_);
  }

 private:
  uint32_t vertex(size_t which, uint32_t v) {
    uint32_t& number = vertex_[which][v];
    if (number != kNone) return number;
    const CutSurface& cut = cuts_[which];
    number = static_cast<uint32_t>(result_.position.size());
    result_.position.push_back(cut.position[v]);
    uint32_t& point = point_[which][cut.point[v]];
    if (point == kNone) point = result_.point_count++;
    result_.point.push_back(point);
    result_.clean_vertex.push_back(cut.clean_vertex[v]);
    return number;
  }

  std::span<const CutSurface> cuts_;
  CutSurface result_;
  std::vector<std::vector<uint32_t>> vertex_, point_;          // per cut: its numbers to those of the result
  std::map<std::pair<size_t, uint32_t>, uint32_t> component_;  // the same, by cut and number there
};

}  // namespace

CutSurface put_together(std::span<const CutSurface> cuts, std::span<const size_t> choice, std::span<Chart> charts) {
  size_t triangles = 0;
  for (const Chart& c : charts) triangles += c.triangle.size();
  const bool one = triangles == cuts[choice.front()].triangle.size() &&
                   std::all_of(choice.begin(), choice.end(), [&](size_t c) { return c == choice.front(); });
  if (one) return cuts[choice.front()];
  CutMixer mixer(cuts);
  for (size_t i = 0; i < charts.size(); ++i) mixer.add(cuts[choice[i]], choice[i], charts[i]);
  return mixer.finish();
}

}  // namespace geocloth
