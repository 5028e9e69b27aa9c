// SPDX-License-Identifier: GPL-3.0-or-later
// Exact signs by CGAL's filtered kernel (Bronnimann, Burnikel, Pion 1998): a pixel that lies on the edge of two
// triangles must belong to exactly one of them, and rounding would give it to both or to none.
#include "mesh/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace geocloth {

int orientation(const Point2& a, const Point2& b, const Point2& c) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  return -static_cast<int>(CGAL::orientation(Point(a[0], a[1]), Point(b[0], b[1]), Point(c[0], c[1])));
}

}  // namespace geocloth
