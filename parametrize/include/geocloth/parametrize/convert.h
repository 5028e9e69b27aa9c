// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/quality.h"
#include "geocloth/parametrize/repair.h"

namespace geocloth {

struct ConvertOptions {
  ImportOptions import;
  std::string parts;  ///< which parts to convert, as of select_parts(); empty: all
  /// [pixels] >= 0.5: edges of the mesh that are longer are halved first, see refine_mesh(); 0: none are. The pixels'
  /// size is FlattenOptions::spacing, or follows from the mesh's area.
  double refine = 0;
  RepairOptions repair;
  /// Of unit length: which way of the mesh is up, for the grain of panels and the image; not set: by the garment's
  /// shape.
  std::optional<Point3> up;
  /// Loose pieces that are up to a twentieth of the garment or three pixels across and lie on it all over, as buttons
  /// and sequins do, ride on it; else those that are smaller than a pixel do, as far as they are 1 % of the area
  /// together.
  bool carry_loose = false;
  /// Of cloth that was given a thickness (a second side within, joined to the first one along hems) one side is
  /// represented, and the other one rides on it.
  bool one_layer = false;
  /// Layers that cut through each other are drawn apart: in the mesh, whose vertices move with them, and again in the
  /// image, whose triangles are coarser.
  bool untangle = false;
  FlattenOptions flatten;
  /// Where Layout::panels is refused it gets up to six times the pixels, and after that falls back to Layout::square,
  /// with a warning in the report.
  bool square_if_panels_fail = true;
  std::filesystem::path stages;  ///< folder for every intermediate as a file; empty: none
};

/// The files that ConvertOptions::stages names.
[[nodiscard]] std::vector<std::filesystem::path> stage_files(const std::filesystem::path& folder);

/// A piece that is too small for a pixel at the chosen spacing, or is to be carried as buttons are
/// (ConvertOptions::carry_loose), and rides on the cloth beside it; or a hole that is too small and is closed in the
/// image.
struct CarriedPart {
  uint32_t part = 0;      ///< of the file (SourceMesh::part)
  uint32_t faces = 0;     ///< triangles left out; 0 for a hole
  double area_share = 0;  ///< of the clean surface
  std::string why;
  bool is_side = false;   ///< the other side of thick cloth, see ConvertOptions::one_layer
  bool is_asked = false;  ///< large enough for pixels, and rides for ConvertOptions::carry_loose
};

/// What was done to draw layers apart.
struct Untangled {
  uint32_t before = 0, after = 0;  ///< pairs of triangles that cut through each other and share no point
  double farthest = 0;             ///< [m] that a point was moved
};

/// A part of the file (SourcePart) as the image has it.
struct PartShape {
  std::string name;
  uint32_t faces = 0;          ///< triangles in the file
  double area_share = 0;       ///< of the whole surface
  double stretched_share = 0;  ///< share of the part's area that is stretched or squeezed by more than 10 %
};

/// The geometry image in numbers.
struct ImageSummary {
  uint32_t valid_pixels = 0;
  uint32_t split_points = 0;     ///< rows of the split-vertex table
  uint32_t copies_max = 0;       ///< most pixels of one point
  double utilisation = 0;        ///< valid pixels / pixels
  double border_share = 0;       ///< share of the valid pixels that lack one of their eight neighbours in the chart
  double free_border_share = 0;  ///< and lies on the garment's own edges, which no layout can avoid
};
[[nodiscard]] ImageSummary summarize_image(const ClothAsset& asset);

struct ConvertReport {
  Topology source;
  double source_bbox_diagonal = 0;                 ///< [m]
  uint32_t source_vertices = 0, source_faces = 0;  ///< as counted in the file (faces: polygons)
  uint32_t sewing_edges = 0;      ///< of TriangleMesh::loose_edge, those that sew: ClothAsset::sewing has their pixels
  uint32_t refined_vertices = 0;  ///< added by ConvertOptions::refine, after those of the file
  /// [m] How far the asset was moved from where the file has it: nowhere, unless that is so far from the origin that
  /// single precision could not tell its points apart.
  Point3 moved{};
  /// Unit length: ConvertOptions::up, or what was taken for it from the garment's shape. It decides the grain of
  /// panels; the asset lies as the file does.
  Point3 up{0, 1, 0};
  std::vector<Repair> repairs;
  std::optional<Untangled> untangled_mesh, untangled_image;  ///< of ConvertOptions::untangle
  Topology cleaned;
  double cleaned_bbox_diagonal = 0;  ///< [m]
  std::vector<CarriedPart> carried;
  std::optional<MirrorPlane> mirror;  ///< of the surface, where left and right are to be cut alike
  std::vector<PartShape> parts;       ///< as in the file
  uint32_t uncut_corners = 0;         ///< where nothing but corners keeps the charts from lying flat
  double disk_share = 0;              ///< of the area that is drawn as disks (FlatChart::is_disk)
  bool panels_failed = false;         ///< so that the image is in squares, though panels were wanted
  Topology represented;
  Topology welded;
  Quality quality;
  std::vector<std::pair<std::string, double>> seconds;  ///< stage name, wall seconds, in order; "total" last
  std::vector<std::string> warnings;                    ///< plain words
  uint64_t peak_memory_bytes = 0;                       ///< of this process so far
};

struct ConvertResult {
  ClothAsset asset;
  FlatSurface flat;  ///< kept for pictures
  ConvertReport report;
};

/// import_mesh, repair_mesh, layers drawn apart if wanted, what is too small left out, cut_to_disks and flatten of the
/// garment set upright (ConvertReport::up), rasterize, build_image, a fit of the pixels to the surface, its layers
/// drawn apart, bind_source, measure_quality, in that order and nothing else; then the checks.
/// @throws Error(verification) when the welded grid mesh differs in topology from the represented surface, or when
///   copies do not coincide, triangles are flipped, charts overlap or springs cross an outline; whatever a stage
///   throws, with the name of the file in the message
[[nodiscard]] ConvertResult convert(const std::filesystem::path& path, const ConvertOptions& options = {},
                                    const Progress& progress = {});

/// The same from a mesh in memory.
[[nodiscard]] ConvertResult convert(const TriangleMesh& mesh, const ConvertOptions& options = {},
                                    const Progress& progress = {});

/// The report as JSON text with the keys that users rely on.
[[nodiscard]] std::string to_json(const ConvertResult& result);

}  // namespace geocloth
