// SPDX-License-Identifier: GPL-3.0-or-later
// A hole's rim is sampled as the outline of a chart that was the filling (panel_layout.cpp): in steps of about a pixel,
// corners among them, and a closed chain of as many pixels (pixel_chain.cpp). It has no mate, so that its samples slide
// along it to where they are nearest to their pixels. Chains meet neither each other nor the outline: the grid between
// them is a disk with as many holes.
#include "flatten/open_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "flatten/panel_layout.h"
#include "flatten/take_mesh.h"
#include "image/chain_targets.h"
#include "image/chart_chain.h"
#include "image/chart_outline.h"
#include "image/lattice_shift.h"
#include "image/seam_measure.h"
#include "image/seam_samples.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/refined_mesh.h"

namespace geocloth {
namespace {

constexpr uint32_t kLeastRimSteps = 4;
constexpr double kHalf = 0.5;         // [pixels]
constexpr double kLeastRimGap = 0.4;  // [steps] between neighbouring samples

/// A hole in a chart's plane.
struct Rim {
  uint32_t hole = 0, chart = 0;
  std::vector<uint32_t> vertex;  ///< around the filling, counter-clockwise seen with v up; the first comes last again
  std::vector<Point2> curve;     ///< per vertex [pixels]
  SeamPlaces places;             ///< of the samples, both ends included
  std::vector<double> mark;
  std::vector<Pixel> chain;  ///< per sample but the last
};

/// What the pixels of one chart are taken by, and the diagonals of its cells.
class ChartBoard {
 public:
  explicit ChartBoard(const FlatChart& chart) : width_(chart.width), height_(chart.height) {
    inside_.assign(std::size_t{width_} * height_, 0);
    diagonal_.assign(inside_.size(), 0);
    const std::vector<std::vector<uint32_t>> crossing = row_crossings(chart);
    for (uint32_t y = 0; y < height_; ++y) {
      for (std::size_t k = 0; k + 1 < crossing[y].size(); k += 2) {
        for (uint32_t x = crossing[y][k]; x <= crossing[y][k + 1]; ++x) inside_[std::size_t{y} * width_ + x] = 1;
      }
    }
    std::vector<Pixel> chain;
    for (const OutlineSample& s : chart.outline)
      chain.push_back({static_cast<int32_t>(s.x), static_cast<int32_t>(s.y)});
    take(chain);
  }

  /// Are the pixels inside, free, and do no two diagonals cross?
  [[nodiscard]] bool has_room(const std::vector<Pixel>& chain) const {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Pixel &p = chain[i], &q = chain[(i + 1) % chain.size()];
      if (p[0] < 0 || p[1] < 0 || p[0] >= int64_t{width_} || p[1] >= int64_t{height_}) return false;
      if (inside_[index(p)] == 0) return false;
      if (is_diagonal(p, q) && diagonal_[cell(p, q)] != 0) return false;
    }
    return true;
  }
  void take(const std::vector<Pixel>& chain) {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const Pixel &p = chain[i], &q = chain[(i + 1) % chain.size()];
      inside_[index(p)] = 0;
      if (is_diagonal(p, q)) diagonal_[cell(p, q)] = 1;
    }
  }

 private:
  [[nodiscard]] static bool is_diagonal(const Pixel& p, const Pixel& q) { return p[0] != q[0] && p[1] != q[1]; }
  [[nodiscard]] std::size_t index(const Pixel& p) const {
    return static_cast<std::size_t>(p[1]) * width_ + static_cast<std::size_t>(p[0]);
  }
  [[nodiscard]] std::size_t cell(const Pixel& p, const Pixel& q) const {
    return index({std::min(p[0], q[0]), std::min(p[1], q[1])});
  }

  uint32_t width_, height_;
  std::vector<uint8_t> inside_, diagonal_;  // per pixel: free and inside; of the cell to its right and below: is used
};

class HoleOpener {
 public:
  HoleOpener(FlatSurface& flat, std::span<const uint32_t> hole) : flat_(flat) {
    for (const uint32_t t : flat.clean_triangle) {
      hole_of_.push_back(hole[t]);
      if (hole[t] != kNone) name_.push_back(hole[t]);
    }
    std::sort(name_.begin(), name_.end());
    name_.erase(std::unique(name_.begin(), name_.end()), name_.end());
    for (uint32_t& h : hole_of_) {
      if (h != kNone) h = static_cast<uint32_t>(std::lower_bound(name_.begin(), name_.end(), h) - name_.begin());
    }
    stuck_.assign(name_.size(), 0);
    rim_.resize(name_.size());
  }

