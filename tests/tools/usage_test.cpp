// SPDX-License-Identifier: GPL-3.0-or-later
// What a script relies on before any work starts: exit status, streams, and a help that says unit, range and default.
#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/run_program.h"

namespace geocloth::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::vector<std::string> kCommands{"convert", "inspect", "simulate", "render", "view", "devices", "bench"};

std::ptrdiff_t count_lines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

class WrongUsage : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(WrongUsage, IsStatus2WithOneLineAndNoOutput) {
  const ProgramResult result = run_program(GetParam());
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
  EXPECT_THAT(result.err, StartsWith("geocloth"));
  EXPECT_THAT(result.err, HasSubstr("--help"));
}

using Words = std::vector<std::string>;
INSTANTIATE_TEST_SUITE_P(
    Usage, WrongUsage,
    testing::Values(
        Words{}, Words{"knit"}, Words{"--knit"}, Words{"convert"}, Words{"convert", "a.obj"},
        Words{"convert", "a.obj", "-o"}, Words{"convert", "a.obj", "-o", "a.obj"},
        Words{"convert", "a.obj", "-o", "a.glb", "--knit"}, Words{"convert", "a.obj", "b.obj", "-o", "a.glb"},
        Words{"convert", "a.obj", "-o", "a.glb", "--resolution", "7"},
        Words{"convert", "a.obj", "-o", "a.glb", "--resolution", "64x"},
        Words{"convert", "a.obj", "-o", "a.glb", "--resolution", "-64"},
        Words{"convert", "a.obj", "-o", "a.glb", "--spacing", "0"},
        Words{"convert", "a.obj", "-o", "a.glb", "--spacing", "nan"},
        Words{"convert", "a.obj", "-o", "a.glb", "--spacing", "0.01", "--resolution", "64"},
        Words{"convert", "a.obj", "-o", "a.glb", "--layout", "round"},
        Words{"convert", "a.obj", "-o", "a.glb", "--unit", "ell"},
        Words{"convert", "a.obj", "-o", "a.glb", "--unit", "cm", "--scale", "0.01"},
        Words{"convert", "a.obj", "-o", "a.glb", "--scale", "inf"}, Words{"inspect"},
        Words{"convert", "a.glb", "-o", "./b/../a.glb"}, Words{"convert", "a.obj", "-o", "a.glb", "--report", "a.obj"},
        Words{"convert", "a.obj", "-o", "a.glb", "--report", "a.glb"},
        Words{"inspect", "a.glb", "--mesh", "a.obj", "--charts", "a.obj"}, Words{"simulate", "a.glb", "-o", "a.glb"},
        Words{"simulate", "a.json", "--report", "a.json"},
        Words{"simulate", "a.glb", "-o", "b.obj", "--last-state", "b_0003.obj"},
        Words{"inspect", "a.glb", "--mesh", "a.stl"}, Words{"simulate"}, Words{"simulate", "a.glb"},
        Words{"simulate", "a.txt", "-o", "a.obj"}, Words{"simulate", "a.glb", "-o", "a.gif"},
        Words{"simulate", "a.glb", "-o", "a.glb", "-o", "a"}, Words{"simulate", "a.glb", "-o", "b.glb", "-o", "b.glb"},
        Words{"simulate", "a.glb", "-o", "b.glb", "--frames", "-1"},
        Words{"simulate", "a.glb", "-o", "b.glb", "--frames", "1e3"},
        Words{"simulate", "a.glb", "-o", "b.glb", "--threads", "0"},
        Words{"simulate", "a.glb", "-o", "b.glb", "--backend", "abacus"}, Words{"view"}, Words{"view", "a.txt"},
        Words{"view", "a.json", "--size", "640"}, Words{"view", "a.json", "--play", "--paused"},
        Words{"view", "a.json", "-o", "a.jpg"}, Words{"view", "a.json", "--show", "bones"},
        Words{"view", "a.json", "--frames", "-1"}, Words{"devices", "all"}, Words{"bench", "fast"},
        Words{"bench", "--scene", "loom"}, Words{"bench", "--size", "1"}, Words{"bench", "--compare", "a.json"}));

TEST(Usage, UnknownCommandNamesTheNearestOne) {
  EXPECT_THAT(run_program({"convret", "a.obj"}).err, HasSubstr("convert"));
}

TEST(Usage, HelpListsTheCommandsOnStandardOutput) {
  const ProgramResult result = run_program({"--help"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, IsEmpty());
  for (const std::string& command : kCommands) EXPECT_THAT(result.out, HasSubstr("\n  " + command + " "));
}

TEST(Usage, VersionIsOneLine) {
  const ProgramResult result = run_program({"--version"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out, "geocloth " GEOCLOTH_VERSION "\n");
}

/// The help's entries: an option's line with the lines that continue it.
std::vector<std::string> option_entries(const std::string& help) {
  std::vector<std::string> entries;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos) continue;
    if (start < 8 && line[start] == '-') {
      entries.push_back(line);
    } else if (start >= 8 && !entries.empty()) {
      entries.back() += line;
    }
  }
  return entries;
}

TEST(Usage, EveryCommandHelpSaysTheDefaultOfEveryOption) {
  for (const std::string& command : kCommands) {
    const ProgramResult result = run_program({command, "--help"});
    EXPECT_EQ(result.status, 0) << command;
    EXPECT_THAT(result.err, IsEmpty()) << command;
    const std::vector<std::string> entries = option_entries(result.out);
    EXPECT_GE(entries.size(), 2U) << command;
    for (const std::string& entry : entries) {
      if (entry.find("--help") != std::string::npos) continue;
      EXPECT_TRUE(entry.find("default") != std::string::npos || entry.find("required") != std::string::npos)
          << command << ": " << entry;
    }
  }
}

TEST(Usage, WhateverDrawsTakesTheSameOptions) {
  for (const char* option : {"--size", "--show"}) EXPECT_THAT(run_program({"view", "--help"}).out, HasSubstr(option));
  for (const char* command : {"simulate", "render"}) {
    const std::string help = run_program({command, "--help"}).out;
    for (const char* option : {"--camera", "--size", "--show"}) EXPECT_THAT(help, HasSubstr(option)) << command;
  }
}

TEST(Usage, HelpSaysUnitRangeAndDefaultOfANumber) {
  EXPECT_THAT(run_program({"convert", "--help"}).out, HasSubstr("pixels; from 8 to 4096; default 128"));
}

}  // namespace
}  // namespace geocloth::test
