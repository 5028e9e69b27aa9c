// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <backends/imgui_impl_glfw.h>
#include <fmt/format.h>
#include <imgui.h>

#include "render/color_map.h"
#include "view/controls.h"

namespace geocloth::view {
namespace {

void text(const std::string& line) {
  ImGui::TextUnformatted(line.c_str());
}

/// A dark pane that lets the scene through, with one accent: it is to be read, not looked at.
void set_style() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6;
  style.FrameRounding = style.GrabRounding = 4;
  style.WindowBorderSize = 0;
  style.WindowPadding = {12, 10};
  style.ItemSpacing = {8, 5};
  const ImVec4 accent{0.42F, 0.60F, 0.86F, 1}, quiet{0.28F, 0.31F, 0.36F, 0.85F}, warm{0.36F, 0.40F, 0.47F, 0.95F};
  auto& color = style.Colors;
  color[ImGuiCol_WindowBg] = {0.10F, 0.11F, 0.13F, 0.95F};
  color[ImGuiCol_TextDisabled] = {0.62F, 0.65F, 0.70F, 1};
  color[ImGuiCol_TitleBg] = color[ImGuiCol_TitleBgActive] =
      color[ImGuiCol_TitleBgCollapsed] = {0.14F, 0.155F, 0.18F, 0.97F};
  color[ImGuiCol_FrameBg] = color[ImGuiCol_Button] = color[ImGuiCol_Header] = quiet;
  color[ImGuiCol_FrameBgHovered] = color[ImGuiCol_ButtonHovered] = color[ImGuiCol_HeaderHovered] = warm;
  color[ImGuiCol_FrameBgActive] = color[ImGuiCol_ButtonActive] = color[ImGuiCol_HeaderActive] = accent;
  color[ImGuiCol_SliderGrab] = color[ImGuiCol_SliderGrabActive] = color[ImGuiCol_CheckMark] = accent;
  color[ImGuiCol_Separator] = {0.35F, 0.38F, 0.43F, 0.6F};
}

void lay_out_playing(Session& session) {
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  if (ImGui::Button(session.playing() ? "pause" : "play", {width, 0})) session.set_playing(!session.playing());
  ImGui::SameLine();
  if (ImGui::Button("step", {width, 0})) session.handle(KeyPressed{Key::step});
  ImGui::SameLine();
  if (ImGui::Button("restart", {width, 0})) session.restart();
  bool cutting = session.cutting();
  if (ImGui::Checkbox("cut along a line", &cutting)) session.set_cutting(cutting);
}

void lay_out_measures(Session& session) {
  const Measures& m = session.measures();
  Simulation& simulation = session.simulation();
  text(fmt::format("frame {}   {:.2f} s", simulation.frame(), simulation.time()));
  text(fmt::format("{:.2f} ms a frame", m.ms_per_frame));
  if (session.playing()) {
    ImGui::SameLine();
    text(fmt::format("  {:.0f} % of real time", 100 * m.speed));
  }
  text(fmt::format("{} particles, {} springs", m.solver.particles, m.solver.springs));
  const auto percent = [](double stretch) { return 100 * (stretch - 1); };
  text(fmt::format("stretch {:+.1f} % max, {:+.2f} % mean", percent(m.stretch.max), percent(m.stretch.mean)));
  if (m.solver.asleep > 0) text(fmt::format("{} cloths asleep", m.solver.asleep));
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s: %s, %s", m.solver.backend.c_str(), m.solver.device.c_str(), m.solver.path.c_str());
  ImGui::PopTextWrapPos();
}

/// What the colours of the strain mean.
void lay_out_legend() {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 8;
  constexpr int kPieces = 48;
  for (int i = 0; i < kPieces; ++i) {
    const Color c = diverging_color((static_cast<float>(i) + 0.5F) / kPieces);
    const float left = at.x + width * static_cast<float>(i) / kPieces,
                right = at.x + width * static_cast<float>(i + 1) / kPieces;
    ImGui::GetWindowDrawList()->AddRectFilled({left, at.y}, {right, at.y + height}, IM_COL32(c.r, c.g, c.b, 255));
  }
  ImGui::Dummy({width, height});
  text(fmt::format("{:+.0f} % strain", -100 * kStrainRange));
  const std::string end = fmt::format("{:+.0f} %", 100 * kStrainRange);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(end.c_str()).x);
  text(end);
}

