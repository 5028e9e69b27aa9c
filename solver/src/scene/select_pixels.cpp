// SPDX-License-Identifier: Apache-2.0
// Which points of a cloth a pin takes. All selectors work on surface points and return every copy of them.

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "colliders/closest.h"
#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/scene.h"
#include "scene/source_surface.h"

namespace geocloth {
namespace {

struct Loop {
  std::vector<uint32_t> pixel;  ///< first copies, ascending
  double length = 0;            ///< [m] at rest
  uint32_t part = 0;            ///< a pixel that stands for the connected part it belongs to
};

/// The welded surface: its connected parts and their boundary loops, as sets of first copies.
class WeldedSurface {
 public:
  explicit WeldedSurface(const ClothAsset& asset)
      : asset_(asset), first_(first_copies(asset)), parts_(connected_parts(asset)) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> faces_of_edge;
    for (const Triangle& t : pixel_triangles(asset)) {
      for (size_t k = 0; k < 3; ++k) ++faces_of_edge[std::minmax(first_[t[k]], first_[t[(k + 1) % 3]])];
    }
    std::vector<std::pair<uint32_t, uint32_t>> border;
    for (const auto& [edge, faces] : faces_of_edge) {
      if (faces == 1) border.push_back(edge);
    }
    collect_loops(border);
  }

  [[nodiscard]] const std::vector<Loop>& longest_first() const { return loops_; }
  [[nodiscard]] uint32_t part_of(uint32_t pixel) const { return parts_[pixel]; }

 private:
  void collect_loops(const std::vector<std::pair<uint32_t, uint32_t>>& border) {
    DisjointSets loops(asset_.pixel_count());
    for (const auto& [a, b] : border) loops.join(a, b);
    std::map<uint32_t, Loop> by_root;
    for (const auto& [a, b] : border) {
      Loop& loop = by_root[loops.find(a)];
      loop.pixel.insert(loop.pixel.end(), {a, b});
      loop.length += static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
    }
    for (auto& [r, loop] : by_root) {
      std::sort(loop.pixel.begin(), loop.pixel.end());
      loop.pixel.erase(std::unique(loop.pixel.begin(), loop.pixel.end()), loop.pixel.end());
      loop.part = parts_[loop.pixel.front()];
      loops_.push_back(std::move(loop));
    }
    std::sort(loops_.begin(), loops_.end(), [](const Loop& a, const Loop& b) {
      return a.length != b.length ? a.length > b.length : a.pixel < b.pixel;
    });
  }

  const ClothAsset& asset_;
  std::vector<uint32_t> first_;
  std::vector<uint32_t> parts_;
  std::vector<Loop> loops_;
};

class Selector {
 public:
  Selector(const ClothAsset& asset, const Transform& transform)
      : asset_(asset), transform_(transform), taken_(asset.pixel_count()) {}

  void operator()(const WhereTop& where) {
    take_top(where.share, [](uint32_t) { return true; });
  }

  void operator()(const WhereBoundary& where) {
    const WeldedSurface surface(asset_);
    const std::vector<Loop>& loops = surface.longest_first();
    if (loops.empty()) {
      throw Error(ErrorCode::invalid_data,
                  name() + "the surface is closed, so it has no boundary to pin; take top, box, sphere or vertices");
    }
    if (where.index && *where.index >= loops.size()) {
      throw Error(ErrorCode::invalid_data, name() + "there is no boundary " + std::to_string(*where.index) +
                                               "; the surface has " + std::to_string(loops.size()) + " boundary loops");
    }
    if (where.index) return take(loops[*where.index]);
    take(*std::max_element(loops.begin(), loops.end(),
                           [&](const Loop& a, const Loop& b) { return mean_height(a) < mean_height(b); }));
  }

  void operator()(const WhereHanger&) { take_highest_of_each_part(WeldedSurface(asset_)); }

  void operator()(const WhereBox& where) {
    const float slack = rounding();
    const Vec3 low = where.min - Vec3{slack, slack, slack}, high = where.max + Vec3{slack, slack, slack};
    for_valid([&](uint32_t p, const Vec3& x) {
      taken_[p] = x.x >= low.x && x.y >= low.y && x.z >= low.z && x.x <= high.x && x.y <= high.y && x.z <= high.z;
    });
  }

  void operator()(const WhereSphere& where) {
    const float radius = where.radius + rounding();
    for_valid([&](uint32_t p, const Vec3& x) { taken_[p] = length(x - where.center) <= radius; });
  }

  void operator()(const WhereVertices& where) { take_vertices(marked(where.source_vertex)); }

