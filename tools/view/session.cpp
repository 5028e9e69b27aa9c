// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/session.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "geocloth/asset/error.h"
#include "render/scene_stage.h"
#include "render/solid_mesh.h"
#include "view/cut_line.h"
#include "view/pick.h"

namespace geocloth::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPictureBudget = 0.06;  ///< [s] of real time that frames between two pictures may take
constexpr double kMeasureEvery = 0.25;   ///< [s] of real time
constexpr size_t kStepsKept = 30;
constexpr float kRoom = 0.08F, kNearby = 0.35F;  ///< what is framed around the garments, shares of their diagonal

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Session::Session(Setup setup, const PictureSize& size)
    : scene_(std::move(setup.scene)),
      settings_(std::move(setup.settings)),
      bodies_(std::move(setup.bodies)),
      make_solver_(std::move(setup.make_solver)),
      before_restart_(std::move(setup.before_restart)),
      size_(size),
      simulation_(make_simulation()),
      stage_(stage_simulation(*simulation_)),
      states_(simulation_->cloths().size()),
      display_(setup.display),
      playing_(setup.play),
      pacer_(1 / scene_.frame_rate),
      frames_(setup.frames) {
  // Bodies have become fields, which takes seconds; a restart need not do it again.
  scene_ = simulation_->scene();
  for (SceneCollider& collider : scene_.colliders)
    if (collider.mesh && !collider.mesh->animation) collider.mesh.reset();
  if (stage_.follow) start_ = middle();
  view_.frame(subject(), size_);
  measure();
}

std::unique_ptr<Simulation> Session::make_simulation() const {
  return std::make_unique<Simulation>(scene_, settings_, bodies_, make_solver_);
}

void Session::restart() {
  let_go();
  try {
    std::unique_ptr<Simulation> anew = make_simulation();
    before_restart_();
    simulation_ = std::move(anew);
  } catch (const Error& error) {
    note_ = error.what();
    return;
  }
  ++generation_;
  for (State& state : states_) state.read = false;
  stage_ = stage_simulation(*simulation_);
  follow();
  pacer_ = Pacer(1 / scene_.frame_rate);
  step_seconds_.clear();
  note_.clear();
  measure();
}

const std::vector<Vec3>& Session::positions(uint32_t cloth) {
  State& state = states_.at(cloth);
  if (!std::exchange(state.read, true)) simulation_->solver().read_positions(cloth, state.position);
  return state.position;
}

Bounds Session::subject() const {
  if (stage_.subject.empty()) return stage_.subject;
  return {stage_.subject.low + way_, stage_.subject.high + way_};
}

Bounds Session::cloth_bounds() {
  Bounds bounds;
  for (uint32_t c = 0; c < states_.size(); ++c) {
    const ClothAsset& asset = *stage_.cloths[c].asset;
    const std::vector<Vec3>& position = positions(c);
    for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel)
      if (asset.valid(pixel) && is_finite(position[pixel])) bounds.include(position[pixel]);
  }
  return bounds;
}

Vec3 Session::middle() {
  std::array<double, 3> sum{};
  double count = 0;
  for (uint32_t c = 0; c < states_.size(); ++c) {
    const ClothAsset& asset = *stage_.cloths[c].asset;
    const std::vector<Vec3>& position = positions(c);
    for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
      if (!asset.valid(pixel) || !is_finite(position[pixel])) continue;
      const Vec3& p = position[pixel];
      sum = {sum[0] + static_cast<double>(p.x), sum[1] + static_cast<double>(p.y), sum[2] + static_cast<double>(p.z)};
      count += 1;
    }
  }
  if (count == 0) return start_;
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)};
}

/// The camera goes with garments that nothing holds.
void Session::follow() {
  if (!stage_.follow) return;
  const Vec3 way = middle() - start_;
  view_.shift(way - way_);
  way_ = way;
}

void Session::frame_all() {
  Bounds all = cloth_bounds();
  const Bounds nearby = grown(all, kNearby * all.diagonal());
  all = grown(all, kRoom * all.diagonal());
  for (const Collider& collider : simulation_->colliders())
    all.include(intersection(collider_bounds(collider), nearby));
  view_.frame(all, size_);
}

void Session::set_playing(bool playing) {
  playing_ = playing;
  pacer_ = Pacer(1 / scene_.frame_rate);
}

