// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks to flat charts. A disk starts from Tutte's embedding with its outline on a circle, which cannot flip, and is
// relaxed to the least symmetric Dirichlet energy with a free outline. Opening a path that ends on the outline keeps
// the disk a disk and keeps every triangle where it is in the plane, so a cut is a warm start. A long tube that ends in
// a cap has no usable Tutte embedding (its far end shrinks exponentially): such a disk is cut towards its far end
// first.

#include "develop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "chart_overlap.h"
#include "embed_chart.h"
#include "geocloth/asset/error.h"
#include "grain.h"
#include "merge_charts.h"
#include "part_panels.h"
#include "point_math.h"
#include "straight_layout.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr size_t kTrialWork = 40'000;  // triangles that trials of a cut may have together
constexpr size_t kLeastTrials = 1;
constexpr size_t kSmall = 1'500;        // triangles of a chart in which all places are tried every time
constexpr double kMostStrain = 4.055;   // energy of a triangle with s1 / s2 of about 1.15
constexpr double kMostStrained = 0.05;  // of a chart's area
constexpr uint32_t kStartSteps = 80, kTrialSteps = 6;
constexpr double kStartTolerance = 1e-4;
constexpr double kNarrow = 0.3;  // of the least cut: what counts as a slit too narrow for pixels
constexpr double kApart = 0.15;  // between the places tried, by the root of the area

// ------------------------------------------------------------------------------------------------ cuts that pay

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

/// Cuts are chosen one after the other, and what is best at the time need not be in the end: several ways to choose are
/// tried.
struct Taste {
  enum class Likes {
    most_gain,            ///< the greatest fall of the energy beyond the price
    most_for_its_length,  ///< the greatest fall by length
    most_of_what_lacks,   ///< the same, but what falls below the target does not count
  } likes = Likes::most_gain;
  size_t places = 6;           ///< places tried at once, at most
  double crease_discount = 0;  ///< for cuts along creases (chart.h)
};
constexpr std::array kTastes{Taste{Taste::Likes::most_gain, 6, kCreaseDiscount},
                             Taste{Taste::Likes::most_of_what_lacks, 6, kCreaseDiscount},
                             Taste{Taste::Likes::most_for_its_length, 6}, Taste{Taste::Likes::most_gain, 12}};

/// The area that is stretched more one way than the other than kMostStrain tells.
double strained_area(const Chart& chart) {
  const std::vector<double> energy =
      SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
  double strained = 0;
  for (size_t t = 0; t < energy.size(); ++t) {
    const Triangle& k = chart.triangle[t];
    if (energy[t] > kMostStrain) {
      strained += triangle_area(chart.position[k[0]], chart.position[k[1]], chart.position[k[2]]);
    }
  }
  return strained;
}

class Developer {
 public:
  Developer(const DevelopOptions& options, const Taste& taste) : options_(options), taste_(taste) {}

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

  struct Trial {
    std::vector<uint32_t> path;
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
    const Distances way_out = distances(chart, outline_loop(chart), on_outline(chart), taste_.crease_discount);
    const std::vector<double> per_triangle =
        SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
    const double side = std::sqrt(total_area(chart));
    const auto judge = [&](Trial& trial) {
      trial.gain = trial.fall - options_.cut_price * trial.length / side;
      trial.worth = worth(energy, energy - trial.fall, trial.length, trial.gain);
    };
    const auto try_out = [&](Trial& trial) {
      trial.chart = opened(chart, trial.path);
      trial.fall = energy - minimise(trial.chart, kTrialSteps, 5e-5);
      judge(trial);
    };
    std::vector<Trial> trials;
    for (const uint32_t v : worst_vertices(chart, per_triangle, way_out, options_.least_cut, count)) {
      Trial& trial = trials.emplace_back();
      trial.path = way_out.path_from(v);
      trial.length = path_length(chart, trial.path);
      if (chart.triangle.size() < kSmall) continue;
      const auto known = falls.find(chart.cut_vertex[v]);
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
      if (!t.path.empty()) falls[chart.cut_vertex[t.path.front()]] = {t.fall, t.length};
    }
    return best;
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
  uint32_t cuts_left_ = 0;
};

// -------------------------------------------------------------------------------------------------- whole garments

/// The length of an outline in the plane when it runs straight where it is serrated now, about.
double smooth_outline_length(const Chart& chart) {
  constexpr int kRounds = 6;
  std::vector<Point2> place;
  for (const uint32_t v : outline_loop(chart)) place.push_back(chart.uv[v]);
  const size_t n = place.size();
  double length = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const std::vector<Point2> before = place;
    length = 0;
    for (size_t i = 0; i < n; ++i) {
      const Point2 &a = before[i], &b = before[(i + 1) % n];
      length += std::hypot(b[0] - a[0], b[1] - a[1]);
      place[i] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    }
  }
  return length;
}

