// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "import/assimp_file.h"
#include "import/node_animation.h"

namespace geocloth::import_detail {

/// The nodes of a scene by their names; of several of one name the first.
using NodesByName = std::map<std::string, std::size_t, std::less<>>;

/// How many animations a file has. COLLADA has one time line: whatever moves in a DAE file is one animation.
[[nodiscard]] std::size_t count_clips(const AssimpFile& file);

/// An animation of a file as assimp read it, between whose keys it goes evenly.
/// @param clip     as of find_clip()
/// @param targets  how many morph targets each node has
/// @throws Error(invalid_data) when there is none, or when it is broken
[[nodiscard]] NodeAnimation read_assimp_animation(const std::filesystem::path& path, const AssimpFile& file,
                                                  const std::string& clip, const NodesByName& nodes,
                                                  std::span<const std::size_t> targets);

}  // namespace geocloth::import_detail
