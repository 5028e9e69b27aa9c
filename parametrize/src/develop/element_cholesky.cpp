// SPDX-License-Identifier: GPL-3.0-or-later
//
// The multifrontal method (Irons 1970; Duff and Reid 1983): the tree of separators is climbed from its leaves. Each
// node sums the matrices of its triangles and what its children left over into a small dense matrix, its front,
// eliminates its own unknowns there, and leaves the rest to its parent. Nearly all arithmetic is dense and branches of
// the tree are independent of each other.
#include "develop/element_cholesky.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include <tbb/parallel_for.h>

#include "develop/dense_front.h"
#include "develop/dissection.h"

namespace geocloth {
namespace {

constexpr size_t kWorthATask = 4'000;  // unknowns below a node

/// Unknowns that follow each other in a child's boundary and in the parent's front as well.
struct Run {
  uint32_t from, to, count;
};

struct Front {
  uint32_t first = 0;              // of its own unknowns, by elimination
  uint32_t own = 0;                // how many they are; in the front they come first
  std::vector<uint32_t> boundary;  // unknowns that it touches and leaves to others, ascending by elimination
  std::vector<uint32_t> child;
  std::vector<std::vector<Run>> child_run;  // per child: where its boundary's unknowns are in this front
  size_t below = 0;                         // unknowns of this node and of those below
  std::vector<uint32_t> triangle;
  std::vector<std::array<uint32_t, 3>> corner;  // per triangle: where its corners are in the front, or kNone
  DenseFront matrix;
};

}  // namespace

struct ElementCholesky::Impl {
  size_t width = 1;
  std::vector<uint32_t> turn;  // per unknown: when it is eliminated
  std::vector<Front> front;
  std::vector<uint32_t> root;

  void analyse(std::span<const Triangle> triangle, std::span<const int32_t> unknown, std::span<const Point2> place) {
    const Dissection dissection = dissect(triangle, unknown, place);
    turn.resize(dissection.order.size());
    for (uint32_t i = 0; i < turn.size(); ++i) turn[dissection.order[i]] = i;
    front.resize(dissection.node.size());
    std::vector<uint32_t> owner(turn.size());  // per turn: front
    for (uint32_t f = 0; f < front.size(); ++f) {
      const auto& [begin, end, parent] = dissection.node[f];
      front[f].first = begin;
      front[f].own = end - begin;
      for (uint32_t i = begin; i < end; ++i) owner[i] = f;
      if (parent == kNone) {
        root.push_back(f);
      } else {
        front[parent].child.push_back(f);
      }
    }
    const auto turns_of = [&](const Triangle& t) {
      std::array<uint32_t, 3> turns{};
      for (size_t i = 0; i < 3; ++i) turns[i] = unknown[t[i]] < 0 ? kNone : turn[static_cast<size_t>(unknown[t[i]])];
      return turns;
    };
    for (uint32_t t = 0; t < triangle.size(); ++t) {
      const std::array<uint32_t, 3> turns = turns_of(triangle[t]);
      const uint32_t earliest = *std::min_element(turns.begin(), turns.end());
      if (earliest != kNone) front[owner[earliest]].triangle.push_back(t);
    }
    for (Front& f : front) {
      gather_boundary(f, triangle, turns_of);
      f.below = f.own;
      for (const uint32_t c : f.child) {
        f.below += front[c].below;
        f.child_run.push_back(runs_in(f, front[c].boundary));
      }
      for (const uint32_t t : f.triangle) {
        std::array<uint32_t, 3> corners = turns_of(triangle[t]);
        for (uint32_t& c : corners) c = c == kNone ? kNone : place_in(f, c);
        f.corner.push_back(corners);
      }
      f.matrix.set_size(f.own * width, f.boundary.size() * width);
    }
  }

