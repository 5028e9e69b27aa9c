// SPDX-License-Identifier: GPL-3.0-or-later
// Garment files hold more than the cloth: buttons, zips, the body. Which parts to convert is said by number, name or
// material. A file of one part, as scanners and simulators write it, is taken apart into its connected pieces, welded
// as repair will weld them, so that a soup of triangles is no thousand pieces.
#include "geocloth/parametrize/parts.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>

#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/error.h"
#include "geocloth/parametrize/repair.h"
#include "mesh/point_math.h"
#include "repair/soup.h"

namespace geocloth {
namespace {

constexpr size_t kMostNamesInMessage = 8;

double area_of(const TriangleMesh& mesh, uint32_t t) {
  const auto& [a, b, c] = mesh.triangle[t];
  return triangle_area(mesh.position[a], mesh.position[b], mesh.position[c]);
}

/// Per triangle the number of its connected piece, the piece of most area first.
std::vector<uint32_t> connected_pieces(const TriangleMesh& mesh, const RepairOptions& options) {
  const WeldReach reach = weld_reach(options, bounding_diagonal(mesh.position));
  const std::vector<uint32_t> point = weld(mesh.position, mesh.triangle, reach).point;
  DisjointSets pieces(mesh.position.size());
  for (const Triangle& t : mesh.triangle) {
    pieces.join(point[t[0]], point[t[1]]);
    pieces.join(point[t[0]], point[t[2]]);
  }
  std::vector<double> area(mesh.position.size(), 0);
  std::vector<uint32_t> root, rank(mesh.position.size(), kNone);
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) {
    const uint32_t piece = pieces.find(point[mesh.triangle[t][0]]);
    area[piece] += area_of(mesh, t);
    if (rank[piece] == kNone) root.push_back(piece);
    rank[piece] = 0;
  }
  std::stable_sort(root.begin(), root.end(), [&](uint32_t a, uint32_t b) { return area[a] > area[b]; });
  for (uint32_t i = 0; i < root.size(); ++i) rank[root[i]] = i;
  std::vector<uint32_t> result;
  result.reserve(mesh.triangle.size());
  for (const Triangle& t : mesh.triangle) result.push_back(rank[pieces.find(point[t[0]])]);
  return result;
}

std::string_view material_name(const TriangleMesh& mesh, const SourcePart& part) {
  return part.material < mesh.material.size() ? std::string_view(mesh.material[part.material].name)
                                              : std::string_view();
}

std::optional<uint32_t> whole_number(std::string_view text) {
  uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

class Selector {
 public:
  explicit Selector(const TriangleMesh& mesh) : mesh_(mesh) {}

  std::vector<char> select(std::string_view selection) {
    bool first = true;
    for (size_t begin = 0; begin <= selection.size();) {
      const size_t end = std::min(selection.find(',', begin), selection.size());
      std::string_view term = selection.substr(begin, end - begin);
      const bool leave_out = term.starts_with('-');
      if (leave_out) term.remove_prefix(1);
      if (first) chosen_.assign(mesh_.part.size(), leave_out ? 1 : 0);
      first = false;
      for (const uint32_t i : parts_of(term)) chosen_[i] = leave_out ? 0 : 1;
      begin = end + 1;
    }
    return chosen_;
  }

 private:
  [[nodiscard]] std::vector<uint32_t> parts_of(std::string_view term) const {
    if (term.empty()) {
      throw Error(ErrorCode::invalid_argument, "an empty term in the selection of parts; write for example 0,2 or -3");
    }
    constexpr std::string_view kMaterial = "material:";
    if (term.starts_with(kMaterial)) return parts_of_material(term.substr(kMaterial.size()));
    std::vector<uint32_t> found = named(term, [&](uint32_t i) { return mesh_.part[i].name; });
    if (found.empty() && !mesh_.part_mesh.empty()) found = named(term, [&](uint32_t i) { return mesh_.part_mesh[i]; });
    if (!found.empty()) return found;
    const size_t dash = term.find('-');
    const std::optional<uint32_t> low = whole_number(term.substr(0, dash));
    const std::optional<uint32_t> high = dash == term.npos ? low : whole_number(term.substr(dash + 1));
    if (!low || !high) {
      throw Error(ErrorCode::invalid_argument, "no part is called " + std::string(term) + "; " + known_parts());
    }
    if (*low > *high || *high >= mesh_.part.size()) {
      throw Error(ErrorCode::invalid_argument, "there is no part " + std::string(term) + "; " + known_parts());
    }
    found.resize(*high - *low + 1);
    std::iota(found.begin(), found.end(), *low);
    return found;
  }

  /// The parts that a function gives that name.
  template <typename NameOf>
  [[nodiscard]] std::vector<uint32_t> named(std::string_view name, const NameOf& name_of) const {
    std::vector<uint32_t> found;
    for (uint32_t i = 0; i < mesh_.part.size(); ++i) {
      if (name_of(i) == name) found.push_back(i);
    }
    return found;
  }

  [[nodiscard]] std::vector<uint32_t> parts_of_material(std::string_view name) const {
    std::vector<uint32_t> found = named(name, [&](uint32_t i) { return material_name(mesh_, mesh_.part[i]); });
    if (!found.empty()) return found;
    throw Error(ErrorCode::invalid_argument, "no part has the material " + std::string(name) + "; see --parts list");
  }

  [[nodiscard]] std::string known_parts() const {
    std::string names;
    for (size_t i = 0; i < std::min(mesh_.part.size(), kMostNamesInMessage); ++i) {
      names += (i > 0 ? ", " : "") + std::to_string(i) + (mesh_.part[i].name.empty() ? "" : " " + mesh_.part[i].name);
    }
    if (mesh_.part.size() > kMostNamesInMessage) names += ", ...";
    return "there are " + std::to_string(mesh_.part.size()) + ": " + names + " (see --parts list)";
  }

  const TriangleMesh& mesh_;
  std::vector<char> chosen_;
};

}  // namespace

TriangleMesh with_triangles(const TriangleMesh& mesh, const std::vector<uint32_t>& order,
                            std::vector<SourcePart> part) {
  TriangleMesh result;
  result.name = mesh.name;
  result.position = mesh.position;
  result.middle = mesh.middle;
  result.loose_edge = mesh.loose_edge;
  result.part = std::move(part);
  result.material = mesh.material;
  result.image = mesh.image;
  result.vertex_groups = mesh.vertex_groups;
  result.paint = mesh.paint;
  result.left_out = mesh.left_out;
  const auto pick = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(order.size());
    for (const uint32_t t : order) to.push_back(from[t]);
  };
  pick(mesh.triangle, result.triangle);
  pick(mesh.polygon, result.polygon);
  pick(mesh.uv, result.uv);
  pick(mesh.normal, result.normal);
  return result;
}

