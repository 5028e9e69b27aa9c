// SPDX-License-Identifier: GPL-3.0-or-later
// The measures of a conversion in plain words, for people who make garments. A map of a surface is free of stretch only
// where the surface is developable (Gauss 1827, Theorema Egregium), so what stays stretched after the cuts says where
// the garment is not; it is told per part of the file.
#include "report/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "develop/map_stretch.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "report/border_pixels.h"

namespace geocloth {
namespace {

constexpr double kStretched = 1.1;  ///< a tenth longer or shorter in some direction

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, share < 0.0995 ? "%.1f %%" : "%.0f %%", 100 * share);
  return text;
}

/// Millimetres, centimetres or metres, whichever reads best.
std::string size_in_words(double metres) {
  if (metres < 0.01) return rounded(1000 * metres) + " mm";
  return metres < 1 ? rounded(100 * metres) + " cm" : rounded(metres) + " m";
}

/// "part 'Hood'"; the number stands in for a name that is missing.
std::string name_of(const std::vector<PartShape>& parts, std::size_t index) {
  return parts[index].name.empty() ? "part " + std::to_string(index) : "part '" + parts[index].name + "'";
}

/// The parts that are stretched most, as share of the whole garment: at most three, in words.
std::string where_stretched(const std::vector<PartShape>& parts) {
  std::vector<std::size_t> order;
  constexpr double kMattersFrom = 0.005;  // of the whole area
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].stretched_share * parts[i].area_share > kMattersFrom) order.push_back(i);
  }
  if (parts.size() < 2 || order.empty()) return {};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return parts[a].stretched_share * parts[a].area_share > parts[b].stretched_share * parts[b].area_share;
  });
  constexpr std::size_t kNamed = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(order.size(), kNamed); ++i) {
    text += (i == 0 ? ", mostly in " : ", ") + name_of(parts, order[i]) + " (" +
            percent(parts[order[i]].stretched_share) + " of it)";
  }
  return text;
}

/// Is most of what is stretched so because it is drawn as a disk?
bool is_mostly_disks(const ConvertReport& report) {
  double stretched = 0;
  for (const PartShape& part : report.parts) stretched += part.stretched_share * part.area_share;
  return report.disk_share > 0 && report.disk_share >= stretched / 2;
}

/// Away from its corners a bag or a folded tie is developable. What texture coordinates stretch says nothing of that:
/// they may be stretched on flat cloth.
std::string why_stretched(const ConvertReport& report, Layout layout) {
  if (layout == Layout::square) {
    return report.panels_failed ? ": a square cannot keep shapes"
                                : ": a square cannot keep shapes (--layout panels does)";
  }
  if (layout == Layout::uv) {
    return ": the texture coordinates are stretched there, and the springs are that uneven; --layout panels lays the "
           "garment out afresh";
  }
  if (is_mostly_disks(report)) {
    return ": its strips have no room for pixels beside each other, so that it is drawn as a disk; give a larger "
           "--resolution";
  }
  if (report.uncut_corners == 0) {
    return ": the garment is not developable there (woven cloth would need a dart), and its springs are that uneven";
  }
  return ": the layout has cuts to too few of the garment's corners (" + std::to_string(report.uncut_corners) +
         (report.uncut_corners == 1 ? " is" : " are") + " left without), and springs around them are that uneven";
}

bool is_stretched(const ConvertReport& report, const ClothAsset& asset) {
  // What a square does to shapes is known; it is worth a word where it is extreme.
  constexpr double kLargestAnisotropy = 1.15, kLargestDirichlet = 4.03, kLargestInSquare = 5;
  const Quality& q = report.quality;
  if (asset.layout == Layout::square) return q.anisotropy_p95 > kLargestInSquare;
  return q.anisotropy_p95 > kLargestAnisotropy || q.symmetric_dirichlet > kLargestDirichlet;
}

void warn_of_stretch(const ConvertReport& report, const ClothAsset& asset, std::vector<std::string>& out) {
  if (!is_stretched(report, asset)) return;
  double stretched = 0;
  for (const PartShape& part : report.parts) stretched += part.stretched_share * part.area_share;
  out.push_back(percent(stretched) + " of the area is stretched or squeezed by more than 10 % in the image" +
                where_stretched(report.parts) + why_stretched(report, asset.layout));
}

/// What most of the uneven cells lie in.
enum class Uneven { crumbs, outlines, folds };

