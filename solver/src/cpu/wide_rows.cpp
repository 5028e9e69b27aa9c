// SPDX-License-Identifier: Apache-2.0
// Every number of a pixel is translated on its way in, so that nothing behind knows of it. Rows that are a multiple of
// half a kilobyte apart would meet at a few places of the cache: they get one line more.

#include "cpu/wide_rows.h"

#include <algorithm>

#include "cpu/cloth_state.h"
#include "lib/self_words.h"

namespace geocloth::cpu {
namespace {

constexpr uint32_t kCrowded = 8;  ///< lines
constexpr uint32_t kThirds = 2;   ///< columns at the end of a row that may not make up a third

uint32_t wide(uint32_t width) {
  uint32_t lines = (width + kThirds + kLineOfFloats - 1) / kLineOfFloats;
  if (lines % kCrowded == 0) ++lines;
  return kLineOfFloats * lines;
}

}  // namespace

WideRows::WideRows(uint32_t width) : width_(width), wide_(wide(width)) {}

template <class T>
void WideRows::widen(std::span<const T> from, const T& nothing, std::vector<T>& to) const {
  const size_t rows = from.size() / width_;
  to.assign(rows * wide_, nothing);
  for (size_t y = 0; y < rows; ++y) {
    const auto row = from.subspan(y * width_, width_);
    std::copy(row.begin(), row.end(), to.begin() + static_cast<std::ptrdiff_t>(y * wide_));
  }
}

ClothData WideRows::widened(const ClothData& data) const {
  ClothData r = data;
  r.width = wide_;
  constexpr shader::vec4 kNothing{0, 0, 0, 0};
  widen<shader::vec4>(data.position, kNothing, r.position);
  for (size_t k = 0; k < data.springs.size(); ++k) widen<shader::vec4>(data.springs[k], kNothing, r.springs[k]);
  widen<uint32_t>(data.cell, 0, r.cell);
  for (shader::SeamSpring& s : r.seam_springs) {
    s.a = pixel(s.a);
    s.middle = pixel(s.middle);
    s.b = pixel(s.b);
    s.beside = pixel(s.beside);
  }
  for (uint32_t& p : r.split_pixel) p = pixel(p);
  for (shader::SelfPoint& p : r.self.points) p.pixel = pixel(p.pixel);
  if (data.self.words.empty()) return r;
  // The words begin with a header and the point of each pixel.
  const size_t begin = shader::self_point_word(0), count = size_t{width_} * data.height;
  std::vector<uint32_t> points;
  widen<uint32_t>(std::span(data.self.words).subspan(begin, count), shader::kSelfNone, points);
  const auto first = data.self.words.begin() + static_cast<std::ptrdiff_t>(begin);
  r.self.words.assign(data.self.words.begin(), first);
  r.self.words.insert(r.self.words.end(), points.begin(), points.end());
  r.self.words.insert(r.self.words.end(), first + static_cast<std::ptrdiff_t>(count), data.self.words.end());
  return r;
}

void WideRows::widen(const ClothFrame& frame, ClothFrame& wide) const {
  wide.params = frame.params;
  wide.params.width = wide_;
  wide.pins = frame.pins;
  for (shader::PinTarget& pin : wide.pins) pin.pixel.x = pixel(pin.pixel.x);
  wide.cell_rounds = frame.cell_rounds;
  wide.asleep = frame.asleep;
  wide.pins_changed = frame.pins_changed;
  if (!frame.pins_changed) return;
  widen<float>(frame.inverse_mass, 0, wide.inverse_mass);
  widen<shader::Attachment>(frame.attachments, {shader::kNoAnchor, 0}, wide.attachments);
  for (shader::Attachment& a : wide.attachments)
    if (a.anchor != shader::kNoAnchor) a.anchor = pixel(a.anchor);
}

}  // namespace geocloth::cpu
