// SPDX-License-Identifier: Apache-2.0
// Structure of arrays for the cpu: the images' texels taken apart.

#include "cpu/cloth_state.h"

#include <algorithm>
#include <utility>

namespace geocloth::cpu {

ClothState::ClothState(ClothData cloth_data, bool accumulate, bool fine)
    : data(std::move(cloth_data)),
      position(pixel_count() + kOverhang, 0),
      previous(pixel_count() + kOverhang, 3),
      carry(pixel_count() + kOverhang, 6),
      normal(pixel_count() + kOverhang, 9),
      offset(fine ? pixel_count() + kOverhang : 0, 12),
      inverse_mass(make_floats(pixel_count() + kOverhang, 15)),
      normal_length(make_floats(pixel_count() + kOverhang, 16)),
      yield(make_floats(pixel_count() + kOverhang, 17)),
      row_yields(data.height, 0) {
  std::fill(yield.begin(), yield.end(), 1.F);
  for (size_t i = 0; i < pixel_count(); ++i) {
    const shader::vec4& p = data.position[i];
    position.set(i, {p.x, p.y, p.z});
    inverse_mass[i] = p.w;
  }
  previous = position;
  for (uint32_t c = 0; c < shader::kSpringComponents; ++c) {
    rest[c].resize(pixel_count());
    compliance[c].resize(pixel_count());
    if (accumulate) multiplier[c].resize(pixel_count());
  }
  take_springs();
}

void ClothState::set_packed_mass(size_t i, float packed) {
  inverse_mass[i] = shader::inverse_mass_of(packed);
  set_yield(i, shader::yield_of(packed));
}

void ClothState::forget() {
  for (Vec3Array* v : {&position, &previous, &carry, &normal, &offset})
    for (Floats* axis : {&v->x, &v->y, &v->z}) std::fill(axis->begin(), axis->end(), 0.F);
  std::fill(normal_length.begin(), normal_length.end(), 0.F);
  std::fill(yield.begin(), yield.end(), 1.F);
  std::fill(row_yields.begin(), row_yields.end(), uint8_t{0});
  for (auto& values : multiplier) std::fill(values.begin(), values.end(), 0.F);
  std::fill(seam_multiplier.begin(), seam_multiplier.end(), 0.F);
  std::fill(kept_in_lines.begin(), kept_in_lines.end(), KeptInLine{});
}

void ClothState::set_topology(ClothData cloth_data) {
  data = std::move(cloth_data);
  take_springs();
}

void ClothState::take_springs() {
  for (uint32_t c = 0; c < shader::kSpringComponents; ++c) {
    for (size_t i = 0; i < pixel_count(); ++i) {
      const shader::vec4& s = data.springs[c / 2][i];
      rest[c][i] = c % 2 == 0 ? s.x : s.z;
      compliance[c][i] = c % 2 == 0 ? s.y : s.w;
    }
  }
  data.position = {};
  data.springs = {};
  const bool accumulate = !multiplier[0].empty();
  if (accumulate) seam_multiplier.resize(data.seam_springs.size());
  if (data.attachments) attachments.resize(pixel_count(), {shader::kNoAnchor, 0});
}

size_t ClothState::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  size_t sum = bytes(inverse_mass) + bytes(normal_length) + bytes(yield) + bytes(row_yields) + bytes(seam_multiplier) +
               bytes(attachments) + bytes(kept_in_lines) + bytes(data.cell) + bytes(data.seam_springs) +
               bytes(data.split_offset) + bytes(data.split_pixel) + data.self.memory_bytes();
  for (const Vec3Array* v : {&position, &previous, &carry, &normal, &offset})
    sum += bytes(v->x) + bytes(v->y) + bytes(v->z);
  for (const auto* components : {&rest, &compliance, &multiplier})
    for (const auto& values : *components) sum += bytes(values);
  return sum;
}

}  // namespace geocloth::cpu
