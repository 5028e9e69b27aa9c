// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Moves pixels so that no structural spring is much shorter or longer than the spacing, as far as that goes: where cut
/// nodes lie closer together than a pixel, or where the cloth is folded more tightly than pixels can show, some springs
/// would have no length to speak of, and a solver no direction for their forces. Copies of a point move together; all
/// other pixels stay.
void limit_springs(ClothAsset& asset);

}  // namespace geocloth
