// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the program as a user's shell does: fork, exec, both streams into files, so that no pipe can fill up.
#include "support/run_program.h"

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

[[noreturn]] void exec_program(const std::vector<std::string>& arguments, const char* out, const char* err) {
  const int out_file = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err_file = open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out_file, STDOUT_FILENO);
  dup2(err_file, STDERR_FILENO);
  // What runs the tests may have run them with nohup, or ignore broken pipes.
  signal(SIGHUP, SIG_DFL);
  signal(SIGPIPE, SIG_DFL);
  std::vector<std::string> words{GEOCLOTH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& arguments, std::chrono::milliseconds interrupt_after,
                          int signal) {
  const TemporaryFolder streams;
  const std::string out = streams / "out", err = streams / "err";
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) exec_program(arguments, out.c_str(), err.c_str());
  if (interrupt_after.count() > 0) {
    std::this_thread::sleep_for(interrupt_after);
    kill(child, signal);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  ProgramResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = read_text(out);
  result.err = read_text(err);
  return result;
}

int run_in_shell(const std::string& arguments, const std::string& before) {
  const int status = std::system((before + "; exec '" GEOCLOTH_PROGRAM "' " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace geocloth::test
