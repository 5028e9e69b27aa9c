// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/fbx_curves.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>

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
  if (result != Z_OK || size != count * sizeof(T)) bad(file, "an array of an animation cannot be unpacked");
  return out;
}

/// Walks the words of the textual form, which are names, numbers, quoted texts and braces.
class TextCurves {
 public:
  TextCurves(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text), check_(file) {}

  void check() {
    std::vector<FbxCurve> open(1);
    for (std::string_view word = next(); !word.empty(); word = next()) {
      if (word == "KeyTime:") {
        open.back().time = numbers<int64_t>();
      } else if (word == "KeyValueFloat:") {
        open.back().value = numbers<float>();
      } else if (word == "{") {
        open.emplace_back();
      } else if (word == "}") {
        check_.add(open.back());
        open.pop_back();
        if (open.empty()) bad(file_, "its braces do not match");
      }
    }
    check_.add(open.back());
  }

 private:
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

  /// All of an array, "*2 { a: 0,90 }".
  template <typename T>
  std::vector<T> numbers() {
    std::vector<T> out;
    for (std::string_view word = next(); word != "}"; word = next()) {
      if (word.empty()) bad(file_, "the keys of an animation are cut off");
      if (word == "{" || word == "a:" || word.starts_with('*')) continue;
      T value{};
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size()) {
        bad(file_, "an animation has a key '" + std::string(word.substr(0, 30)) + "'");
      }
      out.push_back(value);
    }
    return out;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  FbxCurveCheck check_;
};

}  // namespace

void FbxCurveCheck::add(const FbxCurve& curve) {
  if (!std::all_of(curve.value.begin(), curve.value.end(), [](float v) { return std::isfinite(v); })) {
    bad(file_, "an animation has a key that is not a finite number; export it again");
  }
  for (std::size_t i = 1; i < std::min(curve.time.size(), curve.value.size()); ++i) {
    const double step = std::abs(double{curve.value[i]} - double{curve.value[i - 1]});
    if (step < kHalfTurn) continue;
    const double ticks = static_cast<double>(curve.time[i]) - static_cast<double>(curve.time[i - 1]);
    if (ticks < kFewestTicks * step / kHalfTurn) {
      bad(file_, "an animation turns too far between two keys; export it again with more keys");
    }
    added_ += step / kHalfTurn;
  }
  if (added_ > kMaxAdded) fail(file_, ErrorCode::limit, "its animation turns too often; export less of it");
}

void read_fbx_keys(const std::filesystem::path& file, std::string_view name, std::string_view array, FbxCurve& curve) {
  if (array.empty()) return;
  const std::string_view packed = array.substr(1);
  if (name == "KeyTime" && array[0] == 'l') curve.time = unpacked<int64_t>(file, packed);
  if (name != "KeyValueFloat") return;
  if (array[0] == 'f') curve.value = unpacked<float>(file, packed);
  if (array[0] != 'd') return;
  curve.value.clear();
  for (const double value : unpacked<double>(file, packed)) curve.value.push_back(static_cast<float>(value));
}

void check_text_curves(const std::filesystem::path& file, std::string_view text) {
  TextCurves(file, text).check();
}

}  // namespace geocloth::import_detail
