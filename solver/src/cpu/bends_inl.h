// SPDX-License-Identifier: Apache-2.0
// Bends over three pixels in a row, in vectors; see lib/bend.h. Along a row all three groups are done at once: the row
// is taken apart into the columns whose number modulo 3 is 0, 1 and 2, so that every group has its first, middle and
// last pixels next to each other, and put together again after the last group.
#if defined(GEOCLOTH_CPU_BENDS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_BENDS_INL_H
#undef GEOCLOTH_CPU_BENDS_INL_H
#else
#define GEOCLOTH_CPU_BENDS_INL_H
#endif

#include <algorithm>
#include <array>

#include "cpu/constraints_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// Floats of a block's constants.
constexpr size_t bend_floats(size_t lanes, bool several) {
  return (several ? 4 : 3) * lanes;
}

/// A constraint's direction and length, for as many as a vector has lanes. Members one by one, because compilers copy
/// structs of structs of vectors through memory.
template <class D>
struct Ways {
  Vec<D> x, y, z, length;

  HWY_INLINE Ways() {}  // NOLINT(modernize-use-equals-default): a default one is not of the instruction set at hand
  HWY_INLINE void set(D d, const Points<D>& way) {
    x = way.x;
    y = way.y;
    z = way.z;
    length = hn::Sqrt(dot(d, way, way));
  }
  HWY_INLINE void take(const Ways& other) {
    x = other.x;
    y = other.y;
    z = other.z;
    length = other.length;
  }
  HWY_INLINE Points<D> scaled(Vec<D> s) const { return {hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s)}; }
};

/// Blocks first .. last - 1: begin(block, state) and then finish(block, state). The roots of a block are under way
/// while the block before is finished; one after the other, what waits for them fills the processor's queues, and all
/// takes a third longer. Blocks may share pixels, but no constraint's: finish() reads what it writes.
template <class State, class Begin, class Finish>
HWY_INLINE void overlapped(uint32_t first, uint32_t last, const Begin& begin, const Finish& finish) {
  if (first >= last) return;
  State now, next;
  begin(first, now);
  for (uint32_t k = first + 1; k < last; ++k) {
    begin(k, next);
    finish(k - 1, now);
    now.take(next);
  }
  finish(last - 1, now);
}

template <class D>
HWY_INLINE Vec<D> chord_of(D d, const float* constants) {
  return hn::LoadU(d, constants + 2 * hn::Lanes(d));
}
template <class D>
HWY_INLINE Vec<D> back_of(D d, const float* constants) {
  return hn::Sub(hn::Set(d, 1.F), chord_of(d, constants));
}

/// What the three points of a bend are moved by.
template <class D>
struct BendWeights {
  Vec<D> a, middle, b;
};

/// lib/bend.h with inverse = 1 / (w + compliance), 0 where there is no bend.
template <class D>
HWY_INLINE Points<D> bend_way(D d, const Points<D>& to_a, const Points<D>& to_b, const float* constants) {
  const auto chord = chord_of(d, constants), back = back_of(d, constants);
  return add(scale(d, to_a, back), scale(d, to_b, chord));
}
template <bool kSeveral, class D>
HWY_INLINE void project_bend(D d, const Ways<D>& ways, Points<D>& a, Points<D>& middle, Points<D>& b,
                             const BendWeights<D>& w, const float* constants,
                             const Multipliers<kSeveral, D>& multipliers) {
  const size_t lanes = hn::Lanes(d);
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + lanes);
  const auto factor = change_over_length(d, ways.length, rest, inverse, constants + 3 * lanes, multipliers,
                                         [](Vec<D> error) GEOCLOTH_LANES { return error; });
  const Points<D> step = ways.scaled(factor);
  a = sub(a, scale(d, step, w.a));
  middle = add(middle, scale(d, step, w.middle));
  b = sub(b, scale(d, step, w.b));
}

/// Lanes whose bit is set from one vector, all others from another.
template <uint32_t kBits, class D>
HWY_INLINE Vec<D> lanes_from(D d, Vec<D> yes, Vec<D> no) {
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32
  if constexpr (hn::MaxLanes(D()) == 8) return Vec<D>{_mm256_blend_ps(no.raw, yes.raw, kBits & 0xFF)};
#endif
  const hn::RebindToUnsigned<D> du;
  const auto bit = hn::Shl(hn::Set(du, 1), hn::Iota(du, 0));
  return hn::IfThenElse(hn::RebindMask(d, hn::TestBit(hn::Set(du, kBits), bit)), yes, no);
}

