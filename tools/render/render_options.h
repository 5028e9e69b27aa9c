// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "render/camera.h"

namespace geocloth {

/// What a picture shows of the cloth.
enum class Show {
  cloth,   ///< the garment with its materials
  grid,    ///< the surface that is simulated, with the lines of the geometry image
  strain,  ///< the same, coloured by the structural springs' strain
  charts,  ///< the same, a colour per chart
  seams,   ///< the same, with its seams and free borders
};
/// Every choice by its name, in order.
inline constexpr std::array<std::pair<const char*, Show>, 5> kShowNames{{{"cloth", Show::cloth},
                                                                         {"grid", Show::grid},
                                                                         {"strain", Show::strain},
                                                                         {"charts", Show::charts},
                                                                         {"seams", Show::seams}}};

struct PictureSize {
  uint32_t width = 1280, height = 720;  ///< [pixels]
};
inline constexpr uint32_t kMinPictureSide = 16, kMaxRenderSide = 8192;  ///< [pixels]

/// "1280x720". @throws Error(invalid_argument) when it is not that or out of range
[[nodiscard]] PictureSize parse_size(const std::string& text);

inline constexpr float kStrainRange = 0.10F;  ///< strain at the ends of the heat scale

struct RenderOptions {
  PictureSize size;
  Show show = Show::cloth;
  CameraChoice camera;
  std::string device;  ///< part of a device's name; empty: any that can draw
  float strain_range = kStrainRange;
};

}  // namespace geocloth
