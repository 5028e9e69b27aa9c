// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "glb.h"

namespace geocloth::glb {

/// Typed access to the JSON and the buffer views of a file that nobody vouches for. Every failure is an Error
/// (invalid_data) that names the file and the member. The bytes taken are counted: all together they may not be more
/// than the binary chunk holds, so that a small file cannot name one buffer view a thousand times.
class Reader {
 public:
  /// @param container  must outlive the reader
  Reader(const Container& container, std::string name);

  [[noreturn]] void refuse(const std::string& what) const;

  [[nodiscard]] const Json& root() const { return json_; }
  /// The member, or null when there is none (or the value is no object).
  [[nodiscard]] static const Json* find(const Json& object, const char* key);
  [[nodiscard]] const Json& member(const Json& object, const char* key) const;
  [[nodiscard]] const Json& array(const Json& object, const char* key) const;
  /// An element of an array of the glTF root.
  [[nodiscard]] const Json& element(const char* key, uint64_t index) const;
  [[nodiscard]] uint64_t number(const Json& object, const char* key, uint64_t max = 0xFFFFFFFFU) const;
  [[nodiscard]] uint64_t number_or_zero(const Json& object, const char* key) const;
  [[nodiscard]] uint32_t number32(const Json& object, const char* key) const;
  [[nodiscard]] float real(const Json& value, const char* what) const;
  [[nodiscard]] std::string text(const Json& value, const char* what) const;
  [[nodiscard]] std::string text_or_empty(const Json& object, const char* key) const;

  /// The buffer view that object[key] names as values. @param count  as many as there must be
  template <class T>
  std::vector<T> values(const Json& object, const char* key, uint64_t count) {
    const auto bytes = view(object, key);
    if (bytes.size() % sizeof(T) != 0 || bytes.size() / sizeof(T) != count) {
      refuse(std::string("\"") + key + "\" has " + std::to_string(bytes.size()) + " bytes instead of " +
             std::to_string(count) + " x " + std::to_string(sizeof(T)));
    }
    return copy<T>(bytes);
  }
  /// As many values as the view holds.
  template <class T>
  std::vector<T> values(const Json& object, const char* key) {
    const auto bytes = view(object, key);
    if (bytes.size() % sizeof(T) != 0) refuse(std::string("\"") + key + "\" has a broken last element");
    return copy<T>(bytes);
  }
  /// The accessor that object[key] names: floats, two or three to a tuple for Vec2 and Vec3.
  template <class T>
  std::vector<T> floats(const Json& object, const char* key) {
    constexpr const char* kType = sizeof(T) == 4 ? "SCALAR" : sizeof(T) == 8 ? "VEC2" : "VEC3";
    return copy<T>(accessor(object, key, kType, kFloat, sizeof(T)));
  }
  /// The accessor that object[key] names: triangle corners of 16 or 32 bits. Not checked against the vertices.
  std::vector<Triangle> triangles(const Json& object, const char* key);

  /// As Builder::add_materials wrote them; image indices are those of the file.
  [[nodiscard]] std::vector<SourceMaterial> materials() const;
  SourceImage image(uint64_t index);

 private:
  static constexpr uint32_t kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;

  template <class T>
  static std::vector<T> copy(std::span<const std::byte> bytes) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> result(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
  [[nodiscard]] std::span<const std::byte> view(const Json& object, const char* key);
  [[nodiscard]] std::span<const std::byte> accessor(const Json& object, const char* key, const char* type,
                                                    uint32_t component, std::size_t element_size);
  [[nodiscard]] std::span<const std::byte> locate_view(const Json& description, const char* key) const;
  void take(uint64_t bytes);
  [[nodiscard]] SourceMaterial material(const Json& json) const;
  [[nodiscard]] std::optional<uint32_t> texture_image(const Json& material, const char* key) const;

  const Json& json_;
  std::span<const std::byte> binary_;
  std::string name_;
  uint64_t budget_;  ///< [bytes] of the binary chunk that nobody has taken
};

}  // namespace geocloth::glb
