// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks to flat charts. A disk starts from Tutte's embedding with its outline on a circle, which cannot flip, and is
// relaxed to the least symmetric Dirichlet energy with a free outline. Opening a path that ends on the outline keeps
// the disk a disk and keeps every triangle where it is in the plane, so a cut is a warm start. A long tube that ends in
// a cap has no usable Tutte embedding (its far end shrinks exponentially): such a disk is cut towards its far end
// first.

#include "develop/chart_developer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/layout_cost.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr size_t kTrialWork = 40'000;  // triangles that trials of a cut may have together
constexpr size_t kLeastTrials = 1;
constexpr size_t kSmallChart = 1'500;    // triangles of a chart from which on cuts bring what they brought before
constexpr double kMoreThanBelieved = 2;  // in smaller ones they may bring so many times that,
constexpr double kMoreThanFirst = 2;     // and so many times what their first step brings
constexpr uint32_t kStartSteps = 80, kTrialSteps = 6;
constexpr double kStartTolerance = 1e-4, kCutTolerance = 5e-5;
constexpr double kSpoilt = 0.2;       // share of a chart's area from which short cuts are made too
constexpr double kTriedApart = 0.15;  // between the places tried, by the root of the area

/// Places worth a cut, worst first: interior vertices by the excess energy of the triangles within two rings, apart
/// from each other and as far from the outline as a cut should be long.
std::vector<uint32_t> worst_vertices(const Chart& c, const std::vector<double>& energy, const Distances& way_out,
                                     double least_cut, size_t count) {
  std::vector<double> ring(c.position.size(), 0), score(c.position.size(), 0);
  for (size_t t = 0; t < c.triangle.size(); ++t) {
    if (!c.is_cloth(t)) continue;
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
  const double apart = kTriedApart * std::sqrt(total_area(c));
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
  Developer(const DevelopOptions& options, const Taste& taste, std::span<const double> discount, TrialMemory* memory)
      : options_(options), taste_(taste), discount_(discount), memory_(memory) {}

  /// A component in the plane without cuts of its own: where all tastes start.
  static Chart laid_out(const CutSurface& cut, std::vector<uint32_t> triangles) {
    Chart chart = extract_chart(cut, std::move(triangles));
    if (embed_flat(chart)) return chart;
    embed(chart);
    minimise(chart, kStartSteps, kStartTolerance);
    return chart;
  }

  /// Cuts a component that is laid out until it lies well; returns its charts.
  std::vector<Chart> develop_component(const Chart& component) {
    cuts_left_ = options_.max_cuts_per_chart;
    std::vector<Chart> done;
    std::vector<Open> open{{component}};
    while (!open.empty()) {
      Open whole = std::move(open.back());
      open.pop_back();
      relax(whole);
      std::vector<Chart> pieces = without_overlap(whole.chart);
      for (uint32_t i = 0; i < pieces.size(); ++i) {
        Open& piece = open.emplace_back(Open{std::move(pieces[i]), whole.state});
        settle(piece, {{i}}, [](Chart& chart) { return minimise(chart, kStartSteps, kStartTolerance); });
      }
      if (pieces.empty()) done.push_back(std::move(whole.chart));
    }
    return done;
  }

 private:
  using Paths = TrialMemory::Paths;

  /// A chart that is not done.
  struct Open {
    Chart chart;
    TrialMemory::State state = TrialMemory::kStart;
  };

  /// Opens cuts while they pay.
  void relax(Open& open) {
    double energy = chart_energy(open.chart).energy(open.chart.uv);
    Falls falls;
    while (cuts_left_ > 0 &&
           (energy > options_.target_energy || strained_area(open.chart) > kMostStrained * total_area(open.chart))) {
      std::optional<Trial> best = best_cut(open, energy, falls, options_.least_cut);
      if (!best && is_spoilt(open.chart)) best = best_cut(open, energy, falls, 0);
      if (!best) break;
      const bool is_laid = !best->chart.triangle.empty();
      open.chart = is_laid ? std::move(best->chart) : opened(open.chart, best->paths);
      energy = settle(open, best->paths, [&](Chart& chart) {
        if (!is_laid) minimise(chart, kTrialSteps, kCutTolerance);
        return minimise(chart, 20, kCutTolerance);
      });
      --cuts_left_;
    }
    settle(open, {}, [](Chart& chart) { return minimise(chart, 30, 1e-6); });
  }

  /// Lays a chart out after a change that has a name, unless that was done before. @returns its energy
  template <class Lay>
  double settle(Open& open, const Paths& change, const Lay& lay) {
    if (memory_ == nullptr) return lay(open.chart);
    if (std::optional<TrialMemory::Made> known = memory_->made(open.state, change)) {
      open.chart.uv = std::move(known->uv);
      open.state = known->state;
      return known->energy;
    }
    const double energy = lay(open.chart);
    open.state = memory_->keep_made(open.state, change, open.chart.uv, energy);
    return energy;
  }

  /// Is a chart strained by triangles that are longer than cuts have to be? The ends of a closed pole of few triangles
  /// are smaller than a cut is worth, but what they lack is passed on from end to end.
  [[nodiscard]] bool is_spoilt(const Chart& chart) const {
    const std::vector<double> energy = chart_energy(chart).energy_per_triangle(chart.uv);
    double spoilt = 0;
    for (size_t t = 0; t < energy.size(); ++t) {
      const auto& [a, b, c] = chart.triangle[t];
      const Point3 &p = chart.position[a], &q = chart.position[b], &r = chart.position[c];
      const bool is_long = std::max({distance(p, q), distance(q, r), distance(r, p)}) > options_.least_cut;
      if (is_long && chart.is_cloth(t) && energy[t] > kMostStrain) spoilt += triangle_area(p, q, r);
    }
    return spoilt > kSpoilt * total_area(chart);
  }

  /// By how much the energy fell in trials of cuts that were not made, by the cut vertex where they end, as far as they
  /// went. Other cuts change that little.
  struct Fall {
    double energy, length;
  };
  using Falls = std::map<uint32_t, Fall>;

  struct Trial {
    Paths paths;
    double length = 0;
    double fall = 0;   // of the energy
    double times = 1;  // the most that the fall may come to, by what is known of it
    enum class Known : uint8_t { nothing, believed, begun, tried } known = Known::nothing;
    Chart chart;                               // as the cut leaves it; empty where another taste knows that
    std::optional<SymmetricDirichlet> energy;  // of a chart that is begun
    double gain = 0;                           // beyond the price, at most
    double worth = 0;                          // as the taste has it, at most
  };

  /// Of several places, the cut that brings most for its length; nothing when none pays. A trial goes only as far as
  /// it may still become the best one, by what its first step brings, or by what the cut brought in a round before.
  [[nodiscard]] std::optional<Trial> best_cut(const Open& open, double energy, Falls& falls, double least_cut) const {
    using Known = typename Trial::Known;
    const Chart& chart = open.chart;
    const size_t count = std::clamp<size_t>(kTrialWork / chart.triangle.size(), kLeastTrials, taste_.places);
    const Distances way_out =
        distances(chart, outline_loop(chart), on_outline(chart),
                  {taste_.crease_discount, taste_.both_sides ? discount_ : std::span<const double>{}});
    const std::vector<double> per_triangle = chart_energy(chart).energy_per_triangle(chart.uv);
    const double side = std::sqrt(total_area(chart));
    const bool is_small = chart.triangle.size() < kSmallChart;
    const auto judge = [&](Trial& trial) {
      const double fall = trial.times * trial.fall;
      trial.gain = fall - options_.cut_price * trial.length / side;
      trial.worth = worth(energy, energy - fall, trial.length, trial.gain);
    };
    const auto go_on = [&](Trial& trial) {
      go_on_with(trial, open, energy);
      if (!is_small && trial.known == Known::begun) go_on_with(trial, open, energy);
      judge(trial);
    };
    std::vector<Trial> trials;
    const std::vector<uint32_t> worst = worst_vertices(chart, per_triangle, way_out, least_cut, count);
    for (Paths& paths : cut_paths(chart, way_out, worst)) {
      Trial& trial = trials.emplace_back();
      trial.paths = std::move(paths);
      for (const std::vector<uint32_t>& path : trial.paths) trial.length += path_length(chart, path);
      const auto known = falls.find(chart.cut_vertex[trial.paths.front().front()]);
      if (known == falls.end() || known->second.length != trial.length) continue;
      trial.fall = known->second.energy;
      trial.times = is_small ? kMoreThanBelieved : 1;
      trial.known = Known::believed;
      judge(trial);
    }
    const auto go_on_where = [&](Known known) {
      std::vector<size_t> chosen;
      for (size_t i = 0; i < trials.size(); ++i) {
        if (trials[i].known == known) chosen.push_back(i);
      }
      tbb::parallel_for(size_t{0}, chosen.size(), [&](size_t i) { go_on(trials[chosen[i]]); });
      return !chosen.empty();
    };
    go_on_where(Known::nothing);
    const auto better = [](const Trial& a, const Trial& b) {
      return (a.gain > 0) != (b.gain > 0) ? b.gain > 0 : a.worth < b.worth;
    };
    std::optional<Trial> best;
    while (!trials.empty() && !best) {
      Trial& leading = *std::max_element(trials.begin(), trials.end(), better);
      if (!(leading.gain > 0)) {  // what was believed must not end the search
        if (!go_on_where(Known::believed)) break;
      } else if (leading.known != Known::tried) {
        go_on(leading);
      } else {
        best = std::move(leading);
      }
    }
    for (const Trial& t : trials) {
      if (!t.paths.empty()) falls[chart.cut_vertex[t.paths.front().front()]] = {t.times * t.fall, t.length};
    }
    return best;
  }

  /// A step with a cut that is not known, or all others. What is remembered decides nothing: it is asked for just what
  /// would be found.
  void go_on_with(Trial& trial, const Open& open, double energy) const {
    using Known = typename Trial::Known;
    const bool is_first = trial.known != Known::begun;
    const TrialMemory::Depth depth = is_first ? TrialMemory::Depth::first_step : TrialMemory::Depth::whole;
    const std::optional<double> found = memory_ ? memory_->fall(open.state, trial.paths, depth) : std::nullopt;
    if (found) {
      trial.fall = *found;
      trial.chart = {};
      trial.energy.reset();
    } else {
      if (!trial.energy) {
        trial.chart = opened(open.chart, trial.paths);
        trial.energy = chart_energy(trial.chart);
        trial.fall = energy - trial.energy->minimise(trial.chart.uv, 1, kCutTolerance);
      }
      if (!is_first) trial.fall = energy - trial.energy->minimise(trial.chart.uv, kTrialSteps - 1, kCutTolerance);
      if (memory_ != nullptr) memory_->keep_fall(open.state, trial.paths, depth, trial.fall);
    }
    const bool is_done = !is_first || trial.fall < kCutTolerance * (energy - trial.fall);
    trial.known = is_done ? Known::tried : Known::begun;
    trial.times = is_done ? 1 : kMoreThanFirst;
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
    if (2 * std::abs(mirror.height(chart.position[tip])) < kTriedApart * std::sqrt(total_area(chart))) return kNone;
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
    return chart_energy(chart).minimise(chart.uv, iterations, tolerance);
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
  TrialMemory* memory_;
  uint32_t cuts_left_ = 0;
};

}  // namespace

Chart laid_out(const CutSurface& cut, std::vector<uint32_t> triangles) {
  return Developer::laid_out(cut, std::move(triangles));
}

std::vector<Chart> develop_component(const Chart& component, const DevelopOptions& options, const Taste& taste,
                                     std::span<const double> discount, TrialMemory* memory) {
  return Developer(options, taste, discount, memory).develop_component(component);
}

}  // namespace geocloth