/// Cells at outlines are uneven where strips, holes or teeth are not much wider than a pixel, those inside where pixels
/// are too few for the folds between them.
Uneven find_uneven(const ClothAsset& asset) {
  constexpr double kLong = 1.3, kSine = 0.2;  // of the angle off a right one
  constexpr uint32_t kCrumb = 16;             // [pixels] of a chart
  std::vector<uint32_t> pixels(asset.chart_count, 0);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) ++pixels[asset.chart[i]];
  }
  const double h = asset.spacing;
  uint32_t crumbs = 0, outlines = 0, folds = 0;
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if ((asset.spring_mask[i] & kSpringRight) == 0 || (asset.spring_mask[i] & kSpringDown) == 0) continue;
    const Vec3 weft = asset.rest_position[i + 1] - asset.rest_position[i];
    const Vec3 warp = asset.rest_position[i + asset.width] - asset.rest_position[i];
    const double x = length(weft), y = length(warp);
    const bool even =
        std::max(x, y) <= kLong * h && std::min(x, y) * kLong >= h && std::abs(dot(weft, warp)) <= kSine * x * y;
    if (even) continue;
    if (pixels[asset.chart[i]] <= kCrumb) {
      ++crumbs;
    } else if (on_border(asset, i) || on_border(asset, i + 1) || on_border(asset, i + asset.width)) {
      ++outlines;
    } else {
      ++folds;
    }
  }
  if (crumbs > std::max(outlines, folds)) return Uneven::crumbs;
  return folds > outlines ? Uneven::folds : Uneven::outlines;
}

void warn_of_uneven_springs(const ConvertReport& report, const ClothAsset& asset, std::vector<std::string>& out) {
  // From here on the motion of the cloth shows it (tools/report/targets.cpp calls these missed).
  constexpr double kLargestRatio = 2, kLargestAngle = 12;
  constexpr double kKeptFolds = 80;  // [dB] so near is no image that cuts folds short
  const Quality& q = report.quality;
  if (q.spring_p99_over_p1 <= kLargestRatio && q.shear_deg_p95 <= kLargestAngle) return;
  const char* of_what = "strips, holes or layers that are not much wider than";
  const char* remedy = "give a larger --resolution, or leave such parts out with --parts";
  Uneven uneven = find_uneven(asset);
  if (uneven == Uneven::folds && is_mostly_disks(report)) uneven = Uneven::outlines;
  // Stretched texture coordinates, which were told of, stay so at any resolution.
  if (uneven != Uneven::crumbs && asset.layout == Layout::uv && is_stretched(report, asset)) return;
  switch (uneven) {
    case Uneven::outlines:
      break;
    case Uneven::crumbs:
      of_what = "pieces that are hardly larger than";
      remedy = "leave them out with --parts, or merge them with the cloth in a modelling program";
      break;
    case Uneven::folds:
      if (is_stretched(report, asset) && q.psnr_db > kKeptFolds) return;  // which was said
      of_what = "folds or bends that are not much wider than";
      remedy = "give a larger --resolution";
      break;
  }
  out.push_back("springs are uneven (the longest are " + rounded(q.spring_p99_over_p1) +
                " times the shortest, and a twentieth of the places is " + rounded(q.shear_deg_p95) +
                " degrees or more off a right angle): the garment has " + of_what + " a spring (" +
                size_in_words(double{asset.spacing}) + "); " + remedy);
}

/// Loose pieces are carried even where they are more than what may go unnoticed.
void warn_of_carried(const ConvertReport& report, std::vector<std::string>& out) {
  constexpr double kUnnoticed = 0.01;  // share of the area
  double share = 0;
  uint32_t pieces = 0;
  for (const CarriedPart& part : report.carried) {
    if (part.faces == 0 || part.is_side) continue;  // a hole
    share += part.area_share;
    ++pieces;
  }
  if (share <= kUnnoticed) return;
  out.push_back(std::to_string(pieces) + " small pieces, " + percent(share) +
                " of the area, have no pixels: they ride on the cloth beside them, and their weight is not counted");
}

/// A piece of many triangles that is too small for pixels is no button: its file may have parts of several scales.
void warn_of_fine_pieces(const ConvertReport& report, const ClothAsset& asset, std::vector<std::string>& out) {
  constexpr double kMany = 0.05;  // of the triangles
  double faces = 0;
  for (const PartShape& part : report.parts) faces += part.faces;
  for (const CarriedPart& piece : report.carried) {
    if (piece.is_side || piece.is_asked || piece.faces < kMany * faces || piece.part >= report.parts.size()) continue;
    out.push_back(std::to_string(piece.faces) + " triangles of part \"" + report.parts[piece.part].name +
                  "\" have no pixels: beside the rest they are smaller than a spring (" +
                  size_in_words(double{asset.spacing}) +
                  ") and ride on it; where that is cloth, convert it by itself with --parts, and look for parts of " +
                  "another scale");
  }
}

