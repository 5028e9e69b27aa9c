// SPDX-License-Identifier: GPL-3.0-or-later
//
// OptCuts (Li et al. 2018) goes both ways: it extends cuts at their tips and sews them there. Here cuts are extended
// first (chart_developer.h), each to a whole path; this is the way back, in small steps: of all tips the one that
// brings most is sewn by a step. What a step brought when it was last tried is believed until that makes it the best
// one, since a step elsewhere changes that little.
#include "develop/close_slits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <tbb/parallel_for.h>

#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/layout_cost.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSewnAtOnce = 0.04;  // [sqrt(area)] sewn at once
constexpr double kWorthWhile = 1e-3;  // of the cost, by a step
constexpr size_t kLeastLoop = 12;     // vertices of an outline that stays
constexpr uint32_t kSettle = 3;       // Newton steps after every edge
constexpr uint32_t kTrySteps = 10, kSewnSteps = 30;
constexpr size_t kMostTrialWork = 4'000'000;  // triangles relaxed in trials

LayoutCost cost_of(const Chart& chart) {
  LayoutCost cost;
  cost.add(chart, smooth_outline_length(chart));
  return cost;
}

double minimise(Chart& chart, uint32_t steps, double tolerance) {
  return chart_energy(chart).minimise(chart.uv, steps, tolerance);
}

/// Two vertices become one, the first, at a place in the plane.
void merge_vertices(Chart& chart, uint32_t kept, uint32_t gone, const Point2& place) {
  const auto last = static_cast<uint32_t>(chart.position.size() - 1);
  chart.uv[kept] = place;
  for (Triangle& t : chart.triangle) {
    for (uint32_t& v : t) {
      if (v == gone) v = kept;
    }
  }
  if (gone != last) {
    chart.position[gone] = chart.position[last];
    chart.cut_vertex[gone] = chart.cut_vertex[last];
    chart.uv[gone] = chart.uv[last];
    for (Triangle& t : chart.triangle) {
      for (uint32_t& v : t) {
        if (v == last) v = gone;
      }
    }
  }
  chart.position.pop_back();
  chart.cut_vertex.pop_back();
  chart.uv.pop_back();
}

class SlitCloser {
 public:
  SlitCloser(std::vector<Chart>& charts, const Sheet& sheet, const DevelopOptions& options)
      : charts_(charts), sheet_(sheet), options_(options) {
    for (const Chart& c : charts) {
      cost_.push_back(cost_of(c));
      area_ += cost_.back().area;
    }
  }

  void close_all() {
    for (;;) {
      std::vector<Trial> trials = all_tips();
      try_where(trials, [](const Trial& t) { return !t.known; });
      Trial* best = nullptr;
      while (!trials.empty()) {
        best = &*std::min_element(trials.begin(), trials.end(),
                                  [](const Trial& a, const Trial& b) { return a.change < b.change; });
        if (best->change > -kWorthWhile || !best->charts.empty()) break;
        try_out(*best);
      }
      for (const Trial& t : trials) change_[t.tip.front()] = t.change;
      if (best == nullptr || best->change > -kWorthWhile || work_ > kMostTrialWork) break;
      for (size_t i = 0; i < best->of.size(); ++i) {
        charts_[best->of[i]] = std::move(best->charts[i]);
        cost_[best->of[i]] = cost_of(charts_[best->of[i]]);
      }
      sewn_any_ = true;
    }
    if (!sewn_any_) return;
    tbb::parallel_for(size_t{0}, charts_.size(), [&](size_t i) {
      Chart settled = charts_[i];
      minimise(settled, kSewnSteps, 1e-6);
      if (!crossing_edges(settled, outline_loop(settled))) charts_[i] = std::move(settled);
    });
  }

 private:
  /// The ends of one slit, or of two that are each other's mirror images, sewn by a step.
  struct Trial {
    std::vector<uint32_t> tip;  // sheet vertices
    std::vector<size_t> of;     // charts
    bool known = false;         // from a round before
    double change = kInfinity;  // of the cost
    std::vector<Chart> charts;  // empty until it is tried
  };

  [[nodiscard]] uint32_t sheet_vertex(const Chart& c, uint32_t v) const { return sheet_.of_vertex[c.cut_vertex[v]]; }

  /// May the outline's two edges at a place be sewn together?
  [[nodiscard]] bool is_tip(const Chart& c, const std::vector<uint32_t>& loop, size_t place) const {
    const size_t n = loop.size();
    const uint32_t before = loop[(place + n - 1) % n], after = loop[(place + 1) % n];
    return n > kLeastLoop && before != after && sheet_vertex(c, before) == sheet_vertex(c, after) &&
           sheet_.tied[sheet_vertex(c, loop[place])] == 0;
  }

  [[nodiscard]] std::vector<Trial> all_tips() const {
    std::vector<Trial> result;
    std::vector<Point3> place;
    for (size_t k = 0; k < charts_.size(); ++k) {
      const std::vector<uint32_t> loop = outline_loop(charts_[k]);
      for (size_t i = 0; i < loop.size(); ++i) {
        if (!is_tip(charts_[k], loop, i)) continue;
        Trial t;
        t.tip = {sheet_vertex(charts_[k], loop[i])};
        t.of = {k};
        result.push_back(std::move(t));
        place.push_back(charts_[k].position[loop[i]]);
      }
    }
    if (options_.prefer.mirror) pair_up(result, place);
    for (Trial& t : result) {
      const auto known = change_.find(t.tip.front());
      t.known = known != change_.end();
      if (t.known) t.change = known->second;
    }
    return result;
  }

