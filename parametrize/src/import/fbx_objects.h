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
#include <string_view>
#include <vector>

namespace geocloth::import_detail {

/// A record of the file with what it holds by itself.
struct FbxObject {
  int64_t id = 0;             ///< 0: it has none
  std::size_t points = 0;     ///< of a geometry
  uint32_t indices_end = 0;   ///< above all points that a cluster holds
  std::vector<int64_t> time;  ///< of the keys of a curve [ticks], 46,186,158,000 a second
  std::vector<float> value;   ///< of the same keys
};

class FbxObjects {
 public:
  explicit FbxObjects(const std::filesystem::path& file) : file_(file) {}

  /// Refuses keys that assimp would not come to an end with, one curve after the other.
  /// @throws Error(invalid_data) or Error(limit)
  void add(const FbxObject& object);
  /// Refuses bones that hold points which their meshes have not.
  /// @param connections  pairs of parent and child, by their ids
  /// @throws Error(invalid_data)
  void check_bones(std::span<const std::array<uint64_t, 2>> connections) const;

 private:
  void check_keys(const FbxObject& object);

  const std::filesystem::path& file_;
  std::map<int64_t, std::size_t> points_;    ///< of geometries
  std::map<int64_t, uint32_t> indices_end_;  ///< of clusters
  double added_ = 0;                         ///< keys that assimp will put between the others, so far
};

/// Takes what a record of the binary form says of the one that it is in.
/// @param values    of it; an array is all there: its type, count, encoding, size and bytes
/// @param animated  whether keys are wanted
/// @throws Error(invalid_data) for what cannot be unpacked
void read_fbx_record(const std::filesystem::path& file, std::string_view name, std::string_view values, bool animated,
                     FbxObject& object);

/// The objects of the textual form, whose braces match.
void read_fbx_text(const std::filesystem::path& file, std::string_view text, bool animated, FbxObjects& objects);

}  // namespace geocloth::import_detail
