// SPDX-License-Identifier: GPL-3.0-or-later
// Outputs replace what bears their name, so a slip of the hand (`simulate shirt.glb -o shirt.glb`) would cost the user
// the garment. Names are compared as the places that they lead to.
#include "file_names.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include <fmt/format.h>

namespace geocloth {
namespace {

namespace fs = std::filesystem;

/// The place that a name leads to; the name itself where the system cannot tell.
fs::path place_of(const fs::path& path) {
  std::error_code error;
  const fs::path place = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : place;
}

bool all_digits(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Whether `file` is one of the series: out_0007.png of out.png.
bool is_in_series(const fs::path& file, const fs::path& series) {
  const std::string stem = file.stem().string();
  const std::string start = series.stem().string() + "_";
  return file.parent_path() == series.parent_path() && file.extension() == series.extension() &&
         stem.starts_with(start) && stem.size() >= start.size() + 4 && all_digits(stem.substr(start.size()));
}

bool replaces(const NamedFile& output, const NamedFile& other) {
  const fs::path a = place_of(output.path);
  const fs::path b = place_of(other.path);
  if (output.numbered == other.numbered) return a == b;
  return output.numbered ? is_in_series(b, a) : is_in_series(a, b);
}

}  // namespace

std::string find_name_clash(const std::vector<NamedFile>& reads, const std::vector<NamedFile>& writes) {
  for (std::size_t i = 0; i < writes.size(); ++i) {
    const NamedFile& output = writes[i];
    for (const NamedFile& input : reads) {
      if (replaces(output, input))
        return fmt::format("{}: {} would replace {}; give another name", output.option, output.path.string(),
                           input.option);
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (!replaces(output, writes[k])) continue;
      if (output.option == writes[k].option)
        return fmt::format("{}: {} is given twice", output.option, output.path.string());
      return fmt::format("{}: {} would replace what {} writes; give another name", output.option, output.path.string(),
                         writes[k].option);
    }
  }
  return {};
}

}  // namespace geocloth
