// SPDX-License-Identifier: GPL-3.0-or-later
// A body to dress: every limb is a node with a tapered capsule, which the animation turns about its joint.
#include "walker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include <Eigen/Geometry>

#include "geocloth/asset/vec.h"
#include "glb.h"

namespace geocloth::meshes {
namespace {

constexpr double kStride = 1.1;   // [s] two steps
constexpr uint32_t kKeys = 16;    // of a stride, and one more at its end
constexpr uint32_t kAround = 20;  // points of a ring
constexpr uint32_t kCap = 5;      // rings of either cap
constexpr double kDegree = std::numbers::pi / 180;

/// To five decimals, so that the last bits of a sine do not matter.
float rounded(double x) {
  const double r = std::round(x * 1e5) / 1e5;
  return static_cast<float>(r == 0 ? 0 : r);
}

struct Surface {
  std::vector<Vec3> position;
  std::vector<Triangle> triangle;
};

/// A capsule around the line from a to b [m].
Surface capsule(const Vec3& a, const Vec3& b, double radius_a, double radius_b) {
  const Vec3 axis = normalized(b - a);
  const Vec3 side = normalized(cross(std::abs(axis.z) < 0.9F ? Vec3{0, 0, 1} : Vec3{1, 0, 0}, axis));
  const Vec3 other = cross(axis, side);
  Surface surface;
  const auto add = [&](const Vec3& center, double along, double off, double turn) {
    const auto part = [&](float c, float x, float s, float o) {
      return rounded(double{c} + along * double{x} + off * (std::cos(turn) * double{s} + std::sin(turn) * double{o}));
    };
    surface.position.push_back({part(center.x, axis.x, side.x, other.x), part(center.y, axis.y, side.y, other.y),
                                part(center.z, axis.z, side.z, other.z)});
  };
  const double quarter = std::numbers::pi / 2;
  const auto add_ring = [&](const Vec3& center, double radius, double outwards, uint32_t from_pole) {
    const double angle = quarter * from_pole / kCap;
    for (uint32_t i = 0; i < kAround; ++i) {
      add(center, outwards * radius * std::cos(angle), radius * std::sin(angle), 4 * quarter * i / kAround);
    }
  };
  add(a, -radius_a, 0, 0);
  for (uint32_t ring = 1; ring <= kCap; ++ring) add_ring(a, radius_a, -1, ring);
  for (uint32_t ring = kCap - 1; ring > 0; --ring) add_ring(b, radius_b, 1, ring);
  add(b, radius_b, 0, 0);
  const auto last = static_cast<uint32_t>(surface.position.size()) - 1;
  const uint32_t rings = (last - 1) / kAround;
  for (uint32_t i = 0; i < kAround; ++i) {
    const uint32_t next = (i + 1) % kAround;
    surface.triangle.push_back({0, 1 + next, 1 + i});
    for (uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const uint32_t low = 1 + ring * kAround, high = low + kAround;
      surface.triangle.push_back({low + i, low + next, high + i});
      surface.triangle.push_back({low + next, high + next, high + i});
    }
    surface.triangle.push_back({last, last - kAround + i, last - kAround + next});
  }
  return surface;
}

struct Turn {
  Vec3 axis;
  double degrees;
};
/// Turns one after the other, the first one first.
Eigen::Quaterniond turned(std::initializer_list<Turn> turns) {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (const Turn& t : turns) {
    const Eigen::Vector3d axis{double{t.axis.x}, double{t.axis.y}, double{t.axis.z}};
    q = Eigen::AngleAxisd(t.degrees * kDegree, axis.normalized()) * q;
  }
  return q;
}

/// A piece and what it hangs on.
struct Limb {
  std::string name;
  std::string parent;  ///< empty: nothing
  Vec3 joint;          ///< in the parent's coordinates [m]
  Vec3 a, b;           ///< its capsule's axis, from the joint [m]
  double radius_a, radius_b;
  std::function<Eigen::Quaterniond(double)> turn;  ///< at a phase of the stride [rad]
};

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

/// Arm and leg of one side; they swing against each other.
/// @param side  1: of the left, at +x; -1: of the right
void add_side(std::vector<Limb>& limbs, const std::string& name, float side) {
  const double late = side > 0 ? 0 : std::numbers::pi;
  const auto swing = [late](double phase, double degrees, double later = 0) {
    return degrees * std::sin(phase + late + later);
  };
  const Vec3 arm = normalized({side * 0.24F, -0.2F, 0});
  const Vec3 elbow_axis = normalized(cross(arm, kZ));
  limbs.push_back(
      {name + " upper arm", "chest", {side * 0.16F, 0.08F, 0}, {}, 0.27F * arm, 0.045, 0.037, [=](double phase) {
         return turned({{kZ, side * -30.0}, {kX, swing(phase, 22)}});
       }});
  limbs.push_back(
      {name + " forearm", name + " upper arm", 0.27F * arm, {}, 0.25F * arm, 0.037, 0.028, [=](double phase) {
         return turned({{elbow_axis, 20 - swing(phase, 12)}});
       }});
  limbs.push_back({name + " thigh",
                   "hips",
                   {side * 0.08F, -0.04F, 0},
                   {},
                   {side * 0.01F, -0.42F, 0},
                   0.085,
                   0.058,
                   [=](double phase) {
                     return turned({{kX, -3 - swing(phase, 25)}});
                   }});
  limbs.push_back(
      {name + " shin", name + " thigh", {side * 0.01F, -0.42F, 0}, {}, {0, -0.42F, 0}, 0.058, 0.042, [=](double phase) {
         return turned({{kX, 8 + std::max(0.0, swing(phase, 45, 1.2))}});
       }});
  limbs.push_back({name + " foot",
                   name + " shin",
                   {0, -0.42F, 0},
                   {0, -0.015F, -0.03F},
                   {0, -0.03F, 0.14F},
                   0.04,
                   0.03,
                   [=](double phase) {
                     return turned({{kX, -5 - swing(phase, 10, 0.6)}});
                   }});
}

std::vector<Limb> make_limbs() {
  std::vector<Limb> limbs;
  limbs.push_back({"hips", "", {0, 0.95F, 0}, {0, -0.03F, 0}, {0, 0.12F, 0}, 0.125, 0.105, [](double phase) {
                     return turned({{kY, 6 * std::sin(phase)}});
                   }});
  limbs.push_back({"belly", "hips", {0, 0.1F, 0}, {}, {0, 0.24F, 0}, 0.105, 0.1, [](double phase) {
                     return turned({{kX, 3}, {kY, -6 * std::sin(phase)}});
                   }});
  limbs.push_back(
      {"chest", "belly", {0, 0.23F, 0}, {-0.14F, 0.07F, 0}, {0.14F, 0.07F, 0}, 0.06, 0.06, [](double phase) {
         return turned({{kY, -6 * std::sin(phase)}});
       }});
  limbs.push_back({"neck", "chest", {0, 0.08F, 0}, {}, {0, 0.14F, 0}, 0.052, 0.05, [](double phase) {
                     return turned({{kY, 6 * std::sin(phase)}});
                   }});
  limbs.push_back({"head", "neck", {0, 0.21F, 0.01F}, {0, 0, 0.015F}, {0, 0.1F, 0}, 0.085, 0.1, [](double phase) {
                     return turned({{kX, 2 * std::sin(2 * phase)}});
                   }});
  add_side(limbs, "left", 1);
  add_side(limbs, "right", -1);
  return limbs;
}

class Writer {
 public:
  std::vector<std::byte> write() {
    const std::vector<Limb> limbs = make_limbs();
    for (uint32_t k = 0; k <= kKeys; ++k) time_.push_back(rounded(kStride * k / kKeys));
    time_accessor_ = file_.add_accessor(std::span<const float>(time_), file_.add_array(time_));
    glb::Json& root = file_.root;
    root["scenes"] = {{{"nodes", {0}}}};
    root["nodes"] = glb::Json::array();
    root["animations"] = {{{"name", "walk"}, {"samplers", glb::Json::array()}, {"channels", glb::Json::array()}}};
    for (const Limb& limb : limbs) add_limb(limb);
    add_bob();
    return file_.bytes();
  }

