// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace geocloth::meshes {

/// A figure 1.8 m tall of pieces that go into one another at their joints, as a glTF file (.glb). It opens with its
/// arms held out, and its animation "walk" is one stride on the spot, which closes.
[[nodiscard]] std::vector<std::byte> make_walker();

}  // namespace geocloth::meshes
