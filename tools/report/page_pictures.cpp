// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of the report. The garment itself is drawn by the renderer, in the same colours as its seams have in the
// chart map, so that one finds on the model what one sees in the layout.
#include "report/page_pictures.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "geocloth/asset/error.h"
#include "render/asset_pictures.h"
#include "render/canvas.h"
#include "render/playback.h"
#include "render/renderer.h"
#include "render/seam_lines.h"

namespace geocloth {
namespace {

constexpr uint32_t kModelSide = 800;  ///< [pixels]

PagePicture page_picture(std::string title, std::string alt, std::string caption, const Picture& picture) {
  return {std::move(title), std::move(caption), std::move(alt), picture.width, picture.height, encode_png(picture)};
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// Front and back, from a little above.
std::vector<PagePicture> draw_model(const std::shared_ptr<const ClothAsset>& asset, uint32_t seams) {
  const Playback playback = play_asset(asset);
  RenderOptions options;
  options.size = {kModelSide, kModelSide};
  options.show = Show::seams;
  Renderer renderer(playback.scene, options);
  const std::vector<PlayedCloth> cloths = playback.state(0);
  const std::vector<ClothState> states{{cloths[0].position, cloths[0].normal}};
  std::vector<PagePicture> pictures;
  constexpr float kFront = 25, kElevation = 10;
  for (const auto& [side, azimuth] : {std::pair{"front", kFront}, std::pair{"back", kFront + 180}}) {
    renderer.set_camera(OrbitCamera{azimuth, kElevation, std::nullopt});
    pictures.push_back(page_picture(
        fmt::format("Seams on the garment, {}", side),
        fmt::format("The garment seen from the {}, with {} drawn as coloured lines and its free borders in black.",
                    side, counted(seams, "seam", "seams")),
        "Coloured lines are seams, in the colours of the layout; black lines are free borders.",
        renderer.render({}, states)));
  }
  return pictures;
}

}  // namespace

PagePictures draw_page_pictures(const std::shared_ptr<const ClothAsset>& asset) {
  PagePictures page;
  const uint32_t seams = find_seam_lines(*asset).seam_count;
  try {
    page.pictures = draw_model(asset, seams);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::device) throw;
    page.note = error.what();
  }
  const std::string panels = asset->layout == Layout::square ? counted(asset->chart_count, "square", "squares")
                                                             : counted(asset->chart_count, "panel", "panels");
  page.pictures.push_back(page_picture(
      "Layout", fmt::format("Map of the geometry image: {}, sewn along {}.", panels, counted(seams, "seam", "seams")),
      "Each panel has a colour and a number. The two sides of a seam have the same colour and, where there is room, "
      "the "
      "same letter; dark outlines are free borders, white points are where seams meet or end.",
      draw_chart_map(*asset, Caption::none)));
  page.pictures.push_back(
      page_picture("Geometry image",
                   fmt::format("The geometry image, {} by {} pixels: the position of every point as a colour.",
                               asset->width, asset->height),
                   "x, y and z of every point as red, green and blue. It is smooth wherever the cloth is whole.",
                   enlarged_to_see(draw_geometry_image(*asset))));
  page.pictures.push_back(page_picture("Distortion",
                                       "Two heat maps of the geometry image: area against nominal, and how much one "
                                       "direction is stretched more than the "
                                       "other. The numbers are in the table of measures.",
                                       "Left: area of the cloth at a pixel against nominal; pale is right, blue is too "
                                       "small, red is too large. Right: how "
                                       "much longer one direction is than the other; dark is even, yellow is uneven.",
                                       draw_distortion(*asset)));
  page.pictures.back().wide = true;
  return page;
}

}  // namespace geocloth
