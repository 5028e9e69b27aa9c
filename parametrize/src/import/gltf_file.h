// SPDX-License-Identifier: GPL-3.0-or-later
// The JSON of a glTF file with checked access: every message names the file and the element.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace geocloth::import_detail {

class GltfFile {
 public:
  using Json = nlohmann::json;
  using Bytes = std::span<const std::byte>;

  /// @param bytes  of the file; must outlive this object
  /// @param binary the file is a GLB container (glTF 2.0, section 4)
  /// @throws Error(invalid_data, unsupported) when it is no glTF 2.0 file
  GltfFile(const std::filesystem::path& file, Bytes bytes, bool binary);

  [[noreturn]] void bad(const std::string& what) const;

  /// json[name], an array of objects as those of glTF 2.0 are; empty when it is missing.
  [[nodiscard]] const Json& array(const char* name) const;
  /// object[key] as a whole number, or `otherwise` when it is missing.
  [[nodiscard]] std::size_t number(const Json& object, const char* key, const std::string& where,
                                   std::optional<std::size_t> otherwise = std::nullopt) const;
  /// A value that counts elements of json[target].
  [[nodiscard]] std::size_t index(const Json& value, const char* target, const std::string& where) const;
  /// Index in object[key], or nothing when the key is missing.
  [[nodiscard]] std::optional<std::size_t> reference(const Json& object, const char* key, const char* target,
                                                     const std::string& where) const;
  /// object.extensions[name], or null.
  [[nodiscard]] const Json* extension(const Json& object, const char* name, const std::string& where) const;
  void check_numbers(const Json& object, const char* key, std::size_t count, const std::string& where) const;
  void check_name(const Json& object, const std::string& where) const;

  std::filesystem::path path;
  Json json;
  std::optional<Bytes> binary_chunk;

 private:
  std::string_view split_container(Bytes bytes);
  void check_nesting(std::string_view text) const;
  [[nodiscard]] std::size_t whole(const Json& value, const std::string& where) const;
  void check_version() const;
  void check_objects(const std::string& name, const Json& value) const;
};

/// "nodes[3]"
[[nodiscard]] inline std::string label(const char* name, std::size_t i) {
  return std::string(name) + "[" + std::to_string(i) + "]";
}

}  // namespace geocloth::import_detail
