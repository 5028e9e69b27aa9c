// SPDX-License-Identifier: GPL-3.0-or-later
// Synthetic assets made in memory: a surface of nx x ny points laid out as a grid of rectangular charts that share
// their border columns and rows. Everything an asset holds (copies, area shares, seam bends, binding) follows from two
// functions: which surface point a pixel samples, and where that point lies.

#include "support/make_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

namespace geocloth::test {
namespace {

/// One direction of the layout: surface points 0..points-1 (wrapping when periodic) cut into charts.
struct Axis {
  uint32_t points = 0, charts = 1, gap = 0;
  bool periodic = false;

  [[nodiscard]] uint32_t cells() const { return periodic ? points : points - 1; }
  [[nodiscard]] uint32_t first_cell(uint32_t chart) const { return cells() * chart / charts; }
  [[nodiscard]] uint32_t first_pixel(uint32_t chart) const { return first_cell(chart) + chart * (1 + gap); }
  [[nodiscard]] uint32_t pixels() const { return cells() + charts + gap * (charts - 1); }
};

/// Along one axis, the chart and the surface point of every pixel.
struct AxisPixel {
  uint32_t chart = 0, point = 0;
  bool valid = false;
};
std::vector<AxisPixel> axis_pixels(const Axis& axis) {
  std::vector<AxisPixel> pixels(axis.pixels());
  for (uint32_t chart = 0; chart < axis.charts; ++chart) {
    const uint32_t first = axis.first_cell(chart);
    const uint32_t last = axis.first_cell(chart + 1);
    for (uint32_t k = first; k <= last; ++k) {
      pixels[axis.first_pixel(chart) + k - first] = {chart, k % axis.points, true};
    }
  }
  return pixels;
}

using PointPosition = std::function<Vec3(uint32_t i, uint32_t j)>;

float triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5F * length(cross(b - a, c - a));
}

class Builder {
 public:
  Builder(const Axis& u, const Axis& v, PointPosition position)
      : u_(u), v_(v), columns_(axis_pixels(u)), rows_(axis_pixels(v)), point_position_(std::move(position)) {
    asset_.width = u.pixels();
    asset_.height = v.pixels();
    asset_.chart_count = u.charts * v.charts;
    asset_.layout = Layout::panels;
  }

  ClothAsset build() {
    place_pixels();
    connect();
    list_copies();
    bend_across_seams();
    make_source();
    return std::move(asset_);
  }

 private:
  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }
  [[nodiscard]] uint32_t point(uint32_t x, uint32_t y) const { return rows_[y].point * u_.points + columns_[x].point; }
  [[nodiscard]] bool same_chart(uint32_t x0, uint32_t y0, int64_t x1, int64_t y1) const {
    if (x1 < 0 || y1 < 0 || x1 >= asset_.width || y1 >= asset_.height) return false;
    const auto a = asset_.chart[pixel(x0, y0)];
    return a != kNoChart && a == asset_.chart[pixel(static_cast<uint32_t>(x1), static_cast<uint32_t>(y1))];
  }

  void place_pixels() {
    asset_.rest_position.resize(asset_.pixel_count());
    asset_.chart.assign(asset_.pixel_count(), kNoChart);
    for (uint32_t y = 0; y < asset_.height; ++y) {
      for (uint32_t x = 0; x < asset_.width; ++x) {
        if (!columns_[x].valid || !rows_[y].valid) continue;
        asset_.chart[pixel(x, y)] = static_cast<uint16_t>(rows_[y].chart * u_.charts + columns_[x].chart);
        asset_.rest_position[pixel(x, y)] = point_position_(columns_[x].point, rows_[y].point);
      }
    }
    asset_.spacing = length(point_position_(1, 0) - point_position_(0, 0));
  }

  void connect() {
    asset_.spring_mask.assign(asset_.pixel_count(), 0);
    asset_.cell.assign(asset_.pixel_count(), 0);
    asset_.area.assign(asset_.pixel_count(), 0.F);
    for (uint32_t y = 0; y < asset_.height; ++y) {
      for (uint32_t x = 0; x < asset_.width; ++x) {
        for (uint32_t s = 0; s < kSpringCount; ++s) {
          if (same_chart(x, y, int64_t{x} + kSpringOffset[s][0], int64_t{y} + kSpringOffset[s][1])) {
            asset_.spring_mask[pixel(x, y)] |= static_cast<uint8_t>(1U << s);
          }
        }
        if (!same_chart(x, y, int64_t{x} + 1, int64_t{y} + 1)) continue;
        asset_.cell[pixel(x, y)] = kCellFirst | kCellSecond;
        const std::array corner{pixel(x, y), pixel(x, y + 1), pixel(x + 1, y + 1), pixel(x + 1, y)};
        const auto& p = asset_.rest_position;
        const float quad = triangle_area(p[corner[0]], p[corner[1]], p[corner[2]]) +
                           triangle_area(p[corner[0]], p[corner[2]], p[corner[3]]);
        for (const uint32_t c : corner) asset_.area[c] += 0.25F * quad;
      }
    }
  }

