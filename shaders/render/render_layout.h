// SPDX-License-Identifier: Apache-2.0
// What the renderer hands to its shaders; valid GLSL and C++.
#ifndef GEOCLOTH_RENDER_LAYOUT_H
#define GEOCLOTH_RENDER_LAYOUT_H

#include "shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {

/// Column-major, as GLSL has it.
struct mat4 {
  vec4 column[4];
};
#endif

// How a surface gets its colour (ClothDraw::mode).
const uint kDrawMaterial = 0u;  // base colour and texture of the source material
const uint kDrawColor = 1u;     // colour of the vertex
const uint kDrawGrid = 2u;      // base colour, lines where a coordinate of the image is whole
const uint kDrawStrain = 3u;    // heat colour of the structural springs' strain

// Bits of the fourth component of a rest pixel: which structural springs end there.
const uint kRestRight = 1u;
const uint kRestDown = 2u;
const uint kRestLeft = 4u;
const uint kRestUp = 8u;

// Constant over a picture: set 0, binding 0.
struct FrameParams {
  mat4 view_projection;
  mat4 light_projection;  // world to shadow map, xy in -1..1
  vec4 eye;               // [m]
  vec4 to_light;          // unit length; w: side of a texel of the shadow map [m]
  vec4 center;            // what the picture is about [m]; w: its radius
  vec4 viewport;          // [pixels] width, height
};

// Constant over a draw: push constants.
struct ClothDraw {
  vec4 base_color;     // linear
  vec4 origin;         // [m] added to the positions of the image
  uint width;          // of the position image [pixels]
  uint mode;           // kDraw*
  uint shadow_pass;    // 1: project for the light
  float scale;         // of the garment in its scene
  float alpha_cutoff;  // below it there is nothing, and all is opaque above; 0: blended
  float strain_range;  // strain at the end of the heat scale
};

struct SolidDraw {
  mat4 model;
  vec4 base_color;   // linear
  uint shadow_pass;  // 1: project for the light
  uint ground;       // 1: a plane with a grid that fades out
  float grid_scale;  // [m] per unit of the mesh
  float grid_step;   // [m]
};

struct RibbonDraw {
  vec4 origin;      // [m]
  uint width;       // of the position image [pixels]
  float thickness;  // [pixels]
};

struct PanelDraw {
  vec4 corner_size;  // upper left corner and size of what the picture shows, in the unit of the vertices
};

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
