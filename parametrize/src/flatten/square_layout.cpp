// SPDX-License-Identifier: GPL-3.0-or-later
// Gu, Gortler, Hoppe, Geometry Images, SIGGRAPH 2002, sections 3 and 4: every disk is mapped to a square (here a
// rectangle whose sides differ by a pixel at most). Its outline is laid pixel by pixel along the border; where the
// first corner goes is chosen among several places by the stretch that results, never so that a cut end is on a corner.
// The inside starts from a convex embedding, which cannot flip, and is improved without flips.
#include "flatten/square_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "develop/disk_embedding.h"
#include "develop/extend_cut.h"
#include "develop/symmetric_dirichlet.h"
#include "flatten/square_plan.h"
#include "flatten/take_mesh.h"
#include "geocloth/asset/error.h"
#include "image/seam_samples.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/predicates.h"
#include "mesh/refined_mesh.h"
#include "mesh/subdivide.h"
#include "pack/pack.h"

namespace geocloth {
namespace {

constexpr size_t kCornerCandidates = 16;
constexpr int kRelaxRounds = 40;
constexpr double kWild = 5;          // a stretch that calls for a second try
constexpr double kLongEdge = 10;     // [pixels]
constexpr double kFinestShare = 50;  // edges below this share of the whole surface's side are not split
constexpr double kFewPixels = 100;
constexpr double kGoodStretch = 1.2, kHopelessStretch = 100;  // above which longer cuts are tried
constexpr uint32_t kNewtonSteps = 60;
constexpr double kNewtonTolerance = 1e-3, kRoughTolerance = 1e-2;

/// One component with vertices of its own. Planar coordinates are mathematical (y up) and in pixels.
struct Disk {
  double bottom = 0;             // height - 1: the row of y = 0
  std::vector<uint32_t> vertex;  // vertices of the refined mesh
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  std::vector<uint8_t> fixed;
  std::vector<OutlineStop> stop;  // local vertices
  std::vector<uint32_t> sample;   // per step: local vertex
  std::vector<Point2> uv;
};

using Size = std::array<uint32_t, 2>;

std::vector<Disk> split_into_disks(const RefinedMesh& mesh, const std::vector<SampledOutline>& outlines) {
  std::vector<Disk> disks(outlines.size());
  std::vector<uint32_t> local(mesh.position.size(), kNone);
  for (size_t t = 0; t < mesh.triangle.size(); ++t) {
    Disk& disk = disks[mesh.component[t]];
    Triangle corners{};
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t v = mesh.triangle[t][i];
      if (local[v] == kNone) {
        local[v] = static_cast<uint32_t>(disk.vertex.size());
        disk.vertex.push_back(v);
        disk.position.push_back(mesh.position[v]);
        disk.fixed.push_back(mesh.leaving[v] != kNone ? 1 : 0);
      }
      corners[i] = local[v];
    }
    disk.triangle.push_back(corners);
  }
  for (size_t c = 0; c < disks.size(); ++c) {
    for (const OutlineStop& s : outlines[c].stop) {
      disks[c].stop.push_back({local[s.vertex], s.step});
      if (s.step == std::floor(s.step)) disks[c].sample.push_back(local[s.vertex]);
    }
    disks[c].uv.assign(disks[c].vertex.size(), Point2{0, 0});
  }
  return disks;
}

/// The place on a rectangle's border that is `along` steps from its lower left corner, counter-clockwise.
Point2 on_rectangle(double along, const Size& size) {
  const double right = size[0] - 1.0, top = size[1] - 1.0;
  if (along <= right) return {along, 0};
  if (along <= right + top) return {right, along - right};
  if (along <= 2 * right + top) return {2 * right + top - along, top};
  return {0, 2 * (right + top) - along};
}

void place_outline(Disk& disk, const Size& size, uint32_t corner_step) {
  const auto steps = static_cast<double>(disk.sample.size());
  for (const OutlineStop& s : disk.stop) {
    const double along = s.step - corner_step;
    disk.uv[s.vertex] = on_rectangle(along < 0 ? along + steps : along, size);
  }
}

/// An outline between the circle around the rectangle's centre (share 0) and the rectangle (share 1); convex as well.
void place_outline_between(Disk& disk, const Size& size, uint32_t corner_step, double share) {
  place_outline(disk, size, corner_step);
  const double x = 0.5 * (size[0] - 1), y = 0.5 * (size[1] - 1);
  for (const OutlineStop& s : disk.stop) {
    const double turn = (s.step - corner_step) / static_cast<double>(disk.sample.size()) + 0.625;
    const double angle = 2 * std::numbers::pi * turn;
    Point2& p = disk.uv[s.vertex];
    p = {share * p[0] + (1 - share) * x * (1 + std::cos(angle)),
         share * p[1] + (1 - share) * y * (1 + std::sin(angle))};
  }
}

/// Steps on which the rectangle's lower left corner may lie: no corner on a cut end, whose two neighbours are copies of
/// one point and would close the corner's cell. Turns by a quarter (a half, if not square) are the same and left out.
std::vector<uint32_t> corner_steps(const Disk& disk, const RefinedMesh& mesh, const Size& size) {
  const auto steps = static_cast<uint32_t>(disk.sample.size());
  const auto point = [&](uint32_t step) { return mesh.point[disk.vertex[disk.sample[step % steps]]]; };
  const auto is_end = [&](uint32_t step) { return point(step + steps - 1) == point(step + 1); };
  const uint32_t a = size[0] - 1, b = size[1] - 1;
  std::vector<uint32_t> free;
  for (uint32_t first = 0; first < (a == b ? a : a + b); ++first) {
    if (!is_end(first) && !is_end(first + a) && !is_end(first + a + b) && !is_end(first + 2 * a + b)) {
      free.push_back(first);
    }
  }
  return free;
}

/// The rectangle nearest to a square of the disk's perimeter that has a corner step.
Size choose_size(const Disk& disk, const RefinedMesh& mesh, const Size& wanted, uint32_t component) {
  for (uint32_t d = 0; wanted[1] >= d + 4; ++d) {
    for (const Size& size : {Size{wanted[0] + d, wanted[1] - d}, Size{wanted[1] - d, wanted[0] + d}}) {
      if (!corner_steps(disk, mesh, size).empty()) return size;
    }
  }
  throw Error(ErrorCode::verification, "component " + std::to_string(component) +
                                           " has cut ends on every possible corner; raise the resolution");
}

bool has_flips(const Disk& disk) {
  return std::any_of(disk.triangle.begin(), disk.triangle.end(), [&](const Triangle& t) {
    const auto down = [&](uint32_t v) { return Point2{disk.uv[v][0], disk.bottom - disk.uv[v][1]}; };
    return orientation(down(t[0]), down(t[1]), down(t[2])) <= 0;
  });
}

double area_of(const Disk& disk) {
  double sum = 0;
  for (const auto& [a, b, c] : disk.triangle) {
    sum += triangle_area(disk.position[a], disk.position[b], disk.position[c]);
  }
  return sum;
}

/// Lowers the symmetric Dirichlet energy with the outline fixed. The optimiser works at the surface's scale; outline
/// vertices keep their exact places.
void improve(Disk& disk, double tolerance) {
  SymmetricDirichlet energy(disk.position, disk.triangle, disk.fixed);
  double flat_area = 0;
  for (const auto& [a, b, c] : disk.triangle) flat_area -= 0.5 * signed_area_twice(disk.uv[a], disk.uv[b], disk.uv[c]);
  const double scale = std::sqrt(area_of(disk) / flat_area);
  std::vector<Point2> scaled = disk.uv;
  for (Point2& p : scaled) p = {p[0] * scale, p[1] * scale};
  if (!std::isfinite(energy.energy(scaled))) return;
  energy.minimise(scaled, kNewtonSteps, tolerance);
  const std::vector<Point2> before = disk.uv;
  for (size_t v = 0; v < scaled.size(); ++v) {
    if (disk.fixed[v] == 0) disk.uv[v] = {scaled[v][0] / scale, scaled[v][1] / scale};
  }
  if (has_flips(disk)) disk.uv = before;
}

/// Over a circle first, then over outlines that come closer to the rectangle. A branch of the disk whose outline lies
/// on one straight side shrinks exponentially with its length when it is embedded there at once; over the circle it
/// does not, and every next outline starts from the proportions that the one before gave.
/// @return the L2 stretch
double embed_by_circle(Disk& disk, const Size& size, uint32_t corner_step, DiskEmbedding::Weights weights) {
  DiskEmbedding embedding(disk.position, disk.triangle, disk.fixed, weights);
  for (const double share : {0.0, 0.7, 0.95}) {
    place_outline_between(disk, size, corner_step, share);
    embedding.solve(disk.uv);
    embedding.relax_stretch(disk.uv, kRelaxRounds);
    improve(disk, kRoughTolerance);
    embedding.weigh_by(disk.uv);
  }
  place_outline(disk, size, corner_step);
  embedding.solve(disk.uv);
  return embedding.relax_stretch(disk.uv, kRelaxRounds);
}

/// Embeds the disk with the corner step of least stretch; false if every one has a flip.
bool embed(Disk& disk, const RefinedMesh& mesh, const Size& size, DiskEmbedding::Weights weights) {
  DiskEmbedding embedding(disk.position, disk.triangle, disk.fixed, weights);
  const std::vector<uint32_t> free = corner_steps(disk, mesh, size);
  double best = std::numeric_limits<double>::infinity();
  uint32_t best_step = free.front();
  const size_t count = std::min(free.size(), kCornerCandidates);
  for (size_t i = 0; i < count; ++i) {
    const uint32_t step = free[i * free.size() / count];
    place_outline(disk, size, step);
    embedding.solve(disk.uv);
    const double stretch = embedding.l2_stretch(disk.uv);
    if (stretch < best) {
      best = stretch;
      best_step = step;
    }
  }
  place_outline(disk, size, best_step);
  embedding.solve(disk.uv);
  const double stretch = embedding.relax_stretch(disk.uv, kRelaxRounds);
  if (stretch < kWild && !has_flips(disk)) return true;
  const std::vector<Point2> direct = disk.uv;
  const bool direct_is_valid = !has_flips(disk);
  const double carried = embed_by_circle(disk, size, best_step, weights);
  if (carried < stretch && !has_flips(disk)) return true;
  disk.uv = direct;
  return direct_is_valid;
}

std::vector<double> component_areas(const CutSurface& cut) {
  std::vector<double> area(cut.component_count, 0.0);
  for (size_t t = 0; t < cut.triangle.size(); ++t) {
    const auto& [a, b, c] = cut.triangle[t];
    area[cut.component[t]] += triangle_area(cut.position[a], cut.position[b], cut.position[c]);
  }
  return area;
}

FlatChart lay_out(Disk& disk, const RefinedMesh& mesh, const Size& wanted, uint32_t component) {
  const Size size = choose_size(disk, mesh, wanted, component);
  disk.bottom = size[1] - 1.0;
  if (!embed(disk, mesh, size, DiskEmbedding::Weights::mean_value) &&
      !embed(disk, mesh, size, DiskEmbedding::Weights::uniform)) {
    throw Error(ErrorCode::verification,
                "component " + std::to_string(component) +
                    " cannot be laid out in a square without flipped triangles; raise the resolution");
  }
  FlatChart chart;
  chart.width = size[0];
  chart.height = size[1];
  chart.spacing = std::sqrt(area_of(disk) / (static_cast<double>(size[0] - 1) * (size[1] - 1)));
  improve(disk, kNewtonTolerance);
  for (const uint32_t v : disk.sample) {
    chart.outline.push_back(
        {static_cast<uint32_t>(disk.uv[v][0]), size[1] - 1 - static_cast<uint32_t>(disk.uv[v][1]), disk.vertex[v]});
  }
  return chart;
}

double total(const std::vector<double>& area) {
  return std::accumulate(area.begin(), area.end(), 0.0);
}

/// About the spring length that the options lead to.
double expected_spacing(double area, const FlattenOptions& options) {
  return options.spacing > 0 ? options.spacing : std::sqrt(area) / options.resolution;
}

/// Parts of a few pixels gain nothing from longer cuts, unless they could not be laid out at all.
std::vector<double> good_stretch(const std::vector<double>& area, double spacing) {
  std::vector<double> good;
  good.reserve(area.size());
  for (const double a : area) {
    good.push_back(a < kFewPixels * spacing * spacing ? kHopelessStretch : kGoodStretch);
  }
  return good;
}

/// An atlas that is too large is refused before the long work.
void expect_to_fit(const std::vector<Size>& size) {
  std::vector<ChartShape> shape;
  shape.reserve(size.size());
  for (const auto& [width, height] : size) shape.push_back(rectangle_shape(width, height));
  (void)pack_shapes(shape);
}

}  // namespace

