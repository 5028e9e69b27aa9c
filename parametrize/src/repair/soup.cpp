// SPDX-License-Identifier: GPL-3.0-or-later
// From a soup to a complex of proper triangles: collapsed and duplicate faces go, and triangles without area are
// replaced by a corner in the faces beyond their longest side. None of this opens or closes anything: each step keeps
// the homotopy type.
#include "repair/soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <unordered_map>

#include "geocloth/asset/disjoint_sets.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// A triangle whose height is below this share of its longest side counts as a line. Geometry moves by less than that.
constexpr double kFlat = 1e-6;
constexpr double kSlope = 1e-3;  // of the triangle's sides there

uint64_t edge_key(uint32_t a, uint32_t b) {
  return uint64_t{std::min(a, b)} << 32U | std::max(a, b);
}

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Keeps the triangles for which keep[i] holds. @returns how many went
uint64_t filter(Soup& soup, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    soup.triangle[kept] = soup.triangle[i];
    soup.source[kept++] = soup.source[i];
  }
  const uint64_t gone = keep.size() - kept;
  soup.triangle.resize(kept);
  soup.source.resize(kept);
  return gone;
}

/// Marks the triangles of polygons whose points an earlier polygon has. Two copies of a quad may be cut along
/// different diagonals, and then share no triangle.
uint64_t mark_duplicate_polygons(const Soup& soup, std::span<const uint32_t> polygon, std::vector<bool>& keep) {
  uint64_t gone = 0;
  std::map<std::vector<uint32_t>, uint32_t> known;
  for (std::size_t first = 0; first < soup.triangle.size();) {
    std::size_t end = first;
    std::vector<uint32_t> points;
    for (; end < soup.triangle.size() && polygon[soup.source[end]] == polygon[soup.source[first]]; ++end) {
      points.insert(points.end(), soup.triangle[end].begin(), soup.triangle[end].end());
    }
    if (end - first > 1) {
      std::sort(points.begin(), points.end());
      points.erase(std::unique(points.begin(), points.end()), points.end());
      if (!known.try_emplace(std::move(points), 0).second) {
        std::fill(keep.begin() + static_cast<std::ptrdiff_t>(first), keep.begin() + static_cast<std::ptrdiff_t>(end),
                  false);
        ++gone;
      }
    }
    first = end;
  }
  return gone;
}

/// Triangles with the same three points are of one class.
struct Classes {
  std::vector<uint32_t> order;                          ///< triangles, by class, as they come in each
  std::vector<uint32_t> of;                             ///< per triangle: its class; kNone where it is not kept
  std::vector<std::pair<std::size_t, std::size_t>> at;  ///< per class: begin and end in `order`
};

Classes classes_of(const Soup& soup, const std::vector<bool>& keep) {
  Classes classes;
  for (uint32_t i = 0; i < soup.triangle.size(); ++i) {
    if (keep[i]) classes.order.push_back(i);
  }
  std::vector<Triangle> key(soup.triangle.size());
  std::transform(soup.triangle.begin(), soup.triangle.end(), key.begin(), sorted);
  std::stable_sort(classes.order.begin(), classes.order.end(), [&](uint32_t a, uint32_t b) { return key[a] < key[b]; });
  classes.of.assign(soup.triangle.size(), kNone);
  for (std::size_t i = 0; i < classes.order.size(); ++i) {
    const uint32_t t = classes.order[i];
    if (i == 0 || key[t] != key[classes.order[i - 1]]) classes.at.emplace_back(i, i);
    classes.of[t] = static_cast<uint32_t>(classes.at.size() - 1);
    classes.at.back().second = i + 1;
  }
  return classes;
}

bool turns_up(const Triangle& t) {
  const auto least = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return t[(least + 1) % 3] < t[(least + 2) % 3];
}

/// Finds the corners of two layers sewn round the border where a triangle has no vertex but on the border, so that it
/// is one with that of the other layer: two faces that run opposite ways round, or more, with no others at one or two
/// of their edges and one of each layer at the rest. One of them kept would hang on the edge between the layers.
class FlattenedCorners {
 public:
  FlattenedCorners(const Soup& soup, const Classes& classes) : soup_(soup), classes_(classes) {
    for (const uint32_t i : classes.order) {
      const Triangle& t = soup.triangle[i];
      for (std::size_t k = 0; k < 3; ++k) side_.emplace_back(edge_key(t[k], t[(k + 1) % 3]), i);
    }
    std::sort(side_.begin(), side_.end());
  }

