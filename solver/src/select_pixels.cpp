// SPDX-License-Identifier: Apache-2.0
// Which points of a cloth a pin takes. All selectors work on surface points and return every copy of them.

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/solver/scene.h"

namespace geocloth {
namespace {

/// Boundary loops of the welded surface as sets of first copies.
class BoundaryLoops {
 public:
  explicit BoundaryLoops(const ClothAsset& asset) : asset_(asset), first_(first_copies(asset)) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> faces_of_edge;
    for (const Triangle& t : pixel_triangles(asset)) {
      for (size_t k = 0; k < 3; ++k) ++faces_of_edge[std::minmax(first_[t[k]], first_[t[(k + 1) % 3]])];
    }
    parent_.resize(asset.pixel_count());
    std::iota(parent_.begin(), parent_.end(), 0U);
    for (const auto& [edge, faces] : faces_of_edge) {
      if (faces == 1) edges_.push_back(edge);
    }
    for (const auto& [a, b] : edges_) parent_[root(a)] = root(b);
    collect();
  }

  struct Loop {
    std::vector<uint32_t> pixel;  ///< first copies, ascending
    double length = 0;            ///< [m] at rest
  };
  [[nodiscard]] const std::vector<Loop>& longest_first() const { return loops_; }

 private:
  uint32_t root(uint32_t p) {
    while (parent_[p] != p) p = parent_[p] = parent_[parent_[p]];
    return p;
  }

  void collect() {
    std::map<uint32_t, Loop> by_root;
    for (const auto& [a, b] : edges_) {
      Loop& loop = by_root[root(a)];
      loop.pixel.insert(loop.pixel.end(), {a, b});
      loop.length += static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
    }
    for (auto& [r, loop] : by_root) {
      std::sort(loop.pixel.begin(), loop.pixel.end());
      loop.pixel.erase(std::unique(loop.pixel.begin(), loop.pixel.end()), loop.pixel.end());
      loops_.push_back(std::move(loop));
    }
    std::sort(loops_.begin(), loops_.end(), [](const Loop& a, const Loop& b) {
      return a.length != b.length ? a.length > b.length : a.pixel < b.pixel;
    });
  }

  const ClothAsset& asset_;
  std::vector<uint32_t> first_, parent_;
  std::vector<std::pair<uint32_t, uint32_t>> edges_;
  std::vector<Loop> loops_;
};

class Selector {
 public:
  Selector(const ClothAsset& asset, const Transform& transform)
      : asset_(asset), transform_(transform), taken_(asset.pixel_count()) {}

  void operator()(const WhereTop& where) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for_valid([&](uint32_t, const Vec3& x) {
      low = std::min(low, x.y);
      high = std::max(high, x.y);
    });
    const float from = high - where.share * (high - low);
    for_valid([&](uint32_t p, const Vec3& x) { taken_[p] = x.y >= from; });
  }

  void operator()(const WhereBoundary& where) {
    const BoundaryLoops boundary(asset_);
    const auto& loops = boundary.longest_first();
    if (loops.empty())
      throw Error(ErrorCode::invalid_data, name() + "the surface is closed; it has no boundary to pin");
    if (where.index && *where.index >= loops.size()) {
      throw Error(ErrorCode::invalid_data, name() + "there is no boundary " + std::to_string(*where.index) +
                                               "; the surface has " + std::to_string(loops.size()) + " boundary loops");
    }
    const auto& loop = where.index ? loops[*where.index] : highest(loops);
    for (const uint32_t p : loop.pixel) taken_[p] = true;
  }

  void operator()(const WhereBox& where) {
    for_valid([&](uint32_t p, const Vec3& x) {
      taken_[p] = x.x >= where.min.x && x.y >= where.min.y && x.z >= where.min.z && x.x <= where.max.x &&
                  x.y <= where.max.y && x.z <= where.max.z;
    });
  }

  void operator()(const WhereSphere& where) {
    for_valid([&](uint32_t p, const Vec3& x) { taken_[p] = length(x - where.center) <= where.radius; });
  }

  void operator()(const WhereVertices& where) { take_vertices(where.source_vertex); }

  void operator()(const WhereVertexGroup& where) {
    std::string known;
    for (const auto& group : asset_.vertex_groups) {
      if (group.name == where.name) return take_vertices(group.source_vertex);
      known += (known.empty() ? "" : ", ") + group.name;
    }
    throw Error(ErrorCode::invalid_data,
                name() + "there is no vertex group \"" + where.name + "\"; it has " + (known.empty() ? "none" : known));
  }

  [[nodiscard]] std::vector<uint32_t> with_copies() {
    const SplitVertexTable& splits = asset_.splits;
    for (uint32_t r = 0; r < splits.rows(); ++r) {
      const auto begin = splits.pixel.begin() + splits.offset[r], end = splits.pixel.begin() + splits.offset[r + 1];
      if (std::any_of(begin, end, [&](uint32_t p) { return taken_[p]; })) {
        std::for_each(begin, end, [&](uint32_t p) { taken_[p] = true; });
      }
    }
    std::vector<uint32_t> pixels;
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p)
      if (taken_[p]) pixels.push_back(p);
    if (pixels.empty()) {
      throw Error(ErrorCode::invalid_data, name() + "the pin's \"where\" selects no point; widen it or move the cloth");
    }
    return pixels;
  }

 private:
  [[nodiscard]] std::string name() const { return asset_.name.empty() ? "" : asset_.name + ": "; }

  template <class Visit>
  void for_valid(const Visit& visit) const {
    for (uint32_t p = 0; p < asset_.pixel_count(); ++p)
      if (asset_.valid(p)) visit(p, apply(transform_, asset_.rest_position[p]));
  }

  [[nodiscard]] const BoundaryLoops::Loop& highest(const std::vector<BoundaryLoops::Loop>& loops) const {
    const auto mean_height = [&](const BoundaryLoops::Loop& loop) {
      double sum = 0;
      for (const uint32_t p : loop.pixel) sum += static_cast<double>(apply(transform_, asset_.rest_position[p]).y);
      return sum / static_cast<double>(loop.pixel.size());
    };
    return *std::max_element(loops.begin(), loops.end(),
                             [&](const auto& a, const auto& b) { return mean_height(a) < mean_height(b); });
  }

  /// A source vertex takes the pixel that has the largest share of it.
  void take_vertices(const std::vector<uint32_t>& ids) {
    std::vector<bool> wanted(asset_.source.source_vertex_count);
    for (const uint32_t id : ids) {
      if (id >= wanted.size()) {
        throw Error(ErrorCode::invalid_data, name() + "there is no source vertex " + std::to_string(id) +
                                                 "; the file has " + std::to_string(wanted.size()));
      }
      wanted[id] = true;
    }
    for (size_t v = 0; v < asset_.binding.size(); ++v) {
      if (!wanted[asset_.source.source_vertex[v]]) continue;
      const Binding& binding = asset_.binding[v];
      const auto largest = std::max_element(binding.weight.begin(), binding.weight.end()) - binding.weight.begin();
      taken_[binding.pixel[static_cast<size_t>(largest)]] = true;
    }
  }

  const ClothAsset& asset_;
  const Transform& transform_;
  std::vector<bool> taken_;
};

}  // namespace

std::vector<uint32_t> select_pixels(const ClothAsset& asset, const Transform& transform, const Where& where) {
  Selector selector(asset, transform);
  std::visit(selector, where);
  return selector.with_copies();
}

}  // namespace geocloth
