// SPDX-License-Identifier: GPL-3.0-or-later
// Every vertex of the file becomes a point of the image: the grid triangle around its place in the chart, the
// barycentric weights there, and what is left as an offset in the local frame, so that it is exact at rest and follows
// the grid smoothly (wrap deformers work the same way). All render vertices of one surface point share one place:
// otherwise cracks would open along texture seams as soon as the cloth bends.
#include <algorithm>
#include <cmath>
#include <optional>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/seams.h"
#include "mesh/nearest_weights.h"
#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"
#include "mesh/triangle_tree.h"

namespace geocloth {
namespace {

// ---------------------------------------------------------------------------------------------- render vertices

/// The triangles of the file with those turned that run the other way round in the cloth (the repair's flipped_faces):
/// drawn as they were, half of a badly made garment would show its back.
std::vector<Triangle> turned_as_cloth(const TriangleMesh& mesh, const CleanSurface& clean) {
  std::vector<double> agrees(mesh.triangle.size(), 0);
  for (std::size_t i = 0; i < clean.triangle.size(); ++i) {
    const uint32_t t = clean.source_triangle[i];
    if (t == kNone) continue;
    agrees[t] += dot(normal_of(clean, i), normal_of(mesh.position, mesh.triangle[t]));
  }
  std::vector<Triangle> triangle = mesh.triangle;
  for (std::size_t t = 0; t < triangle.size(); ++t)
    if (agrees[t] < 0) std::swap(triangle[t][1], triangle[t][2]);
  return triangle;
}

/// Normals for meshes (or corners) without any: area-weighted over the triangles around the surface point.
std::vector<Point3> smooth_normals(const TriangleMesh& mesh, std::span<const Triangle> triangle,
                                   const CleanSurface& clean) {
  std::vector<Point3> of_point(clean.point_count, Point3{}), normal(mesh.position.size(), Point3{0, 1, 0});
  for (const Triangle& t : triangle) {
    const Point3 weighted = normal_of(mesh.position, t);
    for (const uint32_t v : t) {
      const uint32_t p = clean.source_point[v];
      if (p != kNone) of_point[p] = of_point[p] + weighted;
    }
  }
  for (std::size_t v = 0; v < normal.size(); ++v) {
    const uint32_t p = clean.source_point[v];
    if (p != kNone) normal[v] = direction_of(of_point[p]).value_or(normal[v]);
  }
  return normal;
}

/// What tells the render vertices of one file vertex apart.
struct Attributes {
  Vec2 uv;
  Vec3 normal;
  bool operator==(const Attributes&) const = default;
};

/// Splits the vertices of the file by texture coordinate and normal. Vertices that no triangle uses are kept.
SourceMesh render_mesh(const TriangleMesh& mesh, const CleanSurface& clean) {
  const std::vector<Triangle> triangle = turned_as_cloth(mesh, clean);
  const std::vector<Point3> smooth = smooth_normals(mesh, triangle, clean);
  const auto attributes = [&](std::size_t t, std::size_t k) {
    const uint32_t v = triangle[t][k];
    const bool turned = triangle[t] != mesh.triangle[t];
    const std::size_t corner = turned && k > 0 ? 3 - k : k;  // of the file's
    Attributes a{{}, to_single(smooth[v])};
    if (!mesh.normal.empty()) {
      Point3 normal = direction_of(mesh.normal[t][corner]).value_or(smooth[v]);
      if (turned && dot(normal, normal_of(mesh.position, triangle[t])) < 0) normal = normal * -1;
      a.normal = to_single(normal);
    }
    if (!mesh.uv.empty()) {
      const Point2& uv = mesh.uv[t][corner];
      if (std::isfinite(to_single(uv).x) && std::isfinite(to_single(uv).y)) a.uv = to_single(uv);
    }
    return a;
  };

  std::vector<std::vector<Attributes>> variants(mesh.position.size());
  std::vector<std::array<uint32_t, 3>> chosen(triangle.size());
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      auto& known = variants[triangle[t][k]];
      const Attributes a = attributes(t, k);
      const auto found = std::find(known.begin(), known.end(), a);
      chosen[t][k] = static_cast<uint32_t>(found - known.begin());
      if (found == known.end()) known.push_back(a);
    }
  }

