// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/triangle_middles.h"

#include "mesh/point_math.h"

namespace geocloth {

std::vector<TriangleMiddle> triangle_middles(std::span<const Point3> position, std::span<const Triangle> triangle) {
  std::vector<TriangleMiddle> result;
  result.reserve(triangle.size());
  for (const Triangle& t : triangle) {
    const Point3 &a = position[t[0]], &b = position[t[1]], &c = position[t[2]];
    result.push_back({(a + b + c) * (1.0 / 3), triangle_area(a, b, c)});
  }
  return result;
}

Point3 normal_of(std::span<const Point3> position, const Triangle& triangle) {
  const Point3& a = position[triangle[0]];
  return cross(position[triangle[1]] - a, position[triangle[2]] - a);
}

Point3 normal_of(const CleanSurface& surface, size_t triangle) {
  return normal_of(surface.position, surface.triangle[triangle]);
}

double total_area(std::span<const TriangleMiddle> middle) {
  double area = 0;
  for (const TriangleMiddle& m : middle) area += m.area;
  return area;
}

std::vector<Point3> even_samples(std::span<const TriangleMiddle> middle, std::size_t count) {
  const double area = total_area(middle);
  std::vector<Point3> samples;
  double so_far = 0;
  for (const TriangleMiddle& m : middle) {
    so_far += m.area;
    while (samples.size() < count &&
           so_far > area * (static_cast<double>(samples.size()) + 0.5) / static_cast<double>(count)) {
      samples.push_back(m.place);
    }
  }
  return samples;
}

}  // namespace geocloth
