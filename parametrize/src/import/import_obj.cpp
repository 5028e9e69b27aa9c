// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ ahead of assimp. assimp's reader makes a vertex per face corner, reads coordinates in single precision
// and trusts its input; users select by the numbers of the `v` records. So the records are read here, and assimp gets
// a clean copy in which the position of a vertex is its number: groups, materials and texture coordinates come back
// from assimp with the number of the vertex beside them.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr std::string_view kObjBlank = " \t\r\v\f";

/// Splits the first word off a line.
std::string_view next_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(kObjBlank);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  const std::size_t end = std::min(line.find_first_of(kObjBlank, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Calls handle(line number, line) for every logical line: a backslash at the end joins the next one.
template <typename Handle>
void for_each_line(std::string_view text, Handle&& handle) {
  std::string joined;
  std::size_t number = 0, first = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::string_view line = next_line(text, at);
    ++number;
    if (joined.empty()) first = number;
    if (line.ends_with('\\')) {
      line.remove_suffix(1);
      joined.append(line).push_back(' ');
      continue;
    }
    if (joined.empty()) {
      handle(first, line);
    } else {
      joined.append(line);
      handle(first, std::string_view(joined));
      joined.clear();
    }
  }
  if (!joined.empty()) handle(first, std::string_view(joined));
}

/// Reads a number; "nan" and "inf" are read as what they say, so that they can be refused by name later.
bool read_number(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    value = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos ? 0.0 : HUGE_VAL;
    return true;
  }
  return error == std::errc() && end == word.data() + word.size();
}

