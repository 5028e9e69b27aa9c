// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pieces that fit into each other leave less of the image empty than one wide-spread chart. Candidates are chords
// between two vertices of an outline, short ones first; sets of them are built up one by one, a few best sets at a time
// (beam search), and judged by packing the pieces' outlines; then the chords' ends are moved to where that is best. The
// mesh is cut along its edges near the chosen chords only in the end; straight_layout.cpp then draws the seams
// straight.
#include "develop/part_panels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <set>

#include <tbb/parallel_for.h>

#include "geocloth/asset/error.h"
#include "mesh/point_math.h"
#include "mesh/predicates.h"
#include "pack/pack.h"
#include "pack/panel_piece.h"
#include "pack/ready_shape.h"

namespace geocloth {
namespace {

constexpr double kCells = 80;            // cells in which outlines are compared, by the root of the area
constexpr double kFineCells = 128;       // and where chords are moved
constexpr double kChordStep = 1.0 / 20;  // between outline vertices where chords may end, by the root of the area
constexpr double kSeamPixels = 2.35;     // on borders, per pixel of new seam, on both its sides
constexpr double kStraightened = 0.985;  // of the length of seams that follow the mesh's edges still
constexpr double kLeastPiece = 0.05;     // of all area
constexpr double kLongestChord = 1;      // by the root of the area
constexpr double kApart = 0.12;          // both ends of two chords of one chart, together, by the root of the area
constexpr double kBalance = 0.5;         // what parting off a large piece is worth, in length by the root of its area
constexpr size_t kMostChords = 80, kBeam = 12, kMostPartings = 4;
constexpr size_t kWays = 6, kWaysPerDepth = 4, kShifted = 8;  // that are worth to be carried out
constexpr double kMostDetour = 1.25;                          // of the path of edges beside its chord
constexpr size_t kMostCharts = 24;  // more are small beside the image, and lie in each other's hollows anyway
constexpr double kFine = 256;       // cells by the root of the area in which pixels are counted at most
constexpr double kNet = 0.5;        // share of pixels on borders, and
constexpr double kNetOutline = 40;  // outlines by the root of the area, of cloth that is all threads: too many to part
constexpr double kUnpacked = 1e3;   // what an image misses that cannot be
constexpr double kGivenUp = 1;      // and what it costs to give a target up for none
constexpr double kSame = 1e-6;      // mirrored partings miss the same but for rounding: the first is taken

struct Chord {
  uint32_t chart, first, second;  // places in the chart's loop
  double length;

  [[nodiscard]] std::array<uint32_t, 3> name() const { return {chart, first, second}; }
};

struct Piece {
  uint32_t chart;
  std::vector<uint32_t> loop;  // places in the chart's loop
  ReadyShape shape;
};

struct Parting {
  std::vector<std::shared_ptr<const Piece>> piece;  // most are those of other partings too
  std::vector<Chord> chord;
  double cell = 0;   // [m] of the shapes
  double added = 0;  // [m] of seam
  double utilisation = 0;

  [[nodiscard]] std::vector<std::array<uint32_t, 3>> name() const {
    std::vector<std::array<uint32_t, 3>> result;
    for (const Chord& c : chord) result.push_back(c.name());
    std::sort(result.begin(), result.end());
    return result;
  }
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

  /// Is one of the others about the same chord?
  [[nodiscard]] bool is_near(const std::vector<Chord>& others, const Chord& c) const {
    const PanelPlan& plan = plan_[c.chart];
    const auto apart = [&](uint32_t i, uint32_t j) { return gap(plan.place(i), plan.place(j)); };
    return std::any_of(others.begin(), others.end(), [&](const Chord& d) {
      return d.chart == c.chart && std::min(apart(c.first, d.first) + apart(c.second, d.second),
                                            apart(c.first, d.second) + apart(c.second, d.first)) < kApart * side_;
    });
  }

  /// The chords whose ends lie about a step further along the outline, one or both, on either side.
  [[nodiscard]] std::vector<Chord> moved(const Chord& chord, double step) const {
    const PanelPlan& plan = plan_[chord.chart];
    const auto ends_of = [&](uint32_t place) {
      return std::array{place, along(plan, place, step * side_, true), along(plan, place, step * side_, false)};
    };
    std::vector<Chord> result;
    for (const uint32_t i : ends_of(chord.first)) {
      for (const uint32_t j : ends_of(chord.second)) {
        const Chord c{chord.chart, std::min(i, j), std::max(i, j), gap(plan.place(i), plan.place(j))};
        if (i == j || c.name() == chord.name() || c.length > kLongestChord * side_) continue;
        if (stays_inside(plan, c)) result.push_back(c);
      }
    }
    return result;
  }