  template <class Turns>
  void gather_boundary(Front& f, std::span<const Triangle> triangle, const Turns& turns_of) const {
    const uint32_t end = f.first + f.own;
    for (const uint32_t t : f.triangle) {
      for (const uint32_t i : turns_of(triangle[t])) {
        if (i != kNone && i >= end) f.boundary.push_back(i);
      }
    }
    for (const uint32_t c : f.child) {
      for (const uint32_t i : front[c].boundary) {
        if (i >= end) f.boundary.push_back(i);
      }
    }
    std::sort(f.boundary.begin(), f.boundary.end());
    f.boundary.erase(std::unique(f.boundary.begin(), f.boundary.end()), f.boundary.end());
  }

  static uint32_t place_in(const Front& f, uint32_t i) {
    if (i < f.first + f.own) return i - f.first;
    const auto found = std::lower_bound(f.boundary.begin(), f.boundary.end(), i);
    return f.own + static_cast<uint32_t>(found - f.boundary.begin());
  }

  static std::vector<Run> runs_in(const Front& f, const std::vector<uint32_t>& unknowns) {
    std::vector<Run> runs;
    for (uint32_t i = 0; i < unknowns.size(); ++i) {
      const uint32_t to = place_in(f, unknowns[i]);
      if (!runs.empty() && runs.back().to + runs.back().count == to) {
        ++runs.back().count;
      } else {
        runs.push_back({i, to, 1});
      }
    }
    return runs;
  }

  /// A front's columns: those of the factor, then those of what is left, which have no rows of own unknowns.
  struct Columns {
    DenseFront& own;
    DenseFront::Rest& rest;
    /// Row `row` of a column that has it; the columns beside it are step() away.
    [[nodiscard]] double* at(size_t row, size_t column) const {
      if (column < own.own()) return own.column(column) + row;
      return rest.value.data() + (column - own.own()) * rest.stride + (row - own.own());
    }
    [[nodiscard]] size_t step(size_t column) const { return column < own.own() ? own.stride() : rest.stride; }
  };

  template <size_t kWidth>
  static void add_triangles(Front& f, std::span<const double> element, DenseFront::Rest& rest) {
    constexpr size_t kSize = 3 * kWidth;
    const Columns columns{f.matrix, rest};
    for (size_t i = 0; i < f.triangle.size(); ++i) {
      const double* value = element.data() + f.triangle[i] * (kSize * (kSize + 1) / 2);
      for (size_t k = 0; k < 3; ++k) {
        for (size_t l = 0; l <= k; ++l) {
          const size_t p = f.corner[i][k], q = f.corner[i][l];
          if (p == kNone || q == kNone) continue;
          // A block of the element's matrix, as it is or turned over.
          const size_t low = std::min(p, q) * kWidth, high = std::max(p, q) * kWidth;
          double* const into = columns.at(high, low);
          const size_t step = columns.step(low);
          for (size_t a = 0; a < kWidth; ++a) {
            const double* const row = value + (k * kWidth + a) * (k * kWidth + a + 1) / 2 + l * kWidth;
            for (size_t b = 0; b < (k == l ? a + 1 : kWidth); ++b) into[p < q ? a * step + b : b * step + a] += row[b];
          }
        }
      }
    }
  }

  /// Only the lower half counts.
  template <size_t kWidth>
  static void add_children(Front& f, std::vector<DenseFront::Rest>& left, DenseFront::Rest& rest) {
    const Columns columns{f.matrix, rest};
    for (size_t i = 0; i < left.size(); ++i) {
      const std::vector<Run>& runs = f.child_run[i];
      for (size_t r = 0; r < runs.size(); ++r) {
        for (size_t c = 0; c < runs[r].count * kWidth; ++c) {
          const double* const from = left[i].value.data() + (runs[r].from * kWidth + c) * left[i].stride;
          const size_t column = runs[r].to * kWidth + c;
          double* const into = columns.at(column, column) - column;
          for (size_t s = r, skipped = c / kWidth; s < runs.size(); ++s, skipped = 0) {
            add<kWidth>(from + (runs[s].from + skipped) * kWidth, runs[s].count - skipped,
                        into + (runs[s].to + skipped) * kWidth);
          }
        }
      }
      left[i].value = {};
    }
  }

