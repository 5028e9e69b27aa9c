// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every part of the surface is laid out in several ways (chart_developer.h): from several first cuts, and with cuts
// chosen by several tastes. The one that costs least is taken (layout_cost.h); what needs no seam in it is sewn
// together again (merge_charts.h), seams are drawn straight (straight_layout.h), and charts that waste room are parted
// (part_panels.h).

#include "develop/develop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "cut/edge_wishes.h"
#include "develop/chart_developer.h"
#include "develop/chart_energy.h"
#include "develop/close_slits.h"
#include "develop/grain.h"
#include "develop/layout_cost.h"
#include "develop/merge_charts.h"
#include "develop/met_holes.h"
#include "develop/mixed_cut.h"
#include "develop/part_panels.h"
#include "develop/straight_layout.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kUnsettled = 1e-3;  // of the energy: what is no matter
constexpr double kNarrow = 0.3;      // of the least cut: what counts as a slit too narrow for pixels

/// What is best at the time need not be in the end, so several ways to choose cuts are tried.
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

/// A surface is cut in so many ways at most, in this order.
enum class CutKind : uint8_t { shortest, wishful, along_folds };

/// What a cut is to a part.
struct Worth {
  bool tried = true;
  CutKind kind = CutKind::shortest;
};

/// How many ways a part is worth: time grows with its triangles.
std::vector<Way> ways_for(size_t triangles, const std::vector<Worth>& worth) {
  constexpr size_t kFurther = 1'500, kAll = 4'000, kTwo = 6'000;
  const size_t plain = triangles <= kAll ? kTastes.size() : triangles <= kTwo ? 2 : 1;
  const size_t wishful = triangles <= kAll ? kWishfulTastes.size() : triangles <= kMostWithWishes ? 1 : 0;
  std::vector<Way> ways;
  for (size_t c = 0; c < worth.size(); ++c) {
    if (!worth[c].tried) continue;
    if (worth[c].kind == CutKind::wishful) {
      for (size_t i = 0; i < wishful; ++i) ways.push_back({c, kWishfulTastes.at(i)});
      continue;
    }
    for (size_t i = 0; i < plain; ++i) ways.push_back({c, kTastes.at(i)});
    if (worth[c].kind == CutKind::shortest && triangles <= kFurther) {
      for (const Taste& taste : kFurtherTastes) ways.push_back({c, taste});
    }
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
  size_t way = 0;  // of those for the sheet
  size_t cut = 0;
  std::vector<Chart> charts;
  double cost = std::numeric_limits<double>::infinity();
};

/// The components of one sheet in the plane, cut in one of the ways: where all tastes start.
std::vector<Chart> laid_out(const CutWay& way, size_t sheet) {
  const std::vector<std::vector<uint32_t>>& components = way.triangles[sheet];
  std::vector<Chart> start(components.size());
  tbb::parallel_for(size_t{0}, start.size(), [&](size_t c) { start[c] = laid_out(way.cut, components[c]); });
  return start;
}

/// Is a sheet cut alike in two ways?
bool same_cuts(const CutWay& a, const CutWay& b, size_t sheet) {
  const auto same = [&](const std::vector<uint32_t>& s, const std::vector<uint32_t>& t) {
    if (s.size() != t.size()) return false;
    const Chart p = extract_chart(a.cut, s), q = extract_chart(b.cut, t);
    return p.triangle == q.triangle && p.position == q.position;
  };
  return std::equal(a.triangles[sheet].begin(), a.triangles[sheet].end(), b.triangles[sheet].begin(),
                    b.triangles[sheet].end(), same);
}

/// Lies a sheet so far beside the mirror plane that no cut of it runs along the plane or has a mirror image on it? The
/// tastes for wished cuts are plain ones then.
bool is_beside_mirror(const CutWay& way, size_t sheet, const std::optional<MirrorPlane>& mirror) {
  if (!mirror) return true;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const std::vector<uint32_t>& component : way.triangles[sheet]) {
    for (const uint32_t t : component) {
      for (size_t i = 0; i < 3; ++i) {
        if (way.discount[3 * t + i] > 0) return false;
        const double height = mirror->height(way.cut.position[way.cut.triangle[t][i]]);
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
      }
    }
  }
  return lowest > mirror->tolerance || highest < -mirror->tolerance;
}

