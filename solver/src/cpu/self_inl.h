// SPDX-License-Identifier: Apache-2.0
// Self-collision in vectors: as many points side by side as a vector has lanes where all do the same, and as many
// neighbours of one point where few of them matter. Those go on one by one, by the functions of lib/self_collide.h.
#if defined(GEOCLOTH_CPU_SELF_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_SELF_INL_H
#undef GEOCLOTH_CPU_SELF_INL_H
#else
#define GEOCLOTH_CPU_SELF_INL_H
#endif

#include <bit>
#include <limits>

#include "cpu/lanes_inl.h"
#include "cpu/nearest_list.h"
#include "cpu/self_arrays.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
using Words = hn::VFromD<hn::RebindToUnsigned<D>>;

/// self_in_range() of lib/self_collide.h.
template <class D>
HWY_INLINE Mask<D> in_range(D d, const Points<D>& p) {
  const auto near = [&](Vec<D> v) GEOCLOTH_LANES { return hn::Lt(hn::Abs(v), hn::Set(d, shader::kSelfFarthest)); };
  return hn::And(near(p.x), hn::And(near(p.y), near(p.z)));
}

/// Positions of points side by side.
template <class D>
HWY_INLINE Points<D> load(D d, const Vec3Array& a, size_t i) {
  return {hn::LoadU(d, a.x.data() + i), hn::LoadU(d, a.y.data() + i), hn::LoadU(d, a.z.data() + i)};
}

template <class D>
HWY_INLINE Points<D> in_all_lanes(D d, const shader::vec3& v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

/// Where as many points as a vector has lanes were seen.
template <class D>
HWY_INLINE Points<D> seen(D d, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t point) {
  const hn::RebindToUnsigned<D> du;
  Words<D> x, y, z;
  hn::LoadInterleaved3(du, set.data->words.data() + shader::self_seen_word(room, point), x, y, z);
  return {hn::BitCast(d, x), hn::BitCast(d, y), hn::BitCast(d, z)};
}

/// Lowest and highest of what some lanes had.
template <class D>
class LaneRange {
 public:
  explicit HWY_INLINE LaneRange(D d) : low_(hn::Set(d, kEndless)), high_(hn::Set(d, -kEndless)) {}
  HWY_INLINE void widen(D d, Mask<D> lanes, Vec<D> v) {
    low_ = hn::Min(low_, hn::IfThenElse(lanes, v, hn::Set(d, kEndless)));
    high_ = hn::Max(high_, hn::IfThenElse(lanes, v, hn::Set(d, -kEndless)));
  }
  /// As ordered_bits().
  HWY_INLINE void widen_words(D d, shader::uvec2& range) const {
    const float low = hn::GetLane(hn::MinOfLanes(d, low_)), high = hn::GetLane(hn::MaxOfLanes(d, high_));
    if (low > high) return;  // no lane
    range = {std::min(range.x, shader::ordered_bits(low)), std::max(range.y, shader::ordered_bits(high))};
  }

 private:
  static constexpr float kEndless = std::numeric_limits<float>::infinity();
  Vec<D> low_, high_;
};

/// Positions, four numbers for each.
template <class D>
HWY_INLINE void put_places(D d, AllLanes, const Points<D>& p, float* to) {
  hn::StoreInterleaved4(p.x, p.y, p.z, hn::Zero(d), d, to);
}
template <class D>
HWY_INLINE void put_places(D d, FirstLanes lanes, const Points<D>& p, float* to) {
  constexpr size_t kNumbers = SelfArrays::kPlaceNumbers;
  std::array<float, kNumbers * hn::MaxLanes(D())> buffer;
  put_places(d, AllLanes(), p, buffer.data());
  std::copy_n(buffer.begin(), kNumbers * lanes.count, to);
}

/// self_drift() of lib/self_collide.h.
template <class D>
HWY_NOINLINE void self_drift(D d, SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                             uint32_t first, uint32_t last, shader::SelfDrift& all) {
  LaneRange<D> x(d), y(d), z(d);
  bool lost = false;
  float* const places = arrays.place.data();
  for_run(d, {first, last}, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const Points<D> position = load(d, lanes, at(arrays.position, i));
    put_places(d, lanes, position, places + size_t{SelfArrays::kPlaceNumbers} * i);
    const Points<D> way = sub(position, seen(d, set, room, i));
    const auto somewhere = hn::And(in_range(d, position), hn::FirstN(d, last - i)), known = in_range(d, way);
    lost = lost || !hn::AllFalse(d, hn::AndNot(known, somewhere));
    const auto both = hn::And(somewhere, known);
    x.widen(d, both, way.x);
    y.widen(d, both, way.y);
    z.widen(d, both, way.z);
  });
  x.widen_words(d, all.x);
  y.widen_words(d, all.y);
  z.widen_words(d, all.z);
  if (lost) all.x = {0, shader::kSelfNone};
}

