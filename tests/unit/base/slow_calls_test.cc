#include "base/slow_calls.h"

#include <algorithm>
#include <mutex>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

class SlowCallsTest : public ::testing::Test {
 protected:
  std::vector<std::string> Said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  bool AwaitSaid(std::size_t count) {
    return testing::WaitFor([&] { return Said().size() >= count; });
  }
  std::function<void(const std::string&)> Say() {
    return [this](const std::string& what) {
      const std::lock_guard lock(mutex_);
      said_.push_back(what);
    };
  }

  testing::ManualTime time_;

 private:
  std::mutex mutex_;
  std::vector<std::string> said_;
};

TEST_F(SlowCallsTest, SaysWhatDoesNotAnswerWhileItDoesNot) {
  SlowCalls watch(seconds(10), Say(), time_);
  {
    const SlowCall hangs("/mnt/gone/storm.nc", watch);
    time_.Advance(seconds(9));
    const SlowCall quick("/data/storm.nc", watch);
    time_.Advance(seconds(1));
    ASSERT_TRUE(AwaitSaid(1));
    time_.Advance(seconds(2));
  }
  EXPECT_THAT(Said(),
              ElementsAre(AllOf(StartsWith("/mnt/gone/storm.nc: has not answered for 10.0 s"),
                                HasSubstr("its storage is slow or hangs")),
                          StartsWith("/mnt/gone/storm.nc: answered after 12.0 s")));
}

TEST_F(SlowCallsTest, SaysItMoreAndMoreSeldom) {
  SlowCalls watch(seconds(10), Say(), time_);
  const SlowCall hangs("/mnt/gone", watch);
  // Every ten seconds another call becomes slow and is reported. Its report shows that the watching
  // thread has checked.
  std::vector<std::string> said;
  for (int i = 1; i <= 8; ++i) {
    const std::string marker = absl::StrCat("/marker/", i);
    const SlowCall other(marker, watch);
    time_.Advance(seconds(10));
    const auto is_marker = [&](const std::string& what) { return what.starts_with(marker); };
    ASSERT_TRUE(testing::WaitFor([&] { return std::ranges::any_of(Said(), is_marker); }));
  }
  for (const std::string& what : Said()) {
    if (what.starts_with("/mnt/gone")) said.push_back(what);
  }
  EXPECT_THAT(said, ElementsAre(HasSubstr("for 10.0 s"), HasSubstr("for 20.0 s"),
                                HasSubstr("for 40.0 s"), HasSubstr("for 80.0 s")));
}

TEST_F(SlowCallsTest, SaysNothingOfCallsThatAnswer) {
  SlowCalls watch(seconds(10), Say(), time_);
  for (int i = 0; i < 1000; ++i) {
    const SlowCall call("/data", watch);
    time_.Advance(milliseconds(9));
  }
  EXPECT_THAT(Said(), IsEmpty());
}

}  // namespace
}  // namespace thunderhead::base