/// Per cut: the first one that cuts a sheet alike.
std::vector<size_t> first_alike(const std::vector<CutWay>& cuts, size_t sheet) {
  std::vector<size_t> first(cuts.size());
  for (size_t c = 0; c < cuts.size(); ++c) {
    while (first[c] < c && !same_cuts(cuts[first[c]], cuts[c], sheet)) ++first[c];
  }
  return first;
}

/// What tells sheets and their cuts apart, but for turns and mirroring: counts, and lengths and areas [m, m^2].
struct Likeness {
  static constexpr double kSame = 1e-3;  ///< files round coordinates
  std::vector<size_t> count;
  std::vector<double> size;

  /// Of sheets whose counts are the same.
  [[nodiscard]] bool is_near(const Likeness& other) const {
    const auto same = [](double a, double b) { return std::abs(a - b) <= kSame * a; };
    return std::equal(size.begin(), size.end(), other.size.begin(), other.size.end(), same);
  }
};

Likeness likeness_of(const std::vector<CutWay>& cuts, size_t sheet) {
  Likeness result;
  for (const CutWay& way : cuts) {
    for (const std::vector<uint32_t>& component : way.triangles[sheet]) {
      const Chart chart = extract_chart(way.cut, component);
      result.count.insert(result.count.end(), {chart.triangle.size(), chart.position.size()});
      result.size.insert(result.size.end(), {total_area(chart), outline_length(chart)});
    }
  }
  return result;
}

bool has_fillings(const CutWay& way, size_t sheet) {
  const auto is_filling = [&](uint32_t t) { return way.cut.hole[t] != kNone; };
  const std::vector<std::vector<uint32_t>>& components = way.triangles[sheet];
  return !way.cut.hole.empty() && std::any_of(components.begin(), components.end(), [&](const auto& c) {
    return std::any_of(c.begin(), c.end(), is_filling);
  });
}

/// What the cuts are to a sheet. Those of the surface with its holes filled come first, then those of the surface as it
/// is, which matter to sheets with holes only.
/// @param alike  as of first_alike()
/// @param along_folds  whether those along folds are tried, or the others
std::vector<Worth> worth_of(const std::vector<CutWay>& cuts, size_t sheet, const std::vector<size_t>& alike,
                            bool along_folds, const DevelopOptions& options) {
  std::vector<Worth> worth(cuts.size());
  const bool filled = has_fillings(cuts.front(), sheet);
  for (size_t c = 0; c < cuts.size(); ++c) {
    const bool of_other_surface = cuts[c].cut.hole.empty() != cuts.front().cut.hole.empty();
    if (c > 0 && cuts[c].cut.hole.empty() == cuts[c - 1].cut.hole.empty()) {
      worth[c].kind = worth[c - 1].kind == CutKind::shortest ? CutKind::wishful : CutKind::along_folds;
    }
    const bool is_other_kind = (worth[c].kind == CutKind::along_folds) != along_folds;
    if (is_other_kind || (of_other_surface && !filled)) worth[c].tried = false;
    if (alike[c] == c) continue;
    if (along_folds || (worth[c].kind == CutKind::wishful && is_beside_mirror(cuts[c], sheet, options.prefer.mirror))) {
      worth[c].tried = false;
    }
  }
  return worth;
}

