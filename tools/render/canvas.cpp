// SPDX-License-Identifier: GPL-3.0-or-later
// What a legend, a marked pixel and a contact sheet need, and no more. Text comes from stb_easy_font, which gives every
// letter as a few axis-parallel rectangles.
#include "render/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <stb/stb_easy_font.h>

#include "render/color_map.h"

namespace geocloth {
namespace {

void blend(Color& under, Color over, float coverage) {
  const float a = coverage * static_cast<float>(over.a) / 255.F;
  const auto mix = [a](uint8_t u, uint8_t o) {
    return static_cast<uint8_t>(std::lround(static_cast<float>(u) * (1 - a) + static_cast<float>(o) * a));
  };
  under = {mix(under.r, over.r), mix(under.g, over.g), mix(under.b, over.b),
           std::max(under.a, static_cast<uint8_t>(std::lround(a * 255)))};
}

/// Blends every pixel of a clipped rectangle by coverage(centre x, centre y).
template <typename F>
void cover(Picture& picture, float x0, float y0, float x1, float y1, Color color, F&& coverage) {
  const auto low = [](float v) { return static_cast<int>(std::floor(std::clamp(v, -1.F, 1e6F))); };
  const int left = std::max(0, low(x0)), right = std::min(static_cast<int>(picture.width) - 1, low(x1));
  const int top = std::max(0, low(y0)), bottom = std::min(static_cast<int>(picture.height) - 1, low(y1));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float c = coverage(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      if (c > 0) blend(picture.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y)), color, std::min(c, 1.F));
    }
}

struct FontVertex {
  float x, y, z;
  std::array<unsigned char, 4> color;
};

/// Columns that make a sheet about square; of three choices the one that leaves the fewest places empty.
int sheet_columns(int count, double cell_aspect) {
  const int square = std::clamp(static_cast<int>(std::lround(std::sqrt(count * cell_aspect))), 1, count);
  const auto empty = [count](int columns) { return (count + columns - 1) / columns * columns - count; };
  int best = square;
  for (const int columns : {square + 1, square - 1})
    if (columns >= 1 && columns <= count && empty(columns) < empty(best)) best = columns;
  return best;
}

std::string plain_ascii(std::string_view text) {
  std::string ascii(text);
  std::ranges::replace_if(
      ascii, [](char c) { return c < ' ' || c > '~'; }, '?');
  return ascii;
}

}  // namespace

void fill_rectangle(Picture& picture, int x, int y, int width, int height, Color color) {
  cover(picture, static_cast<float>(x), static_cast<float>(y), static_cast<float>(x + width - 1),
        static_cast<float>(y + height - 1), color, [](float, float) { return 1.F; });
}

void frame_rectangle(Picture& picture, int x, int y, int width, int height, Color color) {
  fill_rectangle(picture, x, y, width, 1, color);
  fill_rectangle(picture, x, y + height - 1, width, 1, color);
  fill_rectangle(picture, x, y, 1, height, color);
  fill_rectangle(picture, x + width - 1, y, 1, height, color);
}

void draw_line(Picture& picture, float x0, float y0, float x1, float y1, float thickness, Color color) {
  const float dx = x1 - x0, dy = y1 - y0, half = thickness / 2;
  const float squared = dx * dx + dy * dy;
  const auto coverage = [&](float x, float y) {
    const float t = squared > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / squared, 0.F, 1.F) : 0.F;
    return half + 0.5F - std::hypot(x - x0 - t * dx, y - y0 - t * dy);
  };
  cover(picture, std::min(x0, x1) - half - 1, std::min(y0, y1) - half - 1, std::max(x0, x1) + half + 1,
        std::max(y0, y1) + half + 1, color, coverage);
}

void fill_disc(Picture& picture, float x, float y, float radius, Color color) {
  cover(picture, x - radius - 1, y - radius - 1, x + radius + 1, y + radius + 1, color,
        [&](float px, float py) { return radius + 0.5F - std::hypot(px - x, py - y); });
}

void draw_text(Picture& picture, int x, int y, int scale, std::string_view text, Color color) {
  std::string ascii = plain_ascii(text);
  std::vector<FontVertex> vertex(ascii.size() * 80);  // at most 20 rectangles a letter
  const int rectangles = stb_easy_font_print(0, 0, ascii.data(), nullptr, vertex.data(),
                                             static_cast<int>(vertex.size() * sizeof(FontVertex)));
  for (int i = 0; i < rectangles; ++i) {
    const FontVertex& a = vertex[static_cast<size_t>(i) * 4];
    const FontVertex& c = vertex[static_cast<size_t>(i) * 4 + 2];
    const auto pixels = [scale](float units) { return static_cast<int>(std::lround(units)) * scale; };
    fill_rectangle(picture, x + pixels(a.x), y + pixels(a.y), pixels(c.x - a.x), pixels(c.y - a.y), color);
  }
}

