// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "render/picture.h"

namespace geocloth {

constexpr Color kPaper{32, 33, 37, 255}, kInk{214, 216, 220, 255};  ///< of every picture with text around it

/// Small drawings into a picture. Coordinates are in pixels, y down; what lies outside is clipped.
void fill_rectangle(Picture& picture, int x, int y, int width, int height, Color color);
void frame_rectangle(Picture& picture, int x, int y, int width, int height, Color color);
/// A line of a given thickness, covered pixels blended by their coverage.
void draw_line(Picture& picture, float x0, float y0, float x1, float y1, float thickness, Color color);
void fill_disc(Picture& picture, float x, float y, float radius, Color color);
/// Text of one line in a bitmap font (ASCII), 7 * scale pixels for a capital, top left corner at (x, y).
void draw_text(Picture& picture, int x, int y, int scale, std::string_view text, Color color);
[[nodiscard]] int text_width(std::string_view text, int scale);
/// Copies a whole picture to (x, y).
void blit(Picture& picture, const Picture& source, int x, int y);
/// Every pixel becomes a block of factor x factor.
[[nodiscard]] Picture enlarged(const Picture& picture, uint32_t factor);
/// Box-filtered in linear light to at most width x height, proportions kept.
[[nodiscard]] Picture shrunk_to_fit(const Picture& picture, uint32_t width, uint32_t height);

/// Pictures side by side and row by row with a number under each, as many columns as make the sheet about square.
/// Every picture is shrunk to at most cell_width.
/// @param labels  one per picture
[[nodiscard]] Picture contact_sheet(const std::vector<Picture>& pictures, const std::vector<std::string>& labels,
                                    uint32_t cell_width);

}  // namespace geocloth
