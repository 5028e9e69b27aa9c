// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, STL, FBX and DAE ahead of assimp. Its readers allocate what a header announces and index by what a list says;
// here the announced sizes are held against the bytes that are there, so that a file that is cut off or lies about its
// sizes ends with a message.
#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "import_detail.h"

namespace geocloth::import_detail {
namespace {

[[noreturn]] void bad(const std::filesystem::path& file, const std::string& what) {
  fail(file, ErrorCode::invalid_data, what);
}

/// Reads a little-endian integer.
template <typename T>
T read_le(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> out;
  constexpr std::string_view blank = " \t\r\n\v\f";
  for (std::size_t at = line.find_first_not_of(blank); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(blank, at), line.size());
    out.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(blank, end);
  }
  return out;
}

std::optional<std::size_t> whole_number(std::string_view word) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

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
    for (auto line = words(next_line()); line.empty() || line[0] != "end_header"; line = words(next_line())) {
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
    if (property.size == 0 || (list && property.count_size == 0)) bad(file_, "the header names an unknown type");
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
    constexpr std::string_view blank = " \t\r\n\v\f";
    const std::size_t begin = bytes_.find_first_not_of(blank, at_);
    if (begin == std::string_view::npos) cut_off(element, i);
    const std::size_t end = std::min(bytes_.find_first_of(blank, begin), bytes_.size());
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

// --- FBX -----------------------------------------------------------------------------------------------------------

class FbxChecker {
 public:
  FbxChecker(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  void check() {
    if (bytes_.size() < 27) bad(file_, "the file is cut off in its header");
    wide_ = read_le<uint32_t>(bytes_, 23) >= 7500;
    std::size_t at = 27;
    while (at < bytes_.size()) {
      const std::size_t next = walk(at, bytes_.size(), 0);
      if (next == 0) return;  // the empty record that ends the list; a footer follows
      at = next;
    }
    bad(file_, "the list of records does not end; is the file cut off?");
  }

 private:
  uint64_t number(std::size_t at) const {
    return wide_ ? read_le<uint64_t>(bytes_, at) : uint64_t{read_le<uint32_t>(bytes_, at)};
  }

  /// Checks one record and those inside it. @returns where the next begins, 0 after an empty record
  std::size_t walk(std::size_t at, std::size_t limit, std::size_t depth) const {
    const std::size_t word = wide_ ? 8 : 4, head = 3 * word + 1;
    if (depth > 64) bad(file_, "its records nest more than 64 levels deep");
    if (head > limit - at) bad(file_, "a record is cut off");
    const uint64_t end = number(at), properties = number(at + word), property_bytes = number(at + 2 * word);
    const auto name = static_cast<unsigned char>(bytes_[at + head - 1]);
    if (end == 0) return 0;
    if (end > limit || end < at + head + name || property_bytes > end - at - head - name) {
      bad(file_, "a record reaches beyond its bounds; is the file cut off or damaged?");
    }
    std::size_t inside = at + head + name;
    check_properties(inside, inside + property_bytes, properties);
    inside += property_bytes;
    while (inside < end) {
      const std::size_t next = walk(inside, end, depth + 1);
      if (next == 0) break;
      inside = next;
    }
    return end;
  }

  void check_properties(std::size_t at, std::size_t end, uint64_t count) const {
    for (uint64_t i = 0; i < count; ++i) {
      if (at >= end) bad(file_, "a record has fewer values than it announces");
      const char type = bytes_[at++];
      const std::size_t size = property_size(type, at, end);
      if (size > end - at) bad(file_, "a value reaches beyond its record; is the file cut off or damaged?");
      at += size;
    }
  }

  std::size_t property_size(char type, std::size_t at, std::size_t end) const {
    switch (type) {
      case 'C':
      case 'B':
        return 1;
      case 'Y':
        return 2;
      case 'I':
      case 'F':
        return 4;
      case 'D':
      case 'L':
        return 8;
      case 'S':
      case 'R':
        if (end - at < 4) bad(file_, "a value is cut off");
        return 4 + std::size_t{read_le<uint32_t>(bytes_, at)};
      case 'f':
      case 'd':
      case 'l':
      case 'i':
      case 'b':
      case 'c':
        return array_size(type, at, end);
      default:
        bad(file_, "a value has an unknown type");
    }
  }

  std::size_t array_size(char type, std::size_t at, std::size_t end) const {
    if (end - at < 12) bad(file_, "an array is cut off");
    const std::size_t count = read_le<uint32_t>(bytes_, at), encoding = read_le<uint32_t>(bytes_, at + 4),
                      stored = read_le<uint32_t>(bytes_, at + 8);
    const std::size_t element = type == 'd' || type == 'l' ? 8 : type == 'f' || type == 'i' ? 4 : 1;
    if (count > kMaxElements) fail(file_, ErrorCode::limit, "an array has more than 100 million entries");
    // zlib expands at most about 1032 times.
    const bool possible = encoding == 0 ? stored == count * element : encoding == 1 && count * element <= stored * 1040;
    if (!possible) bad(file_, "an array announces a size that its data cannot have");
    return 12 + stored;
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  bool wide_ = false;
};

bool looks_like_text(std::string_view bytes) {
  return bytes.find('\0') == std::string_view::npos;
}

}  // namespace

void check_ply(const std::filesystem::path& file, std::string_view bytes) {
  PlyChecker(file, bytes).check();
}

void check_stl(const std::filesystem::path& file, std::string_view bytes) {
  const bool has_count = bytes.size() >= 84;
  const std::size_t announced = has_count ? 84 + 50 * std::size_t{read_le<uint32_t>(bytes, 80)} : 0;
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool solid = bytes.substr(start).starts_with("solid");
  // Some programs open a binary file with "solid" too; then its size gives it away.
  if (has_count && announced == bytes.size()) return;
  if (solid && looks_like_text(bytes)) {
    if (bytes.find("endsolid") == std::string_view::npos && bytes.find("ENDSOLID") == std::string_view::npos) {
      bad(file, "the 'solid' does not end; is the file cut off?");
    }
    return;
  }
  if (!has_count) bad(file, "this is no STL file, or it is cut off in its header");
  if (announced > bytes.size()) {
    bad(file, "the file is cut off: " + std::to_string(bytes.size()) + " of " + std::to_string(announced) + " bytes");
  }
}

void check_fbx(const std::filesystem::path& file, std::string_view bytes) {
  if (bytes.starts_with("Kaydara FBX Binary")) return FbxChecker(file, bytes).check();
  if (!looks_like_text(bytes) || bytes.substr(0, 4096).find("FBX") == std::string_view::npos) {
    bad(file, "this is no FBX file");
  }
  std::ptrdiff_t depth = 0;
  for (const char c : bytes) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth < 0 || depth > 64) bad(file, "its braces do not match");
  }
  if (depth != 0) bad(file, "its braces do not match; is the file cut off?");
}

void check_dae(const std::filesystem::path& file, std::string_view bytes) {
  if (!looks_like_text(bytes) || bytes.substr(0, 4096).find("<COLLADA") == std::string_view::npos) {
    bad(file, "this is no COLLADA file");
  }
  if (bytes.find("</COLLADA>") == std::string_view::npos) bad(file, "'COLLADA' does not end; is the file cut off?");
  std::ptrdiff_t depth = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    if (bytes[i] == '<' && bytes[i + 1] != '/' && bytes[i + 1] != '!' && bytes[i + 1] != '?') ++depth;
    if ((bytes[i] == '<' && bytes[i + 1] == '/') || (bytes[i] == '/' && bytes[i + 1] == '>')) --depth;
    if (depth > 512) bad(file, "its elements nest more than 512 levels deep");
  }
}

}  // namespace geocloth::import_detail
