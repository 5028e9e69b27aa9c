// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a mesh as its file numbers them. assimp makes of FBX and DAE a vertex for every corner of a face and
// keeps no number; what it keeps to the bit is where a point lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct aiMesh;  // of assimp

namespace geocloth::import_detail {

using FilePoint = std::array<float, 3>;  ///< in the unit of the file

/// A number as assimp reads it, which is not always the float nearest to what is written.
[[nodiscard]] float assimp_number(std::string_view word);

class FilePoints {
 public:
  /// @param name      of the mesh, as assimp calls it
  /// @param position  of its points, in the file's order
  /// @param corner    the point of each corner of its faces, in the file's order, where that is known
  FilePoints(std::string name, std::vector<FilePoint> position, std::vector<uint32_t> corner = {});

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::size_t size() const { return position_.size(); }
  [[nodiscard]] const FilePoint& position(std::size_t point) const { return position_[point]; }
  /// The first point at a place.
  [[nodiscard]] std::optional<uint32_t> find(const FilePoint& place) const;
  /// The first point where a point is.
  [[nodiscard]] uint32_t first_at(std::size_t point) const { return first_at_[point]; }
  /// Whether every vertex of a mesh lies at one of the points.
  [[nodiscard]] bool have_all_of(const aiMesh& mesh) const;
  /// Which points the vertices of a mesh are: told apart at one place where the mesh has all corners of the file, else
  /// the first one there.
  /// @param mesh  have_all_of() it
  [[nodiscard]] std::vector<uint32_t> points_of(const aiMesh& mesh) const;

 private:
  std::string name_;
  std::vector<FilePoint> position_;
  std::vector<uint32_t> corner_;
  std::vector<uint32_t> by_place_;  ///< numbers of the points in the order of their places; none if one has no place
  std::vector<uint32_t> first_at_;  ///< of each point, as many as by_place_
};

/// Which of the meshes of a file assimp's mesh was made of: the smallest that has all its points, of its name if one
/// has.
/// @returns its number, or of.size() if it is none of them
[[nodiscard]] std::size_t find_points(std::span<const FilePoints> of, const aiMesh& mesh);

}  // namespace geocloth::import_detail
