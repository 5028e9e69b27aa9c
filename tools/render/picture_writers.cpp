// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_writers.h"

#include <array>
#include <vector>

#include "geocloth/asset/output_file.h"
#include "render/renderer.h"
#include "render/scene_stage.h"
#include "render/video.h"

namespace geocloth {
namespace {

/// The mean of all particles [m]: it moves as smoothly as the cloth's centre of mass does.
Vec3 middle(Simulation& simulation) {
  std::array<double, 3> sum{};
  double count = 0;
  std::vector<Vec3> position;
  for (uint32_t c = 0; c < simulation.cloths().size(); ++c) {
    const ClothAsset& asset = *simulation.cloths()[c].asset;
    simulation.solver().read_positions(c, position);
    for (uint32_t pixel = 0; pixel < asset.pixel_count(); ++pixel) {
      if (!asset.valid(pixel) || !is_finite(position[pixel])) continue;
      const Vec3& p = position[pixel];
      sum = {sum[0] + static_cast<double>(p.x), sum[1] + static_cast<double>(p.y), sum[2] + static_cast<double>(p.z)};
      count += 1;
    }
  }
  if (count == 0) return {};
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count), static_cast<float>(sum[2] / count)};
}

/// Turns the frames of a simulation into pictures.
class PictureWriter : public FrameWriter {
 public:
  PictureWriter(Simulation& simulation, const RenderOptions& options)
      : options_(options),
        stage_(stage_simulation(simulation)),
        renderer_(stage_, options_, &simulation.solver()),
        start_(stage_.follow ? middle(simulation) : Vec3{}) {}

  [[nodiscard]] bool needs_cloth_snapshots() const final { return !renderer_.draws_from_solver(); }

 protected:
  Picture draw(Simulation& simulation, std::span<const ClothSnapshot> cloths) {
    std::vector<ClothState> states;
    states.reserve(cloths.size());
    for (const ClothSnapshot& cloth : cloths) states.push_back({cloth.position, cloth.normal});
    follow_cuts(simulation);
    if (stage_.follow) renderer_.follow(middle(simulation) - start_);
    return renderer_.render(simulation.colliders(), states);
  }

 private:
  /// A cloth that was cut has other faces to draw.
  void follow_cuts(Simulation& simulation) {
    bool cut = false;
    for (size_t c = 0; c < stage_.cloths.size(); ++c) {
      RenderCloth& cloth = stage_.cloths[c];
      const std::shared_ptr<const ClothAsset>& asset = simulation.cloths()[c].asset;
      if (cloth.asset == asset) continue;
      cloth = make_render_cloth(asset, cloth.scale);
      cut = true;
    }
    if (cut) renderer_ = Renderer(stage_, options_, &simulation.solver());
  }

  RenderOptions options_;
  RenderScene stage_;
  Renderer renderer_;
  Vec3 start_;  ///< middle of the garments in the first state [m]
};

class PictureSeriesWriter final : public PictureWriter {
 public:
  PictureSeriesWriter(std::filesystem::path path, Simulation& simulation, const RenderOptions& options)
      : PictureWriter(simulation, options), path_(std::move(path)) {}

  void add_frame(Simulation& simulation, std::span<const ClothSnapshot> cloths) override {
    if (simulation.frame() == 0 && simulation.scene().frames > 0) return;
    OutputFile& file = files_.open(numbered_path(path_, simulation.frame()));
    file.write(std::span<const std::byte>(encode_png(draw(simulation, cloths))));
  }
  void finish() override { files_.close(); }
  void commit() override { files_.commit(); }

 private:
  std::filesystem::path path_;
  OutputSeries files_;
};

class SimulationVideoWriter final : public PictureWriter {
 public:
  SimulationVideoWriter(const std::filesystem::path& path, Simulation& simulation, const RenderOptions& options)
      : PictureWriter(simulation, options),
        video_(path, options.size.width, options.size.height, simulation.scene().frame_rate) {}

  void add_frame(Simulation& simulation, std::span<const ClothSnapshot> cloths) override {
    video_.add(draw(simulation, cloths));
  }
  void finish() override { video_.finish(); }
  void commit() override { video_.commit(); }

 private:
  VideoWriter video_;
};

}  // namespace

std::unique_ptr<FrameWriter> make_picture_series_writer(const std::filesystem::path& path, Simulation& simulation,
                                                        const RenderOptions& options) {
  return std::make_unique<PictureSeriesWriter>(path, simulation, options);
}

std::unique_ptr<FrameWriter> make_video_writer(const std::filesystem::path& path, Simulation& simulation,
                                               const RenderOptions& options) {
  return std::make_unique<SimulationVideoWriter>(path, simulation, options);
}

}  // namespace geocloth
