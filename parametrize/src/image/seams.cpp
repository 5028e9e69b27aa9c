// SPDX-License-Identifier: GPL-3.0-or-later
// From sampled pixels to a simulation image. Pixels of one surface point become a row of the split-vertex table (the
// "cut path sideband" of Gu, Gortler, Hoppe 2002, one row per point instead of one entry per path, so that pockets,
// bow ties and T-junctions of seams fit as well). Cells are split by the shorter diagonal, as there, unless that would
// repeat an edge of the welded mesh: around the end of a cut the two sides of the cut lie next to each other, and two
// diagonals chosen apart may close a pocket of zero area.
#include "geocloth/parametrize/seams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "geocloth/asset/grid_mesh.h"
#include "image/chart_outline.h"
#include "image/pixel_areas.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

using PixelPair = std::array<uint32_t, 2>;

PixelPair sorted(uint32_t a, uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

struct PixelPairHash {
  std::size_t operator()(const PixelPair& p) const {
    uint64_t h = (uint64_t{p[0]} << 32U | p[1]) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(h ^ (h >> 32U));
  }
};

/// What the steps below share: the inputs, the asset under construction, and who is whose copy.
struct Image {
  const FlatSurface& flat;
  const Raster& raster;
  ClothAsset& asset;
  std::vector<uint32_t> first_copy{};   ///< per pixel
  std::vector<ChartOutline> outline{};  ///< per chart

  [[nodiscard]] bool copies(uint32_t a, uint32_t b) const { return first_copy[a] == first_copy[b]; }
  [[nodiscard]] bool on_outline(uint32_t pixel) const { return raster.vertex[pixel] != kNone; }
  [[nodiscard]] bool same_chart(uint32_t a, uint32_t b) const {
    return asset.valid(a) && asset.chart[a] == asset.chart[b];
  }
  [[nodiscard]] Point2 place(uint32_t pixel) const {
    return pixel_in_chart(flat.charts[asset.chart[pixel]], pixel % asset.width, pixel / asset.width);
  }
  /// May a spring or a triangle edge join the two pixels?
  [[nodiscard]] bool linked(uint32_t a, uint32_t b) const {
    return same_chart(a, b) && !copies(a, b) && outline[asset.chart[a]].holds(place(a), place(b));
  }
};

void copy_pixels(const FlatSurface& flat, const Raster& raster, ClothAsset& asset) {
  asset.width = raster.width;
  asset.height = raster.height;
  asset.chart = raster.chart;
  asset.chart_count = static_cast<uint32_t>(flat.charts.size());
  asset.rest_position.assign(asset.pixel_count(), Vec3{});
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) continue;
    asset.rest_position[i] = to_single(raster.position[i]);
  }
}

/// The spring length that the atlas stands for: side of a square of area / cells.
float nominal_spacing(const FlatSurface& flat) {
  double area = 0, cells = 0;
  for (const Triangle& t : flat.triangle) {
    area += triangle_area(flat.position[t[0]], flat.position[t[1]], flat.position[t[2]]);
    cells += signed_area_twice(flat.uv[t[0]], flat.uv[t[1]], flat.uv[t[2]]) / 2;
  }
  return static_cast<float>(std::sqrt(area / std::max(cells, 1.0)));
}

SplitVertexTable split_vertices(const Raster& raster, uint32_t point_count) {
  std::vector<uint32_t> pixels_of(point_count, 0);
  for (const uint32_t p : raster.point) {
    if (p != kNone) ++pixels_of[p];
  }
  // Pixels are met in ascending order: a row is opened by its first pixel and filled in order.
  SplitVertexTable table;
  std::vector<uint32_t> next(point_count, kNone);
  for (const uint32_t p : raster.point) {
    if (p == kNone || pixels_of[p] < 2 || next[p] != kNone) continue;
    if (table.offset.empty()) table.offset.push_back(0);
    next[p] = table.offset.back();
    table.offset.push_back(table.offset.back() + pixels_of[p]);
  }
  table.pixel.resize(table.offset.empty() ? 0 : table.offset.back());
  for (uint32_t i = 0; i < raster.point.size(); ++i) {
    const uint32_t p = raster.point[i];
    if (p != kNone && next[p] != kNone) table.pixel[next[p]++] = i;
  }
  return table;
}

// ---------------------------------------------------------------------------------------------------- springs

