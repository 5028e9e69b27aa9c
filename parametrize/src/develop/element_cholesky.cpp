// SPDX-License-Identifier: GPL-3.0-or-later
//
// The multifrontal method (Irons 1970; Duff and Reid 1983): the tree of separators is climbed from its leaves. Each
// node sums the matrices of its triangles and what its children left over into a small dense matrix, its front,
// eliminates its own unknowns there, and leaves the rest to its parent. Nearly all arithmetic is dense and branches of
// the tree are independent of each other.
//
// What a branch leaves over lies on two stacks, those of nodes an even and an odd number of steps below its top: when a
// node is eliminated the rests of its children are on top of one of them, and its own goes on top of the other.
#include "develop/element_cholesky.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include <tbb/parallel_for.h>

#include "develop/dense_front.h"
#include "develop/dissection.h"
#include "develop/number_store.h"

namespace geocloth {
namespace {

constexpr size_t kWorthATask = 800;  // unknowns below a node

/// Places first..end-1 in an array that all fronts share.
struct Range {
  uint32_t begin = 0, end = 0;

  [[nodiscard]] uint32_t size() const { return end - begin; }
};

struct Front {
  Range own;              // unknowns by elimination; in the front they come first
  Range boundary;         // unknowns that it touches and leaves to others, ascending by elimination
  Range triangle;         // each with its corners' places in the front
  uint32_t children = 0;  // at most two
  std::array<uint32_t, 2> child{};
  size_t below = 0;  // unknowns of this node and of those below
  DenseFront matrix;
  size_t factor = 0;                   // where its factor begins
  std::array<size_t, 2> most_rests{};  // numbers that this branch has on the stack of its top, and on the other
};

}  // namespace

struct ElementCholesky::Impl {
  size_t width = 1;
  std::vector<uint32_t> turn;  // per unknown: when it is eliminated
  std::vector<Front> front;
  std::vector<uint32_t> root;
  std::vector<uint32_t> boundary;               // of all fronts, by elimination
  std::vector<uint32_t> place_in_parent;        // of these unknowns: in the front of the parent
  std::vector<uint32_t> triangle;               // by front
  std::vector<std::array<uint32_t, 3>> corner;  // of these triangles: where their corners are in the front, or kNone
  size_t factor_size = 0;
  NumberStore factor;

  void analyse(std::span<const Triangle> triangles, std::span<const int32_t> unknown, std::span<const Point2> place) {
    const Dissection dissection = dissect(triangles, unknown, place);
    turn.resize(dissection.order.size());
    for (uint32_t i = 0; i < turn.size(); ++i) turn[dissection.order[i]] = i;
    front.resize(dissection.node.size());
    std::vector<uint32_t> owner(turn.size());  // per turn: front
    for (uint32_t f = 0; f < front.size(); ++f) {
      const auto& [begin, end, parent] = dissection.node[f];
      front[f].own = {begin, end};
      std::fill(owner.begin() + begin, owner.begin() + end, f);
      if (parent == kNone) {
        root.push_back(f);
      } else {
        front[parent].child.at(front[parent].children++) = f;
      }
    }
    hand_out(triangles, unknown, owner);
    std::vector<uint32_t> known_to(turn.size(), kNone);  // per turn: the last front that has it in its boundary
    std::vector<uint32_t> place_in_front(turn.size());
    for (uint32_t f = 0; f < front.size(); ++f) {
      gather_boundary(f, known_to);
      place_corners(front[f], place_in_front);
      front[f].factor = factor_size;
      factor_size += front[f].matrix.factor_size();
    }
  }

