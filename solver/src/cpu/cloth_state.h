// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <vector>

#include "backend.h"
#include "lib/lines.h"
#include "lib/point_state.h"
#include "lib/yield.h"
#include "shared/layout.h"

namespace geocloth::cpu {

/// The longest vectors, two for springs along a row, may reach this many pixels over its end, and leave what is there
/// as it is.
inline constexpr uint32_t kOverhang = 31;
/// Floats of a cache line.
inline constexpr uint32_t kLineOfFloats = 16;

/// Memory that begins at a cache line: array `slot` at the 5 * slot-th one of its page, because lines at the same place
/// of all pages share a few places of the cache.
template <class T>
struct LineAllocator {
  using value_type = T;
  using is_always_equal = std::false_type;
  static constexpr std::align_val_t kLine{kLineOfFloats * sizeof(float)};

  uint32_t slot = 0;

  LineAllocator() = default;
  explicit LineAllocator(uint32_t of_slot) : slot(of_slot) {}
  template <class U>
  explicit LineAllocator(const LineAllocator<U>& other) : slot(other.slot) {}

  [[nodiscard]] size_t offset() const { return slot * 5 % 64 * 64 / sizeof(T); }
  T* allocate(size_t count) {
    return static_cast<T*>(::operator new((count + offset()) * sizeof(T), kLine)) + offset();
  }
  void deallocate(T* p, size_t) { ::operator delete(p - offset(), kLine); }
  bool operator==(const LineAllocator& other) const { return slot == other.slot; }
};
using Floats = std::vector<float, LineAllocator<float>>;
/// Zeros.
[[nodiscard]] inline Floats make_floats(size_t size, uint32_t slot) {
  return Floats(size, LineAllocator<float>(slot));
}

/// Three floats per pixel, one array for each: rows are contiguous, so springs of a row vectorise.
struct Vec3Array {
  Floats x, y, z;

  Vec3Array(size_t size, uint32_t slot)
      : x(make_floats(size, slot)), y(make_floats(size, slot + 1)), z(make_floats(size, slot + 2)) {}
  [[nodiscard]] shader::vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
  void set(size_t i, const shader::vec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// Of a point and the spring that begins there, what one sweep along a line leaves for the next.
struct KeptInLine {
  shader::LineSpring spring;
  shader::LinePoint point;
  float multiplier;
};

/// One cloth as the cpu backend keeps it; see shared/layout.h for what the arrays mean.
struct ClothState {
  ClothState(ClothData cloth_data, bool accumulate, bool fine);

  [[nodiscard]] size_t pixel_count() const { return static_cast<size_t>(data.width) * data.height; }
  [[nodiscard]] shader::PointState point(size_t i) const { return {position.at(i), previous.at(i), carry.at(i)}; }
  void set_point(size_t i, const shader::PointState& point) {
    position.set(i, point.position);
    previous.set(i, point.previous);
    carry.set(i, point.carry);
  }
  [[nodiscard]] size_t memory_bytes() const;  ///< of all arrays
  [[nodiscard]] float yield_at(size_t i) const { return has_yields ? yield[i] : 1.F; }
  /// What pixel i keeps beside its position in an image.
  [[nodiscard]] float packed_mass(size_t i) const { return shader::with_yield(inverse_mass[i], yield[i]); }
  void set_packed_mass(size_t i, float packed);
  /// Several threads may at once, each for pixels of its own.
  void set_yield(size_t i, float value) {
    yield[i] = value;
    if (value != 1) mark_yielding(i / data.width, true);
  }
  /// Says whether a row may have points whose yield is not 1.
  void mark_yielding(size_t row, bool yields) {
    std::atomic_ref(row_yields[row]).store(yields ? 1 : 0, std::memory_order_relaxed);
  }
  /// Whether some rows have such points. Rows that nobody works on may be asked for too many.
  [[nodiscard]] bool yields_in(uint32_t first_row, uint32_t last_row) {
    const uint32_t last = std::min(last_row, data.height);
    for (uint32_t y = first_row; has_yields && y < last; ++y)
      if (std::atomic_ref(row_yields[y]).load(std::memory_order_relaxed) != 0) return true;
    return false;
  }
  /// Forgets all that frames have left, as well where there is no cloth: a number that is not finite would come back
  /// from there. Constants and masses stay.
  void forget();
  /// Takes over springs, cells, bends over seams and copies; positions and masses stay.
  void set_topology(ClothData cloth_data);

  ClothData data;  ///< position and springs have moved to the arrays below
  Vec3Array position, previous, carry, normal;
  Vec3Array offset;                    ///< only with ClothParams::fine
  Floats inverse_mass, normal_length;  ///< like the vectors, with kOverhang more than there are pixels
  Floats yield;                        ///< the same, see lib/yield.h
  std::vector<uint8_t> row_yields;     ///< rows with points whose yield is not 1
  bool has_yields = false;             ///< colliders are there in this frame: yields count
  std::array<std::vector<float>, shader::kSpringComponents> rest, compliance;
  std::array<std::vector<float>, shader::kSpringComponents> multiplier;  ///< only with several relaxation steps
  std::vector<float> seam_multiplier;
  std::vector<shader::Attachment> attachments;
  std::vector<ContactSum> contacts;  ///< of the last frame, one for each collider that the cloth met; see backend.h
  std::vector<KeptInLine> kept_in_lines;  ///< as many as pixels, once the pass lines has run by itself

 private:
  void take_springs();
};

}  // namespace geocloth::cpu
