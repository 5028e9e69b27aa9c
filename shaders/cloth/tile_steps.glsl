// SPDX-License-Identifier: Apache-2.0
// Runs steps of a schedule over a region. Every invocation takes each so many-th pixel, always the same ones.
//
// The includer defines, before, const bool kPredicts, whether steps may predict, and, after, run_whole_step(): passes
// that want all of a cloth in one region. (Shaders' compilers inline every call: what never runs is better not there.)
#include "constraints.glsl"
#include "contacts.glsl"
#include "limit.glsl"
#include "predict.glsl"

void run_whole_step(uint pass);

uvec2 pixel_of_region(uint i) {
  return region_low + uvec2(i % region_size.x, i / region_size.x);
}

// Springs and bends are met line by line of their group; some lines lie outside of the region.
uvec2 in_lines(uint i, bool by_column, uint lines) {
  uint length = by_column ? lines : region_size.x;
  return uvec2(i % length, i / length);
}

void run_springs(bool ties) {
  bool by_column = group_by_column(constants.group) == 1u;
  uint low = by_column ? region_low.x : region_low.y;
  uint size = by_column ? region_size.x : region_size.y;
  bool by_pairs = constants.group >= 8u;
  uint first = by_pairs ? 2u * (low / 4u) : low / 2u;
  uint lines = by_pairs ? 2u * (size / 4u + 2u) : size / 2u + 1u;
  uint family = constants.group / 4u;
  for (uint i = gl_LocalInvocationIndex; i < lines * (by_column ? region_size.y : region_size.x);
       i += gl_WorkGroupSize.x) {
    uvec2 n = in_lines(i, by_column, lines);
    uvec2 p = by_column ? uvec2(group_line(constants.group, first + n.x), region_low.y + n.y)
                        : uvec2(region_low.x + n.x, group_line(constants.group, first + n.y));
    if (!is_here(p)) continue;
    if (ties) {
      tie_at(p);
    } else {
      spring_at(family, p);
    }
  }
}

void run_bends() {
  bool by_column = constants.group < 3u;
  uint first = (by_column ? region_low.x : region_low.y) / 3u;
  uint lines = (by_column ? region_size.x : region_size.y) / 3u + 2u;
  uint offset = constants.group % 3u;
  for (uint i = gl_LocalInvocationIndex; i < lines * (by_column ? region_size.y : region_size.x);
       i += gl_WorkGroupSize.x) {
    uvec2 n = in_lines(i, by_column, lines);
    uvec2 p = by_column ? uvec2(3u * (first + n.x) + offset, region_low.y + n.y)
                        : uvec2(region_low.x + n.x, 3u * (first + n.y) + offset);
    if (is_here(p)) bend_at(p);
  }
}

void run_pixels(uint pass, bool pins_too) {
  for (uint i = gl_LocalInvocationIndex; i < region_size.x * region_size.y; i += gl_WorkGroupSize.x) {
    uvec2 p = pixel_of_region(i);
    begin_pixel();
    switch (pass) {
      case kTilePredict:
        if (kPredicts) predict_at(p);
        if (kPredicts && pins_too) {
          uint pin = pin_of_pixel[p.y * params.width + p.x];
          if (pin != kNoPin) pin_at(pin);
        }
        break;
      case kTileLimit:
        if (is_kept(p)) limit_at(p);
        break;
      case kTileCollide:
        if (kContacts && is_kept(p)) collide_at(p);
        break;
      case kTileGiveWay:
        if (kContacts && is_kept(p)) give_way_at(p);
        break;
    }
  }
}

void run_steps() {
  for (uint s = tile.first; s < tile.first + tile.count; ++s) {
    TileStep next = tile_steps[s];
    constants.substep = next.substep;
    constants.group = next.group;
    constants.first = next.first;
    constants.count = next.count;
    constants.read_multiplier = next.read_multiplier;
    constants.write_multiplier = next.write_multiplier;
    barrier();
    if (next.pass == kTileSprings || next.pass == kTileTies) {
      run_springs(next.pass == kTileTies);
    } else if (next.pass == kTileBends) {
      run_bends();
    } else if (next.pass == kTilePredict || next.pass == kTileLimit || next.pass == kTileCollide ||
               next.pass == kTileGiveWay) {
      run_pixels(next.pass, next.pins != 0u);
    } else {
      run_whole_step(next.pass);
    }
    memoryBarrierImage();  // for the normals, which copies share
  }
  barrier();
}
