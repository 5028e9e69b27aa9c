// SPDX-License-Identifier: GPL-3.0-or-later
// The instruction sets that a source of this library is compiled for: included before <hwy/foreach_target.h>.
#pragma once

// Vectors whose length is not known when compiling cannot be members of an array.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
