// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace geocloth {

/// A file that a command reads or writes, under the name that the user gave.
struct NamedFile {
  std::string option;  ///< how a message calls it: "--report"
  std::filesystem::path path;
  bool numbered = false;  ///< a series: out.png stands for out_0000.png and the rest
};

/// Says what is wrong when an output would replace a file that the command reads, or another of its outputs; empty when
/// nothing is. Links and ways like "./a/../b.obj" are followed.
[[nodiscard]] std::string find_name_clash(const std::vector<NamedFile>& reads, const std::vector<NamedFile>& writes);

}  // namespace geocloth
