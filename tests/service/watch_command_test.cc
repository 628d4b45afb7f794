// Tests of `thunderhead watch` as a workflow suite runs it: files arrive as they do in operation.
#include <fcntl.h>
#include <netcdf.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/service/product_folder.h"
#include "tests/service/running_program.h"
#include "tests/service/synthetic_run.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

class WatchCommand : public ::testing::Test {
 protected:
  WatchCommand() {
    fs::create_directories(model_);
    fs::create_directories(inbox_);
    std::ofstream(west_) << R"({"camera": {"orbit": {"azimuthDeg": 270}}})";
    std::ofstream(above_) << R"({"camera": {"topDown": {}}})";
  }

  std::vector<std::string> Arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"watch", inbox_,     "--product", products_, "--views",
                                          west_,   above_,     "--size",    "32x18",   "--quality",
                                          "fast",  "--device", "software"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  // Returns the bytes of a complete file of the run.
  std::string Bytes(int time) const {
    WriteRunFile(model_, time);
    return Contents(RunFile(model_, time));
  }

  // Returns the time that is `seconds` from now.
  static std::string In(int seconds) {
    return absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", absl::Now() + absl::Seconds(seconds),
                            absl::UTCTimeZone());
  }

  static void Await(const std::function<bool()>& holds, RunningProgram& program) {
    WaitFor([&] { return holds() || !program.Runs(); });
    EXPECT_TRUE(holds());
  }

  // Returns the number of lines that programs have written so far.
  std::size_t Lines() const {
    std::size_t lines = 0;
    for (const std::string& file : {out_, err_}) {
      const std::string text = Contents(file);
      lines += static_cast<std::size_t>(std::ranges::count(text, '\n'));
    }
    return lines;
  }

  // Returns how often programs have found the file incomplete.
  std::size_t Refusals(int time) const {
    const std::string text = Contents(err_);
    const std::string refusal = "until it changes: " + RunFile(inbox_, time);
    std::size_t count = 0;
    for (std::size_t at = text.find(refusal); at != std::string::npos;
         at = text.find(refusal, at + 1)) {
      ++count;
    }
    return count;
  }

  void Put(int time, const std::string& bytes) const {
    std::ofstream(RunFile(inbox_, time), std::ios::binary) << bytes;
  }

  // Writes the file in pieces, as a slow copy does. Each piece is written after a program has found
  // the file incomplete.
  void PutSlowly(int time, const std::string& bytes) const {
    std::ofstream file(RunFile(inbox_, time), std::ios::binary);
    constexpr std::size_t kPieces = 4;
    const std::size_t piece = bytes.size() / kPieces + 1;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      const std::size_t refusals = Refusals(time);
      file << bytes.substr(at, piece) << std::flush;
      if (at + piece >= bytes.size()) return;
      EXPECT_TRUE(WaitFor([&] { return Refusals(time) > refusals; }));
    }
  }

  static std::vector<std::string> Products(int times) {
    std::vector<std::string> names;
    for (int time = 0; time < times; ++time) {
      for (const char* view : {"west", "above"}) {
        names.push_back("inbox_2013052012_" + RunTime(time) + "_" + view + ".png");
      }
    }
    return names;
  }

  const TemporaryFolder folder_;
  const std::string model_ = folder_.File("model");
  const std::string inbox_ = folder_.File("inbox");
  const std::string products_ =
      folder_.File("out/{storm}_{run:%Y%m%d%H}_{valid:%Y%m%d_%H%M}_{view}.png");
  const std::string west_ = folder_.File("west.json");
  const std::string above_ = folder_.File("above.json");
  const std::string out_ = folder_.File("stdout");
  const std::string err_ = folder_.File("stderr");
};

// A stop takes effect between two files. Each of these files needs a reader process, so checking
// all of them takes long.
TEST_F(WatchCommand, ASignalEndsTheCheckOfManyOddFiles) {
  constexpr std::size_t kFiles = 1000;
  for (std::size_t i = 0; i < kFiles; ++i) {
    std::ofstream(fs::path(inbox_) / absl::StrCat("odd", i)) << "CDF\x01 cut short";
  }
  RunningProgram program(PROGRAM, Arguments({"--progress", "lines"}), out_, err_);
  Await([this] { return Lines() > 2; }, program);
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait().code, 75);
  EXPECT_LT(Lines(), kFiles) << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("interrupted"));
}

