// SPDX-License-Identifier: GPL-3.0-or-later
// Tutte's embedding (Tutte 1963; Floater 1997 for the weights) over a circle, which holds any disk without flips.
#include "develop/round_chart.h"

#include <cmath>
#include <numbers>
#include <string>
#include <unordered_map>

#include "develop/disk_embedding.h"
#include "geocloth/asset/error.h"

namespace geocloth {

RoundChart lay_out_round(const RefinedMesh& mesh, std::span<const uint32_t> triangles, const SampledOutline& outline) {
  RoundChart chart;
  std::unordered_map<uint32_t, uint32_t> local;
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  std::vector<uint8_t> fixed;
  for (const uint32_t t : triangles) {
    Triangle corners{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = mesh.triangle[t][k];
      const auto [place, is_new] = local.try_emplace(v, static_cast<uint32_t>(chart.vertex.size()));
      corners[k] = place->second;
      if (!is_new) continue;
      chart.vertex.push_back(v);
      position.push_back(mesh.position[v]);
      fixed.push_back(mesh.leaving[v] != kNone ? 1 : 0);
    }
    triangle.push_back(corners);
  }

  const double radius = outline.steps / (2 * std::numbers::pi);
  chart.uv.assign(chart.vertex.size(), Point2{0, 0});
  for (const OutlineStop& stop : outline.stop) {
    const double angle = stop.step / radius;
    chart.uv[local.at(stop.vertex)] = {radius * std::cos(angle), radius * std::sin(angle)};
  }
  for (const auto weights : {DiskEmbedding::Weights::mean_value, DiskEmbedding::Weights::uniform}) {
    const DiskEmbedding embedding(position, triangle, fixed, weights);
    embedding.solve(chart.uv);
    if (std::isfinite(embedding.l2_stretch(chart.uv))) return chart;
  }
  throw Error(ErrorCode::verification, "a scrap of " + std::to_string(triangle.size()) +
                                           " triangles cannot be laid flat in double precision; remesh it with "
                                           "triangles of more even size");
}

}  // namespace geocloth
