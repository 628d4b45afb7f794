// Tests of files that are read by a confined process. The results must equal those of a read in the
// program itself. Whatever a malicious file does to the reader process, the result must be a single
// error within the limits, and other files must still be read.
#include "sandbox/confined_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <stop_token>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/stopwatch.h"
#include "base/utf8.h"
#include "sandbox/child.h"
#include "sandbox/messages.h"
#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"
#include "telemetry/metrics.h"
#include "tests/support/figure.h"
#include "tests/support/manual_time.h"
#include "tests/support/synthetic_cf.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_for.h"
#include "tests/unit/sandbox/misbehaving_format.h"
#include "volume/map_projection.h"

namespace thunderhead::sandbox {
namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr bool kNewEndsTheProgram = true;
#else
constexpr bool kNewEndsTheProgram = false;
#endif
constexpr const char* kWhyNot =
    "AddressSanitizer's operator new ends the program where others throw std::bad_alloc";

using std::chrono::milliseconds;
using storm_files::StormFile;
using ::testing::HasSubstr;
using testing::ManualTime;
using ::testing::Not;
using testing::WaitFor;
using volume::HydrometeorFields;

constexpr std::uint64_t kMemory = std::uint64_t{256} << 20;

// An archive that writes the transmitted data into a string, to compare values byte by byte.
class Bytes {
 public:
  template <Plain Value>
  void operator()(const Value& value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void operator()(const std::string& text) { text_ += text + '\0'; }
  template <Plain Value>
  void operator()(const std::vector<Value>& values) {
    text_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
  }
  const std::string& Text() const { return text_; }

 private:
  std::string text_;
};

std::string BytesOf(const HydrometeorFields& fields) {
  HydrometeorFields copy = fields;
  Bytes bytes;
  Visit(bytes, copy);
  return bytes.Text();
}

// A fixture in which time stands still for readers, unless a test advances it.
class ConfinedFilesTest : public ::testing::Test {
 protected:
  // This is also the limit of processor time for a reader, which the kernel counts.
  static constexpr milliseconds kTime{60'000};

  std::shared_ptr<ConfinedFiles> Files(std::uint64_t memory = kMemory, milliseconds time = kTime) {
    ConfinedOptions options;
    options.limits = {.memory_bytes = memory,
                      .time = time,
                      .memory_flag = "--sandbox-memory",
                      .time_flag = "--sandbox-seconds"};
    options.time = &time_;
    options.program = "/proc/self/exe";
    return std::make_shared<ConfinedFiles>(options);
  }

  // Waits for the future while time passes.
  template <typename Value>
  Value GetInTime(std::future<Value> future) {
    EXPECT_TRUE(WaitFor([&] {
      time_.Advance(milliseconds(100));
      return future.wait_for(milliseconds(0)) == std::future_status::ready;
    }));
    return future.get();
  }
  absl::StatusOr<StormFile> DescribeInTime(ConfinedFiles& files, const std::string& path) {
    return GetInTime(std::async(std::launch::async, [&] { return files.Describe(path); }));
  }

  std::string Bad(const std::string& name) {
    const std::string path = folder_.File(name + ".bad");
    std::ofstream(path) << "CDF, but no netCDF";
    return path;
  }

  std::uint64_t Failures(const char* reason) {
    return telemetry::Counted().reader_failures.Of(reason).Value();
  }

  ManualTime time_;
  testing::TemporaryFolder folder_;
};

testing::SyntheticWrf Storm() {
  testing::SyntheticWrf file;
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00"};
  file.mixing_ratios["QCLOUD"] = [](const testing::WrfCell& cell) { return 1e-4 * cell.level; };
  file.mixing_ratios["QSNOW"] = [](const testing::WrfCell& cell) { return 1e-5 * cell.x; };
  file.mixing_ratios["QNSNOW"] = [](const testing::WrfCell&) { return 1e4; };
  file.units["QNSNOW"] = "kg-1";
  file.land_use_table = "USGS";
  file.columns["LU_INDEX"] = [](const testing::WrfCell& cell) { return 1.0 + cell.x; };
  return file;
}

// Expects that the program itself and a confined reader return the same storm, for every record
// (time) of the file.
void ExpectSameStorm(ConfinedFiles& files, const std::string& path) {
  const auto own = storm_files::StormFormats::BuiltIn().Describe(path);
  const auto confined = files.Describe(path);
  ASSERT_TRUE(own.ok()) << own.status();
  ASSERT_TRUE(confined.ok()) << confined.status();
  EXPECT_EQ(confined->cells, own->cells);
  EXPECT_EQ(confined->times, own->times);
  EXPECT_EQ(confined->fields, own->fields);
  EXPECT_EQ(confined->about, own->about);
  EXPECT_EQ(confined->run, own->run);
  EXPECT_EQ(confined->domain, own->domain);
  EXPECT_EQ(confined->latitude_deg, own->latitude_deg);
  EXPECT_EQ(confined->longitude_deg, own->longitude_deg);
  EXPECT_EQ(confined->dx_m, own->dx_m);
  for (std::size_t record = 0; record < own->times.size(); ++record) {
    const auto grid = own->reader->ReadVerticalGrid(0);
    const auto confined_grid = confined->reader->ReadVerticalGrid(0);
    ASSERT_TRUE(grid.ok() && confined_grid.ok()) << confined_grid.status();
    EXPECT_EQ(confined_grid->low_m, grid->low_m);
    EXPECT_EQ(confined_grid->spacing_m, grid->spacing_m);
    EXPECT_EQ(confined_grid->cells, grid->cells);
    const auto expected = own->reader->Read(record, *grid, {});
    std::vector<double> shares;
    const auto fields = confined->reader->Read(record, *grid, [&shares](double share) {
      shares.push_back(share);
      return absl::OkStatus();
    });
    ASSERT_TRUE(expected.ok()) << expected.status();
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_TRUE(BytesOf(*fields) == BytesOf(*expected)) << path << " record " << record;
    EXPECT_GT(shares.size(), 1U);
    storm_files::RecordPart part = record;
    part.window = storm_files::ColumnWindow{{1, 0}, glm::ivec2(own->cells) - 1};
    part.stride = 2;
    const auto expected_part = own->reader->Read(part, *grid, {});
    const auto read_part = confined->reader->Read(part, *grid, {});
    ASSERT_TRUE(expected_part.ok() && read_part.ok()) << read_part.status();
    EXPECT_TRUE(BytesOf(*read_part) == BytesOf(*expected_part)) << path << " record " << record;
  }
}

TEST_F(ConfinedFilesTest, AreReadAsByTheProgramItself) {
  const auto files = Files(std::uint64_t{1} << 30);
  for (const auto format : {testing::WrfFormat::kNetcdf4, testing::WrfFormat::kClassic,
                            testing::WrfFormat::kOffset64, testing::WrfFormat::kCdf5}) {
    testing::SyntheticWrf storm = Storm();
    storm.format = format;
    const std::string path = folder_.File("wrfout_d01");
    testing::WriteWrf(storm, path);
    ExpectSameStorm(*files, path);
  }
  const std::string cf = folder_.File("cf.nc");
  testing::WriteCf(testing::ExtinctionFile(5, 4, 3, 100.0, 100.0, 50.0,
                                           [](auto x, auto y, auto z) {
                                             return 1e-3 * static_cast<double>(x + 2 * y + 3 * z);
                                           }),
                   cf);
  ExpectSameStorm(*files, cf);
  ExpectSameStorm(*files, THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc");
}

// ExpectSameStorm compares what the archive writes of both storms, so it does not notice a member
// that the archive omits.
TEST_F(ConfinedFilesTest, TheWindComesThrough) {
  // The limit is what the fields need under ASan, which keeps freed memory for a while.
  const auto files = Files(std::uint64_t{2} << 30);
  const auto file = files->Describe(THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc");
  ASSERT_TRUE(file.ok()) << file.status();
  const auto grid = file->reader->ReadVerticalGrid(0);
  ASSERT_TRUE(grid.ok()) << grid.status();
  const auto fields = file->reader->Read(1, *grid, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(fields->motion.steering_m_per_s.x, 4.8, 0.1);
  EXPECT_EQ(fields->motion.time_s, 958858200.0);
}

// Measures the cost of confinement, compared with reading the same file in the process; for
// docs/reliability.md.
TEST(ConfinedFilesBenchmark, Cost) {
  const std::string path = THUNDERHEAD_SOURCE_DIR "/samples/supercell-500m.nc";
  const auto files = std::make_shared<ConfinedFiles>();
  const auto own = storm_files::StormFormats::BuiltIn().Describe(path);
  const auto confined = files->Describe(path);
  ASSERT_TRUE(own.ok() && confined.ok());
  const auto milliseconds_of = [](const auto& work) {
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
      const base::Stopwatch stopwatch;
      work();
      best = std::min(best, stopwatch.ElapsedMs());
    }
    return best;
  };
  const double own_describe = milliseconds_of(
      [&] { EXPECT_TRUE(storm_files::StormFormats::BuiltIn().Describe(path).ok()); });
  const double describe = milliseconds_of([&] { EXPECT_TRUE(files->Describe(path).ok()); });
  const double own_read =
      milliseconds_of([&] { EXPECT_TRUE(own->reader->Read(0, std::nullopt, {}).ok()); });
  const double read =
      milliseconds_of([&] { EXPECT_TRUE(confined->reader->Read(0, std::nullopt, {}).ok()); });
  testing::Figure("describing a storm file", own_describe, "ms");
  testing::Figure("describing a storm file, confined", describe, "ms");
  testing::Figure("reading a time of a storm", own_read, "ms");
  testing::Figure("reading a time of a storm, confined", read, "ms");
}

TEST_F(ConfinedFilesTest, AReaderThatCrashesIsOneError) {
  const std::uint64_t before = Failures("crashed");
  const auto files = Files();
  const absl::Status crash = files->Describe(Bad("crash")).status();
  EXPECT_EQ(crash.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(crash.message()), HasSubstr("crash.bad: its reader crashed (signal 11"));
  EXPECT_THAT(std::string(crash.message()), HasSubstr("damaged or hostile"));
  EXPECT_THAT(std::string(files->Describe(Bad("abort")).status().message()),
              HasSubstr("(signal 6"));
  EXPECT_THAT(std::string(files->Describe(Bad("leave")).status().message()),
              HasSubstr("ended without a result"));
  const auto file = files->Describe(Bad("crash-reading"));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(std::string(file->reader->Read(0, std::nullopt, {}).status().message()),
              HasSubstr("(signal 7"));
  EXPECT_EQ(Failures("crashed"), before + 4);
}

// The kernel kills processes in this way when memory is full. The file is not the cause, so it is
// read again.
TEST_F(ConfinedFilesTest, AReaderThatIsKilledIsTriedAgain) {
  const std::uint64_t before = Failures("killed");
  const auto files = Files();
  const std::string path = Bad("killed");
  for (int i = 1; i <= 2; ++i) {
    const absl::Status status = files->Describe(path).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("memory is full"));
    EXPECT_EQ(Failures("killed"), before + i);
  }
}

// Consecutive requests share one process, which ends when no further request comes.
TEST_F(ConfinedFilesTest, AReaderRestsForAMoment) {
  const std::string path = Bad("named");
  const auto files = Files();
  const auto file = files->Describe(path);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto process = [&] {
    const auto fields = file->reader->Read(0, std::nullopt, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return fields.ok() ? std::stoi(fields->fields[0].variable) : 0;
  };
  const pid_t first = process();
  EXPECT_EQ(process(), first);
  EXPECT_TRUE(file->reader->ReadVerticalGrid(0).ok());
  EXPECT_EQ(process(), first);
  // A process that has ended meanwhile is not an error.
  ASSERT_EQ(kill(first, SIGKILL), 0);
  const pid_t second = process();
  EXPECT_NE(second, first);
  // Another file may have replaced the first.
  std::ofstream(path) << "CDF and something else";
  const pid_t third = process();
  EXPECT_NE(third, second);
  time_.Advance(std::chrono::seconds(2));
  EXPECT_TRUE(WaitFor([&] { return kill(third, 0) != 0; })) << "it is ended and collected";
}

// A process that waits for a storage that does not answer cannot be killed. Children that are not
// killed take the place of such processes here.
TEST_F(ConfinedFilesTest, AtMostEightReadersThatCannotBeKilledAreAbandoned) {
  ASSERT_TRUE(WaitFor([] { return AbandonedChildren() == 0; }));
  const auto files = Files();
  const std::string path = Bad("named");
  std::vector<pid_t> stuck;
  while (stuck.size() < kMaxAbandonedChildren) {
    absl::StatusOr<ChildPlace> place = ChildPlace::Take();
    ASSERT_TRUE(place.ok()) << stuck.size() << ": " << place.status();
    const pid_t process = fork();
    if (process == 0) {
      for (;;) pause();
    }
    ASSERT_GT(process, 0);
    const Child child(process, *std::move(place), base::SteadyTime(), [](pid_t) {});
    stuck.push_back(process);
  }
  EXPECT_EQ(AbandonedChildren(), 8U);
  const absl::Status refused = files->Describe(path).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kUnavailable) << refused;
  EXPECT_EQ(base::DetailsOf(refused).reason, "STORAGE_HANGS");
  EXPECT_THAT(std::string(refused.message()),
              HasSubstr("named.bad: no process can be started to read it, because 8 earlier ones "
                        "cannot be ended; check whether the storage"));
  // When one of them ends, one file can be read at a time.
  kill(stuck.back(), SIGKILL);
  EXPECT_TRUE(WaitFor([] { return AbandonedChildren() == 7; }));
  {
    const absl::StatusOr<ChildPlace> running = ChildPlace::Take();
    EXPECT_TRUE(running.ok()) << running.status();
    EXPECT_FALSE(files->Describe(path).ok());
  }
  EXPECT_TRUE(files->Describe(path).ok());
  for (const pid_t process : stuck) kill(process, SIGKILL);
  EXPECT_TRUE(WaitFor([] { return AbandonedChildren() == 0; }));
}

// A limit on all children would hold up a busy server whose storage answers.
TEST(ChildPlaceTest, RunningChildrenAreNotLimitedWhileNoneIsAbandoned) {
  ASSERT_TRUE(WaitFor([] { return AbandonedChildren() == 0; }));
  std::vector<ChildPlace> places;
  for (std::size_t i = 0; i < 3 * kMaxAbandonedChildren; ++i) {
    absl::StatusOr<ChildPlace> place = ChildPlace::Take();
    ASSERT_TRUE(place.ok()) << place.status();
    places.push_back(*std::move(place));
  }
}

// An attacker may replace a folder by a symbolic link after the path was checked.
TEST_F(ConfinedFilesTest, WhereAnOpenedFileReallyLiesIsChecked) {
  const std::string path = folder_.File("wrfout_d01");
  testing::WriteWrf(Storm(), folder_.File("elsewhere"));
  std::filesystem::create_symlink(folder_.File("elsewhere"), path);
  ConfinedOptions options;
  options.program = "/proc/self/exe";
  std::string place;
  options.check_opened = [&](const std::string& asked, const std::string& lies_at) {
    EXPECT_EQ(asked, path);
    place = lies_at;
    return absl::PermissionDeniedError("not there");
  };
  const auto files = std::make_shared<ConfinedFiles>(options);
  EXPECT_EQ(files->Describe(path).status().code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(place, std::filesystem::canonical(path).string());
}

// A fuzzer found this header: netCDF-C 4.9.0 crashes on it (nc_get_NC, free_NC_vararrayV). A later
// version may refuse it.
TEST_F(ConfinedFilesTest, AFileThatCrashesNetcdfItselfIsOneError) {
  const std::string path = folder_.File("wrfout_d01");
  std::filesystem::copy_file(THUNDERHEAD_SOURCE_DIR "/tests/unit/sandbox/netcdf_header_crash.nc",
                             path);
  const absl::Status status = Files()->Describe(path).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(path));
}

TEST_F(ConfinedFilesTest, AReaderHasATime) {
  const std::uint64_t before = Failures("time");
  for (const char* name : {"hang", "spin"}) {
    const absl::Status status = DescribeInTime(*Files(), Bad(name)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("--sandbox-seconds"));
  }
  EXPECT_EQ(Failures("time"), before + 2);
}

// A search gives a file little time at first, so that a slow file does not delay others. A file
// that needs longer does not count as bad yet.
TEST_F(ConfinedFilesTest, AFileThatNeedsLongerThanItsTrialIsTriedAgain) {
  const std::uint64_t before = Failures("time");
  const auto files = Files();
  const std::string slow = Bad("hang");
  const std::string good = Bad("named");
  const auto describe = [&](const std::vector<std::string>& paths, milliseconds patience) {
    return GetInTime(std::async(std::launch::async,
                                [&, patience] { return files->DescribeEach(paths, patience); }));
  };
  constexpr milliseconds kTrial{2000};
  for (const auto& each : describe({good, slow}, kTrial)) {
    EXPECT_EQ(each.status().code(), absl::StatusCode::kAborted) << each.status();
  }
  EXPECT_EQ(describe({slow}, kTrial)[0].status().code(), absl::StatusCode::kAborted);
  EXPECT_EQ(Failures("time"), before);
  const auto alone = files->DescribeEach({good}, kTrial);
  EXPECT_TRUE(alone[0].ok()) << alone[0].status();
  const auto patient = describe({slow}, storm_files::kLongestDescription);
  EXPECT_EQ(patient[0].status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(Failures("time"), before + 1);
}

// The reader is ended long before its time limit, so that others need not wait for it.
TEST_F(ConfinedFilesTest, AReaderThatIsSilentIsEnded) {
  const std::uint64_t before = Failures("time");
  for (const char* name : {"hang-reading", "spin-reading"}) {
    const auto files = Files(kMemory, std::chrono::hours(100));
    const auto file = files->Describe(Bad(name));
    ASSERT_TRUE(file.ok()) << file.status();
    const auto start = time_.Now();
    const absl::Status status = GetInTime(std::async(
        std::launch::async, [&] { return file->reader->Read(0, std::nullopt, {}).status(); }));
    EXPECT_TRUE(absl::IsDeadlineExceeded(status)) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("it had given no result for 1m"));
    EXPECT_GE(time_.Now() - start, ReaderLimits().silence);
    // The file is not read again.
    EXPECT_EQ(file->reader->Read(0, std::nullopt, {}).status().message(), status.message());
  }
  EXPECT_EQ(Failures("time"), before + 2);
}

TEST_F(ConfinedFilesTest, ARequestToStopEndsTheReader) {
  std::stop_source stop;
  ConfinedOptions options;
  options.limits = {.memory_bytes = kMemory, .time = kTime, .stop = stop.get_token()};
  options.time = &time_;  // stands still, so that no limit of time ends the reader
  options.program = "/proc/self/exe";
  const auto files = std::make_shared<ConfinedFiles>(options);
  const auto file = files->Describe(Bad("hang-reading"));
  ASSERT_TRUE(file.ok()) << file.status();
  auto reading = std::async(std::launch::async,
                            [&] { return file->reader->Read(0, std::nullopt, {}).status(); });
  EXPECT_EQ(reading.wait_for(milliseconds(300)), std::future_status::timeout);
  stop.request_stop();
  ASSERT_EQ(reading.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_EQ(reading.get().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(files->Describe(Bad("sound")).status().code(), absl::StatusCode::kCancelled);
}

TEST_F(ConfinedFilesTest, ALongTextCostsOnlyItsEnd) {
  const std::string path = folder_.File("cloud.nc");
  testing::SyntheticCf storm =
      testing::ExtinctionFile(5, 4, 3, 100.0, 100.0, 50.0, [](auto, auto, auto) { return 1e-3; });
  storm.attributes["source"] = std::string(100'000, 'x');
  testing::WriteCf(storm, path);
  const auto file = Files()->Describe(path);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->about.substr(0, 100), std::string(100, 'x'));
  EXPECT_LE(file->about.size(), base::kMaxTextBytes);
  const auto together = Files()->DescribeEach({path, Bad("wordy")});
  EXPECT_TRUE(together[0].ok()) << together[0].status();
  EXPECT_EQ(together[1].status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(ConfinedFilesTest, AReaderThatSaysNoMoreIsNotWaitedFor) {
  const std::uint64_t before = Failures("crashed");
  // This reader's time limit (100 hours) is longer than the time that passes in the test.
  const auto file = Files(kMemory, std::chrono::hours(100))->Describe(Bad("mute-reading"));
  ASSERT_TRUE(file.ok()) << file.status();
  const absl::Status status = GetInTime(std::async(
      std::launch::async, [&] { return file->reader->Read(0, std::nullopt, {}).status(); }));
  EXPECT_THAT(std::string(status.message()), HasSubstr("ended without a result"));
  EXPECT_EQ(Failures("crashed"), before + 1);
}

// The kernel ends the reader while the server's time stands still. One second of processor time is
// the smallest possible limit.
TEST_F(ConfinedFilesTest, AReaderHasAProcessorTime) {
  const std::uint64_t before = Failures("time");
  const absl::Status status = Files(kMemory, milliseconds(1000))->Describe(Bad("spin")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("--sandbox-seconds"));
  EXPECT_EQ(Failures("time"), before + 1);
}

// The server may make a reader wait, for example when read-ahead yields to other reads. This time
// does not count towards the limit.
TEST_F(ConfinedFilesTest, WhatTheServerWaitsForByItselfDoesNotCount) {
  const auto file = Files()->Describe(Bad("sound"));
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, [this](double) {
    time_.Advance(2 * kTime);
    return absl::OkStatus();
  });
  EXPECT_TRUE(fields.ok()) << fields.status();
}

TEST_F(ConfinedFilesTest, AReaderHasItsMemory) {
  if (kNewEndsTheProgram) GTEST_SKIP() << kWhyNot;
  const absl::Status status = Files()->Describe(Bad("memory")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("256 MiB; --sandbox-memory"));
  EXPECT_TRUE(base::DetailsOf(status).permanent) << "the same file needs as much again";
  EXPECT_FALSE(IsReaderFailure(status));
}

TEST_F(ConfinedFilesTest, AStormLargerThanItsMemoryIsSaidToBe) {
  if (kNewEndsTheProgram) GTEST_SKIP() << kWhyNot;
  testing::SyntheticWrf storm = Storm();
  storm.nx = 200;
  storm.ny = 200;
  storm.levels = 100;
  const std::string path = folder_.File("wrfout_d01");
  testing::WriteWrf(storm, path);
  const auto files = Files(std::uint64_t{64} << 20);
  const auto file = files->Describe(path);
  ASSERT_TRUE(file.ok()) << file.status();
  const absl::Status status = file->reader->Read(0, std::nullopt, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("--sandbox-memory"));
}

TEST_F(ConfinedFilesTest, AReaderMayDoNothingElse) {
  const absl::Status status = Files()->Describe(Bad("everything")).status();
  EXPECT_EQ(std::string(status.message()), "[]");
}

// PROJ opens no file, so a format can convert coordinates in the confined process.
TEST_F(ConfinedFilesTest, AReaderFindsPlacesOnAMap) {
  const auto file = Files()->Describe(Bad("lambert"));
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_TRUE(file->latitude_deg.has_value() && file->longitude_deg.has_value());
  const auto map = volume::MapProjection::Open(file->projection);
  ASSERT_TRUE(map.ok()) << map.status();
  const auto plane_m = map->WorldOf({*file->latitude_deg, *file->longitude_deg});
  ASSERT_TRUE(plane_m.has_value());
  EXPECT_NEAR(plane_m->x, 700'000.0, 0.01);
  EXPECT_NEAR(plane_m->y, 300'000.0, 0.01);
}

// The map projection of a file is untrusted, and PROJ's notation can name files.
TEST_F(ConfinedFilesTest, AMapThatNamesFilesIsNotUsed) {
  auto file = Files()->Describe(Bad("grids"));
  ASSERT_TRUE(file.ok()) << file.status();
  const storm_store::CataloguedStorm storm = storm_store::AssembleStorm("grids", {*file});
  EXPECT_EQ(storm.info.projection, "");
  EXPECT_EQ(storm.info.true_north_deg, 0.0);
  ASSERT_EQ(storm.notes.size(), 1U);
  EXPECT_THAT(storm.notes[0], HasSubstr("without a map"));
  EXPECT_THAT(storm.notes[0], HasSubstr("+nadgrids is not accepted"));
  EXPECT_FALSE(storm_store::ProjectionOf(storm.info, 0).has_value());
}

TEST_F(ConfinedFilesTest, AReaderThatTalksNonsenseIsNotBelieved) {
  const std::uint64_t before = Failures("nonsense");
  for (const char* name : {"noise", "huge", "chatter"}) {
    const absl::Status status = Files()->Describe(Bad(name)).status();
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("its reader sent an invalid value for the "))
        << name;
  }
  EXPECT_EQ(Failures("nonsense"), before + 3);
}

TEST_F(ConfinedFilesTest, FieldsThatOtherRoomsCouldNotBearAreRefused) {
  const auto files = Files();
  const auto read = [&](const std::string& name) {
    const auto file = files->Describe(Bad(name));
    EXPECT_TRUE(file.ok()) << file.status();
    return file.ok() ? file->reader->Read(0, std::nullopt, {}).status() : file.status();
  };
  EXPECT_TRUE(read("sound").ok()) << read("sound");
  for (const char* name :
       {"nan",          "infinite",   "negative",  "short",      "kind",     "quantity",
        "sizes-beyond", "sizes-far",  "sizes-few", "statistics", "terrain",  "terrain-nan",
        "land",         "turbulence", "source",    "shear",      "steering", "time",
        "box",          "columns",    "cells",     "spacing",    "corner"}) {
    const absl::Status status = read(name);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << name << ": " << status;
    EXPECT_THAT(std::string(status.message()),
                HasSubstr("its reader sent an invalid value for the "))
        << name;
  }
  const auto grid = files->Describe(Bad("grid"));
  ASSERT_TRUE(grid.ok());
  EXPECT_FALSE(grid->reader->ReadVerticalGrid(0).ok());
}

TEST_F(ConfinedFilesTest, WhatAFileSaysIsNoControlCharacter) {
  const std::string message(Files()->Describe(Bad("rude")).status().message());
  EXPECT_THAT(message, Not(HasSubstr("\x1b")));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
  EXPECT_THAT(message, HasSubstr("forged"));
}

TEST_F(ConfinedFilesTest, AFileThatFailedItsReaderIsLeftAloneUntilItChanges) {
  const auto files = Files();
  const std::string path = Bad("crash");
  const std::uint64_t before = Failures("crashed");
  const std::string first(files->Describe(path).status().message());
  EXPECT_EQ(std::string(files->Describe(path).status().message()), first);
  EXPECT_EQ(Failures("crashed"), before + 1);
  std::ofstream(path) << "CDF and something else";
  EXPECT_FALSE(files->Describe(path).ok());
  EXPECT_EQ(Failures("crashed"), before + 2);
}

TEST_F(ConfinedFilesTest, AnErrorOfTheFileIsThatOfTheProgramItself) {
  const std::string path = folder_.File("notes.txt");
  for (const std::string& text :
       {std::string("notes on a storm, and not the storm"), std::string("note"), std::string(),
        std::string("CDF\1 notes"), std::string(2000, 'n')}) {
    std::ofstream(path, std::ios::trunc) << text;
    const absl::Status own = storm_files::StormFormats::BuiltIn().Describe(path).status();
    const absl::Status confined = Files()->Describe(path).status();
    EXPECT_EQ(confined.code(), own.code());
    EXPECT_EQ(std::string(confined.message()), std::string(own.message()));
  }
  std::ofstream(path, std::ios::trunc).flush();
  EXPECT_THAT(std::string(Files()->Describe(path).status().message()),
              HasSubstr("notes.txt: is empty (0 bytes); wait for the model to write it"));
  EXPECT_EQ(Files()->Describe(folder_.File("nowhere")).status().code(),
            absl::StatusCode::kNotFound);
  mkfifo(folder_.File("pipe").c_str(), 0600);
  mknod(folder_.File("socket").c_str(), S_IFSOCK | 0600, 0);
  for (const char* const other : {"pipe", "socket"}) {
    const absl::Status refused = Files()->Describe(folder_.File(other)).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(refused.message()), HasSubstr("not a regular file"));
  }
}

TEST_F(ConfinedFilesTest, ReadingStopsWhenNobodyWantsItAnyMore) {
  const auto file = Files()->Describe(Bad("sound"));
  ASSERT_TRUE(file.ok());
  const auto fields = file->reader->Read(
      0, std::nullopt, [](double) { return absl::CancelledError("read-ahead was cancelled"); });
  EXPECT_TRUE(absl::IsCancelled(fields.status())) << fields.status();
}

TEST_F(ConfinedFilesTest, AStoreGoesOnBesideHostileFiles) {
  testing::WriteWrf(Storm(), folder_.File("wrfout_d01"));
  Bad("crash");
  Bad("hang");
  Bad("noise");
  storm_store::StormStoreOptions options;
  options.read_ahead = 0;
  options.formats = FormatsWithMisbehaving();
  options.formats.LeaveTo({.describe = [this, files = Files()](const std::string& path) {
    const bool hangs = absl::StrContains(path, "hang.bad");
    return hangs ? DescribeInTime(*files, path) : files->Describe(path);
  }});
  const auto store = storm_store::StormStore::Open({folder_.Path().string()}, options);
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_EQ((*store)->Storms().size(), 1U);
  EXPECT_TRUE((*store)->Get("wrfout_d01", 0, {}).ok());
}

TEST_F(ConfinedFilesTest, SeveralAreReadAtOnce) {
  const auto files = Files();
  const auto hang = files->Describe(Bad("hang-reading"));
  ASSERT_TRUE(hang.ok()) << hang.status();
  const std::string path = folder_.File("wrfout_d01");
  testing::WriteWrf(Storm(), path);
  std::atomic<bool> begun{false};
  auto hanging = std::async(std::launch::async, [&] {
    const auto begins = [&](double) {
      begun = true;
      return absl::OkStatus();
    };
    return hang->reader->Read(0, std::nullopt, begins).status();
  });
  ASSERT_TRUE(WaitFor([&] { return begun.load(); }));
  // The other file still hangs, because time stands still.
  EXPECT_TRUE(files->Describe(path).ok());
  EXPECT_EQ(hanging.wait_for(milliseconds(0)), std::future_status::timeout);
  EXPECT_TRUE(absl::IsDeadlineExceeded(GetInTime(std::move(hanging))));
}

TEST_F(ConfinedFilesTest, ThisMachineCanConfine) {
  const absl::Status status = Files()->Probe();
  EXPECT_TRUE(status.ok()) << status;
}

}  // namespace
}  // namespace thunderhead::sandbox