  void list_copies() {
    copies_.resize(size_t{u_.points} * v_.points);
    for (uint32_t y = 0; y < asset_.height; ++y) {
      for (uint32_t x = 0; x < asset_.width; ++x) {
        if (asset_.chart[pixel(x, y)] != kNoChart) copies_[point(x, y)].push_back(pixel(x, y));
      }
    }
    std::vector<std::vector<uint32_t>> rows;
    std::copy_if(copies_.begin(), copies_.end(), std::back_inserter(rows), [](const auto& r) { return r.size() > 1; });
    std::sort(rows.begin(), rows.end());
    if (rows.empty()) return;
    asset_.splits.offset.push_back(0);
    for (const auto& row : rows) {
      asset_.splits.pixel.insert(asset_.splits.pixel.end(), row.begin(), row.end());
      asset_.splits.offset.push_back(static_cast<uint32_t>(asset_.splits.pixel.size()));
    }
  }

  void add_seam_bend(uint32_t a, uint32_t middle, uint32_t b) {
    asset_.seam_bends.push_back({a, middle, b, length(asset_.rest_position[b] - asset_.rest_position[a])});
  }

  /// A seam between the charts k and k + 1 of an axis: pixel `last` of one is a copy of pixel `first` of the other.
  static std::vector<std::pair<uint32_t, uint32_t>> seams(const Axis& axis) {
    std::vector<std::pair<uint32_t, uint32_t>> result;
    for (uint32_t k = 0; k + 1 < axis.charts; ++k) {
      const uint32_t first = axis.first_pixel(k + 1);
      result.emplace_back(first - 1 - axis.gap, first);
    }
    if (axis.periodic) result.emplace_back(axis.pixels() - 1, 0);
    return result;
  }

  void bend_across_seams() {
    for (const auto& [last, first] : seams(u_)) {
      for (uint32_t y = 0; y < asset_.height; ++y) {
        if (rows_[y].valid) add_seam_bend(pixel(last - 1, y), pixel(last, y), pixel(first + 1, y));
      }
    }
    for (const auto& [last, first] : seams(v_)) {
      for (uint32_t x = 0; x < asset_.width; ++x) {
        if (columns_[x].valid) add_seam_bend(pixel(x, last - 1), pixel(x, last), pixel(x, first + 1));
      }
    }
  }

  void make_source() {
    SourceMesh& mesh = asset_.source;
    const uint32_t count = u_.points * v_.points;
    mesh.source_vertex_count = count;
    std::vector<Vec3> normal;
    compute_source_normals(normal);
    asset_.binding.resize(count);
    for (uint32_t k = 0; k < count; ++k) {
      const uint32_t first = copies_[k].front();
      mesh.position.push_back(asset_.rest_position[first]);
      mesh.normal.push_back(normalized(normal[k]));
      mesh.uv.push_back({static_cast<float>(k % u_.points) / static_cast<float>(u_.points),
                         static_cast<float>(k / u_.points) / static_cast<float>(v_.points)});
      mesh.source_vertex.push_back(k);
      asset_.binding[k] = bind(first);
    }
    mesh.part.push_back({"cloth", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
    SourceMaterial material;
    material.name = "cloth";
    material.base_color = {0.7F, 0.2F, 0.2F, 1.F};
    mesh.material.push_back(material);
  }

  void compute_source_normals(std::vector<Vec3>& normal) {
    normal.assign(size_t{u_.points} * v_.points, {});
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      asset_.source.triangle.push_back({a, b, c});
      const Vec3 pa = position_of(a);
      const Vec3 n = cross(position_of(b) - pa, position_of(c) - pa);
      for (const uint32_t k : {a, b, c}) normal[k] += n;
    };
    for (uint32_t j = 0; j + 1 < v_.points; ++j) {
      for (uint32_t i = 0; i < u_.cells(); ++i) {
        const uint32_t right = (i + 1) % u_.points;
        const uint32_t a = j * u_.points + i;
        const uint32_t b = (j + 1) * u_.points + i;
        const uint32_t c = (j + 1) * u_.points + right;
        const uint32_t d = j * u_.points + right;
        add(a, b, c);
        add(a, c, d);
      }
    }
  }

  [[nodiscard]] Vec3 position_of(uint32_t k) const { return asset_.rest_position[copies_[k].front()]; }

  /// A source vertex is a pixel itself: weight 1 on it, two neighbours of one cell for the frame.
  [[nodiscard]] Binding bind(uint32_t p) const {
    const uint32_t x = p % asset_.width;
    const uint32_t y = p / asset_.width;
    const int64_t sx = same_chart(x, y, int64_t{x} + 1, y) ? 1 : -1;
    const int64_t sy = same_chart(x, y, x, int64_t{y} + 1) ? 1 : -1;
    const auto across = static_cast<uint32_t>(int64_t{p} + sx);
    const auto down = static_cast<uint32_t>(int64_t{p} + sy * asset_.width);
    return {.pixel = {p, across, down}, .weight = {1.F, 0.F, 0.F}, .offset = {}};
  }

  Axis u_, v_;
  std::vector<AxisPixel> columns_, rows_;
  PointPosition point_position_;
  std::vector<std::vector<uint32_t>> copies_;
  ClothAsset asset_;
};

/// Repeatable noise in -1..1.
float noise(uint32_t i, uint32_t j, uint32_t channel) {
  uint32_t h = i * 0x9E3779B1U ^ j * 0x85EBCA77U ^ channel * 0xC2B2AE3DU;
  h = (h ^ (h >> 15U)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12U)) * 0x297A2D39U;
  h ^= h >> 15U;
  return static_cast<float>(h >> 8U) / 8388608.F - 1.F;
}

