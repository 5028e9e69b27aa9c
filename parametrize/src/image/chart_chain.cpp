// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/chart_chain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/chain_conflicts.h"

namespace geocloth {
namespace {

/// Twice the area inside a closed chain, positive when it runs counter-clockwise seen with v up.
int64_t chain_area(const std::vector<Pixel>& chain) {
  int64_t sum = 0;
  for (size_t i = 0; i < chain.size(); ++i) {
    const Pixel &a = chain[i], &b = chain[(i + 1) % chain.size()];
    sum += int64_t{b[0]} * a[1] - int64_t{a[0]} * b[1];
  }
  return sum;
}

void place(ChartChain& chart, std::vector<Pixel> start) {
  chart.chain = place_chain(chart.target, chart.apart, std::move(start));
  if (chart.chain.result == PixelChain::Result::found && chain_area(chart.chain.pixel) <= 0) {
    chart.chain.result = PixelChain::Result::crowded;
  }
}

/// Samples that are neighbours on the lattice but lie far apart in the plane: a spring between them would be long.
std::vector<ApartSamples> overstretched(const ChartChain& chart) {
  constexpr double kLongest = 1.8;  // [pixels]
  std::vector<std::pair<Pixel, uint32_t>> place;
  const auto count = static_cast<uint32_t>(chart.chain.pixel.size());
  for (uint32_t i = 0; i < count; ++i) place.emplace_back(chart.chain.pixel[i], i);
  std::sort(place.begin(), place.end());
  std::vector<ApartSamples> pairs;
  for (const auto& [p, i] : place) {
    for (const Pixel& q : {Pixel{p[0] + 1, p[1]}, Pixel{p[0], p[1] + 1}}) {
      const auto other = std::lower_bound(place.begin(), place.end(), std::pair<Pixel, uint32_t>(q, 0));
      if (other == place.end() || other->first != q) continue;
      const uint32_t low = std::min(i, other->second), high = std::max(i, other->second);
      if (high - low == 1 || high - low == count - 1) continue;
      const Point2 &a = chart.target[low], &b = chart.target[high];
      if (std::hypot(a[0] - b[0], a[1] - b[1]) > kLongest) pairs.push_back({low, high, 2});
    }
  }
  return pairs;
}

/// Moves such samples apart where that is possible.
void part_overstretched(ChartChain& chart) {
  constexpr int kTries = 3;
  std::vector<ApartSamples> pairs = overstretched(chart);
  for (int attempt = 0; attempt < kTries && !pairs.empty(); ++attempt) {
    ChartChain trial = chart;
    trial.apart.insert(trial.apart.end(), pairs.begin(), pairs.end());
    place(trial, chart.chain.pixel);
    std::vector<ApartSamples> left = overstretched(trial);
    if (trial.chain.result != PixelChain::Result::found || left.size() >= pairs.size()) return;
    chart = std::move(trial);
    pairs = std::move(left);
  }
}

}  // namespace

ChartChain place_chart(std::vector<Point2> target) {
  ChartChain chart{std::move(target), {}, {}};
  place(chart, {});
  if (chart.chain.result == PixelChain::Result::found) part_overstretched(chart);
  return chart;
}

std::vector<size_t> part_pinches(std::span<const std::vector<uint32_t>> points, std::vector<ChartChain>& charts) {
  constexpr int kNudges = 24;
  std::vector<PointChain> chains(charts.size());
  for (size_t c = 0; c < charts.size(); ++c) chains[c].point = points[c];
  std::vector<size_t> pinched;
  for (int nudge = 0; nudge < kNudges; ++nudge) {
    for (size_t c = 0; c < charts.size(); ++c) chains[c].pixel = charts[c].chain.pixel;
    pinched.clear();
    for (const ChainConflict& conflict : chain_conflicts(chains)) {
      charts[conflict.chart].apart.push_back(conflict.samples);
      if (pinched.empty() || pinched.back() != conflict.chart) pinched.push_back(conflict.chart);
    }
    if (pinched.empty()) return {};
    std::vector<size_t> failed;
    for (const size_t c : pinched) {
      std::vector<ApartSamples>& apart = charts[c].apart;
      std::sort(apart.begin(), apart.end());
      apart.erase(std::unique(apart.begin(), apart.end()), apart.end());
      place(charts[c], charts[c].chain.pixel);
      if (charts[c].chain.result != PixelChain::Result::found) failed.push_back(c);
    }
    if (!failed.empty()) return failed;
  }
  return pinched;
}

}  // namespace geocloth
