// SPDX-License-Identifier: Apache-2.0
// Instruction sets that are left out. Include before <hwy/foreach_target.h>.
#pragma once

// Vectors whose length is not known when compiling cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#ifdef GEOCLOTH_FEW_VECTOR_TARGETS  // said by the build
#define GEOCLOTH_LEFT_OUT (HWY_SSE4 | HWY_AVX3)
#else
#define GEOCLOTH_LEFT_OUT 0
#endif
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | GEOCLOTH_LEFT_OUT)
