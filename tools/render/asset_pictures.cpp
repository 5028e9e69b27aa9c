// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures by which a conversion is judged at a glance. The first is the one of Gu, Gortler and Hoppe 2002: positions
// as colours are smooth wherever the image is, so a tear or a fold shows at once. Distortion is that of Sander et al.
// 2001 from the Jacobian at each pixel: area = s1 s2, anisotropy = s1 / s2.
#include "render/asset_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "geocloth/asset/error.h"
#include "render/canvas.h"
#include "render/chart_labels.h"
#include "render/color_map.h"
#include "render/seam_lines.h"

namespace geocloth {
namespace {

constexpr Color kNode{255, 255, 255, 255};
constexpr uint32_t kWantedSide = 1024;  ///< [pixels] small pictures are enlarged to about this
constexpr int kTextScale = 2, kLineHeight = 24, kMargin = 12;

uint32_t enlargement(uint32_t width, uint32_t height) {
  return std::clamp(kWantedSide / std::max(width, height), 1U, 64U);
}

uint8_t to_byte(float unit) {
  return static_cast<uint8_t>(std::lround(std::clamp(unit, 0.F, 1.F) * 255));
}

/// Derivative of the surface along one direction of the image [m per pixel]: the mean of the springs on both sides.
std::optional<Vec3> derivative(const ClothAsset& asset, uint32_t pixel, uint8_t bit, uint32_t step) {
  Vec3 sum;
  float count = 0;
  if ((asset.spring_mask[pixel] & bit) != 0) {
    sum += asset.rest_position[pixel + step] - asset.rest_position[pixel];
    ++count;
  }
  if (pixel >= step && (asset.spring_mask[pixel - step] & bit) != 0) {
    sum += asset.rest_position[pixel] - asset.rest_position[pixel - step];
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum * (1 / count);
}

/// Singular values of the Jacobian (du, dv), by its first fundamental form (a b; b c).
PixelDistortion distortion_of(const Vec3& du, const Vec3& dv) {
  const double a = dot(du, du), b = dot(du, dv), c = dot(dv, dv);
  const double middle = (a + c) / 2, radius = std::hypot((a - c) / 2, b);
  const double large = std::sqrt(middle + radius), small = std::sqrt(std::max(middle - radius, 0.0));
  return {static_cast<float>(large * small), static_cast<float>(std::min(large / std::max(small, 1e-30), 1e6))};
}

/// Draws every pixel of the asset by color(pixel), the others in paper.
template <typename F>
Picture draw_pixels(const ClothAsset& asset, F&& color) {
  Picture picture(asset.width, asset.height, kPaper);
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel)
    if (asset.valid(pixel)) picture.pixel[pixel] = color(pixel);
  return picture;
}

/// A picture with lines of text under it, and room for a key under them.
Picture with_caption(const Picture& picture, const std::vector<std::string>& lines) {
  uint32_t width = picture.width;
  for (const std::string& line : lines)
    width = std::max(width, static_cast<uint32_t>(text_width(line, kTextScale) + 2 * kMargin));
  const int rows = static_cast<int>(lines.size()) + 1;
  Picture result(width, picture.height + static_cast<uint32_t>(rows * kLineHeight + kMargin), kPaper);
  blit(result, picture, 0, 0);
  int y = static_cast<int>(picture.height) + kMargin;
  for (const std::string& line : lines) {
    draw_text(result, kMargin, y, kTextScale, line, kInk);
    y += kLineHeight;
  }
  return result;
}

std::string describe(const ClothAsset& asset) {
  return fmt::format("{} x {} pixels, {} valid, {} chart{}, spacing {:.3g} mm, {} layout", asset.width, asset.height,
                     count_valid_pixels(asset), asset.chart_count, asset.chart_count == 1 ? "" : "s",
                     asset.spacing * 1000, to_string(asset.layout));
}

/// Writes words in different colours behind each other.
void draw_key(Picture& picture, int x, int y, const std::vector<std::pair<std::string, Color>>& words) {
  for (const auto& [word, color] : words) {
    fill_rectangle(picture, x, y, 14, 14, color);
    draw_text(picture, x + 20, y, kTextScale, word, kInk);
    x += 20 + text_width(word, kTextScale) + 24;
  }
}

/// Dark all around, so that it reads on any colour. @param x, y  middle of the word
void draw_label(Picture& picture, int x, int y, int scale, const std::string& text, Color color) {
  const int left = x - text_width(text, scale) / 2, top = y - 7 * scale / 2;
  for (const int dy : {-2, 0, 2})
    for (const int dx : {-2, 0, 2}) draw_text(picture, left + dx, top + dy, scale, text, kPaper);
  draw_text(picture, left, top, scale, text, color);
}

/// Charts' numbers and seams' letters where they find room.
void draw_labels(Picture& picture, const ClothAsset& asset, const SeamLines& lines, uint32_t enlarged_by) {
  const auto draw = [&](const ChartLabel& label, int scale) {
    const int room = static_cast<int>((2 * label.room + 1) * enlarged_by);
    if (std::max(text_width(label.text, scale), 7 * scale) + 4 > room) return;
    const auto middle = [enlarged_by](uint32_t v) { return static_cast<int>(v * enlarged_by + enlarged_by / 2); };
    draw_label(picture, middle(label.x), middle(label.y), scale, label.text, kNode);
  };
  constexpr int kLetterScale = 3, kNumberScale = 5;
  const uint32_t letter = (7 * kLetterScale + 4) / enlarged_by + 1;  // its height in pixels of the image
  for (const ChartLabel& label : seam_letters(asset, lines, 2 * letter)) draw(label, kLetterScale);
  for (const ChartLabel& label : chart_numbers(asset)) draw(label, kNumberScale);
}

/// One heat map: logarithms, because twice and half are as far from right.
struct Scale {
  std::string title;
  Color (*color)(float);
  bool two_sided;            ///< 1 stands in the middle, or at the left
  std::vector<float> marks;  ///< from one end to the other

