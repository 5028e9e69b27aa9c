// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <hwy/targets.h>

namespace geocloth::test {

/// Instruction sets that the solver was built for and that this machine has, as Highway's bits.
inline std::vector<int64_t> vector_targets() {
#ifdef GEOCLOTH_FEW_VECTOR_TARGETS  // said by the build
  constexpr std::array kBuilt{int64_t{HWY_AVX2}, int64_t{HWY_NEON}};
#else
  constexpr std::array kBuilt{int64_t{HWY_SSE4}, int64_t{HWY_AVX2}, int64_t{HWY_AVX3}, int64_t{HWY_NEON}};
#endif
  std::vector<int64_t> list;
  for (const int64_t target : kBuilt)
    if ((hwy::SupportedTargets() & target) != 0) list.push_back(target);
  return list;
}

}  // namespace geocloth::test
