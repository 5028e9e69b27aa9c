// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace geocloth {

enum class Backend {
  automatic,  ///< a real GPU if there is one, else cpu
  cpu,
  vulkan,  ///< any Vulkan device; a software one only when there is no other or when it is named
};
[[nodiscard]] const char* to_string(Backend backend);

/// One thing that can run the solver, or why it cannot.
struct DeviceInfo {
  Backend backend = Backend::cpu;
  std::string name;  ///< as the driver gives it
  std::string type;  ///< "cpu", "discrete gpu", "integrated gpu", "virtual gpu", "software"
  std::string driver;
  uint64_t memory_bytes = 0;
  bool usable = true;
  std::string reason;                 ///< why it is not usable: one sentence per missing thing
  bool chosen_automatically = false;  ///< Backend::automatic would take it
};

/// The cpu first, then every Vulkan device in the loader's order. Never throws because of Vulkan: without a loader or
/// a driver the list says so in an entry that is not usable.
[[nodiscard]] std::vector<DeviceInfo> enumerate_devices();

}  // namespace geocloth
