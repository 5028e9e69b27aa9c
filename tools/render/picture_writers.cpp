// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_writers.h"

#include "geocloth/asset/output_file.h"
#include "render/renderer.h"
#include "render/scene_stage.h"
#include "render/video.h"

namespace geocloth {
namespace {

/// Turns the frames of a simulation into pictures.
class PictureWriter : public FrameWriter {
 public:
  PictureWriter(Simulation& simulation, const RenderOptions& options)
      : renderer_(stage_simulation(simulation), options, &simulation.solver()) {}

  [[nodiscard]] bool needs_cloth_frames() const final { return !renderer_.draws_from_solver(); }

 protected:
  Picture draw(Simulation& simulation, std::span<const ClothFrame> cloths) {
    std::vector<ClothState> states;
    for (const ClothFrame& cloth : cloths) states.push_back({cloth.position, cloth.normal});
    return renderer_.render(simulation.colliders(), states);
  }

 private:
  Renderer renderer_;
};

class PictureSeriesWriter final : public PictureWriter {
 public:
  PictureSeriesWriter(std::filesystem::path path, Simulation& simulation, const RenderOptions& options)
      : PictureWriter(simulation, options), path_(std::move(path)) {}

  void add_frame(Simulation& simulation, std::span<const ClothFrame> cloths) override {
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

  void add_frame(Simulation& simulation, std::span<const ClothFrame> cloths) override {
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
