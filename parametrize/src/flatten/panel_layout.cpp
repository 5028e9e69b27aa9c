// SPDX-License-Identifier: GPL-3.0-or-later
//
// Multi-chart geometry images (Sander et al. 2003) as sewing patterns: every part is developed (develop.cpp), every
// seam is divided into steps of about one spacing that all its sides share, and every side's outline is a closed chain
// of as many pixels (pixel_chain.cpp). Inside its chain a chart is sampled where the plane's lattice falls. So seams
// match point by point, no pixel is a double of its neighbour, and the image has exactly the topology of the surface.

#include "flatten/panel_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "develop/develop.h"
#include "develop/met_holes.h"
#include "develop/round_chart.h"
#include "flatten/narrow_strips.h"
#include "flatten/open_holes.h"
#include "flatten/take_mesh.h"
#include "geocloth/asset/error.h"
#include "image/chain_targets.h"
#include "image/chart_chain.h"
#include "image/lattice_shift.h"
#include "image/pixel_chain.h"
#include "image/seam_measure.h"
#include "image/seam_samples.h"
#include "image/seam_slide.h"
#include "image/seam_steps.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/refined_mesh.h"
#include "mesh/subdivide.h"
#include "pack/pack.h"

namespace geocloth {
namespace {

constexpr uint32_t kLeastLoopSteps = 4;  // a closed chain without sharp turns
constexpr double kLeastCut = 5;          // [pixels] shorter cut extensions are not worth their pixels
constexpr double kLongestEdge = 400;     // [pixels] samples beside a longer one would make slivers of its length
constexpr int kRounds = 40;
/// Pixels that a round chart may have, and how many times those of all charts as they are.
constexpr double kMostDisk = 4096, kMostDiskShare = 1;

/// What a chart looks like to the pixels of its outline: as it is; where that has no room for them, as if it were a few
/// pixels wide everywhere; where that has none either, round.
enum class Shape : uint8_t { own, widened, round };
constexpr double kNarrow = 1, kWide = 3;  // [pixels] that opposite sides keep between them

/// Everything about the charts that their pixels depend on.
struct Plan {
  DevelopedSurface developed;
  std::vector<Outline> outlines;
  double spacing = 0;  // [m]
  std::vector<SeamMeasure> seams;
  std::vector<uint32_t> steps;  // per seam
  std::vector<Shape> shape;     // per chart
  bool has_strips = false;      // that were cut off
};

/// Of the cloth.
std::vector<double> chart_areas(const CutSurface& cut) {
  std::vector<double> area(cut.component_count, 0);
  for (size_t t = 0; t < cut.triangle.size(); ++t) {
    if (!cut.hole.empty() && cut.hole[t] != kNone) continue;
    const Triangle& k = cut.triangle[t];
    area[cut.component[t]] += triangle_area(cut.position[k[0]], cut.position[k[1]], cut.position[k[2]]);
  }
  return area;
}

/// Holes that are filled as yet.
struct Rims {
  double length = 0;  // [m]
  size_t count = 0;
};

Rims rims_of(const CutSurface& cut) {
  Rims rims;
  if (cut.hole.empty()) return rims;
  const std::vector<uint32_t> opposite = opposite_half_edges(cut.triangle);
  std::vector<uint32_t> holes;
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    if (cut.hole[h / 3] == kNone) continue;
    holes.push_back(cut.hole[h / 3]);
    if (opposite[h] != kNone && cut.hole[opposite[h] / 3] == cut.hole[h / 3]) continue;
    rims.length += distance(cut.position[tail(cut.triangle, h)], cut.position[head(cut.triangle, h)]);
  }
  std::sort(holes.begin(), holes.end());
  rims.count = static_cast<size_t>(std::unique(holes.begin(), holes.end()) - holes.begin());
  return rims;
}

/// The spacing with which about resolution^2 pixels lie on the cloth or its outlines: area / h^2 + outline / (2 h),
/// rims of holes among the outlines. Of the pixels in a polygon those on its outline are no part of the hole (Pick
/// 1899), which makes one less for every hole.
double choose_spacing(const std::vector<double>& area, const std::vector<Outline>& outlines, const Rims& rims,
                      const FlattenOptions& options) {
  if (options.spacing > 0) return options.spacing;
  double total = 0, border = rims.length;
  for (const double a : area) total += a;
  for (const Outline& o : outlines) {
    for (const OutlinePath& p : o.path) border += p.length;
  }
  const double wanted = static_cast<double>(options.resolution) * options.resolution + static_cast<double>(rims.count);
  const double per_metre = (-border / 2 + std::sqrt(border * border / 4 + 4 * total * wanted)) / (2 * total);
  return 1 / per_metre;
}

/// @param has_strips  that were cut off: what they hang by should be no wider than they are
Plan make_plan(DevelopedSurface developed, const FlattenOptions& options, bool has_strips) {
  Plan plan;
  plan.has_strips = has_strips;
  plan.developed = std::move(developed);
  plan.outlines = trace_outlines(plan.developed.cut);
  plan.spacing = choose_spacing(chart_areas(plan.developed.cut), plan.outlines, rims_of(plan.developed.cut), options);
  plan.shape.assign(plan.outlines.size(), Shape::own);
  plan.steps = least_seam_steps(plan.developed.cut, plan.outlines);
  plan.seams = measure_seams(plan.outlines, plan.developed.uv, plan.spacing, plan.steps.size());
  std::vector<uint32_t> natural;
  for (const SeamMeasure& seam : plan.seams) natural.push_back(natural_steps(seam));
  if (has_strips) plan.steps = least_seam_steps(plan.developed.cut, plan.outlines, natural);
  for (const Outline& outline : plan.outlines) {
    if (outline.path.size() != 1) continue;
    uint32_t& steps = plan.steps[outline.path[0].seam];
    steps = std::max(steps, kLeastLoopSteps);
  }
  for (size_t s = 0; s < plan.steps.size(); ++s) plan.steps[s] = std::max(plan.steps[s], natural[s]);
  return plan;
}

/// Planar coordinates of the refined mesh [m]: inserted outline vertices lie on their edge as in space.
std::vector<Point2> refined_coordinates(const Plan& plan, const RefinedMesh& mesh,
                                        const std::vector<SampledOutline>& sampled) {
  std::vector<Point2> uv = plan.developed.uv;
  const size_t original = uv.size();
  uv.resize(mesh.position.size());
  for (const SampledOutline& outline : sampled) {
    const size_t n = outline.stop.size();
    for (size_t i = 0; i < n; ++i) {
      const uint32_t a = outline.stop[i].vertex;
      if (a >= original) continue;
      size_t end = i + 1;
      while (outline.stop[end % n].vertex >= original) ++end;
      const uint32_t b = outline.stop[end % n].vertex;
      const double whole = distance(mesh.position[a], mesh.position[b]);
      for (size_t k = i + 1; k < end; ++k) {
        const uint32_t v = outline.stop[k % n].vertex;
        const double share = distance(mesh.position[a], mesh.position[v]) / whole;
        uv[v] = {uv[a][0] + (uv[b][0] - uv[a][0]) * share, uv[a][1] + (uv[b][1] - uv[a][1]) * share};
      }
    }
  }
  return uv;
}

/// A chart's outline samples, counter-clockwise from its first node.
std::vector<uint32_t> sample_vertices(const SampledOutline& outline) {
  std::vector<uint32_t> result;
  for (const OutlineStop& s : outline.stop) {
    if (s.step == std::floor(s.step)) result.push_back(s.vertex);
  }
  return result;
}

/// The refined mesh in the plane, before pixels are found for its outlines.
struct Laid {
  RefinedMesh mesh;
  std::vector<SampledOutline> sampled;        // per chart
  std::vector<std::vector<uint32_t>> vertex;  // per chart
  std::vector<Point2> shift;                  // per chart [pixels], against the lattice
  std::vector<Point2> uv;                     // per vertex [pixels], v down
};

/// Where the samples of a chart's outline lie in its plane.
std::vector<Point2> sample_places(const Laid& laid, size_t chart) {
  std::vector<Point2> places;
  for (const uint32_t v : sample_vertices(laid.sampled[chart])) places.push_back(laid.uv[v]);
  return places;
}

/// Where samples and charts are to lie, where that is known already.
struct Places {
  std::vector<SeamPlaces> seam;  // empty: in steps as equal as the seams' marks allow
  std::vector<Point2> shift;     // per chart [pixels], against the lattice; empty: to be found
};

std::vector<SeamPlaces> even_places(const Plan& plan) {
  std::vector<SeamPlaces> places;
  for (size_t s = 0; s < plan.seams.size(); ++s) {
    places.push_back({plan.seams[s].arc, spread_steps(plan.seams[s], plan.steps[s])});
  }
  return places;
}

Laid lay_out(const Plan& plan, Places places = {}) {
  Laid laid;
  laid.mesh = make_refined_mesh(plan.developed.cut);
  if (places.seam.empty()) places.seam = even_places(plan);
  laid.sampled = insert_seam_samples(laid.mesh, plan.outlines, plan.steps, places.seam);
  laid.vertex.resize(plan.outlines.size());
  std::vector<uint8_t> met(laid.mesh.position.size(), 0);
  for (size_t t = 0; t < laid.mesh.triangle.size(); ++t) {
    for (const uint32_t v : laid.mesh.triangle[t]) {
      if (met[v] == 0) laid.vertex[laid.mesh.component[t]].push_back(v);
      met[v] = 1;
    }
  }
  laid.uv = refined_coordinates(plan, laid.mesh, laid.sampled);
  for (Point2& p : laid.uv) p = {p[0] / plan.spacing, -p[1] / plan.spacing};
  std::vector<std::vector<uint32_t>> round_triangles(plan.shape.size());
  for (uint32_t t = 0; t < laid.mesh.triangle.size(); ++t) {
    const uint32_t c = laid.mesh.component[t];
    if (plan.shape[c] == Shape::round) round_triangles[c].push_back(t);
  }
  for (size_t c = 0; c < plan.shape.size(); ++c) {
    if (plan.shape[c] != Shape::round) continue;
    const RoundChart round = lay_out_round(laid.mesh, round_triangles[c], laid.sampled[c]);
    for (size_t i = 0; i < round.vertex.size(); ++i) laid.uv[round.vertex[i]] = {round.uv[i][0], -round.uv[i][1]};
  }
  laid.shift = std::move(places.shift);
  for (size_t c = laid.shift.size(); c < laid.vertex.size(); ++c)
    laid.shift.push_back(shift_to_lattice(sample_places(laid, c)));
  for (size_t c = 0; c < laid.vertex.size(); ++c) {
    for (const uint32_t v : laid.vertex[c]) {
      laid.uv[v] = {laid.uv[v][0] + laid.shift[c][0], laid.uv[v][1] + laid.shift[c][1]};
    }
  }
  return laid;
}

/// Finds the pixels of all charts; those whose targets are as before keep what they had.
void place_chains(const Plan& plan, const Laid& laid, std::vector<ChartChain>& charts) {
  charts.resize(laid.sampled.size());
  for (size_t c = 0; c < charts.size(); ++c) {
    std::vector<Point2> target =
        chain_targets(sample_places(laid, c), plan.shape[c] == Shape::widened ? kWide : kNarrow);
    if (target != charts[c].target) charts[c] = place_chart(std::move(target));
  }
}

/// One more step for every seam of a chart.
void lengthen(Plan& plan, size_t chart) {
  std::vector<uint32_t> seams;
  for (const OutlinePath& path : plan.outlines[chart].path) seams.push_back(path.seam);
  std::sort(seams.begin(), seams.end());
  seams.erase(std::unique(seams.begin(), seams.end()), seams.end());
  for (const uint32_t seam : seams) ++plan.steps[seam];
}

/// [pixels] of a chart as a disk.
double disk_area(const Laid& laid, size_t chart) {
  const auto outline = static_cast<double>(sample_vertices(laid.sampled[chart]).size());
  return outline * outline / (4 * std::numbers::pi);
}

/// A disk has room for an outline of any length, at the price of an area that grows with its square: right for a
/// button, nonsense for a net whose threads are narrower than a pixel.
/// @throws Error(verification) when the disk would be larger than all charts as they are
void check_room_for_disk(const Plan& plan, const Laid& laid, size_t chart) {
  const auto outline = static_cast<double>(sample_vertices(laid.sampled[chart]).size());
  double area = 0;
  for (const double a : chart_areas(plan.developed.cut)) area += a;
  if (disk_area(laid, chart) <= std::max(kMostDisk, kMostDiskShare * area / (plan.spacing * plan.spacing))) return;
  throw Error(ErrorCode::verification,
              "the strips of a part are too narrow for pixels on either side (its outline has " +
                  std::to_string(std::lround(outline)) + " of them); raise the resolution");
}

/// Charts that found no pixels: which are widened now, which have to become round, and how many there are in all.
struct Stuck {
  std::vector<size_t> widened, to_round;
  size_t count = 0;
};

/// Changes the plan where pixels could not be found, but makes no chart round.
Stuck give_room(Plan& plan, const Laid& laid, std::vector<ChartChain>& charts) {
  std::vector<size_t> crowded, too_short;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (charts[c].chain.result == PixelChain::Result::crowded) crowded.push_back(c);
    if (charts[c].chain.result == PixelChain::Result::too_short) too_short.push_back(c);
  }
  if (crowded.empty() && too_short.empty()) {
    std::vector<std::vector<uint32_t>> points(charts.size());
    for (size_t c = 0; c < charts.size(); ++c) {
      for (const uint32_t v : sample_vertices(laid.sampled[c])) points[c].push_back(laid.mesh.point[v]);
    }
    crowded = part_pinches(points, charts);
  }
  Stuck stuck{{}, {}, crowded.size() + too_short.size()};
  for (const size_t c : crowded) {
    charts[c].target.clear();
    if (plan.shape[c] == Shape::round) too_short.push_back(c);
    if (plan.shape[c] == Shape::widened) stuck.to_round.push_back(c);
    if (plan.shape[c] != Shape::own) continue;
    plan.shape[c] = Shape::widened;
    stuck.widened.push_back(c);
  }
  for (const size_t c : too_short) lengthen(plan, c);
  return stuck;
}

