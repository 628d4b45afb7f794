// Tests of `thunderhead sequence` as a workflow suite runs it: complete products, each drawn once,
// whenever the program is killed.
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"
#include "tests/service/hanging_storage.h"
#include "tests/service/product_folder.h"
#include "tests/service/running_program.h"
#include "tests/service/synthetic_run.h"
#include "tests/service/terminal.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"

namespace thunderhead::testing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr int kTimes = 3;

class SequenceCommand : public ::testing::Test {
 protected:
  SequenceCommand() {
    fs::create_directories(storms_);
    for (int time = 0; time < kTimes; ++time) WriteRunFile(storms_, time);
    std::ofstream(west_) << R"({"camera": {"orbit": {"azimuthDeg": 270}}})";
    std::ofstream(above_) << R"({"camera": {"topDown": {}}})";
  }

  // Returns arguments that write into the folder `out`.
  std::vector<std::string> Arguments(const std::string& out,
                                     const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        "sequence",  storms_,
        "--product", folder_.File(out) + "/{storm}_{valid:%Y%m%d_%H%M}_{view}.png",
        "--views",   west_,
        above_,      "--size",
        "32x18",     "--quality",
        "fast",      "--device",
        "software"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  Ending Run(const std::vector<std::string>& arguments) {
    fs::remove(out_);
    fs::remove(err_);
    return RunningProgram(PROGRAM, arguments, out_, err_).Wait();
  }

  // Starts a program whose storage hangs where HoldProduct has marked it.
  std::unique_ptr<RunningProgram> StartWithHangingStorage(const std::vector<std::string>& arguments,
                                                          const std::string& err) const {
    const HangingStorage hanging;
    return std::make_unique<RunningProgram>(PROGRAM, arguments, out_, err);
  }

  // Makes a program hang that begins to write the product with index `index`. Returns the path at
  // which it hangs.
  std::string HoldProduct(std::size_t index) const {
    fs::create_directories(folder_.File("out"));
    const std::string partial = folder_.File("out/" + Products()[index]) + ".partial";
    HangAt(partial);
    return partial;
  }

  static std::vector<std::string> Products() {
    std::vector<std::string> names;
    for (int time = 0; time < kTimes; ++time) {
      for (const char* view : {"west", "above"}) {
        names.push_back("storms_" + RunTime(time) + "_" + view + ".png");
      }
    }
    return names;
  }

  // Returns the number of products that the last run drew, from its output lines.
  int Drawn() const {
    const std::string out = Contents(out_);
    int count = 0;
    for (std::size_t at = out.find(" ms)"); at != std::string::npos;
         at = out.find(" ms)", at + 1)) {
      ++count;
    }
    return count;
  }

  const TemporaryFolder folder_;
  const std::string storms_ = folder_.File("storms");
  const std::string west_ = folder_.File("west.json");
  const std::string above_ = folder_.File("above.json");
  const std::string out_ = folder_.File("stdout");
  const std::string err_ = folder_.File("stderr");
};

TEST_F(SequenceCommand, DrawsEveryTimeAndViewOnceAndOnlyWhatChangedAgain) {
  ASSERT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2 * kTimes) << Contents(out_);
  ExpectFinished(folder_.File("out"), Products());
  const auto entries = EntriesOf(folder_.File("out/manifest.jsonl"));
  const pipeline::ManifestEntry& entry = entries.at(Products()[2]);
  EXPECT_EQ(entry.valid, "2013-05-20T20:10:00Z");
  EXPECT_EQ(entry.run, "2013-05-20T12:00:00Z");
  EXPECT_EQ(entry.lead_s, 8.0 * 3600 + 600);
  EXPECT_EQ(entry.input.path, RunFile(storms_, 1));
  EXPECT_EQ(entry.input.sha256, *pipeline::Sha256OfFile(RunFile(storms_, 1)));
  EXPECT_EQ(entry.device, "software");

