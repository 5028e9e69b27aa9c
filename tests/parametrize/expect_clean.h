// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"

namespace geocloth::test {

/// Holds a surface against every promise that mesh.h makes of CleanSurface, and its tables against the source mesh.
/// Reports the first few violations of each kind as test failures.
void expect_clean(const CleanSurface& surface, const TriangleMesh& source);

}  // namespace geocloth::test
