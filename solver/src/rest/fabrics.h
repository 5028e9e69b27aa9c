// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/solver/solver.h"

namespace geocloth {

inline constexpr size_t kMostFabrics = 32;

/// What a cloth is made of from cell to cell, and at its pixels.
class FabricMap {
 public:
  /// @param cloth  its asset is not looked at
  /// @param uncut  the asset before any cut: cloth stays what it is where it is cut
  FabricMap(const ClothDesc& cloth, const ClothAsset& uncut);

  /// Of the cell whose first corner is a pixel.
  [[nodiscard]] const Material& of_cell(uint32_t pixel) const { return materials_[cell_.empty() ? 0 : cell_[pixel]]; }
  /// The mean of the cells about a pixel, by their triangles.
  [[nodiscard]] Material at(uint32_t pixel) const;
  /// The same for what bends there. Where fabrics change along a line it bends as one after the other.
  [[nodiscard]] Material bending_at(uint32_t pixel) const;
  /// [N m] Of a bend whose ends are of two rigidities.
  [[nodiscard]] double rigidity_between(double a, double b) const;
  /// Whether a rigidity on the bias is told of any of them: then of all of them.
  [[nodiscard]] bool has_bias() const { return materials_.front().bend_bias >= 0; }
  /// [N m] The largest rigidity of all.
  [[nodiscard]] float stiffest() const;
  /// The cloth's material, as heavy as the heaviest that it has cells of and as soft as the softest: it stretches most.
  [[nodiscard]] Material weakest() const;

 private:
  /// Cells by their first corners, not past an edge of the image.
  [[nodiscard]] Material mean_of(std::span<const uint32_t> cells, uint32_t otherwise) const;

  std::vector<Material> materials_;  ///< the cloth's own first
  std::vector<uint8_t> cell_;        ///< which of them, for each pixel as the first corner of a cell; empty: the first
  std::vector<uint8_t> lone_;        ///< the same of the pixels themselves, where no cell is about them
  std::vector<uint8_t> triangles_;   ///< of each cell
  uint32_t width_;
};

/// [N m] The largest rigidity of a material.
[[nodiscard]] float stiffest_bend(const Material& material);

/// Whether a fabric has a cell: all corners of one.
[[nodiscard]] bool has_cell(const ClothAsset& asset, std::span<const uint32_t> pixels);

}  // namespace geocloth
