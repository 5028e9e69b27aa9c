// SPDX-License-Identifier: GPL-3.0-or-later
// PLY and STL ahead of assimp, and node graphs of any format. Its readers allocate what a header announces and index by
// what a list says; here the announced sizes are held against the bytes that are there, so that a file that is cut off
// or lies about its sizes ends with a message.
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

// --- PLY -----------------------------------------------------------------------------------------------------------

struct PlyProperty {
  std::size_t size = 0;        ///< bytes of the value or of a list's entry
  std::size_t count_size = 0;  ///< bytes of a list's length; 0: no list
  bool integral = true;
  bool is_index = false;  ///< the corners of a face
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> property;
};

std::size_t ply_size(std::string_view type) {
  for (const char* name : {"char", "uchar", "int8", "uint8"}) {
    if (type == name) return 1;
  }
  for (const char* name : {"short", "ushort", "int16", "uint16"}) {
    if (type == name) return 2;
  }
  for (const char* name : {"int", "uint", "int32", "uint32", "float", "float32"}) {
    if (type == name) return 4;
  }
  for (const char* name : {"double", "float64"}) {
    if (type == name) return 8;
  }
  return 0;
}

bool ply_integral(std::string_view type) {
  return !type.starts_with("float") && type != "double";
}

class PlyChecker {
 public:
  PlyChecker(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  void check() {
    read_header();
    for (const PlyElement& element : element_) {
      if (element.count > kMaxElements) {
        fail(file_, ErrorCode::limit, "announces more than 100 million elements '" + element.name + "'");
      }
      if (element.name == "vertex") vertices_ = element.count;
    }
    for (const PlyElement& element : element_) ascii_ ? walk_text(element) : walk_binary(element);
  }

 private:
  std::string_view next_line() {
    if (at_ >= bytes_.size()) bad(file_, "the header does not end; is the file cut off?");
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return line;
  }

  void read_header() {
    if (!bytes_.starts_with("ply\n") && !bytes_.starts_with("ply\r\n")) bad(file_, "this is no PLY file");
    bool has_format = false;
    for (auto line = words_of(next_line()); line.empty() || line[0] != "end_header"; line = words_of(next_line())) {
      if (line.size() >= 2 && line[0] == "format") {
        ascii_ = line[1] == "ascii";
        big_ = line[1] == "binary_big_endian";
        has_format = ascii_ || big_ || line[1] == "binary_little_endian";
      } else if (!line.empty() && line[0] == "element") {
        const auto count = line.size() == 3 ? whole_number(line[2]) : std::nullopt;
        if (!count) bad(file_, "the header has a broken 'element' line");
        element_.push_back({std::string(line[1].substr(0, 40)), *count, {}});
      } else if (!line.empty() && line[0] == "property") {
        read_property(line);
      }
    }
    if (!has_format) bad(file_, "the header names no known format");
    if (at_ > bytes_.size()) at_ = bytes_.size();
  }

  void read_property(const std::vector<std::string_view>& line) {
    PlyProperty property;
    const bool list = line.size() == 5 && line[1] == "list";
    if (element_.empty() || (!list && line.size() != 3)) bad(file_, "the header has a broken 'property' line");
    property.size = ply_size(line[list ? 3 : 1]);
    property.integral = ply_integral(line[list ? 3 : 1]);
    if (list) property.count_size = ply_integral(line[2]) ? ply_size(line[2]) : 0;
    if (property.size == 0 || (list && property.count_size == 0)) {
      const std::string name(line.back().substr(0, 40));
      bad(file_, "the property '" + name +
                     "' has a type that PLY has not (lists count by whole numbers, and none has " +
                     "64 bits but double); write it as uint or float");
    }
    property.is_index = list && (line[4] == "vertex_indices" || line[4] == "vertex_index");
    if (property.is_index && !property.integral) bad(file_, "face corners are not integers");
    element_.back().property.push_back(property);
  }

  [[noreturn]] void cut_off(const PlyElement& element, std::size_t i) const {
    bad(file_, "the file is cut off in element '" + element.name + "' " + std::to_string(i) + " of " +
                   std::to_string(element.count));
  }

  void check_index(uint64_t index, const PlyElement& element, std::size_t i) const {
    if (index >= vertices_) {
      bad(file_, "'" + element.name + "' " + std::to_string(i) + " uses vertex " + std::to_string(index) + " of " +
                     std::to_string(vertices_));
    }
  }

  uint64_t integer(std::size_t at, std::size_t size) const {
    uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const auto byte = static_cast<unsigned char>(bytes_[at + (big_ ? k : size - 1 - k)]);
      value = value << 8U | byte;
    }
    return value;
  }

  void walk_binary(const PlyElement& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.property) {
        std::size_t entries = 1;
        if (property.count_size != 0) {
          if (property.count_size > bytes_.size() - at_) cut_off(element, i);
          entries = integer(at_, property.count_size);
          at_ += property.count_size;
        }
        if (entries > (bytes_.size() - at_) / property.size) cut_off(element, i);
        for (std::size_t k = 0; property.is_index && k < entries; ++k) {
          check_index(integer(at_ + k * property.size, property.size), element, i);
        }
        at_ += entries * property.size;
      }
      if (element.property.empty()) return;
    }
  }

  std::string_view next_text(const PlyElement& element, std::size_t i) {
    constexpr std::string_view kBlank = " \t\r\n\v\f";
    const std::size_t begin = bytes_.find_first_not_of(kBlank, at_);
    if (begin == std::string_view::npos) cut_off(element, i);
    const std::size_t end = std::min(bytes_.find_first_of(kBlank, begin), bytes_.size());
    at_ = end;
    return bytes_.substr(begin, end - begin);
  }

  void walk_text(const PlyElement& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.property) {
        std::size_t entries = 1;
        if (property.count_size != 0) {
          const auto count = whole_number(next_text(element, i));
          if (!count || *count > bytes_.size()) bad(file_, "'" + element.name + "' has a broken list");
          entries = *count;
        }
        for (std::size_t k = 0; k < entries; ++k) {
          const std::string_view word = next_text(element, i);
          if (!property.is_index) continue;
          const auto index = whole_number(word);
          if (!index) bad(file_, "'" + element.name + "' " + std::to_string(i) + " has a broken corner");
          check_index(*index, element, i);
        }
      }
      if (element.property.empty()) return;
    }
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::size_t at_ = 0, vertices_ = 0;
  bool ascii_ = false, big_ = false;
  std::vector<PlyElement> element_;
};

bool looks_like_text(std::string_view bytes) {
  return bytes.find('\0') == std::string_view::npos;
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

void check_ply(const std::filesystem::path& file, std::string_view bytes) {
  PlyChecker(file, bytes).check();
}

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