  std::vector<uint32_t> run() {
    trace_rims();
    if (none_is_stuck()) {
      for (Rim& rim : rim_) place_samples(rim);
      find_chains();
    }
    std::vector<uint32_t> stuck;
    for (uint32_t h = 0; h < stuck_.size(); ++h) {
      if (stuck_[h] != 0) stuck.push_back(name_[h]);
    }
    if (stuck.empty()) open();
    return stuck;
  }

 private:
  [[nodiscard]] bool none_is_stuck() const { return std::find(stuck_.begin(), stuck_.end(), 1) == stuck_.end(); }

  /// Follows the rim of every hole; those that a cut meets are stuck.
  void trace_rims() {
    const std::vector<uint32_t> opposite = opposite_half_edges(flat_.triangle);
    std::vector<uint8_t> on_outline(flat_.position.size(), 0);
    for (uint32_t h = 0; h < opposite.size(); ++h) {
      if (opposite[h] == kNone) on_outline[tail(flat_.triangle, h)] = on_outline[head(flat_.triangle, h)] = 1;
    }
    std::vector<uint32_t> next(flat_.position.size(), kNone), edges(rim_.size(), 0);
    for (uint32_t h = 0; h < opposite.size(); ++h) {
      const uint32_t hole = hole_of_[h / 3];
      if (hole == kNone) continue;
      const uint32_t from = tail(flat_.triangle, h);
      if (on_outline[from] != 0) stuck_[hole] = 1;
      if (opposite[h] == kNone || hole_of_[opposite[h] / 3] == hole) continue;
      next[from] = head(flat_.triangle, h);
      Rim& rim = rim_[hole];
      rim.hole = hole;
      rim.chart = flat_.chart[h / 3];
      if (edges[hole]++ == 0 || from < rim.vertex[0]) rim.vertex.assign(1, from);
    }
    for (Rim& rim : rim_) {
      if (stuck_[rim.hole] != 0 || rim.vertex.empty()) continue;
      for (uint32_t k = 0; k < edges[rim.hole]; ++k) rim.vertex.push_back(next[rim.vertex.back()]);
      if (rim.vertex.back() != rim.vertex[0]) stuck_[rim.hole] = 1;
    }
    for (uint32_t h = 0; h < rim_.size(); ++h) {
      if (edges[h] < 3) stuck_[h] = 1;
    }
  }

  void place_samples(Rim& rim) {
    begin_at_sharpest_corner(rim);
    for (const uint32_t v : rim.vertex) rim.curve.push_back(flat_.uv[v]);
    OutlinePath path;
    path.vertex = rim.vertex;
    const Outline outline{{path}};
    const SeamMeasure measure = measure_seams(std::span(&outline, 1), flat_.uv, 1, 1).front();
    const uint32_t steps = std::max(kLeastRimSteps, natural_steps(measure));
    rim.places = {measure.arc, spread_steps(measure, steps)};
    rim.mark = measure.mark;
  }

  void begin_at_sharpest_corner(Rim& rim) const {
    constexpr double kClearly = 1e-3;  // [rad]
    rim.vertex.pop_back();
    const std::size_t n = rim.vertex.size();
    std::size_t best = 0;
    double sharpest = -kInfinity;
    for (std::size_t i = 0; i < n; ++i) {
      const Point2 &p = flat_.uv[rim.vertex[i]], a = p - flat_.uv[rim.vertex[(i + n - 1) % n]],
                   b = flat_.uv[rim.vertex[(i + 1) % n]] - p;
      const double turn = std::abs(std::atan2(a[0] * b[1] - a[1] * b[0], dot(a, b)));
      if (turn <= sharpest + kClearly) continue;
      sharpest = turn;
      best = i;
    }
    std::rotate(rim.vertex.begin(), rim.vertex.begin() + static_cast<std::ptrdiff_t>(best), rim.vertex.end());
    rim.vertex.push_back(rim.vertex[0]);
  }

  [[nodiscard]] static Point2 place_at(const Rim& rim, double at) {
    const std::vector<double>& arc = rim.places.arc;
    const auto after = std::upper_bound(arc.begin() + 1, arc.end() - 1, at);
    const auto i = static_cast<std::size_t>(after - arc.begin());
    const double whole = arc[i] - arc[i - 1], share = whole > 0 ? (at - arc[i - 1]) / whole : 0;
    const Point2 d = rim.curve[i] - rim.curve[i - 1];
    return {rim.curve[i - 1][0] + share * d[0], rim.curve[i - 1][1] + share * d[1]};
  }