/// Whether the largest chart is a strip, and much longer than the box around it.
bool winds(const ClothAsset& asset) {
  struct ChartBox {
    uint32_t pixels = 0, border = 0, left = UINT32_MAX, right = 0, top = UINT32_MAX, bottom = 0;
  };
  std::vector<ChartBox> charts(asset.chart_count);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) continue;
    const uint32_t x = i % asset.width, y = i / asset.width;
    ChartBox& c = charts[asset.chart[i]];
    ++c.pixels;
    c.border += on_border(asset, i) ? 1U : 0U;
    c.left = std::min(c.left, x);
    c.right = std::max(c.right, x);
    c.top = std::min(c.top, y);
    c.bottom = std::max(c.bottom, y);
  }
  const auto largest =
      std::max_element(charts.begin(), charts.end(), [](const auto& a, const auto& b) { return a.pixels < b.pixels; });
  if (largest == charts.end() || largest->pixels == 0) return false;
  constexpr double kMuchLonger = 2.5;
  return largest->border / 2.0 >
         kMuchLonger * std::hypot(largest->right - largest->left + 1.0, largest->bottom - largest->top + 1.0);
}

std::string why_empty(const ConvertReport& report, const ClothAsset& asset) {
  constexpr uint32_t kNet = 50;  // holes
  if (report.represented.boundary_loops > report.represented.components + kNet) {
    return "it is a net that is cut open along its threads; a whole sheet takes less, with a texture that is clear "
           "where the holes are";
  }
  if (winds(asset)) {
    return "a long piece winds through it; where its texture coordinates lay it out in shorter pieces, --layout uv "
           "takes those";
  }
  return "the pieces do not fill the boxes around them; where texture coordinates lay them out in smaller ones, "
         "--layout uv takes those";
}

/// Pixels take memory whether there is cloth in them or not.
void warn_of_empty_image(const ConvertReport& report, const ClothAsset& asset, std::vector<std::string>& out) {
  constexpr double kMostlyEmpty = 0.35;
  const double filled = static_cast<double>(count_valid_pixels(asset)) / std::max(asset.pixel_count(), 1U);
  if (filled >= kMostlyEmpty) return;
  out.push_back("only " + percent(filled) +
                " of the image is cloth, the rest takes memory for nothing: " + why_empty(report, asset));
}

}  // namespace

std::vector<PartShape> measure_parts(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat) {
  std::vector<PartShape> parts;
  parts.reserve(mesh.part.size());
  for (const SourcePart& part : mesh.part) parts.push_back({.name = part.name, .faces = part.triangle_count});
  const double unit = map_unit(flat);
  double whole = 0;
  std::vector<double> stretched(parts.size(), 0), area(parts.size(), 0);
  for (std::size_t i = 0; i < flat.triangle.size(); ++i) {
    const Triangle& t = flat.triangle[i];
    const double size = triangle_area(flat.position[t[0]], flat.position[t[1]], flat.position[t[2]]);
    whole += size;
    const uint32_t source = clean.source_triangle[flat.clean_triangle[i]];
    if (source == kNone) continue;
    const auto after = std::upper_bound(mesh.part.begin(), mesh.part.end(), source,
                                        [](uint32_t s, const SourcePart& part) { return s < part.first_triangle; });
    if (after == mesh.part.begin()) continue;
    const auto part = static_cast<std::size_t>(after - mesh.part.begin()) - 1;
    area[part] += size;
    const auto [large, small] = singular_values(flat, t, unit);
    if (large > kStretched || small * kStretched < 1) stretched[part] += size;
  }
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (!(area[p] > 0)) continue;
    parts[p].area_share = area[p] / whole;
    parts[p].stretched_share = stretched[p] / area[p];
  }
  return parts;
}