void Session::set_wind(const Wind& wind) {
  simulation_->set_wind(wind);
  scene_.wind = wind;
  scene_.wind_motion.clear();
}

void Session::set_material(uint32_t cloth, const Material& material) {
  simulation_->set_material(cloth, material);
  scene_.cloths[cloth].material = material;
  scene_.cloths[cloth].material_motion.clear();
}

void Session::set_fabric(uint32_t cloth, uint32_t fabric, const Material& material) {
  simulation_->set_fabric(cloth, fabric, material);
  scene_.cloths[cloth].fabrics[fabric] = simulation_->scene().cloths[cloth].fabrics[fabric];
}

void Session::set_gravity(const Vec3& gravity) {
  simulation_->solver().set_gravity(gravity);
  scene_.gravity = gravity;
}

void Session::set_substeps(uint32_t substeps) {
  simulation_->solver().set_time_step(1 / scene_.frame_rate, substeps);
  scene_.substeps = substeps;
}

void Session::advance(double seconds) {
  if (playing_) {
    pacer_.pass(seconds);
    const Clock::time_point start = Clock::now();
    while (playing_ && pacer_.due() && !finished() && seconds_since(start) < kPictureBudget) {
      step();
      pacer_.played();
    }
    pacer_.drop();
  }
  since_measured_ += seconds;
  if (since_measured_ >= kMeasureEvery) measure();
}

void Session::step() {
  update_hand();
  const Clock::time_point start = Clock::now();
  try {
    simulation_->step();
    simulation_->solver().wait();
  } catch (const Error& error) {
    throw Error(error.code(),
                fmt::format("{}: frame {}: {}", scene_.path.string(), simulation_->frame(), error.what()));
  }
  step_seconds_.push_back(seconds_since(start));
  if (step_seconds_.size() > kStepsKept) step_seconds_.pop_front();
  ++played_;
  ++frames_since_measured_;
  for (State& state : states_) state.read = false;
  take_cut_assets();
  follow();
}

void Session::take_cut_assets() {
  for (uint32_t c = 0; c < states_.size(); ++c) {
    RenderCloth& cloth = stage_.cloths[c];
    std::shared_ptr<const ClothAsset> now = asset(c);
    if (cloth.asset != now) cloth = make_render_cloth(std::move(now), cloth.scale);
  }
}

void Session::update_hand() {
  if (!hand_) return;
  const Vec3& now = positions(hand_->cloth())[hand_->pixel()];
  constexpr float kLost = 1e5F;  // [m] pins have a limit too
  if (!(length(now) < kLost)) {
    let_go();
    return;
  }
  hand_->move(screen(), mouse_);
  simulation_->set_hand(hand_->cloth(), {hand_->pin(now)});
}

void Session::measure() {
  measures_.solver = simulation_->solver().statistics();
  double sum = 0, weight = 0;
  uint64_t lost = 0;
  measures_.stretch = {};
  for (uint32_t c = 0; c < states_.size(); ++c) {
    const RenderCloth& cloth = stage_.cloths[c];
    const std::vector<Vec3>& position = positions(c);
    for (uint32_t pixel = 0; pixel < cloth.asset->pixel_count(); ++pixel)
      lost += cloth.asset->valid(pixel) && !is_finite(position[pixel]) ? 1U : 0U;
    const StretchStatistics stretch = measure_stretch(*cloth.asset, cloth.scale, position);
    const double pixels = count_valid_pixels(*cloth.asset);
    measures_.stretch.max = std::max(measures_.stretch.max, stretch.max);
    measures_.stretch.p99 = std::max(measures_.stretch.p99, stretch.p99);
    sum += pixels * stretch.mean;
    weight += pixels;
  }
  if (weight > 0) measures_.stretch.mean = sum / weight;
  double seconds = 0;
  for (const double s : step_seconds_) seconds += s;
  if (!step_seconds_.empty()) measures_.ms_per_frame = 1000 * seconds / static_cast<double>(step_seconds_.size());
  if (since_measured_ > 0) measures_.speed = frames_since_measured_ / scene_.frame_rate / since_measured_;
  since_measured_ = 0;
  frames_since_measured_ = 0;
  if (lost > 0) {
    playing_ = false;
    note_ = fmt::format(
        "{} points are not finite numbers any more: the motion blew up; use more substeps, or a softer material, and "
        "restart",
        lost);
  }
}

void Session::handle(const InputEvent& event) {
  std::visit([this](const auto& e) { on(e); }, event);
}

