// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// The glTF extension that holds the geometry image; its specification is solver/asset/GEOCLOTH_geometry_image.md.
inline constexpr const char* kAssetExtension = "GEOCLOTH_geometry_image";

/// Writes an asset as glTF 2.0 binary: the source mesh as every viewer reads it, the cloth data behind the extension.
/// Same asset, same bytes. @throws Error(invalid_data) if validate() refuses the asset
[[nodiscard]] std::vector<std::byte> encode_asset(const ClothAsset& asset);

/// Reads what encode_asset wrote. Safe for hostile bytes: bounds-checked, validated, memory bounded by the input size.
/// @param name  used in messages, usually the path
/// @throws Error(invalid_data) for anything broken, Error(unsupported) for a glTF without the extension
[[nodiscard]] ClothAsset decode_asset(std::span<const std::byte> bytes, const std::string& name);

/// File forms of the two above. Writing is atomic: the file appears whole or not at all.
/// @throws Error(io) when the file cannot be opened, read or written
void write_asset(const ClothAsset& asset, const std::filesystem::path& path);
[[nodiscard]] ClothAsset read_asset(const std::filesystem::path& path);

}  // namespace geocloth
