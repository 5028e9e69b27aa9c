// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace geocloth::meshes {

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;
using Face = std::vector<uint32_t>;  ///< vertex indices, counter-clockwise seen from outside

/// What one OBJ file holds. Texture coordinates are per face corner, because a seam has two.
struct ObjMesh {
  std::string name{};
  std::string comment{};           ///< first line of the file
  std::vector<Point3> position{};  ///< [m]
  std::vector<Face> face{};
  std::vector<Point2> uv{};
  std::vector<Face> face_uv{};                  ///< as many as faces, or empty
  std::vector<std::array<uint32_t, 2>> line{};  ///< edges between vertices of panels that are to be sewn together
};

/// Wavefront OBJ text; coordinates with five decimals, so that the last bits of a sine do not matter.
[[nodiscard]] std::string to_obj(const ObjMesh& mesh);

/// Garments that a person could wear, and one tiny mesh per defect that real files have.
[[nodiscard]] std::vector<ObjMesh> make_garments();
[[nodiscard]] std::vector<ObjMesh> make_defects();

}  // namespace geocloth::meshes