/// Three vectors of neighbouring columns taken apart into those whose number modulo 3 is 0, 1 and 2, in their order.
/// 4, 8 and 16 are no multiples of 3, so the vectors' lanes of one residue complement each other: a blend brings them
/// together and one look-up into their order.
template <class D>
struct Third {
  Vec<D> a, middle, b;
};
template <class D>
class Thirds {
 public:
  explicit HWY_INLINE Thirds(D d)
      : first_(ordered<0>(d)),
        second_(ordered<1>(d)),
        third_(ordered<2>(d)),
        from_first_(spread<0>(d)),
        from_second_(spread<1>(d)),
        from_third_(spread<2>(d)) {}

  HWY_INLINE Third<D> take_apart(D d, const float* p) const {
    const auto low = hn::LoadU(d, p), mid = hn::LoadU(d, p + kLanes), high = hn::LoadU(d, p + 2 * kLanes);
    return {hn::TableLookupLanes(of_residue<0>(d, low, mid, high), first_),
            hn::TableLookupLanes(of_residue<1>(d, low, mid, high), second_),
            hn::TableLookupLanes(of_residue<2>(d, low, mid, high), third_)};
  }
  HWY_INLINE void put_together(D d, Vec<D> a, Vec<D> middle, Vec<D> b, float* p) const {
    const auto first = hn::TableLookupLanes(a, from_first_), second = hn::TableLookupLanes(middle, from_second_);
    const auto third = hn::TableLookupLanes(b, from_third_);
    hn::StoreU(of_vector<0>(d, first, second, third), d, p);
    hn::StoreU(of_vector<1>(d, first, second, third), d, p + kLanes);
    hn::StoreU(of_vector<2>(d, first, second, third), d, p + 2 * kLanes);
  }

 private:
  static constexpr uint32_t kLanes = hn::MaxLanes(D());
  using Table = decltype(hn::SetTableIndices(D(), static_cast<const int32_t*>(nullptr)));

  /// Lanes whose number is that modulo 3.
  static constexpr uint32_t lanes_modulo_three(uint32_t residue) {
    uint32_t bits = 0;
    for (uint32_t lane = residue % 3; lane < kLanes; lane += 3) bits |= 1U << lane;
    return bits;
  }
  template <uint32_t kResidue>
  static HWY_INLINE Vec<D> of_residue(D d, Vec<D> low, Vec<D> mid, Vec<D> high) {
    constexpr uint32_t kOfMid = lanes_modulo_three(kResidue + 2 * kLanes);  // -kLanes modulo 3
    return lanes_from<lanes_modulo_three(kResidue)>(d, low, lanes_from<kOfMid>(d, mid, high));
  }
  template <uint32_t kVector>
  static HWY_INLINE Vec<D> of_vector(D d, Vec<D> first, Vec<D> second, Vec<D> third) {
    constexpr uint32_t kOfFirst = lanes_modulo_three(2 * kVector * kLanes);
    constexpr uint32_t kOfSecond = lanes_modulo_three(1 + 2 * kVector * kLanes);
    return lanes_from<kOfFirst>(d, first, lanes_from<kOfSecond>(d, second, third));
  }
  /// The n-th column of a residue is in this lane of its vector.
  static constexpr uint32_t lane_of(uint32_t n, uint32_t residue) { return (3 * n + residue) % kLanes; }
  using Lanes = std::array<int32_t, kLanes>;
  static constexpr Lanes lanes_of(uint32_t residue) {
    Lanes from{};
    for (uint32_t n = 0; n < kLanes; ++n) from[n] = static_cast<int32_t>(lane_of(n, residue));
    return from;
  }
  static constexpr Lanes places_in(uint32_t residue) {
    Lanes from{};
    for (uint32_t n = 0; n < kLanes; ++n) from[lane_of(n, residue)] = static_cast<int32_t>(n);
    return from;
  }
  template <uint32_t kResidue>
  static HWY_INLINE Table ordered(D d) {
    static constexpr Lanes kFrom = lanes_of(kResidue);
    return hn::SetTableIndices(d, kFrom.data());
  }
  template <uint32_t kResidue>
  static HWY_INLINE Table spread(D d) {
    static constexpr Lanes kFrom = places_in(kResidue);
    return hn::SetTableIndices(d, kFrom.data());
  }