 private:
  /// The place where a path across the chart can end that is the first at least so far along the outline.
  [[nodiscard]] static uint32_t along(const PanelPlan& plan, uint32_t place, double way, bool forwards) {
    const auto n = static_cast<uint32_t>(plan.loop().size());
    uint32_t i = place;
    for (double gone = 0; gone < way || !plan.has_inner_edge(i);) {
      const uint32_t next = forwards ? (i + 1) % n : (i + n - 1) % n;
      gone += gap(plan.place(i), plan.place(next));
      i = next;
      if (i == place) break;
    }
    return i;
  }

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

  const std::vector<PanelPlan>& plan_;
  double area_, side_;
};

using Stretch = std::array<uint32_t, 2>;  // of a row: first and last column

/// What two rows of a shape have in common.
std::vector<Stretch> common(const std::vector<Stretch>& a, const std::vector<Stretch>& b) {
  std::vector<Stretch> result;
  for (size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    const uint32_t first = std::max(a[i][0], b[k][0]), last = std::min(a[i][1], b[k][1]);
    if (first <= last) result.push_back({first, last});
    a[i][1] < b[k][1] ? ++i : ++k;
  }
  return result;
}

/// The pixels of a shape, and those of them that miss one of their eight neighbours.
struct PixelCount {
  size_t all = 0, border = 0;
};

PixelCount count_pixels(const ChartShape& shape) {
  std::vector<std::vector<Stretch>> row(size_t{shape.height} + 2);  // with a margin
  for (const ChartShape::Run& r : shape.run) row[size_t{r.row} + 1].push_back({r.first, r.last});
  PixelCount count;
  for (std::vector<Stretch>& stretches : row) {
    std::sort(stretches.begin(), stretches.end());
    std::vector<Stretch> merged;
    for (const Stretch& s : stretches) {
      if (!merged.empty() && s[0] <= merged.back()[1] + 1) {
        merged.back()[1] = std::max(merged.back()[1], s[1]);
      } else {
        merged.push_back(s);
      }
    }
    for (const Stretch& s : merged) count.all += s[1] - s[0] + 1;
    stretches = std::move(merged);
  }
  count.border = count.all;
  for (size_t y = 1; y + 1 < row.size(); ++y) {
    for (const Stretch& s : common(common(row[y - 1], row[y]), row[y + 1])) {
      count.border -= std::max(s[1] - s[0] + 1, 2U) - 2;
    }
  }
  return count;
}

std::vector<uint32_t> whole_loop(const PanelPlan& plan) {
  std::vector<uint32_t> all(plan.loop().size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// How charts fill an image in which they lie as they are, on a board of cells that are about as large as its pixels.
class Filled {
 public:
  Filled(const std::vector<PanelPlan>& plan, double side, double pixel) {
    cell_ = std::max(pixel, side / kFine);
    for (const PanelPlan& p : plan) {
      shape_.push_back(p.shape_of(whole_loop(p), {0, 1}, cell_));
      const PixelCount count = count_pixels(shape_.back());
      all_ += static_cast<double>(count.all);
      border_ += static_cast<double>(count.border) * cell_ / pixel;  // a border is as long as it is
    }
    all_ *= cell_ / pixel * cell_ / pixel;
  }

  [[nodiscard]] double border_pixels() const { return border_; }
  [[nodiscard]] double border_share() const { return border_ / all_; }
  /// 0 where no image is large enough.
  [[nodiscard]] double utilisation(double pixel) const {
    try {
      const Packing packing = pack_shapes(shape_);
      const double scale = cell_ / pixel;
      return all_ / (packing.width * scale * packing.height * scale);
    } catch (const Error&) {
      return 0;
    }
  }

 private:
  std::vector<ChartShape> shape_;
  double cell_ = 0, all_ = 0, border_ = 0;
};

/// The root of the area.
double side_of(const std::vector<Chart>& charts) {
  double area = 0;
  for (const Chart& c : charts) area += total_area(c);
  return std::sqrt(area);
}

Filled filled_by(const std::vector<Chart>& charts, double pixel) {
  const double side = side_of(charts);
  std::vector<PanelPlan> plan;
  plan.reserve(charts.size());
  for (const Chart& c : charts) plan.emplace_back(c, side / kCells);
  return {plan, side, pixel};
}

/// The chords of a parting, in the order in which they were chosen, and what it is worth.
struct Choice {
  std::vector<Chord> chord;
  double misses;
};

class PanelParter {
 public:
  /// @param seam  [m] that there is already
  PanelParter(const std::vector<Chart>& charts, double seam, const PartingOptions& options)
      : options_(options), seam_(seam) {
    for (const Chart& c : charts) area_ += total_area(c);
    side_ = std::sqrt(area_);
    for (const Chart& c : charts) {
      plan_.emplace_back(c, std::max(options.pixel, side_ / kCells));
      outline_ += plan_.back().outline();
    }
    const Filled filled(plan_, side_, options.pixel);
    border_ = filled.border_pixels();
    most_seam_ = most_seam({0, filled.border_share(), seam_ / side_}, options_);
  }

  /// The best ways to part the charts, none like another.
  [[nodiscard]] std::vector<Choice> choose() {
    if (border_share(0) > kNet && outline_ > kNetOutline * side_) return {};
    const Parting whole = unparted(kCells);
    if (whole.utilisation >= options_.wanted) return {};
    whole_utilisation_ = whole.utilisation;
    most_misses_ = misses(whole, Ripe::now);
    const bool sparse = whole.utilisation < kSparse;  // such as ribbons: every trial takes long
    const ChordFinder finder(plan_, area_);
    const std::vector<Chord> chord = finder.find(forbidden_);
    std::vector<Parting> beam{whole}, best;
    for (size_t depth = 0; depth < kMostPartings && !beam.empty(); ++depth) {
      beam = measured(parted_further(beam, chord));
      std::vector<Parting> ripe = beam;
      shorten(ripe, kWaysPerDepth, Ripe::now);
      if (!ripe.empty()) most_misses_ = std::min(most_misses_, misses(ripe[0], Ripe::now));
      shorten(beam, sparse ? kBeam / 2 : kBeam, Ripe::not_yet);
      for (size_t i = 0; i < std::min(beam.size(), kWaysPerDepth); ++i) {
        const auto same = [&](const Parting& p) { return p.name() == beam[i].name(); };
        if (std::none_of(ripe.begin(), ripe.end(), same)) ripe.push_back(beam[i]);
      }
      std::move(ripe.begin(), ripe.end(), std::back_inserter(best));
    }
    shorten(best, sparse ? 1 : kShifted, Ripe::now);
    const Parting fine = unparted(kFineCells);
    for (Parting& p : best) shift(fine, finder, p);
    shorten(best, best.size(), Ripe::now);
    std::vector<Choice> result;
    for (Parting& p : best) {
      if (result.size() == kWays || rounded(misses(p, Ripe::now)) >= rounded(misses(fine, Ripe::now))) break;
      const auto is_like = [&](const Choice& other) {
        return other.chord.size() == p.chord.size() && std::all_of(p.chord.begin(), p.chord.end(), [&](const Chord& c) {
                 return finder.is_near(other.chord, c);
               });
      };
      if (std::any_of(result.begin(), result.end(), is_like)) continue;
      result.push_back({p.chord, misses(p, Ripe::now)});
    }
    return result;
  }

  void forbid(const Chord& c) { forbidden_.insert({c.chart, c.first, c.second}); }

  /// Vertex of the chart at a place of its loop.
  [[nodiscard]] uint32_t vertex(uint32_t chart, uint32_t place) const { return plan_[chart].loop()[place]; }

 private:
  /// Partings may be on their way to better ones.
  enum class Ripe : uint8_t { not_yet, now };

  /// Nothing parted, in so many cells by the root of the area.
  [[nodiscard]] Parting unparted(double cells) const {
    Parting result;
    result.cell = std::max(options_.pixel, side_ / cells);
    for (uint32_t c = 0; c < plan_.size(); ++c) {
      result.piece.push_back(make_piece(c, whole_loop(plan_[c]), result.cell));
    }
    measure(result);
    return result;
  }

  /// Every parting of a beam with every chord more, each once.
  [[nodiscard]] static std::vector<std::pair<const Parting*, std::vector<Chord>>> parted_further(
      const std::vector<Parting>& beam, const std::vector<Chord>& chord) {
    std::vector<std::pair<const Parting*, std::vector<Chord>>> trial;
    std::set<std::vector<std::array<uint32_t, 3>>> known;
    for (const Parting& from : beam) {
      for (const Chord& c : chord) {
        Parting further;
        further.chord = from.chord;
        further.chord.push_back(c);
        if (known.insert(further.name()).second) trial.push_back({&from, {c}});
      }
    }
    return trial;
  }

  /// Those of the partings, each with some chords more, that can be made.
  [[nodiscard]] std::vector<Parting> measured(
      const std::vector<std::pair<const Parting*, std::vector<Chord>>>& trial) const {
    std::vector<std::optional<Parting>> found(trial.size());
    tbb::parallel_for(size_t{0}, trial.size(), [&](size_t i) {
      found[i] = *trial[i].first;
      for (const Chord& c : trial[i].second) {
        if (found[i]) found[i] = parted(*found[i], c);
      }
      if (found[i]) measure(*found[i]);
    });
    std::vector<Parting> result;
    for (std::optional<Parting>& p : found) {
      if (p) result.push_back(std::move(*p));
    }
    return result;
  }

  /// Keeps the best ones.
  void shorten(std::vector<Parting>& partings, size_t count, Ripe ripe) const {
    std::stable_sort(partings.begin(), partings.end(), [&](const Parting& a, const Parting& b) {
      return rounded(misses(a, ripe)) < rounded(misses(b, ripe));
    });
    if (partings.size() > count) partings.resize(count);
  }

  /// Moves the ends of chords along the outlines as long as that makes a parting better.
  void shift(const Parting& whole, const ChordFinder& finder, Parting& parting) const {
    constexpr int kRounds = 8;
    double step = kChordStep;
    if (std::vector<Parting> finer = measured({{&whole, parting.chord}}); !finer.empty()) parting = std::move(finer[0]);
    for (int round = 0; round < kRounds && step > kChordStep / 3; ++round) {
      std::vector<std::pair<const Parting*, std::vector<Chord>>> trial;
      for (size_t k = 0; k < parting.chord.size(); ++k) {
        for (const Chord& c : finder.moved(parting.chord[k], step)) {
          trial.emplace_back(&whole, parting.chord);
          trial.back().second[k] = c;
        }
      }
      std::vector<Parting> other = measured(trial);
      shorten(other, 1, Ripe::now);
      if (!other.empty() && rounded(misses(other[0], Ripe::now)) < rounded(misses(parting, Ripe::now))) {
        parting = std::move(other[0]);
      } else {
        step /= 2;
      }
    }
  }

  [[nodiscard]] double misses(const Parting& p, Ripe ripe) const {
    const Filling f{p.utilisation, border_share(p.added), (seam_ + p.added) / side_};
    const Filling whole{whole_utilisation_, border_share(0), seam_ / side_};
    const bool gives_up = ripe == Ripe::now && gives_up_too_much(f, whole, options_);
    return misses_of(f, p.added / side_, options_) + (gives_up ? kGivenUp : 0);
  }

  [[nodiscard]] std::shared_ptr<const Piece> make_piece(uint32_t chart, std::vector<uint32_t> loop, double cell) const {
    ChartShape shape = plan_[chart].shape_of(loop, plan_[chart].up_of(loop), cell);
    return std::make_shared<const Piece>(Piece{chart, std::move(loop), make_ready(std::move(shape))});
  }

  [[nodiscard]] double pixels(double added) const {
    return area_ / (options_.pixel * options_.pixel) + (outline_ + 2 * added) / (2 * options_.pixel);
  }

  /// About the share of pixels that miss one of their eight neighbours.
  [[nodiscard]] double border_share(double added) const {
    return (border_ + kSeamPixels * added / options_.pixel) / pixels(added);
  }

  /// About how much of the image the pieces fill.
  void measure(Parting& p) const {
    std::vector<const ReadyShape*> shape;
    shape.reserve(p.piece.size());
    for (const auto& piece : p.piece) shape.push_back(&piece->shape);
    const Packing packing = pack_quickly(shape);
    const double scale = p.cell / options_.pixel;
    p.utilisation = pixels(p.added) / (((packing.width - 1) * scale + 1) * ((packing.height - 1) * scale + 1));
  }

  /// Nothing where the chord crosses others, parts off too little, or adds too much seam.
  [[nodiscard]] std::optional<Parting> parted(const Parting& from, const Chord& chord) const {
    const double added = from.added + chord.length;
    if (forbidden_.contains(chord.name())) return std::nullopt;
    if (kStraightened * (seam_ + added) > most_seam_ * side_) return std::nullopt;
    if (least_misses(border_share(added), added / side_, options_) > most_misses_) return std::nullopt;
    for (size_t i = 0; i < from.piece.size(); ++i) {
      const Piece& piece = *from.piece[i];
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
      result.chord.push_back(chord);
      result.added = added;
      result.piece[i] = make_piece(piece.chart, std::move(inner), from.cell);
      result.piece.push_back(make_piece(piece.chart, std::move(outer), from.cell));
      return result;
    }
    return std::nullopt;
  }

  PartingOptions options_;
  std::vector<PanelPlan> plan_;
  std::set<std::array<uint32_t, 3>> forbidden_;
  double seam_ = 0, outline_ = 0;  // [m]
  double border_ = 0;              // [pixels]
  double area_ = 0, side_ = 0;
  double most_seam_ = 0;
  double whole_utilisation_ = 0;
  double most_misses_ = 0;  // partings that cannot miss less are not gone on with
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

Filling filling_of(const std::vector<Chart>& charts, const Sheet& sheet, double pixel) {
  Filling filling = unpacked(charts, sheet, pixel);
  filling.utilisation = filled_by(charts, pixel).utilisation(pixel);
  return filling;
}

Filling unpacked(const std::vector<Chart>& charts, const Sheet& sheet, double pixel) {
  return {0, filled_by(charts, pixel).border_share(), seam_length(charts, sheet) / side_of(charts)};
}

double most_seam(const Filling& whole, const PartingOptions& options) {
  return std::max(options.most_seam, whole.seam > options.most_seam ? options.most_longer * whole.seam : 0);
}

double least_misses(double border, double new_seam, const PartingOptions& options) {
  return std::max(border / options.most_border - 1, 0.0) + options.seam_price * new_seam;
}

double misses_of(const Filling& f, double new_seam, const PartingOptions& options) {
  const double reached = std::clamp((f.utilisation - options.enough) / (options.wanted - options.enough), 0.0, 1.0);
  const double lacks = f.utilisation > 0 ? std::max(options.enough / f.utilisation - 1, 0.0) : kUnpacked;
  return lacks + options.reaching * (1 - reached) + least_misses(f.border, new_seam, options);
}

bool gives_up_too_much(const Filling& f, const Filling& whole, const PartingOptions& options) {
  constexpr double kUnknown = 0.0015;  // of the border, before pixels are found for it
  if (f.utilisation >= options.wanted) return false;
  const bool gives_up_border =
      f.border > options.most_border - kUnknown && whole.border <= options.most_border + kUnknown;
  const bool cuts_whole_cloth =
      f.seam > 0 && !(whole.seam > 0) && f.utilisation < options.much_fuller * whole.utilisation;
  return gives_up_border || cuts_whole_cloth;
}

std::vector<PartedPanels> ways_to_part(const std::vector<Chart>& charts, const Sheet& sheet,
                                       const PartingOptions& options) {
  constexpr int kRounds = 4;
  std::vector<PartedPanels> ways;
  if (!(options.pixel > 0) || charts.size() > kMostCharts) return ways;
  PanelParter parter(charts, seam_length(charts, sheet), options);
  Sheet pinned = sheet;
  for (const Chart& c : charts) {
    for (const uint32_t v : outline_loop(c)) pinned.pinned[sheet.of_vertex[c.cut_vertex[v]]] = 1;
  }
  for (int round = 0; round < kRounds && ways.empty(); ++round) {
    const std::vector<Choice> choice = parter.choose();
    if (choice.empty()) break;
    for (const auto& [chords, misses] : choice) {
      PartedPanels way{charts, pinned, misses};
      if (const std::optional<Chord> impossible = part_along(way.charts, chords, parter)) {
        parter.forbid(*impossible);
        continue;
      }
      ways.push_back(std::move(way));
    }
  }
  return ways;
}

}  // namespace geocloth
