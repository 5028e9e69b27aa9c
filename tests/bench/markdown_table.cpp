// SPDX-License-Identifier: GPL-3.0-or-later
// A table that people and git read line by line, and this program reads back to say what changed.
#include "markdown_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

namespace geocloth::bench {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line.substr(1));
  for (std::string cell; std::getline(stream, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

/// The number at the beginning of a cell, with the marks taken away.
std::optional<double> number_of(std::string cell) {
  std::erase(cell, '*');
  double value = 0;
  const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (failure != std::errc()) return std::nullopt;
  return value;
}

const MarkdownTable* find_table(const std::vector<MarkdownTable>& tables, const std::string& heading) {
  const auto found =
      std::find_if(tables.begin(), tables.end(), [&](const MarkdownTable& t) { return t.heading == heading; });
  return found == tables.end() ? nullptr : &*found;
}

const std::vector<std::string>* find_row(const MarkdownTable& table, const std::string& name) {
  const auto found = std::find_if(table.row.begin(), table.row.end(), [&](const auto& row) { return row[0] == name; });
  return found == table.row.end() ? nullptr : &*found;
}

/// Cells of one row that changed.
std::string row_differences(const MarkdownTable& before, const std::vector<std::string>& old_row,
                            const MarkdownTable& after, const std::vector<std::string>& row,
                            const std::map<std::string, Better>& direction) {
  const std::string name = row[0] + ", " + after.heading + ": ";
  const bool was = old_row.size() == before.column.size(), is = row.size() == after.column.size();
  if (was && !is) return name + "converted before, now " + row.back() + "\n";
  if (!was && is) return name + "converts now, better\n";
  std::string text;
  for (std::size_t c = 1; is && c < row.size(); ++c) {
    const auto known = direction.find(after.column[c]);
    const auto old_column = std::find(before.column.begin(), before.column.end(), after.column[c]);
    if (known == direction.end() || old_column == before.column.end()) continue;
    const auto old_value = number_of(old_row[static_cast<std::size_t>(old_column - before.column.begin())]);
    const auto value = number_of(row[c]);
    constexpr double kNoticed = 0.01;
    if (!old_value || !value || std::abs(*value - *old_value) <= kNoticed * std::abs(*old_value)) continue;
    const bool better = (*value < *old_value) == (known->second == Better::less);
    std::ostringstream line;
    line << name << after.column[c] << ' ' << *old_value << " -> " << *value << (better ? ", better\n" : ", WORSE\n");
    text += line.str();
  }
  return text;
}

}  // namespace

std::string to_markdown(const MarkdownTable& table) {
  std::string text = "## " + table.heading + "\n\n|";
  for (const std::string& name : table.column) text += ' ' + name + " |";
  text += "\n|";
  for (std::size_t c = 0; c < table.column.size(); ++c) text += "---|";
  text += '\n';
  for (const auto& row : table.row) {
    text += '|';
    for (std::string cell : row) {
      std::replace(cell.begin(), cell.end(), '|', '/');
      std::replace(cell.begin(), cell.end(), '\n', ' ');
      text += ' ' + cell + " |";
    }
    text += '\n';
  }
  return text + '\n';
}

std::vector<MarkdownTable> parse_markdown(const std::string& text) {
  std::vector<MarkdownTable> tables;
  std::istringstream stream(text);
  std::string heading;
  bool inside = false;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("## ")) heading = line.substr(3);
    if (!line.starts_with('|')) {
      inside = false;
    } else if (!inside) {
      inside = true;
      tables.push_back({heading, cells_of(line), {}});
    } else if (!line.starts_with("|---")) {
      tables.back().row.push_back(cells_of(line));
    }
  }
  return tables;
}

std::string differences(const std::vector<MarkdownTable>& before, const std::vector<MarkdownTable>& after,
                        const std::map<std::string, Better>& direction) {
  std::string text;
  for (const MarkdownTable& table : after) {
    const MarkdownTable* old_table = find_table(before, table.heading);
    if (old_table == nullptr) continue;
    for (const auto& row : table.row) {
      const auto* old_row = find_row(*old_table, row[0]);
      text += old_row == nullptr ? row[0] + ", " + table.heading + ": new\n"
                                 : row_differences(*old_table, *old_row, table, row, direction);
    }
    for (const auto& old_row : old_table->row) {
      if (find_row(table, old_row[0]) == nullptr) text += old_row[0] + ", " + table.heading + ": gone\n";
    }
  }
  return text;
}

}  // namespace geocloth::bench