// Files are written slowly and in pieces. One is truncated and one is written twice, and the
// program is killed repeatedly meanwhile.
TEST_F(WatchCommand, FilesThatComeAsTheyDoInLifeAreEachDrawnOnce) {
  constexpr int kFiles = 5;
  const char* wanted = std::getenv("THUNDERHEAD_KILLS");
  const int kills = wanted == nullptr ? 3 : std::atoi(wanted);
  std::vector<std::string> bytes;
  for (int time = 0; time < kFiles; ++time) bytes.push_back(Bytes(time));
  std::jthread model([&] {
    PutSlowly(1, bytes[1]);
    Put(0, bytes[0]);
    Put(2, bytes[2].substr(0, bytes[2].size() / 2));
    PutSlowly(3, bytes[3]);
    // Waits until these three files are drawn, in two views.
    EXPECT_TRUE(
        WaitFor([&] { return EntriesOf(folder_.File("out/manifest.jsonl")).size() >= 3 * 2; }));
    Put(1, bytes[1]);
    PutSlowly(2, bytes[2]);
    PutSlowly(4, bytes[4]);
  });
  const std::vector<std::string> arguments =
      Arguments({"--ready", "age:0.1", "--until", std::to_string(kFiles), "files", "--movie",
                 folder_.File("out/{storm}.webm")});
  std::mt19937 random(5);
  std::uniform_int_distribution<std::size_t> moment(1, 5);
  for (int i = 0; i < kills; ++i) {
    // The program is killed after it has written a random number of lines. It writes a line for
    // each product and for each incomplete file.
    const std::size_t lines = Lines() + moment(random);
    RunningProgram program(PROGRAM, arguments, out_, err_);
    WaitFor([&] { return Lines() >= lines || !program.Runs(); });
    program.Signal(SIGKILL);
    program.Wait();
    ExpectWholePictures(folder_.File("out"));
  }
  EXPECT_EQ(RunningProgram(PROGRAM, arguments, out_, err_).Wait().code, 0) << Contents(err_);
  std::vector<std::string> products = Products(kFiles);
  products.push_back("inbox.webm");
  // ExpectFinished decodes pictures and checks hashes, including the movie's.
  ExpectFinished(folder_.File("out"), products);
  // Another scan of the folder draws nothing, even for a file that is copied in once more.
  Put(1, bytes[1]);
  const std::string before = folder_.File("before");
  EXPECT_EQ(RunningProgram(PROGRAM, arguments, before, err_).Wait().code, 0);
  EXPECT_THAT(Contents(before), Not(HasSubstr(" ms)")));
}

TEST_F(WatchCommand, AMarkedFileIsDrawnAndAnUnmarkedOneIsNot) {
  Put(0, Bytes(0));
  Put(1, Bytes(1));
  std::ofstream(folder_.File("inbox/wrfoutReady_d01_2013-05-20_20:10:00")) << "";
  const std::vector<std::string> arguments =
      Arguments({"--ready", "marker:wrfoutReady_*", "--files", "wrfout_d01_*", "--until", "1"});
  EXPECT_EQ(RunningProgram(PROGRAM, arguments, out_, err_).Wait().code, 0) << Contents(err_);
  std::vector<std::string> second = Products(2);
  second.erase(second.begin(), second.begin() + 2);
  ExpectFinished(folder_.File("out"), second);
}

// WRF writes its marker before it has closed the file.
TEST_F(WatchCommand, AMarkedFileThatIsNotWholeWaits) {
  const std::string whole = Bytes(1);
  Put(1, whole.substr(0, whole.size() / 2));
  std::ofstream(folder_.File("inbox/wrfoutReady_d01_2013-05-20_20:10:00")) << "";
  RunningProgram program(PROGRAM,
                         Arguments({"--ready", "marker:wrfoutReady_*", "--files", "wrfout_d01_*",
                                    "--until", "1", "--progress", "json"}),
                         out_, err_);
  Await([&] { return Contents(out_).find("\"waiting\"") != std::string::npos; }, program);
  EXPECT_THAT(Contents(out_), HasSubstr("{\"event\":\"waiting\",\"file\":\"" + RunFile(inbox_, 1) +
                                        "\",\"message\":\"waits until it"));
  Put(1, whole);
  EXPECT_EQ(program.Wait().code, 0) << Contents(err_);
  std::vector<std::string> second = Products(2);
  second.erase(second.begin(), second.begin() + 2);
  ExpectFinished(folder_.File("out"), second);
}

