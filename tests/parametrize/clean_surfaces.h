// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "geocloth/parametrize/mesh.h"

// Clean surfaces made by hand, each with a topology that a garment can have.

namespace geocloth::test {

/// A surface over nx x ny points; where it closes on itself, quads wrap around.
struct GridSurface {
  uint32_t nx = 2, ny = 2;  ///< points
  bool wrap_x = false, wrap_y = false;
};

/// A file's mesh of one part, "garment".
TriangleMesh as_mesh(std::vector<Point3> position, std::vector<Triangle> triangle);

CleanSurface disk(uint32_t nx, uint32_t ny, double width = 1, double height = 1);
CleanSurface cylinder(uint32_t around, uint32_t along, double radius = 1, double height = 2);
CleanSurface torus(uint32_t around, uint32_t along);
CleanSurface sphere(uint32_t around, uint32_t along);
CleanSurface tetrahedron();
CleanSurface single_triangle();
/// A strip with half a turn, torn where its ends meet: the ends' vertices are tied in opposite order.
CleanSurface moebius(uint32_t around, uint32_t across);
/// A flat sheet with a second one standing on its middle row, which repair detached: three triangles at every edge.
CleanSurface sheet_with_flap(uint32_t nx, uint32_t ny);
/// A tube with a ring of cloth sewn all around its middle.
CleanSurface cylinder_with_belt(uint32_t around, uint32_t along);
/// A sphere with a triangle that stands on one of its edges: the only tie is a slit of one edge.
CleanSurface sphere_with_fin();
/// Two spheres that share one point.
CleanSurface touching_spheres();
/// A sheet with square holes in it, holes_x times holes_y of them, joined corner to corner when `touching`.
CleanSurface sheet_with_holes(uint32_t holes_x, uint32_t holes_y, bool touching);
/// A T-shirt of four openings: a body tube closed over the shoulders, with two sleeves and a neck.
CleanSurface shirt(uint32_t detail);

struct NamedSurface {
  std::string name;
  std::function<CleanSurface()>
      make;  ///< in the test itself: each is a process that would make those of all others too
};
void PrintTo(const NamedSurface& s, std::ostream* out);
/// Disks, tubes, closed and one-sided surfaces, handles, ties and holes: for parametrised tests.
std::vector<NamedSurface> surfaces_of_every_topology();

}  // namespace geocloth::test