  void operator()(const WhereVertexGroup& where) {
    const auto group = std::ranges::find(asset_.vertex_groups, where.name, &ClothAsset::VertexGroup::name);
    if (group != asset_.vertex_groups.end()) return take_surface(marked(group->source_vertex));
    refuse("vertex group", where.name, asset_.vertex_groups);
  }

  void operator()(const WhereMaterial& where) {
    const SourceMesh& source = asset_.source;
    std::vector<bool> wanted(source.source_vertex_count);
    for (const SourcePart& part : source.part) {
      if (source.material[part.material].name != where.name) continue;
      for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t)
        for (const uint32_t v : source.triangle[t]) wanted[source.source_vertex[v]] = true;
    }
    if (std::ranges::find(wanted, true) == wanted.end()) refuse("material", where.name, source.material);
    take_surface(wanted);
  }

  [[nodiscard]] std::vector<uint32_t> with_copies() {
    const SplitVertexTable& splits = asset_.splits;
    for (uint32_t r = 0; r < splits.rows(); ++r) {
      const std::span<const uint32_t> copies = splits.copies(r);
      if (std::ranges::none_of(copies, [&](uint32_t p) { return taken_[p]; })) continue;
      for (const uint32_t p : copies) taken_[p] = true;
    }
    std::vector<uint32_t> pixels;
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p)
      if (taken_[p]) pixels.push_back(p);
    if (pixels.empty()) {
      throw Error(ErrorCode::invalid_data, name() + "\"where\" selects no point; widen it or move the cloth");
    }
    return pixels;
  }

 private:
  template <class Named>
  [[noreturn]] void refuse(const std::string& what, const std::string& wanted, const std::vector<Named>& all) const {
    std::string known;
    for (const Named& other : all) known += (known.empty() ? "" : ", ") + other.name;
    throw Error(ErrorCode::invalid_data,
                name() + "there is no " + what + " \"" + wanted + "\"; it has " + (known.empty() ? "none" : known));
  }

  [[nodiscard]] std::string name() const { return asset_.name.empty() ? "" : asset_.name + ": "; }

  /// [m] A row that lies on the face of a box is taken whole, on whichever side of it rounding left its points.
  [[nodiscard]] float rounding() const { return 1e-3F * asset_.spacing * transform_.scale; }

  template <class Visit>
  void for_valid(const Visit& visit) const {
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p)
      if (asset_.valid(p)) visit(p, apply(transform_, asset_.rest_position[p]));
  }

  void take(const Loop& loop) {
    for (const uint32_t p : loop.pixel) taken_[p] = true;
  }

  struct Range {
    float low = std::numeric_limits<float>::max(), high = -std::numeric_limits<float>::max();
    void include(float x) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
    [[nodiscard]] float length() const { return high - low; }
    [[nodiscard]] float middle() const { return 0.5F * (low + high); }
  };

  /// Along an axis, of the pixels that are in a set.
  template <class InSet>
  [[nodiscard]] Range range_of(float Vec3::*axis, const InSet& in_set) const {
    Range range;
    for_valid([&](uint32_t p, const Vec3& x) {
      if (in_set(p)) range.include(x.*axis);
    });
    return range;
  }

  /// The highest share of the height of the pixels that are in a set.
  template <class InSet>
  void take_top(float share, const InSet& in_set) {
    const Range height = range_of(&Vec3::y, in_set);
    const float from = height.high - share * height.length() - rounding();
    for_valid([&](uint32_t p, const Vec3& x) {
      if (in_set(p) && x.y >= from) taken_[p] = true;
    });
  }

  /// One end of a level sheet.
  template <class InSet>
  void take_end(float share, const InSet& in_set) {
    const bool along_x = range_of(&Vec3::x, in_set).length() >= range_of(&Vec3::z, in_set).length();
    float Vec3::*const axis = along_x ? &Vec3::x : &Vec3::z;
    const Range range = range_of(axis, in_set);
    const float to = range.low + share * range.length() + rounding();
    for_valid([&](uint32_t p, const Vec3& x) {
      if (in_set(p) && x.*axis <= to) taken_[p] = true;
    });
  }

  /// What a part hangs by.
  /// @param loop  its highest boundary, if it has any
  void hang(uint32_t part, const Loop* loop, const WeldedSurface& surface) {
    constexpr float kEnd = 0.02F;                  // of the part's height or length
    constexpr float kDeep = 0.2F, kLevel = 0.05F;  // of its height, and of its length
    const auto in_part = [&](uint32_t p) { return surface.part_of(p) == part; };
    if (loop == nullptr) return take_top(kEnd, in_part);
    Range rim;
    for (const uint32_t p : loop->pixel) rim.include(apply(transform_, asset_.rest_position[p]).y);
    const Range heights = range_of(&Vec3::y, in_part);
    const float height = heights.length();
    const float length = std::max(range_of(&Vec3::x, in_part).length(), range_of(&Vec3::z, in_part).length());
    // The rim of a flag or a cape goes all around it: held by that, nothing moves. A hat or a tent would fall through
    // its.
    const bool falls_through = rim.middle() < heights.middle() && height > kLevel * length;
    if (!falls_through && rim.length() <= kDeep * height && height > rounding()) return take(*loop);
    if (height > kLevel * length) return take_top(kEnd, in_part);
    take_end(kEnd, in_part);
  }

  void take_highest_of_each_part(const WeldedSurface& surface) {
    std::map<uint32_t, const Loop*> highest;  // of every part; none for a closed one
    for_valid([&](uint32_t p, const Vec3&) { highest.emplace(surface.part_of(p), nullptr); });
    for (const Loop& loop : surface.longest_first()) {
      const Loop*& best = highest[loop.part];
      if (best == nullptr || mean_height(loop) > mean_height(*best)) best = &loop;
    }
    for (const auto& [part, loop] : highest) hang(part, loop, surface);
  }

  [[nodiscard]] double mean_height(const Loop& loop) const {
    double sum = 0;
    for (const uint32_t p : loop.pixel) sum += static_cast<double>(apply(transform_, asset_.rest_position[p]).y);
    return sum / static_cast<double>(loop.pixel.size());
  }

  /// A source vertex takes the pixel that has the largest share of it.
  /// By source vertex, which are listed.
  [[nodiscard]] std::vector<bool> marked(const std::vector<uint32_t>& ids) const {
    std::vector<bool> wanted(asset_.source.source_vertex_count);
    for (const uint32_t id : ids) {
      if (id >= wanted.size()) {
        throw Error(ErrorCode::invalid_data, name() + "there is no source vertex " + std::to_string(id) +
                                                 "; the file has " + std::to_string(wanted.size()));
      }
      wanted[id] = true;
    }
    return wanted;
  }

  void take_vertices(const std::vector<bool>& wanted) {
    for (size_t v = 0; v < asset_.binding.size(); ++v) {
      if (!wanted[asset_.source.source_vertex[v]]) continue;
      const Binding& binding = asset_.binding[v];
      const auto largest = std::max_element(binding.weight.begin(), binding.weight.end()) - binding.weight.begin();
      taken_[binding.pixel[static_cast<size_t>(largest)]] = true;
    }
  }

  void take_surface(const std::vector<bool>& wanted) {
    take_vertices(wanted);
    take_between(wanted);
  }

  /// What lies on triangles and edges between vertices of a group: where those of the mesh are long the pixels at its
  /// vertices alone would be dots, between which the cloth hangs through.
  void take_between(const std::vector<bool>& wanted) {
    const SourceMesh& source = asset_.source;
    const SourceSurface surface(asset_);
    const double beside = kBesideEdge * double{asset_.spacing};
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p) {
      if (!asset_.valid(p) || taken_[p]) continue;
      const Vec3d x = to_double(asset_.rest_position[p]);
      const std::optional<RestPlace> place = surface.place_of(p);
      if (!place) return;
      std::vector<Vec3d> of_group;
      for (const uint32_t v : place->triangle)
        if (wanted[source.source_vertex[v]]) of_group.push_back(to_double(source.position[v]));
      taken_[p] = of_group.size() == 3 ||
                  (of_group.size() == 2 && length(x - closest_on_segment(of_group[0], of_group[1], x)) <= beside);
    }
  }
  static constexpr double kBesideEdge = 0.51;  ///< spacings: one pixel at least in every row or column that it crosses

  const ClothAsset& asset_;
  const Transform& transform_;
  std::vector<bool> taken_;
};

}  // namespace

std::vector<uint32_t> connected_parts(const ClothAsset& asset) {
  const std::vector<uint32_t> first = first_copies(asset);
  DisjointSets parts(asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    parts.join(p, first[p]);
    for (uint32_t s = 0; s < kSpringCount; ++s) {
      if ((asset.spring_mask[p] & (1U << s)) == 0) continue;
      const int64_t q = int64_t{p} + kSpringOffset[s][0] + int64_t{asset.width} * kSpringOffset[s][1];
      parts.join(p, static_cast<uint32_t>(q));
    }
  }
  std::vector<uint32_t> part(asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) part[p] = parts.find(p);
  return part;
}

std::vector<uint32_t> select_pixels(const ClothAsset& asset, const Transform& transform, const Where& where) {
  Selector selector(asset, transform);
  std::visit(selector, where);
  return selector.with_copies();
}

}  // namespace geocloth