TriangleMesh with_choosable_parts(TriangleMesh mesh, const RepairOptions& options) {
  if (mesh.part.size() != 1 || mesh.triangle.empty()) return mesh;
  const std::vector<uint32_t> piece = connected_pieces(mesh, options);
  std::vector<uint32_t> order(mesh.triangle.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return piece[a] < piece[b]; });
  if (piece[order.back()] == 0) return mesh;
  std::vector<SourcePart> part;
  for (uint32_t i = 0; i < order.size(); ++i) {
    if (piece[order[i]] == part.size()) {
      part.push_back({"piece " + std::to_string(part.size()), mesh.part[0].material, i, 0});
    }
    ++part.back().triangle_count;
  }
  return with_triangles(mesh, order, std::move(part));
}

std::vector<PartSummary> summarize_parts(const TriangleMesh& mesh) {
  std::vector<PartSummary> result;
  result.reserve(mesh.part.size());
  for (const SourcePart& part : mesh.part) {
    PartSummary summary{part.name, std::string(material_name(mesh, part)), part.triangle_count};
    for (uint32_t i = 0; i < part.triangle_count; ++i) {
      summary.area += area_of(mesh, part.first_triangle + i);
      for (const uint32_t v : mesh.triangle[part.first_triangle + i]) {
        const Point3& p = mesh.position[v];
        if (i == 0 && v == mesh.triangle[part.first_triangle][0]) summary.low = summary.high = p;
        for (size_t k = 0; k < 3; ++k) {
          summary.low[k] = std::min(summary.low[k], p[k]);
          summary.high[k] = std::max(summary.high[k], p[k]);
        }
      }
    }
    result.push_back(std::move(summary));
  }
  return result;
}

TriangleMesh select_parts(const TriangleMesh& mesh, std::string_view selection) {
  const std::vector<char> chosen = Selector(mesh).select(selection);
  std::vector<uint32_t> order;
  std::vector<SourcePart> part;
  std::vector<std::string> part_mesh;
  for (size_t i = 0; i < mesh.part.size(); ++i) {
    if (chosen[i] == 0) continue;
    if (!mesh.part_mesh.empty()) part_mesh.push_back(mesh.part_mesh[i]);
    SourcePart kept = mesh.part[i];
    kept.first_triangle = static_cast<uint32_t>(order.size());
    for (uint32_t t = 0; t < kept.triangle_count; ++t) order.push_back(mesh.part[i].first_triangle + t);
    part.push_back(std::move(kept));
  }
  if (order.empty()) {
    throw Error(ErrorCode::invalid_argument,
                "the selection of parts " + std::string(selection) + " leaves no face; see --parts list");
  }
  TriangleMesh result = with_triangles(mesh, order, std::move(part));
  result.part_mesh = std::move(part_mesh);
  return result;
}

}  // namespace geocloth