void mark_springs(const Image& image) {
  ClothAsset& asset = image.asset;
  asset.spring_mask.assign(asset.pixel_count(), 0);
  for (uint32_t y = 0; y < asset.height; ++y) {
    for (uint32_t x = 0; x < asset.width; ++x) {
      const uint32_t i = y * asset.width + x;
      if (!asset.valid(i)) continue;
      for (uint32_t s = 0; s < kSpringCount; ++s) {
        const int64_t to_x = int64_t{x} + kSpringOffset[s][0], to_y = int64_t{y} + kSpringOffset[s][1];
        if (to_x < 0 || to_x >= asset.width || to_y >= asset.height) continue;
        const auto j = static_cast<uint32_t>(to_y * asset.width + to_x);
        if (image.linked(i, j)) asset.spring_mask[i] = static_cast<uint8_t>(asset.spring_mask[i] | (1U << s));
      }
    }
  }
}

bool has_spring(const ClothAsset& asset, uint32_t pixel, SpringBit bit) {
  return (asset.spring_mask[pixel] & bit) != 0;
}

// ---------------------------------------------------------------------------------------------------- cells

/// Corners of a cell and which of them are joined by springs:
///     a - b     "right" is the diagonal a-d, "left" is b-c.
///     |   |
///     c - d
struct Cell {
  uint32_t a, b, c, d;
  bool ab, ac, bd, cd, ad, bc;

  Cell(const ClothAsset& asset, uint32_t i)
      : a(i),
        b(i + 1),
        c(i + asset.width),
        d(i + asset.width + 1),
        ab(has_spring(asset, a, kSpringRight)),
        ac(has_spring(asset, a, kSpringDown)),
        bd(has_spring(asset, b, kSpringDown)),
        cd(has_spring(asset, c, kSpringRight)),
        ad(has_spring(asset, a, kSpringDownRight)),
        bc(has_spring(asset, b, kSpringDownLeft)) {}

  [[nodiscard]] bool closed() const { return ab && ac && bd && cd; }
};

/// Chooses the diagonals one after the other and remembers the edges that the welded mesh has so far. Only edges with
/// a split end can be repeated, so only those are kept.
class CellSplitter {
 public:
  explicit CellSplitter(const Image& image) : image_(image), asset_(image.asset) {}

  void split_all() {
    asset_.cell.assign(asset_.pixel_count(), 0);
    split_.assign(asset_.pixel_count(), false);
    settled_.assign(asset_.pixel_count(), false);
    for (const uint32_t pixel : asset_.splits.pixel) split_[pixel] = true;
    keep_structural_edges();
    for (uint32_t y = 0; y + 1 < asset_.height; ++y) {
      for (uint32_t x = 0; x + 1 < asset_.width; ++x) {
        const uint32_t i = y * asset_.width + x;
        if (!settle(i)) leave_open(i);
      }
    }
    // A settled cell can take away a choice of others near a seam: they are asked before any further choice.
    for (const uint32_t i : open_) ask_again(i);
    for (const uint32_t i : open_) {
      if (!settled_[i]) decide(i);
    }
  }

 private:
  enum Diagonal : uint8_t { none = 0, right = 1, left = 2, both = 3 };

  void keep_structural_edges() {
    for (uint32_t i = 0; i < asset_.pixel_count(); ++i) {
      if (has_spring(asset_, i, kSpringRight)) keep(i, i + 1);
      if (has_spring(asset_, i, kSpringDown)) keep(i, i + asset_.width);
    }
  }

  [[nodiscard]] bool may_repeat(uint32_t p, uint32_t q) const { return split_[p] || split_[q]; }
  void keep(uint32_t p, uint32_t q) {
    if (may_repeat(p, q)) edges_.insert(sorted(image_.first_copy[p], image_.first_copy[q]));
  }
  [[nodiscard]] bool exists(uint32_t p, uint32_t q) const {
    return may_repeat(p, q) && edges_.contains(sorted(image_.first_copy[p], image_.first_copy[q]));
  }

  /// Diagonals with which the cell is covered by two triangles.
  [[nodiscard]] Diagonal possible_diagonals(const Cell& k) const {
    if (!k.closed()) return none;
    const unsigned r = k.ad && !exists(k.a, k.d) ? right : none;
    const unsigned l = k.bc && !exists(k.b, k.c) ? left : none;
    return static_cast<Diagonal>(r | l);
  }

  /// Splits the cell if it has no choice or if its choice matters to no other cell.
  [[nodiscard]] bool settle(uint32_t i) {
    const Cell k(asset_, i);
    const Diagonal possible = possible_diagonals(k);
    if (possible == both && (may_repeat(k.a, k.d) || may_repeat(k.b, k.c))) return false;
    choose(k, possible);
    return true;
  }