Axis axis_u(const SheetOptions& o) {
  return {o.nx, o.charts_x, o.gap, false};
}
Axis axis_v(const SheetOptions& o) {
  return {o.ny, o.charts_y, o.gap, false};
}

Axis axis_around(const TubeOptions& o) {
  return {o.nx, o.charts_x, 0, true};
}
Axis axis_along(const TubeOptions& o) {
  return {o.ny, o.charts_y, 0, false};
}

uint32_t pixel_of_point(const Axis& axis, uint32_t point) {
  const auto pixels = axis_pixels(axis);
  const auto at =
      std::find_if(pixels.begin(), pixels.end(), [&](const auto& p) { return p.valid && p.point == point; });
  return static_cast<uint32_t>(at - pixels.begin());
}

}  // namespace

ClothAsset make_sheet(const SheetOptions& o) {
  const float du = o.width / static_cast<float>(o.nx - 1);
  const float dv = o.height / static_cast<float>(o.ny - 1);
  const auto position = [&](uint32_t i, uint32_t j) {
    const bool inside = i > 0 && j > 0 && i + 1 < o.nx && j + 1 < o.ny;
    const float ju = inside ? o.jitter * noise(i, j, 0) : 0.F;
    const float jv = inside ? o.jitter * noise(i, j, 1) : 0.F;
    const float u = (static_cast<float>(i) + ju) * du - 0.5F * o.width;
    const float v = (static_cast<float>(j) + jv) * dv - 0.5F * o.height;
    return o.center + (o.horizontal ? Vec3{u, 0, v} : Vec3{u, -v, 0});
  };
  ClothAsset asset = Builder(axis_u(o), axis_v(o), position).build();
  asset.name = "sheet";

  std::vector<uint32_t> top, bottom, left, right;
  for (uint32_t i = 0; i < o.nx; ++i) {
    top.push_back(i);
    bottom.push_back((o.ny - 1) * o.nx + i);
  }
  for (uint32_t j = 0; j < o.ny; ++j) {
    left.push_back(j * o.nx);
    right.push_back(j * o.nx + o.nx - 1);
  }
  asset.vertex_groups = {
      {"top", top}, {"bottom", bottom}, {"left", left}, {"right", right}, {"corners", {0, o.nx - 1}}};
  return asset;
}

uint32_t sheet_pixel(const SheetOptions& o, uint32_t i, uint32_t j) {
  return pixel_of_point(axis_v(o), j) * axis_u(o).pixels() + pixel_of_point(axis_u(o), i);
}

ClothAsset make_tube(const TubeOptions& o) {
  const auto position = [&](uint32_t i, uint32_t j) {
    const double angle = -2 * std::numbers::pi * i / o.nx;
    const double v = 0.5 - static_cast<double>(j) / (o.ny - 1);
    return o.center + Vec3{static_cast<float>(o.radius * std::cos(angle)), static_cast<float>(o.height * v),
                           static_cast<float>(o.radius * std::sin(angle))};
  };
  ClothAsset asset = Builder(axis_around(o), axis_along(o), position).build();
  asset.name = "tube";
  std::vector<uint32_t> top(o.nx);
  for (uint32_t i = 0; i < o.nx; ++i) top[i] = i;
  asset.vertex_groups = {{"top", top}};
  return asset;
}

uint32_t tube_pixel(const TubeOptions& o, uint32_t i, uint32_t j) {
  return pixel_of_point(axis_along(o), j) * axis_around(o).pixels() + pixel_of_point(axis_around(o), i);
}

}  // namespace geocloth::test
