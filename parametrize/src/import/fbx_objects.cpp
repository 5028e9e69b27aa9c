// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/fbx_objects.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include <zlib.h>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr double kHalfTurn = 179;   ///< [degrees] of the keys that assimp puts between two
constexpr double kFewestTicks = 2;  ///< between such keys, so that it comes forward
constexpr double kMaxAdded = 1e7;   ///< keys of a file
constexpr std::string_view kBetweenWords = " \t\r\n,";

template <typename T>
std::vector<T> unpacked(const std::filesystem::path& file, std::string_view values) {
  const std::size_t count = read_le<uint32_t>(values, 0), stored = read_le<uint32_t>(values, 8);
  const bool packed = read_le<uint32_t>(values, 4) != 0;
  std::vector<T> out(count);
  if (count == 0) return out;
  const char* from = values.data() + 12;
  uLongf size = count * sizeof(T);
  if (!packed) {
    std::memcpy(out.data(), from, size);
    return out;
  }
  const int result = uncompress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(from),
                                static_cast<uLong>(stored));
  if (result != Z_OK || size != count * sizeof(T)) bad(file, "an array cannot be unpacked");
  return out;
}

/// @param number  three for each place
template <typename Number>
std::vector<FilePoint> places_of(const std::vector<Number>& number) {
  std::vector<FilePoint> out;
  out.reserve(number.size() / 3);
  for (std::size_t i = 0; i + 2 < number.size(); i += 3) {
    out.push_back(
        {static_cast<float>(number[i]), static_cast<float>(number[i + 1]), static_cast<float>(number[i + 2])});
  }
  return out;
}

/// One above the largest of some indices.
uint32_t end_of(const std::vector<int32_t>& indices) {
  uint32_t end = 0;
  for (const int32_t i : indices) end = std::max(end, i < 0 ? UINT32_MAX : static_cast<uint32_t>(i) + 1);
  return end;
}

/// Walks the words of the textual form, which are names, numbers, quoted texts and braces.
class TextReader {
 public:
  TextReader(const std::filesystem::path& file, std::string_view text, bool animated)
      : file_(file), text_(text), animated_(animated) {}

  void read(FbxObjects& objects) {
    std::vector<FbxObject> open(1);
    int64_t id = 0;  // first number behind the last name
    std::string name;
    std::string_view head;  // the last name
    bool named = false, numbered = false;
    std::size_t texts = 0;  // behind the last name
    for (std::string_view word = next(); !word.empty(); word = next()) {
      FbxObject& object = open.back();
      if (word == "Vertices:") {
        object.points = places();
      } else if (word == "PolygonVertexIndex:") {
        object.corners = numbers<int32_t>();
      } else if (word == "Indexes:") {
        object.indices_end = end_of(numbers<int32_t>());
      } else if (animated_ && word == "KeyTime:") {
        object.time = numbers<int64_t>();
      } else if (animated_ && word == "KeyValueFloat:") {
        object.value = numbers<float>();
      } else if (word == "{") {
        FbxObject inner;
        inner.is_clip = object.is_clip || is_clip(head);
        if (is_clip(head) && !animated_) objects.blanks.push_back(offset_of(head));
        if (open.size() == kDepthOfObjects) {
          inner.id = id;
          inner.name = name;
        }
        open.push_back(std::move(inner));
      } else if (word == "}") {
        objects.add(std::move(object));
        open.pop_back();
        if (open.empty()) bad(file_, "its braces do not match");
      } else if (word.size() > 2 && word[0] == '"' && ++texts == 2 && head == "P:") {
        const std::string_view type = word.substr(1, word.size() - 2);
        if (is_bad_type(type, object)) objects.blanks.push_back(offset_of(type));
      }
      if (numbered && word.size() > 1 && word[0] == '"') name = fbx_name(word.substr(1, word.size() - 2));
      numbered = named && std::from_chars(word.data(), word.data() + word.size(), id).ec == std::errc();
      named = word.ends_with(':');
      if (!named && word != "{") continue;
      head = word;
      texts = 0;
      id = 0;
      name.clear();
    }
    objects.add(std::move(open.back()));
  }

 private:
  static constexpr std::size_t kDepthOfObjects = 2;  ///< open blocks about one

  static bool is_clip(std::string_view head) {
    return head.ends_with(':') && head.substr(0, head.size() - 1) == kFbxClip;
  }
  [[nodiscard]] std::size_t offset_of(std::string_view word) const {
    return static_cast<std::size_t>(word.data() - text_.data());
  }

  std::string_view next() {
    at_ = text_.find_first_not_of(kBetweenWords, at_);
    while (at_ < text_.size() && text_[at_] == ';') {
      at_ = text_.find_first_not_of(kBetweenWords, std::min(text_.find('\n', at_), text_.size()));
    }
    if (at_ >= text_.size()) return {};
    const std::size_t first = at_;
    if (text_[first] == '"') {
      at_ = std::min(text_.find('"', first + 1), text_.size() - 1) + 1;
    } else if (text_[first] == '{' || text_[first] == '}') {
      ++at_;
    } else {
      at_ = std::min(text_.find_first_of(" \t\r\n,{}\";:", first), text_.size());
      if (at_ < text_.size() && text_[at_] == ':') ++at_;
    }
    at_ = std::max(at_, first + 1);
    return text_.substr(first, at_ - first);
  }

