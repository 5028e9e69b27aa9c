// SPDX-License-Identifier: GPL-3.0-or-later
// Gu, Gortler, Hoppe 2002, section 4: mates of a cut get the same whole number of pixels, and points on them are linear
// in arc length, so that both sides sample identical points. Here a vertex is inserted for each sample instead, which
// makes it exact and extends to any number of runs over one seam.
#include "image/seam_samples.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "geocloth/asset/error.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSnap = 0.05;    // [steps] a vertex this close to a sample becomes the sample
constexpr double kSpread = 0.01;  // share of uniform spacing mixed in, so that no two vertices fall on one place

struct Sample {
  Point3 position;
  uint32_t point;
  double step;
};

/// One seam in its own direction.
struct SeamPlan {
  std::vector<double> step;                   // per vertex of the seam
  std::vector<std::vector<Sample>> inserted;  // per segment, ascending
};

/// Samples at equal lengths in space.
SeamPlaces even_places(const RefinedMesh& mesh, const std::vector<uint32_t>& vertex, uint32_t steps) {
  SeamPlaces places{{0}, {}};
  for (size_t i = 0; i + 1 < vertex.size(); ++i) {
    places.arc.push_back(places.arc.back() + distance(mesh.position[vertex[i]], mesh.position[vertex[i + 1]]));
  }
  for (uint32_t j = 0; j <= steps; ++j) places.at.push_back(places.arc.back() * j / steps);
  return places;
}

SeamPlan plan_seam(RefinedMesh& mesh, const std::vector<uint32_t>& vertex, uint32_t steps, const SeamPlaces& places) {
  const size_t segments = vertex.size() - 1;
  const std::vector<double>& arc = places.arc;
  const double step_length = arc.back() / steps;
  if (!(step_length > 0)) {
    throw Error(ErrorCode::verification,
                "the seam at vertex " + std::to_string(mesh.clean_vertex[vertex[0]]) + " has no length");
  }

  SeamPlan plan;
  plan.step.assign(vertex.size(), -1.0);
  plan.inserted.resize(segments);
  plan.step.front() = 0;
  plan.step.back() = steps;
  size_t segment = 0;
  for (uint32_t j = 1; j < steps; ++j) {
    const double target = places.at[j];
    while (segment + 1 < segments && arc[segment + 1] < target) ++segment;
    const bool to_start = target - arc[segment] <= arc[segment + 1] - target;
    const size_t nearest = to_start ? segment : segment + 1;
    const bool inside = nearest != 0 && nearest != segments;
    if (inside && std::abs(target - arc[nearest]) <= kSnap * step_length && plan.step[nearest] < 0) {
      plan.step[nearest] = j;
      continue;
    }
    const double share = (target - arc[segment]) / (arc[segment + 1] - arc[segment]);
    const Point3 &a = mesh.position[vertex[segment]], &b = mesh.position[vertex[segment + 1]];
    plan.inserted[segment].push_back({a + (b - a) * share, mesh.point_count++, static_cast<double>(j)});
  }

  // Vertices between two samples, in proportion to arc length.
  struct Knot {
    double arc, step;
    size_t after;  // the first vertex that comes later
  };
  std::vector<Knot> knot;
  for (size_t i = 0; i < vertex.size(); ++i) {
    if (plan.step[i] >= 0) knot.push_back({arc[i], plan.step[i], i + 1});
    if (i == segments) break;
    for (const Sample& s : plan.inserted[i])
      knot.push_back({places.at[static_cast<size_t>(std::lround(s.step))], s.step, i + 1});
  }
  for (size_t k = 0; k + 1 < knot.size(); ++k) {
    size_t last = knot[k].after;
    while (plan.step[last] < 0 && last < knot[k + 1].after) ++last;
    const double between = static_cast<double>(last - knot[k].after) + 1;
    for (size_t i = knot[k].after; i < last; ++i) {
      const double by_arc = std::clamp((arc[i] - knot[k].arc) / (knot[k + 1].arc - knot[k].arc), 0.0, 1.0);
      const double by_count = static_cast<double>(i - knot[k].after + 1) / between;
      plan.step[i] = knot[k].step + (1 - kSpread) * by_arc + kSpread * by_count;
    }
  }
  return plan;
}

void insert_run(RefinedMesh& mesh, const OutlinePath& path, const SeamPlan& plan, uint32_t steps,
                SampledOutline& outline) {
  const size_t segments = path.vertex.size() - 1;
  const auto along = [&](double seam_step) { return outline.steps + (path.reversed ? steps - seam_step : seam_step); };
  for (size_t i = 0; i < segments; ++i) {
    const size_t segment = path.reversed ? segments - 1 - i : i;
    outline.stop.push_back({path.vertex[i], along(plan.step[path.reversed ? segments - i : i])});
    std::vector<Sample> samples = plan.inserted[segment];
    if (path.reversed) std::reverse(samples.begin(), samples.end());
    for (const Sample& s : samples) {
      const uint32_t h = mesh.leaving[outline.stop.back().vertex];
      outline.stop.push_back({mesh.split_edge(h, s.position, s.point), along(s.step)});
    }
  }
  outline.steps += steps;
}

}  // namespace

std::vector<SampledOutline> insert_seam_samples(RefinedMesh& mesh, std::span<const Outline> outlines,
                                                std::span<const uint32_t> seam_steps,
                                                std::span<const SeamPlaces> places) {
  std::vector<SeamPlan> plan(seam_steps.size());
  std::vector<SampledOutline> sampled(outlines.size());
  for (size_t c = 0; c < outlines.size(); ++c) {
    for (const OutlinePath& path : outlines[c].path) {
      SeamPlan& seam = plan[path.seam];
      if (seam.step.empty()) {
        std::vector<uint32_t> vertex = path.vertex;
        if (path.reversed) std::reverse(vertex.begin(), vertex.end());
        const uint32_t steps = seam_steps[path.seam];
        seam = plan_seam(mesh, vertex, steps, places.empty() ? even_places(mesh, vertex, steps) : places[path.seam]);
      }
      insert_run(mesh, path, seam, seam_steps[path.seam], sampled[c]);
    }
  }
  return sampled;
}

}  // namespace geocloth
