// SPDX-License-Identifier: GPL-3.0-or-later
//
// Disks to flat charts. A disk starts from Tutte's embedding with its outline on a circle, which cannot flip, and is
// relaxed to the least symmetric Dirichlet energy with a free outline. Opening a path that ends on the outline keeps
// the disk a disk and keeps every triangle where it is in the plane, so a cut is a warm start. A long tube that ends in
// a cap has no usable Tutte embedding (its far end shrinks exponentially): such a disk is cut towards its far end
// first.

#include "develop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "chart_overlap.h"
#include "embed_chart.h"
#include "geocloth/asset/error.h"
#include "grain.h"
#include "merge_charts.h"
#include "point_math.h"
#include "straight_layout.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr size_t kTrialWork = 40'000;  // triangles that trials of a cut may have together
constexpr size_t kLeastTrials = 1, kMostTrials = 6;
constexpr double kMostStrain = 4.055;  // energy of a triangle with s1 / s2 of about 1.15
constexpr uint32_t kTrialSteps = 6;
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

class Developer {
 public:
  Developer(const CutSurface& cut, const DevelopOptions& options) : cut_(cut), options_(options) {}

  /// Lays one component out; returns its charts.
  std::vector<Chart> develop_component(std::vector<uint32_t> triangles) {
    cuts_left_ = options_.max_cuts_per_chart;
    std::vector<Chart> done, open;
    open.push_back(extract_chart(cut_, std::move(triangles)));
    while (!open.empty()) {
      Chart chart = std::move(open.back());
      open.pop_back();
      if (chart.uv.empty()) embed(chart);
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
  /// Minimises the energy and opens cuts while they pay.
  void relax(Chart& chart) {
    double energy = minimise(chart, 80, 1e-4);
    while (cuts_left_ > 0 && (energy > options_.target_energy || is_strained(chart))) {
      std::optional<Trial> best = best_cut(chart, energy);
      if (!best) break;
      chart = std::move(best->chart);
      energy = minimise(chart, 20, 5e-5);
      --cuts_left_;
    }
    minimise(chart, 30, 1e-6);
  }

  /// More than a twentieth of the area is stretched more one way than the other than kMostStrain tells.
  [[nodiscard]] static bool is_strained(const Chart& chart) {
    const std::vector<double> energy =
        SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
    double strained = 0;
    for (size_t t = 0; t < energy.size(); ++t) {
      const Triangle& k = chart.triangle[t];
      if (energy[t] > kMostStrain) {
        strained += triangle_area(chart.position[k[0]], chart.position[k[1]], chart.position[k[2]]);
      }
    }
    return strained > total_area(chart) / 20;
  }

  struct Trial {
    Chart chart;
    double energy = 0;
    double gain = 0;  // fall of the energy beyond the price of the cut
  };

  /// Of several places, the cut that brings most for its length; nothing when none pays.
  [[nodiscard]] std::optional<Trial> best_cut(const Chart& chart, double energy) const {
    const size_t count = std::clamp<size_t>(kTrialWork / chart.triangle.size(), kLeastTrials, kMostTrials);
    const Distances way_out = distances(chart, outline_loop(chart), on_outline(chart));
    const std::vector<double> per_triangle =
        SymmetricDirichlet(chart.position, chart.triangle, {}).energy_per_triangle(chart.uv);
    const std::vector<uint32_t> worst = worst_vertices(chart, per_triangle, way_out, options_.least_cut, count);
    std::vector<std::optional<Trial>> trials(worst.size());
    tbb::parallel_for(size_t{0}, worst.size(), [&](size_t i) {
      const std::vector<uint32_t> path = way_out.path_from(worst[i]);
      const double length = path_length(chart, path);
      Trial trial{opened(chart, path)};
      trial.energy = minimise(trial.chart, kTrialSteps, 5e-5);
      trial.gain = energy - trial.energy - options_.cut_price * length / std::sqrt(total_area(chart));
      if (trial.gain > 0) trials[i] = std::move(trial);
    });
    std::optional<Trial> best;
    for (std::optional<Trial>& t : trials) {
      if (t && (!best || t->gain > best->gain)) best = std::move(t);
    }
    return best;
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

  const CutSurface& cut_;
  DevelopOptions options_;
  uint32_t cuts_left_ = 0;
};

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

}  // namespace

DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options, const Progress& progress) {
  std::vector<std::vector<uint32_t>> parts = triangles_of_components(cut);
  std::vector<std::vector<Chart>> developed(parts.size());
  tbb::parallel_for(size_t{0}, parts.size(),
                    [&](size_t i) { developed[i] = Developer(cut, options).develop_component(std::move(parts[i])); });
  if (progress) progress("flatten", 0.3);
  std::vector<Chart> charts;
  for (std::vector<Chart>& of_part : developed) {
    for (Chart& chart : of_part) charts.push_back(std::move(chart));
  }
  const Sheet sheet = find_sheet(cut);
  merge_charts(
      charts, sheet,
      {.most_energy = options.target_energy, .seam_price = options.cut_price, .narrow = kNarrow * options.least_cut});
  ChartedSurface result =
      options.straight_cuts ? straighten_layout(cut, sheet, charts) : ChartedSurface{cut, std::move(charts)};
  tbb::parallel_for(size_t{0}, result.charts.size(), [&](size_t i) {
    turn_upright(result.charts[i]);
    straighten_threads(result.charts[i]);
  });
  return assembled(result.cut, result.charts);
}

}  // namespace geocloth
