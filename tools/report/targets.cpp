// SPDX-License-Identifier: GPL-3.0-or-later
// What a good geometry image of a garment reaches. The bounds are what the best parametrizations of garments measure
// (symmetric Dirichlet and L2: OptCuts, Li et al. 2018, and UVAtlas polished by SLIM, Rabinovich et al. 2017); the
// wider ones, up to which a miss counts as near, are where the motion of the cloth begins to show it.
#include "report/targets.h"

#include <algorithm>

#include <fmt/format.h>

namespace geocloth {
namespace {

enum class Wanted { at_most, at_least, nothing };

/// A number to be judged.
struct Row {
  const char* key;
  const char* title;
  const char* meaning;
  double value;
  const char* format;  ///< of value and bounds, for fmt
  Wanted wanted = Wanted::nothing;
  double bound = 0;  ///< met up to here
  double limit = 0;  ///< near up to here
};

Verdict verdict_of(const Row& row) {
  if (row.wanted == Wanted::nothing) return Verdict::none;
  const auto within = [&](double bound) {
    return row.wanted == Wanted::at_most ? row.value <= bound : row.value >= bound;
  };
  if (within(row.bound)) return Verdict::met;
  return within(row.limit) ? Verdict::near : Verdict::missed;
}

Measure measure_of(const Row& row, bool has_target) {
  const auto text = [&](double value) { return fmt::format(fmt::runtime(row.format), value); };
  Measure measure{row.key, row.title, row.meaning, text(row.value), {}, Verdict::none};
  if (row.wanted == Wanted::nothing || !has_target) return measure;
  measure.target = (row.wanted == Wanted::at_most ? row.bound == 0 ? "" : "at most " : "at least ") + text(row.bound);
  measure.verdict = verdict_of(row);
  return measure;
}

MeasureGroup group_of(const char* title, const std::vector<Row>& rows, bool has_target = true) {
  MeasureGroup group{title, {}};
  for (const Row& row : rows) group.measures.push_back(measure_of(row, has_target));
  return group;
}

double carried_share(const ConvertReport& report) {
  double share = 0;
  for (const CarriedPart& part : report.carried) share += part.is_side ? 0 : part.area_share;
  return share;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::met:
      return "met";
    case Verdict::near:
      return "near";
    case Verdict::missed:
      return "missed";
    case Verdict::none:
      break;
  }
  return "no target";
}

std::vector<MeasureGroup> judge(const ConvertResult& result) {
  using enum Wanted;
  const Quality& q = result.report.quality;
  const ImageSummary image = summarize_image(result.asset);
  const bool square = result.asset.layout == Layout::square;
  return {
      group_of("Must hold",
               {{"flipped", "Flipped triangles", "Triangles that lie face down in the layout.",
                 static_cast<double>(q.flipped), "{:.0f}", at_most},
                {"mirrored", "Mirrored panels", "Panels that lie with the wrong side up.",
                 static_cast<double>(q.mirrored), "{:.0f}", at_most},
                {"overlapping_pixels", "Overlapping pixels", "Pixels that two places of the cloth claim.",
                 static_cast<double>(q.overlapping_pixels), "{:.0f}", at_most},
                {"crossing_springs", "Springs across a gap", "Springs that would tie cloth where there is none.",
                 static_cast<double>(q.crossing_springs), "{:.0f}", at_most},
                {"copy_gap", "Seam gap [m]", "Largest distance between the two sides of a seam at rest.", q.copy_gap,
                 "{:.2g}", at_most},
                {"carried", "Area without pixels",
                 "Share of the surface in parts that are carried, or too small for a pixel.",
                 100 * carried_share(result.report), "{:.2g} %", at_most, 1, 1}}),
      group_of("Shape: does the cloth keep its lengths and angles?",
               {{"l2_stretch", "Stretch (L2)", "Root mean square stretch of the layout; 1 is none.", q.l2_stretch,
                 "{:.4f}", at_most, 1.005, 1.02},
                {"symmetric_dirichlet", "Symmetric Dirichlet", "Stretch and squeeze together; 4 is none.",
                 q.symmetric_dirichlet, "{:.3f}", at_most, 4.03, 4.1},
                {"anisotropy_p95", "Anisotropy", "One direction against the other, for 95 % of the area; 1 is even.",
                 q.anisotropy_p95, "{:.3f}", at_most, 1.15, 1.3},
                {"shear_deg_p50", "Angle off 90°, median", "How far warp and weft are from a right angle.",
                 q.shear_deg_p50, "{:.2f}°", at_most, 1, 2},
                {"shear_deg_p95", "Angle off 90°, 95 %", "The same; nineteen of twenty places are better.",
                 q.shear_deg_p95, "{:.2f}°", at_most, 6, 12}},
               !square),
      group_of("Springs: are they all about one length?",
               {{"spring_p99_over_p1", "Longest to shortest", "99th over 1st percentile of the spring lengths.",
                 q.spring_p99_over_p1, "{:.3f}", at_most, 1.5, 2},
                {"spring_min", "Shortest spring", "Against the nominal spacing; short springs need more substeps.",
                 q.spring_min, "{:.3f}", at_least, 0.3, 0.15},
                {"spring_max", "Longest spring", "Against the nominal spacing.", q.spring_max, "{:.3f}", at_most, 2, 3},
                {"quad_area_p5", "Small cells", "Area of the smallest twentieth of the cells against nominal.",
                 q.quad_area_p5, "{:.3f}", at_least, 0.9, 0.8},
                {"quad_area_p95", "Large cells", "Area of the largest twentieth of the cells against nominal.",
                 q.quad_area_p95, "{:.3f}", at_most, 1.1, 1.25}},
               !square),
      group_of("Accuracy: is it the same garment?",
               {{"psnr_db", "PSNR [dB]", "Likeness of the image's surface and the garment's; more is better.",
                 q.psnr_db, "{:.1f}", at_least, 80, 70},
                {"max_error", "Largest deviation", "Against the diagonal of the garment.", q.max_error, "{:.2g}",
                 at_most, 2e-3, 5e-3},
                {"rms_error", "Typical deviation", "Root mean square, against the diagonal of the garment.",
                 q.rms_error, "{:.2g}"},
                {"binding_error", "Binding", "How far a bound vertex is off at rest, against the diagonal.",
                 q.binding_error, "{:.2g}", at_most, 1e-6, 1e-5}}),
      group_of("Economy: what does it cost?",
               {{"seam_length", "Seam length", "All cuts together, against the square root of the area.", q.seam_length,
                 "{:.3f}"},
                {"border_share", "Border pixels", "Share of the pixels that lie on an outline.",
                 100 * image.border_share, "{:.1f} %", at_most, 7, 12},
                {"free_border_share", "Free border", "Of them those on hems and other edges of the garment itself.",
                 100 * image.free_border_share, "{:.1f} %"},
                {"utilisation", "Utilisation", "Share of the image that is cloth.", 100 * image.utilisation, "{:.1f} %",
                 at_least, 75, 60}}),
  };
}

Judgement sum_up(const std::vector<MeasureGroup>& groups) {
  Judgement sum;
  for (const MeasureGroup& group : groups) {
    for (const Measure& measure : group.measures) {
      sum.with_target += measure.verdict == Verdict::none ? 0 : 1;
      sum.near += measure.verdict == Verdict::near ? 1 : 0;
      sum.missed += measure.verdict == Verdict::missed ? 1 : 0;
      sum.worst = std::max(sum.worst, measure.verdict);
    }
  }
  return sum;
}

}  // namespace geocloth