/// What a sheet costs at least when it is cut open like this: its first cuts stay, and it has no distortion.
double least_cost(const std::vector<Chart>& start) {
  constexpr double kShortened = 0.97;  // of outlines that are drawn straight
  LayoutCost cost;
  double outline = 0;
  for (const Chart& c : start) {
    cost.area += total_area(c);
    outline += smooth_outline_length(c);
  }
  return kShortened * outline / 2 / std::sqrt(cost.area);
}

/// Lays the components of one sheet out and sews together again what needs no seam.
/// @param along_folds  whether its cuts are those along folds. @returns no charts when there are none such
/// @param twin  of the sheet, where one is laid out already: a pair of shoes is laid out in one way
SheetLayout develop_sheet(const std::vector<CutWay>& cuts, size_t sheet, bool along_folds,
                          const DevelopOptions& options, const SheetLayout* twin) {
  constexpr double kAsGood = 1.005;  // of its twin's cost
  size_t triangles = 0;
  for (const std::vector<uint32_t>& c : cuts.front().triangles[sheet]) triangles += c.size();
  const std::vector<size_t> alike = first_alike(cuts, sheet);
  const std::vector<Way> ways = ways_for(triangles, worth_of(cuts, sheet, alike, along_folds, options));
  if (ways.empty()) return {};
  std::vector<std::vector<Chart>> start(ways.back().cut + 1);
  std::vector<std::deque<TrialMemory>> memory(start.size());
  const auto lay_out_start = [&](size_t c) { start[c] = laid_out(cuts[c], sheet); };
  // What cuts come to is remembered where several tastes start alike.
  for (size_t c = 0; c < start.size(); ++c) {
    const auto starts_so = [&](const Way& w) { return alike[w.cut] == c; };
    if (std::count_if(ways.begin(), ways.end(), starts_so) > 1) memory[c].resize(cuts[c].triangles[sheet].size());
  }
  std::vector<SheetLayout> layouts(ways.size());
  std::vector<std::exception_ptr> failed(ways.size());
  const auto try_way = [&](size_t i) {
    try {
      const CutWay& way = cuts[ways[i].cut];
      const std::vector<Chart>& from = start[ways[i].cut];
      std::deque<TrialMemory>& of_start = memory[alike[ways[i].cut]];
      std::vector<std::vector<Chart>> charts(from.size());
      tbb::parallel_for(size_t{0}, from.size(), [&](size_t c) {
        charts[c] =
            develop_component(from[c], options, ways[i].taste, way.discount, of_start.empty() ? nullptr : &of_start[c]);
      });
      layouts[i].way = i;
      layouts[i].cut = ways[i].cut;
      for (std::vector<Chart>& of_component : charts) {
        for (Chart& chart : of_component) layouts[i].charts.push_back(std::move(chart));
      }
      merge_charts(layouts[i].charts, way.sheet,
                   {.most_energy = options.target_energy,
                    .seam_price = options.cut_price,
                    .narrow = kNarrow * options.least_cut});
      open_met_holes(layouts[i].charts);
      layouts[i].cost = cost_of(layouts[i].charts, options);
    } catch (const Error&) {
      failed[i] = std::current_exception();
    }
  };
  size_t best = 0;
  if (twin != nullptr && twin->way < ways.size()) {
    best = twin->way;
    lay_out_start(ways[best].cut);
    try_way(best);
  }
  if (twin == nullptr || !(layouts[best].cost <= kAsGood * twin->cost)) {
    const auto try_where = [&](const auto& wanted) {
      std::vector<size_t> cut, way;
      for (size_t i = 0; i < ways.size(); ++i) {
        if (!wanted(i) || !layouts[i].charts.empty() || failed[i]) continue;
        way.push_back(i);
        if (start[ways[i].cut].empty() && (cut.empty() || cut.back() != ways[i].cut)) cut.push_back(ways[i].cut);
      }
      tbb::parallel_for(size_t{0}, cut.size(), [&](size_t k) { lay_out_start(cut[k]); });
      tbb::parallel_for(size_t{0}, way.size(), [&](size_t k) { try_way(way[k]); });
      const auto costs_less = [](const SheetLayout& x, const SheetLayout& y) { return x.cost < y.cost; };
      best = static_cast<size_t>(std::min_element(layouts.begin(), layouts.end(), costs_less) - layouts.begin());
    };
    const auto is_open = [&](size_t i) { return cuts[ways[i].cut].cut.hole.empty(); };
    size_t open = 0;  // the first way with the sheet's holes cut open
    while (open < ways.size() && !is_open(open)) ++open;
    if (open == 0 || open == ways.size()) {
      try_where([](size_t) { return true; });
    } else {
      // The first taste tells which of the two is not worth the others, where it is clear.
      constexpr double kClearly = 1.05;
      try_where([](size_t i) { return i == 0; });
      lay_out_start(ways[open].cut);
      const double least = least_cost(start[ways[open].cut]);
      if (layouts[0].cost > least) try_where([&](size_t i) { return i == open; });
      if (!(layouts[0].cost > kClearly * layouts[open].cost)) try_where([&](size_t i) { return i < open; });
      if (layouts[best].cost > least && !(layouts[open].cost > kClearly * layouts[0].cost)) {
        try_where([&](size_t i) { return i > open; });
      }
    }
  }
  if (failed[best]) std::rethrow_exception(failed[best]);
  close_slits(layouts[best].charts, cuts[layouts[best].cut].sheet, options);
  return std::move(layouts[best]);
}