uint32_t count_uncut_corners(const FlatSurface& flat) {
  constexpr double kCorner = 0.5, kMost = 0.5;  // [radians] of the curvature at a point; share of all
  std::vector<double> curvature(flat.position.size(), 2 * std::numbers::pi);
  const std::vector<uint32_t> opposite = opposite_half_edges(flat.triangle);
  std::vector<uint8_t> inside(flat.position.size(), 1);
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    const uint32_t v = tail(flat.triangle, h), next = head(flat.triangle, h);
    if (opposite[h] == kNone) inside[v] = inside[next] = 0;
    const Point3 a = flat.position[next] - flat.position[v];
    const Point3 b = flat.position[tail(flat.triangle, previous_half_edge(h))] - flat.position[v];
    curvature[v] -= std::atan2(length(cross(a, b)), dot(a, b));
  }
  uint32_t corners = 0;
  double in_corners = 0, all = 0;
  for (size_t v = 0; v < curvature.size(); ++v) {
    if (inside[v] == 0) continue;
    const double c = std::abs(curvature[v]);
    all += c;
    if (c < kCorner) continue;
    in_corners += c;
    ++corners;
  }
  return in_corners > kMost * all ? corners : 0;
}

double disk_share(const FlatSurface& flat) {
  double disks = 0, whole = 0;
  for (size_t t = 0; t < flat.triangle.size(); ++t) {
    const Triangle& k = flat.triangle[t];
    const double area = triangle_area(flat.position[k[0]], flat.position[k[1]], flat.position[k[2]]);
    whole += area;
    if (flat.charts[flat.chart[t]].is_disk) disks += area;
  }
  return whole > 0 ? disks / whole : 0;
}

std::vector<std::string> plain_warnings(const ConvertReport& report, const ClothAsset& asset, double wanted_pixels) {
  std::vector<std::string> out;
  const double size = report.cleaned_bbox_diagonal;
  const Quality& q = report.quality;
  constexpr double kLargest = 10, kSmallest = 0.05;  // [m] of a garment, with room to spare
  if (size > kLargest || size < kSmallest) {
    out.push_back("the garment is " + size_in_words(size) +
                  " across; if that is not its true size, give the unit of the file with --unit (mm, cm, dm, in " +
                  "or ft), or a factor with --scale");
  }
  constexpr double kManyMore = 1.5;
  const uint64_t pixels = count_valid_pixels(asset);
  if (wanted_pixels > 0 && static_cast<double>(pixels) > kManyMore * wanted_pixels) {
    out.push_back("the cloth takes " + std::to_string(pixels) + " pixels where about " +
                  std::to_string(std::llround(wanted_pixels)) +
                  " were asked for: it has too many small pieces or narrow strips for so few; --parts leaves pieces "
                  "out, and pieces that should hold together have to be merged in a "
                  "modelling program");
  }
  warn_of_stretch(report, asset, out);
  const bool square = asset.layout == Layout::square;
  if (!square) warn_of_uneven_springs(report, asset, out);
  // A square has few pixels wherever it squeezes: what is said of shapes above is true of places too.
  constexpr double kCoarseDecibel = 50, kFarOff = 0.01;
  if (q.psnr_db < kCoarseDecibel || (!square && q.max_error > kFarOff)) {
    out.push_back("the image is coarse for this mesh (it is up to " + size_in_words(q.max_error * size) +
                  " off); give a larger --resolution");
  }
  constexpr uint32_t kFew = 20;  // pairs, as in sharp folds
  if (report.untangled_image && report.untangled_image->after > kFew) {
    out.push_back(
        std::to_string(report.untangled_image->after) + " pairs of the image's triangles still cut through " +
        "each other: its layers lie nearer than its pixels can tell; give a larger --resolution, or leave out " +
        "the inner ones with --parts");
  }
  warn_of_carried(report, out);
  warn_of_fine_pieces(report, asset, out);
  constexpr double kLargestBindingError = 1e-6;
  if (q.binding_error > kLargestBindingError) {
    out.push_back("single precision moves vertices by up to " + rounded(q.binding_error) +
                  " of the size; move the mesh closer to the origin");
  }
  if (!report.represented.orientable) {
    out.push_back(
        "a part has only one side (it is not orientable), so that its front and back change places at one of its "
        "seams: "
        "right for a twisted band; otherwise faces were joined the wrong way round, and have to be parted in a "
        "modelling "
        "program");
  }
  if (report.sewing_edges > 0 && asset.sewing.empty()) {
    out.push_back("nothing is sewn by the " + std::to_string(report.sewing_edges) +
                  " edges between borders: they end where the image has no cloth of its own, or at one pixel; give a "
                  "larger --resolution");
  }
  if (!square) warn_of_empty_image(report, asset, out);
  constexpr double kShortSpring = 0.05;
  if (q.spring_min < kShortSpring) {
    out.push_back("the shortest spring is " + rounded(q.spring_min) + " of the nominal " +
                  size_in_words(double{asset.spacing}) + "; the simulation needs more substeps for it");
  }
  return out;
}

}  // namespace geocloth