  [[nodiscard]] PixelPair edge(uint32_t p, uint32_t q) const {
    return sorted(image_.first_copy[p], image_.first_copy[q]);
  }

  void leave_open(uint32_t i) {
    open_.push_back(i);
    const Cell k(asset_, i);
    wishes_[edge(k.a, k.d)].push_back(i);
    wishes_[edge(k.b, k.c)].push_back(i);
  }

  /// Settles an open cell if no more than one diagonal is left to it, and then those that lost theirs by that.
  void ask_again(uint32_t cell) {
    std::vector<uint32_t> asked{cell};
    while (!asked.empty()) {
      const uint32_t i = asked.back();
      asked.pop_back();
      if (settled_[i] || !settle(i)) continue;
      settled_[i] = true;
      append_rivals(i, asked);
    }
  }

  /// Splits an open cell that has both diagonals still: by the one that no other open cell may need, if there is one.
  void decide(uint32_t i) {
    const Cell k(asset_, i);
    Diagonal wanted = preferred(k);
    const bool right_rivals = open_rivals(i, edge(k.a, k.d)), left_rivals = open_rivals(i, edge(k.b, k.c));
    if (right_rivals != left_rivals) wanted = right_rivals ? left : right;
    cut(k, wanted);
    settled_[i] = true;
    std::vector<uint32_t> rivals;
    append_rivals(i, rivals);
    for (const uint32_t r : rivals) ask_again(r);
  }

  [[nodiscard]] bool open_rivals(uint32_t i, const PixelPair& diagonal) const {
    const std::vector<uint32_t>& cells = wishes_.at(diagonal);
    return std::any_of(cells.begin(), cells.end(), [&](uint32_t c) { return c != i && !settled_[c]; });
  }

  void append_rivals(uint32_t i, std::vector<uint32_t>& rivals) const {
    const Cell k(asset_, i);
    for (const PixelPair& diagonal : {edge(k.a, k.d), edge(k.b, k.c)}) {
      for (const uint32_t c : wishes_.at(diagonal)) {
        if (!settled_[c]) rivals.push_back(c);
      }
    }
  }

  void choose(const Cell& k, Diagonal possible) {
    switch (possible) {
      case both:
        return cut(k, preferred(k));
      case right:
      case left:
        return cut(k, possible);
      case none:
        return fill_half(k);
    }
  }

  /// The shorter diagonal; at a corner of the outline the one through the corner, because the other one would leave the
  /// corner's pixel on a single triangle and join two outline pixels that may be joined elsewhere too.
  [[nodiscard]] Diagonal preferred(const Cell& k) const {
    const bool right_ear = image_.on_outline(k.a) && image_.on_outline(k.d);
    const bool left_ear = image_.on_outline(k.b) && image_.on_outline(k.c);
    if (right_ear != left_ear) return right_ear ? left : right;
    const auto& p = image_.raster.position;
    return distance(p[k.a], p[k.d]) <= distance(p[k.b], p[k.c]) ? right : left;
  }

  void cut(const Cell& k, Diagonal diagonal) {
    const bool is_left = diagonal == left;
    keep(is_left ? k.b : k.a, is_left ? k.c : k.d);
    asset_.cell[k.a] = static_cast<uint8_t>(kCellFirst | kCellSecond | (is_left ? kCellDiagonalLeft : 0));
  }

  /// One triangle where the outline leaves no room for two.
  void fill_half(const Cell& k) {
    if (k.ad && k.ac && k.cd) return keep_half(k.a, k.d, k.a, kCellFirst);
    if (k.ad && k.ab && k.bd) return keep_half(k.a, k.d, k.a, kCellSecond);
    if (k.bc && k.ab && k.ac) return keep_half(k.b, k.c, k.a, kCellFirst | kCellDiagonalLeft);
    if (k.bc && k.bd && k.cd) return keep_half(k.b, k.c, k.a, kCellSecond | kCellDiagonalLeft);
  }
  void keep_half(uint32_t p, uint32_t q, uint32_t cell, int bits) {
    keep(p, q);
    asset_.cell[cell] = static_cast<uint8_t>(bits);
  }

  const Image& image_;
  ClothAsset& asset_;
  std::vector<bool> split_;
  std::unordered_set<PixelPair, PixelPairHash> edges_;
  std::vector<uint32_t> open_;  ///< cells whose choice matters to others, in order
  std::vector<bool> settled_;   ///< per cell, of the open ones
  std::unordered_map<PixelPair, std::vector<uint32_t>, PixelPairHash> wishes_;  ///< open cells by diagonal
};

