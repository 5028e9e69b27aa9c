// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geocloth/parametrize/seams.h"

namespace geocloth {

/// Writes every intermediate of a conversion as a file as soon as it exists, so that a stage that fails can be looked
/// at; does nothing when the folder is empty.
///   1_import.obj 2_clean.obj 3_cut.obj   surfaces; groups are parts, components, components
///   4_flat.obj                           charts; texture coordinates are the place in the atlas
///   5_image.obj 5_splits.csv             grid with the copies apart; one line for every copy of a split vertex
///   6_welded.obj                         grid with the copies merged
class StageFiles {
 public:
  /// @throws Error(io) when the folder cannot be made
  explicit StageFiles(std::filesystem::path folder);

  void save(const TriangleMesh& mesh) const;
  void save(const CleanSurface& surface) const;
  void save(const CutSurface& surface) const;
  void save(const FlatSurface& flat) const;
  void save(const ClothAsset& asset) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace geocloth