  ASSERT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 0) << Contents(out_);
  // A file that was copied again with the same bytes results in the same pictures, so nothing is
  // drawn.
  fs::last_write_time(RunFile(storms_, 0), fs::file_time_type::clock::now());
  ASSERT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 0) << Contents(out_);
  WriteRunFile(storms_, 0, 2.0);
  ASSERT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 2) << Contents(out_);
  std::ofstream(above_) << R"({"camera": {"topDown": {}}, "sky": {"turbidity": 3}})";
  fs::remove(folder_.File("out/" + Products()[0]));
  // One byte of a picture is changed. Only its hash reveals the change.
  std::string changed = Contents(folder_.File("out/" + Products()[2]));
  changed.back() ^= 1;
  std::ofstream(folder_.File("out/" + Products()[2]), std::ios::binary) << changed;
  ASSERT_EQ(Run(Arguments("out", {"--done"})).code, 0);
  EXPECT_EQ(Drawn(), kTimes + 2) << Contents(out_);
  const std::string check =
      "cd " + folder_.File("out") + " && sha256sum --quiet -c *.done > " + out_ + " 2>&1";
  EXPECT_EQ(std::system(check.c_str()), 0) << Contents(out_);
  for (const std::string& product : Products()) {
    EXPECT_TRUE(fs::remove(folder_.File("out/" + product + ".done"))) << product;
  }
  ExpectFinished(folder_.File("out"), Products());
}

// The files that a run leaves in addition to its pictures.
struct Extras {
  std::vector<std::string> flags;
  std::vector<std::string> products;  // products with a line in the manifest
  bool done = false;                  // true if each product also has a marker file
};

TEST_F(SequenceCommand, KilledAtAnyMomentLosesNothingAndDoublesNothing) {
  const char* wanted = std::getenv("THUNDERHEAD_KILLS");
  const int kills = wanted == nullptr ? 50 : std::atoi(wanted);
  // World files belong to maps, so both views are from above.
  std::ofstream(west_) << R"({"camera": {"topDown": {}}, "sky": {"turbidity": 3}})";
  const std::string movie = "film.webm";
  std::vector<std::string> maps;
  for (const std::string& product : Products()) {
    maps.push_back(fs::path(product).replace_extension(".pgw").string());
  }
  const Extras with_movie{{"--done"}, {movie}, true};
  const Extras with_maps{{"--world-file"}, maps, false};
  std::mt19937 random(7);
  // Duration of a whole run, by kind: true with a movie, false with maps.
  std::map<bool, milliseconds> whole;
  int killed = 0;
  for (int round = 0; killed < kills; ++round) {
    const std::string out = "out" + std::to_string(round);
    const Extras& extras = round % 2 == 0 ? with_movie : with_maps;
    std::vector<std::string> flags = extras.flags;
    if (extras.done) flags.insert(flags.end(), {"--movie", folder_.File(out) + "/" + movie});
    const std::vector<std::string> arguments = Arguments(out, flags);
    // The kill comes at a random moment of a whole run. The first run of each kind is left to
    // finish, to measure how long it takes.
    if (!whole.contains(extras.done)) {
      const auto begun = std::chrono::steady_clock::now();
      ASSERT_EQ(Run(arguments).code, 0) << Contents(err_);
      whole[extras.done] =
          std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begun);
      fs::remove_all(folder_.File(out));
    }
    std::uniform_int_distribution<std::int64_t> moment(0, whole[extras.done].count());
    std::string recorded;
    for (bool ended = false; !ended && killed < kills;) {
      RunningProgram program(PROGRAM, arguments, out_, err_);
      std::this_thread::sleep_for(milliseconds(moment(random)));
      program.Signal(SIGKILL);
      const Ending ending = program.Wait();
      ended = ending.signal == 0;
      if (!ended) ++killed;
      ExpectWholePictures(folder_.File(out));
      // Recorded entries are unchanged: nothing is drawn again, and nothing is lost.
      const std::string now = Contents(folder_.File(out + "/manifest.jsonl"));
      EXPECT_THAT(now, StartsWith(recorded));
      recorded = now.substr(0, now.rfind('\n') + 1);
    }
    EXPECT_EQ(Run(arguments).code, 0) << Contents(err_);
    EXPECT_THAT(Contents(folder_.File(out + "/manifest.jsonl")), StartsWith(recorded));
    std::vector<std::string> products = Products();
    products.insert(products.end(), extras.products.begin(), extras.products.end());
    std::vector<std::string> markers;
    if (extras.done) {
      for (const std::string& product : products) markers.push_back(product + ".done");
    }
    ExpectFinished(folder_.File(out), products, markers);
    if (extras.done) {
      const std::string check =
          "cd " + folder_.File(out) + " && sha256sum --quiet -c *.done > " + out_ + " 2>&1";
      EXPECT_EQ(std::system(check.c_str()), 0) << Contents(out_);
    }
  }
}

