// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
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

/// Chooses one of them while it lives, and then the best one again.
class VectorTarget {
 public:
  explicit VectorTarget(int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~VectorTarget() { hwy::SetSupportedTargetsForTest(0); }
  VectorTarget(const VectorTarget&) = delete;
  VectorTarget& operator=(const VectorTarget&) = delete;
};

/// Runs with each of them.
class OnVectorTarget : public testing::TestWithParam<int64_t> {
  VectorTarget chosen_{GetParam()};
};

}  // namespace geocloth::test
