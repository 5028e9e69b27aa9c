// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "geocloth/asset/topology.h"
#include "geocloth/asset/vec.h"

namespace geocloth {

/// When the animation of a file plays, and what it shows.
struct AnimationOptions {
  /// Name of the animation, what of it is behind a bar ("Armature|Walk" of Blender), or its number in the file from 0;
  /// empty: the first one; "*": all of them at once, of which the later one counts where two move the same.
  std::string clip = {};
  /// [s] >= 0. Before, the nodes go evenly from where they are when the file opens to where the animation begins.
  double start = 0;
  double speed = 1;        ///< > 0: seconds of the animation in a second
  bool loop = false;       ///< begins anew at its end, else it holds its last pose
  std::string parts = {};  ///< which parts of the file, as of select_parts(); empty: all
};

/// [s] Where an animation is at a time [s] >= options.start: it goes at its speed, and begins anew or stays at its end.
/// @param duration  [s] >= 0, of the animation at its own speed
[[nodiscard]] double clip_time(const AnimationOptions& options, double duration, double time);

/// The triangles of a glTF, FBX or DAE file as one of its animations moves nodes, skins and morph targets (not those of
/// DAE). They are those of the scene with which the file opens, the same surface as import_mesh() gives, but of glTF
/// not in its order of vertices. Skins of FBX files open as they are bound, wherever their bones are. What assimp reads
/// of FBX and DAE goes evenly between keys. All that moves in a DAE file is one animation.
class AnimatedMesh {
 public:
  /// Reads everything that playing needs; the file is not needed afterwards.
  /// @throws Error as import_mesh(); Error(unsupported) for a file of another format; Error(invalid_data) when it has
  /// no
  ///   animation or none of that name or number (lists those it has), or when the animation is broken;
  ///   Error(invalid_argument) for options out of range, or when the file has no such parts
  explicit AnimatedMesh(const std::filesystem::path& path, const AnimationOptions& options = {});
  ~AnimatedMesh();
  AnimatedMesh(AnimatedMesh&&) noexcept;
  AnimatedMesh& operator=(AnimatedMesh&&) noexcept;

  /// The same at all times; counter-clockwise seen from outside when the file opens. May be degenerate or duplicated.
  [[nodiscard]] const std::vector<Triangle>& triangle() const;
  /// Of all vertices as the file opens [m], y up: what import_mesh() gives.
  [[nodiscard]] std::vector<Vec3> positions_as_opened() const;
  [[nodiscard]] double duration() const;  ///< [s] >= 0, of the animation at its own speed, from its time 0 on

  /// Of all vertices [m], y up. May be called from several threads at once.
  /// @param time  [s] >= 0. Before `start` a blend; from there on the animation at (time - start) * speed
  /// @throws Error(invalid_argument) for a time out of range, Error(invalid_data) when a vertex comes to a place that
  ///   is not finite or beyond 1e18 m
  [[nodiscard]] std::vector<Vec3> positions_at(double time) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth
