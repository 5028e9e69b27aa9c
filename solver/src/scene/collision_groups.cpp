// SPDX-License-Identifier: Apache-2.0
#include "scene/collision_groups.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace geocloth {
namespace {

constexpr size_t kMostGroups = 32;

/// For each collider whether a list of names has it.
std::vector<bool> named(const JsonReader& list, const Scene& scene) {
  std::vector<std::string_view> known;
  for (const SceneCollider& c : scene.colliders) {
    if (!c.collider.name.empty()) known.emplace_back(c.collider.name);
  }
  std::vector<bool> out(scene.colliders.size(), false);
  for (const JsonReader& entry : list.elements()) {
    const std::string name = entry.text();
    const auto is_it = [&](const SceneCollider& c) { return !name.empty() && c.collider.name == name; };
    const auto it = std::find_if(scene.colliders.begin(), scene.colliders.end(), is_it);
    if (it == scene.colliders.end()) {
      entry.fail(known.empty() ? "there is no collider with a \"name\""
                               : "there is no collider " + in_quotes(name) + nearest_and_all(name, known));
    }
    out[static_cast<size_t>(it - scene.colliders.begin())] = true;
  }
  return out;
}

/// For each collider whether a cloth meets it.
std::vector<bool> met_by(const JsonReader& cloth, const Scene& scene) {
  const bool some = cloth.has("collides_with"), others = cloth.has("ignores");
  if (some && others) cloth.at("ignores").fail("and \"collides_with\" say the same; leave out one of them");
  if (some) return named(cloth.at("collides_with"), scene);
  std::vector<bool> met(scene.colliders.size(), true);
  if (!others) return met;
  met = named(cloth.at("ignores"), scene);
  met.flip();
  return met;
}

}  // namespace

void read_collision_groups(const JsonReader& json, Scene& scene) {
  std::vector<std::vector<bool>> met;
  for (const JsonReader& cloth : json.at("cloths").elements()) met.push_back(met_by(cloth, scene));
  const auto meets_all = [](const std::vector<bool>& cloth) { return std::ranges::find(cloth, false) == cloth.end(); };
  if (std::ranges::all_of(met, meets_all)) return;
  // Colliders that the same cloths meet are one group.
  std::map<std::vector<bool>, uint32_t> groups;
  std::vector<uint32_t> meets(met.size(), 0);
  for (size_t i = 0; i < scene.colliders.size(); ++i) {
    std::vector<bool> meeting(met.size());
    for (size_t c = 0; c < met.size(); ++c) meeting[c] = met[c][i];
    const auto [it, is_new] = groups.try_emplace(meeting, static_cast<uint32_t>(groups.size()));
    if (groups.size() > kMostGroups) {
      json.at("colliders").fail("the cloths part these into more than 32 groups by what they meet", ErrorCode::limit);
    }
    scene.colliders[i].collider.groups = 1U << it->second;
    for (size_t c = 0; is_new && c < met.size(); ++c) meets[c] |= meeting[c] ? 1U << it->second : 0U;
  }
  for (size_t c = 0; c < met.size(); ++c) scene.cloths[c].meets = meets[c];
}

}  // namespace geocloth
