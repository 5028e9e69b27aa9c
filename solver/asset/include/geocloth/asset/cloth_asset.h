// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geocloth/asset/topology.h"
#include "geocloth/asset/vec.h"

namespace geocloth {

/// How the surface was laid out in the image.
enum class Layout : uint8_t {
  square,  ///< One square per connected part (Gu, Gortler, Hoppe 2002).
  panels,  ///< Charts with free outlines, nearly isometric.
  uv,      ///< Charts taken from the garment's own texture coordinates.
};
[[nodiscard]] const char* to_string(Layout layout);

/// The six forward neighbours of a pixel that a spring can reach; the value is its bit in ClothAsset::spring_mask.
///
///            (x,y) --- right --- right2
///           /  |  \.
///   down_left down down_right
///              |
///            down2
enum SpringBit : uint8_t {
  kSpringRight = 1U << 0,      ///< structural, (+1, 0), weft
  kSpringDown = 1U << 1,       ///< structural, (0, +1), warp
  kSpringDownRight = 1U << 2,  ///< shear, (+1, +1)
  kSpringDownLeft = 1U << 3,   ///< shear, (-1, +1)
  kSpringRight2 = 1U << 4,     ///< bending, (+2, 0), weft
  kSpringDown2 = 1U << 5,      ///< bending, (0, +2), warp
};
inline constexpr uint32_t kSpringCount = 6;
/// Pixel offsets in the order of the bits.
inline constexpr std::array<std::array<int32_t, 2>, kSpringCount> kSpringOffset{
    {{1, 0}, {0, 1}, {1, 1}, {-1, 1}, {2, 0}, {0, 2}}};

/// Triangles of the grid cell whose corners are (x,y), (x+1,y), (x,y+1), (x+1,y+1); bits of ClothAsset::cell.
/// With diagonal "down-right" (bit clear): first = (x,y),(x,y+1),(x+1,y+1), second = (x,y),(x+1,y+1),(x+1,y).
/// With diagonal "down-left" (bit set):   first = (x,y),(x,y+1),(x+1,y),   second = (x+1,y),(x,y+1),(x+1,y+1).
/// Row y grows downwards in the image; with +v up this order is counter-clockwise for a chart that is not mirrored.
enum CellBit : uint8_t {
  kCellFirst = 1U << 0,         ///< the first triangle exists
  kCellSecond = 1U << 1,        ///< the second triangle exists
  kCellDiagonalLeft = 1U << 2,  ///< the diagonal runs from (x+1,y) to (x,y+1)
};

inline constexpr uint16_t kNoChart = 0xFFFF;       ///< ClothAsset::chart of a pixel that is not valid
inline constexpr uint32_t kNoPixel = 0xFFFFFFFFU;  ///< "no such pixel"
inline constexpr uint32_t kMaxImageSide = 16384;   ///< [pixels]

/// Compressed rows: row r is pixel[offset[r] .. offset[r+1]). A row holds all pixels that sample one surface point:
/// at least two, ascending. Rows are disjoint and ordered by their first pixel.
struct SplitVertexTable {
  std::vector<uint32_t> offset;  ///< rows + 1 entries (or empty when there is no row); first 0, strictly ascending
  std::vector<uint32_t> pixel;   ///< pixel indices y * width + x
  [[nodiscard]] uint32_t rows() const { return offset.empty() ? 0 : static_cast<uint32_t>(offset.size() - 1); }
  /// The pixels of row r.
  [[nodiscard]] std::span<const uint32_t> copies(uint32_t r) const {
    return std::span(pixel).subspan(offset[r], offset[r + 1] - offset[r]);
  }
};

/// One bending element across a seam: ring-1 pixel on one side, a pixel of the seam point, ring-1 pixel on the other.
struct SeamBend {
  uint32_t a, middle, b;  ///< pixel indices; middle is any copy of the seam point
  float rest_length;      ///< [m] rest distance from a to b
};

/// Where a source vertex lies on the grid: three pixels, barycentric weights, and an offset in the local frame
/// T = normalize(e - N (e.N)), e = p[1] - p[0]; N = normalize(sum of weight * pixel normal); B = N x T.
///   position = w0 p0 + w1 p1 + w2 p2 + offset.x T + offset.y B + offset.z N
struct Binding {
  std::array<uint32_t, 3> pixel{};
  std::array<float, 3> weight{};
  Vec3 offset;  ///< [m]
};

/// An image file as the source had it (PNG or JPEG bytes), never decoded.
struct SourceImage {
  std::string name;
  std::string mime_type;  ///< "image/png" or "image/jpeg"
  std::vector<uint8_t> bytes;
};

/// Red, green, blue and alpha, 0..255 for 0..1, as numbers of the file: no gamma is applied.
using Rgba8 = std::array<uint8_t, 4>;

/// glTF metallic-roughness, as far as importers give it.
struct SourceMaterial {
  std::string name;
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< linear RGBA
  float metallic = 0;
  float roughness = 1;
  std::optional<uint32_t> base_color_image;  ///< index into SourceMesh::images
  std::optional<uint32_t> normal_image;
  std::optional<uint32_t> metallic_roughness_image;
  bool alpha_mask = false;
  bool alpha_blend = false;
  float alpha_cutoff = 0.5F;
};

/// A run of triangles of the source mesh that share a name and a material (a glTF primitive).
struct SourcePart {
  std::string name;
  uint32_t material = 0;        ///< index into SourceMesh::materials
  uint32_t first_triangle = 0;  ///< into SourceMesh::triangle
  uint32_t triangle_count = 0;
};

/// The mesh as the user made it, in metres, ready to be drawn. A vertex here is a render vertex (split at every
/// texture-coordinate and normal seam); `source_vertex` says which vertex of the file it was, or which in `middle`.
struct SourceMesh {
  std::vector<Vec3> position;           ///< [m]
  std::vector<Vec3> normal;             ///< unit length; as many as positions
  std::vector<Vec2> uv;                 ///< as many as positions, or empty; (0,0) is the picture's upper left corner
  std::vector<uint32_t> source_vertex;  ///< each below source_vertex_count; as many as positions
  std::vector<Triangle> triangle;
  std::vector<SourcePart> part;  ///< ranges of `triangle`, ascending, covering all of it
  std::vector<SourceMaterial> material;
  std::vector<SourceImage> image;
  uint32_t source_vertex_count = 0;  ///< vertices in the file, and those in `middle`
  /// Of the vertices at the end that the file has not: each lies in the middle of two that stand before it.
  std::vector<std::array<uint32_t, 2>> middle;

