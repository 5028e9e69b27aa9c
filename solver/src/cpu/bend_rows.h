// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/row_source.h"

namespace geocloth::cpu {

/// Pass curvature, laid out in an empty stream: down the columns the step's group; along the rows, where the groups
/// follow each other in every row, all three.
[[nodiscard]] SweepOp bend_rows(const RowSource& source, const PassStep& step, RowStream& stream);

}  // namespace geocloth::cpu
