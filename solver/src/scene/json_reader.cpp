// SPDX-License-Identifier: Apache-2.0
// JSON with a path on every complaint. nlohmann-json's own exceptions are translated here and nowhere else.

#include "scene/json_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace geocloth {
namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row.back();
}

/// Refuses keys that appear twice: JSON leaves open which of them counts.
class DuplicateKeys {
 public:
  explicit DuplicateKeys(const std::string& name) : name_(name) {}
  bool operator()(int /*depth*/, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) keys_.emplace_back();
    if (event == Event::object_end && !keys_.empty()) keys_.pop_back();
    if (event == Event::key && !keys_.empty() && !keys_.back().insert(parsed.get<std::string>()).second) {
      throw Error(ErrorCode::invalid_data,
                  name_ + ": the key " + in_quotes(parsed.get<std::string>()) + " appears twice in one object");
    }
    return true;
  }

 private:
  std::string name_;
  std::vector<std::set<std::string>> keys_;
};

/// "parse error at line 3, column 7: ..." without the library's number in front.
std::string reason(const nlohmann::json::exception& error) {
  const std::string what = error.what();
  const size_t end = what.find("] ");
  std::string text = end == std::string::npos ? what : what.substr(end + 2);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20; }, ' ');
  return text;
}

}  // namespace

std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& list) {
  constexpr size_t kLongest = 64, kTelling = 4;  // letters: fewer begin many words
  word = word.substr(0, kLongest);
  std::string_view best;
  size_t least = std::max<size_t>(1, word.size() / 3) + 1;
  for (const std::string_view candidate : list) {
    // "rotate" means "rotate_deg", although "time" is as few edits away; "streach" means "stretch_warp".
    size_t edits = edit_distance(word, candidate);
    if (word.size() > kTelling) edits = std::min(edits, edit_distance(word, candidate.substr(0, word.size())));
    if (word.size() >= kTelling && candidate.find(word) != std::string_view::npos) edits = std::min<size_t>(edits, 1);
    if (!word.empty() && candidate.starts_with(word)) edits = 0;
    if (edits < least) {
      least = edits;
      best = candidate;
    }
  }
  return best;
}

std::string listed(const std::vector<std::string_view>& list) {
  std::string text;
  for (const std::string_view word : list) text += (text.empty() ? "" : ", ") + std::string(word);
  return text;
}

std::string in_quotes(std::string_view text) {
  constexpr size_t kLongest = 60;
  std::string out = "\"";
  for (const char c : text.substr(0, kLongest)) out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return out + (text.size() > kLongest ? "...\"" : "\"");
}

std::string nearest_and_all(std::string_view word, const std::vector<std::string_view>& list) {
  const std::string_view nearest = nearest_word(word, list);
  return (nearest.empty() ? "; all are " : "; the nearest is \"" + std::string(nearest) + "\", all are ") +
         listed(list);
}

nlohmann::json JsonReader::parse(std::string_view text, const std::string& name) {
  try {
    return nlohmann::json::parse(text, DuplicateKeys(name));
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::invalid_data, name + ": not valid JSON: " + reason(error));
  }
}

void JsonReader::fail(const std::string& what, ErrorCode code) const {
  throw Error(code, where() + ": " + what);
}

void JsonReader::expect_object(const std::vector<std::string_view>& known_keys) const {
  if (!value_->is_object()) fail("must be an object, not " + std::string(value_->type_name()));
  for (const auto& [key, value] : value_->items()) {
    if (std::find(known_keys.begin(), known_keys.end(), key) != known_keys.end()) continue;
    const std::string_view nearest = nearest_word(key, known_keys);
    fail("unknown key " + in_quotes(key) +
         (nearest.empty() ? "; known are " + listed(known_keys)
                          : "; the nearest known one is \"" + std::string(nearest) + "\""));
  }
}

JsonReader JsonReader::at(std::string_view key) const {
  if (!has(key)) fail("the key \"" + std::string(key) + "\" is missing");
  return {(*value_)[std::string(key)], name_, (path_.empty() ? "" : path_ + ".") + std::string(key)};
}

std::vector<JsonReader> JsonReader::elements() const {
  if (!value_->is_array()) fail("must be an array, not " + std::string(value_->type_name()));
  std::vector<JsonReader> list;
  for (size_t i = 0; i < value_->size(); ++i) {
    list.push_back({(*value_)[i], name_, path_ + "[" + std::to_string(i) + "]"});
  }
  return list;
}

double JsonReader::number() const {
  if (!value_->is_number()) fail("must be a number, not " + std::string(value_->type_name()));
  const auto value = value_->get<double>();
  if (!std::isfinite(value)) fail("must be a finite number");
  return value;
}

float JsonReader::real() const {
  const double value = number();
  if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
    fail("is beyond the range of single precision");
  }
  return static_cast<float>(value);
}

uint32_t JsonReader::count(uint32_t low, uint32_t high) const {
  const double value = number();
  if (value != std::floor(value) || value < low || value > high) {
    fail("must be a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return static_cast<uint32_t>(value);
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) fail("must be true or false, not " + std::string(value_->type_name()));
  return value_->get<bool>();
}

std::string JsonReader::text() const {
  if (!value_->is_string()) fail("must be a string, not " + std::string(value_->type_name()));
  auto text = value_->get<std::string>();
  if (text.find('\0') != std::string::npos) fail("must not hold a zero character, where names of files end");
  return text;
}

Vec3 JsonReader::vector() const {
  const std::vector<JsonReader> list = elements();
  if (list.size() != 3) fail("must be three numbers [x, y, z], not " + std::to_string(list.size()));
  return {list[0].real(), list[1].real(), list[2].real()};
}

}  // namespace geocloth
