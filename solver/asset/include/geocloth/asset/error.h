// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace geocloth {

/// Why an operation could not be done. Quality is never an error: it is data in a report.
enum class ErrorCode {
  invalid_argument,  ///< A value passed by the caller is out of its documented range.
  io,                ///< A file is missing, is a directory, or cannot be read or written.
  invalid_data,      ///< A file was read, but what it holds is broken.
  unsupported,       ///< The input is well formed, but needs something that geocloth cannot do.
  limit,             ///< A documented limit (size, count, memory) would be exceeded.
  device,            ///< No usable device, or the device failed.
  verification,      ///< A result failed its own check and was refused.
  cancelled,         ///< The user or the caller's progress callback asked to stop.
};

/// Besides std::bad_alloc all that geocloth throws. what() names the file, the element and the remedy in one line.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace geocloth