/// What a layout of one part costs, in lengths of seam by the root of the area: its seams, what little distortion it
/// has, and much more where that is beyond the bounds.
double cost_of(const std::vector<Chart>& charts, const DevelopOptions& options) {
  constexpr double kExcess = 1 / 0.06, kBeyond = 1 / 0.005, kStrained = 20;
  double area = 0, outline = 0, energy = 0, strained = 0;
  for (const Chart& c : charts) {
    const double own = total_area(c);
    area += own;
    outline += smooth_outline_length(c);
    energy += own * SymmetricDirichlet(c.position, c.triangle, {}).energy(c.uv);
    strained += strained_area(c);
  }
  energy /= area;
  return outline / 2 / std::sqrt(area) + kExcess * (energy - 4) +
         kBeyond * std::max(energy - options.target_energy, 0.0) +
         kStrained * std::max(strained / area - kMostStrained, 0.0);
}

/// How many tastes a part is worth: time grows with its triangles.
size_t tastes_for(size_t triangles) {
  constexpr size_t kAll = 4'000, kTwo = 10'000;
  return triangles <= kAll ? kTastes.size() : triangles <= kTwo ? 2 : 1;
}

/// Components of the cut surface that were one sheet, in the order of their first ones.
std::vector<std::vector<uint32_t>> components_by_sheet(const CutSurface& cut, const Sheet& sheet) {
  std::vector<uint32_t> root(cut.component_count);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](uint32_t c) {
    while (root[c] != c) c = root[c] = root[root[c]];
    return c;
  };
  std::vector<uint32_t> first(sheet.tied.size(), kNone);  // per sheet vertex: a component that has it
  for (size_t t = 0; t < cut.triangle.size(); ++t) {
    for (const uint32_t v : cut.triangle[t]) {
      uint32_t& f = first[sheet.of_vertex[v]];
      if (f == kNone) f = cut.component[t];
      const auto [low, high] = std::minmax({find(f), find(cut.component[t])});
      root[high] = low;
    }
  }
  std::vector<std::vector<uint32_t>> group(cut.component_count);
  for (uint32_t c = 0; c < cut.component_count; ++c) group[find(c)].push_back(c);
  std::erase_if(group, [](const auto& g) { return g.empty(); });
  return group;
}

