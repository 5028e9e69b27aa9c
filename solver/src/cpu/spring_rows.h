// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/row_source.h"

namespace geocloth::cpu {

/// Passes structural, shear and bending: one group, laid out in an empty stream.
[[nodiscard]] SweepOp spring_rows(const RowSource& source, uint32_t group, RowStream& stream);

/// Pass ties: they lie where the structural springs do.
/// @param last  those that take only a share
[[nodiscard]] SweepOp tie_rows(const RowSource& source, uint32_t group, bool last, RowStream& stream);

/// Pass spans.
[[nodiscard]] SweepOp span_rows(const RowSource& source, uint32_t group, RowStream& stream);

}  // namespace geocloth::cpu
