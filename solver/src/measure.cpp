// SPDX-License-Identifier: Apache-2.0
// Measures of a state on the host, in double precision, from the same springs and masses that the solver uploads.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "check_input.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/solver/solver.h"
#include "lib/bend.h"
#include "rest/upload.h"

namespace geocloth {
namespace {

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y, static_cast<double>(b.z) - a.z);
}

double dot64(const Vec3& a, const Vec3& b) {
  return static_cast<double>(a.x) * b.x + static_cast<double>(a.y) * b.y + static_cast<double>(a.z) * b.z;
}

void check_count(const char* what, size_t count, size_t pixels) {
  if (count == pixels) return;
  throw Error(ErrorCode::invalid_argument, "a measure needs one " + std::string(what) + " for each of the cloth's " +
                                               std::to_string(pixels) + " pixels, not " + std::to_string(count));
}

/// Energy of one spring; a compliance of 0 is a constraint and stores none.
double spring_energy(const Vec3& a, const Vec3& b, float rest, float compliance) {
  if (!(rest > 0) || !(compliance > 0)) return 0;
  const double stretch = distance(a, b) - static_cast<double>(rest);
  return 0.5 * stretch * stretch / static_cast<double>(compliance);
}

/// Energy of one bend (lib/bend.h); a compliance of 0 is none.
/// @param beside  with the weight `turn`
double bend_energy(const Vec3& a, const Vec3& middle, const Vec3& b, const Vec3& beside, double chord, double turn,
                   float rest, float compliance) {
  if (!(compliance > 0)) return 0;
  const auto out = [chord, turn](float pa, float pm, float pb, float pc) {
    const double m = pm;
    return (1 - chord) * (pa - m) + chord * (pb - m) - turn * (pc - m);
  };
  const double e = std::hypot(out(a.x, middle.x, b.x, beside.x), out(a.y, middle.y, b.y, beside.y),
                              out(a.z, middle.z, b.z, beside.z));
  return 0.5 * (e - static_cast<double>(rest)) * (e - static_cast<double>(rest)) / static_cast<double>(compliance);
}

/// @param weight  [1/kg] of every pixel, 0 where it is held: a clamp takes a share of the compliance away
double curvature_energy(const ClothData& data, std::span<const float> weight, std::span<const Vec3> x) {
  double energy = 0;
  const auto left = [weight](uint32_t a, uint32_t middle, uint32_t b, double chord, float compliance) {
    return compliance * shader::clamped_share(weight[a], weight[middle], weight[b], static_cast<float>(chord));
  };
  for (uint32_t p = 0; p < data.pixel_count(); ++p) {
    const shader::vec4& bend = data.springs[2][p];
    if (bend.y > 0) {
      const double h1 = data.springs[0][p].x, h2 = data.springs[0][p + 1].x, chord = h1 / (h1 + h2);
      energy += bend_energy(x[p], x[p + 1], x[p + 2], x[p], chord, 0, bend.x, left(p, p + 1, p + 2, chord, bend.y));
    }
    if (bend.w > 0) {
      const uint32_t middle = p + data.width, b = middle + data.width;
      const double h1 = data.springs[0][p].z, h2 = data.springs[0][middle].z, chord = h1 / (h1 + h2);
      energy += bend_energy(x[p], x[middle], x[b], x[p], chord, 0, bend.z, left(p, middle, b, chord, bend.w));
    }
  }
  for (const shader::SeamSpring& s : data.seam_springs) {
    energy += bend_energy(x[s.a], x[s.middle], x[s.b], x[s.beside], s.chord, s.turn, s.rest,
                          left(s.a, s.middle, s.b, s.chord, s.compliance));
  }
  return energy;
}