  SourceMesh source;
  std::vector<uint32_t> first(mesh.position.size());
  for (uint32_t v = 0; v < mesh.position.size(); ++v) {
    first[v] = static_cast<uint32_t>(source.position.size());
    if (variants[v].empty()) variants[v].push_back({{}, to_single(smooth[v])});
    for (const Attributes& a : variants[v]) {
      source.position.push_back(to_single(mesh.position[v]));
      source.normal.push_back(a.normal);
      if (!mesh.uv.empty()) source.uv.push_back(a.uv);
      source.source_vertex.push_back(v);
    }
  }
  source.triangle = triangle;
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) source.triangle[t][k] = first[triangle[t][k]] + chosen[t][k];
  }
  source.part = mesh.part;
  source.material = mesh.material;
  source.image = mesh.image;
  source.source_vertex_count = static_cast<uint32_t>(mesh.position.size());
  source.middle = mesh.middle;
  return source;
}

// ---------------------------------------------------------------------------------------------- places on the grid

/// Three pixels and their weights.
struct GridPlace {
  std::array<uint32_t, 3> pixel;
  Point3 weight;
};

/// Finds places on the grid: by a chart position where the grid covers it, else by distance.
class GridLocator {
 public:
  GridLocator(const FlatSurface& flat, const Raster& raster, const ClothAsset& asset)
      : flat_(flat), raster_(raster), asset_(asset) {}

  /// The grid triangle over the vertex' place in the plane. Pixels sample the plane up to a pixel or two beside
  /// themselves, so the cells around are searched, the nearest first.
  [[nodiscard]] std::optional<GridPlace> at_vertex(uint32_t flat_vertex, uint32_t chart_index) const {
    const FlatChart& chart = flat_.charts[chart_index];
    const Point2& uv = flat_.uv[flat_vertex];
    const auto column = static_cast<int32_t>(std::clamp(std::floor(uv[0]), 0.0, chart.width - 2.0));
    const auto row = static_cast<int32_t>(std::clamp(std::floor(uv[1]), 0.0, chart.height - 2.0));
    constexpr int32_t kReach = 3;
    std::optional<GridPlace> best;
    double excess = kMostOutside;
    for (int32_t radius = 0; radius <= kReach; ++radius) {
      for (int32_t y = std::max(row - radius, 0); y <= std::min<int64_t>(row + radius, chart.height - 2); ++y) {
        for (int32_t x = std::max(column - radius, 0); x <= std::min<int64_t>(column + radius, chart.width - 2); ++x) {
          if (std::max(std::abs(x - column), std::abs(y - row)) != radius) continue;
          search_cell(chart, chart_index, static_cast<uint32_t>(x), static_cast<uint32_t>(y), uv, best, excess);
          if (excess == 0) return best;
        }
      }
    }
    return best;
  }

  /// Builds its search tree when it is first asked.
  [[nodiscard]] GridPlace nearest(const Point3& p) {
    if (!tree_) {
      for (const Vec3& q : asset_.rest_position) position_.push_back(to_double(q));
      triangle_ = pixel_triangles(asset_);
      tree_.emplace(position_, triangle_);
    }
    const Triangle& t = triangle_[tree_->nearest(p).triangle];
    return {t, nearest_weights(position_[t[0]], position_[t[1]], position_[t[2]], p)};
  }

 private:
  /// How far outside of its triangle, in weights, a place may lie to be taken in: the grid's outline cuts corners.
  static constexpr double kMostOutside = 0.5;