/// Per sheet the first one that it is a twin of, and that is none itself; or the sheet.
std::vector<size_t> find_twins(const std::vector<CutWay>& cuts) {
  std::vector<size_t> twin(cuts.front().triangles.size());
  if (twin.size() < 2) return twin;
  std::vector<Likeness> likeness(twin.size());
  tbb::parallel_for(size_t{0}, twin.size(), [&](size_t i) { likeness[i] = likeness_of(cuts, i); });
  std::map<std::vector<size_t>, std::multimap<double, size_t>> singles;  // by counts and the first size
  for (size_t i = 0; i < twin.size(); ++i) {
    std::multimap<double, size_t>& others = singles[likeness[i].count];
    const double size = likeness[i].size.front();
    twin[i] = i;
    for (auto other = others.lower_bound(size / (1 + 2 * Likeness::kSame));
         other != others.end() && other->first <= size * (1 + 2 * Likeness::kSame); ++other) {
      if (other->second < twin[i] && likeness[other->second].is_near(likeness[i])) twin[i] = other->second;
    }
    if (twin[i] == i) others.emplace(size, i);
  }
  return twin;
}

/// All sheets, twins after those that they are twins of.
std::vector<SheetLayout> develop_sheets(const std::vector<CutWay>& cuts, bool along_folds,
                                        const DevelopOptions& options) {
  const std::vector<size_t> twin = find_twins(cuts);
  std::vector<SheetLayout> developed(twin.size());
  for (const bool paired : {false, true}) {
    tbb::parallel_for(size_t{0}, twin.size(), [&](size_t i) {
      if ((twin[i] != i) == paired)
        developed[i] = develop_sheet(cuts, i, along_folds, options, paired ? &developed[twin[i]] : nullptr);
    });
  }
  return developed;
}

/// Energy by area.
double mean_energy(const std::vector<Chart>& charts) {
  LayoutCost sum;
  for (const Chart& c : charts) sum.add(c, 0);
  return sum.energy / sum.area;
}

constexpr double kMostMean = 4.0265;  // energy beyond which the stretch misses its target

/// What straight threads make of charts that several trials have in common.
class ThreadMemory {
 public:
  explicit ThreadMemory(const std::vector<Chart>& charts) : chart_(charts), known_(charts.size()) {}