FlatSurface lay_out_squares(const CutSurface& whole, const FlattenOptions& options, const Progress& progress) {
  const std::vector<double> area = component_areas(whole);
  const double spacing = expected_spacing(total(area), options);
  CutSurface fine = subdivide_long_edges(whole, std::max(kLongEdge * spacing, std::sqrt(total(area)) / kFinestShare));
  const CutSurface cut = extend_cuts(std::move(fine), good_stretch(area, spacing), progress);
  const std::vector<Outline> outlines = trace_outlines(cut);
  const SquarePlan plan = plan_squares(cut, outlines, area, options);
  expect_to_fit(plan.size);

  RefinedMesh mesh = make_refined_mesh(cut);
  const std::vector<SampledOutline> sampled = insert_seam_samples(mesh, outlines, plan.seam_steps);
  split_edges_across(mesh);

  FlatSurface flat;
  flat.uv.resize(mesh.position.size());
  std::vector<Disk> disks = split_into_disks(mesh, sampled);
  for (uint32_t c = 0; c < disks.size(); ++c) {
    if (progress) progress("flatten", static_cast<double>(c) / static_cast<double>(disks.size()));
    flat.charts.push_back(lay_out(disks[c], mesh, plan.size[c], c));
    for (size_t v = 0; v < disks[c].vertex.size(); ++v) {
      flat.uv[disks[c].vertex[v]] = {disks[c].uv[v][0], disks[c].bottom - disks[c].uv[v][1]};
    }
  }

  take_mesh(flat, std::move(mesh));
  pack_charts(flat);
  if (progress) progress("flatten", 1);
  return flat;
}

}  // namespace geocloth
