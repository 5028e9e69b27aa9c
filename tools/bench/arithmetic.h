// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace geocloth {

struct ArithmeticRun {
  float result = 0;       ///< depends on every operation
  double operations = 0;  ///< that were done
};

/// Fused multiplies and adds with the widest vectors of this processor, enough of them independent to fill its pipes.
[[nodiscard]] ArithmeticRun run_arithmetic(uint32_t rounds);

}  // namespace geocloth