/// Lays the components of one sheet out and sews together again what needs no seam.
std::vector<Chart> develop_sheet(const CutSurface& cut, const Sheet& sheet,
                                 const std::vector<std::vector<uint32_t>>& components, const DevelopOptions& options) {
  size_t triangles = 0;
  for (const std::vector<uint32_t>& c : components) triangles += c.size();
  const size_t count = tastes_for(triangles);
  std::vector<Chart> start(components.size());
  tbb::parallel_for(size_t{0}, start.size(), [&](size_t c) { start[c] = Developer::laid_out(cut, components[c]); });
  std::vector<std::vector<Chart>> layouts(count);
  std::vector<double> cost(count, std::numeric_limits<double>::infinity());
  std::vector<std::exception_ptr> failed(count);
  tbb::parallel_for(size_t{0}, count, [&](size_t i) {
    try {
      std::vector<std::vector<Chart>> charts(start.size());
      tbb::parallel_for(size_t{0}, start.size(),
                        [&](size_t c) { charts[c] = Developer(options, kTastes.at(i)).develop_component(start[c]); });
      for (std::vector<Chart>& of_component : charts) {
        for (Chart& chart : of_component) layouts[i].push_back(std::move(chart));
      }
      merge_charts(layouts[i], sheet,
                   {.most_energy = options.target_energy,
                    .seam_price = options.cut_price,
                    .narrow = kNarrow * options.least_cut});
      cost[i] = cost_of(layouts[i], options);
    } catch (const Error&) {
      failed[i] = std::current_exception();
    }
  });
  const auto best = static_cast<size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  if (failed[best]) std::rethrow_exception(failed[best]);
  return std::move(layouts[best]);
}

DevelopedSurface assembled(const CutSurface& cut, const std::vector<Chart>& charts) {
  DevelopedSurface result;
  CutSurface& out = result.cut;
  out.triangle.resize(cut.triangle.size());
  out.component.resize(cut.triangle.size());
  out.point_count = cut.point_count;
  out.clean_triangle = cut.clean_triangle;
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
      out.triangle[chart.global_triangle[t]] = {first + k[0], first + k[1], first + k[2]};
      out.component[chart.global_triangle[t]] = out.component_count;
    }
    ++out.component_count;
    result.energy.push_back(SymmetricDirichlet(chart.position, chart.triangle, {}).energy(chart.uv));
  }
  return result;
}

/// Seams drawn straight, and every chart turned upright.
ChartedSurface finished(const CutSurface& cut, const Sheet& sheet, const std::vector<Chart>& charts,
                        const DevelopOptions& options) {
  ChartedSurface result = options.straight_cuts ? straighten_layout(cut, sheet, charts) : ChartedSurface{cut, charts};
  tbb::parallel_for(size_t{0}, result.charts.size(), [&](size_t i) {
    turn_upright(result.charts[i]);
    straighten_threads(result.charts[i]);
  });
  return result;
}

/// The same, with charts parted that are packed closer then. What that brings in the end is measured, because a piece
/// may come to hang otherwise than was thought.
ChartedSurface parted_where_that_pays(const CutSurface& cut, const Sheet& sheet, std::vector<Chart> charts,
                                      const DevelopOptions& options) {
  constexpr double kLeastGain = 0.02;
  ChartedSurface whole = finished(cut, sheet, charts, options);
  Sheet pinned = sheet;
  if (!part_panels(charts, pinned, options.parting)) return whole;
  ChartedSurface parted = finished(cut, pinned, charts, options);
  const double before = estimated_utilisation(whole.charts, options.parting.pixel);
  const double after = estimated_utilisation(parted.charts, options.parting.pixel);
  return after >= before + kLeastGain ? std::move(parted) : std::move(whole);
}

}  // namespace

DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options, const Progress& progress) {
  const Sheet sheet = find_sheet(cut);
  std::vector<std::vector<uint32_t>> triangles = triangles_of_components(cut);
  const std::vector<std::vector<uint32_t>> sheets = components_by_sheet(cut, sheet);
  std::vector<std::vector<Chart>> developed(sheets.size());
  tbb::parallel_for(size_t{0}, sheets.size(), [&](size_t i) {
    std::vector<std::vector<uint32_t>> own;
    for (const uint32_t c : sheets[i]) own.push_back(std::move(triangles[c]));
    developed[i] = develop_sheet(cut, sheet, own, options);
  });
  if (progress) progress("flatten", 0.3);
  std::vector<Chart> charts;
  for (std::vector<Chart>& of_sheet : developed) {
    for (Chart& chart : of_sheet) charts.push_back(std::move(chart));
  }
  const ChartedSurface result = parted_where_that_pays(cut, sheet, std::move(charts), options);
  return assembled(result.cut, result.charts);
}

}  // namespace geocloth
