// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/machine.h"

namespace geocloth::test {

std::span<const Machine> machines() {
  static constexpr Machine kMachines[] = {
      {Backend::vulkan, SolverPath::plain}, {Backend::vulkan, SolverPath::tiled}, {Backend::vulkan, SolverPath::tiny}};
  return kMachines;
}

}  // namespace geocloth::test
