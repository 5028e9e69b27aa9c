// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/machine.h"

namespace geocloth::test {

std::span<const Machine> machines() {
  static constexpr Machine kMachines[] = {{}};
  return kMachines;
}

}  // namespace geocloth::test
