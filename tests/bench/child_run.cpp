// SPDX-License-Identifier: GPL-3.0-or-later
// fork, a pipe for the answer, wait4 for the peak of resident memory.
#include "child_run.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>

#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

namespace geocloth::bench {
namespace {

constexpr int kRefused = 3;

void write_all(int file, const std::string& text) {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = write(file, text.data() + written, text.size() - written);
    if (count <= 0) return;
    written += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void be_the_child(const std::function<std::string()>& work, int answer, unsigned limit_seconds) {
  alarm(limit_seconds);
  int status = EXIT_SUCCESS;
  std::string text;
  try {
    text = work();
  } catch (const std::exception& e) {
    text = e.what();
    status = kRefused;
  }
  write_all(answer, text);
  _exit(status);
}

}  // namespace

ChildRun run_in_child(const std::function<std::string()>& work, unsigned limit_seconds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no child process");
  if (child == 0) {
    close(ends[0]);
    be_the_child(work, ends[1], limit_seconds);
  }
  close(ends[1]);
  ChildRun run;
  std::array<char, 4096> buffer{};
  for (ssize_t count = 0; (count = read(ends[0], buffer.data(), buffer.size())) > 0;) {
    run.text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto in_seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  run.cpu_seconds = in_seconds(usage.ru_utime) + in_seconds(usage.ru_stime);
  run.peak_memory_bytes = static_cast<uint64_t>(usage.ru_maxrss) * 1024;
  run.done = WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    run.text = signal == SIGALRM ? "took more than " + std::to_string(limit_seconds) + " s"
                                 : std::string("crashed (") + strsignal(signal) + ")";
  } else if (!run.done) {
    run.text = "refused: " + run.text;
  }
  return run;
}

}  // namespace geocloth::bench