  void search_cell(const FlatChart& chart, uint32_t chart_index, uint32_t x, uint32_t y, const Point2& uv,
                   std::optional<GridPlace>& best, double& excess) const {
    const uint32_t a = (chart.y0 + y) * asset_.width + chart.x0 + x;
    if (asset_.cell[a] == 0 || (asset_.chart[a] != chart_index && asset_.chart[a + 1] != chart_index)) return;
    for (const Triangle& t : cell_triangles(asset_, a)) {
      const Point2 &p = raster_.place[t[0]], &q = raster_.place[t[1]], &r = raster_.place[t[2]];
      const double whole = signed_area_twice(p, q, r);
      if (!(whole > 0)) continue;
      const Point3 w{signed_area_twice(uv, q, r) / whole, signed_area_twice(p, uv, r) / whole,
                     signed_area_twice(p, q, uv) / whole};
      const double outside = std::max({0.0, -w[0], -w[1], -w[2]});
      if (outside >= excess) continue;
      excess = outside < 1e-9 ? 0 : outside;
      const Point3 held{std::max(w[0], 0.0), std::max(w[1], 0.0), std::max(w[2], 0.0)};
      best = GridPlace{t, held * (1 / (held[0] + held[1] + held[2]))};
    }
  }

  const FlatSurface& flat_;
  const Raster& raster_;
  const ClothAsset& asset_;
  std::vector<Point3> position_;
  std::vector<Triangle> triangle_;
  std::optional<TriangleTree> tree_;
};

/// Per surface point a flat vertex (and its chart) that stands there.
struct FlatPlace {
  uint32_t vertex = kNone, chart = 0;
};
std::vector<FlatPlace> flat_places(const FlatSurface& flat) {
  std::vector<FlatPlace> places(flat.point_count);
  for (std::size_t t = 0; t < flat.triangle.size(); ++t) {
    for (const uint32_t v : flat.triangle[t]) {
      FlatPlace& place = places[flat.point[v]];
      if (place.vertex == kNone) place = {v, flat.chart[t]};
    }
  }
  return places;
}

/// The pieces that the image leaves out, and where those that keep their shape ride.
class CarriedPieces {
 public:
  CarriedPieces(const TriangleMesh& mesh, const CleanSurface& clean, std::span<const uint32_t> piece_of_point)
      : clean_(clean), piece_of_point_(piece_of_point) {
    for (std::size_t v = 0; v < mesh.position.size(); ++v) {
      const uint32_t piece = of_vertex(v);
      if (piece == kNone) continue;
      if (piece >= box_.size()) box_.resize(piece + 1);
      for (std::size_t k = 0; k < 3; ++k) {
        box_[piece].low[k] = std::min(box_[piece].low[k], mesh.position[v][k]);
        box_[piece].high[k] = std::max(box_[piece].high[k], mesh.position[v][k]);
      }
    }
    place_.resize(box_.size());
  }

  /// The place that all vertices of v's piece share, or nothing when v is in none or in a large one.
  [[nodiscard]] std::optional<GridPlace> shared_place(std::size_t v, double spacing, GridLocator& locator) {
    constexpr double kRigid = 3;  // [pixels] across
    const uint32_t piece = of_vertex(v);
    if (piece == kNone || distance(box_[piece].low, box_[piece].high) > kRigid * spacing) return std::nullopt;
    if (!place_[piece]) place_[piece] = locator.nearest((box_[piece].low + box_[piece].high) * 0.5);
    return place_[piece];
  }

 private:
  struct Box {
    Point3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  };

  [[nodiscard]] uint32_t of_vertex(std::size_t v) const {
    const uint32_t point = clean_.source_point[v];
    return point == kNone || point >= piece_of_point_.size() ? kNone : piece_of_point_[point];
  }

  const CleanSurface& clean_;
  std::span<const uint32_t> piece_of_point_;
  std::vector<Box> box_;
  std::vector<std::optional<GridPlace>> place_;
};