  /// Small holes first: they have the least choice.
  void find_chains() {
    std::vector<ChartBoard> board;
    for (const FlatChart& chart : flat_.charts) board.emplace_back(chart);
    std::vector<uint32_t> order(rim_.size());
    for (uint32_t h = 0; h < order.size(); ++h) order[h] = h;
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return rim_[a].places.at.size() < rim_[b].places.at.size(); });
    for (const uint32_t h : order) {
      Rim& rim = rim_[h];
      if (!find_chain(rim, board[rim.chart])) stuck_[h] = 1;
    }
  }

  /// A chain beside its rim, or where others are in the way a little nearer to the hole's middle or to the side.
  [[nodiscard]] bool find_chain(Rim& rim, ChartBoard& board) {
    std::vector<Point2> sample;
    Point2 middle{0, 0};
    for (std::size_t k = 0; k + 1 < rim.places.at.size(); ++k) {
      sample.push_back(place_at(rim, rim.places.at[k]));
      for (std::size_t x = 0; x < 2; ++x) middle[x] += sample.back()[x];
    }
    for (double& x : middle) x /= static_cast<double>(sample.size());
    const std::vector<Point2> target = chain_targets(sample);
    // A straight rim between two lines of pixels would waver; the whole hole moves to one of them.
    Point2 to_lattice = shift_to_lattice(target);
    for (double& x : to_lattice) x -= x > kHalf ? 1 : 0;
    struct Change {
      double scale, right, down;
    };
    constexpr std::array kChanges{Change{1, 0, 0},        Change{0.9, 0, 0},       Change{0.8, 0, 0},
                                  Change{1, 0.5, 0},      Change{1, -0.5, 0},      Change{1, 0, 0.5},
                                  Change{1, 0, -0.5},     Change{0.8, 0.5, 0.5},   Change{0.8, -0.5, 0.5},
                                  Change{0.8, 0.5, -0.5}, Change{0.8, -0.5, -0.5}, Change{0.65, 0, 0}};
    for (const Change& change : kChanges) {
      std::vector<Point2> wanted;
      for (const Point2& p : target) {
        const Point2 d = p - middle;
        wanted.push_back({middle[0] + to_lattice[0] + change.scale * d[0] + change.right,
                          middle[1] + to_lattice[1] + change.scale * d[1] + change.down});
      }
      const ChartChain placed = place_chart(std::move(wanted));
      if (placed.chain.result != PixelChain::Result::found || !board.has_room(placed.chain.pixel)) continue;
      rim.chain = placed.chain.pixel;
      board.take(rim.chain);
      slide(rim);
      return true;
    }
    return false;
  }

  /// Moves samples along the rim towards their pixels; corners stay.
  static void slide(Rim& rim) {
    constexpr int kSweeps = 10;
    std::vector<double>& at = rim.places.at;
    const double gap = kLeastRimGap * rim.places.arc.back() / static_cast<double>(at.size() - 1);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t k = 1; k + 1 < at.size(); ++k) {
        if (std::binary_search(rim.mark.begin(), rim.mark.end(), at[k])) continue;
        const double low = at[k - 1] + gap, high = at[k + 1] - gap;
        if (low < high) at[k] = nearest_between(rim, rim.chain[k], low, high);
      }
    }
  }

  /// Where between two places of a rim it is nearest to a pixel.
  [[nodiscard]] static double nearest_between(const Rim& rim, const Pixel& pixel, double low, double high) {
    const std::vector<double>& arc = rim.places.arc;
    const Point2 p{static_cast<double>(pixel[0]), static_cast<double>(pixel[1])};
    double best = low, least = kInfinity;
    for (std::size_t i = 1; i < arc.size(); ++i) {
      const double begin = std::max(low, arc[i - 1]), end = std::min(high, arc[i]);
      if (begin > end) continue;
      const Point2 a = place_at(rim, begin), b = place_at(rim, end), d = b - a;
      const double squared = dot(d, d), s = squared > 0 ? std::clamp(dot(p - a, d) / squared, 0.0, 1.0) : 0;
      const Point2 at{a[0] + s * d[0], a[1] + s * d[1]};
      const double away = dot(p - at, p - at);
      if (away >= least) continue;
      least = away;
      best = begin + s * (end - begin);
    }
    return best;
  }

  /// Leaves the fillings out and puts vertices on the rims for the samples.
  void open() {
    RefinedMesh mesh = without_fillings();
    std::vector<Outline> outlines;
    std::vector<uint32_t> steps;
    std::vector<SeamPlaces> places;
    for (const Rim& rim : rim_) {
      // As the cloth has it, on its right-hand side.
      OutlinePath path;
      path.seam = static_cast<uint32_t>(steps.size());
      path.reversed = true;
      for (const uint32_t v : rim.vertex) path.vertex.push_back(number_[v]);
      std::reverse(path.vertex.begin(), path.vertex.end());
      outlines.push_back({{std::move(path)}});
      steps.push_back(static_cast<uint32_t>(rim.chain.size()));
      places.push_back(rim.places);
    }
    const std::size_t before = mesh.position.size();
    const std::vector<SampledOutline> sampled = insert_seam_samples(mesh, outlines, steps, places);
    flat_.uv.resize(mesh.position.size());
    for (std::size_t r = 0; r < rim_.size(); ++r) take_samples(rim_[r], sampled[r], before);
    take_mesh(flat_, std::move(mesh));
    set_spacing(flat_);
  }

  RefinedMesh without_fillings() {
    RefinedMesh mesh;
    number_.assign(flat_.position.size(), kNone);
    std::vector<uint8_t> used(flat_.position.size(), 0);
    for (std::size_t t = 0; t < flat_.triangle.size(); ++t) {
      if (hole_of_[t] != kNone) continue;
      for (const uint32_t v : flat_.triangle[t]) used[v] = 1;
    }
    std::vector<Point2> uv;
    for (uint32_t v = 0; v < number_.size(); ++v) {
      if (used[v] == 0) continue;
      number_[v] = static_cast<uint32_t>(mesh.position.size());
      mesh.position.push_back(flat_.position[v]);
      mesh.point.push_back(flat_.point[v]);
      mesh.clean_vertex.push_back(flat_.clean_vertex[v]);
      uv.push_back(flat_.uv[v]);
    }
    flat_.uv = std::move(uv);
    mesh.point_count = flat_.point_count;
    for (std::size_t t = 0; t < flat_.triangle.size(); ++t) {
      if (hole_of_[t] != kNone) continue;
      const Triangle& k = flat_.triangle[t];
      mesh.triangle.push_back({number_[k[0]], number_[k[1]], number_[k[2]]});
      mesh.component.push_back(flat_.chart[t]);
      mesh.clean_triangle.push_back(flat_.clean_triangle[t]);
    }
    for (FlatChart& chart : flat_.charts) {
      for (OutlineSample& s : chart.outline) s.vertex = number_[s.vertex];
    }
    mesh.opposite = opposite_half_edges(mesh.triangle);
    mesh.leaving.assign(mesh.position.size(), kNone);
    for (uint32_t h = 0; h < mesh.opposite.size(); ++h) {
      if (mesh.opposite[h] == kNone) mesh.leaving[tail(mesh.triangle, h)] = h;
    }
    return mesh;
  }

  /// @param before  how many vertices there were before any was inserted
  void take_samples(const Rim& rim, const SampledOutline& outline, std::size_t before) {
    std::vector<OutlineSample>& loop = flat_.charts[rim.chart].holes.emplace_back();
    const std::size_t n = rim.chain.size();
    for (const OutlineStop& stop : outline.stop) {
      const bool is_sample = stop.step == std::floor(stop.step);
      const std::size_t k = (n - static_cast<std::size_t>(stop.step)) % n;
      if (stop.vertex >= before) flat_.uv[stop.vertex] = place_at(rim, rim.places.at[k]);
      if (!is_sample) continue;
      loop.push_back({static_cast<uint32_t>(rim.chain[k][0]), static_cast<uint32_t>(rim.chain[k][1]), stop.vertex});
    }
  }

  FlatSurface& flat_;
  std::vector<uint32_t> hole_of_;  // per triangle
  std::vector<uint32_t> name_;     // per hole, as they are counted here
  std::vector<Rim> rim_;           // per hole
  std::vector<uint8_t> stuck_;     // per hole
  std::vector<uint32_t> number_;   // per vertex, once the fillings are out
};

}  // namespace

std::vector<uint32_t> holes_on_cuts(const CutSurface& cut) {
  const std::vector<uint32_t> opposite = opposite_half_edges(cut.triangle);
  std::vector<uint8_t> on_outline(cut.position.size(), 0);
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    if (opposite[h] == kNone) on_outline[tail(cut.triangle, h)] = on_outline[head(cut.triangle, h)] = 1;
  }
  std::vector<uint32_t> met;
  for (std::size_t t = 0; t < cut.triangle.size(); ++t) {
    if (cut.hole.empty() || cut.hole[t] == kNone) continue;
    const Triangle& k = cut.triangle[t];
    if (std::any_of(k.begin(), k.end(), [&](uint32_t v) { return on_outline[v] != 0; })) met.push_back(cut.hole[t]);
  }
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  return met;
}

std::vector<uint32_t> open_holes(FlatSurface& flat, std::span<const uint32_t> hole) {
  return HoleOpener(flat, hole).run();
}

}  // namespace geocloth
