// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a conversion as JSON. Its keys are a promise to users; they are named here and nowhere else.
#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/convert.h"
#include "repair/soup.h"
#include "report/border_pixels.h"

namespace geocloth {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Topology& t, double bbox_diagonal) {
  return {{"vertices", t.vertices},
          {"faces", t.faces},
          {"components", t.components},
          {"boundary_loops", t.boundary_loops},
          {"euler_characteristic", t.euler_characteristic},
          {"orientable", t.orientable},
          {"non_manifold_edges", t.non_manifold_edges},
          {"bow_tie_vertices", t.bow_tie_vertices},
          {"bbox_diagonal", bbox_diagonal}};
}

Json source_json(const ConvertReport& report) {
  Json json = to_json(report.source, report.source_bbox_diagonal);
  json["vertices"] = report.source_vertices;
  json["faces"] = report.source_faces;
  json["refined_vertices"] = report.refined_vertices;
  return json;
}

/// Per pixel whether it, or a copy of it, ends an edge of one triangle alone once the copies are merged.
std::vector<uint8_t> on_own_edges(const ClothAsset& asset) {
  const std::vector<uint32_t> first = first_copies(asset);
  const std::vector<Triangle> welded = proper_triangles(pixel_triangles(asset), first);
  std::vector<uint8_t> is_on(asset.pixel_count(), 0);
  for (const BorderSide& side : border_sides(welded)) {
    const Triangle& t = welded[side.triangle];
    is_on[t[side.corner]] = is_on[t[(side.corner + 1) % 3]] = 1;
  }
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) is_on[i] = is_on[first[i]];
  return is_on;
}

/// Fills in how many pixels lie on outlines. Not all that are no copies lie on the garment's own edges: beside seams
/// there are pixels that lack a neighbour and are none.
void count_border(const ClothAsset& asset, ImageSummary& image) {
  const std::vector<uint8_t> is_own = on_own_edges(asset);
  uint32_t border = 0, free = 0;
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i) || !on_border(asset, i)) continue;
    ++border;
    if (is_own[i] != 0) ++free;
  }
  const double valid = std::max(image.valid_pixels, 1U);
  image.border_share = border / valid;
  image.free_border_share = free / valid;
}

Json image_json(const ClothAsset& asset) {
  const ImageSummary image = summarize_image(asset);
  return {{"layout", to_string(asset.layout)},
          {"width", asset.width},
          {"height", asset.height},
          {"valid_pixels", image.valid_pixels},
          {"charts", asset.chart_count},
          {"spacing", asset.spacing},
          {"split_points", image.split_points},
          {"copies_max", image.copies_max},
          {"utilisation", image.utilisation},
          {"border_share", image.border_share},
          {"free_border_share", image.free_border_share}};
}

Json quality_json(const Quality& q) {
  return {{"flipped", q.flipped},
          {"mirrored", q.mirrored},
          {"overlapping_pixels", q.overlapping_pixels},
          {"crossing_springs", q.crossing_springs},
          {"copy_gap", q.copy_gap},
          {"l2_stretch", q.l2_stretch},
          {"symmetric_dirichlet", q.symmetric_dirichlet},
          {"anisotropy_p95", q.anisotropy_p95},
          {"spring_min", q.spring_min},
          {"spring_max", q.spring_max},
          {"spring_p99_over_p1", q.spring_p99_over_p1},
          {"shear_deg_p50", q.shear_deg_p50},
          {"shear_deg_p95", q.shear_deg_p95},
          {"quad_area_p5", q.quad_area_p5},
          {"quad_area_p95", q.quad_area_p95},
          {"rms_error", q.rms_error},
          {"max_error", q.max_error},
          {"psnr_db", q.psnr_db},
          {"seam_length", q.seam_length},
          {"binding_error", q.binding_error}};
}

Json to_json(const Untangled& untangled) {
  return {{"before", untangled.before}, {"after", untangled.after}, {"farthest", untangled.farthest}};
}

}  // namespace

ImageSummary summarize_image(const ClothAsset& asset) {
  ImageSummary image;
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    image.copies_max = std::max(image.copies_max, static_cast<uint32_t>(asset.splits.copies(row).size()));
  }
  image.valid_pixels = count_valid_pixels(asset);
  image.split_points = asset.splits.rows();
  image.utilisation = image.valid_pixels / static_cast<double>(std::max(asset.pixel_count(), 1U));
  count_border(asset, image);
  return image;
}

std::string to_json(const ConvertResult& result) {
  const ConvertReport& report = result.report;
  Json json;
  json["source"] = source_json(report);
  json["moved"] = report.moved;
  json["up"] = report.up;
  json["repairs"] = Json::array();
  for (const Repair& r : report.repairs) json["repairs"].push_back({{"kind", r.kind}, {"count", r.count}});
  if (report.untangled_mesh && report.untangled_image)
    json["untangled"] = {{"mesh", to_json(*report.untangled_mesh)}, {"image", to_json(*report.untangled_image)}};
  json["cleaned"] = to_json(report.cleaned, report.cleaned_bbox_diagonal);
  json["carried"] = Json::array();
  for (const CarriedPart& c : report.carried) {
    json["carried"].push_back({{"part", c.part}, {"faces", c.faces}, {"area_share", c.area_share}, {"why", c.why}});
  }
  json["parts"] = Json::array();
  for (const PartShape& p : report.parts) {
    json["parts"].push_back(
        {{"name", p.name}, {"faces", p.faces}, {"area_share", p.area_share}, {"stretched_share", p.stretched_share}});
  }
  json["mirror"] = nullptr;
  if (report.mirror) {
    const MirrorPlane& m = *report.mirror;
    json["mirror"] = {{"normal", m.normal}, {"offset", m.offset}, {"share", m.share}};
  }
  json["represented"] = to_json(report.represented, report.cleaned_bbox_diagonal);
  json["image"] = image_json(result.asset);
  if (report.sewing_edges > 0) {
    json["sewing"] = {{"edges", report.sewing_edges}, {"pairs", result.asset.sewing.size()}};
  }
  json["welded"] = {{"components", report.welded.components},
                    {"boundary_loops", report.welded.boundary_loops},
                    {"euler_characteristic", report.welded.euler_characteristic},
                    {"orientable", report.welded.orientable}};
  json["quality"] = quality_json(report.quality);
  for (const auto& [stage, seconds] : report.seconds) json["seconds"][stage] = seconds;
  json["peak_memory_bytes"] = report.peak_memory_bytes;
  json["warnings"] = report.warnings;
  // A name in the file may be no valid UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace geocloth
