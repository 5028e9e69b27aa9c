// SPDX-License-Identifier: GPL-3.0-or-later
// What a user must never find: half a file, a stray temporary, an old result lost to a run that failed.
#include "geocloth/asset/output_file.h"

#include <csignal>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "geocloth/asset/error.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  static std::string text(const fs::path& path) {
    const auto bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  static ErrorCode code_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code();
    }
    ADD_FAILURE() << "no error";
    return ErrorCode::verification;
  }

  const test::TemporaryFolder folder_;
};

using Names = std::vector<std::string>;

TEST_F(OutputFileTest, AppearsOnlyOnCommit) {
  OutputFile file(folder_ / "a.glb");
  file.write("hello");
  EXPECT_FALSE(fs::exists(folder_ / "a.glb"));
  EXPECT_EQ(file.temporary_path().extension(), ".glb");
  file.commit();
  EXPECT_EQ(folder_.entries(), Names{"a.glb"});
  EXPECT_EQ(text(folder_ / "a.glb"), "hello");
}

TEST_F(OutputFileTest, AnAbandonedFileLeavesTheOldOneAlone) {
  write_file(folder_ / "a.txt", "old");
  { OutputFile(folder_ / "a.txt").write("new"); }
  EXPECT_EQ(folder_.entries(), Names{"a.txt"});
  EXPECT_EQ(text(folder_ / "a.txt"), "old");
  write_file(folder_ / "a.txt", "new");
  EXPECT_EQ(text(folder_ / "a.txt"), "new");
}

TEST_F(OutputFileTest, AnotherProgramMayWriteTheTemporaryFile) {
  OutputFile file(folder_ / "film.mp4");
  file.close();
  write_file(file.temporary_path(), "from ffmpeg");
  file.commit();
  EXPECT_EQ(text(folder_ / "film.mp4"), "from ffmpeg");
}

TEST_F(OutputFileTest, SeekRewritesAHeader) {
  OutputFile file(folder_ / "a");
  file.write("....tail");
  file.seek(0);
  file.write("head");
  file.commit();
  EXPECT_EQ(text(folder_ / "a"), "headtail");
}

TEST_F(OutputFileTest, RefusesWhatIsNoFile) {
  EXPECT_EQ(code_of([&] { OutputFile file(folder_.path()); }), ErrorCode::io);
  EXPECT_EQ(code_of([&] { OutputFile file(folder_ / "missing/a"); }), ErrorCode::io);
  EXPECT_EQ(code_of([&] { OutputFile file(fs::path{}); }), ErrorCode::io);
  EXPECT_EQ(code_of([&] { OutputFile file("/dev/null"); }), ErrorCode::io);
  EXPECT_TRUE(folder_.entries().empty());
}

TEST_F(OutputFileTest, ALinkStaysALinkAndLongNamesWork) {
  write_file(folder_ / "target", "old");
  fs::create_symlink("target", folder_ / "link");
  write_file(folder_ / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(text(folder_ / "target"), "new");
  const std::string name(255, 'x');
  write_file(folder_ / name, "long");
  EXPECT_EQ(text(folder_ / name), "long");
}

TEST_F(OutputFileTest, AFullDiskIsAnErrorAndLeavesNothing) {
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 4096;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  const ErrorCode code = code_of([&] { write_file(folder_ / "big", std::string(100000, 'x')); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(code, ErrorCode::io);
  EXPECT_TRUE(folder_.entries().empty());
}

TEST_F(OutputFileTest, InterruptionRemovesEverythingUnfinished) {
  write_file(folder_ / "kept", "kept");
  OutputFile a(folder_ / "a"), b(folder_ / "b");
  OutputSeries series;
  for (uint32_t i = 0; i < 3; ++i) series.open(numbered_path(folder_ / "s.png", i)).write("picture");
  EXPECT_EQ(folder_.entries().size(), 6U);
  remove_unfinished_files();
  EXPECT_EQ(folder_.entries(), Names{"kept"});
}

TEST_F(OutputFileTest, ASeriesAppearsWhole) {
  OutputSeries series;
  for (uint32_t i = 0; i < 2000; ++i) series.open(numbered_path(folder_ / "s.png", i)).write(std::to_string(i));
  EXPECT_FALSE(fs::exists(folder_ / "s_0000.png"));
  series.commit();
  EXPECT_EQ(folder_.entries().size(), 2000U);
  EXPECT_EQ(text(folder_ / "s_1999.png"), "1999");
}

TEST_F(OutputFileTest, ASeriesThatCannotCommitTakesItsFilesBack) {
  OutputSeries series;
  for (uint32_t i = 0; i < 4; ++i) series.open(numbered_path(folder_ / "s.png", i)).write("x");
  fs::create_directory(folder_ / "s_0002.png");  // in the way of the third
  EXPECT_EQ(code_of([&] { series.commit(); }), ErrorCode::io);
  EXPECT_FALSE(fs::exists(folder_ / "s_0000.png"));
  EXPECT_FALSE(fs::exists(folder_ / "s_0001.png"));
}

TEST_F(OutputFileTest, NumbersGrowBeyondFourDigits) {
  EXPECT_EQ(numbered_path("dir/out.obj", 7), "dir/out_0007.obj");
  EXPECT_EQ(numbered_path("out.obj", 12345), "out_12345.obj");
}

TEST_F(OutputFileTest, ReadingNamesWhatIsWrong) {
  EXPECT_EQ(code_of([&] { static_cast<void>(read_file(folder_.path())); }), ErrorCode::io);
  EXPECT_EQ(code_of([&] { static_cast<void>(read_file(folder_ / "missing")); }), ErrorCode::io);
  ::mkfifo((folder_ / "pipe").c_str(), 0600);
  EXPECT_EQ(code_of([&] { static_cast<void>(read_file(folder_ / "pipe")); }), ErrorCode::io);
  write_file(folder_ / "empty", "");
  EXPECT_TRUE(read_file(folder_ / "empty").empty());
  write_file(folder_ / "ten", "0123456789");
  EXPECT_EQ(code_of([&] { static_cast<void>(read_file(folder_ / "ten", 9)); }), ErrorCode::io);
}

}  // namespace
}  // namespace geocloth