// HDF5 locks a file while it writes the file. To a reader the locked file looks damaged, but
// `watch` must wait for it.
TEST_F(WatchCommand, AFileThatItsWriterHoldsOpenIsNotReady) {
  Put(0, Bytes(0));
  int writer = 0;
  ASSERT_EQ(nc_open(RunFile(inbox_, 0).c_str(), NC_WRITE, &writer), NC_NOERR);
  // Sets close-on-exec: otherwise the programs started here would inherit the file and its lock.
  for (const auto& file : fs::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (fs::read_symlink(file, gone) == RunFile(inbox_, 0)) {
      fcntl(std::stoi(file.path().filename()), F_SETFD, FD_CLOEXEC);
    }
  }
  LeaveAlone(RunFile(inbox_, 0));
  EXPECT_EQ(RunningProgram(PROGRAM, {"inspect", RunFile(inbox_, 0)}, out_, err_).Wait().code, 75);
  EXPECT_THAT(Contents(err_), HasSubstr("another program is writing it"));
  // A later file is drawn, so this file would be drawn with it if it were ready.
  Put(1, Bytes(1));
  RunningProgram program(PROGRAM, Arguments({"--ready", "age:0", "--until", "2"}), out_, err_);
  const auto entries = [&] { return EntriesOf(folder_.File("out/manifest.jsonl")); };
  Await([&] { return entries().size() == 2; }, program);
  for (const auto& [name, entry] : entries()) EXPECT_EQ(entry.input.path, RunFile(inbox_, 1));
  ASSERT_EQ(nc_close(writer), NC_NOERR);
  EXPECT_EQ(program.Wait().code, 0) << Contents(err_);
  ExpectFinished(folder_.File("out"), Products(2));
}

TEST_F(WatchCommand, AFileWaitsForTheNextOrForItsSize) {
  Put(0, Bytes(0));
  Put(1, Bytes(1));
  EXPECT_EQ(RunningProgram(PROGRAM, Arguments({"--ready", "next", "--until", "1"}), out_, err_)
                .Wait()
                .code,
            0)
      << Contents(err_);
  ExpectFinished(folder_.File("out"), Products(1));
  // HDF5 ignores bytes after its end of file.
  Put(1, Bytes(1) + std::string(5000, '\0'));
  const std::size_t between = Bytes(1).size() + 2500;
  const std::string ready = "age:0,minsize:" + std::to_string(between);
  fs::remove_all(folder_.File("out"));
  EXPECT_EQ(RunningProgram(PROGRAM, Arguments({"--ready", ready, "--until", "1"}), out_, err_)
                .Wait()
                .code,
            0)
      << Contents(err_);
  std::vector<std::string> second = Products(2);
  second.erase(second.begin(), second.begin() + 2);
  ExpectFinished(folder_.File("out"), second);
}

// The clock was set back by an hour since the file was written, or the file comes from another
// machine's clock.
TEST_F(WatchCommand, AFileFromTheFutureWaitsNoLongerThanItRests) {
  const std::string bytes = Bytes(0);
  const auto begun = std::chrono::steady_clock::now();
  Put(0, bytes);
  fs::last_write_time(RunFile(inbox_, 0), fs::file_time_type::clock::now() + std::chrono::hours(1));
  EXPECT_EQ(RunningProgram(PROGRAM, Arguments({"--ready", "open", "--until", "1", "file", In(600)}),
                           out_, err_)
                .Wait()
                .code,
            0)
      << Contents(err_);
  EXPECT_GE(std::chrono::steady_clock::now() - begun, std::chrono::seconds(2)) << "did not rest";
  ExpectFinished(folder_.File("out"), Products(1));
}

TEST_F(WatchCommand, ABadFileCountsAndTheEndTellsOfIt) {
  Put(0, Bytes(0));
  WriteRunFile(inbox_, 1, 1.0, true);
  EXPECT_EQ(
      RunningProgram(PROGRAM, Arguments({"--ready", "age:0", "--until", "2", "files", In(600)}),
                     out_, err_)
          .Wait()
          .code,
      65)
      << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("1 files could not be drawn"));
  ExpectFinished(folder_.File("out"), Products(1));
}

// The file must be converted first, so waiting for it never helps.
TEST_F(WatchCommand, AFileThatIsRefusedForGoodCountsAsBad) {
  std::ofstream(inbox_ + "/cloud.vdb", std::ios::binary) << std::string(" BDV\0\0\0\0 a grid", 15);
  EXPECT_EQ(
      RunningProgram(PROGRAM, Arguments({"--ready", "age:0", "--until", "1", "file", In(600)}),
                     out_, err_)
          .Wait()
          .code,
      65)
      << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("thunderhead import-vdb"));
}

// Only one of two files with the same time is drawn. The command reports once which one it draws.
TEST_F(WatchCommand, OfTwoFilesWithOneTimeItSaysWhichItDraws) {
  Put(0, Bytes(0));
  const std::string copy = RunFile(inbox_, 0) + "_copy";
  std::ofstream(copy, std::ios::binary) << Bytes(0);
  EXPECT_EQ(
      RunningProgram(PROGRAM, Arguments({"--ready", "age:0", "--until", "2", "files"}), out_, err_)
          .Wait()
          .code,
      0)
      << Contents(err_);
  const std::string said = Contents(err_);
  const std::string note = absl::StrCat(" is in ", RunFile(inbox_, 0), " and in ", copy,
                                        "; the latter is used, because it was written later");
  const std::size_t at = said.find(note);
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find(note, at + 1), std::string::npos) << said;
  ExpectFinished(folder_.File("out"), Products(1));
}