/// Samples slide along their seams to where they suit the pixels of all charts on them.
std::vector<SeamPlaces> suit_samples(const Plan& plan, const Laid& laid, const std::vector<ChartChain>& charts) {
  std::vector<SeamPlaces> places = even_places(plan);
  std::vector<SlidingSeam> seams(plan.seams.size());
  for (size_t s = 0; s < seams.size(); ++s) seams[s] = {std::move(places[s]), plan.seams[s].mark, {}};
  std::vector<std::vector<Pixel>> chains;
  for (size_t c = 0; c < charts.size(); ++c) {
    const auto count = static_cast<uint32_t>(charts[c].chain.pixel.size());
    uint32_t begin = 0;
    for (const OutlinePath& path : plan.outlines[c].path) {
      SeamSide side{c, {}, {}};
      for (uint32_t k = 0; k <= plan.steps[path.seam]; ++k) side.sample.push_back((begin + k) % count);
      for (const uint32_t v : path.vertex) side.curve.push_back(laid.uv[v]);
      if (path.reversed) {
        std::reverse(side.sample.begin(), side.sample.end());
        std::reverse(side.curve.begin(), side.curve.end());
      }
      seams[path.seam].side.push_back(std::move(side));
      begin += plan.steps[path.seam];
    }
    chains.push_back(charts[c].chain.pixel);
  }
  slide_samples(chains, seams);
  for (size_t s = 0; s < seams.size(); ++s) places[s] = std::move(seams[s].places);
  return places;
}