 private:
  static double phase(uint32_t key) { return 2 * std::numbers::pi * (key % kKeys) / kKeys; }

  void add_limb(const Limb& limb) {
    glb::Json& nodes = file_.root["nodes"];
    const std::size_t node = nodes.size();
    const Surface surface = capsule(limb.a, limb.b, limb.radius_a, limb.radius_b);
    const auto count = static_cast<uint32_t>(surface.position.size());
    const uint32_t position = file_.add_accessor(std::span<const Vec3>(surface.position),
                                                 file_.add_array(surface.position, glb::Target::vertices));
    const uint32_t indices =
        file_.add_index_accessor(file_.add_index_view(surface.triangle, count), 0, surface.triangle.size(), count);
    file_.root["meshes"].push_back(
        {{"name", limb.name}, {"primitives", {{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}}});
    nodes.push_back({{"name", limb.name},
                     {"mesh", node},
                     {"translation",
                      {rounded(double{limb.joint.x}), rounded(double{limb.joint.y}), rounded(double{limb.joint.z})}}});
    for (glb::Json& parent : nodes) {
      if (parent["name"] == limb.parent) parent["children"].push_back(node);
    }
    std::vector<std::array<float, 4>> turns;
    for (uint32_t k = 0; k <= kKeys; ++k) {
      const Eigen::Quaterniond q = limb.turn(phase(k));
      turns.push_back({rounded(q.x()), rounded(q.y()), rounded(q.z()), rounded(q.w())});
    }
    const uint32_t view = file_.add_array(turns);
    file_.root["accessors"].push_back(
        {{"bufferView", view}, {"componentType", 5126}, {"count", turns.size()}, {"type", "VEC4"}});
    add_channel(node, "rotation", static_cast<uint32_t>(file_.root["accessors"].size()) - 1);
  }

  /// The hips sink when the feet are apart.
  void add_bob() {
    std::vector<Vec3> place;
    for (uint32_t k = 0; k <= kKeys; ++k) place.push_back({0, rounded(0.96 - 0.015 * std::cos(2 * phase(k))), 0});
    add_channel(0, "translation", file_.add_accessor(std::span<const Vec3>(place), file_.add_array(place)));
  }

  void add_channel(std::size_t node, const char* path, uint32_t output) {
    glb::Json& animation = file_.root["animations"][0];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back({{"input", time_accessor_}, {"output", output}});
  }

  glb::Builder file_;
  std::vector<float> time_;  ///< [s]
  uint32_t time_accessor_ = 0;
};

}  // namespace

std::vector<std::byte> make_walker() {
  return Writer().write();
}

}  // namespace geocloth::meshes
