// SPDX-License-Identifier: GPL-3.0-or-later
// Geomview's OFF, in which CGAL, libigl and geogram keep their meshes. It says what OBJ says, an element on each line,
// so it is written as OBJ, line by line, and read as that: messages about coordinates name the right line.
#include <optional>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

class OffReader {
 public:
  OffReader(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

  std::string read() {
    for (std::size_t at = 0; at < text_.size() && !is_complete();) {
      const std::string_view line = next_line(text_, at);
      ++line_;
      read_line(words_of(line.substr(0, line.find('#'))));
      obj_.push_back('\n');
    }
    if (!counts_) bad_file("the header does not end; is the file cut off?");
    if (!is_complete()) {
      bad_file("the file is cut off: " + std::to_string(vertices_) + " of " + std::to_string(counts_->vertices) +
               " vertices, " + std::to_string(faces_) + " of " + std::to_string(counts_->faces) + " faces");
    }
    return std::move(obj_);
  }

 private:
  using Words = std::vector<std::string_view>;
  struct Counts {
    std::size_t vertices, faces;
  };

  [[noreturn]] void bad_file(const std::string& what) const { bad(file_, what); }
  [[noreturn]] void bad_line(const std::string& what) const {
    bad(file_, "line " + std::to_string(line_) + ": " + what);
  }

  [[nodiscard]] bool is_complete() const {
    return counts_ && vertices_ == counts_->vertices && faces_ == counts_->faces;
  }

  void read_line(Words words) {
    if (words.empty()) return;
    if (!has_keyword_) read_keyword(words);
    if (words.empty()) return;
    if (!counts_) {
      read_counts(words);
    } else if (vertices_ < counts_->vertices) {
      read_vertex(words);
    } else {
      read_face(words);
    }
  }

  /// [ST][C][N][4][n]OFF: what each vertex has. Some files have the number of vertices behind it without a blank.
  void read_keyword(Words& words) {
    const std::size_t off = words[0].find("OFF");
    const std::string_view before = words[0].substr(0, off);
    if (off == std::string_view::npos || before.find_first_not_of("STCN4n") != std::string_view::npos)
      bad_file("this is no OFF file: it does not begin with OFF");
    if (before.find_first_of("4n") != std::string_view::npos)
      fail(file_, ErrorCode::unsupported, "its points have four coordinates or more; write them with three");
    has_normals_ = before.find('N') != std::string_view::npos;
    has_colors_ = before.find('C') != std::string_view::npos;
    has_keyword_ = true;
    words[0].remove_prefix(off + 3);
    if (words[0].empty()) words.erase(words.begin());
    if (!words.empty() && words[0] == "BINARY")
      fail(file_, ErrorCode::unsupported, "it is binary OFF; write it as text, or as PLY");
  }

  void read_counts(const Words& words) {
    const auto vertices = whole_number(words[0]);
    const auto faces = words.size() > 1 ? whole_number(words[1]) : std::nullopt;
    if (!vertices || !faces) bad_line("the header needs the numbers of vertices and faces");
    if (*vertices > kMaxElements || *faces > kMaxElements)
      fail(file_, ErrorCode::limit, "announces more than 100 million vertices or faces");
    counts_ = {*vertices, *faces};
  }

  /// x y z, then the normal, the color and texture coordinates as far as it has them.
  void read_vertex(const Words& words) {
    if (words.size() < 3) bad_line("a vertex needs three numbers; is the file cut off?");
    obj_.push_back('v');
    for (std::size_t k = 0; k < 3; ++k) add(words[k]);
    const std::size_t color = has_normals_ ? 6 : 3;
    for (std::size_t k = color; has_colors_ && words.size() >= color + 3 && k < color + 3; ++k) add(words[k]);
    ++vertices_;
  }

  /// The number of corners, their vertices from 0 on, and perhaps a color.
  void read_face(const Words& words) {
    const auto corners = whole_number(words[0]);
    if (!corners || *corners == 0 || *corners >= words.size())
      bad_line("a face needs the number of its corners and as many vertices; is the file cut off?");
    obj_.push_back('f');
    for (std::size_t k = 1; k <= *corners; ++k) {
      const auto vertex = whole_number(words[k]);
      if (!vertex || *vertex >= counts_->vertices) {
        bad_line("a face uses vertex '" + std::string(words[k].substr(0, 40)) + "' of " +
                 std::to_string(counts_->vertices) + ", counted from 0");
      }
      obj_.append(" ").append(std::to_string(*vertex + 1));
    }
    ++faces_;
  }

  void add(std::string_view word) {
    if (word.find('\\') != std::string_view::npos) bad_line("a number is broken");  // to OBJ the line would go on
    obj_.append(" ").append(word);
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t line_ = 0, vertices_ = 0, faces_ = 0;
  bool has_keyword_ = false, has_normals_ = false, has_colors_ = false;
  std::optional<Counts> counts_;
  std::string obj_;
};

}  // namespace

std::string off_as_obj(const std::filesystem::path& file, std::string_view text) {
  return OffReader(file, text).read();
}

}  // namespace geocloth::import_detail
