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
#include "edge_wishes.h"
#include "embed_chart.h"
#include "geocloth/asset/error.h"
#include "grain.h"
#include "layout_cost.h"
#include "merge_charts.h"
#include "mixed_cut.h"
#include "part_panels.h"
#include "point_math.h"
#include "straight_layout.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr size_t kTrialWork = 40'000;  // triangles that trials of a cut may have together
constexpr size_t kLeastTrials = 1;
constexpr size_t kSmall = 1'500;  // triangles of a chart in which all places are tried every time
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
  double crease_discount = 0;  ///< for cuts along creases (edge_wishes.h)
  bool both_sides = false;     ///< of the mirror plane are cut alike
};
constexpr std::array kTastes{Taste{Taste::Likes::most_gain, 6, kCreaseDiscount},
                             Taste{Taste::Likes::most_of_what_lacks, 6, kCreaseDiscount},
                             Taste{Taste::Likes::most_for_its_length, 6}, Taste{Taste::Likes::most_gain, 12}};
/// For parts so small that it costs nothing.
constexpr std::array kFurtherTastes{Taste{Taste::Likes::most_of_what_lacks, 12},
                                    Taste{Taste::Likes::most_of_what_lacks, 12, kCreaseDiscount / 2},
                                    Taste{Taste::Likes::most_for_its_length, 12, kCreaseDiscount / 2}};
/// With cuts where they are wished.
constexpr std::array kWishfulTastes{Taste{Taste::Likes::most_gain, 6, kCreaseDiscount, true},
                                    Taste{Taste::Likes::most_for_its_length, 6, 0, true}};

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

// -------------------------------------------------------------------------------------------------- whole garments

/// The length of outlines whose mirror image is no outline.
double one_sided_length(const std::vector<Chart>& charts, const MirrorPlane& mirror, double within) {
  std::vector<std::pair<Point3, double>> stop;  // place, its share of the length
  for (const Chart& c : charts) {
    const std::vector<uint32_t> loop = outline_loop(c);
    for (size_t i = 0; i < loop.size(); ++i) {
      const Point3 &a = c.position[loop[i]], &b = c.position[loop[(i + 1) % loop.size()]];
      stop.emplace_back((a + b) * 0.5, distance(a, b));
    }
  }
  double sum = 0;
  for (const auto& [place, length] : stop) {
    const Point3 image = mirror.image(place);
    const auto matches = [&](const auto& other) { return distance(other.first, image) <= within; };
    if (std::none_of(stop.begin(), stop.end(), matches)) sum += length;
  }
  return sum;
}

/// What a layout of one part costs (layout_cost.h), with a little more for seams that are on one side only: of layouts
/// that cost about the same the symmetric one is taken.
double cost_of(const std::vector<Chart>& charts, const DevelopOptions& options) {
  constexpr double kOneSided = 0.05, kMatched = 0.04;
  LayoutCost cost;
  for (const Chart& c : charts) cost.add(c, smooth_outline_length(c));
  if (options.prefer.mirror) {
    const double one_sided = one_sided_length(charts, *options.prefer.mirror, kMatched * std::sqrt(cost.area));
    cost.outline += kOneSided * one_sided;
  }
  return cost.value(options.target_energy);
}

/// A way to lay a part out: from one of the given cuts, by a taste.
struct Way {
  size_t cut;
  Taste taste;
};

