// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "cpu/cloth_state.h"
#include "cpu/self_set.h"

namespace geocloth::cpu {

/// first <= k < last of the points in the order of a PointGrid.
struct PointPiece {
  uint32_t first, last;
};

/// Points of self-collision in the order of the cells of lib/self_collide.h that they lie in: along x within a row of
/// cells, rows along y within a layer. So all that may be near a cell lies in nine pieces.
class PointGrid {
 public:
  /// A point that lies in no cell.
  static constexpr int32_t kNowhere = std::numeric_limits<int32_t>::min();
  /// Cell by cell the cloth whose points lie there, where several collide; of points of more than one, or of one cloth
  /// with itself:
  static constexpr uint32_t kAnyCloth = std::numeric_limits<uint32_t>::max();

  PointGrid(size_t points, uint32_t slot);

  struct Cells {
    std::vector<int32_t> x, y, z;  ///< of each point; x kNowhere: in none
  };
  /// Lowest and highest cells.
  struct Bounds {
    std::array<int32_t, 3> low, high;
  };
  /// Sorts the points of a cloth, or of several.
  /// @param position  of each point
  /// @return whether there is room for their numbers: the points may be too far from each other
  [[nodiscard]] bool sort(const shader::SelfSet& set, const shader::SelfRoom& room, const Cells& cells,
                          const Bounds& bounds, const Vec3Array& position);

  [[nodiscard]] uint32_t point_count() const { return static_cast<uint32_t>(keys_.size()); }
  /// The points in their order, with kOverhang more entries, and where they are.
  [[nodiscard]] const std::vector<uint32_t>& point() const { return point_; }
  [[nodiscard]] const Vec3Array& position() const { return position_; }
  [[nodiscard]] uint32_t cell_count() const { return static_cast<uint32_t>(cells_.size() - 1); }
  [[nodiscard]] PointPiece points_of(uint32_t cell) const { return {cells_[cell].first, cells_[cell + 1].first}; }
  /// The first cell none of whose points comes before the k-th.
  [[nodiscard]] uint32_t cell_from(uint32_t k) const;
  [[nodiscard]] size_t memory_bytes() const;

 private:
  friend class CellsAround;
  struct Cell {
    uint32_t first;  ///< of its points
    int32_t x;
    uint32_t cloth = kAnyCloth;
    bool full = false;  ///< with all that share its bucket: it is left out
  };
  struct Row {
    int64_t number;  ///< neighbours along y have the next ones
    uint32_t first_cell;
  };

  bool sort_keys(const Cells& cells, const Bounds& bounds, uint32_t points, uint32_t point_bits);
  void order_keys(uint32_t key_bits, uint32_t point_bits);
  void list_cells(const shader::SelfSet& set, const Cells& cells, const Bounds& bounds, const Vec3Array& position,
                  uint32_t point_bits);
  void mark_full(const shader::SelfRoom& room, const Cells& cells);

  std::vector<uint32_t> point_;
  Vec3Array position_;
  std::vector<Cell> cells_;  ///< and one for the end
  std::vector<Row> rows_;    ///< and one for the end
  int64_t layer_ = 0;        ///< from a row's number to that of its neighbour along z
  std::vector<uint64_t> keys_, other_keys_;
  std::vector<uint32_t> filled_;  ///< points in each bucket of the hash
};

/// Looks from one cell after another, in their order, at those around it and itself.
class CellsAround {
 public:
  /// @param cell  the first one, if there is one
  CellsAround(const PointGrid& grid, uint32_t cell);

  /// Goes to this cell, the next one or the first.
  /// @return the points in the cells around, but in full ones and in those of the same single cloth
  [[nodiscard]] std::span<const PointPiece> go_to(uint32_t cell);

 private:
  struct Window {
    uint32_t cell, end;  ///< of a row
  };
  void go_to_row(uint32_t row);

  const PointGrid& grid_;
  uint32_t row_ = 0;
  std::array<uint32_t, 3> beside_{};  ///< first row along y beside the row, in the layers around
  std::array<Window, 9> windows_{};
  uint32_t window_count_ = 0;
  std::array<PointPiece, 27> pieces_{};
};

}  // namespace geocloth::cpu
