#include "base/process_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>

namespace thunderhead::base {
namespace {

using ::testing::HasSubstr;

constexpr rlim_t kMiB = rlim_t{1} << 20;

TEST(ProcessLimits, AreNamedWithTheirCommands) {
  EXPECT_EQ(TextOf({}), "");
  EXPECT_EQ(TextOf({.address_space_bytes = 600 * kMiB, .data_bytes = 400 * kMiB, .threads = 50}),
            "the limits of this process are an address space of 600 MiB (RLIMIT_AS, ulimit -v), "
            "data of 400 MiB (RLIMIT_DATA, ulimit -d), 50 processes and threads of its user "
            "(RLIMIT_NPROC, ulimit -u)");
}

TEST(ProcessLimits, AServerNeedsTwoGibibytesOfThem) {
  EXPECT_TRUE(CheckProcessLimits({}).ok());
  EXPECT_TRUE(CheckProcessLimits({.address_space_bytes = 2048 * kMiB}).ok());
  const absl::Status space = CheckProcessLimits({.address_space_bytes = 1000 * kMiB});
  EXPECT_EQ(space.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(space.message()),
              HasSubstr("an address space of 1000 MiB (RLIMIT_AS, ulimit -v)"));
  const absl::Status data = CheckProcessLimits({.data_bytes = 400 * kMiB});
  EXPECT_THAT(std::string(data.message()), HasSubstr("data of 400 MiB (RLIMIT_DATA, ulimit -d)"));
}

TEST(ProcessLimits, AreReadFromTheSystem) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit changed = before;
  constexpr rlim_t kLarge = rlim_t{1} << 46;
  changed.rlim_cur = before.rlim_max == RLIM_INFINITY ? kLarge : before.rlim_max;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &changed), 0);
  EXPECT_EQ(ReadProcessLimits().address_space_bytes, changed.rlim_cur);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
}

[[noreturn]] void EndByAnExceptionOfAThread() {
  rlimit limit{};
  limit.rlim_cur = 500;
  limit.rlim_max = 500;
  setrlimit(RLIMIT_NPROC, &limit);
  TellLimitsAtUnhandledExceptions();
  std::thread([] { throw std::runtime_error("no memory here"); }).join();
  std::exit(0);
}

TEST(ProcessLimitsDeathTest, AnUnhandledExceptionNamesThem) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_DEATH(
      EndByAnExceptionOfAThread(),
      "no code could handle .no memory here.; the limits of this process are .*500 processes");
}

}  // namespace
}  // namespace thunderhead::base