// ---------------------------------------------------------------------------------------------------- seam bends

/// An outline pixel with its neighbours along the outline.
struct OutlinePixel {
  uint32_t pixel, before, after;
};

/// Adds the bending elements that a cut took away: over every seam, from the pixel inside one chart to the pixel inside
/// the other, and over the end of a cut, from the seam into the chart.
///
///      chart 1     . a .              a-middle-b is bent as (x,y-1)-(x,y)-(x,y+1) would be in an uncut image.
///      seam     ---- P ----  q
///      seam     ---- P'----  q'       Where several sheets hang on one seam, only those that were one sheet before
///      chart 2     . b .              the cut are continued into each other; the others are hinged there.
class SeamBender {
 public:
  explicit SeamBender(const Image& image) : image_(image), asset_(image.asset) {}

  void bend_all() {
    collect_outline();
    mark_sheets();
    for (uint32_t row = 0; row < asset_.splits.rows(); ++row) {
      const std::span<const uint32_t> copies = asset_.splits.copies(row);
      for (std::size_t i = 0; i < copies.size(); ++i) {
        for (std::size_t j = i + 1; j < copies.size(); ++j) bend_across(copies[i], copies[j]);
      }
    }
    for (const OutlinePixel& o : outline_) {
      if (first(o.before) == first(o.after)) bend_over_cut_end(o);
    }
  }

 private:
  [[nodiscard]] uint32_t first(uint32_t pixel) const { return image_.first_copy[pixel]; }
  [[nodiscard]] Point3 at(uint32_t pixel) const { return image_.raster.position[pixel]; }
  [[nodiscard]] const OutlinePixel& outline(uint32_t pixel) const { return outline_[outline_of_[pixel]]; }

  void collect_outline() {
    outline_of_.assign(asset_.pixel_count(), kNone);
    for (const FlatChart& chart : image_.flat.charts) {
      const std::size_t n = chart.outline.size();
      const auto pixel = [&](std::size_t k) {
        const OutlineSample& s = chart.outline[k % n];
        return (chart.y0 + s.y) * asset_.width + chart.x0 + s.x;
      };
      for (std::size_t k = 0; k < n; ++k) {
        outline_of_[pixel(k)] = static_cast<uint32_t>(outline_.size());
        outline_.push_back({pixel(k), pixel(k + n - 1), pixel(k + 1)});
        ++sides_of_[sorted(first(pixel(k)), first(pixel(k + 1)))];
      }
    }
  }

  /// For every border vertex the clean vertex, or the two ends of the clean edge, that it stands on: two sides of one
  /// cut have equal marks, tied sheets have different ones.
  void mark_sheets() {
    sheet_.assign(image_.flat.position.size(), {kNone, kNone});
    for (const auto& border : chart_borders(image_.flat)) {
      std::unordered_map<uint32_t, uint32_t> next;
      for (const auto& [from, to] : border) next[from] = to;
      for (const auto& [from, to] : border) {
        if (image_.flat.clean_vertex[from] == kNone) continue;
        std::vector<uint32_t> inserted;
        uint32_t v = to;
        while (image_.flat.clean_vertex[v] == kNone && inserted.size() <= border.size()) {
          inserted.push_back(v);
          v = next[v];
        }
        const uint32_t start = image_.flat.clean_vertex[from];
        sheet_[from] = {start, start};
        for (const uint32_t w : inserted) sheet_[w] = sorted(start, image_.flat.clean_vertex[v]);
      }
    }
  }

  void bend_across(uint32_t i, uint32_t j) {
    const OutlinePixel &oi = outline(i), &oj = outline(j);
    std::vector<PixelPair> shared;  // neighbours along a seam that i and j have in common, as (i's copy, j's copy)
    for (const uint32_t qi : {oi.before, oi.after}) {
      for (const uint32_t qj : {oj.before, oj.after}) {
        if (first(qi) == first(qj)) shared.push_back({qi, qj});
      }
    }
    if (shared.empty() || !one_sheet(i, j, shared[0])) return;
    const Point3 tangent = shared.size() == 2 ? at(shared[1][0]) - at(shared[0][0]) : at(shared[0][0]) - at(i);
    const uint32_t a = most_perpendicular(i, tangent, shared), b = most_perpendicular(j, tangent, shared);
    if (a != kNone && b != kNone) add(a, i, b);
  }

