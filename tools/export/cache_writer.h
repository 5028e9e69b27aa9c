// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "export/frame_writer.h"

namespace geocloth {

/// What a cache is a cache of.
struct CacheDescription {
  std::vector<std::shared_ptr<const ClothAsset>> cloths;
  double frame_rate = 60;    ///< [1/s]
  uint32_t frame_count = 0;  ///< frames to come after frame 0, as far as known; sizes are planned with it
  bool each_part = false;    ///< point caches: one for each part of a garment, of its vertices alone
};

/// A writer that needs nothing of the simulation but the state of its cloths.
class CacheWriter : public FrameWriter {
 public:
  /// The next frame, one entry per cloth; the first is frame 0, the state before the first step.
  virtual void add(std::span<const ClothSnapshot> cloths) = 0;
  void add_frame(Simulation&, std::span<const ClothSnapshot> cloths) final { add(cloths); }
};

/// A writer by the ending of the path, or null for another ending. Several cloths are told apart as written below.
///   .glb  animated glTF: the garments with their materials; morph targets, played by three.js and Blender; a node each
///   .usda  animated USD as text (Omniverse, Houdini, Maya, Unreal): a mesh each, with samples for every frame
///   .obj  a numbered file per frame, out_0001.obj ...; an object each
///   .pc2, .mdd  point caches (Blender, Maya, LightWave); out_1.pc2, out_2.pc2 ... when there are several; of each part
///         out_Sleeve.pc2, out_1_Sleeve.pc2 ...
///   .exr  numbered vertex-animation textures of the grid, RGB = position [m], A = 1 where a pixel is valid;
///         out_1_0001.exr ... when there are several
/// Points of .usda, .obj, .pc2 and .mdd stand in the order of the vertices of the source file, in metres, y up.
/// Vertices that were added where its triangles were divided stand behind them, and are not in .pc2 and .mdd. The
/// caches .glb, .usda, .pc2 and .mdd begin with frame 0; numbered files begin with frame 1.
[[nodiscard]] std::unique_ptr<CacheWriter> make_cache_writer(const std::filesystem::path& path,
                                                             const CacheDescription& description);
/// What all frames of a simulation are.
[[nodiscard]] CacheDescription describe(const Simulation& simulation);

/// The names that an output has on the disk: one for each cloth where the format holds only one, else its own. Those of
/// a numbered series stand for its files, and that of a cloth for those of its parts.
[[nodiscard]] std::vector<std::filesystem::path> output_names(const std::filesystem::path& path,
                                                              std::size_t cloth_count);
/// With the names of the files of parts.
[[nodiscard]] std::vector<std::filesystem::path> output_names(const std::filesystem::path& path,
                                                              const CacheDescription& description);

}  // namespace geocloth