  /// What the left side of a garment needs the right side needs too.
  void pair_up(std::vector<Trial>& trials, const std::vector<Point3>& place) const {
    const MirrorPlane& mirror = *options_.prefer.mirror;
    const double near = kSewnAtOnce * std::sqrt(area_);
    std::vector<char> gone(trials.size(), 0);
    for (size_t i = 0; i < trials.size(); ++i) {
      if (gone[i] != 0 || std::abs(mirror.height(place[i])) < near) continue;
      size_t other = i;
      for (size_t k = i + 1; k < trials.size(); ++k) {
        const double off = distance(mirror.image(place[i]), place[k]);
        if (gone[k] == 0 && off < near && (other == i || off < distance(mirror.image(place[i]), place[other]))) {
          other = k;
        }
      }
      if (other == i) continue;
      gone[other] = 1;
      trials[i].tip.push_back(trials[other].tip.front());
      if (trials[other].of.front() != trials[i].of.front()) trials[i].of.push_back(trials[other].of.front());
    }
    for (size_t i = trials.size(); i-- > 0;) {
      if (gone[i] != 0) trials.erase(trials.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  template <class Wanted>
  void try_where(std::vector<Trial>& trials, const Wanted& wanted) {
    std::vector<size_t> chosen;
    for (size_t i = 0; i < trials.size(); ++i) {
      if (wanted(trials[i])) chosen.push_back(i);
    }
    for (const size_t i : chosen) work_ += work_of(trials[i]);
    tbb::parallel_for(size_t{0}, chosen.size(), [&](size_t i) { carry_out(trials[chosen[i]]); });
  }

  void try_out(Trial& trial) {
    work_ += work_of(trial);
    carry_out(trial);
  }

  [[nodiscard]] size_t work_of(const Trial& trial) const {
    size_t sum = 0;
    for (const size_t k : trial.of) sum += charts_[k].triangle.size() * kTrySteps;
    return sum;
  }

  void carry_out(Trial& trial) const {
    trial.change = kInfinity;
    trial.charts.clear();
    std::vector<Chart> sewn;
    for (const size_t k : trial.of) {
      Chart chart = charts_[k];
      bool any = false;
      for (const uint32_t tip : trial.tip) any = sew(chart, tip) || any;
      if (!any) return;
      minimise(chart, kTrySteps, 5e-5);
      if (crossing_edges(chart, outline_loop(chart))) return;
      sewn.push_back(std::move(chart));
    }
    trial.change = value_with(trial.of, sewn) - value_with({}, {});
    trial.charts = std::move(sewn);
  }

  [[nodiscard]] double value_with(const std::vector<size_t>& of, const std::vector<Chart>& sewn) const {
    LayoutCost sum;
    for (size_t k = 0; k < charts_.size(); ++k) {
      const auto at = std::find(of.begin(), of.end(), k);
      const LayoutCost own = at == of.end() ? cost_[k] : cost_of(sewn[static_cast<size_t>(at - of.begin())]);
      sum.area += own.area;
      sum.outline += own.outline;
      sum.energy += own.energy;
      sum.strained += own.strained;
    }
    return sum.value(options_.target_energy);
  }

  /// Sews a slit by a step from its tip on, or all of it where it is shorter.
  /// @returns false, and a chart that is no good, where nothing can be sewn without a flip
  [[nodiscard]] bool sew(Chart& chart, uint32_t tip) const {
    double done = 0;
    const double step = kSewnAtOnce * std::sqrt(area_);
    while (done < step) {
      const std::vector<uint32_t> loop = outline_loop(chart);
      size_t i = 0;
      while (i < loop.size() && !(sheet_vertex(chart, loop[i]) == tip && is_tip(chart, loop, i))) ++i;
      if (i == loop.size()) break;
      const size_t n = loop.size();
      const uint32_t p = loop[(i + n - 1) % n], q = loop[(i + 1) % n];
      done += distance(chart.position[loop[i]], chart.position[p]);
      tip = sheet_vertex(chart, p);
      if (!sew_edge(chart, p, q)) return false;
      minimise(chart, kSettle, 1e-4);
    }
    return done > 0;
  }

  static bool sew_edge(Chart& chart, uint32_t p, uint32_t q) {
    const Point2 a = chart.uv[p], b = chart.uv[q];
    for (const double share : {0.5, 0.25, 0.75, 0.0, 1.0}) {
      Chart sewn = chart;
      merge_vertices(sewn, p, q, {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])});
      if (!flip_free(sewn)) continue;
      sewn.opposite = opposite_half_edges(sewn.triangle);
      chart = std::move(sewn);
      return true;
    }
    return false;
  }

  std::vector<Chart>& charts_;
  const Sheet& sheet_;
  const DevelopOptions& options_;
  std::vector<LayoutCost> cost_;       // per chart
  std::map<uint32_t, double> change_;  // of the cost, by the tip's sheet vertex
  double area_ = 0;
  size_t work_ = 0;
  bool sewn_any_ = false;
};

}  // namespace

void close_slits(std::vector<Chart>& charts, const Sheet& sheet, const DevelopOptions& options) {
  SlitCloser(charts, sheet, options).close_all();
}

}  // namespace geocloth