/// The rectangle around a chart's pixels, and where it begins in the plane.
struct Frame {
  Pixel low;
  uint32_t width, height;
};

Frame frame_of(const std::vector<Pixel>& chain) {
  Pixel low{std::numeric_limits<int32_t>::max(), std::numeric_limits<int32_t>::max()};
  Pixel high{std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::min()};
  for (const Pixel& p : chain) {
    low = {std::min(low[0], p[0]), std::min(low[1], p[1])};
    high = {std::max(high[0], p[0]), std::max(high[1], p[1])};
  }
  return {low, static_cast<uint32_t>(high[0] - low[0] + 1), static_cast<uint32_t>(high[1] - low[1] + 1)};
}

/// Cuts a chart's rectangle out of the plane around its chain, and moves its vertices into it.
FlatChart make_chart(Laid& laid, size_t c, const std::vector<Pixel>& chain, Shape shape) {
  const auto [low, width, height] = frame_of(chain);
  FlatChart chart;
  chart.width = width;
  chart.height = height;
  chart.is_disk = shape == Shape::round;
  const std::vector<uint32_t> samples = sample_vertices(laid.sampled[c]);
  for (size_t i = 0; i < chain.size(); ++i) {
    chart.outline.push_back(
        {static_cast<uint32_t>(chain[i][0] - low[0]), static_cast<uint32_t>(chain[i][1] - low[1]), samples[i]});
  }
  for (const uint32_t v : laid.vertex[c]) laid.uv[v] = {laid.uv[v][0] - low[0], laid.uv[v][1] - low[1]};
  return chart;
}