  [[nodiscard]] bool is_one(uint32_t c) const {
    const auto [begin, end] = classes_.at[c];
    const auto turns = [&](std::size_t i) { return turns_up(soup_.triangle[classes_.order[i]]); };
    bool both_ways = false;
    for (std::size_t i = begin; i < end; ++i) both_ways = both_ways || turns(i) != turns(begin);
    if (!both_ways) return false;
    const Triangle& t = soup_.triangle[classes_.order[begin]];
    int joined = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<bool> join = is_between_layers(edge_key(t[k], t[(k + 1) % 3]), c);
      if (!join) return false;
      joined += *join ? 1 : 0;
    }
    return joined == 1 || joined == 2;
  }

  /// The two faces beyond an edge of such a class, one of each layer; none at an edge that only the class has.
  [[nodiscard]] std::vector<uint32_t> beyond(uint64_t edge, uint32_t c) const {
    std::vector<uint32_t> faces;
    for (auto s = std::lower_bound(side_.begin(), side_.end(), std::pair(edge, 0U)); s != side_.end(); ++s) {
      if (s->first != edge) break;
      if (classes_.of[s->second] != c) faces.push_back(s->second);
    }
    return faces;
  }

 private:
  /// Whether an edge of a class has two faces of others, each alone in its class; nothing where it has other faces.
  [[nodiscard]] std::optional<bool> is_between_layers(uint64_t edge, uint32_t c) const {
    int others = 0;
    for (auto s = std::lower_bound(side_.begin(), side_.end(), std::pair(edge, 0U)); s != side_.end(); ++s) {
      if (s->first != edge) break;
      const uint32_t other = classes_.of[s->second];
      if (other == c) continue;
      if (classes_.at[other].second - classes_.at[other].first > 1) return std::nullopt;
      ++others;
    }
    return others == 0 || others == 2 ? std::optional(others == 2) : std::nullopt;
  }

  const Soup& soup_;
  const Classes& classes_;
  std::vector<std::pair<uint64_t, uint32_t>> side_;  ///< (edge, triangle), ascending
};

bool runs(const Triangle& t, uint32_t from, uint32_t to) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (t[k] == from) return t[(k + 1) % 3] == to;
  }
  return false;
}

/// An edge of a flattened corner, from where on the layers are apart, and each layer's faces at it.
struct CornerEdge {
  uint32_t a, b;                                 // points
  std::array<std::array<uint32_t, 2>, 2> layer;  // triangles: that in the corner and that beyond
};

/// @param corner  the two triangles over the same points, which run opposite ways round
/// @param beyond  those on the other side, of which as many follow on each of them as can be told by their ways round
CornerEdge corner_edge(const Soup& soup, uint32_t a, uint32_t b, const std::array<uint32_t, 2>& corner,
                       const std::vector<uint32_t>& beyond) {
  const bool follows = runs(soup.triangle[beyond[0]], a, b) != runs(soup.triangle[corner[0]], a, b);
  const auto of_first = follows ? std::size_t{0} : std::size_t{1};
  return {a, b, {{{corner[0], beyond[of_first]}, {corner[1], beyond[1 - of_first]}}}};
}

/// Splits both of a layer's faces at such an edge near its middle, by a point that the other layer does not have: so
/// the corner keeps both of its layers, and they hang together on the border alone.
/// @param parts  per triangle: what it has been split into so far
void split_between_layers(Soup& soup, const CornerEdge& edge, std::map<uint32_t, std::vector<uint32_t>>& parts) {
  constexpr std::array kShares{0.45, 0.55};  // different points have different places
  for (std::size_t i = 0; i < kShares.size(); ++i) {
    const auto middle = static_cast<uint32_t>(soup.position.size());
    const Point3 a = soup.position[edge.a], b = soup.position[edge.b];
    soup.position.push_back(a + (b - a) * kShares[i]);
    for (const uint32_t face : edge.layer[i]) {
      std::vector<uint32_t>& pieces = parts.try_emplace(face, 1, face).first->second;
      const auto has = [&](uint32_t t, uint32_t p) { return std::ranges::count(soup.triangle[t], p) > 0; };
      const auto piece = std::ranges::find_if(pieces, [&](uint32_t t) { return has(t, edge.a) && has(t, edge.b); });
      if (piece == pieces.end()) continue;
      const Triangle whole = soup.triangle[*piece];
      Triangle second = whole;
      *std::ranges::find(soup.triangle[*piece], edge.b) = middle;
      *std::ranges::find(second, edge.a) = middle;
      pieces.push_back(static_cast<uint32_t>(soup.triangle.size()));
      soup.triangle.push_back(second);
      soup.source.push_back(soup.source[face]);
    }
  }
}

