// `thunderhead sequence` as a suite runs it: whole products, each once, whenever it is killed.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pipeline/sha256.h"
#include "tests/service/product_folder.h"
#include "tests/service/running_program.h"
#include "tests/service/synthetic_run.h"
#include "tests/support/temporary_folder.h"

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

  // Into the folder `out`.
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

  static std::vector<std::string> Products() {
    std::vector<std::string> names;
    for (int time = 0; time < kTimes; ++time) {
      for (const char* view : {"west", "above"}) {
        names.push_back("storms_" + RunTime(time) + "_" + view + ".png");
      }
    }
    return names;
  }

  // Lines of products drawn by the last run.
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
  // The same bytes, copied again, make the same pictures.
  fs::last_write_time(RunFile(storms_, 0), fs::file_time_type::clock::now());
  ASSERT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 0) << Contents(out_);
  WriteRunFile(storms_, 0, 2.0);
  ASSERT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 2) << Contents(out_);
  std::ofstream(above_) << R"({"camera": {"topDown": {}}, "sky": {"turbidity": 3}})";
  fs::remove(folder_.File("out/" + Products()[0]));
  // One byte of a picture is another: only its hash tells.
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

TEST_F(SequenceCommand, KilledAtAnyMomentLosesNothingAndDoublesNothing) {
  const char* wanted = std::getenv("THUNDERHEAD_KILLS");
  const int kills = wanted == nullptr ? 12 : std::atoi(wanted);
  const auto begun = std::chrono::steady_clock::now();
  ASSERT_EQ(Run(Arguments("measured")).code, 0) << Contents(err_);
  const auto whole =
      std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begun);
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int64_t> moment(0, whole.count());
  int killed = 0;
  for (int round = 0; killed < kills; ++round) {
    const std::string out = "out" + std::to_string(round);
    std::string recorded;
    for (bool ended = false; !ended && killed < kills;) {
      RunningProgram program(PROGRAM, Arguments(out), out_, err_);
      std::this_thread::sleep_for(milliseconds(moment(random)));
      program.Signal(SIGKILL);
      const Ending ending = program.Wait();
      ended = ending.signal == 0;
      if (!ended) ++killed;
      ExpectWholePictures(folder_.File(out));
      // What was recorded stays as it was: nothing is drawn again, nothing is lost.
      const std::string now = Contents(folder_.File(out + "/manifest.jsonl"));
      EXPECT_THAT(now, StartsWith(recorded));
      recorded = now.substr(0, now.rfind('\n') + 1);
    }
    EXPECT_EQ(Run(Arguments(out)).code, 0) << Contents(err_);
    EXPECT_THAT(Contents(folder_.File(out + "/manifest.jsonl")), StartsWith(recorded));
    ExpectFinished(folder_.File(out), Products());
  }
}

TEST_F(SequenceCommand, ASignalEndsItWithTryAgain) {
  RunningProgram program(PROGRAM, Arguments("out"), out_, err_);
  while (program.Runs() && Contents(out_).empty()) std::this_thread::sleep_for(milliseconds(5));
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait().code, 75);
  EXPECT_THAT(Contents(err_), ContainsRegex("thunderhead: interrupted: [1-5] of 6 pictures"));
  const auto before = EntriesOf(folder_.File("out/manifest.jsonl"));
  EXPECT_GE(before.size(), 1U);
  EXPECT_EQ(Run(Arguments("out")).code, 0);
  EXPECT_EQ(Drawn(), 2 * kTimes - static_cast<int>(before.size()));
  ExpectFinished(folder_.File("out"), Products());
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
}

TEST_F(SequenceCommand, TwoAtOnceDoNotMix) {
  RunningProgram first(PROGRAM, Arguments("out"), out_, err_);
  while (first.Runs() && !fs::exists(folder_.File("out/manifest.jsonl"))) {
    std::this_thread::sleep_for(milliseconds(1));
  }
  const std::string other = folder_.File("other");
  RunningProgram second(PROGRAM, Arguments("out"), other, other);
  EXPECT_EQ(second.Wait().code, 75);
  EXPECT_THAT(Contents(other), HasSubstr("another thunderhead is writing this manifest"));
  EXPECT_EQ(first.Wait().code, 0) << Contents(err_);
  ExpectFinished(folder_.File("out"), Products());
}

TEST_F(SequenceCommand, WhatIsWrongIsToldByItsExitCodeBeforeAnythingIsDrawn) {
  const auto expect = [&](int code, std::vector<std::string> arguments, const std::string& text) {
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
  std::vector<std::string> device = Arguments("out");
  device.back() = "99";
  EXPECT_EQ(Run(device).code, 78);
  EXPECT_THAT(Contents(err_), HasSubstr("device 99"));
}

TEST_F(SequenceCommand, OneBadFileLeavesTheOthersAlone) {
  // Its description is sound; its fields are not.
  WriteRunFile(storms_, 2, 1.0, true);
  const int code = Run(Arguments("out")).code;
  EXPECT_EQ(code, 65) << Contents(err_);
  EXPECT_EQ(Drawn(), 2 * (kTimes - 1));
  EXPECT_THAT(Contents(err_), HasSubstr("2 of 6 pictures could not be made"));
  WriteRunFile(storms_, 2);
  EXPECT_EQ(Run(Arguments("out")).code, 0) << Contents(err_);
  EXPECT_EQ(Drawn(), 2);
  ExpectFinished(folder_.File("out"), Products());
}

TEST_F(SequenceCommand, AnInputThatChangesWhileItIsReadNeverMakesAPicture) {
  const std::string file = RunFile(storms_, 1);
  const std::string next = folder_.File("next");
  const std::string thin = Contents(file);
  WriteRunFile(storms_, 1, 5.0);
  const std::string dense = Contents(file);
  bool is_dense = true;
  RunningProgram program(PROGRAM, Arguments("out"), out_, err_);
  while (program.Runs()) {
    is_dense = !is_dense;
    std::ofstream(next, std::ios::binary) << (is_dense ? dense : thin);
    fs::rename(next, file);
    std::this_thread::sleep_for(milliseconds(3));
  }
  EXPECT_EQ(program.Wait().code, 75) << Contents(err_);
  EXPECT_THAT(Contents(err_), HasSubstr("was written to while it was drawn; try again"));
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
  // Through a pipe, as the limit counts for standard error in a file as well.
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
