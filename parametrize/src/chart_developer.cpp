// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks to flat charts. A disk starts from Tutte's embedding with its outline on a circle, which cannot flip, and is
// relaxed to the least symmetric Dirichlet energy with a free outline. Opening a path that ends on the outline keeps
// the disk a disk and keeps every triangle where it is in the plane, so a cut is a warm start. A long tube that ends in
// a cap has no usable Tutte embedding (its far end shrinks exponentially): such a disk is cut towards its far end
// first.

#include "chart_developer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "chart_overlap.h"
#include "embed_chart.h"
#include "geocloth/asset/error.h"
#include "layout_cost.h"
#include "point_math.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr size_t kTrialWork = 40'000;  // triangles that trials of a cut may have together
constexpr size_t kLeastTrials = 1;
constexpr size_t kSmall = 1'500;  // triangles of a chart in which all places are tried every time
constexpr uint32_t kStartSteps = 80, kTrialSteps = 6;
constexpr double kStartTolerance = 1e-4;
constexpr double kApart = 0.15;  // between the places tried, by the root of the area

/// Places worth a cut, worst first: interior vertices by the excess energy of the triangles within two rings, apart
/// from each other and as far from the outline as a cut should be long.
std::vector<uint32_t> worst_vertices(const Chart& c, const std::vector<double>& energy, const Distances& way_out,
                                     double least_cut, size_t count) {
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
    if (way_out.value[v] > 0 && way_out.value[v] >= least_cut && way_out.from[v] != kNone) order.push_back(v);
  }
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return score[a] != score[b] ? score[a] > score[b] : a < b; });
  // One of each region.
  const double apart = kApart * std::sqrt(total_area(c));
  std::vector<uint32_t> chosen;
  for (const uint32_t v : order) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(),
                                  [&](uint32_t w) { return distance(c.position[v], c.position[w]) < apart; });
    if (!near) chosen.push_back(v);
  }
  return chosen;
}

class Developer {
 public:
  /// @param discount  as of wished_discounts(), for the mirror plane
  Developer(const DevelopOptions& options, const Taste& taste, std::span<const double> discount)
      : options_(options), taste_(taste), discount_(discount) {}

  /// A component in the plane without cuts of its own: where all tastes start.
  static Chart laid_out(const CutSurface& cut, std::vector<uint32_t> triangles) {
    Chart chart = extract_chart(cut, std::move(triangles));
    embed(chart);
    minimise(chart, kStartSteps, kStartTolerance);
    return chart;
  }

  /// Cuts a component that is laid out until it lies well; returns its charts.
  std::vector<Chart> develop_component(const Chart& component) {
    cuts_left_ = options_.max_cuts_per_chart;
    std::vector<Chart> done, open;
    open.push_back(component);
    bool is_piece = false;
    while (!open.empty()) {
      Chart chart = std::move(open.back());
      open.pop_back();
      if (is_piece) minimise(chart, kStartSteps, kStartTolerance);
      is_piece = true;
      relax(chart);
      std::vector<Chart> pieces = without_overlap(chart);
      if (pieces.empty()) {
        done.push_back(std::move(chart));
      } else {
        for (Chart& piece : pieces) open.push_back(std::move(piece));
      }
    }
    return done;
  }

 private:
  /// Opens cuts while they pay.
  void relax(Chart& chart) {
    double energy = SymmetricDirichlet(chart.position, chart.triangle, {}).energy(chart.uv);
    Falls falls;
    while (cuts_left_ > 0 &&
           (energy > options_.target_energy || strained_area(chart) > kMostStrained * total_area(chart))) {
      std::optional<Trial> best = best_cut(chart, energy, falls);
      if (!best) break;
      chart = std::move(best->chart);
      energy = minimise(chart, 20, 5e-5);
      --cuts_left_;
    }
    minimise(chart, 30, 1e-6);
  }

  /// By how much the energy fell in trials of cuts that were not made, by the cut vertex where they end. Other cuts
  /// change that little.
  struct Fall {
    double energy, length;
  };
  using Falls = std::map<uint32_t, Fall>;

  using Paths = std::vector<std::vector<uint32_t>>;

  struct Trial {
    Paths paths;
    double length = 0;
    double fall = 0;        // of the energy
    bool is_known = false;  // from a round before
    Chart chart;            // empty until the cut is tried
    double gain = 0;        // beyond the price
    double worth = 0;       // as the taste has it
  };

