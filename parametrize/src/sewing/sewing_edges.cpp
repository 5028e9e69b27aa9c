// SPDX-License-Identifier: GPL-3.0-or-later
// A sewing pattern in a modelling program is panels with edges between their borders, from vertex to vertex, that no
// face has (Blender draws its sewing springs along them). Between two of them that follow each other the seam goes on,
// as it does where one side stays at a vertex, to which the other one is gathered.
#include "sewing/sewing_edges.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace geocloth {
namespace {

class SewingFinder {
 public:
  explicit SewingFinder(const TriangleMesh& mesh) : mesh_(mesh) {
    find_places();
    find_edges();
    find_pairs();
  }

  std::vector<SewingRun> find() {
    taken_.assign(pair_.size(), false);
    std::vector<SewingRun> runs;
    for (uint32_t i = 0; i < pair_.size(); ++i)
      if (!taken_[i]) runs.push_back(run_through(i));
    return runs;
  }

 private:
  using Places = std::array<uint32_t, 2>;

  static Places sorted(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

  /// The place of every vertex that a face or a loose edge has: the first such vertex there.
  void find_places() {
    std::vector<uint32_t> used;
    for (const Triangle& t : mesh_.triangle) used.insert(used.end(), t.begin(), t.end());
    for (const auto& e : mesh_.loose_edge) used.insert(used.end(), e.begin(), e.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto& position = mesh_.position;
    std::stable_sort(used.begin(), used.end(), [&](uint32_t a, uint32_t b) { return position[a] < position[b]; });
    place_.assign(position.size(), kNone);
    for (std::size_t i = 0; i < used.size(); ++i) {
      const bool is_new = i == 0 || position[used[i]] != position[used[i - 1]];
      place_[used[i]] = is_new ? used[i] : place_[used[i - 1]];
    }
  }

  /// Of the mesh, between ends of loose edges: others are on no seam.
  void find_edges() {
    std::vector<bool> is_end(mesh_.position.size(), false);
    for (const auto& e : mesh_.loose_edge)
      for (const uint32_t end : e) is_end[place_[end]] = true;
    on_face_.assign(mesh_.position.size(), false);
    for (const Triangle& t : mesh_.triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        const uint32_t a = place_[t[k]], b = place_[t[(k + 1) % 3]];
        on_face_[a] = true;
        if (a != b && is_end[a] && is_end[b]) ++faces_[sorted(a, b)];
      }
    }
    for (const auto& [edge, count] : faces_) {
      beside_[edge[0]].push_back(edge[1]);
      beside_[edge[1]].push_back(edge[0]);
    }
  }

  void find_pairs() {
    for (const auto& e : mesh_.loose_edge) {
      const uint32_t a = place_[e[0]], b = place_[e[1]];
      if (a == b || !on_face_[a] || !on_face_[b] || faces_.contains(sorted(a, b))) continue;
      if (number_.try_emplace(sorted(a, b), static_cast<uint32_t>(pair_.size())).second) pair_.push_back({a, b});
    }
  }

  struct Next {
    uint32_t number;
    Places pair;  ///< with the sides of the pair that it follows
  };

  /// Pairs one edge further on one side, where the other one is gathered, and then those further on both.
  [[nodiscard]] std::vector<Next> neighbors(const Places& pair) const {
    std::vector<Next> found;
    const auto add = [&](uint32_t a, uint32_t b) {
      const auto number = number_.find(sorted(a, b));
      if (number != number_.end()) found.push_back({number->second, {a, b}});
    };
    const std::span<const uint32_t> first = beside(pair[0]), second = beside(pair[1]);
    for (const uint32_t a : first) add(a, pair[1]);
    for (const uint32_t b : second) add(pair[0], b);
    for (const uint32_t a : first)
      for (const uint32_t b : second) add(a, b);
    return found;
  }

  /// Ends of loose edges that are an edge of the mesh away. Of a vertex with very many nobody can say how a seam goes
  /// on.
  [[nodiscard]] std::span<const uint32_t> beside(uint32_t place) const {
    constexpr std::size_t kMost = 64;
    const auto found = beside_.find(place);
    if (found == beside_.end() || found->second.size() > kMost) return {};
    return found->second;
  }

  /// From a pair on in one direction and then in the other one.
  SewingRun run_through(uint32_t first) {
    SewingRun run{{pair_[first]}, {}};
    taken_[first] = true;
    std::array<std::set<uint32_t>, 2> passed{{{pair_[first][0]}, {pair_[first][1]}}};
    if (go_on(run, passed)) return run;
    std::reverse(run.pair.begin(), run.pair.end());
    std::reverse(run.on_border.begin(), run.on_border.end());
    go_on(run, passed);
    return run;
  }

  /// @param passed  the run's places on each side, to which it does not come back
  /// @returns whether it has gone round
  bool go_on(SewingRun& run, std::array<std::set<uint32_t>, 2>& passed) {
    // Of a side that stays the next edge will tell.
    const auto is_border = [&](uint32_t a, uint32_t b) { return a == b || faces_.at(sorted(a, b)) == 1; };
    while (true) {
      const Places pair = run.pair.back();
      const auto leads_on = [&](const Next& next) {
        if (run.pair.size() > 2 && next.pair == run.pair.front()) return true;
        const auto is_new = [&](std::size_t s) { return next.pair[s] == pair[s] || !passed[s].contains(next.pair[s]); };
        return !taken_[next.number] && is_new(0) && is_new(1);
      };
      const std::vector<Next> around = neighbors(pair);
      const auto next = std::find_if(around.begin(), around.end(), leads_on);
      if (next == around.end()) return false;
      run.pair.push_back(next->pair);
      run.on_border.push_back({is_border(pair[0], next->pair[0]), is_border(pair[1], next->pair[1])});
      if (taken_[next->number]) return true;
      taken_[next->number] = true;
      for (std::size_t side = 0; side < 2; ++side) passed[side].insert(next->pair[side]);
    }
  }

  const TriangleMesh& mesh_;
  std::vector<uint32_t> place_;       ///< per vertex
  std::vector<bool> on_face_;         ///< per place
  std::map<Places, uint32_t> faces_;  ///< how many triangles edges have
  std::map<uint32_t, std::vector<uint32_t>> beside_;
  std::vector<Places> pair_;
  std::map<Places, uint32_t> number_;  ///< of pairs
  std::vector<bool> taken_;
};

}  // namespace

uint32_t count_edges(std::span<const SewingRun> runs) {
  std::size_t edges = 0;
  for (const SewingRun& run : runs) {
    const bool goes_round = run.pair.size() > 1 && run.pair.front() == run.pair.back();
    edges += run.pair.size() - (goes_round ? 1 : 0);
  }
  return static_cast<uint32_t>(edges);
}

std::vector<SewingRun> find_sewing(const TriangleMesh& mesh) {
  if (mesh.loose_edge.empty()) return {};
  return SewingFinder(mesh).find();
}

}  // namespace geocloth
