// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geocloth/solver/scene.h"
#include "render/render_options.h"
#include "render/renderer.h"
#include "view/hand.h"
#include "view/input_event.h"
#include "view/orbit_view.h"
#include "view/pacer.h"

namespace geocloth::view {

/// What the window shows.
struct Display {
  Show show = Show::cloth;
  bool springs = false, pins = true, colliders = true, panel = true;
};

/// What the panel tells.
struct Measures {
  double ms_per_frame = 0;  ///< mean of the last frames, of the solver alone
  double speed = 0;         ///< of the simulation, 1: as fast as the clock; 0 while it stands still
  StretchStatistics stretch;
  SolverStatistics solver;
};

/// A line that is being drawn over the picture, to cut along.
struct CutLine {
  Vec2 from, to;
};

/// A scene being played and handled: everything about the window but the window. Times are handed in, events too, so
/// that tests can play it.
class Session {
 public:
  struct Setup {
    Scene scene;
    SolverSettings settings;
    BodyReader bodies = {};
    MakeSolver make_solver = {};
    Display display = {};
    bool play = true;
    std::optional<uint32_t> frames;  ///< finished() after so many
    /// Called before a solver dies, whose images may still be drawn.
    std::function<void()> before_restart = [] {};
  };

  /// @throws as Simulation, with the scene's name
  Session(Setup setup, const PictureSize& size);

  /// @throws as Solver::cut
  void handle(const InputEvent& event);
  void handle(std::span<const InputEvent> events) {
    for (const InputEvent& event : events) handle(event);
  }
  void resize(const PictureSize& size) { size_ = size; }
  /// Plays what is due after so much real time [s]. @throws Error naming the scene and the frame
  void advance(double seconds);
  /// Begins the scene anew, with the materials, wind, gravity and substeps that are set. What cannot be read any more
  /// is said in note(), and the scene goes on.
  void restart();
  void frame_all();

  void set_playing(bool playing);
  void set_wind(const Wind& wind);
  void set_material(uint32_t cloth, const Material& material);
  void set_fabric(uint32_t cloth, uint32_t fabric, const Material& material);
  void set_gravity(const Vec3& gravity);
  /// @param substeps  1..256
  void set_substeps(uint32_t substeps);

  [[nodiscard]] bool playing() const { return playing_; }
  [[nodiscard]] bool finished() const { return frames_ && played_ >= *frames_; }
  [[nodiscard]] Simulation& simulation() { return *simulation_; }
  /// Goes up when the simulation is another one: what was made for its solver is to be made anew.
  [[nodiscard]] uint32_t generation() const { return generation_; }
  /// As it stands, for the simulation's cloths.
  [[nodiscard]] const RenderScene& stage() const { return stage_; }
  /// Where the subject is now: with garments that nothing holds it goes along.
  [[nodiscard]] Bounds subject() const;
  [[nodiscard]] Camera camera() const { return view_.camera(); }
  [[nodiscard]] ScreenMap screen() const { return {camera(), size_}; }
  [[nodiscard]] const PictureSize& size() const { return size_; }
  [[nodiscard]] Display& display() { return display_; }
  [[nodiscard]] const Measures& measures() const { return measures_; }
  [[nodiscard]] const std::optional<Hand>& hand() const { return hand_; }
  [[nodiscard]] const std::optional<CutLine>& cut_line() const { return cut_line_; }
  [[nodiscard]] bool cutting() const { return cutting_; }
  void set_cutting(bool cutting) { cutting_ = cutting; }
  /// What happened last, for the panel; empty when nothing is to be said.
  [[nodiscard]] const std::string& note() const { return note_; }
  /// Wind that blows, calm where the scene has none.
  [[nodiscard]] Wind wind() const { return wind_at(scene_, simulation_->time()); }
  [[nodiscard]] const Scene& scene() const { return scene_; }

  /// The state of a cloth now; read from the solver once a frame at most. Pixels of the asset in simulation order.
  [[nodiscard]] const std::vector<Vec3>& positions(uint32_t cloth);
  [[nodiscard]] std::shared_ptr<const ClothAsset> asset(uint32_t cloth) { return simulation_->solver().asset(cloth); }

 private:
  enum class Grasp : uint8_t { nothing, cloth, orbit, pan, cut };

  void on(const MouseMoved& event);
  void on(const MousePressed& event);
  void on(const MouseReleased& event);
  void on(const Scrolled& event);
  void on(const KeyPressed& event);
  void grasp_cloth_or_orbit(const Vec2& at);
  void let_go();
  void cut_along(const CutLine& line);
  std::unique_ptr<Simulation> make_simulation() const;
  void step();
  void update_hand();
  void measure();
  void follow();
  void take_cut_assets();
  [[nodiscard]] Bounds cloth_bounds();
  [[nodiscard]] Vec3 middle();

  Scene scene_;  ///< with what was changed since it was read
  SolverSettings settings_;
  BodyReader bodies_;
  MakeSolver make_solver_;
  std::function<void()> before_restart_;
  PictureSize size_;
  std::unique_ptr<Simulation> simulation_;
  uint32_t generation_ = 0;
  RenderScene stage_;
  Vec3 start_, way_;  ///< [m] middle of the garments at the start, and how far it has come where they are followed
  struct State {
    std::vector<Vec3> position;
    bool read = false;  ///< since the last frame
  };
  std::vector<State> states_;

  OrbitView view_;
  Display display_;
  bool playing_;
  Pacer pacer_;
  std::optional<uint32_t> frames_;
  uint32_t played_ = 0;  ///< frames, over all restarts

  Grasp grasp_ = Grasp::nothing;
  MouseButton grasp_button_ = MouseButton::left;
  Vec2 mouse_;
  bool cutting_ = false;
  std::optional<Hand> hand_;
  std::optional<CutLine> cut_line_;

  Measures measures_;
  std::deque<double> step_seconds_;  ///< of the last frames
  double since_measured_ = 0;        ///< [s] of real time
  uint32_t frames_since_measured_ = 0;
  std::string note_;
};

}  // namespace geocloth::view
