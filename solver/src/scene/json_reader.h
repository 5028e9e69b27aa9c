// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "geocloth/asset/error.h"
#include "geocloth/asset/vec.h"

namespace geocloth {

/// The word of a list that another one was most likely meant to be: one edit away, or a third of its length; empty when
/// there is none.
[[nodiscard]] std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& list);

/// "a, b, c"
[[nodiscard]] std::string listed(const std::vector<std::string_view>& list);

/// A user's text for a message: short, on one line, in quotation marks.
[[nodiscard]] std::string in_quotes(std::string_view text);
/// How a message goes on that there is no such word.
[[nodiscard]] std::string nearest_and_all(std::string_view word, const std::vector<std::string_view>& list);

/// A place in a JSON document that knows its path, so that every complaint can name it: "scene.json:
/// colliders[0].radius: must be a number, not a string". All readers throw Error(invalid_data).
class JsonReader {
 public:
  /// Parses a document; keys that appear twice in an object are refused. `name` is the file in messages.
  static nlohmann::json parse(std::string_view text, const std::string& name);

  JsonReader(const nlohmann::json& value, std::string name) : value_(&value), name_(std::move(name)) {}

  [[nodiscard]] std::string where() const { return path_.empty() ? name_ : name_ + ": " + path_; }
  [[noreturn]] void fail(const std::string& what, ErrorCode code = ErrorCode::invalid_data) const;

  /// This must be an object and have no other keys than these.
  void expect_object(const std::vector<std::string_view>& known_keys) const;
  [[nodiscard]] bool has(std::string_view key) const { return value_->contains(key); }
  [[nodiscard]] JsonReader at(std::string_view key) const;  ///< refuses a missing key
  [[nodiscard]] std::vector<JsonReader> elements() const;   ///< this must be an array
  [[nodiscard]] bool is_string() const { return value_->is_string(); }
  [[nodiscard]] bool is_object() const { return value_->is_object(); }
  [[nodiscard]] bool is_array() const { return value_->is_array(); }

  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] float real() const;     ///< a number within the range of float
  [[nodiscard]] uint32_t count(uint32_t low, uint32_t high) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  [[nodiscard]] Vec3 vector() const;  ///< [x, y, z]

  /// Sets `value` if the key is there.
  void read(std::string_view key, float& value) const {
    if (has(key)) value = at(key).real();
  }
  void read(std::string_view key, Vec3& value) const {
    if (has(key)) value = at(key).vector();
  }
  void read(std::string_view key, std::string& value) const {
    if (has(key)) value = at(key).text();
  }

 private:
  JsonReader(const nlohmann::json& value, std::string name, std::string path)
      : value_(&value), name_(std::move(name)), path_(std::move(path)) {}

  const nlohmann::json* value_;
  std::string name_, path_;
};

}  // namespace geocloth
