// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of FBX animations ahead of assimp, which puts keys of its own between two that are more than half a turn
// apart, without end where they are at the same time or no numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

namespace geocloth::import_detail {

/// The keys of one curve.
struct FbxCurve {
  std::vector<int64_t> time;  ///< ticks, 46,186,158,000 a second
  std::vector<float> value;
};

class FbxCurveCheck {
 public:
  explicit FbxCurveCheck(const std::filesystem::path& file) : file_(file) {}

  /// Refuses keys that assimp would not come to an end with, one curve after the other.
  /// @throws Error(invalid_data) or Error(limit)
  void add(const FbxCurve& curve);

 private:
  const std::filesystem::path& file_;
  double added_ = 0;  ///< keys that assimp will put between the others, so far
};

/// Takes the keys from a record of the binary form, if it has some.
/// @param array  what the record holds; an array is all there: its type, count, encoding, size and bytes
/// @throws Error(invalid_data) for what cannot be unpacked
void read_fbx_keys(const std::filesystem::path& file, std::string_view name, std::string_view array, FbxCurve& curve);

/// Checks the curves of the textual form, whose braces match.
void check_text_curves(const std::filesystem::path& file, std::string_view text);

}  // namespace geocloth::import_detail