double elastic_energy(const ClothData& data, std::span<const float> weight, std::span<const Vec3> x) {
  double energy = 0;
  for (uint32_t p = 0; p < data.pixel_count(); ++p) {
    for (uint32_t c = 0; c < kSpringCount - 2; ++c) {  // the seeds' bending springs are constraints and store none
      const shader::vec4& s = data.springs[c / 2][p];
      const float rest = c % 2 == 0 ? s.x : s.z;
      if (!(rest > 0)) continue;
      const int64_t q = static_cast<int64_t>(p) + kSpringOffset[c][0] + int64_t{data.width} * kSpringOffset[c][1];
      energy += spring_energy(x[p], x[static_cast<size_t>(q)], rest, c % 2 == 0 ? s.y : s.w);
    }
  }
  return data.bending == Bending::curvature ? energy + curvature_energy(data, weight, x) : energy;
}

}  // namespace

StretchStatistics measure_stretch(const ClothAsset& asset, float scale, std::span<const Vec3> positions) {
  check_count("position", positions.size(), asset.pixel_count());
  std::vector<double> ratio;
  for_structural_springs(asset, [&](uint32_t p, uint32_t q) {
    const double rest = static_cast<double>(scale) * distance(asset.rest_position[p], asset.rest_position[q]);
    if (!(rest > 0)) return;
    const double r = distance(positions[p], positions[q]) / rest;
    ratio.push_back(std::isfinite(r) ? r : std::numeric_limits<double>::infinity());  // NaN would be lost in the order
  });
  if (ratio.empty()) return {};
  StretchStatistics result;
  for (const double r : ratio) result.mean += r;
  result.mean /= static_cast<double>(ratio.size());
  const auto p99 = ratio.begin() + static_cast<ptrdiff_t>(static_cast<double>(ratio.size() - 1) * 0.99);
  std::nth_element(ratio.begin(), p99, ratio.end());
  result.p99 = *p99;
  result.max = *std::max_element(p99, ratio.end());
  return result;
}

struct EnergyMeter::Impl {
  ClothData data;
};

EnergyMeter::EnergyMeter(const ClothDesc& cloth) {
  check(cloth, "the cloth whose energy is to be measured");
  impl_ = std::make_unique<Impl>(Impl{make_cloth_data(cloth, {})});
}
EnergyMeter::~EnergyMeter() = default;
EnergyMeter::EnergyMeter(EnergyMeter&&) noexcept = default;
EnergyMeter& EnergyMeter::operator=(EnergyMeter&&) noexcept = default;

Energy EnergyMeter::measure(const Vec3& gravity, std::span<const Vec3> positions, std::span<const Vec3> velocities,
                            std::span<const uint32_t> held) const {
  const ClothData& data = impl_->data;
  check_count("position", positions.size(), data.pixel_count());
  check_count("velocity", velocities.size(), data.pixel_count());
  std::vector<float> weight(data.pixel_count());
  for (uint32_t p = 0; p < data.pixel_count(); ++p) weight[p] = data.position[p].w;
  for (const uint32_t p : held) {
    if (p >= data.pixel_count()) {
      throw Error(ErrorCode::invalid_argument, "pixel " + std::to_string(p) + " cannot be held; the cloth has " +
                                                   std::to_string(data.pixel_count()) + " pixels");
    }
    weight[p] = 0;
  }
  Energy energy;
  for (uint32_t p = 0; p < data.pixel_count(); ++p) {
    if (!(data.position[p].w > 0)) continue;
    const double mass = 1 / static_cast<double>(data.position[p].w);
    energy.kinetic += 0.5 * mass * dot64(velocities[p], velocities[p]);
    energy.potential -= mass * dot64(gravity, positions[p]);
  }
  energy.elastic = elastic_energy(data, weight, positions);
  return energy;
}

Energy measure_energy(const ClothDesc& cloth, const Vec3& gravity, std::span<const Vec3> positions,
                      std::span<const Vec3> velocities, std::span<const uint32_t> held) {
  return EnergyMeter(cloth).measure(gravity, positions, velocities, held);
}

uint64_t hash_state(const ClothAsset& asset, std::span<const Vec3> positions) {
  check_count("position", positions.size(), asset.pixel_count());
  uint64_t hash = 0xCBF29CE484222325U;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    unsigned char bytes[sizeof(Vec3)];
    std::memcpy(bytes, &positions[p], sizeof(Vec3));
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001B3U;
  }
  return hash;
}

}  // namespace geocloth
