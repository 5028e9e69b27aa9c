// SPDX-License-Identifier: Apache-2.0
// Passes over all of a cloth in one region: those that reach too far for a tile, or whose points are anywhere.
#include "lines.glsl"
#include "normals.glsl"
#include "stitch.glsl"

void run_spans() {
  for (uint i = gl_LocalInvocationIndex; i < region_size.x * region_size.y; i += gl_WorkGroupSize.x) {
    uvec2 p = pixel_of_region(i);
    if (span_starts(constants.group, p.x, p.y)) span_at(p);
  }
}

void run_pixels_alone(uint pass) {
  for (uint i = gl_LocalInvocationIndex; i < region_size.x * region_size.y; i += gl_WorkGroupSize.x) {
    uvec2 p = pixel_of_region(i);
    switch (pass) {
      case kTileNormals:
        normal_at(p);
        break;
      case kTileHoldWay:
        hold_way_at(p);
        break;
      case kTileCheckColliders:
        if (kContacts) check_colliders_at(p);
        break;
    }
  }
}

void run_lines() {
  for (uint n = gl_LocalInvocationIndex; n < (constants.group == 0u ? params.height : params.width);
       n += gl_WorkGroupSize.x) {
    line_at(n);
  }
}

void run_list(uint pass) {
  for (uint i = gl_LocalInvocationIndex; i < constants.count; i += gl_WorkGroupSize.x) {
    switch (pass) {
      case kTileNormalsStitch:
        stitch_normals(i);
        break;
      case kTileSeamBends:
        seam_bend_at(constants.first + i);
        break;
      case kTileSeamCurvature:
        seam_curvature_at(constants.first + i);
        break;
      case kTileSeamSpans:
        seam_span_at(constants.first + i);
        break;
      case kTileWholeTies:
        whole_tie_at(constants.first + i);
        break;
      case kTileSew:
        sew_at(constants.first + i);
        break;
      case kTileStitch:
        stitch_at(i);
        break;
      case kTileCheckCopies:
        check_copies_at(i);
        break;
    }
  }
}

void run_whole_step(uint pass) {
  if (pass == kTileSpans) {
    run_spans();
  } else if (pass == kTileLines) {
    run_lines();
  } else if (pass == kTileNormals || pass == kTileHoldWay || pass == kTileCheckColliders) {
    run_pixels_alone(pass);
  } else {
    run_list(pass);
  }
}