  /// Did i and j belong to one sheet before the cut between them?
  [[nodiscard]] bool one_sheet(uint32_t i, uint32_t j, const PixelPair& along_seam) const {
    const uint32_t sides = sides_of_.at(sorted(first(i), first(along_seam[0])));
    if (sides == 2) return true;
    const auto same = [&](uint32_t p, uint32_t q) {
      return sheet_[image_.raster.vertex[p]] == sheet_[image_.raster.vertex[q]];
    };
    return same(i, j) && same(along_seam[0], along_seam[1]);
  }

  /// Pixels that a structural or shear spring joins to this one.
  [[nodiscard]] std::vector<uint32_t> ring_of(uint32_t pixel) const {
    std::vector<uint32_t> ring;
    const int64_t x = pixel % asset_.width, y = pixel / asset_.width;
    for (uint32_t s = 0; s < 4; ++s) {
      const auto bit = static_cast<SpringBit>(1U << s);
      const int64_t step = kSpringOffset[s][1] * int64_t{asset_.width} + kSpringOffset[s][0];
      if (has_spring(asset_, pixel, bit)) ring.push_back(static_cast<uint32_t>(pixel + step));
      const int64_t from_x = x - kSpringOffset[s][0], from_y = y - kSpringOffset[s][1];
      if (from_x < 0 || from_x >= asset_.width || from_y < 0) continue;
      const auto from = static_cast<uint32_t>(pixel - step);
      if (has_spring(asset_, from, bit)) ring.push_back(from);
    }
    return ring;
  }

  [[nodiscard]] uint32_t most_perpendicular(uint32_t pixel, const Point3& tangent,
                                            const std::vector<PixelPair>& excluded) const {
    return best_of_ring(pixel, [&](uint32_t q, const Point3& direction) {
      for (const PixelPair& e : excluded) {
        if (first(q) == first(e[0])) return std::numeric_limits<double>::infinity();
      }
      return std::abs(dot(direction, tangent)) / length(direction);
    });
  }

  /// The ring pixel with the least finite value; the first one where several have it.
  template <class Value>
  [[nodiscard]] uint32_t best_of_ring(uint32_t pixel, const Value& value) const {
    uint32_t best = kNone;
    double least = std::numeric_limits<double>::infinity();
    for (const uint32_t q : ring_of(pixel)) {
      const double v = value(q, at(q) - at(pixel));
      if (v < least) {
        least = v;
        best = q;
      }
    }
    return best;
  }

  void bend_over_cut_end(const OutlinePixel& o) {
    const Point3 along = at(o.before) - at(o.pixel);
    const uint32_t ahead = best_of_ring(
        o.pixel, [&](uint32_t, const Point3& direction) { return dot(direction, along) / length(direction); });
    if (ahead != kNone) add(ahead, o.pixel, o.before);
  }

  void add(uint32_t a, uint32_t middle, uint32_t b) {
    const PixelPair ends = sorted(first(a), first(b));
    if (ends[0] == ends[1] || !done_.insert({ends, first(middle)}).second) return;
    const float rest = length(asset_.rest_position[b] - asset_.rest_position[a]);
    asset_.seam_bends.push_back({a, middle, b, rest});
  }

  struct DoneHash {
    std::size_t operator()(const std::pair<PixelPair, uint32_t>& d) const {
      return PixelPairHash{}(d.first) * 31 + d.second;
    }
  };

  const Image& image_;
  ClothAsset& asset_;
  std::vector<OutlinePixel> outline_;
  std::vector<uint32_t> outline_of_;                                 ///< per pixel: index into outline_
  std::unordered_map<PixelPair, uint32_t, PixelPairHash> sides_of_;  ///< outline steps between two surface points
  std::vector<PixelPair> sheet_;                                     ///< per flat vertex
  std::unordered_set<std::pair<PixelPair, uint32_t>, DoneHash> done_;
};

}  // namespace

ClothAsset build_image(const FlatSurface& flat, const Raster& raster, Layout layout) {
  ClothAsset asset;
  asset.layout = layout;
  asset.spacing = nominal_spacing(flat);
  copy_pixels(flat, raster, asset);
  asset.splits = split_vertices(raster, flat.point_count);
  const Image image{flat, raster, asset, first_copies(asset), chart_outlines(flat)};
  mark_springs(image);
  CellSplitter(image).split_all();
  share_area(asset);
  SeamBender(image).bend_all();
  return asset;
}

}  // namespace geocloth
