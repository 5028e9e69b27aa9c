// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <fmt/format.h>

namespace geocloth {

constexpr uint32_t kMaxFrames = 1000000, kMaxThreads = 256;  ///< the most that --frames and --threads take

/// Options with one way of writing their help: "--frames N   text [unit; from low to high; default d]".
/// A value out of range is wrong usage (exit status 2) with a message that names the option.

/// @param value  holds the default when this is called
/// @param unit   e.g. "m", or "" for a plain count
/// @param no_default  said instead of the default's value when the option's absence means something of its own
template <class Number>
CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& placeholder, Number& value,
                        Number low, Number high, const std::string& unit, const std::string& text,
                        const std::string& no_default = {}) {
  const auto in_range = [low, high](const std::string& given) {
    Number number{};
    // Written so that "nan" is refused too.
    const bool good = CLI::detail::lexical_cast(given, number) && number >= low && number <= high;
    return good ? std::string() : fmt::format("{} is not a number from {} to {}", given, low, high);
  };
  const std::string default_text = no_default.empty() ? fmt::format("{}", value) : no_default;
  return app
      .add_option(name, value,
                  fmt::format("{} [{}from {} to {}; default {}]", text, unit.empty() ? "" : unit + "; ", low, high,
                              default_text))
      ->check(CLI::Validator(in_range, ""))
      ->option_text(placeholder);
}

/// One of a few words.
template <class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& text,
                        const std::string& no_default = {}) {
  std::string words;
  std::string default_text = no_default;
  for (const auto& [word, meaning] : choices) {
    words += (words.empty() ? "" : "|") + word;
    if (default_text.empty() && meaning == value) default_text = word;
  }
  const auto take = [&value, name, choices, words](const CLI::results_t& given) {
    for (const auto& [word, meaning] : choices) {
      if (word == given.back()) {
        value = meaning;
        return true;
      }
    }
    throw CLI::ValidationError(fmt::format("{}: {} is not one of {}", name, given.back(), words));
  };
  return app.add_option(name, take, fmt::format("{} [default {}]", text, default_text))->option_text(words);
}

/// A file or folder, or another plain text.
template <class Text>
CLI::Option* add_text(CLI::App& app, const std::string& name, const std::string& placeholder, Text& value,
                      const std::string& text, const std::string& default_text) {
  return app.add_option(name, value, fmt::format("{} [{}]", text, default_text))->option_text(placeholder);
}

/// Check of a file name's ending, upper or lower case.
inline CLI::Validator ends_with(const std::vector<std::string>& endings) {
  const auto check = [endings](const std::string& given) {
    const std::string ending = CLI::detail::to_lower(std::filesystem::path(given).extension().string());
    const bool known = std::find(endings.begin(), endings.end(), ending) != endings.end();
    return known ? std::string() : fmt::format("{} does not end in {}", given, fmt::join(endings, ", "));
  };
  return CLI::Validator(check, "");
}

/// --quiet, the same in every command that shows progress.
inline CLI::Option* add_quiet(CLI::App& app, bool& quiet) {
  return app.add_flag("-q,--quiet", quiet, "no progress on standard error [default off]");
}

}  // namespace geocloth