double area_of(const Soup& soup, const Triangle& t) {
  return triangle_area(soup.position[t[0]], soup.position[t[1]], soup.position[t[2]]);
}

/// Marks all triangles of a class but the first. Both of a flattened corner stay, with an edge for each layer, unless
/// it is so small that nobody misses it, as those are that rounded coordinates make: then both go, which joins the
/// layers.
uint64_t mark_duplicate_triangles(Soup& soup, std::vector<bool>& keep) {
  const Classes classes = classes_of(soup, keep);
  if (classes.at.size() == classes.order.size()) return 0;
  constexpr double kMissed = 1e-4;  // of all area
  double least = 0;
  for (const Triangle& t : soup.triangle) least += kMissed * area_of(soup, t);
  const FlattenedCorners corners(soup, classes);
  std::vector<CornerEdge> edges;
  for (uint32_t c = 0; c < classes.at.size(); ++c) {
    const auto [begin, end] = classes.at[c];
    if (end - begin == 1) continue;
    for (std::size_t i = begin + 1; i < end; ++i) keep[classes.order[i]] = false;
    if (!corners.is_one(c)) continue;
    const Triangle t = soup.triangle[classes.order[begin]];
    if (area_of(soup, t) < least) {
      keep[classes.order[begin]] = false;
      continue;
    }
    std::size_t other = begin + 1;
    while (turns_up(soup.triangle[classes.order[other]]) == turns_up(t)) ++other;
    keep[classes.order[other]] = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      const std::vector<uint32_t> beyond = corners.beyond(edge_key(a, b), c);
      if (!beyond.empty())
        edges.push_back(corner_edge(soup, a, b, {classes.order[begin], classes.order[other]}, beyond));
    }
  }
  const auto gone = static_cast<uint64_t>(
      std::count_if(classes.order.begin(), classes.order.end(), [&](uint32_t i) { return !keep[i]; }));
  std::map<uint32_t, std::vector<uint32_t>> parts;
  for (const CornerEdge& edge : edges) split_between_layers(soup, edge, parts);
  keep.resize(soup.triangle.size(), true);
  return gone;
}

/// Finds triangles of double-sided sheets whose back is cut along the other diagonals: two triangles across a diagonal
/// from two others over the same four points, about flat, where more than two faces meet at an edge around them.
class BackFinder {
 public:
  BackFinder(const Soup& soup, const std::vector<bool>& keep) : soup_(soup), keep_(keep) {
    for (uint32_t i = 0; i < soup.triangle.size(); ++i) {
      const Triangle& t = soup.triangle[i];
      for (uint32_t k = 0; k < 3 && keep[i]; ++k) side_.emplace_back(edge_key(t[k], t[(k + 1) % 3]), 3 * i + k);
    }
    std::sort(side_.begin(), side_.end());
  }

  std::vector<uint32_t> find() {
    if (!any_crowded()) return {};
    for (uint32_t i = 0; i < soup_.triangle.size(); ++i) {
      for (uint32_t k = 0; k < 3 && keep_[i]; ++k) find_beyond(i, k);
    }
    return found_;
  }

 private:
  using Side = std::pair<uint64_t, uint32_t>;   // edge; 3 * triangle + corner from which it runs
  static constexpr std::size_t kMostSides = 8;  // at an edge; two sheets make four, and pairs of many take for ever

  [[nodiscard]] std::span<const Side> sides_at(uint32_t a, uint32_t b) const {
    const auto [first, end] = std::equal_range(side_.begin(), side_.end(), Side{edge_key(a, b), 0},
                                               [](const Side& x, const Side& y) { return x.first < y.first; });
    return {first, end};
  }
  [[nodiscard]] bool is_crowded(uint32_t a, uint32_t b) const { return sides_at(a, b).size() > 2; }
  [[nodiscard]] bool any_crowded() const {
    for (std::size_t i = 2; i < side_.size(); ++i) {
      if (side_[i].first == side_[i - 2].first) return true;
    }
    return false;
  }

  [[nodiscard]] uint32_t apex(const Side& side) const {
    return soup_.triangle[side.second / 3][(side.second % 3 + 2) % 3];
  }

  /// The triangle over an edge and a point that comes after the first; kNone where there is none.
  [[nodiscard]] uint32_t find_over(uint32_t a, uint32_t b, uint32_t c, uint32_t first) const {
    for (const Side& side : sides_at(a, b)) {
      const uint32_t i = side.second / 3;
      if (i > first && keep_[i] && apex(side) == c) return i;
    }
    return kNone;
  }

