// SPDX-License-Identifier: GPL-3.0-or-later
// Progress and interruption. Interrupting needs no cooperation of the running stage (CGAL calls can last many
// seconds): every output lives under a temporary name until it is complete, the handler removes those names with
// async-signal-safe calls only, and leaves. It runs in the main thread, which opens all outputs: none can appear beside
// it.
#include "progress.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include "geocloth/asset/output_file.h"

namespace geocloth {
namespace {

constexpr int kBarWidth = 30;
constexpr int kStatusOfSignal = 128;  ///< and the signal's number on top, as shells have it

/// Ctrl-C, kill, a terminal that is closed, a reader that has gone (`| head`), and `ulimit -t`.
constexpr std::array<int, 5> kInterrupts{SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXCPU};

pthread_t main_thread;  // set before the handler is

void handle_interrupt(int signal) {
  if (pthread_equal(pthread_self(), main_thread) == 0) {
    pthread_kill(main_thread, signal);
    return;
  }
  remove_unfinished_files();
  _exit(kStatusOfSignal + signal);
}

}  // namespace

void say(const std::string& words) {
  std::fputs(words.c_str(), stderr);
}

ProgressDisplay::ProgressDisplay(std::string command, bool quiet)
    : command_(std::move(command)), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressDisplay::~ProgressDisplay() {
  if (!quiet_ && terminal_ && percent_ >= 0) say("\r\x1b[K");
}

void ProgressDisplay::show(std::string_view stage, double fraction) {
  if (quiet_) return;
  const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
  const bool new_stage = stage != stage_;
  if (!new_stage && percent == percent_) return;
  const auto now = std::chrono::steady_clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(50) : std::chrono::milliseconds(2000);
  if (!new_stage && now - shown_at_ < pause) return;

  stage_ = stage;
  percent_ = percent;
  shown_at_ = now;
  if (terminal_) {
    const int filled = percent * kBarWidth / 100;
    say(fmt::format("\r\x1b[K{} [{:#<{}}{:.<{}}] {:3} %", stage_, "", filled, "", kBarWidth - filled, percent_));
  } else {
    say(fmt::format("geocloth {}: {} {} %\n", command_, stage_, percent_));
  }
  std::fflush(stderr);
}

void remove_unfinished_files_on_interrupt() {
  main_thread = pthread_self();
  struct sigaction action {};
  action.sa_handler = handle_interrupt;
  sigemptyset(&action.sa_mask);
  for (const int signal : kInterrupts) sigaddset(&action.sa_mask, signal);
  for (const int signal : kInterrupts) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    // nohup stays in force.
    const bool ignored = signal == SIGHUP && before.sa_handler == SIG_IGN;
    if (!ignored) sigaction(signal, &action, nullptr);
  }
  // A file past the size that `ulimit -f` allows is then an error of write() like that of a full disk.
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

}  // namespace geocloth
