// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// After the structural springs: fills the bending family, the bends over seams and their colours: curvatures with the
/// material's rigidity, or the seeds' springs over two pixels where bend_stiffness is set.
void add_bends(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest, ClothData& data);

}  // namespace geocloth