/// Number of the cell along an axis, self_cell_of() of lib/self_collide.h.
template <class D>
HWY_INLINE hn::VFromD<hn::RebindToSigned<D>> cell_of(D d, Vec<D> q) {
  const auto farthest = hn::Set(d, shader::kSelfFarthestCell);
  const auto cell = hn::Max(hn::Neg(farthest), hn::Min(farthest, hn::Floor(q)));
  return hn::ConvertTo(hn::RebindToSigned<D>(), cell);
}

/// See run_self_cells().
template <class D>
HWY_NOINLINE void self_cells(D d, SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                             uint32_t first, uint32_t last, PointGrid::Bounds& bounds) {
  const hn::RebindToSigned<D> di;
  const auto nowhere = hn::Set(di, PointGrid::kNowhere);
  std::array<hn::VFromD<decltype(di)>, 3> low, high;
  low.fill(hn::Set(di, std::numeric_limits<int32_t>::max()));
  high.fill(nowhere);
  PointGrid::Cells& cells = arrays.cells;
  const std::array<int32_t*, 3> numbers{cells.x.data(), cells.y.data(), cells.z.data()};
  const auto inverse = hn::Set(d, 1.F / room.reach);
  for_run(d, {first, last}, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const Points<D> position = load(d, lanes, at(arrays.position, i));
    const auto somewhere = hn::And(in_range(d, position), hn::FirstN(d, last - i));
    const Points<D> q = only<D>(somewhere, scale(d, position, inverse));
    const std::array cell{cell_of(d, q.x), cell_of(d, q.y), cell_of(d, q.z)};
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto counts = hn::RebindMask(di, somewhere);
      const auto number = hn::IfThenElse(counts, cell[axis], nowhere);
      low[axis] = hn::Min(low[axis], hn::IfThenElse(counts, cell[axis], low[axis]));
      high[axis] = hn::Max(high[axis], number);
      store(di, number, lanes, numbers[axis] + i);
    }
  });
  std::array<int32_t, hn::MaxLanes(D())> lane;
  for (size_t axis = 0; axis < 3; ++axis) {
    hn::StoreU(low[axis], di, lane.data());
    bounds.low[axis] = std::min(bounds.low[axis], *std::min_element(lane.begin(), lane.end()));
    hn::StoreU(high[axis], di, lane.data());
    bounds.high[axis] = std::max(bounds.high[axis], *std::max_element(lane.begin(), lane.end()));
  }
  for (uint32_t i = first; i < last; ++i) {
    shader::set_self_vector(set, shader::self_seen_word(room, i), arrays.position.at(i));
    if (cells.x[i] == PointGrid::kNowhere) set_self_word(set, shader::self_count_word(room, i), 0);
  }
}

/// Lanes of a mask as bits, the first lane's the lowest.
template <class D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> lanes) {
  static_assert(hn::MaxLanes(D()) <= 16);
  std::array<uint8_t, 8> bytes{};
  hn::StoreMaskBits(d, lanes, bytes.data());
  return bytes[0] | uint32_t{bytes[1]} << 8U;
}