// A suite may move drawn files to an archive, even while `watch` is not running.
TEST_F(WatchCommand, FilesThatAreMovedAwayOnceDrawnStillCount) {
  const std::vector<std::string> arguments =
      Arguments({"--ready", "age:0", "--until", "3", "files", In(3600), "--movie",
                 folder_.File("out/{storm}.webm")});
  const auto archive = [&](int time) {
    fs::rename(RunFile(inbox_, time), folder_.File("archived" + std::to_string(time)));
  };
  // Returns whether `files` input files are drawn: the products are two views of each file and the
  // movie of each view.
  const auto drawn = [&](std::size_t files) {
    const auto entries = EntriesOf(folder_.File("out/manifest.jsonl"));
    return entries.size() == 2 * files + 1 &&
           Contents(out_).find("inbox.webm") != std::string::npos;
  };
  {
    RunningProgram program(PROGRAM, arguments, out_, err_);
    for (int time = 0; time < 2; ++time) {
      Put(time, Bytes(time));
      Await([&] { return drawn(static_cast<std::size_t>(time) + 1); }, program);
      archive(time);
    }
  }
  // The program was killed, and is started again when both files are gone.
  RunningProgram program(PROGRAM, arguments, out_, err_);
  Put(2, Bytes(2));
  EXPECT_EQ(program.Wait().code, 0) << Contents(err_);
  std::vector<std::string> products = Products(3);
  products.push_back("inbox.webm");
  ExpectFinished(folder_.File("out"), products);
}

TEST_F(WatchCommand, AtTheEndItSaysWhatIsMissing) {
  Put(0, Bytes(0));
  const std::string cut = Bytes(1);
  Put(1, cut.substr(0, cut.size() / 2));
  std::ofstream(folder_.File("inbox/README")) << "no storm";
  // The program scans the folder at least once, even if it starts after that time.
  EXPECT_EQ(RunningProgram(PROGRAM, Arguments({"--ready", "age:0", "--until", In(1)}), out_, err_)
                .Wait()
                .code,
            75);
  EXPECT_THAT(Contents(err_),
              HasSubstr("thunderhead: waits until it changes: " + RunFile(inbox_, 1)));
  EXPECT_THAT(Contents(err_),
              HasSubstr("thunderhead: ignored until it changes: " + inbox_ + "/README"));
  EXPECT_THAT(Contents(err_), HasSubstr("1 files are not complete"));
  ExpectFinished(folder_.File("out"), Products(1));
  WriteRunFile(inbox_, 1, 1.0, true);
  EXPECT_EQ(RunningProgram(PROGRAM, Arguments({"--ready", "age:0", "--until", In(1)}), out_, err_)
                .Wait()
                .code,
            65);
  EXPECT_THAT(Contents(err_), HasSubstr("holds nothing but fill values"));
  ExpectFinished(folder_.File("out"), Products(1));
}

TEST_F(WatchCommand, ASignalEndsItWhileItWaits) {
  RunningProgram program(PROGRAM, Arguments({}), out_, err_);
  Await([&] { return fs::exists(folder_.File("out/manifest.jsonl")); }, program);
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait().code, 75);
  EXPECT_THAT(Contents(err_), HasSubstr("thunderhead: interrupted: the products of 0 files"));
}

TEST_F(WatchCommand, WhatIsWrongIsToldBeforeAnyFileComes) {
  const auto expect = [&](int code, const std::vector<std::string>& more, const std::string& text) {
    fs::remove(err_);
    EXPECT_EQ(RunningProgram(PROGRAM, Arguments(more), out_, err_).Wait().code, code) << text;
    EXPECT_THAT(Contents(err_), HasSubstr(text));
  };
  expect(64, {"--ready", "soon"}, "--ready is 'soon'");
  expect(64, {"--until", "soon"}, "--until is 'soon'");
  expect(64, {"--until", "5", "hours"}, "--until is '5 hours'");
  expect(64, {"--until", "5", "6"}, "--until is '5 6'");
  expect(64, {"--product", folder_.File("{time}_{view}.png")}, "--product");
  std::ofstream(above_) << R"({"sky": {"turbidity": 1000}})";
  expect(64, {}, "turbidity");
  fs::remove_all(inbox_);
  std::ofstream(above_) << "{}";
  expect(75, {}, "there is no such folder");
}

}  // namespace
}  // namespace thunderhead::testing