void Session::on(const MouseMoved& event) {
  const Vec2 way{event.at.x - mouse_.x, event.at.y - mouse_.y};
  mouse_ = event.at;
  switch (grasp_) {
    case Grasp::orbit:
      return view_.orbit(way);
    case Grasp::pan:
      return view_.pan(way, size_);
    case Grasp::cloth:
      return hand_->move(screen(), mouse_);
    case Grasp::cut:
      cut_line_->to = mouse_;
      return;
    case Grasp::nothing:
      return;
  }
}

void Session::on(const MousePressed& event) {
  if (grasp_ != Grasp::nothing) return;  // one button at a time
  mouse_ = event.at;
  grasp_button_ = event.button;
  if (event.button == MouseButton::middle || (event.button == MouseButton::left && event.shift)) {
    grasp_ = Grasp::pan;
  } else if (event.button == MouseButton::right) {
    grasp_ = Grasp::orbit;
  } else if (cutting_ || event.control) {
    grasp_ = Grasp::cut;
    cut_line_ = {event.at, event.at};
  } else {
    grasp_cloth_or_orbit(event.at);
  }
}

void Session::grasp_cloth_or_orbit(const Vec2& at) {
  std::vector<PickedFrom> cloths;
  for (uint32_t c = 0; c < states_.size(); ++c)
    cloths.push_back({stage_.cloths[c].asset.get(), positions(c), scene_.cloths[c].transform.scale});
  const std::vector<Collider> seen = display_.colliders ? simulation_->colliders() : std::vector<Collider>{};
  const std::optional<Picked> picked = pick_pixel(screen(), at, cloths, seen);
  if (!picked) {
    grasp_ = Grasp::orbit;
    return;
  }
  grasp_ = Grasp::cloth;
  hand_.emplace(*picked, count_valid_pixels(*stage_.cloths[picked->cloth].asset));
  hand_->move(screen(), at);
}

void Session::on(const MouseReleased& event) {
  if (grasp_ == Grasp::nothing || event.button != grasp_button_) return;
  on(MouseMoved{event.at});
  const std::optional<CutLine> line = grasp_ == Grasp::cut ? cut_line_ : std::nullopt;
  let_go();
  if (line) cut_along(*line);
}

void Session::let_go() {
  grasp_ = Grasp::nothing;
  cut_line_.reset();
  if (!hand_) return;
  simulation_->set_hand(hand_->cloth(), {});
  hand_.reset();
}

void Session::cut_along(const CutLine& line) {
  const auto triangle = cut_triangle(screen(), line.from, line.to, cloth_bounds());
  if (!triangle) return;
  CutResult all;
  try {
    for (uint32_t c = 0; c < states_.size(); ++c) {
      all += simulation_->solver().cut(c, *triangle);
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    note_ = error.what();  // cloth that flew out of the world
    return take_cut_assets();
  }
  take_cut_assets();
  note_ = all == CutResult{}
              ? "the line met no cloth"
              : fmt::format(
                    "cut {} springs{}", all.springs,
                    all.parted_points == 0 ? std::string() : fmt::format(" and {} points of seams", all.parted_points));
}

void Session::on(const Scrolled& event) {
  view_.zoom(event.steps);
}

void Session::on(const KeyPressed& event) {
  switch (event.key) {
    case Key::play:
      return set_playing(!playing_);
    case Key::step:
      playing_ = false;
      if (!finished()) step();
      return measure();
    case Key::restart:
      return restart();
    case Key::frame_all:
      return frame_all();
    case Key::cut:
      cutting_ = !cutting_;
      return;
    case Key::cancel:
      cutting_ = false;
      return let_go();
    case Key::show_cloth:
      display_.show = Show::cloth;
      return;
    case Key::show_grid:
      display_.show = Show::grid;
      return;
    case Key::show_strain:
      display_.show = Show::strain;
      return;
    case Key::show_charts:
      display_.show = Show::charts;
      return;
    case Key::show_seams:
      display_.show = Show::seams;
      return;
    case Key::springs:
      display_.springs = !display_.springs;
      return;
    case Key::pins:
      display_.pins = !display_.pins;
      return;
    case Key::colliders:
      display_.colliders = !display_.colliders;
      return;
    case Key::panel:
      display_.panel = !display_.panel;
      return;
  }
}

}  // namespace geocloth::view