void lay_out_display(Session& session) {
  Display& display = session.display();
  std::array<const char*, kShowNames.size()> names{};
  int chosen = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    names[i] = kShowNames[i].first;
    if (kShowNames[i].second == display.show) chosen = static_cast<int>(i);
  }
  if (ImGui::Combo("show", &chosen, names.data(), static_cast<int>(names.size())))
    display.show = kShowNames[static_cast<size_t>(chosen)].second;
  if (display.show == Show::strain) lay_out_legend();
  ImGui::Checkbox("springs", &display.springs);
  ImGui::SameLine();
  ImGui::Checkbox("pins", &display.pins);
  ImGui::SameLine();
  ImGui::Checkbox("colliders", &display.colliders);
  if (ImGui::Button("frame all", {-1, 0})) session.frame_all();
}

/// Widgets take typed numbers too, of any size; the solver has its limits.
float bounded(float value, float limit) {
  return std::isfinite(value) ? std::clamp(value, -limit, limit) : 0;
}

void lay_out_forces(Session& session) {
  const Scene& scene = session.scene();
  auto substeps = static_cast<int>(scene.substeps);
  if (ImGui::SliderInt("substeps", &substeps, 1, 64, "%d", ImGuiSliderFlags_Logarithmic))
    session.set_substeps(static_cast<uint32_t>(std::clamp(substeps, 1, 256)));
  float gravity = scene.gravity.y;
  if (ImGui::SliderFloat("gravity", &gravity, -20, 5, "%.2f m/s2"))
    session.set_gravity({scene.gravity.x, bounded(gravity, 1000), scene.gravity.z});
  Wind wind = session.wind();
  std::array<float, 3> velocity{wind.velocity.x, wind.velocity.y, wind.velocity.z};
  bool changed = ImGui::SliderFloat3("wind", velocity.data(), -10, 10, "%.1f");
  changed |= ImGui::SliderFloat("gusts", &wind.turbulence, 0, 1, "%.2f");
  if (!changed) return;
  for (float& v : velocity) v = bounded(v, 1000);
  wind.velocity = {velocity[0], velocity[1], velocity[2]};
  wind.turbulence = std::max(bounded(wind.turbulence, 100), 0.F);
  session.set_wind(wind);
}

/// A name in a list of these; none is chosen where it is not among them.
/// @return the new choice, if there is one
std::optional<size_t> choose(const char* label, const std::vector<std::string>& names, std::optional<size_t> chosen) {
  std::optional<size_t> picked;
  if (!ImGui::BeginCombo(label, chosen ? names[*chosen].c_str() : "")) return picked;
  for (size_t i = 0; i < names.size(); ++i)
    if (ImGui::Selectable(names[i].c_str(), chosen == i)) picked = i;
  ImGui::EndCombo();
  return picked;
}

bool lay_out_preset(Material& material) {
  std::vector<std::string> names;
  std::optional<size_t> chosen;
  for (const MaterialPreset& preset : material_presets()) {
    if (preset.material == material) chosen = names.size();
    names.emplace_back(preset.name);
  }
  const std::optional<size_t> picked = choose("preset", names, chosen);
  if (picked) material = material_presets()[*picked].material;
  return picked.has_value();
}

/// A slider of a material's number; what is typed is held to its ends, too.
struct MaterialSlider {
  const char* label;
  float Material::*value;
  float least, most;  ///< in units that are shown
  const char* format;
  float unit = 1;         ///< that is shown, in those of the material
  bool by_orders = true;  ///< of magnitude
  bool is_fabric = true;  ///< see Fabric
};
constexpr std::array kMaterialSliders{
    MaterialSlider{"density", &Material::areal_density, 0.01F, 5, "%.3f kg/m2"},
    MaterialSlider{"stretch warp", &Material::stretch_warp, 0.1F, 1e5F, "%.1f N/m"},
    MaterialSlider{"stretch weft", &Material::stretch_weft, 0.1F, 1e5F, "%.1f N/m"},
    MaterialSlider{"shear", &Material::shear, 0.1F, 1e4F, "%.1f N/m"},
    MaterialSlider{"bend warp", &Material::bend_warp, 0.1F, 1e5F, "%.1f uN m", 1e-6F},
    MaterialSlider{"bend weft", &Material::bend_weft, 0.1F, 1e5F, "%.1f uN m", 1e-6F},
    MaterialSlider{"damping", &Material::damping, 0, 10, "%.2f 1/s", 1, false, false},
    MaterialSlider{"friction", &Material::friction, 0, 2, "%.2f", 1, false, false},
    MaterialSlider{"thickness", &Material::thickness, 0, 20, "%.1f mm", 1e-3F, false, false}};

/// @param fabric  of a cloth that has some; none: its own material
void choose_fabric(const SceneCloth& cloth, std::optional<uint32_t>& fabric) {
  if (fabric && *fabric >= cloth.fabrics.size()) fabric.reset();
  if (cloth.fabrics.empty()) return;
  std::vector<std::string> names{"the cloth's own"};
  for (size_t f = 0; f < cloth.fabrics.size(); ++f) names.push_back(fmt::format("fabrics[{}]", f));
  const std::optional<size_t> picked = choose("fabric", names, fabric ? *fabric + 1 : 0);
  if (!picked) return;
  fabric = *picked == 0 ? std::nullopt : std::optional(static_cast<uint32_t>(*picked - 1));
}

