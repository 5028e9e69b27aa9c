// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace geocloth::cpu {

/// Model name of this machine's processor, or "cpu" where the system does not tell.
[[nodiscard]] std::string cpu_name();

}  // namespace geocloth::cpu
