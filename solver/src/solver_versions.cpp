// SPDX-License-Identifier: Apache-2.0
// A cloth becomes another version of itself, which stays where it is: cut, torn, or of other materials.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "check_input.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "rest/cut_asset.h"
#include "rest/fabrics.h"
#include "rest/inter_points.h"
#include "rest/tear.h"
#include "rest/upload.h"
#include "solver_impl.h"

namespace geocloth {

CutResult Solver::Impl::cut(uint32_t cloth, const std::array<Vec3, 3>& triangle) {
  check_cut(triangle, name_of(cloth) + ": cut");
  Cloth& c = cloths_[cloth];
  std::vector<Vec3> position, normal;
  read_positions(cloth, position);
  read_normals(cloth, normal);
  CutCloth cut = cut_asset(*c.asset, {position, normal, c.scale}, triangle);
  if (cut.asset) take_cut(cloth, std::move(cut.asset));
  return cut.result;
}

CutResult Solver::Impl::tear(uint32_t cloth, float stretch) {
  check_tear(stretch, name_of(cloth));
  const Cloth& c = cloths_[cloth];
  std::vector<Vec3> position, normal;
  read_positions(cloth, position);
  const std::vector<StrainedSpring> springs = springs_that_tear(*c.asset, position, c.scale, stretch);
  if (springs.empty()) return {};
  read_normals(cloth, normal);
  const ClothPose pose{position, normal, c.scale};
  std::shared_ptr<const ClothAsset> torn;
  CutResult all;
  for (const StrainedSpring& spring : springs) {
    CutCloth cut = cut_asset(torn ? *torn : *c.asset, pose, blade_across(*c.asset, pose, spring));
    if (!cut.asset) continue;
    torn = std::move(cut.asset);
    all += cut.result;
  }
  if (torn) take_cut(cloth, std::move(torn));
  return all;
}

void Solver::Impl::take_cut(uint32_t cloth, std::shared_ptr<const ClothAsset> asset) {
  Cloth& c = cloths_[cloth];
  ClothData data = cloth_data(c, asset, c.material, c.fabrics);
  take_version(cloth, std::move(asset), std::move(data));
  c.pins_changed = true;  // attachments run around the cut
  c.disturbed = true;
  if (meets_others(c)) take_inter_anew();
}

void Solver::Impl::set_material(uint32_t cloth, const Material& material) {
  check(material, name_of(cloth) + ": material");
  const Cloth& c = cloths_[cloth];
  check_fabrics(material, c.fabrics, name_of(cloth));
  if (material != c.material) change_fabrics(cloth, Material(material), c.fabrics);
}

void Solver::Impl::set_fabric(uint32_t cloth, uint32_t fabric, const Material& material) {
  if (material == this->fabric(cloth, fabric)) return;
  const Cloth& c = cloths_[cloth];
  std::vector<Fabric> fabrics = c.fabrics;
  fabrics[fabric].material = material;
  check_fabrics(c.material, fabrics, name_of(cloth));
  change_fabrics(cloth, Material(c.material), std::move(fabrics));
}

const Material& Solver::Impl::fabric(uint32_t cloth, uint32_t fabric) const {
  const Cloth& c = cloths_[cloth];
  if (fabric < c.fabrics.size()) return c.fabrics[fabric].material;
  throw Error(ErrorCode::invalid_argument, name_of(cloth) + " has no fabric " + std::to_string(fabric) + ", only " +
                                               std::to_string(c.fabrics.size()));
}

Material Solver::Impl::weakest_of(const Cloth& cloth) {
  return FabricMap({.material = cloth.material, .fabrics = cloth.fabrics}, *cloth.original).weakest();
}

/// @param material  not one of the cloth's own: those change
void Solver::Impl::change_fabrics(uint32_t cloth, const Material& material, std::vector<Fabric> fabrics) {
  Cloth& c = cloths_[cloth];
  std::optional<ClothData> data;
  if (!make_same_data(material, c.material) || !make_same_data(fabrics, c.fabrics))
    data = cloth_data(c, c.asset, material, fabrics);
  const bool was_attached = stretch_limit(c) > 0;
  const Material before = std::exchange(c.material, material);
  c.fabrics = std::move(fabrics);
  c.weakest = weakest_of(c);
  c.disturbed = true;
  if (data || before.max_stretch != material.max_stretch)
    c.pins_changed = c.pins_changed || !c.fabrics.empty();  // see stretch_shares()
  if (data) {
    take_version(cloth, c.asset, std::move(*data));
    c.masses_changed = true;
    c.pins_changed = c.pins_changed || has_attachments(before) != has_attachments(material);
  }
  if (meets_others(c) && (data || before.friction != material.friction)) take_inter_anew();
  if (!was_attached && stretch_limit(c) > 0) ease_from_present(cloth);
}

/// Attachments that are there all of a sudden do not pull at once.
void Solver::Impl::ease_from_present(uint32_t cloth) {
  Cloth& c = cloths_[cloth];
  std::vector<Vec3> position;
  read_positions(cloth, position);
  const double stretch = measure_stretch(*c.asset, c.scale, position).max;
  if (std::isfinite(stretch)) c.limit = std::max(c.limit, static_cast<float>(stretch));
}

ClothData Solver::Impl::cloth_data(const Cloth& cloth, const std::shared_ptr<const ClothAsset>& asset,
                                   const Material& material, const std::vector<Fabric>& fabrics) const {
  return make_cloth_data({.asset = asset,
                          .material = material,
                          .transform = cloth.start,
                          .self_collision = cloth.self_collision,
                          .inter_collision = cloth.inter_collision,
                          .fabrics = fabrics},
                         origin_, *cloth.original);
}

/// The same cloth with other springs, masses or copies.
void Solver::Impl::take_version(uint32_t cloth, std::shared_ptr<const ClothAsset> asset, ClothData data) {
  Cloth& c = cloths_[cloth];
  c.asset = std::move(asset);
  c.free_inverse_mass = inverse_masses(data);
  c.row_of_pixel = split_rows(*c.asset);
  c.springs_per_sweep = data.springs_per_sweep;
  c.self = data.self.numbers;
  backend_->replace_topology(cloth, std::move(data));
}

void Solver::Impl::take_inter_anew() {
  take_inter(inter_data(versions(), origin_), origin_);
}

void Solver::Impl::take_inter(InterData inter, const Vec3& origin) {
  inter_ = inter.points.numbers;
  inter_origin_ = origin;
  backend_->replace_inter(std::move(inter));
}

}  // namespace geocloth
