// SPDX-License-Identifier: Apache-2.0
#include "scene/start.h"

#include <optional>
#include <span>
#include <sstream>
#include <string>

#include "check_input.h"
#include "colliders/reach.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/solver/pixel_binding.h"

namespace geocloth {
namespace {

/// [m] Diagonal of the bounds of all pixels.
double size_of(const ClothAsset& asset, std::span<const Vec3> position) {
  ClothBox box;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) box.add(position[p]);
  return box.empty() ? 0 : double{length(box.high - box.low)};
}

/// From the points of a file to the pixels.
class FilePixels {
 public:
  FilePixels(const SceneStart& start, const ClothDesc& cloth, const PosedVertices& file)
      : start_(start), cloth_(cloth) {
    const ClothAsset& asset = *cloth.asset;
    const size_t points = file.position.size();
    const bool may_be_mesh = points == asset.source.file_vertex_count() || points == asset.source.source_vertex_count;
    // A grid may have as many vertices as the mesh, in another order; only its triangles tell then.
    if (!may_be_mesh || !file.triangle.empty()) grid_ = welded_grid_mesh(asset, asset.rest_position);
    by_grid_ = !may_be_mesh || (points == grid_.pixel.size() && file.triangle == grid_.triangle);
    if (!by_grid_ || points == grid_.pixel.size()) {
      binding_.emplace(by_grid_ ? PixelBinding(asset, asset) : PixelBinding(asset));
      return;
    }
    throw Error(ErrorCode::invalid_data, start.file.string() + ": has " + std::to_string(points) +
                                             " vertices, and the mesh that the asset was converted from has " +
                                             std::to_string(asset.source.file_vertex_count()) + " (its grid " +
                                             std::to_string(grid_.pixel.size()) +
                                             "); it must be the same mesh, with its vertices in the same order");
  }

  /// [m] Where the points have all pixels.
  [[nodiscard]] std::vector<Vec3> positions(std::span<const Vec3> points) const {
    std::vector<Vec3> placed;
    placed.reserve(points.size());
    for (const Vec3& p : points) {
      placed.push_back(apply(start_.transform, p));
      check_position(placed.back(), start_.file.string() + ": vertex " + std::to_string(placed.size() - 1));
    }
    const ClothAsset& asset = *cloth_.asset;
    std::vector<Vec3> known, out;
    if (!by_grid_) {
      if (placed.size() == asset.source.file_vertex_count()) add_middles(asset.source, placed);
      for (const uint32_t v : asset.source.source_vertex) known.push_back(placed[v]);
      binding_->evaluate(known, out, cloth_.transform.scale);
      return out;
    }
    // The grid mesh has no pixels that no cell is at; these go along with what is nearest.
    known.resize(asset.pixel_count());
    std::vector<bool> told(asset.pixel_count());
    for (size_t k = 0; k < placed.size(); ++k) {
      known[grid_.pixel[k]] = placed[k];
      told[grid_.pixel[k]] = true;
    }
    const std::vector<uint32_t> first = first_copies(asset);
    for (uint32_t p = 0; p < known.size(); ++p) known[p] = known[first[p]];
    binding_->evaluate(known, out, cloth_.transform.scale);
    for (uint32_t p = 0; p < known.size(); ++p)
      if (asset.valid(p) && told[first[p]]) out[p] = known[p];
    return out;
  }

 private:
  const SceneStart& start_;
  const ClothDesc& cloth_;
  GridMesh grid_;
  bool by_grid_ = false;                 ///< or by the vertices of the mesh
  std::optional<PixelBinding> binding_;  ///< to those points
};

void check_unit(const SceneStart& start, const ClothDesc& cloth, std::span<const Vec3> position) {
  constexpr double kOtherUnit = 8;  // times as large or small: no pose is, and units that are mixed up are 10 times
  const double size = size_of(*cloth.asset, position);
  const double rest = double{cloth.transform.scale} * size_of(*cloth.asset, cloth.asset->rest_position);
  if (size <= kOtherUnit * rest && size * kOtherUnit >= rest) return;
  std::ostringstream text;
  text << start.file.string() << ": is " << size << " m across there, and the cloth " << rest
       << " m at rest; give the unit of the file, \"transform\": { \"scale\": "
       << double{start.transform.scale} * rest / size << " } or so";
  throw Error(ErrorCode::invalid_data, text.str());
}

}  // namespace

StartState start_state(const SceneStart& start, const ClothDesc& cloth, const ReadVertices& read, double frame_rate) {
  if (!read) throw Error(ErrorCode::unsupported, "this program reads no starts");
  const PosedVertices file = read(start);
  const FilePixels pixels(start, cloth, file);
  StartState state{pixels.positions(file.position), std::vector<Vec3>(cloth.asset->pixel_count())};
  check_unit(start, cloth, state.position);
  if (!start.moving) return state;
  if (file.before.empty()) {
    throw Error(ErrorCode::invalid_data, start.file.string() +
                                             ": has no frame before, that \"moving\" could be told from; it takes a "
                                             "point cache, and a frame from 1 on");
  }
  const std::vector<Vec3> before = pixels.positions(file.before);
  const auto rate = static_cast<float>(file.rate.value_or(frame_rate) / file.step);
  for (size_t p = 0; p < before.size(); ++p) {
    state.velocity[p] = rate * (state.position[p] - before[p]);
    check_position(state.velocity[p], start.file.string() + ": the speed from the frame before");
  }
  return state;
}

}  // namespace geocloth
