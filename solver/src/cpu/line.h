// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <type_traits>

#include "cpu/cloth_state.h"
#include "lib/vector.h"

/// Before a loop in which no turn reads what another one writes, as with the constraints of a group, which share no
/// pixel: then it vectorises. Floats that a reference leads to might be among those that are written: copy them first.
#ifdef __clang__
#define GEOCLOTH_INDEPENDENT_TURNS _Pragma("clang loop vectorize(assume_safety)")
#else
#define GEOCLOTH_INDEPENDENT_TURNS _Pragma("GCC ivdep")
#endif

namespace geocloth::cpu {

/// ClothParams::fine as a constant of the compiler.
template <uint32_t value>
using Fine = std::integral_constant<uint32_t, value>;

/// Calls body(Fine<...>()).
template <class Body>
void with_fine(uint32_t fine, const Body& body) {
  if (fine == shader::kFineOff) return body(Fine<shader::kFineOff>());
  if (fine == shader::kFineOffsets) return body(Fine<shader::kFineOffsets>());
  body(Fine<shader::kFineMomentum>());
}

/// Points from a pixel on, as raw pointers: their positions, or with lib/fine.h their offsets.
struct PointLine {
  struct Coordinates {
    float *x, *y, *z;
    Coordinates(float* px, float* py, float* pz) : x(px), y(py), z(pz) {}
    Coordinates(Vec3Array& a, size_t first) : x(a.x.data() + first), y(a.y.data() + first), z(a.z.data() + first) {}
    [[nodiscard]] shader::vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
    [[nodiscard]] Coordinates from(size_t i) const { return {x + i, y + i, z + i}; }
  };
  Coordinates moving, base, low;
  const float* inverse_mass;
  const float* yield;  ///< lib/yield.h; null: all are 1

  PointLine(ClothState& state, size_t first, uint32_t fine)
      : moving(fine != shader::kFineOff ? state.offset : state.position, first),
        base(state.previous, first),
        low(state.carry, first),
        inverse_mass(state.inverse_mass.data() + first),
        yield(state.has_yields ? state.yield.data() + first : nullptr) {}
  PointLine(const Coordinates& m, const Coordinates& b, const Coordinates& l, const float* weights, const float* yields)
      : moving(m), base(b), low(l), inverse_mass(weights), yield(yields) {}
  /// The line that begins at point i.
  [[nodiscard]] PointLine from(size_t i) const {
    return {moving.from(i), base.from(i), low.from(i), inverse_mass + i, yield != nullptr ? yield + i : nullptr};
  }
  [[nodiscard]] float yield_at(size_t i) const { return yield != nullptr ? yield[i] : 1.F; }
  /// Moves point i by step * weight.
  void move(size_t i, const shader::vec3& step, float weight) const {
    const shader::vec3 p = shader::shifted(moving.at(i), step, weight);
    moving.x[i] = p.x;
    moving.y[i] = p.y;
    moving.z[i] = p.z;
  }
};

/// From point i of one line to that of another.
template <uint32_t fine>
[[nodiscard]] inline shader::vec3 way_between(const PointLine& a, const PointLine& b, size_t i, Fine<fine> /*mode*/) {
  const shader::vec3 d = b.moving.at(i) - a.moving.at(i);
  if constexpr (fine == shader::kFineOff) return d;
  return (b.base.at(i) - a.base.at(i)) + d;
}

/// The same when the substep began; only with offsets.
[[nodiscard]] inline shader::vec3 first_way_between(const PointLine& a, const PointLine& b, size_t i) {
  return (b.base.at(i) - a.base.at(i)) + (b.low.at(i) - a.low.at(i));
}

}  // namespace geocloth::cpu
