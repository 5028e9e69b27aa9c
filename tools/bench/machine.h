// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace geocloth {

/// What this machine can do at most, for the roofline of Williams, Waterman and Patterson 2009.
struct MachineInfo {
  std::string cpu;
  uint32_t cores = 1;
  double copy_gb_per_s = 0;  ///< [1e9 B/s] read plus written, all cores, far more than the caches hold
  double gflops = 0;         ///< [1e9 /s] single precision, all cores, multiply and add fused
};
[[nodiscard]] MachineInfo measure_machine();

/// [B/s] read plus written when `threads` threads copy back and forth within a working set of that many bytes.
[[nodiscard]] double measure_copy_rate(uint32_t threads, uint64_t working_set);

/// [1/s] single-precision operations of `threads` threads; a fused multiply and add is two.
[[nodiscard]] double measure_arithmetic_rate(uint32_t threads);

}  // namespace geocloth
