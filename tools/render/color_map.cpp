// SPDX-License-Identifier: GPL-3.0-or-later
// Colour maps by interpolation of published anchors: viridis (Smith and van der Walt 2015, matplotlib) is even in
// lightness and fit for colour-blind eyes; cool-warm (Moreland 2009, "Diverging Color Maps for Scientific
// Visualization") has a middle that reads as "nothing here".
#include "render/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace geocloth {
namespace {

constexpr std::array<Color, 9> kViridis{{{68, 1, 84},
                                         {71, 44, 122},
                                         {59, 81, 139},
                                         {44, 113, 142},
                                         {33, 144, 141},
                                         {39, 173, 129},
                                         {92, 200, 99},
                                         {170, 220, 50},
                                         {253, 231, 37}}};
constexpr std::array<Color, 9> kCoolWarm{{{59, 76, 192},
                                          {98, 130, 234},
                                          {141, 176, 254},
                                          {184, 208, 249},
                                          {221, 221, 221},
                                          {245, 196, 173},
                                          {244, 154, 123},
                                          {222, 96, 77},
                                          {180, 4, 38}}};

Color interpolate(const std::array<Color, 9>& anchors, float t) {
  const float place = (t > 0 ? std::min(t, 1.F) : 0.F) * 8;  // a NaN is not above 0
  const auto i = std::min(static_cast<size_t>(place), size_t{7});
  const float f = place - static_cast<float>(i);
  const auto mix = [f](uint8_t a, uint8_t b) {
    return static_cast<uint8_t>(std::lround(static_cast<float>(a) * (1 - f) + static_cast<float>(b) * f));
  };
  const Color &a = anchors[i], &b = anchors[i + 1];
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), 255};
}

float channel_to_linear(uint8_t value) {
  const float s = static_cast<float>(value) / 255.F;
  return s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
}

uint8_t channel_to_srgb(float value) {
  const float v = value > 0 ? std::min(value, 1.F) : 0.F;
  const float s = v <= 0.0031308F ? v * 12.92F : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
  return static_cast<uint8_t>(std::lround(s * 255));
}

/// OKLCh (Ottosson 2020); colours that a screen has not are clipped.
Color oklch(float lightness, float chroma, double turns) {
  const auto hue = static_cast<float>(2 * std::numbers::pi * (turns - std::floor(turns)));
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(lightness + 0.3963377774F * a + 0.2158037573F * b);
  const float m = cube(lightness - 0.1055613458F * a - 0.0638541728F * b);
  const float s = cube(lightness - 0.0894841775F * a - 1.2914855480F * b);
  return to_srgb({4.0767416621F * l - 3.3077115913F * m + 0.2309699292F * s,
                  -1.2684380046F * l + 2.6097574011F * m - 0.3413193965F * s,
                  -0.0041960863F * l - 0.7034186147F * m + 1.7076147010F * s});
}

/// Hues a golden angle apart are told apart well, however many there are.
double golden_turns(uint32_t n) {
  return 0.08 + n * (1 - 1 / std::numbers::phi);
}

}  // namespace

LinearColor to_linear(Color color) {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (size_t i = 0; i < values.size(); ++i) values[i] = channel_to_linear(static_cast<uint8_t>(i));
    return values;
  }();
  return {table[color.r], table[color.g], table[color.b]};
}

Color to_srgb(const LinearColor& color) {
  return {channel_to_srgb(color.r), channel_to_srgb(color.g), channel_to_srgb(color.b), 255};
}

Color sequential_color(float t) {
  return interpolate(kViridis, t);
}

Color diverging_color(float t) {
  return interpolate(kCoolWarm, t);
}

Color distinct_color(uint32_t n) {
  // An even lightness and chroma, so that no hue shouts; lightness alternates in threes.
  constexpr std::array<float, 3> kLightness{0.72F, 0.62F, 0.80F};
  constexpr float kChroma = 0.125F;
  return oklch(kLightness[(n / 5) % 3], kChroma, golden_turns(n));
}

Color seam_color(uint32_t seam) {
  // Strong, so that a thin line is seen on pale cloth and on the colours of charts.
  constexpr std::array<float, 3> kLightness{0.60F, 0.70F, 0.52F};
  constexpr float kChroma = 0.19F;
  constexpr double kAgainstCharts = 0.5;
  return oklch(kLightness[(seam / 5) % 3], kChroma, golden_turns(seam) + kAgainstCharts);
}

Color shaded(Color color, float factor) {
  const auto scale = [factor](uint8_t v) {
    return static_cast<uint8_t>(std::lround(std::clamp(static_cast<float>(v) * factor, 0.F, 255.F)));
  };
  return {scale(color.r), scale(color.g), scale(color.b), color.a};
}

}  // namespace geocloth