/// A name that assimp's line reader takes as it is.
std::string printable(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(kObjBlank);
  if (begin == std::string_view::npos) return {};
  std::string name(line.substr(begin, line.find_last_not_of(kObjBlank) + 1 - begin));
  for (char& c : name) {
    if (static_cast<unsigned char>(c) < 32) c = '_';
  }
  if (name.size() > 512) name.resize(512);
  return name;
}

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

  ObjText read() {
    for_each_line(text_, [&](std::size_t number, std::string_view line) {
      line_ = number;
      read_record(line);
    });
    check_range(used_vertex_, out_.position.size(), "vertex");
    check_range(used_uv_, uv_count_, "texture coordinate");
    check_range(used_normal_, normal_count_, "normal");
    finish_colors();
    std::erase_if(out_.loose_edge, [&](const auto& e) { return std::max(e[0], e[1]) >= out_.position.size(); });
    return std::move(out_);
  }

 private:
  /// The greatest index that a face has used, and where. Faces may stand before the records they use.
  struct Greatest {
    std::size_t index = 0, line = 0;
  };

  void check_range(const Greatest& used, std::size_t count, const char* what) const {
    if (used.index <= count) return;
    fail(file_, ErrorCode::invalid_data,
         "line " + std::to_string(used.line) + ": a face uses " + what + " " + std::to_string(used.index) + " of " +
             std::to_string(count) + "; is the file cut off or damaged?");
  }

  [[noreturn]] void bad(const std::string& what) const {
    fail(file_, ErrorCode::invalid_data, "line " + std::to_string(line_) + ": " + what);
  }

  /// Programs in a language that writes 1,5 for one and a half may write so into files.
  [[noreturn]] void refuse_number(std::string_view word, const char* otherwise) const {
    const std::size_t comma = word.find(',');
    std::string pointed(word.substr(0, 64));
    double value = 0;
    if (comma + 1 < pointed.size()) pointed[comma] = '.';
    if (comma >= pointed.size() || comma + 1 == pointed.size() || !read_number(pointed, value)) bad(otherwise);
    bad("the number '" + printable(word) + "' has a decimal comma; export the mesh with decimal points");
  }

  void read_record(std::string_view line) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      read_vertex(line);
    } else if (keyword == "vt") {
      read_values(keyword, line, 1, 3, uv_count_);
    } else if (keyword == "vn") {
      read_values(keyword, line, 3, 3, normal_count_);
    } else if (keyword == "f" || keyword == "fo") {
      read_face(line);
    } else if (keyword == "l") {
      read_line(line);
    } else if (keyword == "o" || keyword == "g") {
      begin(name_, line);
    } else if (keyword == "usemtl") {
      begin(material_, line);
    } else if (keyword == "mtllib") {
      out_.coded.append("mtllib ").append(printable(line)).push_back('\n');
    }
  }

  /// From here on faces are of this object, group or material; one without a name is legal and means "default".
  void begin(std::string& current, std::string_view line) {
    std::string name = printable(line);
    if (name.empty()) name = "default";
    if (name != current) in_part_ = false;
    current = std::move(name);
  }

  /// Left to itself assimp names what follows the first material of an object after the material, and whoever selects
  /// the object by its name gets a piece of it. So every part is a group of its own that is called by its number.
  void begin_part() {
    in_part_ = true;
    out_.coded.append("g ").append(std::to_string(out_.part_name.size())).push_back('\n');
    if (!material_.empty()) out_.coded.append("usemtl ").append(material_).push_back('\n');
    const std::string& name = name_.empty() ? material_ : name_;
    out_.part_name.push_back(name.empty() ? "defaultobject" : name);
  }

  void read_vertex(std::string_view line) {
    Point3 p;
    for (double& c : p) {
      const std::string_view word = next_word(line);
      if (!read_number(word, c)) refuse_number(word, "a vertex needs three numbers; is the file cut off?");
    }
    if (out_.position.size() >= kMaxElements) fail(file_, ErrorCode::limit, "more than 100 million vertices");
    const auto number = static_cast<uint32_t>(out_.position.size());
    out_.position.push_back(p);
    read_color(line);
    out_.coded.append("v ").append(std::to_string(number & 0xFFFFU)).append(" ");
    out_.coded.append(std::to_string(number >> 16U)).append(" 0\n");
  }

  /// Of a `v` record: three numbers after the coordinates, which many programs write though the format has none.
  void read_color(std::string_view line) {
    std::array<double, 3> share{};
    for (double& s : share)
      if (!read_number(next_word(line), s)) return;
    if (!next_word(line).empty()) return;
    out_.color.resize(out_.position.size(), kWhite);
    for (std::size_t k = 0; k < share.size(); ++k) out_.color.back()[k] = static_cast<float>(share[k]);
  }

  /// Some programs count colors from 0 to 255.
  void finish_colors() {
    if (out_.color.empty()) return;
    float most = 0;
    for (const auto& color : out_.color)
      for (const float share : color) most = share > most ? share : most;  // not where it is no number
    if (most > 2) {
      for (auto& color : out_.color)
        if (color != kWhite)
          for (float& share : color) share /= 255;
    }
    out_.color.resize(out_.position.size(), kWhite);
  }

  void read_values(std::string_view keyword, std::string_view line, int least, int written, std::size_t& count) {
    out_.coded.append(keyword);
    for (int k = 0; k < written; ++k) {
      const std::string_view word = next_word(line);
      double value = 0;
      if (!word.empty() || k < least) {
        if (!read_number(word, value)) refuse_number(word, "a number is missing or broken; is the file cut off?");
      }
      if (!std::isfinite(value) || std::abs(value) > 1e9) value = 0;
      char buffer[32];
      const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, 9).ptr;
      out_.coded.append(" ").append(buffer, end);
    }
    out_.coded.push_back('\n');
    ++count;
  }

  /// An index of a face corner, made absolute; negative ones count back from the latest record.
  std::size_t read_index(std::string_view word, std::size_t count, Greatest& used) const {
    long long index = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    if (error != std::errc() || end != word.data() + word.size()) bad("broken face corner '" + printable(word) + "'");
    const long long absolute = index < 0 ? static_cast<long long>(count) + index + 1 : index;
    if (absolute < 1 || absolute > static_cast<long long>(kMaxElements)) {
      bad("a face uses element " + std::to_string(index) + " of " + std::to_string(count));
    }
    const auto result = static_cast<std::size_t>(absolute);
    if (result > used.index) used = {result, line_};
    return result;
  }

  /// Corners of a line, one after the other; what is no line of this file is no reason to refuse its faces.
  void read_line(std::string_view line) {
    std::optional<uint32_t> before;
    for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
      long long index = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
      if (error != std::errc() || (end != word.data() + word.size() && *end != '/')) return;
      const auto count = static_cast<long long>(out_.position.size());
      const long long absolute = index < 0 ? count + index : index - 1;
      if (absolute < 0 || absolute >= static_cast<long long>(kMaxElements)) return;
      const auto vertex = static_cast<uint32_t>(absolute);
      if (before) add_edge(*before, vertex);
      before = vertex;
    }
  }

  void add_edge(uint32_t a, uint32_t b) {
    if (out_.loose_edge.size() >= kMaxElements) fail(file_, ErrorCode::limit, "more than 100 million lines");
    if (a != b) out_.loose_edge.push_back({a, b});
  }

  void read_face(std::string_view line) {
    std::string coded = "f";
    std::size_t corners = 0;
    std::array<std::size_t, 2> ends{};
    for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
      if (++corners > kMaxPolygonCorners) bad("a polygon of more than 4096 corners; triangulate it before exporting");
      const std::size_t slash = std::min(word.find('/'), word.size());
      const std::size_t vertex = read_index(word.substr(0, slash), out_.position.size(), used_vertex_);
      if (corners <= ends.size()) ends[corners - 1] = vertex;
      coded.append(" ").append(std::to_string(vertex));
      if (slash == word.size()) continue;
      const std::string_view rest = word.substr(slash + 1);
      const std::size_t second = std::min(rest.find('/'), rest.size());
      const std::string_view uv = rest.substr(0, second);
      const std::string_view normal = second < rest.size() ? rest.substr(second + 1) : std::string_view();
      if (uv.empty() && normal.empty()) continue;
      coded.push_back('/');
      if (!uv.empty()) coded.append(std::to_string(read_index(uv, uv_count_, used_uv_)));
      if (!normal.empty()) coded.append("/").append(std::to_string(read_index(normal, normal_count_, used_normal_)));
    }
    if (corners == 0) bad("a face without corners; is the file cut off?");
    // Faces with one or two corners are points and lines.
    if (corners == 2) add_edge(static_cast<uint32_t>(ends[0] - 1), static_cast<uint32_t>(ends[1] - 1));
    if (corners < 3) return;
    if (!in_part_) begin_part();
    out_.coded.append(coded).push_back('\n');
  }

  static constexpr std::array<float, 3> kWhite{1, 1, 1};

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t line_ = 0, uv_count_ = 0, normal_count_ = 0;
  Greatest used_vertex_, used_uv_, used_normal_;
  std::string name_, material_;  // of the object or group, and in use
  bool in_part_ = false;         // false: the next face begins one
  ObjText out_;
};

}  // namespace

ObjText read_obj(const std::filesystem::path& file, std::string_view text) {
  return ObjReader(file, text).read();
}

uint32_t decode_obj_vertex(float x, float y) {
  return static_cast<uint32_t>(x) | static_cast<uint32_t>(y) << 16U;
}

std::string clean_mtl(std::string_view text) {
  constexpr std::string_view kKnown[] = {"newmtl", "Kd", "d", "Tr", "Pr", "Pm", "map_Kd", "norm", "map_d"};
  std::string out;
  for_each_line(text, [&](std::size_t, std::string_view line) {
    const std::string_view keyword = next_word(line);
    const std::string value = printable(line);
    for (const std::string_view k : kKnown) {
      if (k == keyword && !value.empty()) out.append(k).append(" ").append(value).push_back('\n');
    }
  });
  return out;
}

}  // namespace geocloth::import_detail