TEST_F(SequenceCommand, ASignalEndsItWithTryAgain) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  // Holds the second product before it is written, so that the run cannot end before the signal
  // arrives.
  const std::string held = HoldProduct(1);
  const auto program = StartWithHangingStorage(Arguments("out", {"--jobs", "1"}), err_);
  WaitFor([&] { return Drawn() > 0 || !program->Runs(); });
  program->Signal(SIGTERM);
  EXPECT_TRUE(WaitFor([&] { return program->IsInterrupted() || !program->Runs(); }));
  HangNoLonger(held);
  EXPECT_EQ(program->Wait().code, 75);
  EXPECT_THAT(Contents(err_), ContainsRegex("thunderhead: interrupted: [1-5] of 6 pictures"));
  const auto before = EntriesOf(folder_.File("out/manifest.jsonl"));
  EXPECT_GE(before.size(), 1U);
  EXPECT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 2 * kTimes - static_cast<int>(before.size()));
  ExpectFinished(folder_.File("out"), Products());
}

// The write of a product hangs, as on a file system that hangs. On a terminal the program shows a
// progress bar. After the first signal it waits for the write, and after a second signal it ends at
// once.
TEST_F(SequenceCommand, ASecondSignalEndsWhatHangsAndATerminalShowsABar) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const std::string stuck = HoldProduct(0);
  Terminal terminal;
  const auto program = StartWithHangingStorage(Arguments("out"), terminal.Name());
  WaitFor([&] { return terminal.Shown().find("5 of 6") != std::string::npos || !program->Runs(); });
  EXPECT_THAT(terminal.Shown(), ContainsRegex("drawing \\[#+\\.+\\]  83 %  5 of 6"));
  EXPECT_EQ(Contents(out_), "") << "lines beside the bar";
  program->Signal(SIGTERM);
  EXPECT_TRUE(WaitFor([&] { return program->IsInterrupted() || !program->Runs(); }));
  EXPECT_TRUE(program->Runs()) << "it hangs, but did not wait";
  program->Signal(SIGTERM);
  EXPECT_EQ(program->Wait().signal, SIGTERM);
  HangNoLonger(stuck);
  EXPECT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 1);
  ExpectFinished(folder_.File("out"), Products());
}

// Another user of the folder could otherwise make the program wait for a reader for ever.
TEST_F(SequenceCommand, FifosInPlaceOfPartialFilesAreReplaced) {
  fs::create_directories(folder_.File("out"));
  const std::string first = folder_.File("out/" + Products()[0]);
  const std::string second = folder_.File("out/" + Products()[1]);
  for (const std::string& planted : {first + ".partial", second + ".done.partial"}) {
    ASSERT_EQ(mkfifo(planted.c_str(), 0600), 0);
  }
  RunningProgram program(PROGRAM, Arguments("out", {"--done"}), out_, err_);
  if (!WaitFor([&] { return !program.Runs(); })) program.Signal(SIGKILL);
  EXPECT_EQ(program.Wait().code, 0) << Contents(err_);
  std::vector<std::string> markers;
  for (const std::string& product : Products()) markers.push_back(product + ".done");
  ExpectFinished(folder_.File("out"), Products(), markers);
}

