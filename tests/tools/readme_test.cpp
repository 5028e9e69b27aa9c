// SPDX-License-Identifier: GPL-3.0-or-later
// What the README shows is what is compiled and shipped.
#include <algorithm>
#include <cctype>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

const std::string kSource = GEOCLOTH_SOURCE_DIR "/";

/// A file without its licence line.
std::string body_of(const std::string& path) {
  const std::string text = read_text(kSource + path);
  return text.substr(text.find('\n') + 1);
}

TEST(Readme, LibraryExamplesAreThePrograms) {
  const std::string readme = read_text(kSource + "README.md");
  EXPECT_THAT(readme, testing::HasSubstr("```cpp\n" + body_of("tests/install/solver/main.cpp") + "```"));
  EXPECT_THAT(readme, testing::HasSubstr("```cmake\n" + body_of("tests/install/solver/CMakeLists.txt") + "```"));
}

/// Text without what stands between ``` and ```.
std::string without_code(const std::string& text) {
  std::string prose;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find("```", at);
    prose += text.substr(at, open - at);
    if (open == std::string::npos) break;
    const std::size_t close = text.find("```", open + 3);
    at = close == std::string::npos ? text.size() : close + 3;
  }
  return prose;
}

/// The names by which the headings of a Markdown text are linked to: lower case, hyphens for spaces, no punctuation.
std::vector<std::string> headings(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream lines(without_code(text));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t start = line.find_first_not_of('#');
    if (start == 0 || start == std::string::npos || line[start] != ' ') continue;
    std::string& name = names.emplace_back();
    for (const char c : line.substr(start + 1)) {
      if (c == ' ') name += '-';
      if (c == '-' || std::isalnum(static_cast<unsigned char>(c)) != 0)
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return names;
}

TEST(Readme, EveryFileItPointsToExists) {
  const std::string readme = without_code(read_text(kSource + "README.md"));
  std::size_t links = 0;
  for (std::size_t at = readme.find("]("); at != std::string::npos; at = readme.find("](", at + 1)) {
    const std::string target = readme.substr(at + 2, readme.find(')', at) - at - 2);
    if (target.starts_with("http") || target.starts_with('#')) continue;
    const std::size_t hash = std::min(target.find('#'), target.size());
    const std::string file = kSource + target.substr(0, hash);
    EXPECT_TRUE(std::filesystem::exists(file)) << target;
    if (hash < target.size()) {
      EXPECT_THAT(headings(read_text(file)), testing::Contains(target.substr(hash + 1)));
    }
    ++links;
  }
  EXPECT_GT(links, 0U);
}

TEST(Readme, SceneFilesOfTheRepositoryAreGood) {
  const TemporaryFolder folder;
  for (const char* name : {"t_shirt", "poncho", "cape"}) {
    const std::string mesh = kSource + "meshes/garments/" + name + ".obj";
    ASSERT_EQ(
        run_program({"convert", mesh, "-o", folder / (std::string(name) + ".glb"), "--resolution", "32", "-q"}).status,
        0);
    const std::string scene =
        folder.write(std::string(name) + ".json", read_text(kSource + "meshes/scenes/" + name + ".json"));
    const ProgramResult result = run_program({"simulate", scene, "--check"});
    EXPECT_EQ(result.status, 0) << result.err;
  }
}

}  // namespace
}  // namespace geocloth::test