  template <size_t kWidth>
  static void add(const double* __restrict from, size_t count, double* __restrict into) {
    for (size_t k = 0; k < count; ++k) {
      for (size_t a = 0; a < kWidth; ++a) into[k * kWidth + a] += from[k * kWidth + a];
    }
  }

  /// Eliminates a node and all below it. @returns what it leaves to its parent
  DenseFront::Rest eliminate(uint32_t number, std::span<const double> element, double diagonal,
                             std::atomic<bool>& definite) {
    Front& f = front[number];
    std::vector<DenseFront::Rest> left(f.child.size());
    const auto eliminate_child = [&](size_t i) { left[i] = eliminate(f.child[i], element, diagonal, definite); };
    if (f.below > kWorthATask) {
      tbb::parallel_for(size_t{0}, f.child.size(), eliminate_child);
    } else {
      for (size_t i = 0; i < f.child.size(); ++i) eliminate_child(i);
    }
    DenseFront::Rest rest = f.matrix.clear();
    for (size_t k = 0; k < f.matrix.own(); ++k) f.matrix.column(k)[k] = diagonal;
    if (width == 1) {
      add_triangles<1>(f, element, rest);
      add_children<1>(f, left, rest);
    } else {
      add_triangles<2>(f, element, rest);
      add_children<2>(f, left, rest);
    }
    if (!definite || !f.matrix.eliminate(rest)) definite = false;
    return rest;
  }

  /// One right side, by turns.
  void solve(std::vector<double>& x) const {
    std::vector<double> part;  // of a front
    const auto gather = [&](const Front& f) {
      part.assign(f.matrix.stride(), 0.0);
      std::copy_n(x.data() + f.first * width, f.matrix.own(), part.data());
      for (size_t i = 0; i < f.boundary.size(); ++i) {
        std::copy_n(x.data() + f.boundary[i] * width, width, part.data() + (f.own + i) * width);
      }
    };
    for (const Front& f : front) {
      gather(f);
      f.matrix.solve_forwards(part.data());
      std::copy_n(part.data(), f.matrix.own(), x.data() + f.first * width);
      for (size_t i = 0; i < f.boundary.size(); ++i) {
        std::copy_n(part.data() + (f.own + i) * width, width, x.data() + f.boundary[i] * width);
      }
    }
    for (auto f = front.rbegin(); f != front.rend(); ++f) {
      gather(*f);
      f->matrix.solve_backwards(part.data());
      std::copy_n(part.data(), f->matrix.own(), x.data() + f->first * width);
    }
  }
};

ElementCholesky::ElementCholesky(std::span<const Triangle> triangle, std::span<const int32_t> unknown,
                                 std::span<const Point2> place, Eigen::Index width)
    : impl_(std::make_unique<Impl>()) {
  impl_->width = static_cast<size_t>(width);
  impl_->analyse(triangle, unknown, place);
}

ElementCholesky::ElementCholesky(ElementCholesky&&) noexcept = default;
ElementCholesky& ElementCholesky::operator=(ElementCholesky&&) noexcept = default;
ElementCholesky::~ElementCholesky() = default;

bool ElementCholesky::factorise(std::span<const double> element, double diagonal) {
  std::atomic<bool> definite = true;
  for (const uint32_t root : impl_->root) (void)impl_->eliminate(root, element, diagonal, definite);
  return definite;
}

void ElementCholesky::solve(Eigen::MatrixXd& right) const {
  const size_t width = impl_->width;
  std::vector<double> x(impl_->turn.size() * width);
  for (Eigen::Index column = 0; column < right.cols(); ++column) {
    double* side = right.col(column).data();
    for (size_t u = 0; u < impl_->turn.size(); ++u) {
      std::copy_n(side + u * width, width, x.data() + impl_->turn[u] * width);
    }
    impl_->solve(x);
    for (size_t u = 0; u < impl_->turn.size(); ++u) {
      std::copy_n(x.data() + impl_->turn[u] * width, width, side + u * width);
    }
  }
}

}  // namespace geocloth
