// SPDX-License-Identifier: Apache-2.0
// Points are sorted by the numbers of their cells (radix sort, with the points' own numbers in the lower bits): rows of
// cells and the pieces of them around a cell then follow from going along, and nothing is looked up.

#include "cpu/point_grid.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace geocloth::cpu {
namespace {

constexpr uint32_t kDigitBits = 11;
constexpr uint32_t kDigits = 1U << kDigitBits;

uint64_t extent(const PointGrid::Bounds& bounds, size_t axis) {
  return static_cast<uint64_t>(int64_t{bounds.high[axis]} - bounds.low[axis] + 1);
}

/// One column more than there are, so that the last one of a row has no neighbour in the next.
int64_t layer_of(const PointGrid::Bounds& bounds) {
  return static_cast<int64_t>(extent(bounds, 1)) + 1;
}

int64_t row_number(const PointGrid::Cells& cells, const PointGrid::Bounds& bounds, uint32_t point) {
  return (int64_t{cells.z[point]} - bounds.low[2]) * layer_of(bounds) + (int64_t{cells.y[point]} - bounds.low[1]);
}

}  // namespace

/// Frames after the first one allocate nothing.
PointGrid::PointGrid(size_t points, uint32_t slot)
    : point_(points + kOverhang, 0), position_(points + kOverhang, slot) {
  cells_.reserve(points + 1);
  rows_.reserve(points + 1);
  keys_.reserve(points);
  other_keys_.reserve(points);
}

bool PointGrid::sort(const shader::SelfSet& set, const shader::SelfRoom& room, const Cells& cells, const Bounds& bounds,
                     const Vec3Array& position) {
  const auto point_bits = static_cast<uint32_t>(std::bit_width(room.points));
  if (!sort_keys(cells, bounds, room.points, point_bits)) return false;
  list_cells(set, cells, bounds, position, point_bits);
  mark_full(room, cells);
  return true;
}

bool PointGrid::sort_keys(const Cells& cells, const Bounds& bounds, uint32_t points, uint32_t point_bits) {
  keys_.clear();
  if (bounds.low[0] > bounds.high[0]) return true;  // all are nowhere
  const uint64_t along = extent(bounds, 0), layer = static_cast<uint64_t>(layer_of(bounds));
  const auto key_bits =
      static_cast<uint32_t>(std::bit_width(along) + std::bit_width(layer) + std::bit_width(extent(bounds, 2)));
  if (key_bits + point_bits > 64) return false;
  for (uint32_t k = 0; k < points; ++k) {
    if (cells.x[k] == kNowhere) continue;
    const auto cell = static_cast<uint64_t>(row_number(cells, bounds, k)) * along +
                      static_cast<uint64_t>(int64_t{cells.x[k]} - bounds.low[0]);
    keys_.push_back(cell << point_bits | k);
  }
  const uint64_t cell_numbers = along * layer * extent(bounds, 2);
  order_keys(static_cast<uint32_t>(std::bit_width(cell_numbers)), point_bits);
  return true;
}

/// By the bits above those of the points, which are in order already.
void PointGrid::order_keys(uint32_t key_bits, uint32_t point_bits) {
  other_keys_.resize(keys_.size());
  for (uint32_t bit = 0; bit < key_bits; bit += kDigitBits) {
    const uint32_t shift = point_bits + bit;
    std::array<uint32_t, kDigits> place{};
    for (const uint64_t key : keys_) ++place[key >> shift & (kDigits - 1)];
    uint32_t sum = 0;
    for (uint32_t& p : place) sum += std::exchange(p, sum);
    for (const uint64_t key : keys_) other_keys_[place[key >> shift & (kDigits - 1)]++] = key;
    keys_.swap(other_keys_);
  }
}

void PointGrid::list_cells(const shader::SelfSet& set, const Cells& cells, const Bounds& bounds,
                           const Vec3Array& position, uint32_t point_bits) {
  const uint32_t count = point_count();
  const uint64_t point_mask = (uint64_t{1} << point_bits) - 1;
  layer_ = layer_of(bounds);
  cells_.clear();
  rows_.clear();
  uint64_t last_cell = 0;
  for (uint32_t k = 0; k < count; ++k) {
    const auto point = static_cast<uint32_t>(keys_[k] & point_mask);
    const uint64_t cell = keys_[k] >> point_bits;
    if (k == 0 || cell != last_cell) {
      const int64_t row = row_number(cells, bounds, point);
      if (k == 0 || row != rows_.back().number) rows_.push_back({row, static_cast<uint32_t>(cells_.size())});
      cells_.push_back({.first = k, .x = cells.x[point]});
      last_cell = cell;
    }
    if (set.between) {
      uint32_t& cloth = cells_.back().cloth;
      const uint32_t own = self_point(set, point).inter_cloth;
      cloth = cells_.back().first == k || cloth == own ? own : kAnyCloth;
    }
    point_[k] = point;
    position_.set(k, position.at(point));
  }
  rows_.push_back({std::numeric_limits<int64_t>::max(), static_cast<uint32_t>(cells_.size())});
  cells_.push_back({.first = count, .x = 0});
}

