// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a simulation.
#include "simulation_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geocloth/solver/intersections.h"

namespace geocloth {
namespace {

constexpr const char* kCheckPass = "check_";
constexpr double kMillisecond = 1e-3;  // [s]

/// The smallest value that at least this share of the values does not exceed.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

/// Over all cloths: the worst of max and p99, the mean weighted by the number of springs.
StretchStatistics stretch_of_all(const Simulation& simulation, std::span<const ClothSnapshot> frames) {
  StretchStatistics all;
  double springs = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ClothDesc& cloth = simulation.cloths()[i];
    const StretchStatistics one = measure_stretch(*cloth.asset, cloth.transform.scale, frames[i].position);
    double count = 0;
    for (const uint8_t mask : cloth.asset->spring_mask) {
      count += static_cast<double>((mask & kSpringRight) != 0) + static_cast<double>((mask & kSpringDown) != 0);
    }
    all.max = std::max(all.max, one.max);
    all.p99 = std::max(all.p99, one.p99);
    all.mean += one.mean * count;
    springs += count;
  }
  if (springs > 0) all.mean /= springs;
  return all;
}

uint64_t torn_springs(const Simulation& simulation) {
  uint64_t springs = 0;
  for (uint32_t c = 0; c < simulation.cloths().size(); ++c) springs += simulation.torn(c).springs;
  return springs;
}

/// The hash of the state; for several cloths the FNV-1a of their hashes.
std::string state_hash(const Simulation& simulation, std::span<const ClothSnapshot> frames) {
  uint64_t hash = hash_state(*simulation.cloths()[0].asset, frames[0].position);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    constexpr uint64_t kPrime = 0x100000001b3U;
    hash = (hash * kPrime) ^ hash_state(*simulation.cloths()[i].asset, frames[i].position);
  }
  return fmt::format("{:016x}", hash);
}

/// Over the frames, of each collider.
nlohmann::ordered_json mean_forces(const Scene& scene, const std::deque<std::vector<ContactForce>>& frames) {
  nlohmann::ordered_json forces = nlohmann::ordered_json::array();
  const float share = 1 / std::max(1.F, static_cast<float>(frames.size()));
  for (std::size_t i = 0; i < scene.colliders.size(); ++i) {
    Vec3 mean;
    float largest = 0;
    for (const std::vector<ContactForce>& frame : frames) {
      mean = mean + share * frame[i].force;
      largest = std::max(largest, length(frame[i].force));
    }
    forces.push_back(
        {{"collider", scene.colliders[i].collider.name}, {"force", {mean.x, mean.y, mean.z}}, {"largest", largest}});
  }
  return forces;
}

}  // namespace

double sewing_gap(const ClothAsset& asset, std::span<const Vec3> positions) {
  float gap = 0;
  for (const auto& [a, b] : asset.sewing) gap = std::max(gap, length(positions[b] - positions[a]));
  return double{gap};
}

uint64_t count_non_finite(const ClothAsset& asset, std::span<const Vec3> positions) {
  uint64_t count = 0;
  for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
    count += static_cast<uint64_t>(asset.valid(pixel) && !is_finite(positions[pixel]));
  }
  return count;
}

void SimulationRecorder::add_frame_time(Simulation& simulation, double seconds) {
  double checks = 0;
  for (const PassTiming& pass : simulation.solver().statistics().passes) {
    if (pass.pass.starts_with(kCheckPass)) checks += pass.seconds;
  }
  // Of this frame alone: spread over all frames, one check that the machine held up would take from all of them.
  frame_seconds_.push_back(std::max(0.0, seconds - (checks - check_seconds_)));
  check_seconds_ = checks;
}

void SimulationRecorder::add_energy(Simulation& simulation) {
  Energy sum;
  std::vector<Vec3> positions, velocities;
  meters_.resize(simulation.solver().cloth_count());
  for (uint32_t i = 0; i < meters_.size(); ++i) {
    const ClothDesc& cloth = simulation.cloths()[i];
    CutMeter& meter = meters_[i];
    if (meter.asset != cloth.asset || meter.material != cloth.material || meter.fabrics != cloth.fabrics)
      meter = {cloth.asset, cloth.material, cloth.fabrics, EnergyMeter(cloth)};
    simulation.solver().read_positions(i, positions);
    simulation.solver().read_velocities(i, velocities);
    const Scene& scene = simulation.scene();
    const Energy one = meter.meter->measure(gravity_of(scene, scene.cloths[i]), positions, velocities,
                                            simulation.solver().held_pixels(i));
    sum.kinetic += one.kinetic;
    sum.potential += one.potential;
    sum.elastic += one.elastic;
  }
  energy_.push_back(sum);
}