  /// Of several places, the cut that brings most for its length; nothing when none pays. What a cut brought in a round
  /// before is believed, in charts where trials are dear, until that makes it the best one.
  [[nodiscard]] std::optional<Trial> best_cut(const Chart& chart, double energy, Falls& falls) const {
    const size_t count = std::clamp<size_t>(kTrialWork / chart.triangle.size(), kLeastTrials, taste_.places);
    const Distances way_out =
        distances(chart, outline_loop(chart), on_outline(chart),
                  {taste_.crease_discount, taste_.both_sides ? discount_ : std::span<const double>{}});
    const std::vector<double> per_triangle =
        SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
    const double side = std::sqrt(total_area(chart));
    const auto judge = [&](Trial& trial) {
      trial.gain = trial.fall - options_.cut_price * trial.length / side;
      trial.worth = worth(energy, energy - trial.fall, trial.length, trial.gain);
    };
    const auto try_out = [&](Trial& trial) {
      trial.chart = opened(chart, trial.paths);
      trial.fall = energy - minimise(trial.chart, kTrialSteps, 5e-5);
      judge(trial);
    };
    std::vector<Trial> trials;
    const std::vector<uint32_t> worst = worst_vertices(chart, per_triangle, way_out, options_.least_cut, count);
    for (Paths& paths : cut_paths(chart, way_out, worst)) {
      Trial& trial = trials.emplace_back();
      trial.paths = std::move(paths);
      for (const std::vector<uint32_t>& path : trial.paths) trial.length += path_length(chart, path);
      if (chart.triangle.size() < kSmall) continue;
      const auto known = falls.find(chart.cut_vertex[trial.paths.front().front()]);
      if (known == falls.end() || known->second.length != trial.length) continue;
      trial.fall = known->second.energy;
      trial.is_known = true;
      judge(trial);
    }
    const auto try_where = [&](const auto& wanted) {
      std::vector<size_t> untried;
      for (size_t i = 0; i < trials.size(); ++i) {
        if (trials[i].chart.triangle.empty() && wanted(trials[i])) untried.push_back(i);
      }
      tbb::parallel_for(size_t{0}, untried.size(), [&](size_t i) { try_out(trials[untried[i]]); });
      return !untried.empty();
    };
    try_where([](const Trial& t) { return !t.is_known; });
    const auto better = [](const Trial& a, const Trial& b) {
      return (a.gain > 0) != (b.gain > 0) ? b.gain > 0 : a.worth < b.worth;
    };
    std::optional<Trial> best;
    while (!trials.empty() && !best) {
      Trial& leading = *std::max_element(trials.begin(), trials.end(), better);
      if (!(leading.gain > 0)) {  // what was believed must not end the search
        if (!try_where([](const Trial&) { return true; })) break;
      } else if (leading.chart.triangle.empty()) {
        try_out(leading);
      } else {
        best = std::move(leading);
      }
    }
    for (const Trial& t : trials) {
      if (!t.paths.empty()) falls[chart.cut_vertex[t.paths.front().front()]] = {t.fall, t.length};
    }
    return best;
  }

  /// The ways from the places to the outline, each with that from the place's mirror image where there is one: what
  /// the left side of a garment needs the right side needs too.
  [[nodiscard]] std::vector<Paths> cut_paths(const Chart& chart, const Distances& way_out,
                                             const std::vector<uint32_t>& tips) const {
    std::vector<Paths> result;
    std::vector<uint32_t> taken;
    for (const uint32_t tip : tips) {
      if (std::find(taken.begin(), taken.end(), tip) != taken.end()) continue;
      Paths paths{way_out.path_from(tip)};
      const uint32_t other = mirror_tip(chart, way_out, tip);
      if (other != kNone) {
        std::vector<uint32_t> path = way_out.path_from(other);
        const auto meets = std::find_first_of(path.begin(), path.end(), paths[0].begin(), paths[0].end());
        if (meets != path.end()) path.erase(meets + 1, path.end());
        if (std::find(path.begin(), path.end(), tip) == path.end() && path.size() > 1) paths.push_back(std::move(path));
        taken.push_back(other);
      }
      result.push_back(std::move(paths));
    }
    return result;
  }

  /// The vertex inside the chart at the tip's mirror image; kNone where that is elsewhere, or too near to the tip for
  /// cuts of their own.
  [[nodiscard]] uint32_t mirror_tip(const Chart& chart, const Distances& way_out, uint32_t tip) const {
    if (!taste_.both_sides || !options_.prefer.mirror) return kNone;
    const MirrorPlane& mirror = *options_.prefer.mirror;
    if (2 * std::abs(mirror.height(chart.position[tip])) < kApart * std::sqrt(total_area(chart))) return kNone;
    const Point3 image = mirror.image(chart.position[tip]);
    uint32_t nearest = 0;
    for (uint32_t v = 1; v < chart.position.size(); ++v) {
      if (distance(chart.position[v], image) < distance(chart.position[nearest], image)) nearest = v;
    }
    if (distance(chart.position[nearest], image) > 2 * mirror.tolerance) return kNone;
    return way_out.value[nearest] >= options_.least_cut && way_out.from[nearest] != kNone ? nearest : kNone;
  }

  [[nodiscard]] double worth(double before, double after, double length, double gain) const {
    const bool lacks = before > options_.target_energy;
    switch (taste_.likes) {
      case Taste::Likes::most_of_what_lacks:
        return (before - (lacks ? std::max(after, options_.target_energy) : after)) / length;
      case Taste::Likes::most_for_its_length:
        return (before - after) / length;
      case Taste::Likes::most_gain:
        break;
    }
    return gain;
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

  DevelopOptions options_;
  Taste taste_;
  std::span<const double> discount_;
  uint32_t cuts_left_ = 0;
};

}  // namespace

Chart laid_out(const CutSurface& cut, std::vector<uint32_t> triangles) {
  return Developer::laid_out(cut, std::move(triangles));
}

std::vector<Chart> develop_component(const Chart& component, const DevelopOptions& options, const Taste& taste,
                                     std::span<const double> discount) {
  return Developer(options, taste, discount).develop_component(component);
}

}  // namespace geocloth
