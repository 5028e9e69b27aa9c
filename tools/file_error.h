// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"

namespace geocloth {

/// Calls `work`; an Error that does not name the file it is about gets the file's name in front. One about a device or
/// a display is about no file.
template <class Work>
auto name_file_in_errors(const std::filesystem::path& file, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const Error& error) {
    const std::string message = error.what();
    const bool named = error.code() == ErrorCode::device || message.find(file.filename().string()) != std::string::npos;
    throw Error(error.code(), named ? message : file.string() + ": " + message);
  }
}

}  // namespace geocloth