  /// All of an array, "*2 { a: 0,90 }"; of what is none, as the files before version 7 have it, nothing.
  template <typename Take>
  void for_numbers(const Take& take) {
    const std::size_t first = at_;
    if (!next().starts_with('*')) {
      at_ = first;
      return;
    }
    for (std::string_view word = next(); word != "}"; word = next()) {
      if (word.empty()) bad(file_, "an array is cut off");
      if (word != "{" && word != "a:" && !word.starts_with('*')) take(word);
    }
  }
  std::vector<FilePoint> places() {
    std::vector<float> number;
    for_numbers([&](std::string_view word) { number.push_back(assimp_number(word)); });
    return places_of(number);
  }
  template <typename T>
  std::vector<T> numbers() {
    std::vector<T> out;
    for_numbers([&](std::string_view word) {
      T value{};
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size()) {
        bad(file_, "it has '" + std::string(word.substr(0, 30)) + "' where a number is to be");
      }
      out.push_back(value);
    });
    return out;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  bool animated_;
  std::size_t at_ = 0;
};

}  // namespace

bool is_bad_type(std::string_view type, const FbxObject& of) {
  return (type == "KTime" && !of.is_clip) || type == "ColorAndAlpha";
}

std::string fbx_name(std::string_view name) {
  name = name.substr(0, name.find('\0'));  // "hip\0\1Model" in the binary form
  for (const std::string_view kind : {"Model::", "Geometry::"}) {
    if (name.starts_with(kind)) return std::string(name.substr(kind.size()));
  }
  return std::string(name);
}

void FbxObjects::add(FbxObject object) {
  check_keys(object);
  if (object.id != 0) name_[object.id] = object.name;
  if (object.indices_end > 0) {
    uint32_t& end = indices_end_[object.id];
    end = std::max(end, object.indices_end);
  }
  if (object.points.empty()) return;
  const auto [it, is_new] = point_count_.try_emplace(object.id, object.points.size());
  it->second = std::min(it->second, object.points.size());
  std::vector<uint32_t> corner;
  corner.reserve(object.corners.size());
  for (const int32_t i : object.corners) corner.push_back(static_cast<uint32_t>(i < 0 ? ~i : i));
  points.emplace_back(std::move(object.name), std::move(object.points), std::move(corner));
}

void FbxObjects::check_keys(const FbxObject& object) {
  if (!std::all_of(object.value.begin(), object.value.end(), [](float v) { return std::isfinite(v); })) {
    bad(file_, "an animation has a key that is not a finite number; export it again");
  }
  for (std::size_t i = 1; i < std::min(object.time.size(), object.value.size()); ++i) {
    const double step = std::abs(double{object.value[i]} - double{object.value[i - 1]});
    if (step < kHalfTurn) continue;
    const double ticks = static_cast<double>(object.time[i]) - static_cast<double>(object.time[i - 1]);
    if (ticks < kFewestTicks * step / kHalfTurn) {
      bad(file_, "an animation turns too far between two keys; export it again with more keys");
    }
    added_ += step / kHalfTurn;
  }
  if (added_ > kMaxAdded) fail(file_, ErrorCode::limit, "its animation turns too often; export less of it");
}

void FbxObjects::check_bones(std::span<const std::array<uint64_t, 2>> connections) const {
  std::multimap<int64_t, int64_t> parents;
  for (const auto& [parent, child] : connections) {
    parents.emplace(static_cast<int64_t>(child), static_cast<int64_t>(parent));
  }
  const auto for_parents = [&](int64_t id, const auto& visit) {
    const auto [first, last] = parents.equal_range(id);
    for (auto it = first; it != last; ++it) visit(it->second);
  };
  std::multiset<std::pair<int64_t, std::string>> held;  // by a skin
  for (const auto& [parent, child] : connections) {
    const auto model = name_.find(static_cast<int64_t>(child));
    if (model == name_.end() || !indices_end_.contains(static_cast<int64_t>(parent))) continue;
    for_parents(static_cast<int64_t>(parent), [&](int64_t skin) { held.emplace(skin, model->second); });
  }
  const auto twice = std::adjacent_find(held.begin(), held.end());
  if (twice != held.end()) bad(file_, "a skin has the bone '" + twice->second + "' twice; export it again");
  for (const auto& [cluster, end] : indices_end_) {
    for_parents(cluster, [&, most = end](int64_t skin) {
      for_parents(skin, [&](int64_t geometry) {
        const auto count = point_count_.find(geometry);
        if (count == point_count_.end() || most <= count->second) return;
        bad(file_, "a bone holds point " + std::to_string(most - 1) + " of a mesh of " + std::to_string(count->second) +
                       "; export it again");
      });
    });
  }
}

void read_fbx_record(const std::filesystem::path& file, std::string_view name, std::string_view values, bool animated,
                     FbxObject& object) {
  if (values.empty()) return;
  const char type = values[0];
  const std::string_view array = values.substr(1);
  if (name == "Vertices" && type == 'd') object.points = places_of(unpacked<double>(file, array));
  if (name == "Vertices" && type == 'f') object.points = places_of(unpacked<float>(file, array));
  if (name == "PolygonVertexIndex" && type == 'i') object.corners = unpacked<int32_t>(file, array);
  if (name == "Indexes" && type == 'i') object.indices_end = end_of(unpacked<int32_t>(file, array));
  if (!animated) return;
  if (name == "KeyTime" && type == 'l') object.time = unpacked<int64_t>(file, array);
  if (name != "KeyValueFloat") return;
  if (type == 'f') object.value = unpacked<float>(file, array);
  if (type != 'd') return;
  object.value.clear();
  for (const double value : unpacked<double>(file, array)) object.value.push_back(static_cast<float>(value));
}

void read_fbx_text(const std::filesystem::path& file, std::string_view text, bool animated, FbxObjects& objects) {
  TextReader(file, text, animated).read(objects);
}

}  // namespace geocloth::import_detail
