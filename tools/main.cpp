// SPDX-License-Identifier: GPL-3.0-or-later
// The program: a table of commands, one file per command. Parsing ends before any work starts, so that wrong usage
// (exit status 2) is told apart from work that failed (1).
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "command.h"
#include "geocloth/asset/error.h"
#include "progress.h"

namespace {

using geocloth::CommandRun;

enum ExitStatus { kDone = 0, kFailed = 1, kWrongUsage = 2 };

struct Command {
  const char* name;
  const char* summary;
  CommandRun (*add)(CLI::App& app);
};

constexpr std::array<Command, 7> kCommands{{
    {"convert", "turn a garment mesh into an asset: geometry image and split-vertex table", geocloth::add_convert},
    {"inspect", "say what is in an asset, or write its grid mesh", geocloth::add_inspect},
    {"simulate", "run a scene and write the motion", geocloth::add_simulate},
    {"render", "make pictures of an asset or of a simulated motion, off screen", geocloth::add_render},
    {"view", "show a scene in a window: orbit, play, drag, cut", geocloth::add_view},
    {"devices", "list what can run the solver, and why a device cannot", geocloth::add_devices},
    {"bench", "measure how fast the solver is on this machine", geocloth::add_bench},
}};

/// One line, whatever the message holds.
void print_error(std::string_view command, std::string message) {
  for (char& c : message) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  geocloth::say(fmt::format("geocloth{}{}: {}\n", command.empty() ? "" : " ", command, message));
}

int report_usage(const CLI::App& program, const std::string& command, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(error);
  print_error(command, fmt::format("{}; see geocloth {}--help", error.what(), command.empty() ? "" : command + " "));
  return kWrongUsage;
}

int run_command(const std::string& name, const CommandRun& run) {
  try {
    run();
    return kDone;
  } catch (const std::bad_alloc&) {
    print_error(name, "out of memory; use less resolution, a smaller mesh, or smaller or fewer pictures");
  } catch (const std::exception& error) {
    print_error(name, error.what());
  }
  return kFailed;
}

/// Empty when the first word is a command or an option.
std::string describe_unknown_command(int argc, char** argv) {
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.starts_with('-')) return {};
  std::string known;
  for (const Command& command : kCommands) {
    if (word == command.name) return {};
    known += fmt::format("{}{}", known.empty() ? "" : ", ", command.name);
  }
  const std::string what = word.empty() ? "no command" : "unknown command " + word;
  return fmt::format("{}; known are {}; see geocloth --help", what, known);
}

int run_program(int argc, char** argv) {
  if (const std::string unknown = describe_unknown_command(argc, argv); !unknown.empty()) {
    print_error("", unknown);
    return kWrongUsage;
  }
  CLI::App program{"geocloth: garment meshes as geometry images, simulated as cloth", "geocloth"};
  program.set_version_flag("--version", "geocloth " GEOCLOTH_VERSION, "print the version and leave");
  program.set_help_flag("-h,--help", "print this help and leave; geocloth COMMAND --help for a command's options");
  program.get_formatter()->column_width(34);
  program.get_formatter()->label("SUBCOMMAND", "COMMAND");
  program.require_subcommand(1);

  std::vector<CLI::App*> apps;
  std::vector<CommandRun> runs;
  for (const Command& command : kCommands) {
    CLI::App* app = program.add_subcommand(command.name, command.summary)->group("Commands");
    app->set_help_flag("-h,--help", "print this help and leave");
    runs.push_back(command.add(*app));
    apps.push_back(app);
  }

  const auto chosen = [&] {
    std::size_t i = 0;
    while (i < apps.size() && !apps[i]->parsed()) ++i;
    return i;
  };
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::size_t i = chosen();
    return report_usage(program, i < apps.size() ? kCommands[i].name : "", error);
  }
  const std::size_t i = chosen();
  return run_command(kCommands[i].name, runs[i]);
}

/// A file that is opened would take the place of a closed one, and messages would be written into it.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", O_RDWR) < 0) std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  geocloth::remove_unfinished_files_on_interrupt();
  int status = kFailed;
  try {
    status = run_program(argc, argv);
  } catch (const std::exception& error) {
    print_error("", error.what());
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    print_error("", "standard output cannot be written; is its disk full?");
    return kFailed;
  }
  return status;
}
