// SPDX-License-Identifier: GPL-3.0-or-later
// fork, a pipe for the answer, poll to hear who is done, wait4 for the peak of resident memory.
#include "child_run.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>
#include <vector>

#include <poll.h>
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

/// A child at work.
struct Child {
  std::size_t number = 0;  ///< of its work
  pid_t process = 0;
  int answer = -1;  ///< the pipe that it writes to
  std::chrono::steady_clock::time_point start;
  std::string text;
};

Child start_child(std::size_t number, const std::function<std::string(std::size_t)>& work, unsigned limit_seconds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  Child child{number, 0, ends[0], std::chrono::steady_clock::now(), {}};
  child.process = fork();
  if (child.process < 0) throw std::runtime_error("no child process");
  if (child.process == 0) {
    close(ends[0]);
    be_the_child([&] { return work(number); }, ends[1], limit_seconds);
  }
  close(ends[1]);
  return child;
}

/// What became of a child that has closed its pipe.
ChildRun ended(const Child& child, unsigned limit_seconds) {
  close(child.answer);
  int status = 0;
  rusage usage{};
  wait4(child.process, &status, 0, &usage);
  ChildRun run;
  run.text = child.text;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - child.start).count();
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

/// Waits until some child has something to say. @returns it
std::size_t next_to_speak(const std::vector<Child>& children) {
  std::vector<pollfd> files;
  files.reserve(children.size());
  for (const Child& child : children) files.push_back({child.answer, POLLIN, 0});
  if (poll(files.data(), files.size(), -1) < 0) throw std::runtime_error("cannot wait for a child process");
  const auto spoke = std::find_if(files.begin(), files.end(), [](const pollfd& file) { return file.revents != 0; });
  return static_cast<std::size_t>(spoke - files.begin());
}

}  // namespace

void run_in_children(std::size_t count, const std::function<std::string(std::size_t)>& work, unsigned at_once,
                     unsigned limit_seconds, const std::function<void(std::size_t, const ChildRun&)>& done) {
  std::vector<Child> children;
  for (std::size_t started = 0; started < count || !children.empty();) {
    if (started < count && children.size() < at_once) {
      children.push_back(start_child(started++, work, limit_seconds));
      continue;
    }
    const std::size_t i = next_to_speak(children);
    std::array<char, 4096> buffer{};
    const ssize_t read_count = read(children[i].answer, buffer.data(), buffer.size());
    if (read_count > 0) {
      children[i].text.append(buffer.data(), static_cast<std::size_t>(read_count));
      continue;
    }
    const Child child = std::move(children[i]);
    children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
    done(child.number, ended(child, limit_seconds));
  }
}

ChildRun run_in_child(const std::function<std::string()>& work, unsigned limit_seconds) {
  ChildRun result;
  run_in_children(
      1, [&](std::size_t) { return work(); }, 1, limit_seconds,
      [&](std::size_t, const ChildRun& run) { result = run; });
  return result;
}

}  // namespace geocloth::bench