TEST_F(SequenceCommand, SharesTogetherMakeAllAndThenTheMovie) {
  std::vector<std::unique_ptr<RunningProgram>> shares;
  for (const char* shard : {"0/2", "1/2"}) {
    shares.push_back(std::make_unique<RunningProgram>(PROGRAM, Arguments("out", {"--shard", shard}),
                                                      out_, err_));
  }
  for (const auto& share : shares) EXPECT_EQ(share->Wait().code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2 * kTimes);
  const auto first = EntriesOf(folder_.File("out/manifest.0-of-2.jsonl"));
  const auto second = EntriesOf(folder_.File("out/manifest.1-of-2.jsonl"));
  EXPECT_EQ(first.size(), 4U);
  EXPECT_EQ(second.size(), 2U);
  const std::string movie = folder_.File("out/{storm}.webm");
  EXPECT_EQ(Run(Arguments("out", {"--shard", "0/2", "--movie", movie})).code, 64);
  ASSERT_EQ(Run(Arguments("out", {"--movie", movie})).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 1) << "the movie alone: " << Contents(out_);
  EXPECT_GT(fs::file_size(folder_.File("out/storms.webm")), 500U);
  ASSERT_EQ(Run(Arguments("out", {"--movie", movie})).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 0) << Contents(out_);
  // One manifest now contains all lines, including the lines that the shares (parallel programs)
  // had written.
  std::vector<std::string> all = Products();
  all.push_back("storms.webm");
  ExpectFinished(folder_.File("out"), all);
  // Shares of a changed scene remove the manifest lines of products that they draw again. Every
  // remaining line stays valid.
  std::ofstream(above_) << R"({"camera": {"topDown": {}}, "sky": {"turbidity": 3}})";
  ASSERT_EQ(Run(Arguments("out", {"--shard", "0/2"})).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2) << Contents(out_);
  std::map<std::string, std::string> sums;
  for (const char* manifest : {"manifest.jsonl", "manifest.0-of-2.jsonl"}) {
    for (const auto& [file, line] : EntriesOf(folder_.File("out/" + std::string(manifest)))) {
      EXPECT_TRUE(sums.emplace(file, line.sha256).second) << file << " has two lines";
      EXPECT_EQ(line.sha256, *pipeline::Sha256OfFile(folder_.File("out/" + file))) << file;
    }
  }
  EXPECT_EQ(sums.size(), all.size());
}

TEST_F(SequenceCommand, TwoAtOnceDoNotMix) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  // Holds the first run for as long as the second needs to start.
  const std::string stuck = HoldProduct(0);
  const auto first = StartWithHangingStorage(Arguments("out"), err_);
  WaitFor([&] { return fs::exists(folder_.File("out/manifest.jsonl")) || !first->Runs(); });
  const std::string other = folder_.File("other");
  RunningProgram second(PROGRAM, Arguments("out"), other, other);
  EXPECT_EQ(second.Wait().code, 75);
  EXPECT_THAT(Contents(other), HasSubstr("another thunderhead is writing this manifest"));
  first->Signal(SIGKILL);
  first->Wait();
  HangNoLonger(stuck);
  EXPECT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  ExpectFinished(folder_.File("out"), Products());
}

TEST_F(SequenceCommand, WhatIsWrongIsToldByItsExitCodeBeforeAnythingIsDrawn) {
  const auto expect = [&](int code, const std::vector<std::string>& arguments,
                          const std::string& text) {
    EXPECT_EQ(Run(arguments).code, code) << text;
    EXPECT_THAT(Contents(err_), HasSubstr(text));
    EXPECT_FALSE(fs::exists(folder_.File("out")) && !fs::is_empty(folder_.File("out"))) << text;
  };
  const auto with = [&](std::size_t at, const std::string& text) {
    std::vector<std::string> arguments = Arguments("out");
    arguments[at] = text;
    return arguments;
  };
  expect(64, with(3, folder_.File("out/{valid:%Y}_{view}.png")), "two products would both be");
  expect(64, with(3, folder_.File("out/{valid:%Y%m%d%H%M}.png")), "add {view}");
  expect(64, with(3, folder_.File("out/{storm}.gif")), "must end in .png");
  expect(64, with(5, folder_.File("none.json")), "none.json cannot be read");
  expect(64, Arguments("out", {"--times", "7"}), "--times is '7'");
  expect(64, Arguments("out", {"--shard", "2/2"}), "--shard is '2/2'");
  expect(64, Arguments("out", {"--jobs", "0"}), "--jobs");
  expect(64, Arguments("out", {"--movie", "x.gif"}), "must end in .webm");
  expect(75, with(1, folder_.File("none")), "none");
  std::ofstream(folder_.File("text.nc")) << "no storm";
  expect(65, with(1, folder_.File("text.nc")), "text.nc");
  expect(78, with(3, out_ + "/{valid:%H%M}_{view}.png"), "cannot be created");
  EXPECT_EQ(Run(Arguments("film", {"--movie", out_ + "/{storm}.webm"})).code, 78);
  EXPECT_THAT(Contents(err_), HasSubstr("cannot be created"));
  std::vector<std::string> device = Arguments("out");
  device.back() = "99";
  EXPECT_EQ(Run(device).code, 78);
  EXPECT_THAT(Contents(err_), HasSubstr("device 99"));
}