void PointGrid::mark_full(const shader::SelfRoom& room, const Cells& cells) {
  const auto bucket = [&](const Cell& cell) {
    const uint32_t point = point_[cell.first];
    return shader::self_hash(room,
                             {static_cast<uint32_t>(cells.x[point]), static_cast<uint32_t>(cells.y[point]),
                              static_cast<uint32_t>(cells.z[point])},
                             0);
  };
  filled_.assign(room.buckets, 0);
  for (uint32_t c = 0; c < cell_count(); ++c) filled_[bucket(cells_[c])] += cells_[c + 1].first - cells_[c].first;
  for (uint32_t c = 0; c < cell_count(); ++c) cells_[c].full = filled_[bucket(cells_[c])] > room.most_in_bucket;
}

uint32_t PointGrid::cell_from(uint32_t k) const {
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), k,
                                      [](const Cell& cell, uint32_t number) { return cell.first < number; });
  return static_cast<uint32_t>(found - cells_.begin());
}

size_t PointGrid::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  return bytes(point_) + 3 * bytes(position_.x) + bytes(cells_) + bytes(rows_) + bytes(keys_) + bytes(other_keys_) +
         bytes(filled_);
}

CellsAround::CellsAround(const PointGrid& grid, uint32_t cell) : grid_(grid) {
  const std::vector<PointGrid::Row>& rows = grid.rows_;
  const auto next = std::upper_bound(rows.begin(), rows.end(), cell,
                                     [](uint32_t c, const PointGrid::Row& row) { return c < row.first_cell; });
  if (next == rows.end()) return;  // no cell
  const auto row = static_cast<uint32_t>(next - rows.begin() - 1);
  for (uint32_t k = 0; k < beside_.size(); ++k) {
    const int64_t first = rows[row].number + (int64_t{k} - 1) * grid.layer_ - 1;
    const auto found = std::lower_bound(rows.begin(), rows.end(), first,
                                        [](const PointGrid::Row& r, int64_t number) { return r.number < number; });
    beside_[k] = static_cast<uint32_t>(found - rows.begin());
  }
  go_to_row(row);
}

void CellsAround::go_to_row(uint32_t row) {
  const std::vector<PointGrid::Row>& rows = grid_.rows_;
  row_ = row;
  window_count_ = 0;
  for (uint32_t k = 0; k < beside_.size(); ++k) {
    const int64_t middle = rows[row].number + (int64_t{k} - 1) * grid_.layer_;
    while (rows[beside_[k]].number < middle - 1) ++beside_[k];
    for (uint32_t r = beside_[k]; rows[r].number <= middle + 1; ++r)
      windows_[window_count_++] = {rows[r].first_cell, rows[r + 1].first_cell};
  }
}

std::span<const PointPiece> CellsAround::go_to(uint32_t cell) {
  const std::vector<PointGrid::Cell>& cells = grid_.cells_;
  if (cell >= grid_.rows_[row_ + 1].first_cell) go_to_row(row_ + 1);
  const int64_t x = cells[cell].x;
  const uint32_t own = cells[cell].cloth;
  size_t count = 0;
  for (Window& window : std::span(windows_).first(window_count_)) {
    while (window.cell < window.end && cells[window.cell].x < x - 1) ++window.cell;
    for (uint32_t c = window.cell; c < window.end && cells[c].x <= x + 1; ++c) {
      if (cells[c].full || (own != PointGrid::kAnyCloth && cells[c].cloth == own)) continue;
      const PointPiece piece = grid_.points_of(c);
      if (count > 0 && pieces_[count - 1].last == piece.first) {
        pieces_[count - 1].last = piece.last;
      } else {
        pieces_[count++] = piece;
      }
    }
  }
  return std::span(pieces_).first(count);
}

}  // namespace geocloth::cpu
