// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp takes on trust of the objects of an FBX file. Between two keys that are more than half a turn apart it
// puts keys of its own, without end where they are at the same time or no numbers; and a bone that holds a point which
// its mesh has not ends the program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "import/file_points.h"

namespace geocloth::import_detail {

/// A record of the file with what it holds by itself.
struct FbxObject {
  int64_t id = 0;                      ///< 0: it has none
  std::string name = {};               ///< as its node will be called
  std::vector<FilePoint> points = {};  ///< of a geometry
  std::vector<int32_t> corners = {};   ///< of its faces: their points, of the last one of a face the complement
  uint32_t indices_end = 0;            ///< above all points that a cluster holds
  bool is_clip = false;                ///< it, or what it is in
  std::vector<int64_t> time;           ///< of the keys of a curve [ticks], 46,186,158,000 a second
  std::vector<float> value;            ///< of the same keys
};

class FbxObjects {
 public:
  explicit FbxObjects(const std::filesystem::path& file) : file_(file) {}

  /// Bytes of the file that are to be blanked, so that assimp passes over what it cannot read.
  std::vector<std::size_t> blanks;
  /// Those of each geometry, in the order of the file.
  std::vector<FilePoints> points;

  /// Refuses keys that assimp would not come to an end with, one curve after the other.
  /// @throws Error(invalid_data) or Error(limit)
  void add(FbxObject object);
  /// Refuses bones that hold points which their meshes have not, and two bones of one name in a skin: assimp ends the
  /// program over either.
  /// @param connections  pairs of parent and child, by their ids
  /// @throws Error(invalid_data)
  void check_bones(std::span<const std::array<uint64_t, 2>> connections) const;

 private:
  void check_keys(const FbxObject& object);

  const std::filesystem::path& file_;
  std::map<int64_t, std::size_t> point_count_;  ///< of geometries
  std::map<int64_t, uint32_t> indices_end_;     ///< of clusters
  std::map<int64_t, std::string> name_;         ///< of all
  double added_ = 0;                            ///< keys that assimp will put between the others, so far
};

/// Takes what a record of the binary form says of the one that it is in.
/// @param values    of it; an array is all there: its type, count, encoding, size and bytes
/// @param animated  whether keys are wanted
/// @throws Error(invalid_data) for what cannot be unpacked
void read_fbx_record(const std::filesystem::path& file, std::string_view name, std::string_view values, bool animated,
                     FbxObject& object);

/// What assimp reads animations by; under another name it leaves them alone.
inline constexpr std::string_view kFbxClip = "AnimationStack";

/// Whether properties of a type end the program when a node has them. Times matter in clips alone, colours with a share
/// nowhere.
[[nodiscard]] bool is_bad_type(std::string_view type, const FbxObject& of);

/// What assimp calls an object, by its name in the file.
[[nodiscard]] std::string fbx_name(std::string_view name);

/// The objects of the textual form, whose braces match.
void read_fbx_text(const std::filesystem::path& file, std::string_view text, bool animated, FbxObjects& objects);

}  // namespace geocloth::import_detail