/// The side of a pixel before anything is cut, when only the area is known.
double rough_spacing(const CutSurface& cut, const FlattenOptions& options) {
  if (options.spacing > 0) return options.spacing;
  double total = 0;
  for (const double a : chart_areas(cut)) total += a;
  return std::sqrt(total) / options.resolution;
}

/// A plan and the pixels of its charts.
struct Placed {
  Plan plan;
  Laid laid;
  std::vector<ChartChain> charts;
  std::optional<Packing> packing;
};

/// Is a chart's disk small, or not much larger than the chart?
bool is_worth_a_disk(const Placed& placed, size_t chart) {
  constexpr double kSmall = 256, kMuchLarger = 2;
  const double pixels = chart_areas(placed.plan.developed.cut)[chart] / (placed.plan.spacing * placed.plan.spacing);
  return disk_area(placed.laid, chart) <= std::max(kSmall, kMuchLarger * pixels);
}

/// Do many pixels of a chart's outline lie far from where they should?
bool is_entangled(const ChartChain& chart) {
  constexpr double kFar = 2, kMany = 0.1;  // [pixels]; share
  size_t far = 0;
  if (chart.chain.pixel.size() != chart.target.size()) return false;
  for (size_t i = 0; i < chart.chain.pixel.size(); ++i) {
    const Pixel& p = chart.chain.pixel[i];
    if (std::hypot(p[0] - chart.target[i][0], p[1] - chart.target[i][1]) > kFar) ++far;
  }
  return static_cast<double>(far) > kMany * static_cast<double>(chart.chain.pixel.size());
}

