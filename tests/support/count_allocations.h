// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace geocloth::test {

/// Allocations by operator new so far, of all threads of a program that is built with count_allocations.cpp.
[[nodiscard]] uint64_t count_allocations();

}  // namespace geocloth::test