/// For all masks of so many lanes: which lanes are set, one after the other.
template <size_t kLanes>
struct SetLanes {
  std::array<std::array<int32_t, kLanes>, size_t{1} << kLanes> of{};
  constexpr SetLanes() {
    for (size_t bits = 0; bits < of.size(); ++bits) {
      size_t count = 0;
      for (size_t lane = 0; lane < kLanes; ++lane)
        if ((bits >> lane & 1U) != 0) of[bits][count++] = static_cast<int32_t>(lane);
    }
  }
};
template <size_t kLanes>
inline constexpr SetLanes<kLanes> kSetLanes;

/// Puts those lanes first whose bits are set. Highway's own copies a table to the stack each time where it needs one.
template <class DT, class V>
HWY_INLINE V set_lanes_first(DT d, V v, uint32_t bits) {
  constexpr size_t kLanes = hn::MaxLanes(DT());
  if constexpr (kLanes <= 8) {
    const auto lanes = hn::LoadU(hn::RebindToSigned<DT>(), kSetLanes<kLanes>.of[bits].data());
    return hn::TableLookupLanes(v, hn::IndicesFromVec(d, lanes));
  } else {
    const std::array<uint8_t, 8> bytes{static_cast<uint8_t>(bits), static_cast<uint8_t>(bits >> 8U)};
    return hn::Compress(v, hn::LoadMaskBits(d, bytes.data()));
  }
}

/// Points near another one, as many as fit: which they are, and how far.
template <class D>
class NearPoints {
 public:
  /// Adds those lanes that are nearer.
  HWY_INLINE void add(D d, Mask<D> nearer, const uint32_t* points, Vec<D> distance2) {
    const hn::RebindToUnsigned<D> du;
    const uint32_t bits = bits_of(d, nearer);
    hn::StoreU(set_lanes_first(du, hn::LoadU(du, points), bits), du, point_.data() + count_);
    hn::StoreU(set_lanes_first(d, distance2, bits), d, distance2_.data() + count_);
    count_ += static_cast<uint32_t>(std::popcount(bits));
  }
  [[nodiscard]] HWY_INLINE bool is_full() const { return count_ > kMost; }

  /// Calls body(point, distance2) for all but `own` and some points, and begins anew.
  template <class Body>
  HWY_INLINE void take(D /*d*/, uint32_t own, std::span<const uint32_t> but, const Body& body) {
    const hn::RebindToUnsigned<D> du;
    for (uint32_t k = 0; k < count_; k += static_cast<uint32_t>(hn::Lanes(du))) {
      const auto point = hn::LoadU(du, point_.data() + k);
      auto left_out = hn::Eq(point, hn::Set(du, own));
      for (const uint32_t p : but) left_out = hn::Or(left_out, hn::Eq(point, hn::Set(du, p)));
      uint32_t bits = bits_of(du, hn::AndNot(left_out, hn::FirstN(du, count_ - k)));
      for (; bits != 0; bits &= bits - 1) {
        const uint32_t n = k + static_cast<uint32_t>(std::countr_zero(bits));
        body(point_[n], distance2_[n]);
      }
    }
    count_ = 0;
  }

 private:
  static constexpr size_t kMost = 48;  ///< more of them than that are taken in parts
  static constexpr size_t kRoom = kMost + 2 * hn::MaxLanes(D());
  std::array<uint32_t, kRoom> point_;  // as many as were written are read
  std::array<float, kRoom> distance2_;
  uint32_t count_ = 0;
};

