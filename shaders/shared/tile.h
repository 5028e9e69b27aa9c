// SPDX-License-Identifier: Apache-2.0
// Passes of a schedule that one work group runs in its own memory: what tile.comp and tiny.comp read.
#ifndef GEOCLOTH_SHARED_TILE_H
#define GEOCLOTH_SHARED_TILE_H

#include "types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// Descriptor set 1, one for each cloth and direction.
const uint kBindingTileSteps = 0u;    // buffer TileStep[]
const uint kBindingPinOfPixel = 1u;   // buffer uint[pixels]: index into PinTarget[], kNoPin; read when there are pins
const uint kBindingPositionOut = 2u;  // image rgba32f, where tile.comp writes; it reads from set 0
const uint kBindingPreviousOut = 3u;  // image rgba32f
const uint kBindingCarryOut = 4u;     // image rgba32f
const uint kNoPin = 0xFFFFFFFFu;

// TileStep::pass.
const uint kTileNormals = 0u;
const uint kTileNormalsStitch = 1u;
const uint kTilePredict = 2u;  // and the pins
const uint kTileSprings = 3u;
const uint kTileBends = 4u;
const uint kTileSeamBends = 5u;
const uint kTileSeamCurvature = 6u;
const uint kTileStitch = 7u;
const uint kTileLimit = 8u;
const uint kTileCollide = 9u;
const uint kTileCheckCopies = 10u;
const uint kTileCheckColliders = 11u;
const uint kTileSpans = 12u;
const uint kTileSeamSpans = 13u;
const uint kTileHoldWay = 14u;
const uint kTileTies = 15u;
const uint kTileGiveWay = 16u;
const uint kTileLines = 17u;
const uint kTileWholeTies = 18u;
const uint kTileSew = 19u;

// One pass, with what it would get as PassConstants.
struct TileStep {
  uint pass;
  uint substep;
  uint group;
  uint first;
  uint count;
  uint read_multiplier;
  uint write_multiplier;
  uint pins;  // 1: with kTilePredict, the cloth has pins
};

// Push constants of a dispatch.
struct TileConstants {
  uint first;         // step
  uint count;         // of them
  uint keep_history;  // 1: the steps do not write previous and carry of every free point: they go along as they are
};

#ifdef __cplusplus
static_assert(sizeof(TileStep) == 32 && sizeof(TileConstants) == 12);
}  // namespace geocloth::shader
#endif

#endif