  /// The same as straighten_threads() of all charts.
  void straighten(std::vector<Chart>& charts, double share) {
    std::vector<Known*> known;  // per chart
    known.reserve(charts.size());
    std::vector<uint8_t> is_taken(chart_.size(), 0);
    for (const Chart& c : charts) known.push_back(known_of(c, is_taken));
    tbb::parallel_for(size_t{0}, charts.size(), [&](size_t i) {
      if (known[i] == nullptr) return straighten_threads(charts[i], share);
      const auto [result, is_new] = known[i]->try_emplace(share);
      if (is_new) {
        straighten_threads(charts[i], share);
        result->second = charts[i].uv;
      } else {
        charts[i].uv = result->second;
      }
    });
  }

 private:
  using Known = std::map<double, std::vector<Point2>>;  // per share

  /// Layers of cloth may lie in one place, so that each chart is taken once.
  Known* known_of(const Chart& chart, std::vector<uint8_t>& is_taken) {
    for (size_t i = 0; i < chart_.size(); ++i) {
      if (is_taken[i] != 0 || chart_[i].triangle != chart.triangle || chart_[i].position != chart.position) continue;
      is_taken[i] = 1;
      return &known_[i];
    }
    return nullptr;
  }

  const std::vector<Chart>& chart_;
  std::vector<Known> known_;  // per chart
};

/// Threads meet at right angles as far as stretch leaves room for that.
/// @param share  at most, of what angles are worth
std::vector<Chart> with_straight_threads(const std::vector<Chart>& charts, double share, ThreadMemory& memory) {
  const double most = std::max(kMostMean, mean_energy(charts) + kUnsettled);
  for (const double less : {1.0, 0.7, 0.5, 0.25}) {
    std::vector<Chart> result = charts;
    memory.straighten(result, share * less);
    if (mean_energy(result) <= most) return result;
  }
  return charts;
}

/// Do threads meet at angles that are good enough on finished charts, or as good as before?
bool has_good_angles(const ThreadMeasure& now, const ThreadMeasure& before) {
  constexpr double kMedian = 0.8, kLarge = 4;  // [degrees]
  return now.angle_p50 <= std::max(kMedian, before.angle_p50) && now.angle_p95 <= std::max(kLarge, before.angle_p95);
}

/// Do threads lie well enough, or as well as before?
bool lie_well(const ThreadMeasure& now, const ThreadMeasure& before) {
  constexpr double kAnisotropy = 1.145;
  return has_good_angles(now, before) && now.anisotropy_p95 <= std::max(kAnisotropy, before.anisotropy_p95);
}

/// Where a little more cloth than may be is stretched more one way than the other, triangles that are count more, and
/// the stretch is spread to those beside them; as long as energy and angles allow that, or not at all.
void even_out_stretch(std::vector<Chart>& charts) {
  constexpr double kWanted = 1.149, kPastMending = 1.2;  // anisotropy of the 95th percentile
  constexpr double kFrom = 1.1, kPerWeight = 0.05, kMostWeight = 2;
  constexpr int kRounds = 3;
  const ThreadMeasure before = measure_threads(charts);
  if (before.anisotropy_p95 <= kWanted || before.anisotropy_p95 > kPastMending) return;
  const double most_energy = std::max(kMostMean, mean_energy(charts) + kUnsettled);
  std::vector<Chart> even = charts;
  for (int round = 0; round < kRounds; ++round) {
    tbb::parallel_for(size_t{0}, even.size(), [&](size_t i) {
      std::vector<double> times = anisotropies(even[i]);
      for (double& a : times) a = 1 + std::clamp((a - kFrom) / kPerWeight, 0.0, kMostWeight);
      straighten_threads(even[i], 1, times);
    });
    const ThreadMeasure now = measure_threads(even);
    if (now.anisotropy_p95 > kWanted) continue;
    if (mean_energy(even) <= most_energy && has_good_angles(now, before)) charts = std::move(even);
    return;
  }
}

/// Seams drawn straight, and every chart turned upright.
ChartedSurface straightened(const CutSurface& cut, const Sheet& sheet, const std::vector<Chart>& charts,
                            const DevelopOptions& options) {
  ChartedSurface result = options.straight_cuts
                              ? straighten_layout(cut, sheet, charts, options.prefer, options.target_energy)
                              : ChartedSurface{cut, charts};
  tbb::parallel_for(size_t{0}, result.charts.size(), [&](size_t i) { turn_upright(result.charts[i]); });
  return result;
}

/// A way to part charts, carried out.
struct PartingTrial {
  ChartedSurface parted;
  bool is_bent = false;  // so that threads drawn straight change its outlines
  bool is_over = false;
  // With threads as straight as they are at the time:
  std::vector<Chart> charts;
  Filling filling;
};

/// The same, with charts parted where the image comes nearer to what it is to be. What that brings is measured on the
/// finished charts: a piece may come to hang otherwise than was thought, and threads drawn straight bend charts that
/// were to lie in each other's hollows, so that pieces keep more of their own shape where angles allow that.
ChartedSurface parted_where_that_pays(const CutSurface& cut, const Sheet& sheet, const std::vector<Chart>& charts,
                                      const DevelopOptions& options) {
  constexpr double kLeastGain = 0.02, kBetter = 1e-3;  // less may be rounding's choice
  constexpr double kBent = 1;                          // [degrees]
  const PartingOptions& parting = options.parting;
  const ChartedSurface loose = straightened(cut, sheet, charts, options);
  ThreadMemory memory(loose.charts);
  ChartedSurface best{loose.cut, with_straight_threads(loose.charts, 1, memory)};
  if (!(parting.pixel > 0)) return best;
  const double more_border =
      unpacked(best.charts, find_sheet(best.cut), parting.pixel).border -
      unpacked(loose.charts, find_sheet(loose.cut), parting.pixel).border;  // of straight threads
  PartingOptions before_threads = parting;
  before_threads.most_border -= std::max(more_border, 0.0);
  const std::vector<PartedPanels> ways = ways_to_part(loose.charts, find_sheet(loose.cut), before_threads);
  if (ways.empty()) return best;
  const Filling whole = filling_of(best.charts, find_sheet(best.cut), parting.pixel);
  const ThreadMeasure before = measure_threads(best.charts);
  double least = misses_of(whole, 0, parting) - kLeastGain;
  std::vector<PartingTrial> trials(ways.size());
  tbb::parallel_for(size_t{0}, ways.size(), [&](size_t i) {
    PartingTrial& t = trials[i];
    t.is_over = ways[i].promise >= least;
    if (t.is_over) return;
    t.parted = straightened(loose.cut, ways[i].sheet, ways[i].charts, options);
    const Filling f = unpacked(t.parted.charts, find_sheet(t.parted.cut), parting.pixel);
    t.is_over = least_misses(f.border + more_border, f.seam - whole.seam, parting) >= least;
    t.is_bent = measure_threads(t.parted.charts).angle_p95 > kBent;
  });
  for (const double share : {1.0, 0.5, 0.25}) {
    for (PartingTrial& t : trials) {
      if (!t.is_over) t.charts = with_straight_threads(t.parted.charts, share, memory);
    }
    tbb::parallel_for(size_t{0}, trials.size(), [&](size_t i) {
      PartingTrial& t = trials[i];
      if (t.is_over) return;
      // Threads that are less straight lie no better, and charts that keep more of their shape have no less border.
      const Sheet of_trial = find_sheet(t.parted.cut);
      const Filling f = unpacked(t.charts, of_trial, parting.pixel);
      t.is_over =
          !lie_well(measure_threads(t.charts), before) || least_misses(f.border, f.seam - whole.seam, parting) >= least;
      if (!t.is_over) t.filling = filling_of(t.charts, of_trial, parting.pixel);
    });
    for (PartingTrial& t : trials) {
      if (t.is_over) continue;
      const double misses = misses_of(t.filling, t.filling.seam - whole.seam, parting);
      const bool within_limits =
          t.filling.seam <= most_seam(whole, parting) && !gives_up_too_much(t.filling, whole, parting);
      if (within_limits && misses < least) {
        least = misses - kBetter;
        best = {t.parted.cut, t.charts};
      }
      t.is_over = !t.is_bent || t.filling.utilisation >= parting.wanted;
    }
  }
  return best;
}