/// How many ways a part is worth: time grows with its triangles.
std::vector<Way> ways_for(size_t triangles, size_t cuts) {
  constexpr size_t kFurther = 1'500, kAll = 4'000, kTwo = 10'000, kOther = 30'000;
  const size_t plain = triangles <= kAll ? kTastes.size() : triangles <= kTwo ? 2 : 1;
  const size_t wishful = triangles <= kAll ? kWishfulTastes.size() : triangles <= kOther ? 1 : 0;
  std::vector<Way> ways;
  for (size_t i = 0; i < plain; ++i) ways.push_back({0, kTastes.at(i)});
  if (triangles <= kFurther) {
    for (const Taste& taste : kFurtherTastes) ways.push_back({0, taste});
  }
  for (size_t c = 1; c < cuts; ++c) {
    for (size_t i = 0; i < wishful; ++i) ways.push_back({c, kWishfulTastes.at(i)});
  }
  return ways;
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

/// A cut surface and what is asked of it again and again.
struct CutWay {
  const CutSurface& cut;
  Sheet sheet;
  std::vector<std::vector<std::vector<uint32_t>>> triangles;  // per sheet and component
  std::vector<double> discount;                               // per half-edge, for the mirror plane
};

CutWay examined(const CutSurface& cut, const DevelopOptions& options) {
  CutWay way{cut, find_sheet(cut), {}, {}};
  std::vector<std::vector<uint32_t>> triangles = triangles_of_components(cut);
  for (const std::vector<uint32_t>& components : components_by_sheet(cut, way.sheet)) {
    way.triangles.emplace_back();
    for (const uint32_t c : components) way.triangles.back().push_back(std::move(triangles[c]));
  }
  way.discount = wished_discounts(cut.position, cut.triangle, cut.clean_vertex, {false, {}, options.prefer.mirror});
  return way;
}

struct SheetLayout {
  size_t cut = 0;
  std::vector<Chart> charts;
};

/// The components of one sheet in the plane, cut in one of the ways: where all tastes start.
std::vector<Chart> laid_out(const CutWay& way, size_t sheet) {
  const std::vector<std::vector<uint32_t>>& components = way.triangles[sheet];
  std::vector<Chart> start(components.size());
  tbb::parallel_for(size_t{0}, start.size(), [&](size_t c) { start[c] = Developer::laid_out(way.cut, components[c]); });
  return start;
}

/// Lays the components of one sheet out and sews together again what needs no seam.
SheetLayout develop_sheet(const std::vector<CutWay>& cuts, size_t sheet, const DevelopOptions& options) {
  size_t triangles = 0;
  for (const std::vector<uint32_t>& c : cuts.front().triangles[sheet]) triangles += c.size();
  const std::vector<Way> ways = ways_for(triangles, cuts.size());
  std::vector<std::vector<Chart>> start(ways.back().cut + 1);
  tbb::parallel_for(size_t{0}, start.size(), [&](size_t c) { start[c] = laid_out(cuts[c], sheet); });
  std::vector<SheetLayout> layouts(ways.size());
  std::vector<double> cost(ways.size(), std::numeric_limits<double>::infinity());
  std::vector<std::exception_ptr> failed(ways.size());
  tbb::parallel_for(size_t{0}, ways.size(), [&](size_t i) {
    try {
      const CutWay& way = cuts[ways[i].cut];
      const std::vector<Chart>& from = start[ways[i].cut];
      std::vector<std::vector<Chart>> charts(from.size());
      tbb::parallel_for(size_t{0}, from.size(), [&](size_t c) {
        charts[c] = Developer(options, ways[i].taste, way.discount).develop_component(from[c]);
      });
      layouts[i].cut = ways[i].cut;
      for (std::vector<Chart>& of_component : charts) {
        for (Chart& chart : of_component) layouts[i].charts.push_back(std::move(chart));
      }
      merge_charts(layouts[i].charts, way.sheet,
                   {.most_energy = options.target_energy,
                    .seam_price = options.cut_price,
                    .narrow = kNarrow * options.least_cut});
      cost[i] = ways.size() > 1 ? cost_of(layouts[i].charts, options) : 0;
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
  ChartedSurface result = options.straight_cuts
                              ? straighten_layout(cut, sheet, charts, options.prefer, options.target_energy)
                              : ChartedSurface{cut, charts};
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

DevelopedSurface develop(std::span<const CutSurface> cuts, const DevelopOptions& options, const Progress& progress) {
  std::vector<CutWay> ways;
  for (const CutSurface& cut : cuts) ways.push_back(examined(cut, options));
  std::vector<SheetLayout> developed(ways.front().triangles.size());
  tbb::parallel_for(size_t{0}, developed.size(), [&](size_t i) { developed[i] = develop_sheet(ways, i, options); });
  if (progress) progress("flatten", 0.3);
  std::vector<Chart> charts;
  std::vector<size_t> choice;
  for (SheetLayout& of_sheet : developed) {
    for (Chart& chart : of_sheet.charts) {
      charts.push_back(std::move(chart));
      choice.push_back(of_sheet.cut);
    }
  }
  const CutSurface cut = put_together(cuts, choice, charts);
  const ChartedSurface result = parted_where_that_pays(cut, find_sheet(cut), std::move(charts), options);
  return assembled(result.cut, result.charts);
}

DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options, const Progress& progress) {
  return develop(std::span(&cut, 1), options, progress);
}

}  // namespace geocloth
