// SPDX-License-Identifier: GPL-3.0-or-later
// FBX ahead of assimp: the records of the binary form have to lie within one another, arrays must hold what they
// announce, and the connections between objects must not form a circle, because assimp follows them by recursion.
#include <charconv>
#include <cstring>

#include "import/fbx_objects.h"
#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr char kBlank = '_';

class FbxChecker {
 public:
  FbxChecker(const std::filesystem::path& file, std::string_view bytes, bool animated)
      : file_(file), bytes_(bytes), animated_(animated), objects_(file) {}

  /// Pairs of parent and child object, after check().
  std::vector<std::array<uint64_t, 2>> connections;

  /// After check().
  [[nodiscard]] FbxObjects& objects() { return objects_; }

  void check() {
    if (bytes_.size() < 27) bad(file_, "the file is cut off in its header");
    wide_ = read_le<uint32_t>(bytes_, 23) >= 7500;
    std::size_t at = 27;
    FbxObject none;
    while (at < bytes_.size()) {
      const std::size_t next = walk(at, bytes_.size(), 0, none);
      if (next == 0) return objects_.check_bones(connections);  // the empty record that ends the list; a footer follows
      at = next;
    }
    bad(file_, "the list of records does not end; is the file cut off?");
  }

 private:
  uint64_t number(std::size_t at) const {
    return wide_ ? read_le<uint64_t>(bytes_, at) : uint64_t{read_le<uint32_t>(bytes_, at)};
  }

  /// Checks one record and those inside it.
  /// @param around  the record that it is in
  /// @returns where the next begins, 0 after an empty record
  std::size_t walk(std::size_t at, std::size_t limit, std::size_t depth, FbxObject& around) {
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
    const std::string_view called = bytes_.substr(at + head, name), values = bytes_.substr(inside, property_bytes);
    if (called == "C") read_connection(values);
    if (called == kFbxClip && !animated_) objects_.blanks.push_back(at + head);
    if (called == "P") blank_type(values, inside, around);
    read_fbx_record(file_, called, values, animated_, around);
    inside += property_bytes;
    FbxObject own;
    own.is_clip = around.is_clip || called == kFbxClip;
    if (depth == 1 && values.size() >= 9 && values[0] == 'L') {
      own.id = read_le<int64_t>(values, 1);
      if (values.size() >= 14 && values[9] == 'S') own.name = fbx_name(text_at(values, 9));
    }
    while (inside < end) {
      const std::size_t next = walk(inside, end, depth + 1, own);
      if (next == 0) break;
      inside = next;
    }
    objects_.add(std::move(own));
    return end;
  }

  /// Of a text among the values of a record.
  static std::string_view text_at(std::string_view values, std::size_t at) {
    return values.substr(at + 5, read_le<uint32_t>(values, at + 1));
  }

  /// A property begins with its name and its type.
  /// @param at  of the values in the file
  void blank_type(std::string_view values, std::size_t at, const FbxObject& of) {
    if (values.size() < 5 || values[0] != 'S') return;
    const std::size_t second = 5 + text_at(values, 0).size();
    if (values.size() < second + 5 || values[second] != 'S') return;
    if (is_bad_type(text_at(values, second), of)) objects_.blanks.push_back(at + second + 5);
  }

  /// A record C with the values "OO", child, parent.
  void read_connection(std::string_view values) {
    constexpr std::string_view kObjectLink("S\2\0\0\0OO", 7);
    if (!values.starts_with(kObjectLink) || values.size() < 25 || values[7] != 'L' || values[16] != 'L') return;
    connections.push_back({read_le<uint64_t>(values, 17), read_le<uint64_t>(values, 8)});
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
  bool animated_, wide_ = false;
  FbxObjects objects_;
};

/// Reads the next integer after `at`, across blanks and commas.
uint64_t next_number(std::string_view text, std::size_t& at) {
  at = std::min(text.find_first_not_of(" \t,", at), text.size());
  int64_t value = 0;
  const char* end = std::from_chars(text.data() + at, text.data() + text.size(), value).ptr;
  at = static_cast<std::size_t>(end - text.data());
  return static_cast<uint64_t>(value);
}

/// The lines C: "OO", child, parent of the textual form.
std::vector<std::array<uint64_t, 2>> text_connections(std::string_view text) {
  std::vector<std::array<uint64_t, 2>> out;
  for (std::size_t at = text.find("\"OO\""); at != std::string_view::npos; at = text.find("\"OO\"", at)) {
    at += 4;
    const uint64_t child = next_number(text, at), parent = next_number(text, at);
    out.push_back({parent, child});
  }
  return out;
}

void check_text(const std::filesystem::path& file, std::string_view bytes) {
  if (bytes.find('\0') != std::string_view::npos || bytes.substr(0, 4096).find("FBX") == std::string_view::npos) {
    bad(file, "this is no FBX file");
  }
  std::ptrdiff_t depth = 0;
  for (const char c : bytes) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (depth < 0 || depth > 64) bad(file, "its braces do not match");
  }
  if (depth != 0) bad(file, "its braces do not match; is the file cut off?");
}

}  // namespace

std::string checked_fbx(const std::filesystem::path& file, std::string bytes, bool animated,
                        std::vector<FilePoints>& points) {
  if (!bytes.starts_with("Kaydara FBX Binary")) {
    check_text(file, bytes);
    FbxObjects objects(file);
    read_fbx_text(file, bytes, animated, objects);
    std::vector<std::array<uint64_t, 2>> connections = text_connections(bytes);
    objects.check_bones(connections);
    check_hierarchy(file, std::move(connections));
    for (const std::size_t at : objects.blanks) bytes[at] = kBlank;
    points = std::move(objects.points);
    return bytes;
  }
  FbxChecker checker(file, bytes, animated);
  checker.check();
  check_hierarchy(file, std::move(checker.connections));
  for (const std::size_t at : checker.objects().blanks) bytes[at] = kBlank;
  points = std::move(checker.objects().points);
  return bytes;
}

}  // namespace geocloth::import_detail
