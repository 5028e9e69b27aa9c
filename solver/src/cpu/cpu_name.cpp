// SPDX-License-Identifier: Apache-2.0
// The processor's name as Linux tells it.

#include "cpu/cpu_name.h"

#include <fstream>

namespace geocloth::cpu {

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name"))
      if (const size_t colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "cpu";
}

}  // namespace geocloth::cpu
