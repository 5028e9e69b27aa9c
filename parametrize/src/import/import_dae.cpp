// SPDX-License-Identifier: GPL-3.0-or-later
// COLLADA ahead of assimp, which allocates the counts that a file announces, adds offsets and strides without a bound,
// and follows node instances by recursion. Arrays, accessors, weights, keys and instances are held against what is
// there; lights and cameras are taken out, and animations where nobody asks for them.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>

#include <pugixml.hpp>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

constexpr std::string_view kXmlBlank = " \t\r\n";
constexpr double kMaxKeyPairs = 2e10;  ///< of all channels of an animation: half a minute of assimp's

template <typename Take>
void for_words(std::string_view text, const Take& take) {
  for (std::size_t at = text.find_first_not_of(kXmlBlank); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kXmlBlank, at), text.size());
    take(text.substr(at, end - at));
    at = text.find_first_not_of(kXmlBlank, end);
  }
}

std::size_t count_words(std::string_view text) {
  std::size_t count = 0;
  for_words(text, [&](std::string_view) { ++count; });
  return count;
}

/// @returns whether the whole word is a number
template <typename Number>
bool read_number(std::string_view word, Number& value) {
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && stop == word.data() + word.size();
}

std::vector<int64_t> integers(std::string_view text) {
  std::vector<int64_t> out;
  for_words(text, [&](std::string_view word) {
    int64_t value = 0;
    out.push_back(read_number(word, value) ? value : INT64_MIN);
  });
  return out;
}

