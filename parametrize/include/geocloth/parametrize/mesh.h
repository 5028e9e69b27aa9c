// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;

inline constexpr uint32_t kNone = 0xFFFFFFFFU;  ///< "no such element"

/// Reports how far a long operation is; called from one thread. Throw Error(cancelled) from it to stop the work.
/// @param stage     name of the stage ("import", "repair", "cut", ...)
/// @param fraction  0..1 of that stage
using Progress = std::function<void(std::string_view stage, double fraction)>;

/// A mesh as its file has it: triangulated, node transforms applied, in metres, y up, nothing repaired.
struct TriangleMesh {
  std::string name;              ///< stem of the file name
  std::vector<Point3> position;  ///< vertices of the file, in the file's order [m]
  /// Of vertices at the end that refine_mesh() added: the two before it that each is in the middle of.
  std::vector<std::array<uint32_t, 2>> middle;
  std::vector<Triangle> triangle;                   ///< indices into position; may be degenerate or duplicated
  std::vector<std::array<uint32_t, 2>> loose_edge;  ///< edges of no face; between panels they say what is to be sewn
  std::vector<uint32_t> polygon;                    ///< per triangle: number of the polygon of the file it was cut from
  std::vector<std::array<Point2, 3>> uv;      ///< per triangle corner, v down as in glTF; empty when the file has none
  std::vector<std::array<Point3, 3>> normal;  ///< per triangle corner, unit length, or empty
  std::vector<SourcePart> part;               ///< ranges of `triangle`, ascending, covering all of it
  std::vector<std::string> part_mesh;         ///< what the file calls the mesh of each part, an object; or empty
  std::vector<SourceMaterial> material;
  std::vector<SourceImage> image;
  /// Vertices of each named part, by the name of its mesh, too; those that each bone moves more than anything else, and
  /// those painted in one of eight colours ("color:red"), where there are several.
  std::vector<ClothAsset::VertexGroup> vertex_groups;
  std::vector<Rgba8> paint;           ///< per vertex, white where a file that paints others says nothing; or empty
  std::vector<std::string> left_out;  ///< what the file has and this mesh has not, in plain words
};

/// A surface that is manifold and consistently oriented everywhere, together with the ties that repair cut.
/// Every vertex has one fan of triangles. Vertices with equal `point` are copies of one surface point: they arise
/// where an edge had more than two faces, at bow-tie vertices, and along the tear of a non-orientable part. Their
/// positions are bit-identical. Every triangle has three different points and a positive area.
struct CleanSurface {
  std::vector<Point3> position;    ///< per vertex [m]
  std::vector<Triangle> triangle;  ///< indices into position
  std::vector<uint32_t> point;     ///< per vertex: its surface point, 0..point_count-1
  uint32_t point_count = 0;
  std::vector<uint32_t> component;  ///< per triangle: connected manifold component, 0..component_count-1
  uint32_t component_count = 0;
  std::vector<uint32_t> source_triangle;  ///< per triangle: triangle of the TriangleMesh, kNone if repair made it
  std::vector<std::array<Point2, 3>> uv;  ///< per triangle corner, as in TriangleMesh; empty when the file has none
  std::vector<uint32_t> source_point;     ///< per source vertex: the point it was welded into, kNone if no face uses it
};

/// One kind of repair and how often it was done.
struct Repair {
  std::string kind;  ///< "welded_vertices", "degenerate_faces", "duplicate_faces", "t_junctions", "zero_area_faces",
                     ///< "flipped_faces", "detached_sheets", "torn_edges", "bow_ties", "lost_parts"
  uint64_t count = 0;
};

}  // namespace geocloth
