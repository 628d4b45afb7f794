#include "base/storage_checks.h"

#include <atomic>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/manual_time.h"
#include "tests/support/wait_for.h"

namespace thunderhead::base {
namespace {

using std::chrono::milliseconds;
using testing::ManualTime;
using testing::WaitFor;

// A simulated file. Checking it may hang.
struct File {
  std::atomic<int> begun{0};
  std::atomic<int> looks{0};
  std::atomic<bool> hangs{false};
};

std::function<void()> LookAt(const std::shared_ptr<File>& file) {
  return [file] {
    ++file->begun;
    file->hangs.wait(true);
    ++file->looks;
  };
}

// Checks again while the file hangs, until the timeout.
void LookInVain(StorageChecks& looks, const File& file, ManualTime& time, milliseconds patience) {
  const int begun = file.begun;
  auto waiting = std::async(std::launch::async, [&] { looks.LookAgain(); });
  EXPECT_TRUE(WaitFor([&] { return file.begun > begun; }));
  time.Advance(patience - milliseconds(1));
  const auto has_ended = [&] {
    return waiting.wait_for(milliseconds(0)) == std::future_status::ready;
  };
  const int seen = time.Looks();
  EXPECT_TRUE(WaitFor([&] { return time.Looks() >= seen + 2 || has_ended(); }));
  EXPECT_FALSE(has_ended());
  time.Advance(milliseconds(1));
  waiting.get();
}

TEST(StorageChecksTest, WhoAsksGetsALookOfItsOwnOrALaterOne) {
  const auto file = std::make_shared<File>();
  StorageChecks looks("/file", LookAt(file), testing::kHangLimit);
  for (int i = 1; i <= 100; ++i) {
    looks.LookAgain();
    EXPECT_EQ(file->looks, i);
  }
  std::vector<std::jthread> asking;
  for (int i = 0; i < 8; ++i) {
    asking.emplace_back([&] {
      for (int k = 0; k < 100; ++k) {
        const int before = file->looks;
        looks.LookAgain();
        EXPECT_GT(file->looks, before);
      }
    });
  }
}

TEST(StorageChecksTest, OneThatHangsHoldsUpOnce) {
  const auto file = std::make_shared<File>();
  ManualTime time;
  StorageChecks looks("/file", LookAt(file), milliseconds(200), time);
  looks.LookAgain();
  file->hangs = true;
  LookInVain(looks, *file, time, milliseconds(200));
  // Later calls do not wait, because time stands still.
  for (int i = 0; i < 100; ++i) looks.LookAgain();
  EXPECT_EQ(file->looks, 1);
  file->hangs = false;
  file->hangs.notify_all();
  EXPECT_TRUE(WaitFor([&] {
    looks.LookAgain();
    return file->looks >= 3;
  })) << "it is looked at again";
}

TEST(StorageChecksTest, OneThatHangsIsLeftBehindAtTheEnd) {
  const auto file = std::make_shared<File>();
  file->hangs = true;
  // The clock is static, because the pending check outlives the test.
  static ManualTime time;
  {
    StorageChecks looks("/file", LookAt(file), milliseconds(100), time);
    LookInVain(looks, *file, time, milliseconds(100));
    // The destructor returns while time stands still, because the check has already timed out.
  }
  file->hangs = false;
  file->hangs.notify_all();
}

}  // namespace
}  // namespace thunderhead::base