void SimulationRecorder::add_contact_forces(Simulation& simulation) {
  const Scene& scene = simulation.scene();
  if (!scene.contact_forces) return;
  contact_forces_.push_back(simulation.solver().contact_forces());
  if (static_cast<double>(contact_forces_.size()) > std::max(1.0, scene.frame_rate)) contact_forces_.pop_front();
}

std::string SimulationRecorder::report(Simulation& simulation, std::span<const ClothSnapshot> cloths,
                                       const ContactCheck& contact, std::span<const std::string> warnings) const {
  const SolverStatistics statistics = simulation.solver().statistics();
  const Scene& scene = simulation.scene();
  const double frames = std::max<double>(1, static_cast<double>(frame_seconds_.size()));

  nlohmann::ordered_json passes = nlohmann::ordered_json::object();
  for (const PassTiming& pass : statistics.passes) passes[pass.pass] = pass.seconds / frames / kMillisecond;
  const double total_seconds = std::accumulate(frame_seconds_.begin(), frame_seconds_.end(), 0.0);
  const double projections = static_cast<double>(statistics.springs) * scene.substeps * scene.relaxation_steps *
                             static_cast<double>(frame_seconds_.size());
  const StretchStatistics stretch = stretch_of_all(simulation, cloths);
  nlohmann::ordered_json energy = nlohmann::ordered_json::array();
  for (const Energy& e : energy_) {
    energy.push_back({{"kinetic", e.kinetic}, {"potential", e.potential}, {"elastic", e.elastic}});
  }
  uint64_t non_finite = 0;
  double gap = 0;
  std::vector<PosedCloth> posed;
  for (std::size_t i = 0; i < cloths.size(); ++i) {
    gap = std::max(gap, sewing_gap(*simulation.cloths()[i].asset, cloths[i].position));
    posed.push_back({*simulation.cloths()[i].asset, cloths[i].position});
    non_finite += count_non_finite(*simulation.cloths()[i].asset, cloths[i].position);
  }
  const Intersections cuts = count_intersections(posed);

  nlohmann::ordered_json report{{"backend", statistics.backend},
                                {"device", statistics.device},
                                {"path", statistics.path},
                                {"threads", statistics.threads},
                                {"frames", frame_seconds_.size()},
                                {"substeps", scene.substeps},
                                {"particles", statistics.particles},
                                {"springs", statistics.springs},
                                {"asleep", statistics.asleep},
                                {"torn_springs", torn_springs(simulation)},
                                {"ms_per_frame",
                                 {{"median", percentile(frame_seconds_, 0.5) / kMillisecond},
                                  {"p95", percentile(frame_seconds_, 0.95) / kMillisecond}}},
                                {"passes_ms", passes},
                                {"springs_per_second", total_seconds > 0 ? projections / total_seconds : 0},
                                {"stretch", {{"max", stretch.max}, {"p99", stretch.p99}, {"mean", stretch.mean}}},
                                {"copy_gap", statistics.copy_gap},
                                {"sewing_gap", gap},
                                {"penetration", statistics.penetration},
                                {"drawn_penetration", contact.depth_between_vertices()},
                                {"intersections", {{"within", cuts.within}, {"between", cuts.between}}},
                                {"energy", energy},
                                {"non_finite", non_finite},
                                {"state_hash", state_hash(simulation, cloths)},
                                {"warnings", std::vector(warnings.begin(), warnings.end())}};
  if (scene.contact_forces) report["contact_forces"] = mean_forces(scene, contact_forces_);
  return report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string SimulationRecorder::summary(Simulation& simulation) const {
  const SolverStatistics statistics = simulation.solver().statistics();
  return fmt::format("{} frames on {} ({}, {}): {} particles, {} springs, {:.2f} ms a frame (median)",
                     frame_seconds_.size(), statistics.backend, statistics.device, statistics.path,
                     statistics.particles, statistics.springs, percentile(frame_seconds_, 0.5) / kMillisecond);
}

}  // namespace geocloth
