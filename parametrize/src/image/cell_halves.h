// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "image/pixel_chain.h"

namespace geocloth {

/// The cells of the rectangle around a closed chain of outline pixels, each as a left and a right half (apart only
/// where the chain crosses the cell): which of them lie inside the chain.
class CellHalves {
 public:
  enum class Diagonal : uint8_t { none, right, left };  ///< right: falling to the right, left: rising
  struct Cell {
    bool left = false, right = false;
    Diagonal diagonal = Diagonal::none;
  };

  explicit CellHalves(std::span<const Pixel> chain);
  /// @param chains  the first, and those around holes inside of it
  explicit CellHalves(std::span<const std::vector<Pixel>> chains);

  [[nodiscard]] const Pixel& low() const { return low_; }
  [[nodiscard]] const Pixel& high() const { return high_; }

  /// The cell to the right of p and below it.
  [[nodiscard]] Cell get(const Pixel& p) const {
    if (p[0] < low_[0] || p[1] < low_[1] || p[0] >= high_[0] || p[1] >= high_[1]) return {};
    return cell_[static_cast<size_t>((p[1] - low_[1]) * width_ + p[0] - low_[0])];
  }
  /// Calls visit(pixel, dx, dy) for every right angle of the halves inside of the cell to the right of p and below it:
  /// the pixel at the angle, whose sides run from there by dx columns and by dy rows.
  template <class Visit>
  void for_right_angles(const Pixel& p, const Visit& visit) const {
    const Cell cell = get(p);
    // Of the half below a diagonal that falls, only the lower left corner is a right angle, and so on.
    if (cell.left && cell.diagonal != Diagonal::right) visit(p, 1, 1);
    if (cell.left && cell.diagonal != Diagonal::left) visit(Pixel{p[0], p[1] + 1}, 1, -1);
    if (cell.right && cell.diagonal != Diagonal::left) visit(Pixel{p[0] + 1, p[1]}, -1, 1);
    if (cell.right && cell.diagonal != Diagonal::right) visit(Pixel{p[0] + 1, p[1] + 1}, -1, -1);
  }
  /// Is there surface on both sides of the edge from p to the right, or downwards?
  [[nodiscard]] bool inner_right(const Pixel& p) const {
    const Cell below = get(p), above = get({p[0], p[1] - 1});
    return (below.diagonal == Diagonal::right ? below.right : below.left) &&
           (above.diagonal == Diagonal::left ? above.right : above.left);
  }
  [[nodiscard]] bool inner_down(const Pixel& p) const { return get(p).left && get({p[0] - 1, p[1]}).right; }
  /// Is the cell to the right of p and below it inside as a whole?
  [[nodiscard]] bool whole(const Pixel& p) const {
    const Cell cell = get(p);
    return cell.left && cell.right;
  }

 private:
  Cell& at(int32_t x, int32_t y) { return cell_[static_cast<size_t>(y * width_ + x)]; }
  void find_rectangle(std::span<const Pixel> chain);
  void cross_rows(std::span<const Pixel> chain, std::vector<std::vector<int32_t>>& crossing);
  void fill_row(std::vector<int32_t>& crossing, int32_t y);

  Pixel low_{}, high_{};
  int32_t width_ = 0;
  std::vector<Cell> cell_;
};

}  // namespace geocloth
