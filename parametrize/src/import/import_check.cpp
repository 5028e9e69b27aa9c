// SPDX-License-Identifier: GPL-3.0-or-later
// STL ahead of assimp, node graphs of any format, and the words of texts. Its readers allocate what a header announces;
// here the announced sizes are held against the bytes that are there, so that a file that is cut off or lies about its
// sizes ends with a message.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <map>
#include <optional>

#include "import/import_detail.h"

namespace geocloth::import_detail {
std::string_view next_line(std::string_view text, std::size_t& at) {
  const std::size_t begin = at, end = std::min(text.find_first_of("\n\r", begin), text.size());
  at = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
  return text.substr(begin, end - begin);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    out.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlank, end);
  }
  return out;
}

std::optional<std::size_t> whole_number(std::string_view word) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

namespace {

bool looks_like_text(std::string_view bytes) {
  return bytes.find('\0') == std::string_view::npos;
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string checked_stl(const std::filesystem::path& file, std::string text) {
  constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;
  const bool has_count = text.size() >= kHeaderBytes;
  const std::size_t announced =
      has_count ? kHeaderBytes + kTriangleBytes * std::size_t{read_le<uint32_t>(text, kHeaderBytes - 4)} : 0;
  // Some programs open a binary file with "solid" too; then its size gives it away.
  if (has_count && announced == text.size()) return text;
  if (looks_like_text(text)) {
    // Some programs write the words of the format in capitals, which assimp does not know.
    if (text.find("SOLID") == std::min(text.find_first_not_of(" \t\r\n"), text.size())) text = in_small_letters(text);
    if (text.find("solid") == std::min(text.find_first_not_of(" \t\r\n"), text.size())) {
      if (text.find("endsolid") == std::string::npos && text.find("ENDSOLID") == std::string::npos) {
        bad(file, "the 'solid' does not end; is the file cut off?");
      }
      return text;
    }
  }
  if (!has_count) bad(file, "this is no STL file, or it is cut off in its header");
  const std::string sizes = std::to_string(text.size()) + " of " + std::to_string(announced) + " bytes";
  if (announced > text.size()) bad(file, "the file is cut off: " + sizes);
  // Padding is shorter than a triangle.
  if (announced + kTriangleBytes <= text.size()) bad(file, "the file is longer than its header says: " + sizes);
  text.resize(announced);
  return text;
}

void check_hierarchy(const std::filesystem::path& file, std::vector<std::array<uint64_t, 2>> edges) {
  constexpr uint64_t kMostNodes = 1'000'000, kMostLevels = 512;
  std::sort(edges.begin(), edges.end());
  std::map<uint64_t, uint64_t> parents;
  for (const auto& [parent, child] : edges) {
    parents.try_emplace(parent, 0);
    ++parents[child];
  }
  struct Unfolded {
    uint64_t count = 0, depth = 0;
  };
  std::map<uint64_t, Unfolded> unfolded;
  std::vector<uint64_t> ready;
  for (const auto& [node, count] : parents) {
    if (count > 0) continue;
    ready.push_back(node);
    unfolded[node] = {1, 1};
  }
  std::size_t done = 0;
  for (; done < ready.size(); ++done) {
    const Unfolded self = unfolded[ready[done]];
    if (self.count > kMostNodes || self.depth > kMostLevels) {
      fail(file, ErrorCode::limit, "its nodes nest more than 512 levels deep, or unfold to more than a million");
    }
    const std::array<uint64_t, 2> first{ready[done], 0};
    for (auto it = std::lower_bound(edges.begin(), edges.end(), first); it != edges.end() && (*it)[0] == ready[done];
         ++it) {
      const uint64_t child = (*it)[1];
      Unfolded& below = unfolded[child];
      below = {std::min(below.count + self.count, kMostNodes + 1), std::max(below.depth, self.depth + 1)};
      if (--parents[child] == 0) ready.push_back(child);
    }
  }
  if (done < parents.size()) bad(file, "its nodes form a circle");
}

}  // namespace geocloth::import_detail
