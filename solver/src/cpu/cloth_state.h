// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "backend.h"
#include "shared/layout.h"

namespace geocloth::cpu {

/// The longest vectors may reach this many pixels over the end of a row, and leave what is there as it is.
inline constexpr uint32_t kOverhang = 15;

/// Three floats per pixel, one array for each: rows are contiguous, so springs of a row vectorise.
struct Vec3Array {
  std::vector<float> x, y, z;

  explicit Vec3Array(size_t size = 0) : x(size), y(size), z(size) {}
  [[nodiscard]] shader::vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
  void set(size_t i, const shader::vec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// One cloth as the cpu backend keeps it; see shared/layout.h for what the arrays mean.
struct ClothState {
  ClothState(ClothData cloth_data, bool accumulate, bool fine);

  [[nodiscard]] size_t pixel_count() const { return static_cast<size_t>(data.width) * data.height; }
  [[nodiscard]] size_t memory_bytes() const;  ///< of all arrays
  /// Takes over springs, cells, bends over seams and copies; positions stay.
  void set_topology(ClothData cloth_data);

  ClothData data;  ///< position and springs have moved to the arrays below
  Vec3Array position, previous, carry, normal;
  Vec3Array offset;                                ///< only with ClothParams::fine
  std::vector<float> inverse_mass, normal_length;  ///< like the vectors, with kOverhang more than there are pixels
  std::array<std::vector<float>, shader::kSpringComponents> rest, compliance;
  std::array<std::vector<float>, shader::kSpringComponents> multiplier;  ///< only with several relaxation steps
  std::vector<float> seam_multiplier;
  std::vector<shader::Attachment> attachments;

 private:
  void take_springs();
};

}  // namespace geocloth::cpu
