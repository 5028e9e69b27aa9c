// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/row_source.h"

namespace geocloth::cpu {

/// Pass lines, those along rows (group 0) or columns. They go as far as some point of them has a spring, along rows in
/// as many columns as are turned at once.
[[nodiscard]] LineStream line_stream(const RowSource& source, uint32_t group);

}  // namespace geocloth::cpu
