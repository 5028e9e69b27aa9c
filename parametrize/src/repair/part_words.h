// SPDX-License-Identifier: GPL-3.0-or-later
// How what is carried is named in the report.
#pragma once

#include <cstdio>
#include <string>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

[[nodiscard]] inline std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

[[nodiscard]] inline std::string of_part(const TriangleMesh& mesh, uint32_t part) {
  return part < mesh.part.size() && !mesh.part[part].name.empty() ? " of '" + mesh.part[part].name + "'" : "";
}

}  // namespace geocloth