  /// Do two triangles, on a-b from both sides, lie about flat?
  [[nodiscard]] bool is_flat(uint32_t a, uint32_t b, uint32_t c, uint32_t d) const {
    constexpr double kMostFolded = 0.5;  // cosine
    const auto at = [&](uint32_t p) -> const Point3& { return soup_.position[p]; };
    const Point3 one = cross(at(b) - at(a), at(c) - at(a)), other = cross(at(d) - at(a), at(b) - at(a));
    return dot(one, other) >= kMostFolded * std::sqrt(dot(one, one) * dot(other, other));
  }

  /// What is cut otherwise than a triangle and one beyond its side.
  void find_beyond(uint32_t i, uint32_t k) {
    const Triangle& t = soup_.triangle[i];
    const uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const std::span<const Side> sides = sides_at(a, b);
    if (sides.size() > kMostSides) return;
    for (const Side& side : sides) {
      const uint32_t d = apex(side);
      if (side.second / 3 <= i || !keep_[side.second / 3] || d == c) continue;
      const uint32_t over_a = find_over(c, d, a, i), over_b = find_over(c, d, b, i);
      if (over_a == kNone || over_b == kNone || !is_flat(a, b, c, d) || !is_flat(c, d, a, b)) continue;
      if (!is_crowded(a, c) && !is_crowded(c, b) && !is_crowded(b, d) && !is_crowded(d, a)) continue;
      for (const uint32_t over : {over_a, over_b}) {
        keep_[over] = false;
        found_.push_back(over);
      }
      return;
    }
  }

  const Soup& soup_;
  std::vector<bool> keep_;
  std::vector<Side> side_;  // ascending
  std::vector<uint32_t> found_;
};

/// Marks the backs of parts that are double-sided, with the duplicates among them, for the greater part: a single flat
/// pillow is what it is.
uint64_t mark_backs(const Soup& soup, std::vector<bool>& keep) {
  constexpr double kLeastShare = 0.25;  // of a part's triangles; with a whole back it is a half
  const std::vector<uint32_t> found = BackFinder(soup, keep).find();
  if (found.empty()) return 0;
  DisjointSets parts(soup.position.size());
  for (const Triangle& t : soup.triangle) {
    parts.join(t[0], t[1]);
    parts.join(t[1], t[2]);
  }
  std::vector<uint32_t> all(soup.position.size(), 0), doubled(soup.position.size(), 0);  // by a part's first point
  const auto part_of = [&](std::size_t i) { return parts.find(soup.triangle[i][0]); };
  for (std::size_t i = 0; i < soup.triangle.size(); ++i) {
    ++all[part_of(i)];
    if (!keep[i]) ++doubled[part_of(i)];
  }
  for (const uint32_t i : found) ++doubled[part_of(i)];
  uint64_t gone = 0;
  for (const uint32_t i : found) {
    if (doubled[part_of(i)] < kLeastShare * all[part_of(i)]) continue;
    keep[i] = false;
    ++gone;
  }
  return gone;
}

/// Triangles by edge, kept up while triangles change.
class CapRemover {
 public:
  explicit CapRemover(Soup& soup) : soup_(soup), keep_(soup.triangle.size(), true) {
    for (uint32_t i = 0; i < soup.triangle.size(); ++i) enqueue_if_flat(i);
    if (queue_.empty()) return;
    for (uint32_t i = 0; i < soup.triangle.size(); ++i) link(i);
  }

  uint64_t run() {
    // Longest side first: the sides that come in are shorter then, and the work ends. The bound is for rounding.
    uint64_t budget = 16 * soup_.triangle.size() + 1024;
    uint64_t removed = 0;
    while (!queue_.empty() && budget-- > 0) {
      const uint32_t i = queue_.top().triangle;
      queue_.pop();
      if (!keep_[i]) continue;
      const auto flat = flat_side(i);
      if (!flat) continue;
      remove(i, flat->corner);
      ++removed;
    }
    filter(soup_, keep_);
    return removed;
  }

 private:
  struct Flat {
    double length;
    uint32_t corner = 0;  ///< the longest side runs from this corner to the next
    uint32_t triangle = 0;
    bool operator<(const Flat& o) const { return length != o.length ? length < o.length : triangle > o.triangle; }
  };

  const Point3& at(uint32_t point) const { return soup_.position[point]; }