TEST_F(SequenceCommand, OneBadFileLeavesTheOthersAlone) {
  // The file's description is valid, but its fields are not.
  WriteRunFile(storms_, 2, 1.0, true);
  KeepFresh(RunFile(storms_, 2));
  EXPECT_EQ(Run(Arguments("out", {"--times", "2"})).code, 75) << "just written: " << Contents(err_);
  LeaveAlone(RunFile(storms_, 2));
  const std::vector<std::string> arguments =
      Arguments("out", {"--movie", folder_.File("out/films/{storm}.webm"), "--progress", "json"});
  EXPECT_EQ(Run(arguments).code, 65) << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("2 of 6 pictures could not be made"));
  EXPECT_EQ(EntriesOf(folder_.File("out/manifest.jsonl")).size(), 5U) << "four and their movie";
  EXPECT_THAT(Contents(out_),
              ContainsRegex("\"event\":\"failed\",\"file\":\"[^\"]*_2020_west.png\","
                            "\"message\":\"[^\"]*holds nothing but fill values"));
  const std::string short_movie = Contents(folder_.File("out/films/storms.webm"));
  EXPECT_GT(short_movie.size(), 500U);
  WriteRunFile(storms_, 2);
  EXPECT_EQ(Run(arguments).code, 0) << Contents(err_);
  EXPECT_NE(Contents(folder_.File("out/films/storms.webm")), short_movie);
  EXPECT_EQ(EntriesOf(folder_.File("out/manifest.jsonl")).size(), 7U);
}

TEST_F(SequenceCommand, AFileThatIsCutShortIsNamedAndLeavesTheOthersAlone) {
  const std::string cut = RunFile(storms_, 1);
  const std::string whole = Contents(cut);
  std::ofstream(cut, std::ios::binary) << whole.substr(0, whole.size() / 2);
  // The folder also contains files that are not storms, as model folders do.
  std::ofstream(storms_ + "/README") << "no storm";
  // The truncated file counts as still being written until it has been unchanged for a while. This
  // holds whether it is read alone or in its folder.
  KeepFresh(cut);
  EXPECT_EQ(RunningProgram(PROGRAM, {"inspect", cut}, out_, err_).Wait().code, 75);
  KeepFresh(cut);
  EXPECT_EQ(Run(Arguments("out")).code, 75);
  EXPECT_EQ(Drawn(), 2 * (kTimes - 1)) << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr(cut));
  EXPECT_THAT(Contents(err_), HasSubstr("1 of the storms' files could not be read"));
  LeaveAlone(cut);
  EXPECT_EQ(RunningProgram(PROGRAM, {"inspect", cut}, out_, err_).Wait().code, 65);
  std::vector<std::string> alone = Arguments("alone");
  alone[1] = cut;
  EXPECT_EQ(Run(alone).code, 65) << Contents(err_);
  EXPECT_EQ(Run(Arguments("out")).code, 65) << Contents(err_);
  // Which time is the last, and which has the number 1, depends on the missing file.
  EXPECT_EQ(Run(Arguments("out", {"--times", "last"})).code, 65);
  EXPECT_THAT(Contents(err_), HasSubstr("Nothing is drawn, because --times is known only"));
  std::vector<std::string> numbered = Arguments("numbered");
  numbered[3] = folder_.File("numbered/{time}_{view}.png");
  EXPECT_EQ(Run(numbered).code, 65);
  EXPECT_THAT(Contents(err_), HasSubstr("{time} is known only when all files can be read"));
  EXPECT_FALSE(fs::exists(folder_.File("numbered")));
}

