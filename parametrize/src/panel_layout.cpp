// SPDX-License-Identifier: GPL-3.0-or-later
//
// Multi-chart geometry images (Sander et al. 2003) as sewing patterns: every part is developed (develop.cpp), every
// seam is divided into steps of about one spacing that all its sides share, and every side's outline is a closed chain
// of as many pixels (pixel_chain.cpp). Inside its chain a chart is sampled where the plane's lattice falls. So seams
// match point by point, no pixel is a double of its neighbour, and the image has exactly the topology of the surface.

#include "panel_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "chain_conflicts.h"
#include "develop.h"
#include "geocloth/asset/error.h"
#include "pack.h"
#include "pixel_chain.h"
#include "point_math.h"
#include "refined_mesh.h"
#include "seam_samples.h"
#include "seam_steps.h"

namespace geocloth {
namespace {

constexpr double kLeastChartArea = 6;    // [pixels] a smaller chart is enlarged to it
constexpr uint32_t kLeastLoopSteps = 4;  // a closed chain without sharp turns
constexpr double kLeastCut = 5;          // [pixels] shorter cut extensions are not worth their pixels
constexpr double kEnlargement = 1.15;
constexpr double kShift = 1.03;
constexpr double kMostEnlargement = 5;
constexpr int kRounds = 24;

/// Everything about the charts that does not change while the numbers of steps are searched for.
struct Plan {
  DevelopedSurface developed;
  std::vector<Outline> outlines;
  double spacing = 0;            // [m]
  std::vector<uint32_t> steps;   // per seam
  std::vector<double> natural;   // per chart: pixels per metre that its size asks for
  std::vector<double> enlarged;  // per chart: by this factor, to make room for its outline
  [[nodiscard]] double scale(size_t chart) const { return natural[chart] * enlarged[chart]; }
};

std::vector<double> chart_areas(const CutSurface& cut) {
  std::vector<double> area(cut.component_count, 0);
  for (size_t t = 0; t < cut.triangle.size(); ++t) {
    const Triangle& k = cut.triangle[t];
    area[cut.component[t]] += triangle_area(cut.position[k[0]], cut.position[k[1]], cut.position[k[2]]);
  }
  return area;
}

double planar_distance(const Point2& a, const Point2& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

/// What every segment of every seam measures [pixels]: the longest of its runs in the plane, so that no chain of pixels
/// has to go further than one pixel in a step.
std::vector<std::vector<double>> segment_lengths(const Plan& plan) {
  std::vector<std::vector<double>> lengths(plan.steps.size());
  for (size_t c = 0; c < plan.outlines.size(); ++c) {
    for (const OutlinePath& path : plan.outlines[c].path) {
      std::vector<double>& length = lengths[path.seam];
      const size_t segments = path.vertex.size() - 1;
      length.resize(segments, 0);
      for (size_t i = 0; i < segments; ++i) {
        const double run =
            plan.scale(c) * planar_distance(plan.developed.uv[path.vertex[i]], plan.developed.uv[path.vertex[i + 1]]);
        double& longest = length[path.reversed ? segments - 1 - i : i];
        longest = std::max(longest, run);
      }
    }
  }
  return lengths;
}

/// The spacing with which about resolution^2 pixels lie inside or on the outlines: area / h^2 + outline / (2 h).
double choose_spacing(const std::vector<double>& area, const std::vector<Outline>& outlines,
                      const FlattenOptions& options) {
  if (options.spacing > 0) return options.spacing;
  double total = 0, border = 0;
  for (const double a : area) total += a;
  for (const Outline& o : outlines) {
    for (const OutlinePath& p : o.path) border += p.length;
  }
  const double wanted = static_cast<double>(options.resolution) * options.resolution;
  const double per_metre = (-border / 2 + std::sqrt(border * border / 4 + 4 * total * wanted)) / (2 * total);
  return 1 / per_metre;
}

/// Gives every seam at least as many steps as it is pixels long.
void raise_steps(Plan& plan) {
  const std::vector<std::vector<double>> lengths = segment_lengths(plan);
  for (size_t seam = 0; seam < plan.steps.size(); ++seam) {
    const double pixels = std::accumulate(lengths[seam].begin(), lengths[seam].end(), 0.0);
    plan.steps[seam] = std::max(plan.steps[seam], static_cast<uint32_t>(std::lround(pixels)));
  }
}

/// The side of a pixel before anything is cut, when only the area is known.
double rough_spacing(const CutSurface& cut, const FlattenOptions& options) {
  if (options.spacing > 0) return options.spacing;
  double total = 0;
  for (const double a : chart_areas(cut)) total += a;
  return std::sqrt(total) / options.resolution;
}

Plan make_plan(const CutSurface& cut, const FlattenOptions& options, const Progress& progress) {
  Plan plan;
  DevelopOptions develop_options;
  develop_options.least_cut = kLeastCut * rough_spacing(cut, options);
  plan.developed = develop(cut, develop_options, progress);
  plan.outlines = trace_outlines(plan.developed.cut);
  const std::vector<double> area = chart_areas(plan.developed.cut);
  plan.spacing = choose_spacing(area, plan.outlines, options);
  for (const double a : area) {
    const double pixels = a / (plan.spacing * plan.spacing);
    plan.natural.push_back(std::max(1.0, std::sqrt(kLeastChartArea / pixels)) / plan.spacing);
    plan.enlarged.push_back(1.0);
  }
  plan.steps = least_seam_steps(plan.developed.cut, plan.outlines);
  for (const Outline& outline : plan.outlines) {
    if (outline.path.size() != 1) continue;
    uint32_t& steps = plan.steps[outline.path[0].seam];
    steps = std::max(steps, kLeastLoopSteps);
  }
  raise_steps(plan);
  return plan;
}

/// Planar coordinates of the refined mesh: inserted outline vertices lie on their edge as in space.
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

std::vector<ChainRun> chain_runs(const Plan& plan, size_t chart, const std::vector<uint32_t>& samples,
                                 const std::vector<Point2>& uv) {
  const size_t n = samples.size();
  const auto place = [&](size_t i) -> Point2 {
    const Point2& p = uv[samples[i % n]];
    return {p[0] * plan.scale(chart), -p[1] * plan.scale(chart)};
  };
  std::vector<ChainRun> runs;
  size_t first = 0;
  for (const OutlinePath& path : plan.outlines[chart].path) {
    ChainRun run;
    for (size_t i = first; i <= first + plan.steps[path.seam]; ++i) {
      run.target.push_back(place(i));
      const Point2 before = place(i + n - 1), after = place(i + 1);
      const double dx = after[0] - before[0], dy = after[1] - before[1];
      const double l = std::hypot(dx, dy);
      // Left of the outline's direction; v runs down.
      run.inward.push_back(l > 0 ? Point2{dy / l, -dx / l} : Point2{0, 0});
    }
    first += plan.steps[path.seam];
    runs.push_back(std::move(run));
  }
  return runs;
}

/// Twice the area inside a closed chain, positive when it runs counter-clockwise seen with v up.
int64_t chain_area(const std::vector<std::vector<Pixel>>& runs) {
  int64_t sum = 0;
  for (const std::vector<Pixel>& run : runs) {
    for (size_t i = 0; i + 1 < run.size(); ++i) {
      sum += int64_t{run[i + 1][0]} * run[i][1] - int64_t{run[i][0]} * run[i + 1][1];
    }
  }
  return sum;
}

/// A run of a chart's outline for which no pixels were found.
struct Stuck {
  size_t chart;
  uint32_t seam;
  uint32_t least_steps;
};

struct Chains {
  std::vector<std::vector<ChainRun>> asked;  // per chart
  std::vector<ChainResult> found;            // per chart
  std::vector<Stuck> stuck;
};

/// @param before  of the round before: charts that did not change since keep what they had
Chains place_chains(const Plan& plan, const std::vector<SampledOutline>& sampled, const std::vector<Point2>& uv,
                    Chains before) {
  Chains chains;
  for (size_t c = 0; c < plan.outlines.size(); ++c) {
    std::vector<ChainRun> runs = chain_runs(plan, c, sample_vertices(sampled[c]), uv);
    const bool known = c < before.asked.size() && before.asked[c] == runs;
    ChainResult result = known ? std::move(before.found[c]) : place_chain(runs);
    if (!known && result.failed.empty() && chain_area(result.run) <= 0) {
      for (uint32_t r = 0; r < plan.outlines[c].path.size(); ++r) result.failed.push_back({r, 0});
    }
    for (const auto& [run, least_steps] : result.failed) {
      chains.stuck.push_back({c, plan.outlines[c].path[run].seam, least_steps});
    }
    chains.asked.push_back(std::move(runs));
    chains.found.push_back(std::move(result));
  }
  return chains;
}

/// A run is stuck because its ends came to lie further apart than it has steps, or because there is too little room; a
/// pinched chart only has to fall differently on the lattice.
/// @returns false when a chart has become so large beside the others that panels make no sense
bool make_room(Plan& plan, const std::vector<Stuck>& stuck, const std::vector<size_t>& pinched) {
  std::vector<size_t> crowded;
  for (const Stuck& s : stuck) {
    if (plan.steps[s.seam] < s.least_steps) {
      plan.steps[s.seam] = s.least_steps;
    } else {
      crowded.push_back(s.chart);
    }
  }
  crowded.erase(std::unique(crowded.begin(), crowded.end()), crowded.end());
  for (const size_t c : crowded) plan.enlarged[c] *= kEnlargement;
  for (const size_t c : pinched) plan.enlarged[c] *= kShift;
  raise_steps(plan);
  return *std::max_element(plan.enlarged.begin(), plan.enlarged.end()) <= kMostEnlargement;
}

/// Charts whose inside would repeat an edge of the welded mesh; asked when every chart has its chain.
std::vector<size_t> pinched_charts(const Chains& chains, const std::vector<SampledOutline>& sampled,
                                   const RefinedMesh& mesh) {
  std::vector<PointChain> charts;
  for (size_t c = 0; c < chains.found.size(); ++c) {
    PointChain chain;
    for (const std::vector<Pixel>& run : chains.found[c].run) {
      chain.pixel.insert(chain.pixel.end(), run.begin(), run.end() - 1);
    }
    for (const uint32_t v : sample_vertices(sampled[c])) chain.point.push_back(mesh.point[v]);
    charts.push_back(std::move(chain));
  }
  return conflicting_charts(charts);
}

FlatChart make_chart(const Plan& plan, size_t c, const SampledOutline& sampled,
                     const std::vector<std::vector<Pixel>>& runs, std::vector<Point2>& uv,
                     const std::vector<uint32_t>& chart_vertices) {
  Pixel low{std::numeric_limits<int32_t>::max(), std::numeric_limits<int32_t>::max()};
  Pixel high{std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::min()};
  for (const std::vector<Pixel>& run : runs) {
    for (const Pixel& p : run) {
      low = {std::min(low[0], p[0]), std::min(low[1], p[1])};
      high = {std::max(high[0], p[0]), std::max(high[1], p[1])};
    }
  }
  FlatChart chart;
  chart.width = static_cast<uint32_t>(high[0] - low[0] + 1);
  chart.height = static_cast<uint32_t>(high[1] - low[1] + 1);
  chart.spacing = 1 / plan.scale(c);
  const std::vector<uint32_t> samples = sample_vertices(sampled);
  size_t i = 0;
  for (const std::vector<Pixel>& run : runs) {
    for (size_t k = 0; k + 1 < run.size(); ++k, ++i) {
      chart.outline.push_back(
          {static_cast<uint32_t>(run[k][0] - low[0]), static_cast<uint32_t>(run[k][1] - low[1]), samples[i]});
    }
  }
  for (const uint32_t v : chart_vertices) {
    uv[v] = {uv[v][0] * plan.scale(c) - low[0], -uv[v][1] * plan.scale(c) - low[1]};
  }
  return chart;
}

}  // namespace

FlatSurface lay_out_panels(const CutSurface& cut, const FlattenOptions& options, const Progress& progress) {
  Plan plan = make_plan(cut, options, progress);
  RefinedMesh mesh;
  std::vector<SampledOutline> sampled;
  std::vector<Point2> uv;
  Chains chains;
  for (int round = 0;; ++round) {
    mesh = make_refined_mesh(plan.developed.cut);
    sampled = insert_seam_samples(mesh, plan.outlines, plan.steps, segment_lengths(plan));
    uv = refined_coordinates(plan, mesh, sampled);
    chains = place_chains(plan, sampled, uv, std::move(chains));
    const std::vector<size_t> pinched =
        chains.stuck.empty() ? pinched_charts(chains, sampled, mesh) : std::vector<size_t>{};
    if (chains.stuck.empty() && pinched.empty()) break;
    if (round == kRounds || !make_room(plan, chains.stuck, pinched)) {
      throw Error(ErrorCode::verification, "no pixels could be found for " + std::to_string(chains.stuck.size()) +
                                               " runs of seams and " + std::to_string(pinched.size()) +
                                               " narrow charts; raise the resolution or try --layout square");
    }
  }

  FlatSurface flat;
  std::vector<std::vector<uint32_t>> vertices(plan.outlines.size());
  std::vector<uint8_t> met(mesh.position.size(), 0);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    for (const uint32_t v : mesh.triangle[t]) {
      if (met[v] == 0) vertices[mesh.component[t]].push_back(v);
      met[v] = 1;
    }
  }
  for (size_t c = 0; c < plan.outlines.size(); ++c) {
    flat.charts.push_back(make_chart(plan, c, sampled[c], chains.found[c].run, uv, vertices[c]));
  }
  flat.position = std::move(mesh.position);
  flat.uv = std::move(uv);
  flat.triangle = std::move(mesh.triangle);
  flat.chart = std::move(mesh.component);
  flat.point = std::move(mesh.point);
  flat.point_count = mesh.point_count;
  flat.clean_vertex = std::move(mesh.clean_vertex);
  flat.clean_triangle = std::move(mesh.clean_triangle);
  pack_charts(flat);
  if (progress) progress("flatten", 1);
  return flat;
}

}  // namespace geocloth
