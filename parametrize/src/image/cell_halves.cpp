// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/cell_halves.h"

#include <algorithm>

namespace geocloth {

CellHalves::CellHalves(std::span<const Pixel> chain) {
  find_rectangle(chain);
  std::vector<std::vector<int32_t>> crossing(static_cast<size_t>(high_[1] - low_[1]));  // [half pixels]
  cross_rows(chain, crossing);
  for (int32_t y = 0; y < high_[1] - low_[1]; ++y) fill_row(crossing[static_cast<size_t>(y)], y);
}

CellHalves::CellHalves(std::span<const std::vector<Pixel>> chains) {
  find_rectangle(chains.front());
  std::vector<std::vector<int32_t>> crossing(static_cast<size_t>(high_[1] - low_[1]));
  for (const std::vector<Pixel>& chain : chains) cross_rows(chain, crossing);
  for (int32_t y = 0; y < high_[1] - low_[1]; ++y) fill_row(crossing[static_cast<size_t>(y)], y);
}

void CellHalves::find_rectangle(std::span<const Pixel> chain) {
  low_ = high_ = chain.front();
  for (const Pixel& p : chain) {
    low_ = {std::min(low_[0], p[0]), std::min(low_[1], p[1])};
    high_ = {std::max(high_[0], p[0]), std::max(high_[1], p[1])};
  }
  width_ = high_[0] - low_[0];
  cell_.assign(static_cast<size_t>(width_) * static_cast<size_t>(high_[1] - low_[1]), Cell{});
}

void CellHalves::cross_rows(std::span<const Pixel> chain, std::vector<std::vector<int32_t>>& crossing) {
  for (size_t i = 0; i < chain.size(); ++i) {
    const Pixel &a = chain[i], &b = chain[(i + 1) % chain.size()];
    if (a[1] == b[1]) continue;
    const int32_t row = std::min(a[1], b[1]) - low_[1];
    crossing[static_cast<size_t>(row)].push_back(a[0] + b[0] - 2 * low_[0]);
    if (a[0] == b[0]) continue;
    const bool falls_right = (b[0] > a[0]) == (b[1] > a[1]);
    at(std::min(a[0], b[0]) - low_[0], row).diagonal = falls_right ? Diagonal::right : Diagonal::left;
  }
}

void CellHalves::fill_row(std::vector<int32_t>& crossing, int32_t y) {
  std::sort(crossing.begin(), crossing.end());
  for (size_t k = 0; k + 1 < crossing.size(); k += 2) {
    // Left half: between 2 x and 2 x + 1; right half: between 2 x + 1 and 2 x + 2.
    for (int32_t half = crossing[k]; half < crossing[k + 1]; ++half) {
      Cell& cell = at(half / 2, y);
      (half % 2 == 0 ? cell.left : cell.right) = true;
    }
  }
}

}  // namespace geocloth
