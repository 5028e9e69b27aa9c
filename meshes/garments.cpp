// SPDX-License-Identifier: GPL-3.0-or-later
// Garments as a tailor would make them: flat panels, cut out, triangulated and sewn where their edges meet in space.
// A T-shirt panel is blown up by the solution u of the Poisson equation -lap u = c with u = 0 on its seams: z =
// sqrt(2u) makes every cross-section of a straight piece an exact half ellipse of aspect sqrt(c), smoothly from torso
// to sleeve.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include <Eigen/SparseCholesky>

#include "planar_mesh.h"

namespace geocloth::meshes {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPanelGap = 0.03;      // [m] between panels in texture space
constexpr double kSewTolerance = 1e-5;  // [m] points of panels that meet are one vertex; also the file's last digit

/// Collects panels into one mesh, sews what coincides, and scales the texture coordinates into the unit square.
class Sewing {
 public:
  explicit Sewing(std::string name, std::string comment)
      : mesh_{.name = std::move(name), .comment = std::move(comment)} {}

  /// @param in_space  where a panel vertex is in space
  /// @param flip      the panel's outside is its back
  /// @returns the mesh's vertex for each of the panel's
  std::vector<uint32_t> add(const PlanarMesh& panel, const std::function<Point3(uint32_t)>& in_space,
                            bool flip = false) {
    const auto [low, high] = std::minmax_element(panel.position.begin(), panel.position.end());
    const double shift = right_edge_ - (*low)[0];
    right_edge_ += (*high)[0] - (*low)[0] + kPanelGap;
    const auto first_uv = static_cast<uint32_t>(mesh_.uv.size());
    std::vector<uint32_t> vertex(panel.position.size());
    for (uint32_t i = 0; i < panel.position.size(); ++i) {
      mesh_.uv.push_back({panel.position[i][0] + shift, panel.position[i][1]});
      vertex[i] = vertex_at(in_space(i));
    }
    for (auto t : panel.triangle) {
      if (flip) std::swap(t[1], t[2]);
      mesh_.face.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
      mesh_.face_uv.push_back({first_uv + t[0], first_uv + t[1], first_uv + t[2]});
    }
    return vertex;
  }

  /// Vertices that lie apart and are to be sewn together.
  void sew(uint32_t a, uint32_t b) { mesh_.line.push_back({a, b}); }