/// The same with layers of cloth cut from each other all along their folds, as a tailor would cut a cushion, where that
/// costs little enough to be looked at. Nothing when there is no such place.
std::vector<SheetLayout> with_layers_apart(const std::vector<CutWay>& cuts, const std::vector<SheetLayout>& developed,
                                           const DevelopOptions& options) {
  constexpr double kMostCost = 1.5;  // of the other way's
  std::vector<SheetLayout> layered = develop_sheets(cuts, true, options);
  bool is_other = false;
  for (size_t i = 0; i < layered.size(); ++i) {
    const bool is_worth_it = !layered[i].charts.empty() && layered[i].cost < kMostCost * developed[i].cost;
    if (!is_worth_it) layered[i] = developed[i];
    is_other = is_other || is_worth_it;
  }
  return is_other ? layered : std::vector<SheetLayout>{};
}

ChartedSurface finished(std::span<const CutSurface> cuts, const std::vector<SheetLayout>& developed,
                        const DevelopOptions& options) {
  std::vector<Chart> charts;
  std::vector<size_t> choice;
  for (const SheetLayout& of_sheet : developed) {
    charts.insert(charts.end(), of_sheet.charts.begin(), of_sheet.charts.end());
    choice.insert(choice.end(), of_sheet.charts.size(), of_sheet.cut);
  }
  const CutSurface cut = put_together(cuts, choice, charts);
  return parted_where_that_pays(cut, find_sheet(cut), charts, options);
}

/// With no more distortion than there may be, or than the other has.
bool fills_better(const ChartedSurface& surface, const ChartedSurface& other, const PartingOptions& options) {
  if (mean_energy(surface.charts) > std::max(kMostMean, mean_energy(other.charts) + kUnsettled)) return false;
  if (!lie_well(measure_threads(surface.charts), measure_threads(other.charts))) return false;
  const Filling f = filling_of(surface.charts, find_sheet(surface.cut), options.pixel);
  const Filling g = filling_of(other.charts, find_sheet(other.cut), options.pixel);
  return misses_of(f, f.seam - g.seam, options) < misses_of(g, 0, options);
}

}  // namespace

DevelopedSurface develop(std::span<const CutSurface> cuts, const DevelopOptions& options, const Progress& progress) {
  std::vector<CutWay> ways;
  for (const CutSurface& cut : cuts) ways.push_back(examined(cut, options));
  const std::vector<SheetLayout> developed = develop_sheets(ways, false, options);
  if (progress) progress("flatten", 0.3);
  ChartedSurface result = finished(cuts, developed, options);
  try {
    const std::vector<SheetLayout> layered = with_layers_apart(ways, developed, options);
    if (!layered.empty()) {
      ChartedSurface other = finished(cuts, layered, options);
      if (fills_better(other, result, options.parting)) result = std::move(other);
    }
  } catch (const Error&) {  // some piece between folds has no layout; the whole has one
  }
  even_out_stretch(result.charts);
  // Threads drawn straight may have turned a chart as a whole.
  for (Chart& c : result.charts)
    if (is_askew(c)) turn_upright(c);
  open_met_holes(result.charts);
  return assembled(result.cut, result.charts);
}

DevelopedSurface develop(const CutSurface& cut, const DevelopOptions& options, const Progress& progress) {
  return develop(std::span(&cut, 1), options, progress);
}

}  // namespace geocloth