/// Do so many samples want the same pixels that to look for others takes long and finds none?
bool is_overfull(const std::vector<Point2>& target) {
  constexpr double kMany = 0.2;
  std::vector<Pixel> pixel;
  pixel.reserve(target.size());
  for (const Point2& p : target) {
    pixel.push_back({static_cast<int32_t>(std::lround(p[0])), static_cast<int32_t>(std::lround(p[1]))});
  }
  std::sort(pixel.begin(), pixel.end());
  const auto single = static_cast<double>(std::unique(pixel.begin(), pixel.end()) - pixel.begin());
  const auto all = static_cast<double>(target.size());
  return all - single > kMany * all;
}

constexpr size_t kFringe = 12;  // strips; an outline finds its way around fewer

/// @param least  per chart, see narrow_strips.h. @returns whether there are any
bool cut_off(Placed& placed, const std::vector<size_t>& least, const FlattenOptions& options) {
  Plan& plan = placed.plan;
  if (std::all_of(least.begin(), least.end(), [](size_t n) { return n == kNoStrips; })) return false;
  if (!cut_off_strips(plan.developed, least, plan.spacing)) return false;
  placed = {make_plan(std::move(plan.developed), options, true), {}, {}, {}};
  return true;
}

/// Fringes are cut off where there is clearly no room for them.
bool cut_off_overfull_fringes(Placed& placed, const FlattenOptions& options) {
  std::vector<size_t> least(placed.plan.shape.size(), kNoStrips);
  for (size_t c = 0; c < least.size(); ++c) {
    if (is_overfull(chain_targets(sample_places(placed.laid, c), kNarrow))) least[c] = kFringe;
  }
  return cut_off(placed, least, options);
}

