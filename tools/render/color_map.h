// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/picture.h"

namespace geocloth {

/// Linear light, sRGB primaries, usually 0..1.
struct LinearColor {
  float r = 0, g = 0, b = 0;
};
[[nodiscard]] inline LinearColor operator+(const LinearColor& a, const LinearColor& b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
[[nodiscard]] inline LinearColor operator*(const LinearColor& a, float s) {
  return {a.r * s, a.g * s, a.b * s};
}
[[nodiscard]] LinearColor to_linear(Color color);
[[nodiscard]] Color to_srgb(const LinearColor& color);

/// t in 0..1 (clamped; NaN counts as 0).
/// sequential: dark violet to yellow (viridis). diverging: blue, pale grey in the middle, red (Moreland's cool-warm).
[[nodiscard]] Color sequential_color(float t);
[[nodiscard]] Color diverging_color(float t);

/// The n-th of an endless row of colours that are told apart well: hues a golden angle apart.
[[nodiscard]] Color distinct_color(uint32_t n);
/// The colour of a seam, the same in every picture.
[[nodiscard]] Color seam_color(uint32_t seam);
/// The same colour, lighter (factor > 1) or darker (factor < 1).
[[nodiscard]] Color shaded(Color color, float factor);

}  // namespace geocloth
