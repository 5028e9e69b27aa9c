// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/mesh_warnings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kApart = 1e-4;  // of the size: safely not one place

bool is_notable(uint64_t count, double share, std::size_t of) {
  return count > 0 && static_cast<double>(count) >= share * static_cast<double>(of);
}

}  // namespace

std::optional<std::string> warning_of_spacing(double spacing, double asked) {
  constexpr double kMuch = 0.1;  // of what was asked for
  if (asked <= 0 || std::abs(spacing / asked - 1) <= kMuch) return std::nullopt;
  char text[256];
  std::snprintf(text, sizeof text,
                "springs are %.3g m long instead of %.3g m, as the cloth's size and seams want; give another --spacing",
                spacing, asked);
  return text;
}

std::optional<std::string> warning_of_coarse_triangles(const ClothAsset& asset) {
  constexpr double kCoarse = 8;  // pixels
  const double size = drawn_triangle_size(asset);
  if (size <= kCoarse) return std::nullopt;
  char text[256];
  std::snprintf(
      text, sizeof text,
      "the mesh is coarse: its triangles are about %.0f pixels across, and finer folds of the cloth would not "
      "be drawn; --refine 2 divides them",
      size);
  return text;
}

std::optional<std::string> warning_of_cracks(const Cracks& cracks) {
  constexpr uint32_t kFew = 8;
  constexpr double kSmallShare = 0.05;  // of the border: slits, and layers that end beside each other
  if (cracks.edges < kFew || cracks.edges < kSmallShare * cracks.of_edges) return std::nullopt;
  constexpr double kMore = 1.1;  // what is said in three digits is to reach the widest
  char text[256];
  std::snprintf(text, sizeof text,
                "%u of the %u edges on the border lie beside others, up to %.3g m apart: where the garment should hold "
                "together there, give --weld %.3g",
                cracks.edges, cracks.of_edges, cracks.widest, kMore * cracks.widest);
  return text;
}

std::optional<std::string> warning_of_thickness(const std::optional<double>& thickness) {
  if (!thickness) return std::nullopt;
  char text[256];
  std::snprintf(text, sizeof text,
                "the cloth has a thickness of %.2g m: its two sides move each for itself and show through each other; "
                "--one-layer simulates one side, which the other one rides on",
                *thickness);
  return text;
}

std::optional<std::string> warning_of_folds(const RepairResult& repaired, std::size_t triangles, double size) {
  constexpr double kNotable = 0.01;  // of all triangles
  if (!is_notable(repaired.folded_faces, kNotable, triangles)) return std::nullopt;
  char text[320];
  std::snprintf(text, sizeof text,
                "%llu triangles lie exactly on others that they hang together with, and are left out: where that is a "
                "garment folded flat, move its layers apart in a modelling program; %.1g m is enough",
                static_cast<unsigned long long>(repaired.folded_faces), kApart * size);
  return text;
}

std::optional<std::string> warning_of_touching(const RepairResult& repaired, double size) {
  constexpr double kNotable = 0.002;  // of all vertices
  if (!is_notable(repaired.touching_points, kNotable, repaired.surface.position.size())) return std::nullopt;
  char text[320];
  std::snprintf(text, sizeof text,
                "folds or surfaces that the file keeps apart touch in %llu points and are joined there, so that they "
                "cannot open: where they are not sewn, move them apart in a modelling program; %.1g m is enough",
                static_cast<unsigned long long>(repaired.touching_points), kApart * size);
  return text;
}

std::optional<std::string> warning_of_loose_pieces(const LoosePiecesLeft& loose) {
  if (loose.count == 0) return std::nullopt;
  const bool one = loose.count == 1;
  const char* them = one ? "it" : "them";
  const std::string riders =
      loose.would_ride < loose.count ? std::to_string(loose.would_ride) + " of them" : std::string(them);
  const std::string ride = loose.would_ride == 0 ? "" : "let " + riders + " ride on the cloth with --carry-loose, ";
  char text[400];
  std::snprintf(text, sizeof text,
                "%u %s%s, up to %.3g m across, %s attached to nothing and will fall or float by %s: %smerge %s with "
                "the cloth in a modelling program, or leave %s out with --parts",
                loose.count, loose.are_small ? "small " : "", one ? "piece" : "pieces", loose.across,
                one ? "is" : "are", one ? "itself" : "themselves", ride.c_str(), them, them);
  return text;
}

std::string warning_of_move(const Point3& way) {
  char text[256];
  std::snprintf(text, sizeof text,
                "the mesh lies %.3g m from the origin, too far for single precision: the asset is moved by (%.9g, "
                "%.9g, %.9g) m to the origin; move it there in the file to have it where colliders are",
                length(way), way[0], way[1], way[2]);
  return text;
}

std::optional<std::string> warning_of_far_vertices(const TriangleMesh& mesh, const Point3& moved, double spacing) {
  constexpr std::size_t kFewest = 8;
  constexpr double kNearlyAll = 0.99;
  constexpr double kMuchFarther = 20;  // than nearly all of the vertices
  std::vector<bool> is_used(mesh.position.size(), false);
  for (const Triangle& t : mesh.triangle) {
    for (const uint32_t v : t) is_used[v] = true;
  }
  std::vector<uint32_t> used;
  for (uint32_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v]) used.push_back(v);
  }
  if (used.size() < kFewest) return std::nullopt;
  Point3 median{};
  const auto middle = used.begin() + static_cast<std::ptrdiff_t>(used.size() / 2);
  for (std::size_t k = 0; k < 3; ++k) {
    std::nth_element(used.begin(), middle, used.end(),
                     [&](uint32_t a, uint32_t b) { return mesh.position[a][k] < mesh.position[b][k]; });
    median[k] = mesh.position[*middle][k];
  }
  const auto away = [&](uint32_t v) { return distance(mesh.position[v], median); };
  const auto nearer = [&](uint32_t a, uint32_t b) {
    const double p = away(a), q = away(b);
    return p != q ? p < q : a > b;
  };
  const auto last_near = used.begin() + static_cast<std::ptrdiff_t>(kNearlyAll * static_cast<double>(used.size() - 1));
  std::nth_element(used.begin(), last_near, used.end(), nearer);
  const double near = away(*last_near);
  const bool is_in_pixel = 2 * near < spacing;
  const double least = is_in_pixel ? spacing / 2 : kMuchFarther * near;
  const auto far = std::count_if(last_near, used.end(), [&](uint32_t v) { return away(v) > near && away(v) >= least; });
  if (far == 0) return std::nullopt;
  const uint32_t farthest = *std::max_element(last_near, used.end(), nearer);
  const Point3 place = mesh.position[farthest] - moved;
  char text[320];
  std::snprintf(
      text, sizeof text,
      "vertex %u of the file, counted from 1, lies far from the others, at (%.9g, %.9g, %.9g) m%s: all the rest "
      "is %s %.3g m; remove it if it is a stray one",
      farthest + 1, place[0], place[1], place[2],
      far > 1 ? (", and " + std::to_string(far - 1) + " more do").c_str() : "",
      is_in_pixel ? "smaller than a pixel of" : "within", is_in_pixel ? spacing : near);
  return text;
}

}  // namespace geocloth
