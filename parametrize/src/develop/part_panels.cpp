// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces that fit into each other leave less of the image empty than one wide-spread chart. Candidates are chords
// between two vertices of an outline, short ones first; sets of them are built up one by one, a few best sets at a time
// (beam search), and judged by packing the pieces' outlines. The mesh is cut along its edges near the chosen chords
// only in the end; straight_layout.cpp then draws the seams straight.
#include "develop/part_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include <tbb/parallel_for.h>

#include "flatten/pack.h"
#include "flatten/panel_piece.h"
#include "mesh/point_math.h"
#include "mesh/predicates.h"

namespace geocloth {
namespace {

constexpr double kCells = 80;            // cells in which outlines are compared, by the root of the area
constexpr double kChordStep = 1.0 / 20;  // between outline vertices where chords may end, by the root of the area
constexpr double kBorderPixels = 1.25;   // per pixel of outline: slanting lines have two side by side
constexpr double kSeamPixels = 2.1;      // per pixel of new seam, on both its sides
constexpr double kStraightened = 0.985;  // of the length of seams that follow the mesh's edges still
constexpr double kLeastPiece = 0.05;     // of all area
constexpr double kLongestChord = 1;      // by the root of the area
constexpr double kApart = 0.12;          // both ends of two chords of one chart, together, by the root of the area
constexpr double kBalance = 0.5;         // what parting off a large piece is worth, in length by the root of its area
constexpr size_t kMostChords = 60, kBeam = 8, kMostPartings = 4;
constexpr double kMostDetour = 1.25;  // of the path of edges beside its chord
constexpr size_t kMostCharts = 24;    // more are small beside the image, and lie in each other's hollows anyway
constexpr double kSparse = 0.25;      // utilisation below which pixels on borders cost less than empty ones
constexpr double kSame = 1e-6;        // mirrored partings are worth the same but for rounding: the first is taken

struct Chord {
  uint32_t chart, first, second;  // places in the chart's loop
  double length;
};

struct Piece {
  uint32_t chart;
  std::vector<uint32_t> loop;  // places in the chart's loop
  ChartShape shape;
};

struct Parting {
  std::vector<Piece> piece;
  std::vector<size_t> chord;
  double added = 0;  // [m] of seam
  double utilisation = 0;
};

double rounded(double x) {
  return std::round(x / kSame);
}

double gap(const Point2& a, const Point2& b) {
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

/// Does a chord stay inside of the outline, touching it at its ends only?
bool stays_inside(const PanelPlan& plan, const Chord& chord) {
  const auto n = static_cast<uint32_t>(plan.loop().size());
  const Point2 &a = plan.place(chord.first), &b = plan.place(chord.second);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = i + 1 == n ? 0 : i + 1;
    if (i == chord.first || j == chord.first || i == chord.second || j == chord.second) continue;
    const Point2 &p = plan.place(i), &q = plan.place(j);
    if (orientation(a, b, p) * orientation(a, b, q) <= 0 && orientation(p, q, a) * orientation(p, q, b) <= 0) {
      return false;
    }
  }
  const auto is_left = [](const Point2& o, const Point2& p, const Point2& q) {
    return orientation(o, p, q) < 0;  // y is up here
  };
  const Point2& before = plan.place(chord.first == 0 ? n - 1 : chord.first - 1);
  const Point2& after = plan.place(chord.first + 1 == n ? 0 : chord.first + 1);
  const bool left_of_after = is_left(a, after, b), left_of_before = is_left(before, a, b);
  return is_left(before, a, after) ? left_of_after && left_of_before : left_of_after || left_of_before;
}

/// Where charts may be parted: chords that are short for what they part off, none near another.
class ChordFinder {
 public:
  ChordFinder(const std::vector<PanelPlan>& plan, double area) : plan_(plan), area_(area), side_(std::sqrt(area)) {}

  [[nodiscard]] std::vector<Chord> find(const std::set<std::array<uint32_t, 3>>& forbidden) const {
    std::vector<std::pair<double, Chord>> ranked;
    for (uint32_t c = 0; c < plan_.size(); ++c) rank_chords(c, ranked);
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& x, const auto& y) { return rounded(x.first) < rounded(y.first); });
    std::vector<Chord> result;
    for (const auto& [rank, wanted] : ranked) {
      if (result.size() == kMostChords) break;
      if (is_near(result, wanted)) continue;
      Chord chord = shortened(wanted);
      if (!stays_inside(plan_[chord.chart], chord)) chord = wanted;
      if (is_near(result, chord) || forbidden.contains({chord.chart, chord.first, chord.second})) continue;
      if (stays_inside(plan_[chord.chart], chord)) result.push_back(chord);
    }
    return result;
  }

 private:
  void rank_chords(uint32_t chart, std::vector<std::pair<double, Chord>>& ranked) const {
    const PanelPlan& plan = plan_[chart];
    const size_t n = plan.loop().size();
    std::vector<double> swept(n + 1, 0);  // area between the origin and the loop
    for (uint32_t i = 0; i < n; ++i) {
      const Point2 &a = plan.place(i), &b = plan.place(i + 1 == n ? 0 : i + 1);
      swept[i + 1] = swept[i] + (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    const std::vector<uint32_t> end = ends(plan);
    for (size_t i = 0; i < end.size(); ++i) {
      for (size_t j = i + 1; j < end.size(); ++j) {
        const Point2 &a = plan.place(end[i]), &b = plan.place(end[j]);
        const double length = gap(a, b);
        const double beside = swept[end[j]] - swept[end[i]] + (b[0] * a[1] - b[1] * a[0]) / 2;
        const double smaller = std::min(beside, swept[n] - beside);
        if (smaller < kLeastPiece * area_ || length > kLongestChord * side_) continue;
        ranked.push_back({(length - kBalance * std::sqrt(smaller)) / side_, {chart, end[i], end[j], length}});
      }
    }
  }

  /// Outline vertices about a step apart where a path across the chart can end.
  [[nodiscard]] std::vector<uint32_t> ends(const PanelPlan& plan) const {
    std::vector<uint32_t> result;
    const double step = kChordStep * side_;
    double since = step;
    const auto n = static_cast<uint32_t>(plan.loop().size());
    for (uint32_t i = 0; i < n; ++i) {
      if (since >= step && plan.has_inner_edge(i)) {
        result.push_back(i);
        since = 0;
      }
      since += gap(plan.place(i), plan.place(i + 1 == n ? 0 : i + 1));
    }
    return result;
  }

  /// The vertices less than half a step from one along the outline.
  [[nodiscard]] std::vector<uint32_t> around(const PanelPlan& plan, uint32_t place) const {
    const auto n = static_cast<uint32_t>(plan.loop().size());
    std::vector<uint32_t> result{place};
    for (const uint32_t step : {1U, n - 1}) {
      double way = 0;
      for (uint32_t i = place, next = (i + step) % n; next != place; i = next, next = (next + step) % n) {
        way += gap(plan.place(i), plan.place(next));
        if (way > kChordStep * side_ / 2) break;
        if (plan.has_inner_edge(next)) result.push_back(next);
      }
    }
    return result;
  }

  /// The shortest chord nearby.
  [[nodiscard]] Chord shortened(const Chord& chord) const {
    const PanelPlan& plan = plan_[chord.chart];
    Chord best = chord;
    const std::vector<uint32_t> second = around(plan, chord.second);
    for (const uint32_t i : around(plan, chord.first)) {
      for (const uint32_t j : second) {
        const double length = gap(plan.place(i), plan.place(j));
        if (i != j && rounded(length / side_) < rounded(best.length / side_)) {
          best = {chord.chart, std::min(i, j), std::max(i, j), length};
        }
      }
    }
    return best;
  }

  [[nodiscard]] bool is_near(const std::vector<Chord>& others, const Chord& c) const {
    const PanelPlan& plan = plan_[c.chart];
    const auto apart = [&](uint32_t i, uint32_t j) { return gap(plan.place(i), plan.place(j)); };
    return std::any_of(others.begin(), others.end(), [&](const Chord& d) {
      return d.chart == c.chart && std::min(apart(c.first, d.first) + apart(c.second, d.second),
                                            apart(c.first, d.second) + apart(c.second, d.first)) < kApart * side_;
    });
  }

  const std::vector<PanelPlan>& plan_;
  double area_, side_;
};

class PanelParter {
 public:
  /// @param seam  [m] that there is already
  PanelParter(const std::vector<Chart>& charts, double seam, const PartingOptions& options)
      : options_(options), seam_(seam) {
    for (const Chart& c : charts) area_ += total_area(c);
    side_ = std::sqrt(area_);
    cell_ = std::max(options.pixel, side_ / kCells);
    for (const Chart& c : charts) {
      plan_.emplace_back(c, cell_);
      outline_ += plan_.back().outline();
    }
  }

  /// How much of the image the charts fill as they lie.
  [[nodiscard]] double utilisation() const {
    Parting lying;
    for (uint32_t c = 0; c < plan_.size(); ++c) {
      lying.piece.push_back({c, {}, plan_[c].shape_of(whole_loop(c), {0, 1}, cell_)});
    }
    measure(lying);
    return lying.utilisation;
  }

  /// The chords to part along, in the order in which they were chosen.
  [[nodiscard]] std::vector<Chord> choose() {
    Parting best;
    for (uint32_t c = 0; c < plan_.size(); ++c) best.piece.push_back(make_piece(c, whole_loop(c)));
    measure(best);
    if (best.utilisation >= options_.wanted) return {};
    if (best.utilisation < kSparse) options_.most_border = 1;  // a ribbon is mostly border as it is
    const std::vector<Chord> chord = ChordFinder(plan_, area_).find(forbidden_);
    std::vector<Parting> beam{best};
    for (size_t depth = 0; depth < kMostPartings && !beam.empty(); ++depth) {
      beam = best_of(parted_further(beam, chord));
      if (!beam.empty() && rounded(worth(beam.front())) > rounded(worth(best))) best = beam.front();
    }
    std::vector<Chord> result;
    for (const size_t k : best.chord) result.push_back(chord[k]);
    return result;
  }

  void forbid(const Chord& c) { forbidden_.insert({c.chart, c.first, c.second}); }

  /// Vertex of the chart at a place of its loop.
  [[nodiscard]] uint32_t vertex(uint32_t chart, uint32_t place) const { return plan_[chart].loop()[place]; }

 private:
  [[nodiscard]] std::vector<uint32_t> whole_loop(uint32_t chart) const {
    std::vector<uint32_t> all(plan_[chart].loop().size());
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }

  /// Every parting of a beam with every chord more, each once.
  [[nodiscard]] std::vector<Parting> parted_further(const std::vector<Parting>& beam,
                                                    const std::vector<Chord>& chord) const {
    std::vector<std::pair<size_t, size_t>> trial;
    std::set<std::vector<size_t>> known;
    for (size_t b = 0; b < beam.size(); ++b) {
      for (size_t k = 0; k < chord.size(); ++k) {
        std::vector<size_t> name = beam[b].chord;
        name.push_back(k);
        std::sort(name.begin(), name.end());
        if (known.insert(std::move(name)).second) trial.emplace_back(b, k);
      }
    }
    std::vector<std::optional<Parting>> found(trial.size());
    tbb::parallel_for(size_t{0}, trial.size(), [&](size_t i) {
      const auto [b, k] = trial[i];
      found[i] = parted(beam[b], chord, k);
      if (found[i]) measure(*found[i]);
    });
    std::vector<Parting> result;
    for (std::optional<Parting>& p : found) {
      if (p) result.push_back(std::move(*p));
    }
    return result;
  }

  [[nodiscard]] std::vector<Parting> best_of(std::vector<Parting> partings) const {
    std::stable_sort(partings.begin(), partings.end(),
                     [&](const Parting& a, const Parting& b) { return rounded(worth(a)) > rounded(worth(b)); });
    if (partings.size() > kBeam) partings.resize(kBeam);
    return partings;
  }

  [[nodiscard]] double worth(const Parting& p) const {
    return std::min(p.utilisation, options_.wanted) - options_.least_gain * p.added / side_;
  }

  [[nodiscard]] Piece make_piece(uint32_t chart, std::vector<uint32_t> loop) const {
    ChartShape shape = plan_[chart].shape_of(loop, plan_[chart].up_of(loop), cell_);
    return {chart, std::move(loop), std::move(shape)};
  }

  [[nodiscard]] double pixels(double added) const {
    return area_ / (options_.pixel * options_.pixel) + (outline_ + 2 * added) / (2 * options_.pixel);
  }

  /// About the share of pixels that miss one of their eight neighbours.
  [[nodiscard]] double border_share(double added) const {
    return (kBorderPixels * outline_ + kSeamPixels * added) / options_.pixel / pixels(added);
  }

  /// About how much of the image the pieces fill.
  void measure(Parting& p) const {
    std::vector<ChartShape> shape;
    shape.reserve(p.piece.size());
    for (const Piece& piece : p.piece) shape.push_back(piece.shape);
    const Packing packing = pack_shapes(shape, PackEffort::quick);
    const double scale = cell_ / options_.pixel;
    p.utilisation = pixels(p.added) / (((packing.width - 1) * scale + 1) * ((packing.height - 1) * scale + 1));
  }

  /// Nothing where the chord crosses others, parts off too little, or adds too much seam.
  [[nodiscard]] std::optional<Parting> parted(const Parting& from, const std::vector<Chord>& chords, size_t k) const {
    const Chord& chord = chords[k];
    const double added = from.added + chord.length;
    if (kStraightened * (seam_ + added) > options_.most_seam * side_ || border_share(added) > options_.most_border)
      return std::nullopt;
    for (size_t i = 0; i < from.piece.size(); ++i) {
      const Piece& piece = from.piece[i];
      const auto begin = piece.loop.begin(), end = piece.loop.end();
      const auto a = std::find(begin, end, chord.first), b = std::find(begin, end, chord.second);
      if (piece.chart != chord.chart || a == end || b == end) continue;
      const auto [low, high] = std::minmax(a, b);
      std::vector<uint32_t> inner(low, high + 1), outer(high, end);
      outer.insert(outer.end(), begin, low + 1);
      for (const auto* loop : {&inner, &outer}) {
        if (loop->size() < 3 || plan_[piece.chart].area_of(*loop) < kLeastPiece * area_) return std::nullopt;
      }
      Parting result = from;
      result.chord.push_back(k);
      result.added = added;
      result.piece[i] = make_piece(piece.chart, std::move(inner));
      result.piece.push_back(make_piece(piece.chart, std::move(outer)));
      return result;
    }
    return std::nullopt;
  }

  PartingOptions options_;
  std::vector<PanelPlan> plan_;
  std::set<std::array<uint32_t, 3>> forbidden_;
  double seam_ = 0, outline_ = 0;  // [m]
  double area_ = 0, side_ = 0, cell_ = 0;
};

/// The length of outlines that have a mate, once each.
double seam_length(const std::vector<Chart>& charts, const Sheet& sheet) {
  struct Edge {
    uint32_t low, high;
    double length;
  };
  std::vector<Edge> edge;
  for (const Chart& c : charts) {
    const std::vector<uint32_t> loop = outline_loop(c);
    for (size_t i = 0; i < loop.size(); ++i) {
      const uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
      const auto [low, high] = std::minmax(sheet.of_vertex[c.cut_vertex[a]], sheet.of_vertex[c.cut_vertex[b]]);
      edge.push_back({low, high, distance(c.position[a], c.position[b])});
    }
  }
  std::sort(edge.begin(), edge.end(),
            [](const Edge& a, const Edge& b) { return std::pair(a.low, a.high) < std::pair(b.low, b.high); });
  double sum = 0;
  for (size_t i = 0; i + 1 < edge.size(); ++i) {
    if (edge[i].low == edge[i + 1].low && edge[i].high == edge[i + 1].high) sum += edge[i].length;
  }
  return sum;
}

/// A vertex by which a place on the outline is known in the pieces of its chart.
uint32_t find_vertex(const Chart& piece, uint32_t cut_vertex, const Point2& uv) {
  for (uint32_t v = 0; v < piece.position.size(); ++v) {
    if (piece.cut_vertex[v] == cut_vertex && piece.uv[v] == uv) return v;
  }
  return kNone;
}

/// The pieces of a chart that is cut from a to b, about straight; nothing where its edges do not allow that.
std::vector<Chart> cut_across(const Chart& chart, uint32_t a, uint32_t b) {
  const Distances d = distances(chart, {b}, on_outline(chart));
  const Point2 &p = chart.uv[a], &q = chart.uv[b];
  if (d.from[a] == kNone || d.value[a] > kMostDetour * std::hypot(p[0] - q[0], p[1] - q[1])) return {};
  std::vector<Chart> pieces = separated(opened(chart, d.path_from(a)));
  if (pieces.size() != 2) return {};
  return pieces;
}

/// The charts parted along the chords. @returns the first chord along which no path of edges runs
std::optional<Chord> part_along(std::vector<Chart>& charts, const std::vector<Chord>& chords,
                                const PanelParter& parter) {
  std::vector<std::vector<Chart>> pieces;
  pieces.reserve(charts.size());
  for (const Chart& c : charts) pieces.push_back({c});
  for (const Chord& chord : chords) {
    const Chart& whole = charts[chord.chart];
    std::vector<Chart>& own = pieces[chord.chart];
    bool done = false;
    for (size_t i = 0; i < own.size() && !done; ++i) {
      const auto end = [&](uint32_t place) {
        const uint32_t v = parter.vertex(chord.chart, place);
        return find_vertex(own[i], whole.cut_vertex[v], whole.uv[v]);
      };
      const uint32_t a = end(chord.first), b = end(chord.second);
      if (a == kNone || b == kNone) continue;
      std::vector<Chart> two = cut_across(own[i], a, b);
      if (two.empty()) return chord;
      own[i] = std::move(two[0]);
      own.push_back(std::move(two[1]));
      done = true;
    }
    if (!done) return chord;
  }
  charts.clear();
  for (std::vector<Chart>& own : pieces) {
    for (Chart& c : own) charts.push_back(std::move(c));
  }
  return std::nullopt;
}

}  // namespace

double estimated_utilisation(const std::vector<Chart>& charts, double pixel) {
  return PanelParter(charts, 0, {.pixel = pixel}).utilisation();
}

bool part_panels(std::vector<Chart>& charts, Sheet& sheet, const PartingOptions& options) {
  constexpr int kRounds = 4;
  if (!(options.pixel > 0) || charts.size() > kMostCharts) return false;
  PanelParter parter(charts, seam_length(charts, sheet), options);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Chord> chords = parter.choose();
    std::vector<uint32_t> end;
    for (const Chord& c : chords) {
      for (const uint32_t place : {c.first, c.second}) {
        end.push_back(sheet.of_vertex[charts[c.chart].cut_vertex[parter.vertex(c.chart, place)]]);
      }
    }
    const std::optional<Chord> impossible = part_along(charts, chords, parter);
    if (impossible) {
      parter.forbid(*impossible);
      continue;
    }
    for (const uint32_t v : end) sheet.pinned[v] = 1;
    return !chords.empty();
  }
  return false;
}

}  // namespace geocloth
