// SPDX-License-Identifier: GPL-3.0-or-later
// A pixel that stands beside its sample drags the grid along the outline. Samples of equal distance cannot stand beside
// the pixels of several charts that run at different angles to the lattice, so they slide: in turn with the pixels
// inside (grid_relaxation.h) every sample goes along its seam to where the energy of all the grids around its copies is
// least. The chains of pixels stay, and with them the topology.

#include "image/seam_slide.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "image/grid_relaxation.h"

namespace geocloth {
namespace {

constexpr double kLeastGap = 0.4;  // [steps] between neighbouring samples
constexpr int kSlideRounds = 20;

/// The place on a side at a length along its seam, and its derivative.
struct Place {
  Point2 at, along;
};

class Slider {
 public:
  Slider(std::span<const std::vector<Pixel>> chain, std::vector<SlidingSeam>& seams) : chain_(chain), seams_(seams) {
    std::vector<std::vector<Point2>> place(chain.size());
    for (size_t c = 0; c < chain.size(); ++c) place[c].resize(chain[c].size());
    for (const SlidingSeam& seam : seams) {
      for (const SeamSide& side : seam.side) {
        for (size_t k = 0; k < seam.places.at.size(); ++k) {
          place[side.chart][side.sample[k]] = place_on(seam, side, seam.places.at[k]).at;
        }
      }
    }
    for (size_t c = 0; c < chain.size(); ++c) grid_.emplace_back(chain[c], place[c]);
  }

  void run() {
    for (int round = 0; round < kSlideRounds; ++round) {
      tbb::parallel_for(size_t{0}, grid_.size(), [&](size_t c) { grid_[c].sweep(); });
      for (SlidingSeam& seam : seams_) {
        for (size_t k = 1; k + 1 < seam.places.at.size(); ++k) {
          if (!std::binary_search(seam.mark.begin(), seam.mark.end(), seam.places.at[k])) slide(seam, k);
        }
      }
    }
  }

 private:
  static Place place_on(const SlidingSeam& seam, const SeamSide& side, double at) {
    const auto after = std::upper_bound(seam.places.arc.begin() + 1, seam.places.arc.end() - 1, at);
    const auto i = static_cast<size_t>(after - seam.places.arc.begin());
    const double whole = seam.places.arc[i] - seam.places.arc[i - 1];
    const Point2 &a = side.curve[i - 1], &b = side.curve[i];
    const Point2 along = whole > 0 ? Point2{(b[0] - a[0]) / whole, (b[1] - a[1]) / whole} : Point2{0, 0};
    const double share = at - seam.places.arc[i - 1];
    return {{a[0] + share * along[0], a[1] + share * along[1]}, along};
  }

  [[nodiscard]] uint32_t pixel(const SeamSide& side, size_t k) const {
    return grid_[side.chart].index(chain_[side.chart][side.sample[k]]);
  }

  void put(const SlidingSeam& seam, size_t k, double at) {
    for (const SeamSide& side : seam.side) grid_[side.chart].move(pixel(side, k), place_on(seam, side, at).at);
  }

  [[nodiscard]] double energy(const SlidingSeam& seam, size_t k) const {
    double sum = 0;
    for (const SeamSide& side : seam.side) sum += grid_[side.chart].energy(pixel(side, k));
    return sum;
  }

  void slide(SlidingSeam& seam, size_t k) {
    double first = 0, second = 0;
    for (const SeamSide& side : seam.side) {
      const GridSlope s = grid_[side.chart].slope(pixel(side, k));
      const Point2 d = place_on(seam, side, seam.places.at[k]).along;
      first += s.gradient[0] * d[0] + s.gradient[1] * d[1];
      second += s.hessian[0] * d[0] * d[0] + 2 * s.hessian[1] * d[0] * d[1] + s.hessian[2] * d[1] * d[1];
    }
    if (!(second > 0)) return;
    const double gap = kLeastGap * seam.places.arc.back() / static_cast<double>(seam.places.at.size() - 1);
    const double low = seam.places.at[k - 1] + gap, high = seam.places.at[k + 1] - gap;
    if (low >= high) return;
    const double old = seam.places.at[k], before = energy(seam, k);
    for (const double share : {1.0, 0.5, 0.25, 0.125}) {
      const double trial = std::clamp(old - share * first / second, low, high);
      put(seam, k, trial);
      if (energy(seam, k) < before) {
        seam.places.at[k] = trial;
        return;
      }
    }
    put(seam, k, old);
  }

  std::span<const std::vector<Pixel>> chain_;
  std::vector<SlidingSeam>& seams_;
  std::vector<GridRelaxation> grid_;
};

}  // namespace

void slide_samples(std::span<const std::vector<Pixel>> chain, std::vector<SlidingSeam>& seams) {
  Slider(chain, seams).run();
}

}  // namespace geocloth
