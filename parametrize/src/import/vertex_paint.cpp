// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/vertex_paint.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace geocloth::import_detail {
namespace {

constexpr std::array<const char*, 8> kKindName{"black", "red", "green", "yellow", "blue", "magenta", "cyan", "white"};
constexpr unsigned kWhite = 1U << 7U;

}  // namespace

void VertexPaint::add(uint32_t vertex, const Color& color) {
  if (vertex >= vertex_.size()) vertex_.resize(vertex + std::size_t{1});
  Vertex& v = vertex_[vertex];
  const int kind = (color[0] > 0.5F ? 1 : 0) + (color[1] > 0.5F ? 2 : 0) + (color[2] > 0.5F ? 4 : 0);
  v.kinds = static_cast<uint8_t>(v.kinds | 1U << kind);
  for (std::size_t k = 0; k < color.size(); ++k)
    v.sum[k] += std::isfinite(color[k]) ? std::clamp(color[k], 0.0F, 1.0F) : 1;
  ++v.corners;
}

void VertexPaint::copy(uint32_t from, uint32_t to) {
  vertex_.resize(std::max(vertex_.size(), std::max(from, to) + std::size_t{1}));
  if (vertex_[to].corners == 0) vertex_[to] = vertex_[from];
}

std::vector<Rgba8> VertexPaint::colors(std::size_t vertex_count) const {
  std::vector<Rgba8> colors(vertex_count, Rgba8{255, 255, 255, 255});
  for (std::size_t v = 0; v < std::min(vertex_count, vertex_.size()); ++v) {
    const auto corners = static_cast<float>(vertex_[v].corners);
    if (!(corners > 0)) continue;
    for (std::size_t k = 0; k < 4; ++k)
      colors[v][k] = static_cast<uint8_t>(std::lround(255 * std::min(vertex_[v].sum[k] / corners, 1.0F)));
  }
  return colors;
}

std::vector<ClothAsset::VertexGroup> VertexPaint::groups(std::size_t vertex_count) const {
  const auto kinds_of = [&](std::size_t v) {
    const unsigned kinds = v < vertex_.size() ? vertex_[v].kinds : 0;
    return kinds != 0 ? kinds : kWhite;
  };
  std::vector<ClothAsset::VertexGroup> groups;
  unsigned all = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) all |= kinds_of(v);
  if (std::popcount(all) < 2) return groups;
  for (unsigned kind = 0; kind < kKindName.size(); ++kind) {
    if ((all >> kind & 1U) == 0) continue;
    ClothAsset::VertexGroup& group = groups.emplace_back();
    group.name = std::string("color:") + kKindName[kind];
    for (uint32_t v = 0; v < vertex_count; ++v)
      if ((kinds_of(v) >> kind & 1U) != 0) group.source_vertex.push_back(v);
  }
  return groups;
}

Rgba8 mean(const Rgba8& a, const Rgba8& b) {
  Rgba8 m{};
  for (std::size_t k = 0; k < m.size(); ++k) m[k] = static_cast<uint8_t>((unsigned{a[k]} + b[k] + 1) / 2);
  return m;
}

}  // namespace geocloth::import_detail