  /// Vertices that the file has: without those that were added when its triangles were divided.
  [[nodiscard]] uint32_t file_vertex_count() const {
    return source_vertex_count - static_cast<uint32_t>(middle.size());
  }
};

/// Adds the places of the vertices that are in the middle of others.
/// @param points  of the vertices of the file; gets source_vertex_count of them
void add_middles(const SourceMesh& source, std::vector<Vec3>& points);

/// Everything that the solver, the renderer and the tools need to know of one garment. A plain value.
/// All per-pixel arrays have width * height entries, row by row, pixel (0,0) at the top left.
struct ClothAsset {
  std::string name;
  Layout layout = Layout::square;
  uint32_t width = 0, height = 0;  ///< [pixels], 1..kMaxImageSide
  float spacing = 0;               ///< [m] nominal spring length

  std::vector<Vec3> rest_position;   ///< [m]; copies of one point are bit-identical; zero where not valid
  std::vector<uint16_t> chart;       ///< chart number, kNoChart where the pixel is not valid
  std::vector<uint8_t> spring_mask;  ///< SpringBit; a set bit means both ends are valid and no outline is crossed
  std::vector<uint8_t> cell;         ///< CellBit; cells of the last row and column are empty
  std::vector<float> area;           ///< [m^2] the pixel's own share of the surface; > 0 where valid, else 0
  SplitVertexTable splits;
  std::vector<SeamBend> seam_bends;
  /// Pairs of pixels that lie apart at rest and are to be sewn together, as edges between panels of a sewing pattern
  /// say. What is sewn already is in `splits`.
  std::vector<std::array<uint32_t, 2>> sewing;
  uint32_t chart_count = 0;

  SourceMesh source;
  std::vector<Binding> binding;  ///< one per vertex of `source`

  /// Named sets of source vertices (vertex ids of the file), for pins.
  struct VertexGroup {
    std::string name;
    std::vector<uint32_t> source_vertex;
  };
  std::vector<VertexGroup> vertex_groups;
  /// What the vertices of the file are painted in, one for each, or empty where none is: maps for settings that differ
  /// from place to place, such as the distance from its skin that the cloth may go.
  std::vector<Rgba8> paint;

  [[nodiscard]] uint32_t pixel_count() const { return width * height; }
  [[nodiscard]] bool valid(uint32_t pixel) const { return chart[pixel] != kNoChart; }
};

/// Checks every size, index range, number and invariant named above; afterwards no reader can go out of bounds.
/// @throws Error(invalid_data) naming the first element that is wrong
void validate(const ClothAsset& asset);

/// Number of valid pixels.
[[nodiscard]] uint32_t count_valid_pixels(const ClothAsset& asset);

/// Area-weighted normals of the grid, summed over the copies of a split vertex, so that copies agree bit for bit.
/// @param position  one per pixel
/// @param normal    resized to one per pixel; unit length, zero where the pixel is not valid
/// @throws Error(invalid_argument) for another number of positions
void compute_normals(const ClothAsset& asset, const std::vector<Vec3>& position, std::vector<Vec3>& normal);

/// Evaluates the binding: where every vertex of the source mesh is when the grid stands at `position`.
/// @param position, normal  one per pixel
/// @param out               resized to one per source (render) vertex
/// @param scale             of the garment in its scene: offsets grow with it
/// @throws Error(invalid_argument) for another number of positions or normals
void evaluate_binding(const ClothAsset& asset, const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                      std::vector<Vec3>& out, float scale = 1);

/// The offset with which the pixels and weights of a binding put its vertex at a point, the grid being at `position`.
[[nodiscard]] Vec3 binding_offset(const Binding& binding, const std::vector<Vec3>& position,
                                  const std::vector<Vec3>& normal, const Vec3& point, float scale = 1);

/// Normals of the source mesh as coordinates in the frames (T, B, N) of the binding at rest, one per render vertex.
[[nodiscard]] std::vector<Vec3> bind_normals(const ClothAsset& asset);

/// Turns the normals of the source mesh with the grid: hard edges of the garment stay hard.
/// @param bound             what bind_normals gave
/// @param position, normal  one per pixel
/// @param out               resized to one per render vertex; unit length
/// @throws Error(invalid_argument) for another number of any of them
void evaluate_bound_normals(const ClothAsset& asset, const std::vector<Vec3>& bound, const std::vector<Vec3>& position,
                            const std::vector<Vec3>& normal, std::vector<Vec3>& out);

/// [pixels] How far across the triangles are that are drawn, as a mean by area of the root of twice the area; 0 for
/// none. Folds finer than that do not show.
[[nodiscard]] double drawn_triangle_size(const ClothAsset& asset);

}  // namespace geocloth