/// @param cloth   whose material is shown; may be chosen anew
/// @param fabric  that of it
void lay_out_material(Session& session, uint32_t& cloth, std::optional<uint32_t>& fabric) {
  if (!ImGui::CollapsingHeader("material")) return;
  const std::vector<SceneCloth>& cloths = session.scene().cloths;
  if (cloths.size() > 1) {
    std::vector<std::string> names;
    for (size_t c = 0; c < cloths.size(); ++c)
      names.push_back(fmt::format("{} {}", c, cloths[c].asset.stem().string()));
    cloth = static_cast<uint32_t>(choose("cloth", names, cloth).value_or(cloth));
  }
  choose_fabric(cloths[cloth], fabric);
  const Solver& solver = session.simulation().solver();
  Material material = fabric ? solver.fabric(cloth, *fabric) : solver.material(cloth);
  bool changed = lay_out_preset(material);
  for (const MaterialSlider& s : kMaterialSliders) {
    if (fabric && !s.is_fabric) continue;
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (s.by_orders ? ImGuiSliderFlags_Logarithmic : 0);
    float value = material.*s.value / s.unit;
    if (!ImGui::SliderFloat(s.label, &value, s.least, s.most, s.format, flags)) continue;
    material.*s.value = s.unit * (std::isfinite(value) ? value : s.least);
    changed = true;
  }
  if (!changed) return;
  fabric ? session.set_fabric(cloth, *fabric, material) : session.set_material(cloth, material);
}

void lay_out_controls() {
  if (!ImGui::CollapsingHeader("mouse and keys")) return;
  for (const auto& [hand, what] : kControls) {
    text(hand);
    ImGui::PushTextWrapPos(0);
    ImGui::Indent();
    ImGui::TextDisabled("%s", what);
    ImGui::Unindent();
    ImGui::PopTextWrapPos();
  }
}

/// What the mouse does, drawn over the scene: the line to cut along, and how the hand pulls.
void draw_gestures(Session& session) {
  ImDrawList* const list = ImGui::GetBackgroundDrawList();
  const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
  const auto place = [&](const Vec2& p) { return ImVec2{p.x / scale.x, p.y / scale.y}; };
  if (const auto& line = session.cut_line()) {
    const ImVec2 from = place(line->from), to = place(line->to);
    list->AddLine(from, to, IM_COL32(20, 20, 24, 200), 4);
    list->AddLine(from, to, IM_COL32(255, 214, 90, 255), 2);
  }
  if (const auto& hand = session.hand()) {
    const ScreenMap screen = session.screen();
    const auto held = screen.place(session.positions(hand->cloth())[hand->pixel()]), goal = screen.place(hand->goal());
    if (!held || !goal) return;
    list->AddLine(place(*held), place(*goal), IM_COL32(255, 214, 90, 255), 1.5F);
    list->AddCircleFilled(place(*held), 5, IM_COL32(20, 20, 24, 200));
    list->AddCircleFilled(place(*held), 3.5F, IM_COL32(255, 214, 90, 255));
  }
}

}  // namespace

Panel::Panel(Window& window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // a viewer leaves no files
  ImGui::GetIO().ConfigWindowsMoveFromTitleBarOnly = true;
  set_style();
  ImGui_ImplGlfw_InitForOther(window.handle(), true);
  ImGui::GetIO().Fonts->Build();
}

Panel::~Panel() {
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool Panel::takes_mouse() const {
  return ImGui::GetIO().WantCaptureMouse;
}

bool Panel::takes_keys() const {
  return ImGui::GetIO().WantTextInput;
}

const ImDrawData& Panel::lay_out(Session& session) {
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  draw_gestures(session);
  if (session.display().panel) {
    ImGui::SetNextWindowPos({12, 12}, ImGuiCond_FirstUseEver);
    if (ImGui::Begin("geocloth", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
      ImGui::PushItemWidth(190);
      lay_out_playing(session);
      ImGui::Separator();
      lay_out_measures(session);
      ImGui::Separator();
      lay_out_display(session);
      ImGui::Separator();
      lay_out_forces(session);
      lay_out_material(session, cloth_, fabric_);
      lay_out_controls();
      if (!session.note().empty()) {
        ImGui::Separator();
        ImGui::PushTextWrapPos(0);
        text(session.note());
        ImGui::PopTextWrapPos();
      }
      ImGui::PopItemWidth();
    }
    ImGui::End();
  }
  ImGui::Render();
  return *ImGui::GetDrawData();
}

}  // namespace geocloth::view
