// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/develop.h"
#include "develop/sewn_sheet.h"

namespace geocloth {

/// Sews slits inside of charts from their tips on, and whole ones, as long as the layout costs less with it
/// (layout_cost.h): the last of the cuts that a chart was given often falls below what was needed, and one that was
/// made early may be idle since others were.
/// @param charts  of one part, laid out; each stays flip-free and free of self-overlap
void close_slits(std::vector<Chart>& charts, const Sheet& sheet, const DevelopOptions& options);

}  // namespace geocloth
