// SPDX-License-Identifier: GPL-3.0-or-later
// ffmpeg as a child process. Its input is a socket, not a pipe, so that a dead ffmpeg is an error of send() and not a
// SIGPIPE; its complaints go to a temporary file, so that it never waits for us to read them. It has a process group of
// its own (Ctrl-C is ours to handle: ffmpeg would answer it by completing the file) and dies with its parent.
#include "render/video.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

std::filesystem::path find_program(std::string_view name) {
  const char* path = std::getenv("PATH");
  std::string_view folders = path == nullptr ? std::string_view() : path;
  while (!folders.empty()) {
    const size_t end = folders.find(':');
    std::filesystem::path candidate = std::filesystem::path(folders.substr(0, end)) / name;
    if (access(candidate.c_str(), X_OK) == 0 && !std::filesystem::is_directory(candidate)) return candidate;
    folders = end == std::string_view::npos ? std::string_view() : folders.substr(end + 1);
  }
  return {};
}

std::vector<std::string> arguments(const std::filesystem::path& output, uint32_t width, uint32_t height,
                                   double frame_rate) {
  return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-xerror", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt",
          "rgba", "-s", fmt::format("{}x{}", width, height), "-r", fmt::format("{}", frame_rate), "-i", "pipe:0",
          // Colours as the PNGs have them: BT.709 matrix, and said so in the file.
          "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv,format=yuv420p", "-c:v",
          "libx264", "-preset", "medium", "-crf", "17", "-colorspace", "bt709", "-color_primaries", "bt709",
          "-color_trc", "bt709", "-movflags", "+faststart", "-fflags", "+bitexact", "-f", "mp4",
          "file:" + output.string()};  // a colon in its name is no protocol
}

/// What follows fork() in the child: only async-signal-safe calls.
[[noreturn]] void become(const char* program, char* const* argv, int input, int complaints, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // it died before the line above
  dup2(input, STDIN_FILENO);
  dup2(complaints, STDOUT_FILENO);
  dup2(complaints, STDERR_FILENO);
  execv(program, argv);
  _exit(127);
}

}  // namespace

struct VideoWriter::Encoder {
  pid_t process = -1;
  int input = -1;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> complaints{std::tmpfile(), std::fclose};

  Encoder(const std::filesystem::path& program, std::vector<std::string> args) {
    std::array<int, 2> ends{-1, -1};
    if (complaints == nullptr || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      throw Error(ErrorCode::io, fmt::format("ffmpeg cannot be started: {}", std::strerror(errno)));
    std::vector<char*> argv;
    argv.reserve(args.size() + 1);
    for (std::string& arg : args) argv.push_back(arg.data());
    argv.push_back(nullptr);
    const pid_t parent = getpid();
    process = fork();
    if (process == 0) become(program.c_str(), argv.data(), ends[0], fileno(complaints.get()), parent);
    close(ends[0]);
    input = ends[1];
    if (process < 0) {
      close(input);
      throw Error(ErrorCode::io, fmt::format("ffmpeg cannot be started: {}", std::strerror(errno)));
    }
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    if (process > 0) kill(process, SIGKILL);
    wait();
  }

  bool send_all(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = send(input, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      bytes = bytes.subspan(static_cast<size_t>(sent));
    }
    return true;
  }

  /// Ends the input and waits; true when ffmpeg is content.
  bool wait() {
    if (input >= 0) close(input);
    input = -1;
    if (process <= 0) return true;
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    process = -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  /// The first line of what ffmpeg complained about.
  std::string words() {
    std::array<char, 400> line{};
    std::rewind(complaints.get());
    const size_t length = std::fread(line.data(), 1, line.size() - 1, complaints.get());
    const std::string_view text(line.data(), length);
    return std::string(text.substr(0, text.find('\n')));
  }
};

VideoWriter::VideoWriter(const std::filesystem::path& path, uint32_t width, uint32_t height, double frame_rate)
    : path_(path), width_(width), height_(height), file_(path) {
  if (width == 0 || height == 0 || !(frame_rate > 0))
    throw Error(ErrorCode::invalid_argument, path.string() + ": a film needs a size and a frame rate above 0");
  const std::filesystem::path program = find_program("ffmpeg");
  if (program.empty())
    throw Error(ErrorCode::io, path.string() +
                                   ": the program ffmpeg, which makes films, is not installed; install it (Debian: "
                                   "ffmpeg) or write numbered pictures by naming the output .png");
  encoder_ = std::make_unique<Encoder>(program, arguments(file_.temporary_path(), width, height, frame_rate));
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const Picture& picture) {
  if (picture.width != width_ || picture.height != height_)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{}: a frame has {} x {} pixels, the film {} x {}", path_.string(), picture.width,
                            picture.height, width_, height_));
  if (!encoder_->send_all(picture.bytes())) fail();
}

void VideoWriter::finish() {
  if (!encoder_->wait()) fail();
}

void VideoWriter::commit() {
  file_.commit();
}

void VideoWriter::fail() {
  encoder_->wait();
  throw Error(ErrorCode::io, fmt::format("{}: ffmpeg could not make the film: {}", path_.string(), encoder_->words()));
}

}  // namespace geocloth
