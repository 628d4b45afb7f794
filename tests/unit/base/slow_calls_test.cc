#include "base/slow_calls.h"

#include <mutex>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

class SlowCallsTest : public ::testing::Test {
 protected:
  std::vector<std::string> Said() {
    const std::lock_guard lock(mutex_);
    return said_;
  }
  bool AwaitSaid(std::size_t count) {
    for (int i = 0; i < 2000 && Said().size() < count; ++i) {
      std::this_thread::sleep_for(milliseconds(5));
    }
    return Said().size() >= count;
  }
  std::function<void(const std::string&)> Say() {
    return [this](const std::string& what) {
      const std::lock_guard lock(mutex_);
      said_.push_back(what);
    };
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> said_;
};

TEST_F(SlowCallsTest, SaysWhatDoesNotAnswerWhileItDoesNot) {
  SlowCalls watch(milliseconds(40), Say());
  {
    const SlowCall hangs("/mnt/gone/storm.nc", watch);
    const SlowCall quick("/data/storm.nc", watch);
    ASSERT_TRUE(AwaitSaid(1));
    EXPECT_THAT(Said(), Contains(AllOf(StartsWith("/mnt/gone/storm.nc: has not answered for 0."),
                                       HasSubstr("its storage is slow or hangs"))));
  }
  EXPECT_THAT(Said(), Contains(StartsWith("/mnt/gone/storm.nc: answered after")));
}

TEST_F(SlowCallsTest, SaysItMoreAndMoreSeldom) {
  SlowCalls watch(milliseconds(20), Say());
  const SlowCall hangs("/mnt/gone", watch);
  std::this_thread::sleep_for(milliseconds(1000));
  // After 20, 40, 80, 160, 320 and 640 ms, give or take those of a slow machine.
  EXPECT_THAT(Said(), SizeIs(::testing::AllOf(::testing::Ge(2U), ::testing::Le(7U))));
}

TEST_F(SlowCallsTest, SaysNothingOfCallsThatAnswer) {
  SlowCalls watch(milliseconds(10'000), Say());
  for (int i = 0; i < 1000; ++i) const SlowCall call("/data", watch);
  EXPECT_THAT(Said(), IsEmpty());
}

}  // namespace
}  // namespace thunderhead::base
