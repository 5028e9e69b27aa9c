// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/seam_measure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace geocloth {
namespace {

constexpr double kReach = 1;          // [pixels] to either side, over which an outline may take its turn
constexpr double kSharp = 0.866;      // cosine of the least turn, 30 degrees
constexpr double kLeastDistance = 2;  // [pixels] between the turns of one outline
constexpr double kLeastPiece = 0.5;   // [steps] between marks

Point2 difference(const Point2& a, const Point2& b) {
  return {b[0] - a[0], b[1] - a[1]};
}

double larger_extent(const Point2& a, const Point2& b) {
  return std::max(std::abs(a[0] - b[0]), std::abs(a[1] - b[1]));
}

/// The marks that leave pieces longer than `least` between them, with both ends of the seam.
std::vector<double> piece_ends(const SeamMeasure& seam, double least) {
  std::vector<double> end{0};
  for (const double mark : seam.mark) {
    if (mark - end.back() > least && seam.arc.back() - mark > least) end.push_back(mark);
  }
  end.push_back(seam.arc.back());
  return end;
}

/// The point of the polygon at a length from its start.
Point2 point_at(std::span<const Point2> polygon, std::span<const double> arc, double at) {
  const auto after = std::upper_bound(arc.begin() + 1, arc.end() - 1, at);
  const auto i = static_cast<size_t>(after - arc.begin());
  const double whole = arc[i] - arc[i - 1], share = whole > 0 ? (at - arc[i - 1]) / whole : 0;
  const Point2 d = difference(polygon[i - 1], polygon[i]);
  return {polygon[i - 1][0] + share * d[0], polygon[i - 1][1] + share * d[1]};
}

}  // namespace

std::vector<uint32_t> sharp_turns(std::span<const Point2> polygon) {
  std::vector<double> arc{0};
  for (size_t i = 0; i + 1 < polygon.size(); ++i) {
    const Point2 d = difference(polygon[i], polygon[i + 1]);
    arc.push_back(arc.back() + std::hypot(d[0], d[1]));
  }
  struct Turn {
    double cosine;
    uint32_t vertex;
  };
  std::vector<Turn> turns;
  for (uint32_t i = 1; i + 1 < polygon.size(); ++i) {
    if (arc[i] < kReach || arc.back() - arc[i] < kReach) continue;
    const Point2 before = difference(point_at(polygon, arc, arc[i] - kReach), polygon[i]);
    const Point2 after = difference(polygon[i], point_at(polygon, arc, arc[i] + kReach));
    const double lengths = std::hypot(before[0], before[1]) * std::hypot(after[0], after[1]);
    if (!(lengths > 0)) continue;
    const double cosine = (before[0] * after[0] + before[1] * after[1]) / lengths;
    if (cosine < kSharp) turns.push_back({cosine, i});
  }
  std::stable_sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) { return a.cosine < b.cosine; });
  std::vector<uint32_t> marks;
  for (const Turn& turn : turns) {
    const auto near = [&](uint32_t other) { return std::abs(arc[other] - arc[turn.vertex]) < kLeastDistance; };
    if (std::none_of(marks.begin(), marks.end(), near)) marks.push_back(turn.vertex);
  }
  std::sort(marks.begin(), marks.end());
  return marks;
}

std::vector<SeamMeasure> measure_seams(std::span<const Outline> outlines, std::span<const Point2> uv, double spacing,
                                       size_t seam_count) {
  std::vector<SeamMeasure> seams(seam_count);
  std::vector<std::vector<uint32_t>> marks(seam_count);  // vertices
  for (const Outline& outline : outlines) {
    for (const OutlinePath& path : outline.path) {
      std::vector<Point2> run;
      for (const uint32_t v : path.vertex) run.push_back({uv[v][0] / spacing, uv[v][1] / spacing});
      if (path.reversed) std::reverse(run.begin(), run.end());
      std::vector<double>& longest = seams[path.seam].arc;  // of the segment before each vertex, for now
      longest.resize(run.size(), 0);
      for (size_t i = 1; i < run.size(); ++i) longest[i] = std::max(longest[i], larger_extent(run[i - 1], run[i]));
      for (const uint32_t i : sharp_turns(run)) marks[path.seam].push_back(i);
    }
  }
  for (size_t s = 0; s < seam_count; ++s) {
    std::partial_sum(seams[s].arc.begin(), seams[s].arc.end(), seams[s].arc.begin());
    std::sort(marks[s].begin(), marks[s].end());
    for (const uint32_t i : marks[s]) seams[s].mark.push_back(seams[s].arc[i]);
  }
  return seams;
}

uint32_t natural_steps(const SeamMeasure& seam) {
  uint32_t steps = 0;
  const std::vector<double> end = piece_ends(seam, kLeastPiece);
  for (size_t i = 0; i + 1 < end.size(); ++i) steps += static_cast<uint32_t>(std::lround(end[i + 1] - end[i]));
  return steps;
}

std::vector<double> spread_steps(const SeamMeasure& seam, uint32_t steps) {
  const double length = seam.arc.back();
  std::vector<double> end = piece_ends(seam, kLeastPiece * length / steps);
  if (end.size() > steps + size_t{1}) end = {0, length};
  const size_t pieces = end.size() - 1;
  std::vector<uint32_t> count;
  for (size_t i = 0; i < pieces; ++i) {
    count.push_back(std::max(1U, static_cast<uint32_t>(std::lround((end[i + 1] - end[i]) * steps / length))));
  }
  // The piece with the longest steps gets one more, or that with the shortest gives one away, until the sum is right.
  for (uint32_t sum = std::accumulate(count.begin(), count.end(), 0U); sum != steps;) {
    const bool more = sum < steps;
    size_t best = pieces;
    double best_length = 0;
    for (size_t i = 0; i < pieces; ++i) {
      if (!more && count[i] == 1) continue;
      const double piece = (end[i + 1] - end[i]) / (more ? count[i] : count[i] - 1);  // step length now, or after that
      if (best < pieces && (more ? piece <= best_length : piece >= best_length)) continue;
      best = i;
      best_length = piece;
    }
    count[best] += more ? 1 : -1U;
    sum += more ? 1 : -1U;
  }
  std::vector<double> at{0};
  for (size_t i = 0; i < pieces; ++i) {
    for (uint32_t k = 1; k < count[i]; ++k) at.push_back(end[i] + (end[i + 1] - end[i]) * k / count[i]);
    at.push_back(end[i + 1]);
  }
  return at;
}

}  // namespace geocloth