  [[nodiscard]] ObjMesh finish() {
    Point2 low = mesh_.uv[0], high = mesh_.uv[0];
    for (const Point2& p : mesh_.uv) {
      for (std::size_t k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
    const double size = std::max(high[0] - low[0], high[1] - low[1]);
    for (Point2& p : mesh_.uv) p = {(p[0] - low[0]) / size, (p[1] - low[1]) / size};
    return std::move(mesh_);
  }

 private:
  uint32_t vertex_at(const Point3& p) {
    const std::array<long, 3> key{std::lround(p[0] / kSewTolerance), std::lround(p[1] / kSewTolerance),
                                  std::lround(p[2] / kSewTolerance)};
    const auto [place, is_new] = vertices_.try_emplace(key, static_cast<uint32_t>(mesh_.position.size()));
    if (is_new) mesh_.position.push_back(p);
    return place->second;
  }

  ObjMesh mesh_;
  std::map<std::array<long, 3>, uint32_t> vertices_;
  double right_edge_ = 0;
};

/// Linear finite elements for -lap u = c(x, y); u = 0 where `fixed`, no flow across the rest of the border.
std::vector<double> solve_poisson(const PlanarMesh& mesh, const std::vector<bool>& fixed,
                                  const std::function<double(const Point2&)>& c) {
  const auto n = static_cast<Eigen::Index>(mesh.position.size());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& t : mesh.triangle) {
    std::array<Point2, 3> opposite{};  // edge opposite to each corner
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2 &a = mesh.position[t[(k + 1) % 3]], &b = mesh.position[t[(k + 2) % 3]];
      opposite[k] = {b[0] - a[0], b[1] - a[1]};
    }
    const double area = 0.5 * (opposite[0][0] * opposite[1][1] - opposite[0][1] * opposite[1][0]);
    for (std::size_t i = 0; i < 3; ++i) {
      if (fixed[t[i]]) continue;
      right[t[i]] += c(mesh.position[t[i]]) * area / 3;
      for (std::size_t j = 0; j < 3; ++j) {
        if (fixed[t[j]]) continue;
        const double dot = opposite[i][0] * opposite[j][0] + opposite[i][1] * opposite[j][1];
        entries.emplace_back(t[i], t[j], dot / (4 * area));
      }
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (fixed[static_cast<std::size_t>(i)]) entries.emplace_back(i, i, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd u = solver.solve(right);
  return {u.begin(), u.end()};
}

/// Moves every vertex towards the middle of its neighbours and then a little further back, which takes out zigzags and
/// keeps the size (Taubin 1995, "A Signal Processing Approach to Fair Surface Design"); those on an opening only along
/// it.
void smooth(ObjMesh& mesh, int rounds) {
  std::map<std::pair<uint32_t, uint32_t>, int> faces_at_edge;
  for (const Face& f : mesh.face) {
    for (std::size_t k = 0; k < f.size(); ++k) ++faces_at_edge[std::minmax(f[k], f[(k + 1) % f.size()])];
  }
  std::vector<bool> on_opening(mesh.position.size(), false);
  for (const auto& [edge, faces] : faces_at_edge) {
    if (faces == 1) on_opening[edge.first] = on_opening[edge.second] = true;
  }
  constexpr double kTowards = 0.5, kBack = -0.53;
  for (int step = 0; step < 2 * rounds; ++step) {
    const double share = step % 2 == 0 ? kTowards : kBack;
    std::vector<Point3> sum(mesh.position.size());
    std::vector<int> count(mesh.position.size());
    const auto pull = [&](uint32_t at, uint32_t to, bool along_opening) {
      if (on_opening[at] && !along_opening) return;
      for (std::size_t k = 0; k < 3; ++k) sum[at][k] += mesh.position[to][k];
      ++count[at];
    };
    for (const auto& [edge, faces] : faces_at_edge) {
      pull(edge.first, edge.second, faces == 1);
      pull(edge.second, edge.first, faces == 1);
    }
    for (std::size_t i = 0; i < mesh.position.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) mesh.position[i][k] += share * (sum[i][k] / count[i] - mesh.position[i][k]);
    }
  }
}

/// Half a T-shirt's outline, the wearer's left (+x), all in metres above the floor.
constexpr Point2 kNeckSide{0.085, 1.46}, kShoulder{0.21, 1.42}, kCuffTop{0.40, 1.25}, kCuffBottom{0.315, 1.155},
    kArmpit{0.235, 1.235}, kHemSide{0.25, 0.86}, kDressHem{0.45, 0.42};

std::vector<Point2> mirrored_and_reversed(std::vector<Point2> points) {
  std::reverse(points.begin(), points.end());
  for (Point2& p : points) p[0] = -p[0];
  return points;
}

/// A shirt's panel: outline counter-clockwise from the left hem corner; `seam` marks outline points on a seam.
struct ShirtPanel {
  PlanarMesh mesh;
  std::vector<bool> on_seam;
};

ShirtPanel make_shirt_panel(const Point2& hem_side, double neck_depth, double spacing) {
  std::vector<Point2> outline;
  std::vector<bool> on_seam;
  // The last point belongs to the next stretch; a corner between a seam and an opening lies on the seam.
  const auto add = [&](const std::vector<Point2>& corners, bool is_seam) {
    for (const Point2& p : sample_polyline(corners, spacing)) {
      const bool corner = p == corners.front();
      outline.push_back(p);
      on_seam.push_back(is_seam || corner);
    }
  };
  std::vector<Point2> neck;
  constexpr int kNeckSteps = 12;
  for (int i = 0; i <= kNeckSteps; ++i) {
    const double angle = kPi * i / kNeckSteps;
    neck.push_back({kNeckSide[0] * std::cos(angle), kNeckSide[1] - neck_depth * std::sin(angle)});
  }
  neck.front() = kNeckSide;
  neck.back() = {-kNeckSide[0], kNeckSide[1]};
  const std::vector<Point2> side{hem_side, kArmpit, kCuffBottom}, cuff{kCuffBottom, kCuffTop},
      top{kCuffTop, kShoulder, kNeckSide};
  add({{-hem_side[0], hem_side[1]}, hem_side}, false);
  add(side, true);
  add(cuff, false);
  add(top, true);
  add(neck, false);
  // Sampled on one side and mirrored, so that both sides carry the same points.
  const auto add_mirrored = [&](const std::vector<Point2>& corners, bool is_seam) {
    std::vector<Point2> samples = sample_polyline(corners, spacing);
    samples.push_back(corners.back());
    samples = mirrored_and_reversed(samples);
    samples.pop_back();
    for (const Point2& p : samples) {
      outline.push_back(p);
      on_seam.push_back(is_seam || p == samples.front());
    }
  };
  add_mirrored(top, true);
  add_mirrored(cuff, false);
  add_mirrored(side, true);

  ShirtPanel panel{triangulate({outline}, spacing), on_seam};
  panel.on_seam.resize(panel.mesh.position.size(), false);
  return panel;
}

/// Front and back, sewn along the sides and over the shoulders.
ObjMesh make_top(const std::string& name, const std::string& comment, const Point2& hem_side) {
  constexpr double kSpacing = 0.025, kFrontNeck = 0.09, kBackNeck = 0.02;
  constexpr double kTorsoAspect = 0.45, kSleeveAspect = 0.9;
  // Depth over width of the cross-section: the torso is flat, sleeves are round.
  const auto curvature = [](const Point2& p) {
    const double t = std::clamp((std::abs(p[0]) - 0.18) / 0.1, 0.0, 1.0);
    const double aspect = kTorsoAspect + (kSleeveAspect - kTorsoAspect) * t * t * (3 - 2 * t);
    return aspect * aspect;
  };
  Sewing sewing(name, comment);
  for (const bool is_front : {true, false}) {
    const ShirtPanel panel = make_shirt_panel(hem_side, is_front ? kFrontNeck : kBackNeck, kSpacing);
    const std::vector<double> u = solve_poisson(panel.mesh, panel.on_seam, curvature);
    const double side = is_front ? 1 : -1;
    sewing.add(
        panel.mesh,
        [&](uint32_t i) {
          const Point2& p = panel.mesh.position[i];
          return Point3{p[0], p[1], side * std::sqrt(2 * std::max(u[i], 0.0))};
        },
        !is_front);
  }
  ObjMesh shirt = sewing.finish();
  // The section's slope is infinite at a seam, which shows the irregular first row of vertices as a zigzag.
  constexpr int kRounds = 80;
  smooth(shirt, kRounds);
  return shirt;
}

ObjMesh make_t_shirt() {
  return make_top("t_shirt", "T-shirt sewn from a front and a back: openings at neck, two cuffs and hem", kHemSide);
}

ObjMesh make_dress() {
  return make_top("dress",
                  "Dress with sleeves, flared, sewn from a front and a back: openings at neck, two cuffs and hem",
                  kDressHem);
}

/// Flat panels before and behind a body, with an edge from each vertex of a seam to the one that it is sewn to. The
/// skirt is wider than the waist, to which it is gathered.
ObjMesh make_dress_pattern() {
  constexpr double kSpacing = 0.025, kFrontNeck = 0.1, kBackNeck = 0.03, kApart = 0.17;  // [m]
  constexpr double kSkirtHalf = 0.4, kSkirtTop = 0.97, kSkirtHem = 0.45;
  constexpr Point2 kWaist{0.2, 1.0};
  Sewing sewing("dress_pattern", "Dress as a sewing pattern: flat panels, and edges between what is sewn together");
  const std::vector<Point2> skirt_outline = sample_polyline({{-kSkirtHalf, kSkirtHem},
                                                             {kSkirtHalf, kSkirtHem},
                                                             {kSkirtHalf, kSkirtTop},
                                                             {-kSkirtHalf, kSkirtTop},
                                                             {-kSkirtHalf, kSkirtHem}},
                                                            kSpacing);
  const PlanarMesh skirt = triangulate({skirt_outline}, kSpacing);
  std::array<std::vector<uint32_t>, 2> bodice_seam, skirt_side;
  for (const bool is_front : {true, false}) {
    const double z = is_front ? kApart : -kApart;
    const std::size_t side = is_front ? 0 : 1;
    const ShirtPanel bodice = make_shirt_panel(kWaist, is_front ? kFrontNeck : kBackNeck, kSpacing);
    const auto placed = [z](const PlanarMesh& panel) {
      return [&panel, z](uint32_t i) { return Point3{panel.position[i][0], panel.position[i][1], z}; };
    };
    const std::vector<uint32_t> top = sewing.add(bodice.mesh, placed(bodice.mesh), !is_front);
    const std::vector<uint32_t> bottom = sewing.add(skirt, placed(skirt), !is_front);
    std::vector<uint32_t> waist, gathered;  // from left to right
    for (uint32_t i = 0; i < top.size(); ++i) {
      if (bodice.on_seam[i]) bodice_seam[side].push_back(top[i]);
      if (bodice.mesh.position[i][1] == kWaist[1]) waist.push_back(i);
    }
    for (uint32_t i = 0; i < skirt_outline.size(); ++i) {
      if (skirt_outline[i][1] == kSkirtTop) gathered.push_back(i);
      const bool on_side = std::abs(skirt_outline[i][0]) == kSkirtHalf && skirt_outline[i][1] < kSkirtTop;
      if (on_side) skirt_side[side].push_back(bottom[i]);
    }
    const auto left_to_right = [](const PlanarMesh& panel) {
      return [&panel](uint32_t a, uint32_t b) { return panel.position[a][0] < panel.position[b][0]; };
    };
    std::sort(waist.begin(), waist.end(), left_to_right(bodice.mesh));
    std::sort(gathered.begin(), gathered.end(), left_to_right(skirt));
    for (std::size_t i = 0; i < gathered.size(); ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(gathered.size() - 1);
      const auto to = static_cast<std::size_t>(std::lround(share * static_cast<double>(waist.size() - 1)));
      sewing.sew(bottom[gathered[i]], top[waist[to]]);
    }
  }
  // Both are cut along the same lines, in the same order.
  for (std::size_t i = 0; i < bodice_seam[0].size(); ++i) sewing.sew(bodice_seam[0][i], bodice_seam[1][i]);
  for (std::size_t i = 0; i < skirt_side[0].size(); ++i) sewing.sew(skirt_side[0][i], skirt_side[1][i]);
  return sewing.finish();
}

ObjMesh make_flag() {
  constexpr double kWidth = 1.2, kHeight = 0.8, kBottom = 1.0, kSpacing = 0.035;
  const PlanarMesh panel = triangulate(
      {sample_polyline({{0, 0}, {kWidth, 0}, {kWidth, kHeight}, {0, kHeight}, {0, 0}}, kSpacing)}, kSpacing);
  Sewing sewing("flag", "Flag: a rectangle, upright, its pole along x = 0");
  sewing.add(panel, [&](uint32_t i) { return Point3{panel.position[i][0], kBottom + panel.position[i][1], 0}; });
  return sewing.finish();
}

std::vector<Point2> circle(double radius, double spacing) {
  const auto steps = std::lround(2 * kPi * radius / spacing);
  std::vector<Point2> points;
  for (long i = 0; i < steps; ++i) {
    const double angle = 2 * kPi * static_cast<double>(i) / static_cast<double>(steps);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}

ObjMesh make_poncho() {
  constexpr double kHalf = 0.6, kHole = 0.11, kSpacing = 0.032, kHeight = 1.6;
  const std::vector<Point2> outline =
      sample_polyline({{-kHalf, -kHalf}, {kHalf, -kHalf}, {kHalf, kHalf}, {-kHalf, kHalf}, {-kHalf, -kHalf}}, kSpacing);
  const PlanarMesh panel = triangulate({outline, circle(kHole, kSpacing)}, kSpacing);
  Sewing sewing("poncho", "Poncho: a square of 1.2 m with a hole for the head, lying flat");
  sewing.add(panel, [&](uint32_t i) { return Point3{panel.position[i][0], kHeight, -panel.position[i][1]}; });
  return sewing.finish();
}

/// A sector of a ring, rolled without stretch into a part of a cone that opens to the front.
ObjMesh make_cape() {
  constexpr double kInner = 0.16, kOuter = 1.0, kHalfAngle = 0.42 * kPi, kSpacing = 0.034;
  constexpr double kFlare = 0.55;  // sine of the cone's half angle
  constexpr double kApex = 1.6;    // [m] height of the cone's tip
  std::vector<Point2> corners;
  constexpr int kSteps = 48;
  const auto arc = [&](double radius, bool forward) {
    for (int i = 0; i <= kSteps; ++i) {
      const double t = static_cast<double>(forward ? i : kSteps - i) / kSteps;
      const double angle = kHalfAngle * (2 * t - 1);
      corners.push_back({radius * std::sin(angle), -radius * std::cos(angle)});
    }
  };
  arc(kOuter, true);
  // The inner arc has fewer samples than it has corners; its corners are what shapes it.
  arc(kInner, false);
  corners.push_back(corners.front());
  std::vector<Point2> outline;
  for (const Point2& p : sample_polyline(corners, kSpacing)) {
    const bool far = outline.empty() || std::hypot(p[0] - outline.back()[0], p[1] - outline.back()[1]) > 0.6 * kSpacing;
    if (far) outline.push_back(p);
  }
  const PlanarMesh panel = triangulate({outline}, kSpacing);
  Sewing sewing("cape", "Cape: a ring's sector rolled into a cone around the neck, open at the front");
  sewing.add(panel, [&](uint32_t i) {
    const Point2& p = panel.position[i];
    const double radius = std::hypot(p[0], p[1]), angle = std::atan2(p[0], -p[1]) / kFlare;
    return Point3{-radius * kFlare * std::sin(angle), kApex - radius * std::sqrt(1 - kFlare * kFlare),
                  -radius * kFlare * std::cos(angle)};
  });
  return sewing.finish();
}

/// Two discs, sewn at their rims: flat but for as much as tells its inside from its outside.
ObjMesh make_cushion() {
  constexpr double kRadius = 0.25, kSpacing = 0.018, kBulge = 0.004;  // [m]
  const PlanarMesh panel = triangulate({circle(kRadius, kSpacing)}, kSpacing);
  Sewing sewing("cushion", "Cushion: two discs sewn at their rims, without air yet");
  for (const double side : {1.0, -1.0}) {
    sewing.add(
        panel,
        [&](uint32_t i) {
          const Point2& p = panel.position[i];
          const double out = std::min(1.0, std::hypot(p[0], p[1]) / kRadius);
          const bool on_rim = out > 1 - 1e-6;
          return Point3{p[0], on_rim ? 0 : side * kBulge * (1 - out * out), -p[1]};
        },
        side < 0);
  }
  return sewing.finish();
}

/// A strip whose left and right edges are sewn: a tube along y.
/// @param place  of (t around 0..1, height 0..1)
ObjMesh make_tube(const std::string& name, const std::string& comment, double width, double height, double spacing,
                  const std::function<Point3(double, double)>& place) {
  const std::vector<Point2> outline =
      sample_polyline({{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}}, spacing);
  const PlanarMesh panel = triangulate({outline}, spacing);
  Sewing sewing(name, comment);
  sewing.add(panel, [&](uint32_t i) { return place(panel.position[i][0] / width, panel.position[i][1] / height); });
  return sewing.finish();
}

ObjMesh make_skirt() {
  constexpr double kWaist = 0.13, kHem = 0.30, kBottom = 0.45, kTop = 1.0, kHemWidth = 2 * kPi * 0.215;
  return make_tube(
      "skirt", "Flared skirt: openings at waist and hem", kHemWidth, kTop - kBottom, 0.03,
      [](double around, double up) {
        const double radius = kHem + (kWaist - kHem) * up;
        const double angle = 2 * kPi * around;
        return Point3{radius * std::cos(angle), kBottom + (kTop - kBottom) * up, -radius * std::sin(angle)};
      });
}

ObjMesh make_sleeve() {
  constexpr double kRadius = 0.09, kLength = 0.55, kBend = 0.5;  // [m], [m], [rad] over the length
  return make_tube(
      "sleeve", "Bent sleeve: a tube with two openings", 2 * kPi * kRadius, kLength, 0.022,
      [](double around, double along) {
        const double bend_radius = kLength / kBend, bend = kBend * (along - 0.5);
        const double angle = 2 * kPi * around;
        const double out = bend_radius + kRadius * std::cos(angle);
        return Point3{out * std::cos(bend) - bend_radius, 1.2 + out * std::sin(bend), -kRadius * std::sin(angle)};
      });
}

}  // namespace

std::vector<ObjMesh> make_garments() {
  return {make_t_shirt(), make_poncho(), make_cape(),    make_skirt(),        make_sleeve(),
          make_dress(),   make_flag(),   make_cushion(), make_dress_pattern()};
}

}  // namespace geocloth::meshes
