// SPDX-License-Identifier: GPL-3.0-or-later
// Whole numbers of pixel steps for seams whose runs must all get the same (Gu, Gortler, Hoppe 2002, section 4; here a
// seam may run in several components). Steps are first real numbers in proportion to length, with a minimum per seam,
// so that each component's outline has the perimeter of a square for its share of the area; then they are rounded;
// last, every perimeter is made even, which is a linear system over GF(2) that always has a solution. A perimeter of 2
// (w + h - 2) steps is a rectangle whose sides differ by at most one.
#include "flatten/square_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "image/seam_steps.h"

namespace geocloth {
namespace {

constexpr uint32_t kMinPerimeter = 16;  // [steps] 5 x 5 pixels: nothing in the middle touches two outline pixels
constexpr uint32_t kComfortableSteps = 3;
constexpr double kCoarsest = 1.4142;  // of the spacing wanted: crumbs leave the cloth half of its pixels

struct Run {
  uint32_t seam;
  uint32_t times;  // how often the component's outline runs over it
};

struct Seam {
  double length = 0;
  uint32_t least = 1;               // [steps] for the welded grid to be a proper mesh
  std::vector<uint32_t> component;  // that run over it, ascending
};

class SquarePlanner {
 public:
  SquarePlanner(const CutSurface& cut, std::span<const Outline> outlines, std::span<const double> area)
      : area_(area), run_(outlines.size()) {
    const std::vector<uint32_t> least = least_seam_steps(cut, outlines);
    seam_.resize(least.size());
    for (size_t s = 0; s < least.size(); ++s) seam_[s].least = least[s];
    for (uint32_t c = 0; c < outlines.size(); ++c) collect(outlines[c], c);
  }

  [[nodiscard]] double total_area() const { return std::accumulate(area_.begin(), area_.end(), 0.0); }

  /// Real-valued steps for a nominal spacing.
  void spread(double spacing) {
    wanted_.assign(seam_.size(), 0.0);
    for (size_t s = 0; s < seam_.size(); ++s) wanted_[s] = seam_[s].least;
    for (uint32_t c = 0; c < run_.size(); ++c) {
      const double perimeter = std::max<double>(kMinPerimeter, 4 * std::sqrt(area_[c]) / spacing);
      const uint32_t least = comfortable(c, perimeter) ? kComfortableSteps : 1;
      const double density = steps_per_length(c, perimeter, least);
      for (const Run& r : run_[c]) {
        const double share = std::max<double>(least, seam_[r.seam].length * density);
        wanted_[r.seam] = std::max(wanted_[r.seam], share);
      }
    }
  }

  [[nodiscard]] double pixels() const {
    double sum = 0;
    for (const auto& runs : run_) {
      double perimeter = 0;
      for (const Run& r : runs) perimeter += r.times * wanted_[r.seam];
      sum += (perimeter / 4 + 1) * (perimeter / 4 + 1);
    }
    return sum;
  }

  SquarePlan round() {
    SquarePlan plan;
    for (const double w : wanted_) plan.seam_steps.push_back(static_cast<uint32_t>(std::lround(w)));
    enlarge_small(plan);
    make_even(plan);
    for (uint32_t c = 0; c < run_.size(); ++c) {
      const uint32_t half = perimeter(plan, c) / 2 + 2;  // width + height
      plan.size.push_back({half - half / 2, half / 2});
    }
    return plan;
  }

 private:
  void collect(const Outline& outline, uint32_t c) {
    std::vector<uint32_t> seams;
    for (const OutlinePath& path : outline.path) {
      seam_[path.seam].length = path.length;
      seams.push_back(path.seam);
    }
    std::sort(seams.begin(), seams.end());
    for (const uint32_t s : seams) {
      if (run_[c].empty() || run_[c].back().seam != s) {
        run_[c].push_back({s, 0});
        seam_[s].component.push_back(c);
      }
      ++run_[c].back().times;
    }
  }

  [[nodiscard]] bool comfortable(uint32_t c, double perimeter) const {
    double sum = 0;
    for (const Run& r : run_[c]) sum += r.times * std::max(kComfortableSteps, seam_[r.seam].least);
    return sum <= perimeter;
  }

