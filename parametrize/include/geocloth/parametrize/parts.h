// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "geocloth/parametrize/repair.h"

namespace geocloth {

/// What `convert --parts list` says about a part.
struct PartSummary {
  std::string name, material;
  uint32_t triangles = 0;
  double area = 0;       ///< [m^2]
  Point3 low{}, high{};  ///< [m] box around it
};

/// The mesh with the parts that users choose from: those of the file (objects, groups, primitives); where the file has
/// only one, its connected pieces, the largest first, named "piece 0", ... Vertices keep their numbers.
/// @param options  which pieces count as connected
[[nodiscard]] TriangleMesh with_choosable_parts(TriangleMesh mesh, const RepairOptions& options = {});

/// @param mesh  of with_choosable_parts
[[nodiscard]] std::vector<PartSummary> summarize_parts(const TriangleMesh& mesh);

/// The mesh with some of its parts only. Vertices keep their numbers; those that only parts left out use remain.
/// @param mesh       of with_choosable_parts
/// @param selection  terms with commas between them, each a number N, a range N-M, the name of parts or else of their
///   meshes in the file, or material:NAME; a '-' before a term leaves out. "0,2", "sleeve_l,sleeve_r", "-3",
///   "0-5,-buttons", "-material:metal". When the first term leaves out, all others stay. A name with a comma cannot be
///   said; use the number.
/// @throws Error(invalid_argument) when a term is empty or names no part, or when no part is left
[[nodiscard]] TriangleMesh select_parts(const TriangleMesh& mesh, std::string_view selection);

}  // namespace geocloth