int text_width(std::string_view text, int scale) {
  std::string ascii = plain_ascii(text);
  return stb_easy_font_width(ascii.data()) * scale;
}

void blit(Picture& picture, const Picture& source, int x, int y) {
  for (uint32_t row = 0; row < source.height; ++row)
    for (uint32_t column = 0; column < source.width; ++column) {
      const int64_t px = int64_t{x} + column, py = int64_t{y} + row;
      if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
      picture.at(static_cast<uint32_t>(px), static_cast<uint32_t>(py)) = source.at(column, row);
    }
}

Picture enlarged(const Picture& picture, uint32_t factor) {
  Picture result(picture.width * factor, picture.height * factor);
  for (uint32_t y = 0; y < result.height; ++y)
    for (uint32_t x = 0; x < result.width; ++x) result.at(x, y) = picture.at(x / factor, y / factor);
  return result;
}

Picture shrunk_to_fit(const Picture& picture, uint32_t width, uint32_t height) {
  const double ratio =
      std::min({1.0, static_cast<double>(width) / picture.width, static_cast<double>(height) / picture.height});
  if (ratio >= 1) return picture;
  const auto side = [ratio](uint32_t s) { return std::max(1U, static_cast<uint32_t>(std::lround(s * ratio))); };
  Picture result(side(picture.width), side(picture.height));
  for (uint32_t y = 0; y < result.height; ++y)
    for (uint32_t x = 0; x < result.width; ++x) {
      const uint32_t x0 = static_cast<uint32_t>(uint64_t{x} * picture.width / result.width);
      const uint32_t y0 = static_cast<uint32_t>(uint64_t{y} * picture.height / result.height);
      const uint32_t x1 = std::max(x0 + 1, static_cast<uint32_t>(uint64_t{x + 1} * picture.width / result.width));
      const uint32_t y1 = std::max(y0 + 1, static_cast<uint32_t>(uint64_t{y + 1} * picture.height / result.height));
      LinearColor sum;
      float alpha = 0;
      for (uint32_t sy = y0; sy < y1; ++sy)
        for (uint32_t sx = x0; sx < x1; ++sx) {
          sum = sum + to_linear(picture.at(sx, sy));
          alpha += static_cast<float>(picture.at(sx, sy).a);
        }
      const float share = 1.F / static_cast<float>((x1 - x0) * (y1 - y0));
      Color color = to_srgb(sum * share);
      color.a = static_cast<uint8_t>(std::lround(alpha * share));
      result.at(x, y) = color;
    }
  return result;
}

Picture contact_sheet(const std::vector<Picture>& pictures, const std::vector<std::string>& labels,
                      uint32_t cell_width) {
  constexpr int kGap = 8, kLabelScale = 2, kLabelHeight = 24;
  std::vector<Picture> cells;
  uint32_t width = 1, height = 1;
  for (const Picture& picture : pictures) {
    cells.push_back(shrunk_to_fit(picture, cell_width, 4 * cell_width));
    width = std::max(width, cells.back().width);
    height = std::max(height, cells.back().height);
  }
  const int step_x = static_cast<int>(width) + kGap, step_y = static_cast<int>(height) + kLabelHeight + kGap;
  const auto count = static_cast<int>(std::max<size_t>(cells.size(), 1));
  const int columns = sheet_columns(count, static_cast<double>(step_y) / step_x);
  const int rows = (count + columns - 1) / columns;
  Picture sheet(static_cast<uint32_t>(columns * step_x + kGap), static_cast<uint32_t>(rows * step_y + kGap), kPaper);
  for (int i = 0; i < static_cast<int>(cells.size()); ++i) {
    const int x = kGap + i % columns * step_x, y = kGap + i / columns * step_y;
    blit(sheet, cells[static_cast<size_t>(i)], x, y);
    if (static_cast<size_t>(i) < labels.size())
      draw_text(sheet, x + 2, y + static_cast<int>(height) + 5, kLabelScale, labels[static_cast<size_t>(i)], kInk);
  }
  return sheet;
}

}  // namespace geocloth