  /// Every triangle goes to the front that eliminates the first of its corners.
  void hand_out(std::span<const Triangle> triangles, std::span<const int32_t> unknown,
                const std::vector<uint32_t>& owner) {
    std::vector<std::array<uint32_t, 3>> turns(triangles.size());
    std::vector<uint32_t> taker(triangles.size(), kNone);
    std::vector<uint32_t> next(front.size() + 1, 0);
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      uint32_t earliest = kNone;
      for (size_t i = 0; i < 3; ++i) {
        const int32_t u = unknown[triangles[t][i]];
        turns[t][i] = u < 0 ? kNone : turn[static_cast<size_t>(u)];
        earliest = std::min(earliest, turns[t][i]);
      }
      if (earliest == kNone) continue;
      taker[t] = owner[earliest];
      ++next[taker[t] + 1];
    }
    for (size_t f = 0; f < front.size(); ++f) next[f + 1] += next[f];
    for (size_t f = 0; f < front.size(); ++f) front[f].triangle = {next[f], next[f + 1]};
    triangle.resize(next.back());
    corner.resize(next.back());
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      if (taker[t] == kNone) continue;
      const uint32_t at = next[taker[t]]++;
      triangle[at] = t;
      corner[at] = turns[t];
    }
  }

  void gather_boundary(uint32_t number, std::vector<uint32_t>& known_to) {
    Front& f = front[number];
    f.boundary.begin = static_cast<uint32_t>(boundary.size());
    const auto add = [&](uint32_t i) {
      if (i == kNone || i < f.own.end || known_to[i] == number) return;
      known_to[i] = number;
      boundary.push_back(i);
    };
    for (uint32_t i = f.triangle.begin; i < f.triangle.end; ++i) {
      for (const uint32_t c : corner[i]) add(c);
    }
    for (uint32_t c = 0; c < f.children; ++c) {
      const Range of_child = front[f.child.at(c)].boundary;
      for (uint32_t i = of_child.begin; i < of_child.end; ++i) add(boundary[i]);
    }
    std::sort(boundary.begin() + f.boundary.begin, boundary.end());
    f.boundary.end = static_cast<uint32_t>(boundary.size());
    place_in_parent.resize(boundary.size());
  }

  /// Where in the front everything is that comes to it.
  /// @param place_in_front  per turn, of this front; what others had there does not matter
  void place_corners(Front& f, std::vector<uint32_t>& place_in_front) {
    for (uint32_t i = f.own.begin; i < f.own.end; ++i) place_in_front[i] = i - f.own.begin;
    for (uint32_t i = f.boundary.begin; i < f.boundary.end; ++i) {
      place_in_front[boundary[i]] = f.own.size() + i - f.boundary.begin;
    }
    for (uint32_t i = f.triangle.begin; i < f.triangle.end; ++i) {
      for (uint32_t& c : corner[i]) c = c == kNone ? kNone : place_in_front[c];
    }
    f.matrix = DenseFront(f.own.size() * width, f.boundary.size() * width);
    f.below = f.own.size();
    size_t of_children = 0;
    for (uint32_t c = 0; c < f.children; ++c) {
      const Front& child = front[f.child.at(c)];
      for (uint32_t i = child.boundary.begin; i < child.boundary.end; ++i) {
        place_in_parent[i] = place_in_front[boundary[i]];
      }
      f.below += child.below;
      f.most_rests[0] = std::max(f.most_rests[0], child.most_rests[1]);
      f.most_rests[1] = std::max(f.most_rests[1], of_children + child.most_rests[0]);
      of_children += child.matrix.rest_size();
    }
    f.most_rests[0] = std::max(f.most_rests[0], f.matrix.rest_size());
  }

  /// A front's columns: those of the factor, then those of what is left, which have no rows of own unknowns.
  struct Columns {
    const DenseFront& matrix;
    double *factor, *rest;

    [[nodiscard]] bool is_own(size_t column) const { return column < matrix.own(); }
    /// Row `row` of a column that has it; the columns beside it are step() away.
    [[nodiscard]] double* at(size_t row, size_t column) const {
      if (is_own(column)) return factor + column * matrix.stride() + row;
      return rest + (column - matrix.own()) * matrix.rest_stride() + (row - matrix.own());
    }
    [[nodiscard]] size_t step(size_t column) const { return is_own(column) ? matrix.stride() : matrix.rest_stride(); }
  };

  template <size_t kWidth>
  void add_triangles(const Front& f, std::span<const double> element, const Columns& columns) const {
    constexpr size_t kSize = 3 * kWidth, kHalf = kSize * (kSize + 1) / 2;
    constexpr size_t kAhead = 3, kLine = 8;  // triangles; numbers of a cache line
    for (uint32_t i = f.triangle.begin; i < f.triangle.end; ++i) {
      const double* value = element.data() + triangle[i] * kHalf;
      if (i + kAhead < f.triangle.end) {  // they lie here and there
        const double* const later = element.data() + triangle[i + kAhead] * kHalf;
        for (size_t k = 0; k < kHalf; k += kLine) __builtin_prefetch(later + k);
      }
      for (size_t k = 0; k < 3; ++k) {
        for (size_t l = 0; l <= k; ++l) {
          const size_t p = corner[i][k], q = corner[i][l];
          if (p == kNone || q == kNone) continue;
          // A block of the element's matrix, as it is or turned over.
          const size_t low = std::min(p, q) * kWidth, high = std::max(p, q) * kWidth;
          double* const into = columns.at(high, low);
          const size_t step_a = p < q ? columns.step(low) : 1, step_b = p < q ? 1 : columns.step(low);
          for (size_t a = 0; a < kWidth; ++a) {
            const double* const row = value + (k * kWidth + a) * (k * kWidth + a + 1) / 2 + l * kWidth;
            for (size_t b = 0; b < (k == l ? a + 1 : kWidth); ++b) into[a * step_a + b * step_b] += row[b];
          }
        }
      }
    }
  }

  /// What is the same for all fronts while a matrix is factorised.
  struct Job {
    std::span<const double> element;
    double diagonal;
    std::atomic<bool> definite = true;
  };

  /// @param left  what the children have left
  void eliminate(const Front& f, const std::array<const double*, 2>& left, double* rest, Job& job) const {
    double* const own = factor.data() + f.factor;
    f.matrix.clear(own, job.diagonal, rest);
    const Columns columns{f.matrix, own, rest};
    width == 1 ? add_triangles<1>(f, job.element, columns) : add_triangles<2>(f, job.element, columns);
    for (uint32_t c = 0; c < f.children; ++c) {
      const Front& child = front[f.child.at(c)];
      const std::span<const uint32_t> to(place_in_parent.data() + child.boundary.begin, child.boundary.size());
      f.matrix.add(child.matrix, left.at(c), to, width, own, rest);
    }
    if (!job.definite || !f.matrix.eliminate(own, rest)) job.definite = false;
  }

  /// Eliminates a node and all below it.
  /// @param rest   the top of the stack on which the node's rest goes
  /// @param other  the top of the other one
  void eliminate_branch(const Front& f, double* rest, double* other, Job& job) const {
    std::array<const double*, 2> left{};
    for (uint32_t c = 0; c < f.children; ++c) {
      const Front& child = front[f.child.at(c)];
      eliminate_branch(child, other, rest, job);
      left.at(c) = other;
      other += child.matrix.rest_size();
    }
    eliminate(f, left, rest, job);
  }

  /// The same where branches are worth tasks. @returns what the node leaves to its parent, at its begin
  NumberStore eliminate_in_tasks(const Front& f, Job& job) const {
    if (f.below <= kWorthATask) {
      NumberStore rests(f.most_rests[0] + f.most_rests[1]);
      eliminate_branch(f, rests.data(), rests.data() + f.most_rests[0], job);
      return rests;
    }
    std::array<NumberStore, 2> of_child;
    std::array<const double*, 2> left{};
    tbb::parallel_for(uint32_t{0}, f.children, [&](uint32_t c) {
      of_child.at(c) = eliminate_in_tasks(front[f.child.at(c)], job);
      left.at(c) = of_child.at(c).data();
    });
    NumberStore rest(f.matrix.rest_size());
    eliminate(f, left, rest.data(), job);
    return rest;
  }

  /// A right side's numbers of a front, in its order.
  void gather(const Front& f, const std::vector<double>& x, std::vector<double>& part) const {
    part.assign(f.matrix.stride(), 0.0);
    std::copy_n(x.data() + f.own.begin * width, f.matrix.own(), part.data());
    double* into = part.data() + f.matrix.own();
    for (uint32_t i = f.boundary.begin; i < f.boundary.end; ++i, into += width) {
      for (size_t a = 0; a < width; ++a) into[a] = x[boundary[i] * width + a];
    }
  }

  /// One right side, by turns.
  void solve_forwards(std::vector<double>& x) const {
    std::vector<double> part;
    for (const Front& f : front) {
      gather(f, x, part);
      f.matrix.solve_forwards(factor.data() + f.factor, part.data());
      std::copy_n(part.data(), f.matrix.own(), x.data() + f.own.begin * width);
      const double* from = part.data() + f.matrix.own();
      for (uint32_t i = f.boundary.begin; i < f.boundary.end; ++i, from += width) {
        for (size_t a = 0; a < width; ++a) x[boundary[i] * width + a] = from[a];
      }
    }
  }

  void solve_node_backwards(const Front& f, std::vector<double>& x, std::vector<double>& part) const {
    gather(f, x, part);
    f.matrix.solve_backwards(factor.data() + f.factor, part.data());
    std::copy_n(part.data(), f.matrix.own(), x.data() + f.own.begin * width);
  }

  /// A node and all below it, whose ancestors are solved.
  void solve_branch_backwards(const Front& f, std::vector<double>& x, std::vector<double>& part) const {
    solve_node_backwards(f, x, part);
    for (uint32_t c = 0; c < f.children; ++c) solve_branch_backwards(front[f.child.at(c)], x, part);
  }

  /// The same where branches are worth tasks.
  void solve_backwards_in_tasks(const Front& f, std::vector<double>& x) const {
    std::vector<double> part;
    if (f.below <= kWorthATask) return solve_branch_backwards(f, x, part);
    solve_node_backwards(f, x, part);
    tbb::parallel_for(uint32_t{0}, f.children, [&](uint32_t c) { solve_backwards_in_tasks(front[f.child.at(c)], x); });
  }

  void solve(std::vector<double>& x) const {
    solve_forwards(x);
    for (const uint32_t r : root) solve_backwards_in_tasks(front[r], x);
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
  if (impl_->factor.empty()) impl_->factor = NumberStore(impl_->factor_size);
  Impl::Job job{element, diagonal};
  for (const uint32_t root : impl_->root) (void)impl_->eliminate_in_tasks(impl_->front[root], job);
  return job.definite;
}

void ElementCholesky::forget_factor() {
  impl_->factor = NumberStore();
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