/// Orders the corners so that the frame's edge, from the first to the second, is the longest one: it keeps a direction
/// even where the triangle has collapsed.
Binding bind_at(const ClothAsset& asset, const GridPlace& place) {
  std::size_t start = 0;
  double longest = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double l = distance(to_double(asset.rest_position[place.pixel[k]]),
                              to_double(asset.rest_position[place.pixel[(k + 1) % 3]]));
    if (l > longest) {
      longest = l;
      start = k;
    }
  }
  Binding binding;
  for (std::size_t k = 0; k < 3; ++k) {
    binding.pixel[k] = place.pixel[(start + k) % 3];
    binding.weight[k] = static_cast<float>(std::clamp(place.weight[(start + k) % 3], 0.0, 1.0));
  }
  return binding;
}

/// Where evaluate_binding puts the source at rest when every offset is `offset`.
std::vector<Vec3> evaluate_at_rest(ClothAsset& asset, const std::vector<Vec3>& normal, const Vec3& offset) {
  for (Binding& b : asset.binding) b.offset = offset;
  std::vector<Vec3> out;
  evaluate_binding(asset, asset.rest_position, normal, out);
  return out;
}

/// Sets the offsets to what evaluate_binding lacks. Its local frames are read off its own results, for offsets along
/// each axis: so whatever frame it chooses is the one that is inverted here.
void set_offsets(ClothAsset& asset) {
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  float reach = asset.spacing;  // long enough to be read off without loss
  for (const Vec3& p : asset.source.position) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const std::vector<Vec3> base = evaluate_at_rest(asset, normal, {});
  std::array<std::vector<Vec3>, 3> tip{evaluate_at_rest(asset, normal, {reach, 0, 0}),
                                       evaluate_at_rest(asset, normal, {0, reach, 0}),
                                       evaluate_at_rest(asset, normal, {0, 0, reach})};
  std::vector<Vec3> now = base;
  std::vector<Point3> offset(asset.binding.size(), Point3{});
  for (int correction = 0; correction < 2; ++correction) {
    for (std::size_t i = 0; i < offset.size(); ++i) {
      const Point3 missing = to_double(asset.source.position[i]) - to_double(now[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const Point3 axis = (to_double(tip[k][i]) - to_double(base[i])) * (1 / double{reach});
        offset[i][k] += dot(axis, missing);
      }
      asset.binding[i].offset = to_single(offset[i]);
    }
    evaluate_binding(asset, asset.rest_position, normal, now);
  }
}

}  // namespace

void bind_source(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
                 ClothAsset& asset, std::span<const uint32_t> carried_piece, std::span<const Point3> beside) {
  asset.name = mesh.name;
  asset.vertex_groups = mesh.vertex_groups;
  asset.paint = mesh.paint;
  asset.source = render_mesh(mesh, clean);

  const std::vector<FlatPlace> places = flat_places(flat);
  GridLocator locator(flat, raster, asset);
  CarriedPieces carried(mesh, clean, carried_piece);
  std::vector<std::optional<GridPlace>> of_vertex(mesh.position.size());
  asset.binding.clear();
  for (const uint32_t v : asset.source.source_vertex) {
    if (!of_vertex[v]) {
      const uint32_t point = clean.source_point[v];
      const FlatPlace place = point == kNone ? FlatPlace{} : places[point];
      if (place.vertex != kNone) of_vertex[v] = locator.at_vertex(place.vertex, place.chart);
      if (!of_vertex[v]) of_vertex[v] = carried.shared_place(v, asset.spacing, locator);
      if (!of_vertex[v]) of_vertex[v] = locator.nearest(beside.empty() ? mesh.position[v] : beside[v]);
    }
    asset.binding.push_back(bind_at(asset, *of_vertex[v]));
  }
  set_offsets(asset);
}

}  // namespace geocloth
