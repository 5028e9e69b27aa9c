// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_check.h"

#include <fmt/format.h>

#include "geocloth/solver/intersections.h"
#include "scene_warnings.h"

namespace geocloth {
namespace {

constexpr uint64_t kFew = 20;  // pairs: sharp folds, which are left alone as what is near along the surface

std::string pairs_of(uint64_t count) {
  return fmt::format("{} pairs of its triangles cut through each other", count);
}

}  // namespace

LayerCheck::Tangles LayerCheck::look(Simulation& simulation) {
  const std::vector<ClothDesc>& cloths = simulation.cloths();
  Tangles tangles{.within = std::vector<uint64_t>(cloths.size(), 0)};
  std::vector<std::vector<Vec3>> positions(cloths.size());
  std::vector<PosedCloth> others;
  for (size_t c = 0; c < cloths.size(); ++c) {
    if (!cloths[c].self_collision && !cloths[c].inter_collision) continue;
    simulation.solver().read_positions(static_cast<uint32_t>(c), positions[c]);
    const PosedCloth posed{*cloths[c].asset, positions[c]};
    if (cloths[c].self_collision) tangles.within[c] = count_intersections({&posed, 1}).within;
    if (cloths[c].inter_collision) others.push_back(posed);
  }
  if (others.size() > 1) tangles.between = count_intersections(others).between;
  return tangles;
}

std::vector<std::string> LayerCheck::warnings(const Simulation& simulation) const {
  std::vector<std::string> warnings;
  for (size_t c = 0; c < start_.within.size(); ++c) {
    if (start_.within[c] <= kFew) continue;
    warnings.push_back(
        fmt::format("{}: {} as it begins, which \"self_collision\" does not draw apart; convert it with --untangle, "
                    "or leave out the inner layers with --parts",
                    name_of_cloth(simulation.scene(), c), pairs_of(start_.within[c])));
  }
  if (start_.between > kFew) {
    warnings.push_back(fmt::format(
        "cloths with \"inter_collision\" begin with {} pairs of triangles that cut through each other, which "
        "it does not draw apart; part them in the meshes, or let one begin wider",
        start_.between));
  }
  return warnings;
}

std::vector<std::string> LayerCheck::played_warnings(Simulation& simulation) const {
  const Tangles now = look(simulation);
  std::vector<std::string> warnings;
  for (size_t c = 0; c < now.within.size(); ++c) {
    if (now.within[c] <= start_.within[c] + kFew) continue;
    warnings.push_back(fmt::format(
        "{}: {} after the last frame ({} before the first one): layers got through each other; more "
        "\"substeps\" keep faster ones apart, and a wider \"distance\" of \"self_collision\" more stretched ones",
        name_of_cloth(simulation.scene(), c), pairs_of(now.within[c]), start_.within[c]));
  }
  if (now.between > start_.between + kFew) {
    warnings.push_back(fmt::format(
        "cloths with \"inter_collision\" have {} pairs of triangles that cut through each other after the last frame "
        "({} before the first one): they got through each other; more \"substeps\" keep faster ones apart, and a wider "
        "\"distance\" more stretched ones",
        now.between, start_.between));
  }
  return warnings;
}

}  // namespace geocloth