/// Strips are cut off charts that have no pixels but on disks that are too large, and fringes where they are crowded or
/// entangled. @returns whether there are any
bool cut_off_crowded_strips(Placed& placed, const Stuck& stuck, const FlattenOptions& options) {
  std::vector<size_t> least(placed.plan.shape.size(), kNoStrips);
  for (size_t c = 0; c < placed.charts.size(); ++c) {
    if (is_entangled(placed.charts[c])) least[c] = kFringe;
  }
  for (const size_t c : stuck.widened) least[c] = kFringe;
  for (const size_t c : stuck.to_round) {
    if (!is_worth_a_disk(placed, c)) least[c] = 1;
  }
  return cut_off(placed, least, options);
}

/// @throws Error(verification) when no pixels can be found for some chart
Placed placed_at(Plan plan, const FlattenOptions& options, const Progress& progress) {
  Placed placed{std::move(plan), {}, {}, {}};
  for (int round = 0;; ++round) {
    if (progress) progress("flatten", 1);
    placed.laid = lay_out(placed.plan);
    if (round == 0 && cut_off_overfull_fringes(placed, options)) placed.laid = lay_out(placed.plan);
    place_chains(placed.plan, placed.laid, placed.charts);
    const Stuck stuck = give_room(placed.plan, placed.laid, placed.charts);
    if (cut_off_crowded_strips(placed, stuck, options)) continue;
    if (stuck.count == 0) return placed;
    if (round == kRounds) {
      throw Error(ErrorCode::verification, "no pixels could be found for the outlines of " +
                                               std::to_string(stuck.count) + " charts; raise the resolution");
    }
    for (const size_t c : stuck.to_round) placed.plan.shape[c] = Shape::round;
    for (size_t c = 0; c < placed.plan.shape.size(); ++c) {
      if (placed.plan.shape[c] == Shape::round) check_room_for_disk(placed.plan, placed.laid, c);
    }
  }
}

/// Packs the charts. @returns the share of the image's pixels that they fill
double packed(Placed& placed) {
  std::vector<ChartShape> shape;
  double pixels = 0;
  for (const ChartChain& c : placed.charts) {
    const std::vector<Pixel>& chain = c.chain.pixel;
    const auto [low, width, height] = frame_of(chain);
    FlatChart chart;
    chart.width = width;
    chart.height = height;
    double area_twice = 0;
    for (size_t i = 0; i < chain.size(); ++i) {
      const Pixel &p = chain[i], &q = chain[(i + 1) % chain.size()];
      area_twice +=
          static_cast<double>(p[1] - low[1]) * (q[0] - low[0]) - static_cast<double>(p[0] - low[0]) * (q[1] - low[1]);
      chart.outline.push_back({static_cast<uint32_t>(p[0] - low[0]), static_cast<uint32_t>(p[1] - low[1]), 0});
    }
    pixels += (area_twice + static_cast<double>(chain.size())) / 2 + 1;  // Pick 1899
    shape.push_back(chart_shape(chart));
  }
  placed.packing = pack_shapes(shape);
  return pixels / (static_cast<double>(placed.packing->width) * placed.packing->height);
}

/// Where an image lacks little of being well filled, the nearest spacing is taken, a few tenths of a per cent larger or
/// smaller, at which it is: charts' rows and columns are whole numbers, and one more may be all but empty.
void find_fuller_image(Placed& placed, const FlattenOptions& options) {
  constexpr double kStep = 1e-3, kHopeful = 0.985;  // of the spacing; of the utilisation that is enough
  constexpr int kSteps = 10, kAtOnce = 4;
  const double enough = PartingOptions{}.enough;
  if (const double now = packed(placed); now >= enough || now < kHopeful * enough) return;
  for (int first = 1; first <= kSteps; first += kAtOnce / 2) {
    std::array<std::optional<Placed>, kAtOnce> trial;
    tbb::parallel_for(0, kAtOnce, [&](int i) {
      const int steps = first + i / 2;
      FlattenOptions other = options;
      other.spacing = placed.plan.spacing * (1 + (i % 2 == 0 ? -steps : steps) * kStep);
      try {
        Placed p = placed_at(make_plan(placed.plan.developed, other, placed.plan.has_strips), other, {});
        if (packed(p) >= enough) trial[static_cast<size_t>(i)] = std::move(p);
      } catch (const Error&) {  // this one has no room for some chart
      }
    });
    const auto found = std::find_if(trial.begin(), trial.end(), [](const auto& t) { return t.has_value(); });
    if (found == trial.end()) continue;
    placed = std::move(**found);
    return;
  }
}

