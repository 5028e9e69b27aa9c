// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// The pixels that a chart takes up, as runs of a row.
struct ChartShape {
  struct Run {
    uint32_t row, first, last;  ///< columns first..last
  };
  uint32_t width = 0, height = 0;  ///< [pixels]
  std::vector<Run> run;            ///< may overlap; not empty
};

/// @throws Error(limit) when a side exceeds kMaxImageSide
[[nodiscard]] ChartShape rectangle_shape(uint32_t width, uint32_t height);

/// The outline of a chart and everything inside.
[[nodiscard]] ChartShape chart_shape(const FlatChart& chart);

/// Where charts lie in an atlas [pixels].
struct Packing {
  uint32_t width = 0, height = 0;
  std::vector<std::array<uint32_t, 2>> corner;  ///< top left, per chart
  std::vector<uint8_t> turned;                  ///< per chart: non-zero when it lies turned by half a turn
};

/// How long to look for a good packing; `quick` is for comparing sets of shapes with each other.
enum class PackEffort : uint8_t { quick, thorough };

/// Packs shapes into a small and not too lopsided atlas: pixels of different shapes never are 8-neighbours, and a shape
/// may lie in the hollow of another. Shapes are not mirrored and, so that the grain stays along v, turned by half a
/// turn at most, and only where that saves a few per cent of the atlas. Deterministic.
/// @throws Error(limit) when the atlas would exceed kMaxImageSide
[[nodiscard]] Packing pack_shapes(std::span<const ChartShape> shape, PackEffort effort = PackEffort::thorough);

/// The same with little effort, of shapes that are ready for it (ready_shape.h).
struct ReadyShape;
[[nodiscard]] Packing pack_quickly(std::span<const ReadyShape* const> shape);

/// Packs the charts of a flat surface: sets its size and the charts' corners, and turns charts with their vertices.
/// @param flat  complete but for width, height and the charts' corners
void pack_charts(FlatSurface& flat);
/// The same where the packing of its charts' shapes is known.
void arrange_charts(FlatSurface& flat, const Packing& packing);

/// Turns a packed atlas by half a turn.
void turn_atlas(FlatSurface& flat);

}  // namespace geocloth
