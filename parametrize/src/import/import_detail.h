// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of the importer share: the bytes of a file, and the checks that run before assimp sees them.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/mesh.h"
#include "import/file_points.h"

namespace geocloth::import_detail {

inline constexpr std::size_t kMaxElements = 100'000'000;  ///< vertices, corners or records that a file may hold
inline constexpr std::size_t kMaxTriangles = 20'000'000;  ///< of a mesh, instances counted
inline constexpr std::size_t kMaxPolygonCorners = 4096;
inline constexpr double kMaxCoordinate = 1e18;  ///< beyond it, products of coordinates leave the range of a float

/// Throws Error(code) with the message "<file>: <what>".
[[noreturn]] void fail(const std::filesystem::path& file, ErrorCode code, const std::string& what);
[[noreturn]] inline void bad(const std::filesystem::path& file, const std::string& what) {
  fail(file, ErrorCode::invalid_data, what);
}

/// The line that begins at `at`, without its end, which is \n, \r or both; moves behind it.
[[nodiscard]] std::string_view next_line(std::string_view text, std::size_t& at);
/// What blanks are between.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);
/// Nothing where a word is another thing, or too large.
[[nodiscard]] std::optional<std::size_t> whole_number(std::string_view word);

/// Reads a little-endian integer.
template <typename T>
T read_le(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Points that a pose moves less than this part of the mesh's size are at rest: matrices are kept as floats.
inline constexpr double kPoseAtRest = 1e-4;

/// An OBJ file in a form that is safe for assimp: only records that were understood, with absolute indices in range.
/// Each vertex is written with its number (low 16 bits, high bits) in place of its position, so that the number comes
/// back from assimp, which makes a vertex of its own for every face corner.
struct ObjText {
  std::vector<Point3> position;             ///< of the `v` records, in the file's order
  std::vector<std::array<float, 3>> color;  ///< of each, 0..1, white where the file says none; or empty: none at all
  std::string coded;                        ///< its groups are called by the numbers of the parts
  std::vector<std::string> part_name;       ///< after the object or group, without either after the material
  std::vector<std::array<uint32_t, 2>> loose_edge;  ///< of `l` records, and of faces that are only lines
};
[[nodiscard]] ObjText read_obj(const std::filesystem::path& file, std::string_view text);
/// The vertex number that read_obj wrote as a position.
[[nodiscard]] uint32_t decode_obj_vertex(float x, float y);
/// The known records of an MTL file.
[[nodiscard]] std::string clean_mtl(std::string_view text);

/// A file in memory that assimp may ask for.
struct MemoryFile {
  std::string name, bytes;
};

enum class Format { obj, gltf, glb, ply, stl, off, fbx, dae };
/// What a file is by its ending.
/// @throws Error(unsupported) for an ending that is not known
[[nodiscard]] Format format_of(const std::filesystem::path& file);
/// Whether a file is glTF by its ending.
/// @throws Error(unsupported) for an ending that is not known
[[nodiscard]] bool is_gltf(const std::filesystem::path& file);

struct GltfBytes {
  std::vector<std::byte> bytes;
  bool binary = false;  ///< a GLB container, whatever the ending says
};
/// The bytes of a file that is glTF by its ending.
/// @throws Error(io) when it cannot be read, Error(invalid_data) when it is empty, Error(unsupported) for UTF-16
[[nodiscard]] GltfBytes read_gltf_bytes(const std::filesystem::path& file);

/// Checks the container, the JSON and every index, offset and size of a glTF file that assimp relies on.
/// @returns the same scene for assimp, without what geocloth does not use: the JSON, and its buffers as files of their
///   own; quantised attributes are floats there
/// @param left_out  filled with what of the scene is not in them, in plain words
/// @throws Error(unsupported) when it needs an extension that cannot be decoded
[[nodiscard]] std::vector<MemoryFile> read_gltf(const std::filesystem::path& file, std::span<const std::byte> bytes,
                                                bool binary, std::vector<std::string>& left_out);

/// Checks that the sizes a PLY file announces are the sizes it has.
/// @returns it as assimp reads it: what assimp does not know stands before no vertices or faces, and strips are faces
[[nodiscard]] std::string checked_ply(const std::filesystem::path& file, std::string text);
/// The same for STL. @returns it as assimp reads it: without padding at the end, words in small letters
[[nodiscard]] std::string checked_stl(const std::filesystem::path& file, std::string text);
/// An OFF file as the OBJ text that says the same, on the same lines.
/// @throws Error(unsupported) for its binary form, and for points of other than three coordinates
[[nodiscard]] std::string off_as_obj(const std::filesystem::path& file, std::string_view text);
/// Walks the records of a binary FBX file, or looks for the opening of a textual one, and at its connections.
/// @param animated  whether animations are wanted; else those of the file do not matter
/// @param points  filled with those of its meshes
/// @returns it as assimp reads it
[[nodiscard]] std::string checked_fbx(const std::filesystem::path& file, std::string bytes, bool animated,
                                      std::vector<FilePoints>& points);

struct DaeText {
  std::string text;            ///< for assimp: without lights and cameras, and animations but where they are asked for
  double metres_per_unit = 1;  ///< as the file says; assimp applies it
  std::vector<FilePoints> points;
};
/// Checks the XML of a DAE file and every count, offset and index of it that assimp relies on.
/// @param animated  whether animations are of interest
[[nodiscard]] DaeText read_dae(const std::filesystem::path& file, std::string_view bytes, bool animated);

/// Refuses a graph of "parent has child" that has a circle, is deeper than 512 levels, or unfolds to more than a
/// million nodes: importers follow it by recursion.
/// @param edges  pairs of parent and child
void check_hierarchy(const std::filesystem::path& file, std::vector<std::array<uint64_t, 2>> edges);

/// Cuts a polygon into triangles by clipping ears, shortest diagonal first; independent of the corner it starts with.
/// @param corner  positions of at least three corners in order; the polygon may be concave and somewhat out of plane
/// @param out     triangles as corner numbers are appended; always corner.size() - 2 of them
void triangulate_polygon(std::span<const Point3> corner, std::vector<Triangle>& out);

}  // namespace geocloth::import_detail