/// self_find() of lib/self_collide.h for the points in some cells.
template <class D>
HWY_NOINLINE void self_find(D d, const SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                            uint32_t first_cell, uint32_t last_cell) {
  const PointGrid& grid = arrays.grid;
  const Vec3Array& positions = grid.position();
  const uint32_t* const points = grid.point().data();
  const auto reach2 = hn::Set(d, room.reach * room.reach);
  const std::span skips = std::span(set.data->words).subspan(shader::self_skip_word(room));
  NearPoints<D> near;
  CellsAround around(grid, first_cell);
  for (uint32_t cell = first_cell; cell < last_cell; ++cell) {
    const std::span<const PointPiece> pieces = around.go_to(cell);
    const PointPiece own_piece = grid.points_of(cell);
    for (uint32_t k = own_piece.first; k < own_piece.last; ++k) {
      const uint32_t point = points[k];
      const shader::SelfPoint& own = self_point(set, point);
      const Points<D> at = in_all_lanes(d, positions.at(k));
      const auto near_along = skips.subspan(own.skip_begin, set.between ? 0 : own.skip_end - own.skip_begin);
      NearestList found;
      const auto take = [&] {
        near.take(d, point, near_along, [&](uint32_t other, float distance2) {
          if (set.between && own.inter_cloth == self_point(set, other).inter_cloth) return;
          found.add_if_near(set, room, own, other, distance2);
        });
      };
      for (const PointPiece& piece : pieces) {
        for (uint32_t i = piece.first; i < piece.last; i += static_cast<uint32_t>(hn::Lanes(d))) {
          const Points<D> way = sub(load(d, positions, i), at);
          const auto squared = dot(d, way, way);
          near.add(d, hn::And(hn::Lt(squared, reach2), hn::FirstN(d, piece.last - i)), points + i, squared);
          if (near.is_full()) take();
        }
      }
      take();
      found.write(set, room, point);
    }
  }
}

using FourLanes = hn::FixedTag<float, 4>;

/// Four points as vectors.
HWY_INLINE Points<FourLanes> load_four(const float* places, const uint32_t* points) {
  const FourLanes d;
  const hn::FixedTag<uint64_t, 2> pairs;
  const auto place = [&](size_t k) GEOCLOTH_LANES {
    return hn::LoadU(d, places + size_t{SelfArrays::kPlaceNumbers} * (points[k] & ~shader::kSelfThinBit));
  };
  const auto a = place(0), b = place(1), c = place(2), e = place(3);
  const auto xy_ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b)),
             xy_ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
  const auto z_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b)),
             z_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, xy_ab, xy_ce)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, xy_ab, xy_ce)),
          hn::BitCast(d, hn::InterleaveLower(pairs, z_ab, z_ce))};
}

/// Pairs of points that touch, of one point after another: few for each of them, but many before they are worked on.
template <class D>
class TouchingPairs {
 public:
  [[nodiscard]] HWY_INLINE bool has_room() const { return count_ + shader::kSelfMostNeighbors <= kMost; }

  HWY_INLINE void add(uint32_t point, const shader::SelfPair& pair, const shader::PointState& own,
                      const shader::PointState& other) {
    point_[count_] = point;
    set(kApart, own.position - other.position);
    set(kWay, way_of(own) - way_of(other));
    number_[kShare][count_] = pair.share;
    number_[kDistance][count_] = pair.distance;
    number_[kFriction][count_] = pair.friction;
    ++count_;
  }

  /// Pushes the points, and begins anew.
  HWY_INLINE void push(D d, SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room) {
    for (size_t k = 0; k < count_; k += hn::Lanes(d)) add_up(d, k);
    for (uint32_t k = 0; k < count_;) {
      const uint32_t point = point_[k];
      shader::SelfPush sum = shader::no_push();
      for (; k < count_ && point_[k] == point; ++k) {
        sum.shift = sum.shift + at(kShift, k);
        sum.impulse = sum.impulse + at(kImpulse, k);
      }
      shader::set_self_push(set, room, point, shader::self_limited(room, sum));
      arrays.pushed[point] = shader::self_is_pushed(set, room, point) ? 1 : 0;
    }
    count_ = 0;
  }

 private:
  static constexpr size_t kMost = 96, kRoom = kMost + hn::MaxLanes(D());
  enum Number : size_t { kApart, kWay = 3, kShare = 6, kDistance, kFriction, kShift, kImpulse = 12, kNumbers = 15 };