  /// @return value as place on the scale, 0..1
  [[nodiscard]] float place(float value) const {
    const float along = value > 0 ? std::log(value) / std::log(marks.back()) : 0;
    return std::clamp(two_sided ? along / 2 + 0.5F : along, 0.F, 1.F);
  }
};

void draw_scale(Picture& picture, int x, int y, int width, const Scale& scale) {
  draw_text(picture, x, y, kTextScale, scale.title, kInk);
  const int bar = y + kLineHeight;
  for (int i = 0; i < width; ++i)
    fill_rectangle(picture, x + i, bar, 1, 16, scale.color((static_cast<float>(i) + 0.5F) / static_cast<float>(width)));
  for (const float mark : scale.marks) {
    const int at = x + static_cast<int>(scale.place(mark) * static_cast<float>(width - 1));
    const std::string text = fmt::format("{:.3g}", mark);
    fill_rectangle(picture, at, bar + 16, 1, 4, kInk);
    const int left = at - text_width(text, kTextScale) / 2;
    draw_text(picture, std::clamp(left, x, x + width - text_width(text, kTextScale)), bar + 22, kTextScale, text, kInk);
  }
}

float percentile(std::vector<float> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::vector<PixelDistortion> measure_distortion(const ClothAsset& asset) {
  std::vector<PixelDistortion> result(asset.pixel_count());
  const float per_spacing = asset.spacing > 0 ? 1 / asset.spacing : 0;
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if (!asset.valid(pixel)) continue;
    const auto du = derivative(asset, pixel, kSpringRight, 1);
    const auto dv = derivative(asset, pixel, kSpringDown, asset.width);
    if (du && dv) result[pixel] = distortion_of(*du * per_spacing, *dv * per_spacing);
  }
  return result;
}

Picture draw_geometry_image(const ClothAsset& asset) {
  constexpr float kHuge = std::numeric_limits<float>::max();
  Vec3 low{kHuge, kHuge, kHuge}, high{-kHuge, -kHuge, -kHuge};
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    if (!asset.valid(pixel)) continue;
    const Vec3& p = asset.rest_position[pixel];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const auto place = [](float v, float from, float to) { return to > from ? (v - from) / (to - from) : 0.5F; };
  return draw_pixels(asset, [&](uint32_t pixel) {
    const Vec3& p = asset.rest_position[pixel];
    return Color{to_byte(place(p.x, low.x, high.x)), to_byte(place(p.y, low.y, high.y)),
                 to_byte(place(p.z, low.z, high.z)), 255};
  });
}

Picture draw_normal_map(const ClothAsset& asset) {
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  return draw_pixels(asset, [&](uint32_t pixel) {
    const Vec3& n = normal[pixel];
    return Color{to_byte(n.x / 2 + 0.5F), to_byte(n.y / 2 + 0.5F), to_byte(n.z / 2 + 0.5F), 255};
  });
}

Picture draw_chart_map(const ClothAsset& asset, Caption caption) {
  const SeamLines lines = find_seam_lines(asset);
  // Lit by the rest shape, so that one sees which part of the garment lies where.
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  const Vec3 to_light = normalized({-0.4F, 0.6F, 0.7F});
  const auto chart_color = [&](uint32_t pixel) {
    return shaded(distinct_color(asset.chart[pixel]), 0.76F + 0.18F * dot(normal[pixel], to_light));
  };
  const uint32_t scale = enlargement(asset.width, asset.height);
  const Picture base = draw_pixels(asset, [&](uint32_t pixel) {
    const bool border = lines.on_outline[pixel] != 0 && lines.pixel_seam[pixel] == kNoSeam;
    return border ? shaded(chart_color(pixel), 0.45F) : chart_color(pixel);
  });
  const std::vector<std::string> words{
      describe(asset), fmt::format("{} seams, {} split points; mates have the same colour and letter", lines.seam_count,
                                   asset.splits.rows())};
  Picture picture = caption == Caption::below ? with_caption(enlarged(base, scale), words) : enlarged(base, scale);
  for (uint32_t y = 0; y < asset.height; ++y)
    for (uint32_t x = 0; x < asset.width; ++x) {
      const uint32_t seam = lines.pixel_seam[size_t{y} * asset.width + x];
      if (seam == kNoSeam) continue;
      const auto side = static_cast<int>(scale);
      fill_rectangle(picture, static_cast<int>(x * scale), static_cast<int>(y * scale), side, side,
                     seam == kSeamNode ? kNode : seam_color(seam));
    }
  draw_labels(picture, asset, lines, scale);
  if (caption == Caption::none) return picture;
  const int top = static_cast<int>(base.height * scale) + kMargin;
  draw_key(picture, kMargin, top + 2 * kLineHeight,
           {{"free border", shaded(distinct_color(0), 0.36F)}, {"seam", seam_color(0)}, {"node", kNode}});
  return picture;
}

Picture draw_distortion(const ClothAsset& asset) {
  const std::vector<PixelDistortion> distortion = measure_distortion(asset);
  std::vector<float> areas, anisotropies;
  for (const PixelDistortion& d : distortion) {
    if (d.area <= 0) continue;
    areas.push_back(d.area);
    anisotropies.push_back(d.anisotropy);
  }
  constexpr float kFine = 1.5F;
  const bool fine = percentile(anisotropies, 0.95) <= kFine && percentile(areas, 0.95) <= kFine &&
                    percentile(areas, 0.05) * kFine >= 1;
  const Scale area{"area of the surface per area of the image", diverging_color, true,
                   fine ? std::vector{1 / 1.5F, 0.8F, 1.F, 1.25F, 1.5F} : std::vector{0.25F, 0.5F, 1.F, 2.F, 4.F}};
  const Scale anisotropy{"anisotropy (larger over smaller stretch)", sequential_color, false,
                         fine ? std::vector{1.F, 1.1F, 1.2F, 1.35F, 1.5F} : std::vector{1.F, 1.5F, 2.F, 4.F, 8.F}};
  const uint32_t scale = std::max(1U, enlargement(asset.width, asset.height) * 3 / 4);
  const Picture left =
      enlarged(draw_pixels(asset, [&](uint32_t p) { return area.color(area.place(distortion[p].area)); }), scale);
  const Picture right = enlarged(
      draw_pixels(asset, [&](uint32_t p) { return anisotropy.color(anisotropy.place(distortion[p].anisotropy)); }),
      scale);

  const int panel = std::max(static_cast<int>(left.width), 620), gap = 2 * kMargin;
  Picture picture(static_cast<uint32_t>(2 * panel + gap), left.height + 5 * kLineHeight + kMargin, kPaper);
  const int top = static_cast<int>(left.height) + kMargin, bar = std::min(panel - 2 * kMargin, 600);
  const auto draw_panel = [&](int x, const Picture& map, const Scale& map_scale, const std::vector<float>& values) {
    blit(picture, map, x, 0);
    draw_scale(picture, x + kMargin, top, bar, map_scale);
    draw_text(picture, x + kMargin, top + 3 * kLineHeight, kTextScale,
              fmt::format("5% {:.3g}   median {:.3g}   95% {:.3g}", percentile(values, 0.05), percentile(values, 0.5),
                          percentile(values, 0.95)),
              kInk);
  };
  draw_panel(0, left, area, areas);
  draw_panel(panel + gap, right, anisotropy, anisotropies);
  return picture;
}

Picture draw_flat_surface(const FlatSurface& flat) {
  const uint32_t scale = enlargement(flat.width, flat.height);
  Picture picture(flat.width * scale, flat.height * scale, kPaper);
  const auto place = [&](uint32_t triangle, uint32_t corner) {
    const FlatChart& chart = flat.charts[flat.chart[triangle]];
    const Point2& uv = flat.uv[flat.triangle[triangle][corner]];
    // Pixel centres carry the samples.
    return Vec2{static_cast<float>((uv[0] + chart.x0 + 0.5) * scale),
                static_cast<float>((uv[1] + chart.y0 + 0.5) * scale)};
  };
  for (uint32_t t = 0; t < flat.triangle.size(); ++t)
    for (uint32_t i = 0; i < 3; ++i) {
      const Vec2 a = place(t, i), b = place(t, (i + 1) % 3);
      draw_line(picture, a.x, a.y, b.x, b.y, 0.6F, distinct_color(flat.chart[t]));
    }
  for (const FlatChart& chart : flat.charts) {
    const auto draw = [&](const std::vector<OutlineSample>& loop) {
      for (const OutlineSample& sample : loop)
        fill_disc(picture, (static_cast<float>(chart.x0 + sample.x) + 0.5F) * static_cast<float>(scale),
                  (static_cast<float>(chart.y0 + sample.y) + 0.5F) * static_cast<float>(scale),
                  std::max(1.F, static_cast<float>(scale) * 0.2F), kInk);
    };
    draw(chart.outline);
    for (const std::vector<OutlineSample>& hole : chart.holes) draw(hole);
  }
  return picture;
}

Picture enlarged_to_see(const Picture& picture) {
  return enlarged(picture, enlargement(picture.width, picture.height));
}

std::vector<std::filesystem::path> write_pictures(const ClothAsset& asset, const FlatSurface* flat,
                                                  const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure || !std::filesystem::is_directory(folder))
    throw Error(ErrorCode::io, folder.string() + ": the folder cannot be made; choose another for the pictures");
  std::vector<std::filesystem::path> files;
  const auto write = [&](const char* name, const Picture& picture) {
    files.push_back(folder / name);
    write_png(picture, files.back());
  };
  write("geometry_image.png", enlarged_to_see(draw_geometry_image(asset)));
  write("normals.png", enlarged_to_see(draw_normal_map(asset)));
  write("charts.png", draw_chart_map(asset));
  write("distortion.png", draw_distortion(asset));
  if (flat != nullptr) write("flat.png", draw_flat_surface(*flat));
  return files;
}

}  // namespace geocloth