class DaeReader {
 public:
  DaeReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), size_(bytes.size()) {
    check_nesting(bytes);
    const pugi::xml_parse_result result = document_.load_buffer(bytes.data(), bytes.size());
    if (!result) bad("its XML is broken (" + std::string(result.description()) + "); is the file cut off?");
    root_ = document_.child("COLLADA");
    if (!root_) bad("this is no COLLADA file");
  }

  DaeText read(bool animated) {
    for (const char* name : {"library_animation_clips", "library_cameras", "library_lights"}) remove_all(name);
    if (!animated) remove_all("library_animations");
    walk(root_);
    for (const pugi::xml_node accessor : accessors_) check_accessor(accessor);
    for (const pugi::xml_node skin : skins_) check_skin(skin);
    for (const pugi::xml_node sampler : samplers_) check_sampler(sampler);
    for (const pugi::xml_node channel : channels_) check_channel(channel);
    check_hierarchy(file_, instances());
    DaeText out;
    for (const pugi::xml_node geometry : geometries_) out.points.push_back(points_of_geometry(geometry));
    mend_unit();
    out.metres_per_unit = root_.child("asset").child("unit").attribute("meter").as_double(1);
    if (!std::isfinite(out.metres_per_unit) || out.metres_per_unit <= 0) bad("asset.unit.meter is no positive number");
    std::ostringstream text;
    document_.save(text, "", pugi::format_raw);
    out.text = text.str();
    return out;
  }

 private:
  struct Array {
    std::size_t count = 0;
    pugi::xml_node node;
  };
  struct Accessor {
    std::size_t count = 0, stride = 1;
    std::size_t size = 0;  ///< numbers of an element, as assimp counts them
    std::size_t offset = 0;
    pugi::xml_node array;
  };

  void remove_all(const char* name) {
    while (root_.remove_child(name)) {
    }
  }

  static std::string tag(pugi::xml_node node) { return std::string("<").append(node.name()).append(">"); }
  [[noreturn]] void bad(const std::string& what) const { fail(file_, ErrorCode::invalid_data, what); }

  /// Elements open and close like brackets; counting them first bounds every recursion over the document.
  void check_nesting(std::string_view bytes) const {
    if (bytes.find('\0') != std::string_view::npos) bad("this is no COLLADA file");
    std::ptrdiff_t depth = 0;
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
      const char next = bytes[i + 1];
      if (bytes[i] == '<' && next != '!' && next != '?') depth += next == '/' ? -1 : 1;
      if (bytes[i] == '/' && next == '>') --depth;
      if (depth > 200) bad("its elements nest more than 200 levels deep");
    }
  }

  /// A count in an attribute; never more than the file has bytes.
  std::size_t number(pugi::xml_node node, const char* name, std::size_t otherwise) const {
    const pugi::xml_attribute attribute = node.attribute(name);
    if (!attribute) return otherwise;
    const std::string_view text = attribute.value();
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value > size_) {
      bad(tag(node) + " has an impossible " + name + " '" + std::string(text.substr(0, 30)) + "'");
    }
    return value;
  }

  /// Exporters on German machines write "0,010000".
  void mend_unit() {
    pugi::xml_attribute metres = root_.child("asset").child("unit").attribute("meter");
    std::string text = metres.value();
    if (std::count(text.begin(), text.end(), ',') != 1 || text.find('.') != std::string::npos) return;
    text[text.find(',')] = '.';
    metres.set_value(text.c_str());
  }

  /// Blanks around a value are as good as none (XML Schema, list types); assimp trips over them in single numbers.
  static void trim(pugi::xml_node text) {
    const std::string_view value = text.value();
    const std::size_t first = value.find_first_not_of(kXmlBlank);
    if (text.type() != pugi::node_pcdata || first == std::string_view::npos) return;
    const std::size_t last = value.find_last_not_of(kXmlBlank);
    if (last + 1 - first < value.size()) text.set_value(std::string(value.substr(first, last + 1 - first)).c_str());
  }

  /// What says how many primitives it has and has others ends assimp where it is built as Debian builds it; some
  /// programs count wrongly.
  void mend_count(pugi::xml_node primitives) const {
    const std::string_view name = primitives.name();
    if (name != "triangles" && name != "polylist" && name != "polygons") return;
    const auto lists =
        static_cast<std::size_t>(std::distance(primitives.children("p").begin(), primitives.children("p").end()));
    if (name != "polygons" && lists > 1) bad(tag(primitives) + " has more than one <p>");
    pugi::xml_attribute count = primitives.attribute("count");
    if (name == "polygons") count.set_value(lists);
    if (name == "polylist") count.set_value(count_words(primitives.child("vcount").text().get()));
    if (lists == 0) count.set_value(0U);
  }

  void walk(pugi::xml_node node) {
    for (const pugi::xml_node child : node.children()) {
      trim(child);
      const std::string_view name = child.name();
      if (name.ends_with("_array")) add_array(child);
      if (name == "accessor") accessors_.push_back(child);
      if (name == "skin") skins_.push_back(child);
      if (name == "geometry") {
        geometry_[reference_to(child)] = child;
        geometries_.push_back(child);
      }
      if (name == "sampler") samplers_.push_back(child);
      mend_count(child);
      if (name == "channel") channels_.push_back(child);
      static_cast<void>(number(child, "count", 0));
      static_cast<void>(number(child, "stride", 0));
      if (name == "input" && number(child, "offset", 0) > 64) bad("<input> has an offset beyond 64");
      if (name == "p" || name == "h" || name == "v" || name == "vcount") check_integers(child);
      if (name == "vcount") check_polygon_sizes(child);
      walk(child);
    }
  }

  /// assimp reads such a list without end when something else is in it.
  void check_integers(pugi::xml_node node) const {
    for (const pugi::xml_node text : node.children()) {
      const std::string_view value = text.value();
      if (text.type() != pugi::node_pcdata || value.find_first_not_of("0123456789- \t\r\n") != std::string_view::npos) {
        bad(tag(node) + " holds something that is no integer");
      }
    }
    for (const int64_t i : integers(node.text().get())) {
      if (i < -1 || i > static_cast<int64_t>(kMaxElements)) bad(tag(node) + " holds an impossible number");
    }
  }

  /// <vcount> has an entry for each polygon its parent announces.
  void check_polygon_sizes(pugi::xml_node node) const {
    if (count_words(node.text().get()) < number(node.parent(), "count", 0)) bad("a <vcount> is cut off");
    for (const int64_t corners : integers(node.text().get())) {
      if (corners < 0 || static_cast<std::size_t>(corners) > size_) bad("a <vcount> holds an impossible number");
    }
  }

  /// How others of the file name an element.
  static std::string reference_to(pugi::xml_node node) {
    std::string reference = "#";
    reference += node.attribute("id").value();
    return reference;
  }

  void add_array(pugi::xml_node node) {
    const std::size_t count = number(node, "count", 0);
    if (count_words(node.text().get()) < count) bad(tag(node) + " has fewer values than it says");
    array_[reference_to(node)] = {count, node};
  }

  void check_accessor(pugi::xml_node node) {
    const auto array = array_.find(node.attribute("source").value());
    if (array == array_.end()) return;  // assimp refuses what it cannot resolve
    const std::size_t offset = number(node, "offset", 0);
    Accessor a{number(node, "count", 0), number(node, "stride", 1), 0, offset, array->second.node};
    std::size_t params = 0;
    for (const pugi::xml_node param : node.children("param")) {
      a.size += std::strcmp(param.attribute("type").value(), "float4x4") == 0 ? std::size_t{16} : std::size_t{1};
      ++params;
    }
    if (a.stride == 0 || params > std::max<std::size_t>(a.stride, 1) || offset > array->second.count ||
        a.count > (array->second.count - offset) / a.stride) {
      bad("an <accessor> reaches beyond its array");
    }
    const pugi::xml_node source = node.parent().parent();
    accessor_[reference_to(source)] = a;
  }

  /// Accessor behind the input of that meaning.
  Accessor input(pugi::xml_node parent, const char* semantic) const {
    for (const pugi::xml_node node : parent.children("input")) {
      if (std::strcmp(node.attribute("semantic").value(), semantic) != 0) continue;
      const auto it = accessor_.find(node.attribute("source").value());
      if (it != accessor_.end()) return it->second;
    }
    return {};
  }

  FilePoints points_of_geometry(pugi::xml_node geometry) const {
    const Accessor accessor = input(geometry.child("mesh").child("vertices"), "POSITION");
    std::vector<float> number;
    if (accessor.stride >= 3)
      for_words(accessor.array.text().get(), [&](std::string_view word) { number.push_back(assimp_number(word)); });
    std::vector<FilePoint> position;
    for (std::size_t i = 0; i < accessor.count; ++i) {
      const std::size_t at = accessor.offset + i * accessor.stride;
      if (at + 2 < number.size()) position.push_back({number[at], number[at + 1], number[at + 2]});
    }
    return {geometry.attribute("id").value(), std::move(position)};
  }

  /// How many points the mesh of a skin has; 0 where that is not known.
  std::size_t points_of(pugi::xml_node skin) const {
    const auto mesh = geometry_.find(skin.attribute("source").value());
    return mesh == geometry_.end() ? 0 : input(mesh->second.child("mesh").child("vertices"), "POSITION").count;
  }

  void check_skin(pugi::xml_node skin) const {
    const pugi::xml_node joints = skin.child("joints"), weights = skin.child("vertex_weights");
    const Accessor names = input(joints, "JOINT"), matrices = input(joints, "INV_BIND_MATRIX");
    if (matrices.count < names.count || (names.count > 0 && matrices.stride < 16)) {
      bad("a <skin> does not have a matrix for every joint");
    }
    const pugi::xml_node bind = skin.child("bind_shape_matrix");
    if (bind && count_words(bind.text().get()) < 16) bad("a <bind_shape_matrix> is cut off");
    std::size_t joint_offset = 0, weight_offset = 0, per_entry = 0;
    for (const pugi::xml_node node : weights.children("input")) {
      const std::size_t offset = number(node, "offset", 0);
      per_entry = std::max(per_entry, offset + 1);
      if (std::strcmp(node.attribute("semantic").value(), "JOINT") == 0) joint_offset = offset;
      if (std::strcmp(node.attribute("semantic").value(), "WEIGHT") == 0) weight_offset = offset;
    }
    if (weights && per_entry != 2) bad("a <vertex_weights> does not have joints and weights");
    const std::size_t held = number(weights, "count", 0);
    if (weights && (held != count_words(weights.child("vcount").text().get()) || held < points_of(skin))) {
      bad("a <vertex_weights> does not have an entry for each point of its mesh");
    }
    const std::vector<int64_t> indices = integers(weights.child("v").text().get());
    const auto joint_count = static_cast<int64_t>(std::min(names.count, input(weights, "JOINT").count));
    const auto weight_count = static_cast<int64_t>(input(weights, "WEIGHT").count);
    int64_t entries = 0;
    for (const int64_t n : integers(weights.child("vcount").text().get())) entries += n;
    if (entries * 2 > static_cast<int64_t>(indices.size())) bad("a <vertex_weights> is cut off");
    for (std::size_t i = 0; i + 1 < indices.size(); i += 2) {
      const int64_t joint = indices[i + joint_offset], weight = indices[i + weight_offset];
      if (joint < 0 || joint >= joint_count || weight < 0 || weight >= weight_count) {
        bad("a <vertex_weights> names a joint or weight that does not exist");
      }
    }
  }

  /// assimp goes through all keys of a channel for each of its times, and copies values without a bound.
  void check_sampler(pugi::xml_node sampler) {
    const Accessor times = input(sampler, "INPUT"), values = input(sampler, "OUTPUT");
    if (times.count == 0 || times.count != values.count) bad("an animation does not have a value for each time");
    if (times.size > times.stride || values.size > values.stride || values.size > 16) {
      bad("an animation has values of an impossible size");
    }
    check_times(times.array.text().get());
    key_pairs_ += double(times.count) * double(times.count);
    if (key_pairs_ > kMaxKeyPairs) {
      fail(file_, ErrorCode::limit, "its animation has too many keys; export fewer, or as FBX or glTF");
    }
    values_[reference_to(sampler)] = values.size;
  }

  void check_times(std::string_view text) const {
    for_words(text, [&](std::string_view word) {
      double time = 0;
      if (read_number(word, time) && std::abs(time) < 1e9) return;
      bad("an animation has a time '" + std::string(word.substr(0, 30)) + "'");
    });
  }

  /// One number of a transform, "node/turn.ANGLE" or "node/matrix(1)(2)", takes one number of a key.
  void check_channel(pugi::xml_node channel) const {
    const std::string_view target = channel.attribute("target").value();
    const auto size = values_.find(channel.attribute("source").value());
    const bool one = target.find_first_of(".(", std::min(target.find('/'), target.size())) != std::string_view::npos;
    if (one && size != values_.end() && size->second != 1) bad("an animation has values of an impossible size");
  }

  /// Nodes numbered in the order of the document, with their children and the nodes they instance.
  std::vector<std::array<uint64_t, 2>> instances() const {
    std::map<std::string, uint64_t> by_id;
    std::vector<std::pair<uint64_t, std::string>> targets;
    std::vector<std::array<uint64_t, 2>> edges;
    uint64_t count = 0;
    collect_nodes(root_, 0, count, by_id, targets, edges);
    for (const auto& [node, target] : targets) {
      const auto it = by_id.find(target);
      if (it != by_id.end()) edges.push_back({node, it->second});
    }
    return edges;
  }

  static void collect_nodes(pugi::xml_node parent, uint64_t number, uint64_t& count,
                            std::map<std::string, uint64_t>& by_id,
                            std::vector<std::pair<uint64_t, std::string>>& targets,
                            std::vector<std::array<uint64_t, 2>>& edges) {
    for (const pugi::xml_node child : parent.children()) {
      uint64_t self = number;
      if (std::strcmp(child.name(), "node") == 0) {
        self = ++count;
        // The nodes of a library stand under no other until they are instanced.
        if (number != 0) edges.push_back({number, self});
        for (const char* name : {"id", "name", "sid"}) {
          if (child.attribute(name)) by_id.try_emplace(child.attribute(name).value(), self);
        }
      } else if (std::strcmp(child.name(), "instance_node") == 0) {
        const std::string_view url = child.attribute("url").value();
        targets.emplace_back(number, std::string(url.substr(url.starts_with('#') ? 1 : 0)));
      }
      collect_nodes(child, self, count, by_id, targets, edges);
    }
  }

  const std::filesystem::path& file_;
  std::size_t size_;
  pugi::xml_document document_;
  pugi::xml_node root_;
  std::map<std::string, Array> array_;
  std::map<std::string, Accessor> accessor_;  ///< by the "#id" of their <source>
  std::map<std::string, pugi::xml_node> geometry_;
  std::vector<pugi::xml_node> geometries_, accessors_, skins_, samplers_, channels_;
  std::map<std::string, std::size_t> values_;  ///< of a key, by the "#id" of samplers
  double key_pairs_ = 0;
};

}  // namespace

DaeText read_dae(const std::filesystem::path& file, std::string_view bytes, bool animated) {
  return DaeReader(file, bytes).read(animated);
}

}  // namespace geocloth::import_detail