  HWY_INLINE void set(size_t number, const shader::vec3& v) {
    number_[number][count_] = v.x;
    number_[number + 1][count_] = v.y;
    number_[number + 2][count_] = v.z;
  }
  [[nodiscard]] HWY_INLINE shader::vec3 at(size_t number, size_t k) const {
    return {number_[number][k], number_[number + 1][k], number_[number + 2][k]};
  }
  HWY_INLINE PointRow row(size_t number, size_t k) {
    return {&number_[number][k], &number_[number + 1][k], &number_[number + 2][k]};
  }

  /// self_add() of lib/self_collide.h: what is added.
  HWY_INLINE void add_up(D d, size_t k) {
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.F), no_way = hn::Set(d, shader::kSelfNoWay);
    const Points<D> apart = load(d, row(kApart, k)), way = load(d, row(kWay, k)), before = sub(apart, way);
    const auto share = hn::LoadU(d, &number_[kShare][k]);
    const UnitAndLength<D> now = unit_and_length(d, apart), then = unit_and_length(d, before);
    const auto past = hn::And(hn::Lt(dot(d, apart, before), zero), hn::Gt(then.length, no_way));
    const Points<D> n = choose<D>(past, then.unit, now.unit);
    const auto depth = hn::Sub(hn::LoadU(d, &number_[kDistance][k]), dot(d, apart, n));
    const auto touches = hn::And(hn::Gt(depth, zero), hn::Or(past, hn::Gt(now.length, no_way)));
    const auto along = dot(d, way, n);
    const Points<D> sliding = sub(way, scale(d, n, along));
    const auto slid = length(d, sliding), brake = hn::Mul(hn::LoadU(d, &number_[kFriction][k]), depth);
    const auto held = hn::IfThenElse(hn::Gt(slid, brake), hn::Mul(brake, hn::Div(one, slid)), one);
    const Points<D> braked = scale(d, sliding, held);
    const auto inwards = hn::Min(depth, hn::Max(hn::Neg(along), zero));
    store(d, only<D>(touches, scale(d, sub(scale(d, n, depth), braked), share)), row(kShift, k));
    store(d, only<D>(touches, scale(d, sub(scale(d, n, inwards), braked), share)), row(kImpulse, k));
  }

  std::array<uint32_t, kMost> point_;
  std::array<std::array<float, kRoom>, kNumbers> number_{};
  uint32_t count_ = 0;
};

/// self_push() of lib/self_collide.h. A point has few neighbours, and gathers of them take longer than loads.
template <class D>
HWY_NOINLINE void self_push(D d, SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                            uint32_t first, uint32_t last) {
  const FourLanes four;
  constexpr uint32_t kAtOnce = 4;
  const uint32_t* const words = set.data->words.data();
  const float* const places = arrays.place.data();
  const auto distance2 = hn::Set(four, room.distance * room.distance);
  TouchingPairs<D> pairs;
  for (uint32_t point = first; point < last; ++point) {
    const uint32_t count = words[shader::self_count_word(room, point)];
    arrays.pushed[point] = 0;
    if (count == 0 || self_is_held(set, room, point)) continue;
    const Points<FourLanes> at = in_all_lanes(four, arrays.position.at(point));
    const uint32_t* const neighbors = words + shader::self_neighbor_word(room, point, 0);
    for (uint32_t k = 0; k < count; k += kAtOnce) {
      std::array<uint32_t, kAtOnce> some;
      for (uint32_t n = 0; n < kAtOnce; ++n) some[n] = neighbors[std::min(k + n, count - 1)];
      const Points<FourLanes> apart = sub(at, load_four(places, some.data()));
      const auto touches = hn::And(hn::Lt(dot(four, apart, apart), distance2), hn::FirstN(four, count - k));
      for (uint32_t bits = bits_of(four, touches); bits != 0; bits &= bits - 1) {
        const uint32_t neighbor = neighbors[k + static_cast<uint32_t>(std::countr_zero(bits))];
        const shader::SelfPair pair = self_pair(set, room, self_point(set, point), neighbor);
        pairs.add(point, pair, self_state(set, room, point), self_state(set, room, pair.other));
      }
    }
    if (!pairs.has_room()) pairs.push(d, arrays, set, room);
  }
  pairs.push(d, arrays, set, room);
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
