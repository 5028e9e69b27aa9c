// SPDX-License-Identifier: GPL-3.0-or-later
// PLY ahead of assimp. Its reader allocates what a header announces and indexes by what a list says; here the announced
// sizes are held against the bytes that are there, so that a file that is cut off or lies about its sizes ends with a
// message.
//
// assimp 5.2 also takes an element whose name it does not know for one of no records, so that what follows is read from
// the wrong place, and of a triangle strip it keeps the first triangle. Such files it gets in another form, with
// vertices first, then faces, and nothing that it does not know before them. So it gets those with comments between
// properties, for it reads none of the properties after them.
#include <algorithm>
#include <array>
#include <span>
#include <utility>

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
  std::vector<PlyProperty> property{};
  std::string header{};            ///< its lines of it
  std::size_t begin = 0, end = 0;  ///< its bytes
};

constexpr std::string_view kBetweenNumbers = " \t\r\n\v\f";  // in a text
constexpr std::string_view kVertices = "vertex", kFaces = "face", kStrips = "tristrips";

/// What of a file there is to know for geocloth, in an order in which assimp reads it.
constexpr std::array<std::string_view, 3> kWanted{kVertices, kFaces, "material"};

/// Elements that assimp can read over.
bool ply_is_known(std::string_view element) {
  return element == "edge" || std::ranges::find(kWanted, element) != kWanted.end();
}

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

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  void check() {
    read_header();
    for (const PlyElement& element : element_) {
      if (element.count > kMaxElements) {
        fail(file_, ErrorCode::limit, "announces more than 100 million elements '" + element.name + "'");
      }
      if (element.name == kVertices) vertices_ = element.count;
    }
    refuse_twins();
    has_strips_ = find(kStrips) != nullptr;
    for (PlyElement& element : element_) {
      element.begin = at_;
      ascii_ ? walk_text(element) : walk_binary(element);
      element.end = at_;
    }
  }

  /// Whether assimp would take what it reads from the wrong place, or too little of it. After check().
  bool is_misread() const {
    bool unknown = false, vertices = false, misread = has_strips_ || has_inner_comment_;
    for (const PlyElement& element : element_) {
      if (element.name == kVertices || element.name == kFaces) misread = misread || unknown;
      if (element.name == kFaces && !vertices) misread = true;
      vertices = vertices || element.name == kVertices;
      unknown = unknown || !ply_is_known(element.name);
    }
    return misread;
  }

  /// The wanted elements alone, with strips as faces. After check().
  std::string rewritten() const {
    std::string text = preamble_;
    for (const std::string_view name : kWanted) {
      if (name == kFaces && has_strips_) {
        text += "element face " + std::to_string(face_count_) + "\nproperty list uint uint vertex_indices\n";
      } else if (const PlyElement* element = find(name)) {
        text += element->header;
      }
    }
    text += "end_header\n";
    for (const std::string_view name : kWanted) {
      if (name == kFaces && has_strips_) {
        text += faces_;
      } else if (const PlyElement* element = find(name)) {
        append_records(*element, text);
      }
    }
    return text;
  }

 private:
  std::string_view next_line() {
    if (at_ >= bytes_.size()) bad(file_, "the header does not end; is the file cut off?");
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    const std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    return line;
  }

  const PlyElement* find(std::string_view name) const {
    const auto it = std::ranges::find(element_, name, &PlyElement::name);
    return it == element_.end() ? nullptr : &*it;
  }

  /// assimp makes room for the first of two and fills in both.
  void refuse_twins() const {
    for (const std::string_view name : {kVertices, kFaces, kStrips}) {
      if (std::ranges::count(element_, name, &PlyElement::name) > 1) {
        bad(file_, "the header has more than one element '" + std::string(name) + "'; merge them into one");
      }
    }
  }

  void read_header() {
    if (!bytes_.starts_with("ply\n") && !bytes_.starts_with("ply\r\n")) bad(file_, "this is no PLY file");
    bool has_format = false;
    std::string_view whole = next_line();
    for (auto line = words_of(whole); line.empty() || line[0] != "end_header"; line = words_of(whole)) {
      if (line.size() >= 2 && line[0] == "format") {
        ascii_ = line[1] == "ascii";
        big_ = line[1] == "binary_big_endian";
        has_format = ascii_ || big_ || line[1] == "binary_little_endian";
      } else if (!line.empty() && line[0] == "element") {
        const auto count = line.size() == 3 ? whole_number(line[2]) : std::nullopt;
        if (!count) bad(file_, "the header has a broken 'element' line");
        element_.push_back({std::string(line[1].substr(0, 40)), *count});
      } else if (!line.empty() && line[0] == "property") {
        read_property(line);
      }
      keep_line(whole, line.empty() ? "" : line[0]);
      whole = next_line();
    }
    if (!has_format) bad(file_, "the header names no known format");
    if (at_ > bytes_.size()) at_ = bytes_.size();
  }

  /// Comments may name a picture.
  void keep_line(std::string_view line, std::string_view keyword) {
    const bool is_of_element = keyword == "element" || keyword == "property";
    has_inner_comment_ = has_inner_comment_ || (keyword == "property" && !was_of_element_);
    was_of_element_ = is_of_element;
    if (line.ends_with('\r')) line.remove_suffix(1);
    (is_of_element ? element_.back().header : preamble_).append(line).push_back('\n');
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

  /// A corner of face or strip i.
  void add_corner(uint64_t index, const PlyElement& element, std::size_t i) {
    if (index >= vertices_) {
      bad(file_, "'" + element.name + "' " + std::to_string(i) + " uses vertex " + std::to_string(index) + " of " +
                     std::to_string(vertices_));
    }
    if (has_strips_) corner_.push_back(static_cast<uint32_t>(index));
  }

  /// Where a strip ends and another begins, which programs write as -1.
  void restart() {
    add_strip();
    corner_.clear();
  }

  void begin_corners(const PlyProperty& property) {
    if (property.is_index) corner_.clear();
  }

  void end_corners(const PlyElement& element, const PlyProperty& property) {
    if (!has_strips_ || !property.is_index) return;
    if (element.name == kFaces) add_face(corner_);
    if (element.name == kStrips) add_strip();
  }

  /// Every other triangle of a strip turns the other way round. Those of two equal corners only lead on to the next.
  void add_strip() {
    for (std::size_t k = 0; k + 2 < corner_.size(); ++k) {
      std::array<uint32_t, 3> t{corner_[k], corner_[k + 1], corner_[k + 2]};
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      if (k % 2 == 1) std::swap(t[0], t[1]);
      add_face(t);
    }
  }

  void add_face(std::span<const uint32_t> corners) {
    if (++face_count_ > kMaxTriangles) fail(file_, ErrorCode::limit, "holds more than 20 million triangles");
    write(static_cast<uint32_t>(corners.size()));
    for (const uint32_t c : corners) write(c);
    if (ascii_) faces_.push_back('\n');
  }

  /// A number of a face, in the file's own form.
  void write(uint32_t value) {
    if (ascii_) {
      faces_.append(std::to_string(value)).push_back(' ');
      return;
    }
    for (unsigned k = 0; k < 4; ++k) faces_.push_back(static_cast<char>(value >> 8U * (big_ ? 3 - k : k)));
  }

  /// In a text, where assimp reads by lines, they begin and end with one.
  void append_records(const PlyElement& element, std::string& text) const {
    std::string_view records = bytes_.substr(element.begin, element.end - element.begin);
    if (ascii_) records.remove_prefix(std::min(records.find_first_not_of(kBetweenNumbers), records.size()));
    text += records;
    if (ascii_ && !records.empty()) text.push_back('\n');
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
        begin_corners(property);
        for (std::size_t k = 0; property.is_index && k < entries; ++k) {
          const uint64_t index = integer(at_ + k * property.size, property.size);
          if (element.name == kStrips && index >= vertices_ && index == ~uint64_t{0} >> (64 - 8 * property.size)) {
            restart();
          } else {
            add_corner(index, element, i);
          }
        }
        end_corners(element, property);
        at_ += entries * property.size;
      }
      if (element.property.empty()) return;
    }
  }

  std::string_view next_text(const PlyElement& element, std::size_t i) {
    const std::size_t begin = bytes_.find_first_not_of(kBetweenNumbers, at_);
    if (begin == std::string_view::npos) cut_off(element, i);
    const std::size_t end = std::min(bytes_.find_first_of(kBetweenNumbers, begin), bytes_.size());
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
        begin_corners(property);
        for (std::size_t k = 0; k < entries; ++k) {
          const std::string_view word = next_text(element, i);
          if (!property.is_index) continue;
          if (element.name == kStrips && word == "-1") {
            restart();
            continue;
          }
          const auto index = whole_number(word);
          if (!index) bad(file_, "'" + element.name + "' " + std::to_string(i) + " has a broken corner");
          add_corner(*index, element, i);
        }
        end_corners(element, property);
      }
      if (element.property.empty()) return;
    }
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::size_t at_ = 0, vertices_ = 0;
  bool ascii_ = false, big_ = false, has_strips_ = false;
  bool has_inner_comment_ = false, was_of_element_ = false;
  std::string preamble_;  // lines of the header that are of no element
  std::vector<PlyElement> element_;
  std::vector<uint32_t> corner_;  // of the face or strip that is being read, where there are strips
  std::string faces_;             // the records of faces and of strips as faces, where there are strips
  std::size_t face_count_ = 0;
};

}  // namespace

std::string checked_ply(const std::filesystem::path& file, std::string text) {
  PlyReader reader(file, text);
  reader.check();
  return reader.is_misread() ? reader.rewritten() : std::move(text);
}

}  // namespace geocloth::import_detail
