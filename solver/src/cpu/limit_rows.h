// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/row_source.h"

namespace geocloth::cpu {

/// Place of each pin among the anchors. Pixels of a row are held by anchors of neighbouring columns, more or less: in
/// that order a vector's lanes choose from as many anchors as it has lanes.
[[nodiscard]] std::vector<uint32_t> order_anchors(const RowSource& source);

/// Pass limit, laid out in an empty stream. Anchors stay where the pins put them during a substep, so they need not be
/// looked up in the image.
[[nodiscard]] SweepOp limit_rows(const RowSource& source, const std::vector<uint32_t>& anchor_of_pin,
                                 RowStream& stream);

}  // namespace geocloth::cpu