  std::optional<Flat> flat_side(uint32_t i) const {
    const Triangle& t = soup_.triangle[i];
    Flat flat{0, 0, i};
    for (uint32_t k = 0; k < 3; ++k) {
      const double l = distance(at(t[k]), at(t[(k + 1) % 3]));
      if (l > flat.length) flat = {l, k, i};
    }
    const Point3 &a = at(t[flat.corner]), &b = at(t[(flat.corner + 1) % 3]), &c = at(t[(flat.corner + 2) % 3]);
    const Foot foot = foot_on(a, b, c);
    // A needle keeps its area as long as that can be computed: its corners are different points of the surface. Beside
    // an end of the side a point has to be the nearer to it, or what is taken away here comes back as the next triangle
    // round that end.
    const bool between = foot.at > kFlat && foot.at < 1 - kFlat;
    const double beside = std::min(foot.at, 1 - foot.at);
    const bool on_side = between && foot.height <= std::min(kFlat, kSlope * beside) * flat.length;
    const bool line = on_side || !(triangle_area(a, b, c) > 0);
    return line ? std::optional(flat) : std::nullopt;
  }

  void enqueue_if_flat(uint32_t i) {
    if (const auto flat = flat_side(i)) queue_.push(*flat);
  }

  void link(uint32_t i) {
    const Triangle& t = soup_.triangle[i];
    for (std::size_t k = 0; k < 3; ++k) faces_[edge_key(t[k], t[(k + 1) % 3])].push_back(i);
  }

  void unlink(uint32_t i) {
    const Triangle& t = soup_.triangle[i];
    for (std::size_t k = 0; k < 3; ++k) std::erase(faces_[edge_key(t[k], t[(k + 1) % 3])], i);
  }

  /// Takes triangle i away and puts its middle point into the side a-b of every other face there.
  void remove(uint32_t i, uint32_t corner) {
    const Triangle t = soup_.triangle[i];
    const uint32_t a = t[corner], b = t[(corner + 1) % 3], middle = t[(corner + 2) % 3];
    unlink(i);
    keep_[i] = false;
    const std::vector<uint32_t> others = faces_[edge_key(a, b)];
    for (const uint32_t f : others) {
      unlink(f);
      const Triangle whole = soup_.triangle[f];
      if (std::find(whole.begin(), whole.end(), middle) != whole.end()) {
        keep_[f] = false;  // the same three points again
        continue;
      }
      Triangle first = whole, second = whole;
      *std::find(first.begin(), first.end(), b) = middle;
      *std::find(second.begin(), second.end(), a) = middle;
      soup_.triangle[f] = first;
      soup_.triangle.push_back(second);
      soup_.source.push_back(soup_.source[f]);
      keep_.push_back(true);
      for (const uint32_t n : {f, static_cast<uint32_t>(soup_.triangle.size() - 1)}) {
        link(n);
        enqueue_if_flat(n);
      }
    }
  }

  Soup& soup_;
  std::vector<bool> keep_;
  std::unordered_map<uint64_t, std::vector<uint32_t>> faces_;
  std::priority_queue<Flat> queue_;
};

}  // namespace

std::vector<BorderSide> border_sides(std::span<const Triangle> triangles) {
  std::vector<std::pair<uint64_t, uint32_t>> sides;
  sides.reserve(triangles.size() * 3);
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    for (uint32_t k = 0; k < 3; ++k) sides.emplace_back(edge_key(t[k], t[(k + 1) % 3]), 3 * i + k);
  }
  std::sort(sides.begin(), sides.end());
  std::vector<BorderSide> border;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool alone = (i == 0 || sides[i - 1].first != sides[i].first) &&
                       (i + 1 == sides.size() || sides[i + 1].first != sides[i].first);
    if (alone) border.push_back({sides[i].second / 3, sides[i].second % 3});
  }
  std::sort(border.begin(), border.end(), [](const BorderSide& a, const BorderSide& b) {
    return a.triangle != b.triangle ? a.triangle < b.triangle : a.corner < b.corner;
  });
  return border;
}

uint64_t drop_collapsed(Soup& soup) {
  std::vector<bool> keep(soup.triangle.size());
  std::transform(soup.triangle.begin(), soup.triangle.end(), keep.begin(),
                 [](const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; });
  return filter(soup, keep);
}

uint64_t drop_duplicates(Soup& soup, std::span<const uint32_t> polygon) {
  std::vector<bool> keep(soup.triangle.size(), true);
  uint64_t gone = polygon.empty() ? 0 : mark_duplicate_polygons(soup, polygon, keep);
  gone += mark_duplicate_triangles(soup, keep);
  gone += mark_backs(soup, keep);
  filter(soup, keep);
  return gone;
}

uint64_t flatten_caps(Soup& soup) {
  return CapRemover(soup).run();
}

}  // namespace geocloth
