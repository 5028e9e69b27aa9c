// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth::import_detail {

/// What the vertices of a file are painted in, corner by corner: a vertex may have one in each of its faces.
class VertexPaint {
 public:
  using Color = std::array<float, 4>;  ///< red, green, blue, alpha; 0..1

  void add(uint32_t vertex, const Color& color);
  /// Paints a vertex that has no paint as another one is.
  void copy(uint32_t from, uint32_t to);

  /// The mean over its corners of each vertex; white where it has none.
  [[nodiscard]] std::vector<Rgba8> colors(std::size_t vertex_count) const;
  /// The vertices of one colour of eight, or nearly, are a group, "color:red", where there are several colours. One
  /// whose corners differ is in several.
  /// @param vertex_count  those that were not added are white
  [[nodiscard]] std::vector<ClothAsset::VertexGroup> groups(std::size_t vertex_count) const;

 private:
  struct Vertex {
    Color sum{};
    uint32_t corners = 0;
    uint8_t kinds = 0;  ///< bit r + 2 g + 4 b with red, green and blue 0 or 1
  };
  std::vector<Vertex> vertex_;
};

/// Of two vertices that another one lies between.
[[nodiscard]] Rgba8 mean(const Rgba8& a, const Rgba8& b);

}  // namespace geocloth::import_detail