// The shares list the folder before and after a file is complete. Each time must still be in
// exactly one share.
TEST_F(SequenceCommand, SharesThatSeeDifferentFilesLeaveNoTimeOut) {
  const std::string first = RunFile(storms_, 0);
  const std::string whole = Contents(first);
  std::ofstream(first, std::ios::binary) << whole.substr(0, whole.size() / 2);
  KeepFresh(first);
  EXPECT_EQ(Run(Arguments("out", {"--shard", "0/2"})).code, 75) << Contents(err_);
  EXPECT_EQ(Drawn(), 2) << "of the third file: " << Contents(out_);
  std::ofstream(first, std::ios::binary) << whole;
  EXPECT_EQ(Run(Arguments("out", {"--shard", "1/2"})).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2) << "of the second: " << Contents(out_);
  EXPECT_EQ(Run(Arguments("out", {"--shard", "0/2"})).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2) << "of the first: " << Contents(out_);
  for (const std::string& product : Products()) {
    EXPECT_TRUE(fs::exists(folder_.File("out/" + product))) << product;
  }
}

TEST_F(SequenceCommand, AnInputThatChangesWhileItIsReadNeverMakesAPicture) {
  if (!kHasHangingStorage) GTEST_SKIP() << "a sanitizer must be the program's first library";
  const std::string file = RunFile(storms_, 1);
  const std::string next = folder_.File("next");
  const std::string thin = Contents(file);
  WriteRunFile(storms_, 1, 5.0);
  const std::string dense = Contents(file);
  bool is_dense = true;
  // Another file replaces the input whenever the program is about to open it.
  HangAt(file);
  const auto program = StartWithHangingStorage(Arguments("out"), err_);
  while (WaitFor([&] { return Hangs(file) || !program->Runs(); }) && program->Runs()) {
    is_dense = !is_dense;
    std::ofstream(next, std::ios::binary) << (is_dense ? dense : thin);
    fs::rename(next, file);
    Release(file);
  }
  HangNoLonger(file);
  EXPECT_EQ(program->Wait().code, 75) << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("changed while it was drawn; try again"));
  for (const auto& [name, entry] : EntriesOf(folder_.File("out/manifest.jsonl"))) {
    EXPECT_NE(entry.input.path, file) << name;
  }
  EXPECT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  const auto entries = EntriesOf(folder_.File("out/manifest.jsonl"));
  EXPECT_EQ(entries.at(Products()[2]).input.sha256, *pipeline::Sha256OfFile(file));
  ExpectFinished(folder_.File("out"), Products());
}

TEST_F(SequenceCommand, AFullDiskIsWorthAnotherTry) {
  std::string command = "(ulimit -f 0; exec " + std::string(PROGRAM);
  for (const std::string& argument : Arguments("out")) command += " '" + argument + "'";
  const std::string err = folder_.File("pipe");
  // Standard error goes through a pipe, because the file size limit would also apply to it in a
  // file.
  ASSERT_EQ(
      std::system(("(" + command + ") 2>&1 >/dev/null; echo code $?) | cat > " + err).c_str()), 0);
  EXPECT_THAT(Contents(err), HasSubstr("code 75"));
  EXPECT_THAT(Contents(err), HasSubstr("cannot be written"));
  EXPECT_FALSE(fs::exists(folder_.File("out/" + Products()[0])));
  for (const auto& file : fs::directory_iterator(folder_.File("out"))) {
    EXPECT_EQ(file.path().filename(), "manifest.jsonl");
  }
  EXPECT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  ExpectFinished(folder_.File("out"), Products());
}

}  // namespace
}  // namespace thunderhead::testing
