// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>

#include "export/frame_writer.h"
#include "render/render_options.h"

namespace geocloth {

/// Draws a simulation frame by frame. On Vulkan the pictures are drawn from the solver's own images.
/// A numbered picture per frame, out_0001.png ... (the state before the first step only when there are no frames).
[[nodiscard]] std::unique_ptr<FrameWriter> make_picture_series_writer(const std::filesystem::path& path,
                                                                      Simulation& simulation,
                                                                      const RenderOptions& options);
/// A film of all frames, from the state before the first step on.
[[nodiscard]] std::unique_ptr<FrameWriter> make_video_writer(const std::filesystem::path& path, Simulation& simulation,
                                                             const RenderOptions& options);

}  // namespace geocloth
