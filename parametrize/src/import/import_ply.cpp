// SPDX-License-Identifier: GPL-3.0-or-later
// PLY ahead of assimp. Its reader allocates what a header announces and indexes by what a list says; here the announced
// sizes are held against the bytes that are there, so that a file that is cut off or lies about its sizes ends with a
// message.
#include <algorithm>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

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

}  // namespace

void check_ply(const std::filesystem::path& file, std::string_view bytes) {
  PlyChecker(file, bytes).check();
}

}  // namespace geocloth::import_detail