  Table first_, second_, third_, from_first_, from_second_, from_third_;
};

/// Where the three points of bends are, from some pixel on.
template <bool kOnOffsets>
struct BendLines {
  PointsOf<kOnOffsets> a, middle, b;
};

/// Blocks of bends whose first points lie at stream.pixel of their line.
/// @param kYields  whether the lines have yields that may be below 1
template <bool kSeveral, bool kYields, bool kOnOffsets, class D>
HWY_INLINE void project_bends(D d, const SweepOp& op, const BendLines<kOnOffsets>& lines, uint32_t first,
                              uint32_t last) {
  const size_t lanes = hn::Lanes(d);
  const uint32_t* const pixel = op.stream->pixel.data();
  const float* const constants = op.stream->constants.data();
  const size_t floats = bend_floats(lanes, kSeveral);
  overlapped<Ways<D>>(
      first, last,
      [&](uint32_t k, Ways<D>& ways) GEOCLOTH_LANES {
        const size_t i = pixel[k];
        ways.set(d, bend_way(d, way_between(d, lines.middle, i, lines.a, i),
                             way_between(d, lines.middle, i, lines.b, i), constants + k * floats));
      },
      [&](uint32_t k, const Ways<D>& ways) GEOCLOTH_LANES {
        const size_t i = pixel[k];
        Points<D> a = load(d, lines.a.at(i)), middle = load(d, lines.middle.at(i)), b = load(d, lines.b.at(i));
        BendWeights<D> w{hn::LoadU(d, lines.a.inverse_mass + i), hn::LoadU(d, lines.middle.inverse_mass + i),
                         hn::LoadU(d, lines.b.inverse_mass + i)};
        w.a = hn::Mul(w.a, back_of(d, constants + k * floats));
        w.b = hn::Mul(w.b, chord_of(d, constants + k * floats));
        if constexpr (kYields) {
          w.a = hn::Mul(w.a, hn::LoadU(d, lines.a.yield + i));
          w.middle = hn::Mul(w.middle, hn::LoadU(d, lines.middle.yield + i));
          w.b = hn::Mul(w.b, hn::LoadU(d, lines.b.yield + i));
        }
        project_bend(d, ways, a, middle, b, w, constants + k * floats, Multipliers<kSeveral, D>(op, k, lanes));
        const size_t j = anew(i);
        store(d, a, lines.a.at(j));
        store(d, middle, lines.middle.at(j));
        store(d, b, lines.b.at(j));
      });
}

template <bool kSeveral, bool kYields, bool kOnOffsets, class D>
HWY_NOINLINE void bends_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  using Base = PointsOf<kOnOffsets>;
  const size_t offset = op.offset;
  const BendLines<kOnOffsets> lines{Base(state, 0), Base(state, offset), Base(state, 2 * offset)};
  project_bends<kSeveral, kYields>(d, op, lines, first, last);
}

/// A row that is taken apart: of each residue modulo 3 every coordinate and the inverse mass times the yield,
/// `op.offset` floats apart; then of each the coordinates of the bases, if there are any.
class ThirdRow {
 public:
  ThirdRow(float* scratch, size_t stride) : scratch_(scratch), stride_(stride) {}

  /// From the n-th column of a residue on: coordinate 0, 1, 2, or 3 for the mass, or 4, 5, 6 of the base.
  [[nodiscard]] HWY_INLINE float* at(size_t residue, size_t coordinate, size_t n) const {
    const size_t line = coordinate < 4 ? 4 * residue + coordinate : 12 + 3 * residue + (coordinate - 4);
    return scratch_ + line * stride_ + n;
  }
  /// The columns column, column + 3, ...
  template <bool kOnOffsets>
  [[nodiscard]] HWY_INLINE PointsOf<kOnOffsets> from(size_t column) const {
    const size_t r = column % 3, n = column / 3;
    const PointBase points(at(r, 0, n), at(r, 1, n), at(r, 2, n), at(r, 3, n), nullptr);
    if constexpr (kOnOffsets) {
      return {points, at(r, 4, n), at(r, 5, n), at(r, 6, n)};
    } else {
      return points;
    }
  }

 private:
  float* scratch_;
  size_t stride_;
};

