// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/file_points.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include <assimp/fast_atof.h>
#include <assimp/mesh.h>

namespace geocloth::import_detail {
namespace {

struct NoNumber : std::exception {
  template <typename... What>
  explicit NoNumber(const What&... /*what*/) {}
};

}  // namespace

float assimp_number(std::string_view word) {
  constexpr std::size_t kLongest = 30;  // assimp 5.2.5 cuts off what is longer in FBX files
  std::array<char, kLongest + 1> text{};
  word.copy(text.data(), kLongest);
  float value = 0;
  try {
    Assimp::fast_atoreal_move<float, NoNumber>(text.data(), value);
  } catch (const NoNumber&) {
    return std::numeric_limits<float>::quiet_NaN();
  }
  return value;
}

FilePoints::FilePoints(std::string name, std::vector<FilePoint> position, std::vector<uint32_t> corner)
    : name_(std::move(name)), position_(std::move(position)), corner_(std::move(corner)) {
  const auto is_finite = [](const FilePoint& p) {
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
  };
  if (!std::all_of(position_.begin(), position_.end(), is_finite)) return;
  by_place_.resize(position_.size());
  for (uint32_t i = 0; i < by_place_.size(); ++i) by_place_[i] = i;
  std::stable_sort(by_place_.begin(), by_place_.end(),
                   [&](uint32_t a, uint32_t b) { return position_[a] < position_[b]; });
  first_at_.resize(by_place_.size());
  uint32_t first = 0;
  for (const uint32_t i : by_place_) {
    if (position_[i] != position_[first] || i == by_place_[0]) first = i;
    first_at_[i] = first;
  }
}

std::optional<uint32_t> FilePoints::find(const FilePoint& place) const {
  const auto found = std::lower_bound(by_place_.begin(), by_place_.end(), place,
                                      [&](uint32_t a, const FilePoint& p) { return position_[a] < p; });
  if (found == by_place_.end() || position_[*found] != place) return std::nullopt;
  return *found;
}

bool FilePoints::have_all_of(const aiMesh& mesh) const {
  return std::all_of(mesh.mVertices, mesh.mVertices + mesh.mNumVertices, [&](const aiVector3D& p) {
    return find({p.x, p.y, p.z}).has_value();
  });
}

std::vector<uint32_t> FilePoints::points_of(const aiMesh& mesh) const {
  std::vector<uint32_t> points;
  points.reserve(mesh.mNumVertices);
  for (const aiVector3D& p : std::span(mesh.mVertices, mesh.mNumVertices)) {
    const FilePoint place{p.x, p.y, p.z};
    const std::size_t i = points.size();
    const bool is_known = corner_.size() == mesh.mNumVertices && corner_[i] < size() && position_[corner_[i]] == place;
    points.push_back(is_known ? corner_[i] : find(place).value());
  }
  return points;
}

std::size_t find_points(std::span<const FilePoints> of, const aiMesh& mesh) {
  const std::string_view name = mesh.mName.C_Str();
  const auto find = [&](bool named) {
    std::size_t best = of.size();
    for (std::size_t i = 0; i < of.size(); ++i) {
      if ((of[i].name() == name) != named || (best < of.size() && of[best].size() <= of[i].size())) continue;
      if (of[i].have_all_of(mesh)) best = i;
    }
    return best;
  };
  const std::size_t named = find(true);
  return named < of.size() ? named : find(false);
}

}  // namespace geocloth::import_detail