  /// The density at which the component's steps add up to its perimeter; 0 when the minima alone exceed it.
  [[nodiscard]] double steps_per_length(uint32_t c, double perimeter, uint32_t least) const {
    double total_length = 0;
    for (const Run& r : run_[c]) total_length += r.times * seam_[r.seam].length;
    double low = 0, high = perimeter / total_length;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      double sum = 0;
      for (const Run& r : run_[c]) {
        const Seam& seam = seam_[r.seam];
        sum += r.times * std::max<double>(std::max(least, seam.least), seam.length * middle);
      }
      (sum > perimeter ? high : low) = middle;
    }
    return 0.5 * (low + high);
  }

  [[nodiscard]] uint32_t perimeter(const SquarePlan& plan, uint32_t c) const {
    uint32_t sum = 0;
    for (const Run& r : run_[c]) sum += r.times * plan.seam_steps[r.seam];
    return sum;
  }

  void enlarge_small(SquarePlan& plan) const {
    for (uint32_t c = 0; c < run_.size(); ++c) {
      while (perimeter(plan, c) < kMinPerimeter) {
        const auto coarser = [&](const Run& a, const Run& b) {
          return seam_[a.seam].length / plan.seam_steps[a.seam] < seam_[b.seam].length / plan.seam_steps[b.seam];
        };
        ++plan.seam_steps[std::max_element(run_[c].begin(), run_[c].end(), coarser)->seam];
      }
    }
  }

  /// Gauss elimination over GF(2), one equation per component: the sum of the seams that it runs over an odd number of
  /// times, each plus 0 or 1 steps, is even. Seams of one component come first as pivots, long ones before short ones,
  /// so that a correction stays where it is needed.
  void make_even(SquarePlan& plan) const {
    std::vector<std::vector<uint32_t>> odd_in(seam_.size());  // per seam: equations
    for (uint32_t c = 0; c < run_.size(); ++c) {
      for (const Run& r : run_[c]) {
        if (r.times % 2 == 1) odd_in[r.seam].push_back(c);
      }
    }
    std::vector<uint32_t> order;
    for (uint32_t s = 0; s < seam_.size(); ++s) {
      if (!odd_in[s].empty()) order.push_back(s);
    }
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      if (odd_in[a].size() != odd_in[b].size()) return odd_in[a].size() < odd_in[b].size();
      return seam_[a].length > seam_[b].length;
    });
    // A basis of the column space: basis[c] has its lowest equation at c, and says which seams it is the sum of.
    struct Column {
      std::vector<uint32_t> equation, seam;
    };
    std::vector<Column> basis(run_.size());
    const auto add = [](std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
      std::vector<uint32_t> sum;
      std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(sum));
      a = std::move(sum);
    };
    const auto reduce = [&](Column& column) {
      while (!column.equation.empty() && !basis[column.equation.front()].equation.empty()) {
        const Column& pivot = basis[column.equation.front()];
        add(column.equation, pivot.equation);
        add(column.seam, pivot.seam);
      }
    };
    for (const uint32_t s : order) {
      Column column{odd_in[s], {s}};
      reduce(column);
      if (!column.equation.empty()) basis[column.equation.front()] = std::move(column);
    }
    Column wrong;
    for (uint32_t c = 0; c < run_.size(); ++c) {
      if (perimeter(plan, c) % 2 == 1) wrong.equation.push_back(c);
    }
    reduce(wrong);
    for (const uint32_t s : wrong.seam) ++plan.seam_steps[s];
  }

  std::span<const double> area_;
  std::vector<std::vector<Run>> run_;  // per component, by seam
  std::vector<Seam> seam_;
  std::vector<double> wanted_;
};

}  // namespace

SquarePlan plan_squares(const CutSurface& cut, std::span<const Outline> outlines, std::span<const double> area,
                        const FlattenOptions& options) {
  SquarePlanner planner(cut, outlines, area);
  if (options.spacing > 0) {
    planner.spread(options.spacing);
    return planner.round();
  }
  // The pixels fall as the spacing grows: bisection on its logarithm. Where small parts take more than there are, the
  // image grows.
  const double wanted = static_cast<double>(options.resolution) * options.resolution;
  const double even = std::sqrt(planner.total_area() / wanted);
  double low = even / 4, high = even * kCoarsest;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    planner.spread(middle);
    (planner.pixels() > wanted ? low : high) = middle;
  }
  return planner.round();
}

}  // namespace geocloth