/// Charts with their holes; those that have no room in the image are cut open to the outline, all in the end.
/// @throws Error(limit) where so many have none that the ways to the outline would take longer than all the rest
FlatSurface with_open_holes(DevelopedSurface developed, const FlattenOptions& options, const Progress& progress) {
  constexpr int kTries = 4;
  constexpr double kMostWays = 5e7;  // triangles that are looked at for ways from holes
  for (int tries = 0;; ++tries) {
    std::vector<uint32_t> hole;  // per triangle of the clean surface
    for (size_t t = 0; t < developed.cut.hole.size(); ++t) {
      const uint32_t clean = developed.cut.clean_triangle[t];
      if (clean >= hole.size()) hole.resize(clean + size_t{1}, kNone);
      hole[clean] = developed.cut.hole[t];
    }
    std::vector<uint32_t> stuck;
    for (const uint32_t h : hole) {
      if (h != kNone) stuck.push_back(h);
    }
    if (stuck.empty()) return lay_out_developed(std::move(developed), options, progress);
    std::sort(stuck.begin(), stuck.end());
    stuck.erase(std::unique(stuck.begin(), stuck.end()), stuck.end());
    if (tries < kTries) {
      FlatSurface flat = lay_out_developed(developed, options, progress);
      stuck = open_holes(flat, hole);
      if (stuck.empty()) return flat;
    }
    if (kMostWays < static_cast<double>(stuck.size()) * static_cast<double>(developed.cut.triangle.size())) {
      throw Error(ErrorCode::limit, "panels: " + std::to_string(stuck.size()) +
                                        " holes have no room for pixels around them; give a larger --resolution");
    }
    developed = with_holes_cut_open(developed, stuck);
  }
}

}  // namespace

FlatSurface lay_out_panels(std::span<const CutSurface> cuts, const FlattenOptions& options, const Progress& progress) {
  const CutSurface& cut = cuts.front();
  DevelopOptions develop_options;
  develop_options.least_cut = kLeastCut * rough_spacing(cut, options);
  develop_options.parting.pixel = rough_spacing(cut, options);
  develop_options.straight_cuts = options.straight_cuts;
  develop_options.prefer = options.prefer;
  return with_open_holes(develop(cuts, develop_options, progress), options, progress);
}

FlatSurface lay_out_developed(DevelopedSurface developed, const FlattenOptions& options, const Progress& progress) {
  const double longest = kLongestEdge * rough_spacing(developed.cut, options);
  developed.cut = subdivide_long_edges(std::move(developed.cut), developed.uv, longest);
  Placed placed = placed_at(make_plan(std::move(developed), options, false), options, progress);
  if (!(options.spacing > 0)) find_fuller_image(placed, options);
  auto& [plan, laid, charts, packing] = placed;
  laid = lay_out(plan, {suit_samples(plan, laid, charts), laid.shift});

  FlatSurface flat;
  for (size_t c = 0; c < charts.size(); ++c)
    flat.charts.push_back(make_chart(laid, c, charts[c].chain.pixel, plan.shape[c]));
  take_mesh(flat, std::move(laid.mesh));
  flat.uv = std::move(laid.uv);
  set_spacing(flat);
  packing ? arrange_charts(flat, *packing) : pack_charts(flat);
  return flat;
}

void set_spacing(FlatSurface& flat) {
  std::vector<double> in_space(flat.charts.size(), 0), in_plane(flat.charts.size(), 0);
  for (size_t t = 0; t < flat.triangle.size(); ++t) {
    const Triangle& k = flat.triangle[t];
    in_space[flat.chart[t]] += triangle_area(flat.position[k[0]], flat.position[k[1]], flat.position[k[2]]);
    in_plane[flat.chart[t]] += signed_area_twice(flat.uv[k[0]], flat.uv[k[1]], flat.uv[k[2]]) / 2;
  }
  for (size_t c = 0; c < flat.charts.size(); ++c) flat.charts[c].spacing = std::sqrt(in_space[c] / in_plane[c]);
}

}  // namespace geocloth
