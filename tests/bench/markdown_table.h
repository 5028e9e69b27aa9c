// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

namespace geocloth::bench {

/// A table of a Markdown file: its heading and its cells as text.
struct MarkdownTable {
  std::string heading;  ///< of the section it stands in
  std::vector<std::string> column;
  std::vector<std::vector<std::string>> row;  ///< the first cell is the row's name
};

[[nodiscard]] std::string to_markdown(const MarkdownTable& table);

/// Every table of a text that to_markdown wrote.
[[nodiscard]] std::vector<MarkdownTable> parse_markdown(const std::string& text);

/// Whether less or more is better, per column; columns that are not named are not compared.
enum class Better { less, more };

/// One line per number that changed by more than a hundredth, and per row that came, went, or is refused or converted
/// now: "garments/a.obj, panels: PSNR 79.1 -> 81.2, better".
[[nodiscard]] std::string differences(const std::vector<MarkdownTable>& before, const std::vector<MarkdownTable>& after,
                                      const std::map<std::string, Better>& direction);

}  // namespace geocloth::bench
