// SPDX-License-Identifier: GPL-3.0-or-later
//
// The multifrontal method (Irons 1970; Duff and Reid 1983): the tree of separators is climbed from its leaves. Each
// node sums the matrices of its triangles and what its children left over into a small dense matrix, its front,
// eliminates its own unknowns there, and leaves the rest to its parent. Nearly all arithmetic is dense and branches of
// the tree are independent of each other.
#include "element_cholesky.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <vector>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

#include "dissection.h"

namespace geocloth {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr size_t kWorthATask = 4'000;  // unknowns below a node

struct Front {
  uint32_t first = 0;              // of its own unknowns, by elimination
  uint32_t own = 0;                // how many they are; in the front they come first
  std::vector<uint32_t> boundary;  // unknowns that it touches and leaves to others, ascending by elimination
  std::vector<uint32_t> child;
  std::vector<std::vector<uint32_t>> child_place;  // per child and unknown of its boundary: where that is in this front
  size_t below = 0;                                // unknowns of this node and of those below
  std::vector<uint32_t> triangle;
  std::vector<std::array<uint32_t, 3>> corner;  // per triangle: where its corners are in the front, or kNone
  MatrixXd factor;                              // columns of the own unknowns
};

}  // namespace

struct ElementCholesky::Impl {
  Index width = 1;
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
        std::vector<uint32_t>& places = f.child_place.emplace_back();
        places.reserve(front[c].boundary.size());
        for (const uint32_t b : front[c].boundary) places.push_back(place_in(f, b));
      }
      for (const uint32_t t : f.triangle) {
        std::array<uint32_t, 3> corners = turns_of(triangle[t]);
        for (uint32_t& c : corners) c = c == kNone ? kNone : place_in(f, c);
        f.corner.push_back(corners);
      }
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

  /// A front's columns: those of the factor, then those of what is left, which have no rows of own unknowns.
  struct Columns {
    struct Column {
      double* value;
      size_t first_row;
      double& operator[](size_t row) const { return value[row - first_row]; }
    };
    double *own, *rest;
    size_t own_count, rows;
    Columns(Front& f, MatrixXd& update)
        : own(f.factor.data()),
          rest(update.data()),
          own_count(static_cast<size_t>(f.factor.cols())),
          rows(static_cast<size_t>(f.factor.rows())) {}
    Column operator[](size_t column) const {
      if (column < own_count) return {own + column * rows, 0};
      return {rest + (column - own_count) * (rows - own_count), own_count};
    }
  };

  template <size_t kWidth>
  static void add_triangles(Front& f, std::span<const double> element, MatrixXd& update) {
    constexpr size_t kSize = 3 * kWidth;
    const Columns columns(f, update);
    for (size_t i = 0; i < f.triangle.size(); ++i) {
      const double* value = element.data() + f.triangle[i] * (kSize * (kSize + 1) / 2);
      std::array<size_t, kSize> at{};
      for (size_t k = 0; k < kSize; ++k) {
        const uint32_t corner = f.corner[i][k / kWidth];
        at[k] = corner == kNone ? kNone : corner * kWidth + k % kWidth;
      }
      for (size_t p = 0; p < kSize; ++p) {
        for (size_t q = 0; q <= p; ++q, ++value) {
          if (at[p] != kNone && at[q] != kNone) columns[std::min(at[p], at[q])][std::max(at[p], at[q])] += *value;
        }
      }
    }
  }

  template <size_t kWidth>
  static void add_children(Front& f, std::vector<MatrixXd>& left, MatrixXd& update) {
    const Columns columns(f, update);
    for (size_t i = 0; i < left.size(); ++i) {
      const std::vector<uint32_t>& place = f.child_place[i];
      const double* value = left[i].data();
      for (size_t column = 0; column < place.size() * kWidth; ++column) {
        const Columns::Column into = columns[place[column / kWidth] * kWidth + column % kWidth];
        const size_t b = column / kWidth;
        // The lower half of a block on the diagonal would do, but its upper half does no harm.
        for (size_t a = b; a < place.size(); ++a) {
          for (size_t k = 0; k < kWidth; ++k) into[place[a] * kWidth + k] += value[a * kWidth + k];
        }
        value += place.size() * kWidth;
      }
      left[i].resize(0, 0);
    }
  }

  /// Eliminates a node and all below it. @returns what it leaves to its parent (lower half)
  MatrixXd eliminate(uint32_t number, std::span<const double> element, double diagonal, std::atomic<bool>& definite) {
    Front& f = front[number];
    std::vector<MatrixXd> left(f.child.size());
    const auto eliminate_child = [&](size_t i) { left[i] = eliminate(f.child[i], element, diagonal, definite); };
    if (f.below > kWorthATask) {
      tbb::parallel_for(size_t{0}, f.child.size(), eliminate_child);
    } else {
      for (size_t i = 0; i < f.child.size(); ++i) eliminate_child(i);
    }
    const Index own = f.own * width, rest = static_cast<Index>(f.boundary.size()) * width;
    f.factor.setZero(own + rest, own);
    MatrixXd update = MatrixXd::Zero(rest, rest);
    f.factor.topRows(own).diagonal().setConstant(diagonal);
    if (width == 1) {
      add_triangles<1>(f, element, update);
      add_children<1>(f, left, update);
    } else {
      add_triangles<2>(f, element, update);
      add_children<2>(f, left, update);
    }
    if (own == 0) return update;
    Eigen::Ref<MatrixXd> top = f.factor.topRows(own);
    const Eigen::LLT<Eigen::Ref<MatrixXd>> square(top);  // in place
    if (square.info() != Eigen::Success) definite = false;
    if (rest == 0 || !definite) return update;
    auto below = f.factor.bottomRows(rest);
    top.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    update.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    return update;
  }

  [[nodiscard]] MatrixXd gathered(const Front& f, const MatrixXd& x) const {
    MatrixXd result(static_cast<Index>(f.boundary.size()) * width, x.cols());
    for (size_t i = 0; i < f.boundary.size(); ++i) {
      result.middleRows(static_cast<Index>(i) * width, width) = x.middleRows(f.boundary[i] * width, width);
    }
    return result;
  }

  void solve(MatrixXd& x) const {
    for (const Front& f : front) {
      const Index own = f.own * width;
      auto mine = x.middleRows(f.first * width, own);
      f.factor.topRows(own).triangularView<Eigen::Lower>().solveInPlace(mine);
      const MatrixXd change = f.factor.bottomRows(f.factor.rows() - own) * mine;
      for (size_t i = 0; i < f.boundary.size(); ++i) {
        x.middleRows(f.boundary[i] * width, width) -= change.middleRows(static_cast<Index>(i) * width, width);
      }
    }
    for (auto f = front.rbegin(); f != front.rend(); ++f) {
      const Index own = f->own * width;
      auto mine = x.middleRows(f->first * width, own);
      mine -= f->factor.bottomRows(f->factor.rows() - own).transpose() * gathered(*f, x);
      f->factor.topRows(own).triangularView<Eigen::Lower>().transpose().solveInPlace(mine);
    }
  }
};

ElementCholesky::ElementCholesky(std::span<const Triangle> triangle, std::span<const int32_t> unknown,
                                 std::span<const Point2> place, Eigen::Index width)
    : impl_(std::make_unique<Impl>()) {
  impl_->width = width;
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

void ElementCholesky::solve(MatrixXd& right) const {
  const Index width = impl_->width;
  MatrixXd x(right.rows(), right.cols());
  for (size_t u = 0; u < impl_->turn.size(); ++u) {
    x.middleRows(impl_->turn[u] * width, width) = right.middleRows(static_cast<Index>(u) * width, width);
  }
  impl_->solve(x);
  for (size_t u = 0; u < impl_->turn.size(); ++u) {
    right.middleRows(static_cast<Index>(u) * width, width) = x.middleRows(impl_->turn[u] * width, width);
  }
}

}  // namespace geocloth