/// Calls body(third) for vectors of a row's thirds; the last one ends within the row. What lies between them in the
/// scratch is of other rows: lanes of blocks without a bend read it, and write it again.
template <class D, class Body>
HWY_INLINE void for_thirds(D d, const ClothState& state, const RowStream& stream, uint32_t y, const Body& body) {
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  const uint32_t latest = state.data.width / 3 - lanes;
  for (uint32_t k = stream.third_first[y]; k < stream.third_first[y + 1]; ++k) {
    const Run run = stream.thirds[k];
    for (uint32_t n = run.first; n < run.last; n += lanes) body(std::min(n, latest));
  }
}

/// Groups 0, 1 and 2 of bend_groups.h in some rows, group by group: what waits for roots in one row goes on in the
/// next.
template <bool kSeveral, bool kOnOffsets, class D>
HWY_NOINLINE void bends_along(D d, const SweepOp& op, ClothState& state, bool yields, const SweepFrame& frame,
                              const RowRange& rows) {
  const RowStream& stream = *op.stream;
  const Thirds<D> thirds(d);
  const size_t width = state.data.width;
  const auto apart = [&](uint32_t y) GEOCLOTH_LANES {
    return ThirdRow(frame.scratch + third_row(y, frame.sweep->strip, op.offset, kOnOffsets), op.offset);
  };
  for (uint32_t y = rows.first; y < rows.last; ++y) {
    const ThirdRow row = apart(y);
    const PointsOf<kOnOffsets> points(state, y * width);
    for_thirds(d, state, stream, y, [&](uint32_t n) GEOCLOTH_LANES {
      const auto take_apart = [&](const float* p, size_t coordinate) GEOCLOTH_LANES {
        const Third<D> third = thirds.take_apart(d, p + 3 * size_t{n});
        hn::StoreU(third.a, d, row.at(0, coordinate, n));
        hn::StoreU(third.middle, d, row.at(1, coordinate, n));
        hn::StoreU(third.b, d, row.at(2, coordinate, n));
      };
      take_apart(points.x, 0);
      take_apart(points.y, 1);
      take_apart(points.z, 2);
      take_apart(points.inverse_mass, 3);
      if constexpr (kOnOffsets) {
        take_apart(points.base_x, 4);
        take_apart(points.base_y, 5);
        take_apart(points.base_z, 6);
      }
      if (!yields) return;
      const Third<D> yield = thirds.take_apart(d, points.yield + 3 * size_t{n});
      const auto lessen = [&](size_t residue, Vec<D> by) GEOCLOTH_LANES {
        float* const mass = row.at(residue, 3, n);
        hn::StoreU(hn::Mul(hn::LoadU(d, mass), by), d, mass);
      };
      lessen(0, yield.a);
      lessen(1, yield.middle);
      lessen(2, yield.b);
    });
  }
  const ThirdRow all(frame.scratch, op.offset);
  const auto project = [&](uint32_t group) GEOCLOTH_LANES {
    const uint32_t* const first = &stream.group_first[group * (size_t{state.data.height} + 1)];
    const BendLines<kOnOffsets> lines{all.from<kOnOffsets>(group), all.from<kOnOffsets>(group + 1),
                                      all.from<kOnOffsets>(group + 2)};
    project_bends<kSeveral, false>(d, op, lines, first[rows.first], first[rows.last]);
  };
  const bool back = op.order == BendOrder::backward;
  for (const uint32_t group : {back ? 2U : 0U, 1U, back ? 0U : 2U}) project(group);
  if (op.order == BendOrder::there_and_back) {
    for (const uint32_t group : {1U, 0U}) project(group);
  }
  for (uint32_t y = rows.first; y < rows.last; ++y) {
    const ThirdRow row = apart(y);
    const PointsOf<kOnOffsets> points(state, y * width);
    for_thirds(d, state, stream, y, [&](uint32_t n) GEOCLOTH_LANES {
      const auto put_together = [&](float* p, size_t c) GEOCLOTH_LANES {
        thirds.put_together(d, hn::LoadU(d, row.at(0, c, n)), hn::LoadU(d, row.at(1, c, n)),
                            hn::LoadU(d, row.at(2, c, n)), p + 3 * size_t{n});
      };
      put_together(points.x, 0);
      put_together(points.y, 1);
      put_together(points.z, 2);
    });
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
